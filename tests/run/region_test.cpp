// A region of a frame is computed as if the whole had been, at less cost.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/formats/exr.h"
#include "tests/support/command_line.h"
#include "tests/support/difference.h"

namespace alcove {
namespace {

using namespace test;
using testing::HasSubstr;

TEST_F(CommandLine, a_region_is_that_part_of_the_whole) {
  const Window data{-8, -4, 80, 44}, region{19, 14, 27, 20};
  wall_frame(data).write(frame);
  using Options = std::vector<std::string>;
  for (const Options& options : {Options{"--radius", "1"},
                                 {"--radius", "0.5"},
                                 {"--radius", "1", "--resolution", "half"},
                                 {"--radius", "0.5", "--denoise", "bilateral"},
                                 {"--radius", "0.5", "--set", "stride=4", "--set", "density=uniform"},
                                 {"--radius", "0.5", "--set", "stride=1"},
                                 {"--radius", "2", "--resolution", "quarter", "--denoise", "box"}}) {
    Options arguments{"run", frame, "-o", ao, "--camera", camera, "--type", "float"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    ASSERT_EQ(run_program(arguments).code, 0);
    const Image whole = read_exr_image(ao);
    arguments.insert(arguments.end(), {"--roi", "19,14,27,20"});
    const Finished finished = run_program(arguments);
    ASSERT_EQ(finished.code, 0) << finished;
    const Image part = read_exr_image(ao);
    EXPECT_EQ(part.data, region);
    EXPECT_EQ(part.display, kWallWindow);
    const Difference d = difference(part.pixels, cropped(whole.pixels, whole.data, region));
    EXPECT_LE(d.max, 1e-6) << testing::PrintToString(options) << " at " << d.worst;
    EXPECT_LT(*std::ranges::min_element(part.pixels), 0.9) << "or else there is nothing to compare";
  }
}

TEST_F(CommandLine, a_small_radius_makes_a_region_cheap) {
  const std::string stats = folder / "stats.json";
  ASSERT_EQ(run_program({"run", frame, "-o", ao, "--camera", camera, "--radius", "0.05", "--denoise", "none", "--roi",
                         "20,4,8,8", "--stats", stats})
                .code,
            0);
  EXPECT_LT(nlohmann::json::parse(read_bytes(stats))["frames"][0]["pixels"].get<int>(), 24 * 24) << "of 64 x 36";
}

// How many directions a tile takes is decided by all of its pixels, and by its neighbours, at each of four comparisons.
TEST_F(CommandLine, a_region_by_error_computes_the_tiles_that_decide) {
  const std::string interior = ALCOVE_SOURCE_DIR "/examples/interior";
  const std::string stats = folder / "stats.json";
  const auto pixels = [&](const std::vector<std::string>& search) {
    std::vector<std::string> arguments{"run",      interior + ".gbuffer.exr", "-o",       ao,
                                       "--camera", interior + ".camera.json", "--type",   "float",
                                       "--roi",    "480,270,20,16",           "--radius", "0.02",
                                       "--set",    "complete=none",           "--stats",  stats};
    arguments.insert(arguments.end(), search.begin(), search.end());
    const Finished finished = run_program(arguments);
    EXPECT_EQ(finished.code, 0) << finished;
    return std::sqrt(nlohmann::json::parse(read_bytes(stats))["frames"][0]["pixels"].get<double>());
  };
  const double plain = pixels({"--search", "exact", "--denoise", "none"}), by_error = pixels({"--tolerance", "0.004"});
  EXPECT_GE(by_error, plain + 70) << "39 px on either side";
}

TEST_F(CommandLine, a_region_has_the_frame_read_once) {
  const std::string stats = folder / "stats.json";
  const auto rows_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"run",  frame,      "-o",   ao,        "--camera",
                                       camera, "--radius", "0.02", "--stats", stats};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished finished = run_program(arguments);
    EXPECT_EQ(finished.code, 0) << finished;
    return nlohmann::json::parse(read_bytes(stats))["frames"][0]["rows_read"].get<int>();
  };
  EXPECT_EQ(rows_of({}), kWallWindow.height);
  EXPECT_EQ(rows_of({"--roi", "4,6,20,10"}), kWallWindow.height);
  EXPECT_EQ(rows_of({"--roi", "4,6,20,10", "--preset", "reference"}), kWallWindow.height) << "its lines reach far";
}

TEST_F(CommandLine, a_region_that_shows_too_little_is_read_as_the_whole_is) {
  const Window tall{0, 0, 320, 240};
  FrameFile inverse = wall_frame(tall, tall);
  for (float& z : inverse.planes.at("ViewLayer.Depth.Z")) z = 20 / z;
  inverse.write(frame);
  nlohmann::json silent = wall_camera(tall);
  for (const char* key : {"depth", "depth_kind"}) silent.erase(key);
  write_bytes(camera, silent.dump());
  const std::vector<std::string> arguments{"run", frame, "-o", ao, "--camera", camera, "--radius", "0.1"};
  const Finished all = run_program(arguments);
  ASSERT_EQ(all.code, 0) << all;
  EXPECT_THAT(all.err, HasSubstr("depth kind taken as inverse")) << "or else nothing is proved";
  const Image whole = read_exr_image(ao);
  std::vector<std::string> of_region = arguments;
  of_region.insert(of_region.end(), {"--roi", "10,12,24,9"});
  const Finished finished = run_program(of_region);
  ASSERT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.err, HasSubstr("depth kind taken as inverse")) << "or else nothing is proved";
  const Image part = read_exr_image(ao);
  EXPECT_EQ(part.pixels, cropped(whole.pixels, whole.data, part.data));
}

TEST_F(CommandLine, a_region_outside_of_the_frame_is_refused) {
  for (const char* roi : {"0,0,65,10", "-1,0,5,5", "60,30,4,7", "2147483647,0,2147483647,1"}) {
    const Finished finished = run({"--roi", roi});
    EXPECT_EQ(finished.code, 2) << finished;
    EXPECT_THAT(finished.err, HasSubstr("--roi"));
  }
  for (const char* roi : {"0,0,0,5", "1,2,3", "a,b,c,d", "1,2,3,4,5", "1.5,2,3,4"})
    EXPECT_EQ(run({"--roi", roi}).code, 2) << roi;
}

}  // namespace
}  // namespace alcove
