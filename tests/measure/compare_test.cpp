// `alcove compare` as scripts see it: files in, JSON and exit code out.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "core/formats/png.h"
#include "tests/support/command_line.h"
#include "tests/support/picture_file.h"

namespace alcove::compare_test {
namespace {

using namespace test;
using Plane = std::vector<float>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Window kWindow{0, 0, kFormulaWidth, kFormulaHeight};

class Compare : public CompareCommand {
 protected:
  std::string exr(const std::string& name, const std::map<std::string, Plane>& planes,
                  const Window& data = kWindow) const {
    return exr_of(name, planes, data);
  }

  const Plane ramp = ramp_plane(0, 1), box = ramp_with_box();
};

/// Half of the pixels (the left ones) get another value.
Plane with_left(Plane plane, float value) {
  for (std::size_t i = 0; i < plane.size(); i++)
    if (i % kFormulaWidth < kFormulaWidth / 2) plane[i] = value;
  return plane;
}

Plane constant(float value) { return Plane(kWindow.pixels(), value); }

// One picture.

TEST_F(Compare, a_picture_with_itself) {
  const auto a = exr("a.exr", {{"Y", box}});
  const json j =
      measured({a, a, "--max-rmse", "0", "--max-p99", "0", "--min-ssim", "1", "--max-flip", "0", "--max-bias", "0"});
  for (const char* key : {"rmse", "mae", "bias", "max", "p95", "p99", "flip"}) EXPECT_EQ(j[key], 0) << key;
  EXPECT_EQ(j["count"], kWindow.pixels());
  EXPECT_EQ(j["excluded"], 0);
  EXPECT_DOUBLE_EQ(j["ssim"], 1);
  EXPECT_TRUE(j["psnr"].is_null()) << "infinite";
  EXPECT_EQ(j["pass"], true);
  EXPECT_THAT(j["broken"], IsEmpty());
}

TEST_F(Compare, known_differences) {
  const json j =
      measured({exr("a.exr", {{"Y", with_left(constant(0.5f), 0.75f)}}), exr("b.exr", {{"Y", constant(0.5f)}})});
  EXPECT_DOUBLE_EQ(j["rmse"], std::sqrt(0.5 * 0.0625));
  EXPECT_DOUBLE_EQ(j["mae"], 0.125);
  EXPECT_DOUBLE_EQ(j["bias"], 0.125);
  EXPECT_DOUBLE_EQ(j["max"], 0.25);
  EXPECT_DOUBLE_EQ(j["p99"], 0.25);
  EXPECT_DOUBLE_EQ(j["psnr"], -10 * std::log10(0.5 * 0.0625));
  EXPECT_EQ(j["channels"], json::array({"Y"}));
  EXPECT_EQ(j["bands"][2]["count"], kWindow.pixels());
  EXPECT_DOUBLE_EQ(j["bands"][2]["bias"], 0.125);
  EXPECT_EQ(j["bands"][0]["count"], 0);
  EXPECT_TRUE(j["edges"].is_null());
}

TEST_F(Compare, the_box_has_the_stored_ssim_and_flip) {
  const auto a = exr("a.exr", {{"Y", box}}), b = exr("b.exr", {{"Y", ramp}});
  const json j = measured({a, b});
  EXPECT_NEAR(j["ssim"], 0.707282647151, 1e-11);
  EXPECT_NEAR(j["flip"], 0.110418082, 1e-6);
  EXPECT_NEAR(measured({a, b, "--peak", "2"})["ssim"], 0.751035250255, 1e-11);
  EXPECT_NE(measured({a, b, "--hdr"})["flip"], j["flip"]);
}

TEST_F(Compare, flip_of_colours_is_that_of_the_colours_not_of_each_channel) {
  const auto result = noise_result(), reference = noise_reference();
  const auto a = exr("a.exr", {{"R", result[0]}, {"G", result[1]}, {"B", result[2]}});
  const auto b = exr("b.exr", {{"R", reference[0]}, {"G", reference[1]}, {"B", reference[2]}});
  EXPECT_NEAR(measured({a, b})["flip"], 0.323722805, 1e-6);
  const json two = measured(
      {exr("c.exr",
           {{"x.R", result[0]}, {"x.G", result[1]}, {"x.B", result[2]}, {"y.R", ramp}, {"y.G", ramp}, {"y.B", ramp}}),
       exr("d.exr", {{"x.R", reference[0]},
                     {"x.G", reference[1]},
                     {"x.B", reference[2]},
                     {"y.R", ramp},
                     {"y.G", ramp},
                     {"y.B", ramp}})});
  EXPECT_NEAR(two["flip"], 0.323722805 / 2, 1e-6) << "the mean of the layers";
}

TEST_F(Compare, the_table_tells_the_same) {
  const Finished finished =
      compare({exr("a.exr", {{"Y", with_left(constant(0.5f), 0.75f)}}), exr("b.exr", {{"Y", constant(0.5f)}})});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.out, AllOf(HasSubstr("rmse 0.1768"), HasSubstr("bias +0.1250"), HasSubstr("psnr 15.05 dB"),
                                  HasSubstr("1920 pixels")));
}

// Channels and formats.

TEST_F(Compare, channels_match_by_name_then_by_its_last_part) {
  const auto a = exr("a.exr", {{"R", ramp}, {"G", box}, {"B", ramp}});
  const std::string layer = "ViewLayer.Combined.";
  const json j =
      measured({a, exr("b.exr", {{layer + "R", ramp}, {layer + "G", box}, {layer + "B", ramp}, {layer + "A", box}})});
  EXPECT_EQ(j["rmse"], 0);
  EXPECT_EQ(j["channels"], json::array({"B", "G", "R"}));
  expect_error(3, {a, exr("c.exr", {{"x.R", ramp}, {"y.R", box}})},
               {"channel R could be compared with several", "--channel"});
  const json list = measured({a, folder / "c.exr", "--channel", "R=x.R,G=y.R"});
  EXPECT_EQ(list["rmse"], 0);
  EXPECT_EQ(measured({a, folder / "c.exr", "--channel", "R=x.R", "--channel", "G=y.R"}), list);
}

TEST_F(Compare, ao_is_not_paired_with_a_component_of_a_normal) {
  const auto ao = exr("ao.exr", {{"Y", ramp}});
  const std::map<std::string, Plane> normal{{"N.X", box}, {"N.Y", box}, {"N.Z", box}};
  expect_error(3, {exr("n.exr", normal), ao}, {"share no channel", "N (X, Y, Z)", "--channel"});
  const auto hidden = exr("h.exr", {{"Y", ramp}, {"hidden1.Z", box}});
  EXPECT_EQ(measured({hidden, exr("o.exr", {{"AO", ramp}})})["channels"], json::array({"Y"}));
  EXPECT_EQ(measured({folder / "n.exr", ao, "--channel", "N.Y=Y"})["count"], ramp.size());
  EXPECT_EQ(measured({folder / "n.exr", exr("m.exr", {{"X", box}, {"Y", box}, {"Z", box}})})["rmse"], 0);
  EXPECT_EQ(measured({exr("l.exr", {{"L.Y", ramp}, {"L.A", box}}), ao})["rmse"], 0) << "it is no vector";
}

TEST_F(Compare, the_only_ao_layer_of_a_renderer_is_found_and_said) {
  const auto ao = exr("ao.exr", {{"Y", box}});
  const std::map<std::string, Plane> others{{"ViewLayer.Combined.R", ramp}, {"ViewLayer.Combined.G", ramp},
                                            {"ViewLayer.Combined.B", ramp}, {"ViewLayer.Depth.Z", ramp},
                                            {"ViewLayer.Normal.X", ramp},   {"ViewLayer.Normal.Y", ramp},
                                            {"ViewLayer.Normal.Z", ramp}};
  const auto with = [&](const std::string& file, const std::vector<std::string>& layers) {
    auto planes = others;
    for (const auto& layer : layers)
      for (const char* color : {".R", ".G", ".B"}) planes[layer + color] = box;
    return exr(file, planes);
  };
  for (const char* layer : {"AO", "ViewLayer.AO", "ViewLayer.Ambient Occlusion", "view.ambient_occlusion", "ao"}) {
    const Finished finished = compare({ao, with("layers.exr", {layer})});
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_THAT(finished.out, HasSubstr("rmse 0.0000"));
    EXPECT_EQ(finished.err, fmt::format("alcove: note: Y against {}.R of the reference, by the name; --channel chooses "
                                        "others [ao-layer]\n",
                                        layer));
  }
  // Of two renderers' files all colours count, and no alpha.
  auto other = others;
  for (const char* color : {"AO.R", "AO.G", "AO.B"}) other[color] = box;
  other["AO.A"] = ramp;
  std::erase_if(other, [](const auto& plane) { return plane.first.starts_with("ViewLayer"); });
  EXPECT_EQ(measured({exr("other.exr", other), with("layers.exr", {"left.AO"})})["channels"],
            json::array({"AO.B", "AO.G", "AO.R"}));
  // A depth beside it, and two layers, decide nothing.
  expect_error(3, {ao, with("two.exr", {"ViewLayer.AO", "Other.AO"})},
               {"share no channel", "ViewLayer.AO (B, G, R)", "Other.AO (B, G, R)", "ViewLayer.Depth.Z"});
}

TEST_F(Compare, no_common_channel_is_an_error_that_lists_both) {
  expect_error(3, {exr("a.exr", {{"Y", ramp}}), exr("b.exr", {{"U", ramp}, {"V", ramp}})},
               {"a.exr has Y", "b.exr has U, V", "--channel"});
  expect_error(3, {folder / "a.exr", folder / "b.exr", "--channel", "Y=W"}, {"no channel W"});
}

TEST_F(Compare, a_png_is_compared_as_it_is_stored) {
  Plane rgb;
  for (std::size_t i = 0; i < kWindow.pixels(); i++) rgb.insert(rgb.end(), {float(i % 256) / 255, 0.2f, 1});
  write_png(folder / "a.png", kWindow.width, kWindow.height, 3, rgb);
  std::map<std::string, Plane> planes{{"R", {}}, {"G", {}}, {"B", {}}};
  for (std::size_t i = 0; i < rgb.size(); i++) planes[std::string(1, "RGB"[i % 3])].push_back(rgb[i]);
  const json j = measured({folder / "a.png", exr("b.exr", planes)});
  EXPECT_LT(j["max"], 1e-7);
  EXPECT_EQ(j["count"], kWindow.pixels());
  write_png(folder / "grey.png", kWindow.width, kWindow.height, 1, ramp);
  EXPECT_LT(measured({folder / "grey.png", exr("c.exr", {{"AO", ramp}})})["max"], 0.5 / 255 + 1e-6);
}

// Which pixels.

TEST_F(Compare, nan_pixels_are_left_out_and_counted) {
  Plane broken = ramp;
  broken[7] = kNan;
  broken[100] = std::numeric_limits<float>::infinity();
  const auto a = exr("a.exr", {{"Y", broken}});
  const json j = measured({a, exr("b.exr", {{"Y", ramp}})});
  EXPECT_EQ(j["excluded"], 2);
  EXPECT_EQ(j["holes"], 2);
  const json itself = measured({a, a, "--max-rmse", "0"});
  EXPECT_EQ(itself["excluded"], 2);
  EXPECT_EQ(itself["holes"], 0);
  EXPECT_TRUE(itself["first_hole"].is_null());
  EXPECT_EQ(itself["pass"], true) << "both have the same holes";
  EXPECT_EQ(j["count"], kWindow.pixels() - 2);
  EXPECT_EQ(j["rmse"], 0);
  EXPECT_EQ(j["flip"], 0);
  EXPECT_DOUBLE_EQ(j["ssim"], 1);
}

TEST_F(Compare, a_hole_in_one_file_breaks_every_limit_and_is_named_with_its_place) {
  const std::size_t at = 3 * kFormulaWidth + 7;
  Plane broken = ramp;
  broken[at] = broken[at + 2] = kNan;
  broken[at + 1] = -std::numeric_limits<float>::infinity();
  const auto a = exr("a.exr", {{"X", ramp}, {"Y", broken}}, {5, -2, kFormulaWidth, kFormulaHeight});
  const auto b = exr("b.exr", {{"X", ramp}, {"Y", ramp}}, {5, -2, kFormulaWidth, kFormulaHeight});
  const std::string place = fmt::format("3 of {} pixels are NaN or infinite in one file only, the first in the ", 1920);
  for (const auto& [option, value] : {std::pair{"--max-rmse", "1"},
                                      {"--max-p99", "1"},
                                      {"--min-ssim", "0"},
                                      {"--max-flip", "1"},
                                      {"--max-bias", "1"}}) {
    expect_error(6, {a, b, option, value}, {place + "result at x 12, y 1, channel Y", "--max-excluded is 0"});
    expect_error(6, {b, a, option, value}, {place + "reference at x 12, y 1, channel Y", "--max-excluded is 0"});
  }
  const json j = measured({a, b, "--max-rmse", "1"}, 6);
  EXPECT_EQ(j["holes"], 3);
  EXPECT_EQ(j["first_hole"], json({{"x", 12}, {"y", 1}, {"channel", "Y"}, {"in", "result"}}));
  EXPECT_EQ(j["pass"], false);
  EXPECT_EQ(measured({a, b, "--max-excluded", "0.0016"})["pass"], true);
  expect_error(6, {a, b, "--max-excluded", "0.0015"}, {place, "--max-excluded is 0.0015"});
  const auto mask = exr("m.exr", {{"m", with_left(constant(1), 0)}}, {5, -2, kFormulaWidth, kFormulaHeight});
  EXPECT_EQ(measured({a, b, "--mask", mask, "--max-rmse", "0"})["holes"], 0);
}

TEST_F(Compare, a_hole_in_one_of_two_references_is_a_hole) {
  Plane broken = ramp;
  broken[4] = kNan;
  const auto whole = exr("whole.exr", {{"Y", ramp}}), hole = exr("hole.exr", {{"Y", broken}});
  for (const auto& [result, a, b, in] : {std::array{hole, whole, hole, std::string("result")},
                                         {hole, hole, whole, "result"},
                                         {whole, whole, hole, "reference"},
                                         {whole, hole, whole, "reference"}}) {
    const json j = measured({result, a, "--reference-b", b, "--max-rmse", "1"}, 6);
    EXPECT_EQ(j["holes"], 1);
    EXPECT_EQ(j["first_hole"]["in"], in);
  }
  EXPECT_EQ(measured({hole, hole, "--reference-b", hole})["holes"], 0);
}

TEST_F(Compare, a_hole_without_a_limit_is_a_warning) {
  Plane broken = ramp;
  broken[0] = kNan;
  const auto a = exr("a.exr", {{"Y", broken}}), b = exr("b.exr", {{"Y", ramp}});
  const Finished finished = compare({a, b});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.err, AllOf(StartsWith("alcove: warning: 1 of 1920 pixels"), HasSubstr("x 0, y 0, channel Y"),
                                  HasSubstr("[holes]")));
  EXPECT_EQ(measured({a, b})["pass"], false);
}

