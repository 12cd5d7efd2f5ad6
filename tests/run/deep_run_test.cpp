// Runs with deep files: the bits of --behind, a frame of samples alone, crops and tiles, what inspect says, and every
// mistake in files and options.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/formats/exr.h"
#include "tests/support/command_line.h"
#include "tests/support/deep_file.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

using Options = std::vector<std::string>;

/// A plate before the wall and the floor, and what lies behind them, as peels and as samples.
class DeepRun : public CommandLine {
 protected:
  DeepRun() {
    FrameFile wall = wall_frame();
    std::vector<float>& z = wall.planes.at("ViewLayer.Depth.Z");
    for (std::size_t i = 0; i < z.size(); i++) {
      const int x = int(i) % kWallWindow.width, y = int(i) / kWallWindow.width;
      const bool is_plate = x >= 20 && x < 40 && y >= 8 && y < 28;
      second.push_back(is_plate ? z[i] : 9 + 0.5F * float(i % 3));
      third.push_back(is_plate ? 8.25F : 0);
      if (is_plate) z[i] = 2.5F;
    }
    first = z;
    wall.write(frame);
    write_layer("second.exr", second);
    write_layer("third.exr", third);
    write_layer("flat.exr", first);
    write_deep(deep, {samples()});
  }

  /// Every surface as an opaque sample, in no order; each times its pixel's factor.
  DeepFilePart samples(const std::vector<float>& factors = {}) const {
    DeepFilePart part;
    part.data = kWallWindow;
    for (std::size_t i = 0; i < first.size(); i++) {
      const float by = factors.empty() ? 1 : factors[i];
      part.pixels.push_back({{1, second[i] * by}, {1, first[i] * by}, {0.25F, 2 * by}});
      if (third[i] > 0) part.pixels.back().insert(part.pixels.back().begin(), {1, third[i] * by});
    }
    return part;
  }

  /// The length of each pixel's ray, of unit depth.
  static std::vector<float> rays() {
    std::vector<float> lengths;
    for (int y = 0; y < kWallWindow.height; y++)
      for (int x = 0; x < kWallWindow.width; x++)
        lengths.push_back(float(std::sqrt(1 + std::pow((x + 0.5 - 32) / 60, 2) + std::pow((y + 0.5 - 18) / 60, 2))));
    return lengths;
  }

  void write_layer(const std::string& name, const std::vector<float>& z) const {
    FrameFile layer;
    layer.planes["Z"] = z;
    layer.write(folder / name);
  }

  std::vector<float> pixels_of(const std::string& path) const { return read_exr_image(path).pixels; }

  std::vector<float> result(const Options& more) const {
    Options options{"--type", "float"};
    options.insert(options.end(), more.begin(), more.end());
    const Finished finished = run(options);
    EXPECT_EQ(finished.code, 0) << finished;
    return finished.code == 0 ? pixels_of(ao) : std::vector<float>();
  }

  /// A run of files of its own.
  Finished run_on(const Options& inputs) const {
    Options options{"run"};
    options.insert(options.end(), inputs.begin(), inputs.end());
    options.insert(options.end(), {"-o", ao, "--camera", camera, "--radius", "1", "--type", "float"});
    return run_program(options);
  }

  void expect_refused(const Finished& finished, const std::vector<std::string>& words, int code = 3) const {
    EXPECT_EQ(finished.code, code) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    for (const auto& word : words) EXPECT_THAT(finished.err, HasSubstr(word));
  }

  const std::string deep = folder / "deep.exr";
  std::vector<float> first, second, third;
};

TEST_F(DeepRun, peels_as_samples_give_the_bits_of_behind) {
  const auto behind =
      result({"--aov", "ao,hidden", "--behind", folder / "second.exr", "--behind", folder / "third.exr"});
  EXPECT_TRUE(std::ranges::find(behind, 8.25F) != behind.end()) << "or else nothing was shown";
  EXPECT_TRUE(result({"--aov", "ao,hidden", "--deep", deep}) == behind);
  const Options peels{"--search", "exact", "--behind", folder / "second.exr", "--behind", folder / "third.exr"};
  EXPECT_TRUE(result({"--search", "exact", "--deep", deep}) == result(peels));
  DeepFilePart tiles = samples();
  tiles.is_tiled = true;
  tiles.tile = 16;
  write_deep(deep, {tiles});
  EXPECT_TRUE(result({"--aov", "ao,hidden", "--deep", deep}) == behind);
}

TEST_F(DeepRun, samples_along_the_ray_are_told_by_the_flat_depth) {
  const auto planar = result({"--deep", deep, "--aov", "hidden"});
  write_deep(deep, {samples(rays())});
  const auto along = result({"--deep", deep, "--aov", "hidden"});
  ASSERT_EQ(along.size(), planar.size());
  for (std::size_t i = 0; i < along.size(); i++)
    ASSERT_NEAR(along[i] / (planar[i] + 1), planar[i] / (planar[i] + 1), 1e-5) << i;
}

