// What a good run leaves behind: the AO file, the composite, the preview and the statistics.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/png.h"
#include "core/options/options.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove::outputs_test {
namespace {

using namespace test;

TEST_F(CommandLine, ao_is_one_half_channel_with_the_windows_and_attributes_of_the_input) {
  const Window display{0, 0, 64, 36};
  for (const Window& data : {display, Window{-8, -4, 80, 44}, Window{10, 6, 40, 24}})
    for (const double aspect : {1.0, 2.0}) {
      FrameFile input = wall_frame(data, display, aspect);
      input.attributes = {{"owner", "a studio"}, {"sceneTimeCode", "01:02:03:04"}, {"comments", "ü"}};
      input.write(frame);
      write_bytes(camera, wall_camera(display, aspect).dump());
      done();
      ExrHeader header = read_header(ao);
      const ExrHeader before = read_header(frame);
      EXPECT_THAT(channels_in(header), ElementsAre(HeaderChannel{"Y", 1}));
      EXPECT_EQ(header["compression"].bytes, std::string(1, 3)) << "3: ZIP";
      EXPECT_EQ(header["lineOrder"].bytes, std::string(1, 0)) << "0: increasing";
      EXPECT_EQ(text_in(header, "alcove/input"), "wall.0042.exr");
      EXPECT_THAT(text_in(header, "alcove/version"), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
      EXPECT_THAT(text_in(header, "alcove/options"), testing::MatchesRegex("[0-9a-f]{16}"));
      EXPECT_NE(text_in(header, "alcove/device"), "(none)");
      for (const auto& [name, attribute] : before)
        if (name != "channels") EXPECT_EQ(header[name].bytes, attribute.bytes) << name << " over " << to_string(data);
      for (const auto& [name, attribute] : header)
        EXPECT_TRUE(before.contains(name) || name.starts_with("alcove/")) << name << " is new";
    }
}

TEST_F(CommandLine, ao_is_open_above_and_dark_in_the_corner_whatever_the_data_window) {
  for (const Window& data : {kWallWindow, Window{-8, -4, 80, 44}, Window{10, 6, 40, 26}}) {
    wall_frame(data).write(frame);
    const Image image = computed({});
    const auto at = [&](int x, int y) {
      return image.pixels[std::size_t(y - data.y) * std::size_t(data.width) + std::size_t(x - data.x)];
    };
    EXPECT_NEAR(at(32, 9), 1, 1e-3) << "the open wall, " << to_string(data);
    EXPECT_LT(at(32, 27), 0.75) << "the wall just above the floor, " << to_string(data);
    EXPECT_GT(at(32, 27), 0.3) << to_string(data);
    for (const float value : image.pixels) EXPECT_TRUE(value >= 0 && value <= 1) << value;
  }
}

TEST_F(CommandLine, type_and_compression_are_as_asked) {
  const Image exact = computed({"--set", "compression=none"});
  ExrHeader header = read_header(ao);
  EXPECT_THAT(channels_in(header), ElementsAre(HeaderChannel{"Y", 2}));
  EXPECT_EQ(header["compression"].bytes, std::string(1, 0));
  done({"--set", "compression=piz"});
  EXPECT_EQ(read_header(ao)["compression"].bytes, std::string(1, 4));
  const Image rounded = read_exr_image(ao);
  for (std::size_t i = 0; i < exact.pixels.size(); i++) ASSERT_NEAR(rounded.pixels[i], exact.pixels[i], 0x1p-12) << i;
}

/// A frame with beauty, its AO as float and its composite.
struct Composite {
  Image input, ao, result;
  std::span<const float> in(const std::string& name) const { return input.plane("ViewLayer." + name); }
};

using Ambient = std::function<double(const std::string& component, std::size_t pixel)>;
/// The composite must be the beauty without what occlusion takes of `ambient`, as precise as that; alpha must be the
/// same bits.
void expect_composite(const Composite& frame, const Ambient& ambient, double precision = 1e-6) {
  const auto alpha = frame.in("Combined.A"), ao = frame.ao.plane("Y"), alpha_after = frame.result.plane("A");
  EXPECT_EQ(std::memcmp(alpha.data(), alpha_after.data(), alpha.size_bytes()), 0) << "alpha has changed";
  for (const std::string component : {"R", "G", "B"}) {
    const auto beauty = frame.in("Combined." + component), result = frame.result.plane(component);
    for (std::size_t i = 0; i < beauty.size(); i++) {
      const double f = 1 - double(alpha[i]) * (1 - double(ao[i])), light = ambient(component, i),
                   expected = beauty[i] - light + light * f;
      ASSERT_NEAR(result[i], expected, precision * (std::abs(expected) + 1))
          << component << " of pixel " << i << ", ao " << ao[i] << ", alpha " << alpha[i];
    }
  }
}

class Composites : public CommandLine {
 protected:
  Composites() { add_beauty(input); }
  Composite compute(const Options& more = {}) {
    input.write(frame);
    done(joined(typed("--set composite-layers=rgba --type float --set compression=none --composite " + composite),
                more));
    return {read_exr_image(frame), read_exr_image(ao), read_exr_image(composite)};
  }
  /// What is stored as half but for the depth.
  void make_half() {
    for (const auto& [name, plane] : input.planes)
      if (!name.ends_with("Depth.Z")) input.halves.insert(name);
  }
  std::string how() const { return text_in(read_header(composite), "alcove/composite"); }

  FrameFile input = wall_frame();
  const std::string composite = folder / "composite.exr";
};

TEST_F(Composites, composite_dims_only_the_ambient_part) {
  for (const bool is_half : {false, true}) {
    if (is_half) make_half();
    const Composite frame = compute();
    const Ambient indirect = [&](const std::string& c, std::size_t i) {
      return double(frame.in("DiffInd." + c)[i]) * frame.in("DiffCol." + c)[i];
    };
    expect_composite(frame, indirect, is_half ? 0x1p-11 : 1e-6);
    EXPECT_THAT(how(), StartsWith("ambient"));
    EXPECT_EQ(text_in(read_header(composite), "alcove/radius"), text_in(read_header(ao), "alcove/radius"));
    const int type = is_half ? 1 : 2;
    EXPECT_THAT(channels_in(read_header(composite)), ElementsAre(HeaderChannel{"A", type}, HeaderChannel{"B", type},
                                                                 HeaderChannel{"G", type}, HeaderChannel{"R", type}));
  }
}

TEST_F(Composites, blender_5_names_mean_the_same_light) {
  const Composite old_names = compute();
  for (const std::string c : {".R", ".G", ".B"}) {
    input.rename("ViewLayer.DiffInd" + c, "ViewLayer.Diffuse Indirect" + c);
    input.rename("ViewLayer.DiffCol" + c, "ViewLayer.Diffuse Color" + c);
  }
  const Composite new_names = compute();
  EXPECT_EQ(old_names.result.pixels, new_names.result.pixels)
      << "the indirect light of Blender is without the surface's colour, under either name";
}

TEST_F(Composites, arnold_indirect_light_holds_the_colour_already) {
  for (const std::string c : {".R", ".G", ".B"})
    input.rename("ViewLayer.DiffInd" + c, "ViewLayer.diffuse_indirect" + c);
  const Composite frame = compute();
  expect_composite(frame,
                   [&](const std::string& c, std::size_t i) { return double(frame.in("diffuse_indirect." + c)[i]); });
}

TEST_F(Composites, composite_without_parts_is_a_multiply_and_says_so) {
  input.erase(".Diff");
  const Composite frame = compute();
  expect_composite(frame, [&](const std::string& c, std::size_t i) { return double(frame.in("Combined." + c)[i]); });
  EXPECT_THAT(how(), StartsWith("multiply"));
}

TEST_F(Composites, the_whole_beauty_that_is_asked_for_is_no_warning) {
  input.erase(".Diff");
  const Composite plain = compute();
  const Options words{"--composite", composite, "--set", "composite-layers=rgba"};
  EXPECT_THAT(done(words).err, HasSubstr("[no-indirect-light]"));
  Options asked = words;
  asked.insert(asked.end(), {"--set", "ambient=beauty"});
  EXPECT_THAT(done(asked).err, Not(HasSubstr("[no-indirect-light]")));
  EXPECT_THAT(how(), StartsWith("multiply"));
  EXPECT_EQ(read_exr_image(composite).pixels, plain.result.pixels);
  EXPECT_THAT(run({"--composite", composite, "--set", "ambient=R,G,B"}).err,
              AllOf(HasSubstr("--set ambient takes a layer"), Not(HasSubstr("channel names"))));
}

TEST_F(Composites, a_beauty_whose_alpha_is_0_everywhere_is_a_warning) {
  compute();
  EXPECT_THAT(done({"--composite", composite}).err, Not(HasSubstr("[transparent-beauty]")));
  input.change("Combined.A", [](float) { return 0.f; });
  compute();
  EXPECT_THAT(done({"--composite", composite}).err, AllOf(HasSubstr("alpha is 0"), HasSubstr("[transparent-beauty]")));
}

TEST_F(Composites, the_help_of_an_option_says_exr_where_it_reads_no_other_picture) {
  compute();
  const std::string png = folder / "x.png";
  const std::size_t pixels = kWallWindow.pixels();
  const std::vector<float> colors(3 * pixels, 0.5f);
  const auto bytes = encode_png("x", kWallWindow.width, kWallWindow.height, 3, colors);
  write_bytes(png, {bytes.begin(), bytes.end()});
  const auto says_exr = [](const char* key) {
    const SettingRow& row = row_of_key(key);
    return (row.value + row.sentence).find("EXR") != std::string::npos || row.value.find(".exr") != std::string::npos;
  };
  for (const char* key : {"beauty", "matte", "material-ao", "normal", "position", "albedo", "objects", "motion",
                          "behind", "depth", "deep", "environment"}) {
    const SettingRow& row = row_of_key(key);
    const bool names_png = row.sentence.find("PNG") != row.sentence.npos;
    const Options words =
        row.is_only_key() ? Options{"--set", fmt::format("{}={}", key, png)} : Options{row.long_name(), png};
    const Options reader = row.key() == "albedo"    ? Options{"--set", "multi-bounce=true"}
                           : row.key() == "objects" ? Options{"--set", "occluders=wall"}
                           : row.key() == "motion"  ? Options{"--around", "1"}
                                                    : Options();
    const Options all = joined(joined(words, reader), {"--set", "composite-layers=rgba", "--composite", composite});
    const std::string said = run(all).err;
    const bool is_refused_as_png = said.find("deep data") != said.npos || said.find("takes an .exr") != said.npos ||
                                   said.find("not an EXR") != said.npos;
    EXPECT_EQ(is_refused_as_png, says_exr(key) && !names_png) << key << ": " << said;
  }
}

TEST_F(Composites, what_inspect_proposes_for_a_beauty_without_parts_is_taken_by_strict) {
  input.erase(".Diff");
  compute();
  const Options words{"inspect", frame, "--camera", camera, "--beauty", frame, "--json"};
  const std::string command = json::parse(run_well(words).out)["command"];
  Options proposed = typed(command);
  proposed.erase(proposed.begin());
  const Finished finished = run_program(joined(proposed, {"--strict"}), {.folder = folder.path()});
  EXPECT_EQ(finished.code, 0) << command << finished;
  EXPECT_TRUE(fs::exists(folder / "composite.exr"));
}

class FrameLists : public Composites {
 protected:
  FrameLists() { input.write(frame); }

  std::string entry(const std::string& name, const std::string& file, const std::string& camera_name = "camera.json",
                    const std::string& more = "radius = 1\n") const {
    return fmt::format("[[frame]]\nname = '{}'\ninput = '{}'\ncamera = '{}'\n{}", name, file, folder / camera_name,
                       more);
  }
  Finished run_list(const std::string& entries, const Options& more = {}) const {
    write_bytes(list, entries);
    fs::remove(good);
    return run_program(joined({"run", list, "-o", folder / "{name}.exr"}, more));
  }

  const std::string list = folder / "list.toml", good = folder / "good.exr", lost = folder / "in.lost.exr";
};

TEST_F(FrameLists, are_computed_by_their_own_cameras_and_radii) {
  const auto radius_of = [&](const Options& more) {
    const Finished finished = run_list(entry("wall", frame, "camera.json", "radius = 0.25\n"), more);
    EXPECT_EQ(finished.code, 0) << finished;
    return text_in(read_header(folder / "wall.exr"), "alcove/radius");
  };
  EXPECT_EQ(radius_of({"--source", "auto"}), "0.25");
  EXPECT_EQ(radius_of({"--radius", "0.5"}), "0.5") << "what is typed wins";
  EXPECT_EQ(radius_of({"--set", "radius=0.5"}), "0.5");
  EXPECT_EQ(radius_of({"--fov", "60", "--normal", "none"}), "0.25");
  test::expect_refused(run_program({"run", list, "-o", folder / "ao.exr"}), 2, {"--output", "{name}"});
}

TEST_F(FrameLists, have_no_frame_that_writes_over_what_another_one_reads) {
  const std::string other = folder / "b.exr";
  fs::copy_file(frame, other);
  const std::string before = read_bytes(other);
  test::expect_refused(run_list(entry("b", frame) + entry("c", other)), 2, {"--output of frame b", "b.exr"});
  EXPECT_EQ(read_bytes(other), before);
  EXPECT_FALSE(fs::exists(folder / "c.exr"));
  test::expect_refused(run_list(entry("d", frame) + entry("old-d", frame), {"--matte", folder / "old-{name}.exr"}), 2,
                       {"--output of frame old-d", "--matte"});
  test::expect_refused(run_list(entry("b", list)), 3, {"frame b", "is a list itself"});
}

TEST_F(FrameLists, with_a_bad_frame_end_before_any_work_or_go_on_where_they_are_told_to) {
  const std::string bad = folder / "bad.0001.exr";
  const auto expect_code = [&](int code, const std::string& entries, const Options& more = {}) {
    const Finished finished = run_list(entries, more);
    EXPECT_EQ(finished.code, code) << entries << finished;
    EXPECT_EQ(fs::exists(good), code < 2) << entries;
    return finished.err;
  };
  for (const std::string& input : {lost, folder / "in.lost.####.exr"}) {
    const std::string entries = entry("lost", input) + entry("good", frame);
    EXPECT_THAT(expect_code(3, entries), HasSubstr("lost"));
    expect_code(1, entries, {"--keep-going"});
    expect_code(0, entries, {"--set", "missing=skip"});
  }
  expect_code(3, entry("good", frame) + entry("lost", lost));  // a missing input is known before any work
  write_bytes(bad, "no EXR");
  expect_code(3, entry("bad", bad) + entry("good", frame));
  EXPECT_THAT(expect_code(1, entry("bad", bad) + entry("good", frame), {"--keep-going"}), HasSubstr("bad.0001.exr"));
  test::expect_refused(run_list(entry("shot", folder / "bad.####.exr") + entry("bad.0001", frame)), 2,
                       {"--output of frame bad.0001", "bad.0001.exr"});
}

TEST_F(FrameLists, may_miss_the_inputs_of_frames_only) {
  const Options skip{"--set", "missing=skip"};
  const std::string misspelt = entry("misspelt", frame, "camrea.json") + entry("good", frame);
  test::expect_refused(run_list(misspelt, skip), 3, {"misspelt", "camrea.json"});
  EXPECT_EQ(run_list(misspelt, joined(skip, {"--keep-going"})).code, 1);
  EXPECT_TRUE(fs::exists(good));
  const Options without_beauty{"--beauty", folder / "lost.exr", "--composite", folder / "{name}.c.exr"};
  test::expect_refused(run_list(entry("good", frame), joined(skip, without_beauty)), 3, {"lost.exr"});
  const Finished all_lost = run_list(entry("lost", lost), skip);
  EXPECT_EQ(all_lost.code, 3) << all_lost;
  EXPECT_THAT(all_lost.err, HasSubstr("list.toml: the input of each frame is missing"));
}

TEST_F(FrameLists, end_at_once_by_what_is_no_frames_fault) {
  const std::string two = entry("a", frame) + entry("b", frame), settings = folder / "look.toml";
  write_bytes(folder / "file", "");
  write_bytes(list, two);
  for (const auto& [code, more] : {std::pair<int, Options>{4, {"-o", folder / "file/{name}.exr"}},
                                   {5, {"-o", folder / "{name}.exr", "--device", "none such"}}}) {
    const Finished finished = run_program(joined({"run", list, "--keep-going"}, more));
    EXPECT_EQ(finished.code, code) << finished;
    EXPECT_THAT(finished.err, AllOf(HasSubstr("frame a"), Not(HasSubstr("frame b"))));
  }
  write_bytes(settings, "slices = 2\n");
  const Finished told = run_list(two, {"--keep-going", "--preset", settings});
  EXPECT_EQ(told.code, 0) << told;
  const std::size_t first = told.err.find("settings of");
  EXPECT_NE(first, std::string::npos) << told;
  EXPECT_EQ(told.err.find("settings of", first + 1), std::string::npos) << told;
  const Finished lacks = run_list(entry("a", frame) + entry("b", frame, "camera.json", ""), {"--keep-going"});
  EXPECT_EQ(lacks.code, 2) << lacks;
  EXPECT_THAT(lacks.err, HasSubstr("frame b: missing:"));
}

TEST_F(Composites, a_dry_run_refuses_a_display_configuration_that_is_not_there) {
  compute();
  const Options words{"--composite", composite, "--preview", folder / "p.png", "--set", "ocio=/none/show.ocio"};
  test::expect_refused(run(joined(words, {"--dry-run"})), 3, {"/none/show.ocio", "--set ocio"});
}

TEST_F(Composites, beauty_of_its_own_file_keeps_that_files_attributes) {
  FrameFile beauty{kWallWindow, kWallWindow, 1, {}, {}, {{"grade", "none"}}};
  for (const std::string c : {"R", "G", "B", "A"}) beauty.planes[c] = input.planes.at("ViewLayer.Combined." + c);
  beauty.write(folder / "beauty.exr");
  done({"--beauty", folder / "beauty.exr", "--composite", composite, "--set", "composite-layers=rgba"});
  EXPECT_EQ(text_in(read_header(composite), "grade"), "none");
  EXPECT_EQ(text_in(read_header(ao), "grade"), "(none)");
  const Image before = read_exr_image(folder / "beauty.exr", {"A"}), after = read_exr_image(composite, {"A"});
  EXPECT_EQ(std::memcmp(before.pixels.data(), after.pixels.data(), 4 * before.pixels.size()), 0);
}

TEST_F(Composites, nothing_that_leaves_is_nan_or_infinite_and_repairs_are_counted) {
  const float nan = std::nanf(""), inf = INFINITY;
  const auto spoil = [&](const char* name, std::size_t pixel, float value) {
    input.planes.at(std::string("ViewLayer.") + name)[pixel] = value;
  };
  spoil("Depth.Z", 100, nan);
  spoil("Depth.Z", 101, -1);
  spoil("Normal.X", 202, nan);
  spoil("Combined.R", 1900, nan);
  spoil("Combined.G", 1901, inf);
  spoil("DiffInd.B", 1902, -inf);
  spoil("Combined.A", 1903, nan);
  const Composite frame = compute({"--stats", folder / "stats.json"});
  for (const Image* image : {&frame.ao, &frame.result})
    for (std::size_t i = 0; i < image->pixels.size(); i++)
      EXPECT_TRUE(std::isfinite(image->pixels[i]))
          << image->pixels[i] << " in " << image->names[i / kWallWindow.pixels()] << " of pixel "
          << i % kWallWindow.pixels();
  EXPECT_EQ(json::parse(read_bytes(folder / "stats.json"))["frames"][0]["repaired_pixels"], 7)
      << "pixels 100, 101, 202 and 1900 to 1903";
}

TEST_F(Composites, a_composite_beyond_half_stays_finite) {
  for (const char* name : {"ViewLayer.DiffInd.R", "ViewLayer.DiffCol.R"})
    input.planes[name].assign(kWallWindow.pixels(), 60000);
  make_half();
  const Composite frame = compute();
  for (const float value : frame.result.pixels) ASSERT_TRUE(std::isfinite(value)) << value;
}

TEST_F(CommandLine, preview_is_a_png_of_the_display_windows_size) {
  wall_frame({-8, -4, 80, 44}).write(frame);
  done({"--preview", folder / "preview.png"});
  const std::string png = read_bytes(folder / "preview.png");
  ASSERT_GT(png.size(), 33);
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(12, 4), "IHDR");
  EXPECT_EQ(png.substr(16, 10), std::string("\0\0\0\x40\0\0\0\x24\x08\0", 10)) << "64 x 36, 8 bits, grey";
}

TEST_F(CommandLine, stats_have_the_documented_fields_and_add_up) {
  FrameFile input = wall_frame();
  for (std::size_t i = 0; i < 64; i++) input.planes["ViewLayer.Depth.Z"][i] = 1e10f;  // one line of 36 is sky
  input.write(frame);
  const json stats = stats_of(typed("--slices 2 --steps 5 --set stride=2 --set density=uniform --set power=1.5"));
  const json one = stats.at("frames").at(0), totals = stats.at("totals");
  EXPECT_TRUE(stats.at("device").is_string());
  EXPECT_EQ(stats.at("options"), text_in(read_header(ao), "alcove/options"));
  EXPECT_EQ(stats.at("frames").size(), 1);
  EXPECT_EQ(one.at("frame"), 42);
  EXPECT_EQ(one.at("input"), frame);
  EXPECT_EQ(one.at("output"), ao);
  double sum = 0;
  std::vector<std::string> passes;
  for (const auto& pass : one.at("passes")) {
    sum += pass.at("ms").get<double>();
    EXPECT_GT(pass.at("ms"), 0);
    passes.push_back(pass.at("name"));
  }
  EXPECT_THAT(passes, ElementsAre("prepare", "reconstruct", "sites", "classify", "list_sites", "chains", "chain_ends",
                                  "backs", "horizon", "completion", "interpolate", "interpolate", "shape"));
  const json& ms = one.at("ms");
  EXPECT_NEAR(ms.at("compute"), sum, 1e-9 * sum);
  for (const char* name : {"read", "compute", "write"}) EXPECT_GT(ms.at(name), 0) << name;
  EXPECT_GE(ms.at("total").get<double>(), ms.at("read").get<double>() + ms.at("write").get<double>());
  EXPECT_NEAR(one.at("samples_per_pixel"), 2 * 2 * 5 / 2.0 * 35.0 / 36, 1e-9);
  EXPECT_EQ(one.at("repaired_pixels"), 0);
  EXPECT_EQ(one.at("parts"), 1);
  // of 64 x 36 pixels
  EXPECT_EQ(one.at("tiles"), json({{"total", 40}, {"sky", 0}, {"proved", 0}, {"kept", 0}, {"computed", 40}}));
  EXPECT_EQ(totals.at("frames"), 1);
  EXPECT_EQ(totals.at("failed"), 0);
  for (const char* name : {"wall_s", "cpu_s", "peak_rss_mb"}) EXPECT_GT(totals.at(name), 0) << name;
}

}  // namespace
}  // namespace alcove::outputs_test