TEST_F(Compare, a_mask_from_a_file_from_alpha_and_from_depth) {
  const auto a = exr("a.exr", {{"Y", with_left(ramp, 0.9f)}}), b = exr("b.exr", {{"Y", ramp}});
  const auto mask = exr("mask.exr", {{"m", with_left(constant(0.1f), 0)}});
  const auto alpha = exr("alpha.exr", {{"R", ramp}, {"A", with_left(constant(1), 0)}});
  const auto depth = exr("depth.exr", {{"ViewLayer.Depth.Z", with_left(constant(5), 1e10f)}});
  const std::vector<std::vector<std::string>> ways{
      {"--mask", mask}, {"--mask", alpha}, {"--depth", depth}, {"--mask", alpha, "--mask-channel", "A"}};
  for (const auto& arguments : ways) {
    std::vector<std::string> all{a, b};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const json j = measured(all);
    EXPECT_EQ(j["masked"], kWindow.pixels() / 2) << arguments[0];
    EXPECT_EQ(j["rmse"], 0);
    EXPECT_EQ(j["flip"], 0) << "what is left out must not shine over";
    EXPECT_DOUBLE_EQ(j["ssim"], 1);
  }
  expect_error(3, {a, b, "--mask", exr("two.exr", {{"u", ramp}, {"v", ramp}})},
               {"its mask channel is not clear", "u, v", "--mask-channel"});
}