TEST_F(DeepRun, crops_and_tiles_of_a_large_frame_have_the_bits_of_the_whole) {
  const auto whole = result({"--deep", deep});
  const auto crop = result({"--deep", deep, "--roi", "16,5,30,20"});
  const Image image = read_exr_image(ao);
  ASSERT_EQ(image.data.width, 30);
  for (int y = 0; y < image.data.height; y++)
    for (int x = 0; x < image.data.width; x++)
      ASSERT_EQ(crop[std::size_t(y * 30 + x)], whole[std::size_t((y + image.data.y) * 64 + x + image.data.x)]);
}

TEST_F(DeepRun, samples_alone_are_a_frame) {
  const Finished flat =
      run_on({folder / "flat.exr", "--behind", folder / "second.exr", "--behind", folder / "third.exr"});
  ASSERT_EQ(flat.code, 0) << flat;
  const auto expected = pixels_of(ao);
  for (const Options& inputs : {Options{deep}, Options{"--depth", deep}, Options{"--deep", deep}}) {
    const Finished finished = run_on(inputs);
    ASSERT_EQ(finished.code, 0) << finished;
    EXPECT_TRUE(pixels_of(ao) == expected) << inputs[0];
  }
}

TEST_F(DeepRun, elements_of_several_files_give_the_bits_of_all_samples_in_one) {
  EXPECT_EQ(run_on({deep}).code, 0);
  const std::vector<float> expected = pixels_of(ao);
  // Each pixel's samples are dealt out in turn; the second file has lost its rows above and below, and its columns, in
  // which the first one has all samples; it has other lines together.
  const DeepFilePart all = samples();
  DeepFilePart one = all, other = all;
  other.data = {5, 9, 40, 20};
  other.compression = Imf::RLE_COMPRESSION;
  other.pixels.clear();
  for (std::size_t i = 0; i < all.pixels.size(); i++) {
    const int x = int(i) % kWallWindow.width - other.data.x, y = int(i) / kWallWindow.width - other.data.y;
    if (x < 0 || x >= other.data.width || y < 0 || y >= other.data.height) continue;
    one.pixels[i].clear();
    other.pixels.emplace_back();
    for (std::size_t s = 0; s < all.pixels[i].size(); s++)
      (s % 2 ? one.pixels[i] : other.pixels.back()).push_back(all.pixels[i][s]);
  }
  const std::string a = folder / "a.exr", b = folder / "b.exr";
  for (const bool is_tiled : {false, true}) {
    other.is_tiled = is_tiled;
    other.tile = 7;
    write_deep(a, {one}, kWallWindow);
    write_deep(b, {other}, kWallWindow);
    for (const Options& inputs : {Options{a, "--deep", b}, {b, "--deep", a}, {"--deep", a, "--deep", b}}) {
      const Finished finished = run_on(inputs);
      EXPECT_EQ(finished.code, 0) << finished;
      EXPECT_TRUE(pixels_of(ao) == expected) << testing::PrintToString(inputs) << is_tiled;
    }
    EXPECT_TRUE(result({"--deep", a, "--deep", b}) == result({"--deep", deep})) << "beside a flat depth";
  }
}

TEST_F(DeepRun, an_element_that_is_not_of_the_picture_is_refused) {
  DeepFilePart small = samples();
  small.data = {0, 0, 64, 20};
  small.pixels.resize(64 * 20);
  write_deep(folder / "small.exr", {small}, small.data);
  expect_refused(run_on({deep, "--deep", folder / "small.exr"}), {"small.exr", "same pixels", "--deep"});
  expect_refused(run_on({deep, "--deep", folder / "flat.exr"}), {"flat.exr", "no deep data", "--deep"});
}

TEST_F(DeepRun, samples_are_the_depth_of_the_frames_around_too) {
  FrameFile normals = wall_frame();
  std::erase_if(normals.planes, [](const auto& plane) { return plane.first.find("Depth") != std::string::npos; });
  json cameras = wall_camera();
  for (int number = 1; number <= 3; number++) {
    normals.write(folder / fmt::format("n.{}.exr", number));
    std::filesystem::copy_file(deep, folder / fmt::format("d.{}.exr", number));
    json matrix = cameras["world_to_camera"];
    matrix[0][3] = -0.2 * number;
    cameras["frames"].push_back({{"frame", number}, {"world_to_camera", matrix}});
  }
  write_bytes(camera, cameras.dump());
  for (const Options& inputs :
       {Options{folder / "n.%d.exr", "--deep", folder / "d.%d.exr"}, Options{folder / "d.%d.exr"}}) {
    Options options{"run"};
    options.insert(options.end(), inputs.begin(), inputs.end());
    options.insert(options.end(), {"-o", folder / "out.%d.exr", "--camera", camera, "--radius", "1", "--around", "1",
                                   "--frames", "2", "--aov", "depth,hidden"});
    const Finished finished = run_program(options);
    ASSERT_EQ(finished.code, 0) << finished;
    EXPECT_THAT(attribute_of_whole_exr(folder / "out.2.exr", "alcove/hidden").value_or(""), HasSubstr("frames 1, 3"));
  }
}

