// Runs with deep files: the bits of --behind, a frame of samples alone, what inspect says, and every mistake in files
// and options.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "tests/support/openexr.h"

namespace alcove::deep_run_test {
namespace {

using namespace test;

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
    write_plane(folder / "second.exr", "Z", second);
    write_plane(folder / "third.exr", "Z", third);
    write_plane(flat, "Z", first);
    write_deep(deep, {samples()});
    write_deep(small, {small_samples()}, small_samples().data);
  }

  /// Every surface as an opaque sample, in no order; each times its pixel's factor.
  DeepFilePart samples(const std::function<double(std::size_t)>& factor = nullptr) const {
    DeepFilePart part;
    part.data = kWallWindow;
    for (std::size_t i = 0; i < first.size(); i++) {
      const float by = factor ? float(factor(i)) : 1;
      part.pixels.push_back({{1, second[i] * by}, {1, first[i] * by}, {0.25F, 2 * by}});
      if (third[i] > 0) part.pixels.back().insert(part.pixels.back().begin(), {1, third[i] * by});
    }
    return part;
  }
  /// Those of a picture that is not as high.
  DeepFilePart small_samples() const {
    DeepFilePart part = samples();
    part.data.height = 20;
    part.pixels.resize(64 * 20);
    return part;
  }
  /// A renderer's, which end at the first opaque surface; in some of 16 columns one lies far behind.
  DeepFilePart samples_of_first(std::size_t columns = 0) const {
    DeepFilePart part = samples();
    for (std::size_t i = 0; i < part.pixels.size(); i++) {
      part.pixels[i] = {{1, first[i]}};
      if (i % 16 < columns) part.pixels[i].push_back({1, 50});
    }
    return part;
  }

  std::vector<float> result(const std::string& more) const { return computed(typed(more)).pixels; }
  /// A run of files of its own.
  Finished run_on(const Options& inputs) const {
    return run_program(
        joined(joined({"run"}, inputs), {"-o", ao, "--camera", camera, "--radius", "1", "--type", "float"}));
  }
  std::vector<float> result_of(const Options& inputs) const {
    const Finished finished = run_on(inputs);
    EXPECT_EQ(finished.code, 0) << testing::PrintToString(inputs) << finished;
    return finished.code == 0 ? read_exr_image(ao).pixels : std::vector<float>();
  }
  json inspected(const Options& inputs) const {
    const Finished finished = run_well(joined({"inspect", "--json", "--camera", camera}, inputs));
    return json::parse(finished.out);
  }

  const std::string deep = folder / "deep.exr", flat = folder / "flat.exr", small = folder / "small.exr";
  const std::string peels = "--behind " + (folder / "second.exr") + " --behind " + (folder / "third.exr");
  std::vector<float> first, second, third;
};

TEST_F(DeepRun, peels_as_samples_give_the_bits_of_behind) {
  const auto behind = result("--aov ao,hidden " + peels);
  EXPECT_TRUE(std::ranges::find(behind, 8.25F) != behind.end()) << "or else nothing was shown";
  EXPECT_TRUE(result("--aov ao,hidden --deep " + deep) == behind);
  EXPECT_TRUE(result("--search exact --deep " + deep) == result("--search exact " + peels));
  DeepFilePart tiles = samples();
  tiles.is_tiled = true;
  tiles.tile = 16;
  write_deep(deep, {tiles});
  EXPECT_TRUE(result("--aov ao,hidden --deep " + deep) == behind);
}

TEST_F(DeepRun, samples_along_the_ray_are_told_by_the_flat_depth) {
  const auto planar = result("--aov hidden --deep " + deep);
  write_deep(deep, {samples([](std::size_t i) { return ray_length(i); })});
  const auto along = result("--aov hidden --deep " + deep);
  ASSERT_EQ(along.size(), planar.size());
  for (std::size_t i = 0; i < along.size(); i++)
    ASSERT_NEAR(along[i] / (planar[i] + 1), planar[i] / (planar[i] + 1), 1e-5) << i;
}