TEST_F(Compare, errors_at_depth_edges_and_away_from_them) {
  Plane result = ramp, depth = constant(10);
  for (std::size_t i = 0; i < depth.size(); i++) {
    if (i % kFormulaWidth >= 24) depth[i] = 12;
    // two of the three columns that each side of the edge has
    if (i % kFormulaWidth >= 22 && i % kFormulaWidth < 26) result[i] += 0.5f;
  }
  const json j =
      measured({exr("a.exr", {{"Y", result}}), exr("b.exr", {{"Y", ramp}}), "--depth", exr("z.exr", {{"Z", depth}})});
  EXPECT_EQ(j["edges"]["at"]["count"], 6 * kFormulaHeight);
  EXPECT_NEAR(j["edges"]["at"]["bias"], 0.5 * 4 / 6, 1e-6);
  EXPECT_EQ(j["edges"]["away"]["rmse"], 0);
}

TEST_F(Compare, nothing_to_compare_is_an_error) {
  const auto a = exr("a.exr", {{"Y", ramp}});
  expect_error(3, {a, exr("nan.exr", {{"Y", constant(kNan)}})}, {"nan.exr", "no pixel to compare", "1920 are NaN"});
  expect_error(3, {a, a, "--mask", exr("empty.exr", {{"Y", constant(0)}})},
               {"no pixel to compare", "1920 are left out by the mask"});
}

TEST_F(Compare, other_pixels_are_an_error_that_names_both_windows) {
  const auto a = exr("a.exr", {{"Y", ramp}});
  const auto small = exr("b.exr", {{"Y", Plane(100)}}, {0, 0, 10, 10}),
             moved = exr("c.exr", {{"Y", ramp}}, {5, 0, kFormulaWidth, kFormulaHeight});
  expect_error(3, {a, small}, {to_string(kWindow), to_string({0, 0, 10, 10}), "a.exr", "b.exr"});
  expect_error(3, {a, moved}, {to_string(kWindow), to_string({5, 0, kFormulaWidth, kFormulaHeight})});
  expect_error(3, {a, a, "--mask", small}, {"b.exr"});
  expect_error(3, {a, a, "--reference-b", small}, {"b.exr"});
  expect_error(3, {a, a, "--depth", exr("z.exr", {{"Z", Plane(100, 1)}}, {0, 0, 10, 10})}, {"z.exr"});
}