TEST_F(DeepRun, flat_parts_beside_samples_are_the_frame) {
  DeepFilePart flat;
  flat.is_flat = true;
  flat.name = "flat";
  flat.data = kWallWindow;
  flat.channels = {"Z"};
  for (const float z : first) flat.pixels.push_back({{z}});
  write_deep(folder / "both.exr", {samples(), flat});
  ASSERT_EQ(run_on({folder / "flat.exr"}).code, 0);
  const auto plain = pixels_of(ao);
  const Finished finished = run_on({folder / "both.exr"});
  ASSERT_EQ(finished.code, 0) << finished;
  EXPECT_TRUE(pixels_of(ao) == plain) << "samples that nobody asked for are not read";
  ASSERT_EQ(run_on({folder / "both.exr", "--deep", folder / "both.exr", "--aov", "hidden"}).code, 0);
  const auto hidden = pixels_of(ao);
  EXPECT_TRUE(std::ranges::find(hidden, 8.25F) != hidden.end());
}

TEST_F(DeepRun, samples_without_anything_hidden_are_noted) {
  DeepFilePart part = samples();
  for (std::size_t i = 0; i < part.pixels.size(); i++) part.pixels[i] = {{1, first[i]}};
  write_deep(deep, {part});
  const Finished finished = run({"--deep", deep});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.err, HasSubstr("rendered in one go"));
}

/// The samples of a renderer, which end at the first opaque surface: their lists say nothing of what is hidden.
TEST_F(DeepRun, samples_that_end_at_the_first_surface_switch_no_completion_off) {
  DeepFilePart part = samples();
  for (std::size_t i = 0; i < part.pixels.size(); i++) part.pixels[i] = {{1, first[i]}};
  write_deep(deep, {part});
  for (const Options& search : {Options{"--search", "exact"}, Options{"--preset", "reference"}}) {
    Options with = search;
    with.insert(with.end(), {"--deep", deep});
    EXPECT_TRUE(result(with) == result(search)) << search[1];
  }
}

TEST_F(DeepRun, few_surfaces_behind_others_tell_of_no_more) {
  const Options search{"--search", "exact"};
  const auto ao_with = [&](std::size_t lists, const Options& more = {}) {
    DeepFilePart part = samples();
    for (std::size_t i = 0; i < part.pixels.size(); i++) {
      part.pixels[i] = {{1, first[i]}};
      if (i % 16 < lists) part.pixels[i].push_back({1, 50});
    }
    write_deep(deep, {part});
    Options with{"--search", "exact", "--deep", deep};
    with.insert(with.end(), more.begin(), more.end());
    return result(with);
  };
  const auto plain = result(search);
  // What lies beyond the radius hides nothing, but a pixel that lists it and nothing before it has nothing there.
  EXPECT_TRUE(ao_with(7) == plain);
  EXPECT_FALSE(ao_with(9) == plain);
  // The samples of the region alone would tell otherwise.
  const auto whole = ao_with(9);
  const auto crop = ao_with(9, {"--roi", "11,5,4,20"});
  for (int y = 0; y < 20; y++)
    for (int x = 0; x < 4; x++) ASSERT_EQ(crop[std::size_t(y * 4 + x)], whole[std::size_t((y + 5) * 64 + x + 11)]);
}

TEST_F(DeepRun, impossible_opacities_are_noted) {
  DeepFilePart part = samples();
  for (auto& pixel : part.pixels) pixel[0][0] = 1.5F;
  write_deep(deep, {part});
  const Finished finished = run({"--deep", deep});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.err, HasSubstr("opacity"));
}