TEST_F(DeepRun, samples_alone_are_a_frame_and_may_lie_in_several_files) {
  const auto expected = result_of(joined({flat}, typed(peels)));
  for (const Options& inputs : {Options{deep}, Options{"--depth", deep}, Options{"--deep", deep}})
    EXPECT_TRUE(result_of(inputs) == expected) << inputs[0];
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
  const std::string a = folder / "a.exr", b = folder / "b.exr", both = "--deep " + a + " --deep " + b;
  write_deep(a, {one}, kWallWindow);
  const auto beside_flat = result("--deep " + deep);
  for (const bool is_tiled : {false, true}) {
    other.is_tiled = is_tiled;
    other.tile = 7;
    write_deep(b, {other}, kWallWindow);
    EXPECT_TRUE(result(both) == beside_flat) << is_tiled;
    if (!is_tiled) EXPECT_TRUE(result_of({b, "--deep", a}) == expected);
    if (is_tiled) EXPECT_TRUE(result_of({a, "--deep", b}) == expected);
    if (is_tiled) EXPECT_TRUE(result_of(typed(both)) == expected);
  }
  test::expect_refused(run_on({deep, "--deep", small}), 3, {"small.exr", "same pixels", "--deep"});
  test::expect_refused(run_on({deep, "--deep", flat}), 3, {"flat.exr", "no deep data", "--deep"});
}

TEST_F(DeepRun, samples_are_the_depth_of_the_frames_around_too) {
  FrameFile normals = wall_frame();
  normals.erase("Depth");
  json cameras = wall_camera();
  for (int number = 1; number <= 3; number++) {
    normals.write(folder / fmt::format("n.{}.exr", number));
    fs::copy_file(deep, folder / fmt::format("d.{}.exr", number));
    json matrix = cameras["world_to_camera"];
    matrix[0][3] = -0.2 * number;
    cameras["frames"].push_back({{"frame", number}, {"world_to_camera", matrix}});
  }
  write_bytes(camera, cameras.dump());
  for (const Options& inputs :
       {Options{folder / "n.%d.exr", "--deep", folder / "d.%d.exr"}, Options{folder / "d.%d.exr"}}) {
    run_well(joined(joined({"run"}, inputs), typed("-o " + folder.path() + "/out.%d.exr --camera " + camera +
                                                   " --radius 1 --around 1 --frames 2 --aov depth,hidden")));
    EXPECT_THAT(attribute_of_whole_exr(folder / "out.2.exr", "alcove/hidden").value_or(""), HasSubstr("frames 1, 3"));
  }
}

TEST_F(DeepRun, flat_parts_beside_samples_are_the_frame) {
  DeepFilePart part;
  part.is_flat = true;
  part.name = "flat";
  part.data = kWallWindow;
  part.channels = {"Z"};
  for (const float z : first) part.pixels.push_back({{z}});
  const std::string both = folder / "both.exr";
  write_deep(both, {samples(), part});
  EXPECT_TRUE(result_of({both}) == result_of({flat})) << "samples that nobody asked for are not read";
  const auto hidden = result_of({both, "--deep", both, "--aov", "hidden"});
  EXPECT_TRUE(std::ranges::find(hidden, 8.25F) != hidden.end());
}

TEST_F(DeepRun, samples_without_anything_hidden_are_noted_and_switch_no_completion_off) {
  write_deep(deep, {samples_of_first()});
  EXPECT_THAT(done({"--deep", deep}).err, HasSubstr("rendered in one go"));
  for (const std::string search : {"--search exact", "--preset reference"})
    EXPECT_TRUE(result(search + " --deep " + deep) == result(search)) << search;
}

TEST_F(DeepRun, few_surfaces_behind_others_tell_of_no_more) {
  const auto ao_with = [&](std::size_t columns, const std::string& more = {}) {
    write_deep(deep, {samples_of_first(columns)});
    return result("--search exact --deep " + deep + more);
  };
  const auto plain = result("--search exact"), whole = ao_with(9);
  // What lies beyond the radius hides nothing, but a pixel that lists it and nothing before it has nothing there.
  EXPECT_TRUE(ao_with(7) == plain);
  EXPECT_FALSE(whole == plain);
  // The samples of the region alone would tell otherwise.
  EXPECT_EQ(ao_with(9, " --roi 11,5,4,20"), cropped(whole, kWallWindow, {11, 5, 4, 20}));
}