TEST_F(Compare, files_of_one_display_window_are_compared_where_all_have_pixels) {
  const auto write = [&](const std::string& name, const std::string& channel, const Window& data, const auto& value) {
    FrameFile file{data, {0, 0, 60, 32}, 1, {}, {}, {}};
    for (int y = data.y; y < data.y + data.height; y++)
      for (int x = data.x; x < data.x + data.width; x++) file.planes[channel].push_back(value(x, y));
    file.write(folder / name);
    return std::string(folder / name);
  };
  const auto slope = [](int x, int y) { return float(x + 2 * y) / 256; };
  const auto raised = [&](int x, int y) { return slope(x, y) + (x >= 20 ? 0.25f : 0); };
  const auto left = [](int x, int) { return float(x < 20); };
  const auto a = write("a.exr", "Y", {-4, -4, 50, 40}, slope), b = write("b.exr", "Y", {3, 2, 60, 20}, raised);
  const json j = measured({a, b});
  EXPECT_EQ(j["common_window"], json({{"x", 3}, {"y", 2}, {"width", 43}, {"height", 20}}));
  EXPECT_EQ(j["count"], 43 * 20);
  EXPECT_EQ(j["max"], 0.25);
  EXPECT_THAT(compare({a, b}).out, HasSubstr("the files' windows differ: compared 43x20 at (3, 2)"));
  const auto mask = write("m.exr", "Y", {10, 0, 30, 10}, left);
  const json masked = measured({a, b, "--mask", mask});
  EXPECT_EQ(masked["common_window"], json({{"x", 10}, {"y", 2}, {"width", 30}, {"height", 8}}));
  EXPECT_EQ(masked["count"], 10 * 8);
  EXPECT_EQ(masked["max"], 0);
  EXPECT_TRUE(measured({a, a})["common_window"].is_null());
  expect_error(3, {a, write("far.exr", "Y", {50, 0, 5, 5}, slope)}, {"far.exr", "share no pixel"});
}

TEST_F(Compare, a_picture_too_small_for_ssim_has_none) {
  const Plane one{0.5f};
  const auto a = exr("a.exr", {{"Y", one}}, {0, 0, 1, 1});
  EXPECT_TRUE(measured({a, a})["ssim"].is_null());
  expect_error(6, {a, a, "--min-ssim", "0.5"}, {"ssim cannot be measured"});
}

// Limits and mistakes.

TEST_F(Compare, a_broken_limit_ends_with_6_and_says_which) {
  const auto a = exr("a.exr", {{"Y", with_left(constant(0.5f), 0.25f)}}), b = exr("b.exr", {{"Y", constant(0.5f)}});
  EXPECT_EQ(compare({a, b, "--max-rmse", "0.1768", "--max-bias", "0.1251", "--max-p99", "0.25"}).code, 0);
  expect_error(6, {a, b, "--max-rmse", "0.17"}, {"rmse is 0.176777, and --max-rmse is 0.17"});
  expect_error(6, {a, b, "--max-bias", "0.1"}, {"bias is -0.125, and --max-bias is 0.1"});
  expect_error(6, {a, b, "--max-p99", "0.2"}, {"p99 is 0.25, and --max-p99 is 0.2"});
  expect_error(6, {a, b, "--min-ssim", "0.99"}, {"--min-ssim is 0.99"});
  expect_error(6, {a, b, "--max-flip", "0.001", "--max-rmse", "0.1"},
               {"--max-flip is 0.001", "; ", "--max-rmse is 0.1"});
  const json j = measured({a, b, "--max-rmse", "0.1"}, 6);
  EXPECT_EQ(j["pass"], false);
  EXPECT_EQ(j["broken"].size(), 1);
}

TEST_F(Compare, a_small_error_is_told_in_its_own_digits) {
  const auto a = exr("a.exr", {{"Y", constant(0.50004f)}}), b = exr("b.exr", {{"Y", constant(0.5f)}});
  EXPECT_THAT(compare({a, b}).out, AllOf(HasSubstr("rmse 4.0e-05"), HasSubstr("bias +4.0e-05")));
}

TEST_F(Compare, mistakes_on_the_command_line_end_with_2) {
  const auto a = exr("a.exr", {{"Y", ramp}});
  using Words = std::vector<std::string>;
  for (const auto& [more, words] :
       {std::pair<Words, Words>{{"--max-rms", "1"}, {"--max-rms", "did you mean --max-rmse"}},
        {{"--max-rmse", "nan"}, {"--max-rmse", "nan is not a finite number"}},
        {{"--peak", "0"}, {"--peak", "above 0"}},
        {{"--frames", "1-3"}, {"a.exr", "%04d"}},
        {{"--motion", a}, {"--motion"}},
        {{"--mask-channel", "M"}, {"--mask-channel: applies with --mask only"}},
        {{"--depth-channel", "Z"}, {"--depth-channel: applies with --depth only"}},
        {{"--sky", "5"}, {"--sky: applies with --depth only"}},
        {{"--motion-channels", "X,Y"}, {"--motion-channels: applies with --motion only"}}}) {
    Words arguments{a, a};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_error(2, arguments, words);
  }
  expect_error(2, {}, {"RESULT is missing"});
  expect_error(2, {folder / "a.%04d.exr", a, "--frames", "1-x"}, {"1-x"});
}

TEST_F(Compare, files_that_cannot_be_read_end_with_3) {
  const auto a = exr("a.exr", {{"Y", ramp}});
  expect_error(3, {a, folder / "missing.exr"}, {"missing.exr", "REFERENCE"});
  expect_error(3, {folder / "missing.png", a}, {"missing.png", "RESULT"});
  write_bytes(folder / "text.png", "no picture");
  expect_error(3, {folder / "text.png", a}, {"text.png"});
  write_bytes(folder / "cut.exr", read_bytes(a).substr(0, read_bytes(a).size() - 100));
  expect_error(3, {folder / "cut.exr", a}, {"cut.exr", "damaged or incomplete"});
  expect_error(3, {a, a, "--depth", exr("normal.exr", {{"N.X", ramp}, {"N.Y", ramp}})},
               {"normal.exr", "no depth channel", "--depth-channel"});
}

// Sequences.

class CompareSequence : public Compare {
 protected:
  CompareSequence() {
    for (int frame = 1; frame <= 4; frame++) {
      const std::string number = "000" + std::to_string(frame);
      exr("ao." + number + ".exr", {{"Y", constant(frame == 3 ? 0.75f : 0.5f)}});
      exr("truth." + number + ".exr", {{"AO", constant(0.5f)}});
    }
  }
  const std::string result = folder / "ao.%04d.exr", reference = folder / "truth.####.exr";
};

