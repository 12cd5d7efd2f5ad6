// Frames that are computed in tiles have the bits of frames that are computed at once.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstdlib>

#include "cli/options.h"
#include "core/run/batch.h"
#include "tests/support/command_line.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::HasSubstr;

using Options = std::vector<std::string>;

/// Bytes for frames: too few for any frame of this test as a whole.
constexpr std::uint64_t kLittleMemory = 4 << 20;

class Tiles : public CommandLine {
 protected:
  Tiles() {
    FrameFile large = wall_frame(data, display);
    add_beauty(large);
    add_blocks(large.planes.at("ViewLayer.Depth.Z"));
    large.write(frame);
    json oblique = wall_camera(display);
    oblique["cx"] = oblique["cx"].get<double>() + 3.137;
    write_bytes(camera, oblique.dump());
    ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
  }

  /// Blocks of 5 x 4 pixels at five heights, so that occluders stand beside every border of a tile.
  void add_blocks(std::vector<float>& depth) const {
    for (std::size_t i = 0; i < depth.size(); i++) {
      const std::size_t column = i % std::size_t(data.width) / 5, row = i / std::size_t(data.width) / 4;
      depth[i] -= 0.015f * float((7 * column + 13 * row) % 5);
    }
  }

  /// `alcove run` on the frame with these arguments, with so many bytes for frames or, for 0, as many as there are. It
  /// runs within this process, since no option gives a run so few.
  RunReport run_here(const Options& more, std::uint64_t bytes) const {
    Options arguments{shot, "-o", ao, "--camera", shot_camera, "--stats", folder / "stats.json", "--type", "float"};
    if (const char* device = std::getenv("ALCOVE_TEST_DEVICE"); device && *device)
      arguments.insert(arguments.end(), {"--device", device});
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOptions options;
    EXPECT_TRUE(parse_run_options(arguments, options));
    if (bytes) options.settings.device.memory = 1;
    if (bytes) options.settings.device.least_memory = bytes;
    return run_frames(options.settings);
  }

  /// The bytes of the AO, and of the composite where there is one; how many tiles they took.
  std::pair<std::string, int> computed(const Options& more, bool in_tiles) const {
    RunReport report = run_here(more, in_tiles ? little_memory : 0);
    // What reaches far takes more: then the tiles are the smallest that there are.
    for (std::uint64_t bytes = little_memory; in_tiles && report.done != 1 && bytes < 4 * little_memory;
         bytes += bytes / 4)
      report = run_here(more, bytes);
    EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
    if (report.done != 1) return {};
    const bool has_composite = std::ranges::find(more, "--composite") != more.end();
    return {read_bytes(ao) + (has_composite ? read_bytes(folder / "composite.exr") : ""), report.frames[0].parts};
  }

  /// The run in tiles must fail with ErrorKind::device and these words.
  void expect_refused(const Options& more, const std::vector<std::string>& words) const {
    const RunReport report = run_here(more, kLittleMemory);
    ASSERT_TRUE(report.stop);
    EXPECT_EQ(report.stop->kind(), ErrorKind::device);
    for (const auto& word : words) EXPECT_THAT(report.stop->what(), HasSubstr(word));
  }

  /// The run in tiles must give the bits of the whole.
  void expect_same(const Options& options) const {
    const auto [whole, one] = computed(options, false);
    const auto [tiled, many] = computed(options, true);
    EXPECT_EQ(one, 1);
    EXPECT_GT(many, 1) << testing::PrintToString(options);
    EXPECT_TRUE(whole == tiled) << testing::PrintToString(options);
  }

  std::string shot = frame, shot_camera = camera;
  std::uint64_t little_memory = kLittleMemory;
  const Window data{-6, -3, 507, 286}, display{0, 0, 500, 281};
};

TEST_F(Tiles, give_the_bits_of_the_whole) {
  for (const Options& options :
       {Options{"--radius", "0.2"},
        {"--radius", "0.2", "--aov", "ao,normal,depth,specular-occlusion", "--composite", folder / "composite.exr"},
        {"--radius", "0.3", "--estimator", "bitmask", "--slices", "2", "--steps", "20"},
        {"--radius", "0.2", "--estimator", "hbao", "--denoise", "box"},
        {"--radius", "0.2", "--estimator", "crytek", "--denoise", "none"},
        {"--radius", "0.2", "--resolution", "half"},
        {"--radius", "0.2", "--resolution", "quarter", "--denoise-radius", "5"},
        {"--radius", "0.2", "--stride", "4"},
        {"--radius", "0.2", "--stride", "8", "--density", "uniform"},
        {"--radius", "0.2", "--stride", "1"},
        {"--radius", "0.03", "--tolerance", "0.03", "--aov", "ao,error"},
        {"--radius", "0.2", "--roi", "3,5,450,250", "--falloff", "smooth"}}) {
    expect_same(options);
  }
}

TEST_F(Tiles, give_the_bits_of_the_whole_in_exact_searches) {
  // A rendered frame: the long runs of its surfaces go on beyond the tiles.
  shot = ALCOVE_SOURCE_DIR "/examples/interior.gbuffer.exr";
  shot_camera = ALCOVE_SOURCE_DIR "/examples/interior.camera.json";
  little_memory = 4 * kLittleMemory;
  expect_same({"--radius", "0.05", "--preset", "reference"});
  expect_same({"--radius", "0.06", "--preset", "reference", "--denoise", "none", "--thickness", "0.05"});
}

TEST_F(Tiles, a_radius_that_reaches_everywhere_is_refused) {
  expect_refused({"--radius", "50"}, {frame, "--radius", "--memory"});
}

TEST_F(Tiles, pictures_need_the_whole) {
  expect_refused({"--radius", "0.1", "--preview", folder / "p.png"}, {frame, "--preview", "--memory"});
}

}  // namespace
}  // namespace alcove