TEST_F(DeepRun, mistakes_are_refused_in_one_line) {
  expect_refused(run({"--deep", folder / "flat.exr"}), {"flat.exr", "no deep data", "--behind", "--deep"});
  expect_refused(run({"--normal", deep}), {"deep.exr", "deep data", "--normal"});
  expect_refused(run({"--behind", deep}), {"deep.exr", "deep data", "behind-channel"});
  expect_refused(run_program({"compare", deep, folder / "flat.exr"}), {"deep.exr", "deep data"});

  DeepFilePart other = samples(std::vector<float>(first.size(), 3.7F));
  write_deep(folder / "other.exr", {other});
  expect_refused(run({"--deep", folder / "other.exr"}), {"other.exr", "--depth-scale"});

  DeepFilePart small = samples();
  small.data.height = 20;
  small.pixels.resize(64 * 20);
  write_deep(folder / "small.exr", {small}, small.data);
  expect_refused(run({"--deep", folder / "small.exr"}), {"small.exr", "same pixels", "--deep"});

  DeepFilePart without = samples();
  without.channels = {"A", "depth.Z"};
  write_deep(folder / "without.exr", {without});
  expect_refused(run({"--deep", folder / "without.exr"}), {"without.exr", "no Z", "--deep"});

  const std::string bytes = read_bytes(deep);
  write_bytes(folder / "cut.exr", bytes.substr(0, bytes.size() - 100));
  expect_refused(run({"--deep", folder / "cut.exr"}), {"cut.exr", "--deep"});
}

TEST_F(DeepRun, estimators_that_know_no_layers_take_samples_as_the_depth_alone) {
  for (const char* estimator : {"hbao", "crytek"}) {
    const Options with{"--deep", deep, "--estimator", estimator};
    expect_refused(run(with), {"deep.exr", "--estimator gtao or bitmask", "--deep", "--set hidden=0"}, 2);
    Options without_hidden = with;
    without_hidden.insert(without_hidden.end(), {"--set", "hidden=0"});
    EXPECT_TRUE(result(without_hidden) == result({"--estimator", estimator}));
    EXPECT_EQ(run_on({deep, "--estimator", estimator}).code, 0);
  }
}

TEST_F(DeepRun, inspect_lists_the_surfaces_that_there_are) {
  const Finished finished = run_program({"inspect", "--json", frame, "--deep", deep, "--camera", camera});
  ASSERT_EQ(finished.code, 0) << finished;
  const json aovs = json::parse(finished.out)["aovs"];
  EXPECT_TRUE(aovs.contains("behind3")) << "the plate, the wall behind it, and what is behind that";
  EXPECT_FALSE(aovs.contains("behind4"));
}

TEST_F(DeepRun, inspect_looks_at_a_frame_without_samples_that_are_refused) {
  DeepFilePart small = samples();
  small.data.height = 20;
  small.pixels.resize(64 * 20);
  write_deep(folder / "small.exr", {small}, small.data);
  const Finished finished =
      run_program({"inspect", "--json", frame, "--deep", folder / "small.exr", "--camera", camera});
  ASSERT_EQ(finished.code, 0) << finished;
  const json found = json::parse(finished.out);
  EXPECT_THAT(found["refused"].dump(), HasSubstr("same pixels"));
  EXPECT_THAT(found["missing"].dump(), Not(HasSubstr("same pixels")));
  EXPECT_EQ(found["depth"]["kind"], "planar");
  EXPECT_EQ(found["deep"].size(), 1);
  EXPECT_EQ(found["command"], "") << "a run would fail";
}

TEST_F(DeepRun, inspect_says_what_samples_hold) {
  const auto inspected = [&](const Options& inputs) {
    Options options{"inspect", "--json", "--camera", camera};
    options.insert(options.end(), inputs.begin(), inputs.end());
    const Finished finished = run_program(options);
    EXPECT_EQ(finished.code, 0) << finished;
    return json::parse(finished.out)["deep"];
  };
  const json alone = inspected({deep});
  ASSERT_EQ(alone.size(), 1);
  EXPECT_NEAR(alone[0]["samples_per_pixel"].get<double>(), 3 + 400.0 / 2304, 1e-6);
  EXPECT_EQ(alone[0]["most_samples"], 4);
  EXPECT_NEAR(alone[0]["hidden_share"].get<double>(), (2304 + 400) / (3 * 2304 + 400.0), 0.1);
  EXPECT_EQ(alone[0]["depth"], "the depth of the frame");
  EXPECT_EQ(alone[0]["state"], "messy");
  EXPECT_EQ(inspected({frame, "--deep", deep})[0]["depth"], "planar");
  write_deep(deep, {samples(rays())});
  EXPECT_EQ(inspected({frame, "--deep", deep})[0]["depth"], "along the ray");

  DeepFilePart part = samples();
  for (std::size_t i = 0; i < part.pixels.size(); i++) part.pixels[i] = {{1, first[i]}};
  write_deep(deep, {part});
  const std::string text = run_program({"inspect", deep, "--camera", camera}).out;
  EXPECT_THAT(text, HasSubstr("rendered in one go"));
  EXPECT_THAT(text, Not(HasSubstr("behind1"))) << "no pixel has a second surface";
  EXPECT_THAT(text, testing::ContainsRegex("as planar alone [0-9.]+ % of the smooth places are flat"));
}

}  // namespace
}  // namespace alcove