TEST_F(CompareSequence, tells_every_frame_the_worst_the_mean_and_the_flicker) {
  const json j = measured({result, reference});
  ASSERT_EQ(j["frames"].size(), 4);
  EXPECT_EQ(j["frames"][2]["frame"], 3);
  EXPECT_EQ(j["frames"][2]["rmse"], 0.25);
  EXPECT_EQ(j["frames"][1]["rmse"], 0);
  EXPECT_EQ(j["worst"]["frame"], 3);
  EXPECT_EQ(j["mean"]["rmse"], 0.0625);
  EXPECT_EQ(j["rmse"], 0.25) << "the worst of any frame";
  EXPECT_EQ(j["count"], 4 * kWindow.pixels());
  EXPECT_DOUBLE_EQ(j["flicker"], std::sqrt((0 + 0.0625 + 0.0625) / 3));
  EXPECT_EQ(j["pass"], true);
}

TEST_F(CompareSequence, a_hole_is_named_with_its_frame) {
  Plane broken = constant(0.5f);
  broken[1] = kNan;
  exr("ao.0002.exr", {{"Y", broken}});
  expect_error(6, {result, reference, "--max-rmse", "1"}, {"frame 2: 1 of 1920 pixels", "x 1, y 0, channel Y"});
  const json j = measured({result, reference, "--max-rmse", "1"}, 6);
  EXPECT_EQ(j["holes"], 1);
  EXPECT_EQ(j["frames"][1]["first_hole"]["x"], 1);
  EXPECT_TRUE(j["frames"][0]["first_hole"].is_null());
}

TEST_F(CompareSequence, limits_hold_for_every_frame) {
  EXPECT_EQ(compare({result, reference, "--max-rmse", "0.25"}).code, 0);
  EXPECT_EQ(measured({result, folder / "truth.0001.exr"})["frames"].size(), 4) << "one reference serves all";
  expect_error(6, {result, reference, "--max-rmse", "0.2"}, {"frame 3: rmse is 0.25, and --max-rmse is 0.2"});
}

TEST_F(CompareSequence, a_list_chooses_the_frames) {
  const json j = measured({result, reference, "--frames", "4,1-2"});
  EXPECT_EQ(j["frames"].size(), 3);
  EXPECT_EQ(j["frames"][0]["frame"], 4);
  EXPECT_EQ(j["rmse"], 0);
  EXPECT_TRUE(measured({result, reference, "--frames", "1-3x2"})["flicker"].is_null())
      << "no two frames follow each other";
}

TEST_F(CompareSequence, frames_that_result_lacks_are_a_warning) {
  const auto said = [&](const Options& options) { return compare(options).err; };
  EXPECT_THAT(said({result, reference}), Not(HasSubstr("sequence-hole")));
  exr("truth.0006.exr", {{"AO", ramp}});
  EXPECT_THAT(said({result, reference}), AllOf(HasSubstr("were not compared: 6"), HasSubstr("[sequence-hole]")));
  EXPECT_THAT(said({result, reference, "--frames", "1-4"}), Not(HasSubstr("sequence-hole")));
  for (const char* name : {"ao.0003.exr", "truth.0003.exr", "truth.0006.exr"}) fs::remove(folder / name);
  EXPECT_THAT(said({result, reference}), HasSubstr("were not compared: 3"));
}

TEST_F(CompareSequence, missing_frames_are_listed) {
  exr("ao.0007.exr", {{"Y", ramp}});
  exr("ao.0008.exr", {{"Y", ramp}});
  const Finished finished = compare({result, reference});
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err, AllOf(HasSubstr("truth.####.exr"), HasSubstr("frames are missing: 7-8")));
  EXPECT_THAT(compare({result, reference, "--frames", "1-10"}).err,
              AllOf(HasSubstr("ao.%04d.exr"), HasSubstr("5-6, 9-10")));
  expect_error(3, {folder / "none.%04d.exr", reference}, {"none.0001.exr"});
  const std::string too_long = folder / (std::string(300, 'x') + ".%04d.exr");  // for a name of the file system's
  expect_error(3, {too_long, reference, "--frames", "1"}, {too_long, "frames are missing: 1"});
}

TEST_F(CompareSequence, an_error_that_moves_with_its_surface_does_not_flicker) {
  // an error of the result moves to the right by 3 pixels per frame, and up by 2
  for (int frame = 1; frame <= 3; frame++) {
    Plane plane = constant(0.25f);
    for (int y = 0; y < kFormulaHeight; y++)
      for (int x = 0; x < kFormulaWidth; x++)
        if (((x - 3 * frame + 90) % 5 == 0) != ((y + 2 * frame) % 7 == 0))
          plane[std::size_t(y * kFormulaWidth + x)] += 0.25f;
    exr("moving." + std::to_string(frame) + ".exr", {{"Y", plane}});
    exr("still." + std::to_string(frame) + ".exr", {{"Y", constant(0.25f)}});
    // Blender's: place in the previous frame minus place here, y up.
    exr("vector." + std::to_string(frame) + ".exr", {{"ViewLayer.Vector.X", constant(-3)},
                                                     {"ViewLayer.Vector.Y", constant(-2)},
                                                     {"ViewLayer.Vector.Z", constant(0)}});
  }
  const std::vector<std::string> pictures{folder / "moving.%d.exr", folder / "still.%d.exr"};
  EXPECT_GT(measured(pictures)["flicker"], 0.1);
  EXPECT_EQ(measured({pictures[0], pictures[1], "--motion", folder / "vector.%d.exr"})["flicker"], 0);
  EXPECT_GT(measured({pictures[0], pictures[1], "--motion", folder / "vector.%d.exr", "--motion-channels",
                      "Vector.Y,Vector.X"})["flicker"],
            0.1);
}

// What decides without being meant.

