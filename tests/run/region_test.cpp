// A region of a frame is computed as if the whole had been, at less cost.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

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
                                 {"--radius", "0.5", "--stride", "4", "--density", "uniform"},
                                 {"--radius", "0.5", "--stride", "1"},
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