TEST_F(DeepRun, impossible_opacities_are_noted) {
  DeepFilePart part = samples();
  for (auto& pixel : part.pixels) pixel[0][0] = 1.5F;
  write_deep(deep, {part});
  EXPECT_THAT(done({"--deep", deep}).err, HasSubstr("opacity"));
}

TEST_F(DeepRun, mistakes_are_refused_in_one_line) {
  write_deep(folder / "other.exr", {samples([](std::size_t) { return 3.7; })});
  DeepFilePart without = samples();
  without.channels = {"A", "depth.Z"};
  write_deep(folder / "without.exr", {without});
  const std::string bytes = read_bytes(deep);
  write_bytes(folder / "cut.exr", bytes.substr(0, bytes.size() - 100));
  const std::tuple<const char*, const char*, Options> rows[] = {
      {"--deep", "flat.exr", {"no deep data", "--behind", "--deep"}},
      {"--normal", "deep.exr", {"deep data", "--normal"}},
      {"--behind", "deep.exr", {"deep data", "behind-channel"}},
      {"--deep", "other.exr", {"--depth-scale"}},
      {"--deep", "small.exr", {"same pixels", "--deep"}},
      {"--deep", "without.exr", {"no Z", "--deep"}},
      {"--deep", "cut.exr", {"--deep"}}};
  for (const auto& [option, file, texts] : rows) expect_refused(3, {option, folder / file}, joined({file}, texts));
  test::expect_refused(run_program({"compare", deep, flat}), 3, {"deep.exr", "deep data"});
}

TEST_F(DeepRun, estimators_that_know_no_layers_take_samples_as_the_depth_alone) {
  for (const std::string estimator : {"hbao", "crytek"}) {
    const std::string with = "--deep " + deep + " --estimator " + estimator;
    expect_refused(2, typed(with), {"deep.exr", "--estimator gtao or bitmask", "--deep", "--set hidden=0"});
    EXPECT_TRUE(result(with + " --set hidden=0") == result("--estimator " + estimator));
    result_of({deep, "--estimator", estimator});
  }
}

TEST_F(DeepRun, inspect_lists_the_surfaces_that_there_are) {
  const json aovs = inspected({frame, "--deep", deep})["aovs"];
  EXPECT_TRUE(aovs.contains("behind3")) << "the plate, the wall behind it, and what is behind that";
  EXPECT_FALSE(aovs.contains("behind4"));
}

TEST_F(DeepRun, inspect_looks_at_a_frame_without_samples_that_are_refused) {
  const json found = inspected({frame, "--deep", small});
  EXPECT_THAT(found["refused"].dump(), HasSubstr("same pixels"));
  EXPECT_THAT(found["missing"].dump(), Not(HasSubstr("same pixels")));
  EXPECT_EQ(found["depth"]["kind"], "planar");
  EXPECT_EQ(found["deep"].size(), 1);
  EXPECT_EQ(found["command"], "") << "a run would fail";
}

TEST_F(DeepRun, inspect_says_what_samples_hold) {
  const json alone = inspected({deep})["deep"];
  ASSERT_EQ(alone.size(), 1);
  EXPECT_NEAR(alone[0]["samples_per_pixel"].get<double>(), 3 + 400.0 / 2304, 1e-6);
  EXPECT_EQ(alone[0]["most_samples"], 4);
  EXPECT_NEAR(alone[0]["hidden_share"].get<double>(), (2304 + 400) / (3 * 2304 + 400.0), 0.1);
  EXPECT_EQ(alone[0]["depth"], "the depth of the frame");
  EXPECT_EQ(alone[0]["state"], "messy");
  EXPECT_EQ(inspected({frame, "--deep", deep})["deep"][0]["depth"], "planar");
  write_deep(deep, {samples([](std::size_t i) { return ray_length(i); })});
  EXPECT_EQ(inspected({frame, "--deep", deep})["deep"][0]["depth"], "along the ray");

  write_deep(deep, {samples_of_first()});
  const std::string text = run_program({"inspect", deep, "--camera", camera, "-v"}).out;
  EXPECT_THAT(text, HasSubstr("rendered in one go"));
  EXPECT_THAT(text, Not(HasSubstr("behind1"))) << "no pixel has a second surface";
  EXPECT_THAT(text, ContainsRegex("as planar alone [0-9.]+ % of the smooth places are flat"));
}

}  // namespace
}  // namespace alcove::deep_run_test