/// A reference whose left half is 0, as renderers fill sky, and a result that has 1 there.
TEST_F(Compare, sky_that_is_0_in_one_and_1_in_the_other_is_said_with_what_leaves_it_out) {
  Plane far(kWindow.pixels(), 5.0f);
  for (std::size_t i = 0; i < far.size(); i++)
    if (i % kFormulaWidth < kFormulaWidth / 2) far[i] = 1e10f;
  const auto result = exr("sky1.exr", {{"Y", with_left(constant(0.5f), 1)}});
  const auto reference = exr("sky0.exr", {{"AO", with_left(constant(0.6f), 0)}});
  const auto depth = exr("depth.exr", {{"ViewLayer.Depth.Z", far}});
  const Finished finished = compare({result, reference});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.err, AllOf(StartsWith("alcove: warning: "), HasSubstr(" [sky-differs]"),
                                  HasSubstr("50.0 % of the pixels are 0 in " + reference), HasSubstr("1 in " + result),
                                  HasSubstr("0.1000"), HasSubstr("--depth")));
  const json j = measured({result, reference});
  EXPECT_EQ(j["sky_differs"]["count"], kWindow.pixels() / 2);
  EXPECT_NEAR(j["sky_differs"]["rmse_without"].get<double>(), 0.1, 1e-6);
  // The other way round it is the result that has 0.
  EXPECT_THAT(compare({reference, result}).err, HasSubstr("are 0 in " + reference));
  EXPECT_THAT(compare({result, reference, "--depth", depth}).err, IsEmpty());
  EXPECT_TRUE(measured({result, reference, "--depth", depth})["sky_differs"].is_null());
}

TEST_F(Compare, sky_that_is_few_pixels_or_little_of_the_error_is_not_told_of) {
  Plane holes = box, filled = with_left(box, 0.3f), open = constant(0.9f), dark = constant(0.3f);
  holes[0] = 0;
  filled[0] = 1;
  const auto few = std::ptrdiff_t(kWindow.pixels() / 50);
  std::fill_n(open.begin(), few, 1.0f);
  std::fill_n(dark.begin(), few, 0.0f);
  EXPECT_THAT(compare({exr("a.exr", {{"Y", filled}}), exr("b.exr", {{"Y", holes}})}).err, IsEmpty());
  EXPECT_THAT(compare({exr("c.exr", {{"Y", open}}), exr("d.exr", {{"Y", dark}})}).err, IsEmpty());
}

TEST_F(Compare, a_quiet_one_says_by_its_exit_code_alone) {
  const auto a = exr("a.exr", {{"Y", with_left(ramp, 1)}}), b = exr("b.exr", {{"Y", with_left(ramp, 0)}});
  for (const char* quiet : {"-q", "--quiet"}) {
    const Finished finished = compare({a, b, quiet});
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_EQ(finished.out + finished.err, "");
  }
  const Finished broken = compare({a, b, "-q", "--max-rmse", "0.1"});
  EXPECT_EQ(broken.code, 6);
  EXPECT_EQ(broken.out, "");
  EXPECT_THAT(broken.err, HasSubstr("--max-rmse"));
  EXPECT_EQ(measured({a, b, "-q"})["pass"], true) << "what --json asks for is printed";
}

// Documents.

TEST_F(CompareSequence, every_option_and_every_field_is_told) {
  const std::string page = read_bytes(ALCOVE_SOURCE_DIR "/docs/compare-and-bench.md"), help = compare({"--help"}).out;
  const std::size_t begin = page.find("## alcove compare"), end = page.find("\n## ", begin);
  ASSERT_NE(begin, page.npos);
  const std::string section = page.substr(begin, end - begin);
  const std::regex option("\n  (-h,)?(--[a-z0-9-]+)");
  int count = 0;
  for (std::sregex_iterator match(help.begin(), help.end(), option), none; match != none; ++match, count++)
    if ((*match)[2] != "--help")
      EXPECT_TRUE(std::regex_search(section, std::regex((*match)[2].str() + "[^a-z-]"))) << (*match)[2];
  EXPECT_GE(count, 20);
  EXPECT_THAT(help, HasSubstr("exit code 6"));
  for (const json& object :
       {measured({result, reference}), measured({folder / "ao.0001.exr", folder / "truth.0001.exr"})})
    for (const auto& [key, value] : object.items())
      EXPECT_TRUE(page.find("\"" + key + "\"") != page.npos || page.find("`" + key + "`") != page.npos) << key;
}

// The page.

TEST_F(CompareSequence, the_page_and_json_have_the_verdict_and_each_limit_with_its_value) {
  const std::string page = folder / "page.html";
  const Options limits{"--max-rmse", "0.2", "--max-bias", "0.5"};
  const auto with_limits = [&](Options words) {
    words.insert(words.end(), limits.begin(), limits.end());
    return words;
  };
  EXPECT_EQ(compare(with_limits({result, reference, "--report", page})).code, 6);
  const json verdict = report_in(page)["verdict"];
  EXPECT_EQ(verdict["pass"], false);
  EXPECT_EQ(verdict["limits"][0],
            (json{{"option", "--max-rmse"}, {"limit", 0.2}, {"value", 0.25}, {"frame", "3"}, {"holds", false}}));
  EXPECT_EQ(verdict["limits"][1]["holds"], true);
  EXPECT_EQ(measured(with_limits({result, reference}), 6)["limits"], verdict["limits"]);
  ASSERT_EQ(compare({result, reference, "--report", page}).code, 0);
  EXPECT_TRUE(report_in(page)["verdict"].is_null()) << "without limits there is none";
}

TEST_F(Compare, the_scale_of_the_error_fits_a_small_error_and_a_single_pixel_hides_no_other) {
  const auto scale = [&](Plane plane) {
    const std::string page = folder / "page.html";
    EXPECT_EQ(compare({exr("a.exr", {{"Y", plane}}), exr("b.exr", {{"Y", constant(0.5f)}}), "--report", page}).code, 0);
    return report_in(page)["images"][0]["full"].get<double>();
  };
  EXPECT_NEAR(scale(with_left(constant(0.5f), 0.503f)), 0.005, 1e-9);
  EXPECT_NEAR(scale(constant(0.75f)), 0.25, 1e-9);
  EXPECT_NEAR(scale(constant(0.5f)), 0.25, 1e-9) << "of equal pictures";
  Plane one = constant(0.5f);
  one[0] = 0.59f;
  EXPECT_NEAR(scale(one), 0.025, 1e-9);
}

