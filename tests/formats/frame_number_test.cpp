// Frame numbers in the names that people give to files.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sequence.h"
#include "tests/support/test.h"

namespace alcove::frame_number_test {
namespace {

using namespace test;

TEST(FrameNumber, is_found_wherever_compositors_write_it) {
  const std::map<int, std::vector<const char*>> names{
      {5,
       {"shot.0005.exr", "shot_0005.exr", "shot0005.exr", "0005.exr", "5.exr", "shot-5.exr", "shot.5.exr",
        "shot.v012.0005.exr", "shot_0005_v2.exr", "shot.0005.beauty.exr", "shot.0005.left.exr", "shot.5.left.exr",
        "shot.%V.0005.exr", "shot.0005.%V.exr", "shot_0005_left.exr", "sh010_0005.exr", "seq_010_0005.exr", "shot.0005",
        "/shots/sh0100/v003/shot.0005.exr"}},
      {-5, {"shot.-0005.exr", "-5.exr"}},
      {7, {"shot_1920x1080.0007.exr"}},
      {10, {"shot_v002.0010.exr"}},
      {1001, {"shot.1001-copy.exr", "shot 1001.exr"}}};
  for (const auto& [number, all] : names)
    for (const char* name : all) {
      const FrameNumber found = frame_number_in(name);
      EXPECT_EQ(found.number, number) << name << " " << found.doubt;
      EXPECT_EQ(found.doubt, "") << name;
    }
}

TEST(FrameNumber, is_none_where_digits_mean_something_else) {
  for (const char* name : {"shot_v002.exr", "shot.v0012.exr", "shot_V3.exr", "shot_version0003.exr", "shot_v2.1.exr",
                           "4k_shot.exr", "shot_4k.exr", "shot_1920x1080.exr", "sh010.exr", "sh010_beauty.exr",
                           "sh0100_beauty_v003.exr", "render_2024-05-13.exr", "beauty.exr", "", ".exr",
                           "/shots/0005/beauty.exr", "shot.20240513121212.exr", "99999999999999999999.exr"})
    EXPECT_EQ(frame_number_in(name).number, std::nullopt) << name;
}

TEST(FrameNumber, that_is_in_doubt_says_why) {
  EXPECT_THAT(frame_number_in("shot_v002.exr").doubt, HasSubstr("v002 is a version"));
  EXPECT_THAT(frame_number_in("sh010.exr").doubt, HasSubstr("sh010 may be"));
  EXPECT_THAT(frame_number_in("render_2024-05-13.exr").doubt, HasSubstr("13 may be"));
  EXPECT_EQ(frame_number_in("beauty.exr").doubt, "");
}

}  // namespace
}  // namespace alcove::frame_number_test