TEST_F(CompareSequence, junit_has_a_case_for_each_frame_and_a_picture_for_each_that_fails) {
  const std::string xml = folder / "new/junit.xml", picture = folder / "new/junit.3.error.png";
  EXPECT_EQ(compare({result, reference, "--junit", xml, "--max-rmse", "0.2"}).code, 6);
  const std::string text = read_bytes(xml);
  EXPECT_THAT(text, AllOf(HasSubstr("tests=\"4\" failures=\"1\" errors=\"0\""), HasSubstr("name=\"2\"></testcase>"),
                          HasSubstr("<failure message=\"rmse is 0.25, and --max-rmse is 0.2\"/>"),
                          HasSubstr("[[ATTACHMENT|" + picture + "]]"), HasSubstr("full colour from an error of 0.25")));
  EXPECT_THAT(names_in(folder / "new"), ElementsAre("junit.3.error.png", "junit.xml"));
  EXPECT_EQ(read_bytes(picture).substr(1, 3), "PNG");
}

TEST_F(CompareSequence, reports_of_an_earlier_comparison_do_not_stay) {
  const std::string a = exr("a.exr", {{"Y", ramp}}), b = exr("b.exr", {{"Y", ramp}});
  const Options reports{"--junit", folder / "j.xml", "--report", folder / "r.html"};
  ASSERT_EQ(compare(joined({a, b}, reports)).code, 0);
  ASSERT_TRUE(fs::exists(folder / "j.xml") && fs::exists(folder / "r.html"));
  expect_error(3, joined({a, folder / "gone.exr"}, reports), {"gone.exr"});
  EXPECT_FALSE(fs::exists(folder / "r.html")) << "nothing was compared";
  EXPECT_THAT(read_bytes(folder / "j.xml"), AllOf(HasSubstr("<error message="), HasSubstr("errors=\"1\"")));
  ASSERT_EQ(compare(joined({result, reference, "--max-rmse", "0.2"}, reports)).code, 6);
  ASSERT_TRUE(fs::exists(folder / "j.3.error.png"));
  ASSERT_EQ(compare(joined({result, reference, "--max-rmse", "0.3"}, reports)).code, 0);
  EXPECT_FALSE(fs::exists(folder / "j.3.error.png")) << "the frame passes now";
}

TEST_F(CompareSequence, a_frame_that_cannot_be_compared_ends_with_3_and_the_others_are_compared) {
  const std::string xml = folder / "j.xml", page = folder / "r.html";
  const Options words{result, reference, "--max-rmse", "0.2", "--junit", xml, "--report", page};
  const auto expect_report = [&](const char* error) {
    const Finished finished = compare(words);
    EXPECT_EQ(finished.code, 3);
    EXPECT_THAT(finished.err, AllOf(HasSubstr(error), HasSubstr("frame 3: rmse is 0.25")));
    EXPECT_THAT(read_bytes(xml), AllOf(HasSubstr("tests=\"4\" failures=\"1\" errors=\"1\""),
                                       HasSubstr("name=\"2\">\n    <error message="), HasSubstr(error)));
    const json verdict = report_in(page)["verdict"];
    EXPECT_EQ(verdict["pass"], false);
    EXPECT_EQ(verdict["failed"][0]["frame"], "2");
    const json told = json::parse(compare(joined(words, {"--json"})).out);
    EXPECT_EQ(told["pass"], false);
    EXPECT_EQ(told["frames"].size(), 3);
    EXPECT_THAT(told["failed"][0]["error"].get<std::string>(), HasSubstr(error));
  };
  write_bytes(folder / "truth.0002.exr", "damaged");
  expect_report("truth.0002.exr");
  fs::remove(folder / "truth.0002.exr");
  expect_report("truth.####.exr: frames are missing: 2");
}

TEST_F(Compare, a_frame_of_a_list_without_its_reference_is_an_error_of_its_own) {
  const std::string list = folder / "list.toml", page = folder / "r.html";
  for (const char* name : {"hall.exr", "yard.exr"}) exr(name, {{"Y", ramp}});
  write_bytes(list,
              "[[frame]]\nname = 'hall'\ninput = 'x'\nreference = 'gone.exr'\n"
              "[[frame]]\nname = 'yard'\ninput = 'x'\nreference = 'hall.exr'\n");
  const Options words{folder / "{name}.exr", list, "--junit", folder / "j.xml", "--report", page};
  EXPECT_EQ(compare(words).code, 3);
  EXPECT_THAT(read_bytes(folder / "j.xml"),
              AllOf(HasSubstr("name=\"yard\"></testcase>"), HasSubstr("<error message=")));
  EXPECT_EQ(report_in(page)["title"], "2 frames against list.toml") << "and no place for names";
}

TEST_F(Compare, a_frame_of_a_list_that_names_no_reference_fails_alone_and_is_in_the_table) {
  const std::string list = folder / "list.toml", xml = folder / "j.xml";
  for (const char* name : {"hall.exr", "yard.exr"}) exr(name, {{"Y", ramp}});
  write_bytes(list,
              "[[frame]]\nname = 'hall'\ninput = 'x'\n"
              "[[frame]]\nname = 'yard'\ninput = 'x'\nreference = 'hall.exr'\n");
  const Finished finished = compare({folder / "{name}.exr", list, "--junit", xml});
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.out, AllOf(HasSubstr("hall not compared\n"), HasSubstr("worst: frame yard")));
  EXPECT_THAT(finished.err, HasSubstr("frame hall has neither"));
  EXPECT_THAT(read_bytes(xml), AllOf(HasSubstr("name=\"yard\"></testcase>"), HasSubstr("frame hall has neither")));
  write_bytes(list, "[[frame]]\nname = 'hall'\ninput = 'x'\n");
  const json told = measured({folder / "{name}.exr", list}, 3);
  EXPECT_EQ(told["failed"].size(), 1);
  EXPECT_EQ(told["pass"], false);
}

TEST_F(Compare, junit_says_what_the_exit_code_says_of_holes) {
  Plane hole = ramp;
  hole[7] = kNan;
  const std::string a = exr("a.exr", {{"Y", hole}}), b = exr("b.exr", {{"Y", ramp}}), xml = folder / "j.xml";
  EXPECT_EQ(compare({a, b, "--junit", xml}).code, 0);
  EXPECT_THAT(read_bytes(xml), HasSubstr("failures=\"0\""));
  EXPECT_THAT(names_in(folder.path()), Not(Contains(testing::EndsWith("error.png"))));
  EXPECT_EQ(compare({a, b, "--junit", xml, "--max-rmse", "1"}).code, 6);
  EXPECT_THAT(read_bytes(xml), HasSubstr("failures=\"1\""));
}

TEST_F(Compare, junit_escapes_names_and_writes_over_no_input) {
  const auto a = exr("a&b.exr", {{"Y", ramp}}), b = exr("<b>.exr", {{"Y", ramp}});
  ASSERT_EQ(compare({a, b, "--junit", folder / "j.xml"}).code, 0);
  EXPECT_THAT(read_bytes(folder / "j.xml"),
              AllOf(HasSubstr("a&amp;b.exr"), HasSubstr("&lt;b&gt;.exr"), Not(HasSubstr("<b>"))));
  const auto none = exr("no\xef\xbf\xbe-xml\xef\xbf\xbf.exr", {{"Y", ramp}});
  ASSERT_EQ(compare({none, b, "--junit", folder / "j.xml"}).code, 0);
  EXPECT_THAT(read_bytes(folder / "j.xml"), HasSubstr("no\xef\xbf\xbd-xml\xef\xbf\xbd.exr"));
  const std::string taken = folder / "j._b__exr.error.png";
  fs::copy_file(a, taken);
  expect_error(2, {taken, b, "--junit", folder / "j.xml"}, {"--junit"});
  std::string frames;
  for (const std::string name : {"a b", "a_b"}) {
    fs::copy_file(a, folder / name + ".exr");
    frames += "[[frame]]\nname = '" + name + "'\ninput = 'x'\nreference = 'a&b.exr'\n";
  }
  write_bytes(folder / "list.toml", frames);
  expect_error(2, {folder / "{name}.exr", folder / "list.toml", "--junit", folder / "j.xml"},
               {"frame a b", "frame a_b"});
}

// Lists of frames.

TEST_F(Compare, frames_of_a_list_have_names_and_limits_of_their_own_and_no_flicker) {
  exr("hall.exr", {{"Y", with_left(constant(0.5f), 0.75f)}});
  exr("yard.exr", {{"Y", constant(0.6f)}});
  exr("grey.exr", {{"Y", constant(0.5f)}});
  const std::string list = folder / "frames.toml", page = folder / "page.html", results = folder / "{name}.exr";
  write_bytes(list,
              "[[frame]]\nname = 'hall'\ninput = 'x'\nreference = 'grey.exr'\nmax-rmse = 0.2\n"
              "[[frame]]\nname = 'yard'\ninput = 'x'\ntruth = ['grey.exr', 'grey.exr']\n");
  EXPECT_EQ(compare({results, list, "--max-rmse", "0.11", "--report", page}).code, 0) << "the frame's own limit wins";
  const json shown = report_in(page);
  EXPECT_EQ(shown["sequence"]["worst_frame"], "hall");
  EXPECT_FALSE(shown["sequence"].contains("flicker"));
  EXPECT_EQ(shown["images"][1]["frame"], "yard");
  const json told = measured({results, list});
  EXPECT_EQ(told["frames"][0]["frame"], "hall");
  EXPECT_NEAR(told["frames"][1]["rmse"], 0.1, 1e-6) << "of the truth where there is no reference";
  expect_error(6, {results, list, "--max-rmse", "0.09"}, {"frame yard: rmse is 0.1"});
  expect_error(2, {folder / "hall.exr", list}, {"{name}"});
  expect_error(2, {results, list, "--frames", "1-2"}, {"--frames 1-2", "unlike frames"});
  const std::string hall = "[[frame]]\nname = 'hall'\ninput = 'x'\nreference = 'grey.exr'\n";
  const std::string yard = "[[frame]]\nname = 'yard'\ninput = 'x'\nreference = 'grey.exr'\nmax-rmse = 1\n";
  write_bytes(list, hall + "max-excluded = 0.5\n" + yard);
  EXPECT_EQ(measured({results, list})["limits"][0]["option"], "--max-excluded") << "that one frame has";
  write_bytes(list, hall + "max-grain = 0.1\n");
  expect_error(2, {results, list}, {"--max-grain 0.1", "--depth"});
  for (const char* limit : {"max-rmse = -1", "min-ssim = 7", "max-excluded = 1.5"}) {
    write_bytes(list, hall + limit + "\n");
    expect_error(3, {results, list}, {std::string(limit).substr(0, 8), "range"});
  }
  write_bytes(list, "[[frame]]\nname = 'hall'\ninput = 'x'\n");
  expect_error(3, {results, list}, {"frame hall has neither \"reference\" nor \"truth\""});
  expect_error(3, {folder / "none.exr", ""}, {"none.exr"});
}

TEST_F(CompareSequence, the_report_is_one_page_with_pictures) {
  const std::string page = folder / "page.html";
  EXPECT_EQ(compare({result, reference, "--report", page, "--max-rmse", "0.2"}).code, 6);
  const std::string html = read_bytes(page);
  EXPECT_THAT(html, AllOf(HasSubstr("<html"), HasSubstr("\"kind\": \"compare\""), HasSubstr("data:image/png;base64,")));
  EXPECT_THAT(html, HasSubstr("ao.%04d.exr against truth.####.exr"));
  const json shown = report_in(page), told = measured({result, reference});
  EXPECT_EQ(shown["sequence"]["flicker"], told["flicker"]);
  EXPECT_EQ(shown["sequence"]["worst_frame"], std::to_string(told["worst"]["frame"].get<int>()));
  for (const char* list : {"candidates", "rows"})
    for (const auto& row : shown[list]) EXPECT_FALSE(row.contains("flicker")) << "it is that of the sequence: " << row;
}

TEST_F(Compare, files_of_one_name_are_told_apart_on_the_page) {
  const std::string page = folder / "page.html";
  for (const char* place : {"old", "new"}) fs::create_directory(folder / place);
  const auto a = exr("old/ao.exr", {{"Y", box}}), b = exr("new/ao.exr", {{"Y", ramp}});
  ASSERT_EQ(compare({a, b, "--report", page}).code, 0);
  EXPECT_THAT(read_bytes(page), AllOf(HasSubstr("\"title\": \"" + a + " against " + b), HasSubstr("\"name\": \"" + a)));
}

TEST_F(CompareSequence, folders_of_a_page_are_made_and_one_that_cannot_be_ends_with_4_before_any_work) {
  EXPECT_EQ(compare({result, reference, "--report", folder / "some/new/page.html"}).code, 0);
  EXPECT_TRUE(fs::exists(folder / "some/new/page.html"));
  write_bytes(folder / "file", "");
  expect_error(4, {result, reference, "--report", folder / "file/page.html"}, {"file/page.html", "--report"});
}

}  // namespace
}  // namespace alcove::compare_test
