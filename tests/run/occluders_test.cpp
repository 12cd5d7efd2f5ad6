// What does not count blocks nothing: as if it were not there where it is known what is behind it.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/formats/exr.h"
#include "core/frame/matte.h"
#include "tests/support/command_line.h"
#include "tests/support/difference.h"

namespace alcove {
namespace {

using namespace test;
using testing::Each;
using testing::HasSubstr;
using Options = std::vector<std::string>;
using Plane = std::vector<float>;

const Window kWindow{0, 0, 320, 180};
constexpr int kLeft = 140, kRight = 180, kTop = 40;  // of the board, px
constexpr float kBoard = 4.6F;                       // its distance: the wall is at 6

const std::vector<Options> kSearches{{},
                                     {"--estimator", "bitmask"},
                                     {"--estimator", "hbao"},
                                     {"--estimator", "crytek"},
                                     {"--preset", "production"},
                                     {"--thickness", "infinite"},
                                     {"--resolution", "half"},
                                     {"--search", "exact"},
                                     {"--tolerance", "0.05"}};

Options joined(Options a, const Options& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The floor and the wall, and a board that stands on the floor before the wall.
class Occluders : public CommandLine {
 protected:
  Occluders() {
    write_bytes(camera, wall_camera(kWindow).dump());
    Plane& z = file.planes["ViewLayer.Depth.Z"];
    const Plane wall = z;
    for (std::size_t i = 0; i < z.size(); i++) {
      const int x = int(i) % kWindow.width, y = int(i) / kWindow.width;
      is_board.push_back(x >= kLeft && x < kRight && y >= kTop && wall[i] > kBoard ? 1.0F : 0.0F);
      if (is_board[i] == 0) continue;
      z[i] = kBoard;
      file.planes["ViewLayer.Normal.Y"][i] = -1;
      file.planes["ViewLayer.Normal.Z"][i] = 0;
    }
    file.planes["Behind.Z"] = wall;
    for (std::size_t i = 0; i < z.size(); i++)
      if (is_board[i] == 0) file.planes["Behind.Z"][i] = 1e10F;
    set_matte(is_board);
  }

  void set_matte(const Plane& matte) const { FrameFile{kWindow, kWindow, 1, {{"Y", matte}}, {}, {}}.write(board); }

  Plane ao_of(const FrameFile& of, const Options& more) const {
    of.write(frame);
    const Finished finished = run(joined({"--type", "float", "--set", "overwrite=true"}, more));
    EXPECT_EQ(finished.code, 0) << finished << testing::PrintToString(more);
    return finished.code ? Plane(kWindow.pixels(), -1) : read_exr_image(ao).pixels;
  }
  Plane ao_of(const Options& more) const { return ao_of(file, more); }

  /// How far two results are apart where the board is not, nor within so many px of it.
  Difference beside_board(Plane a, Plane b, int around) const {
    for (std::size_t i = 0; i < a.size(); i++) {
      const int x = int(i) % kWindow.width, y = int(i) / kWindow.width;
      if (x >= kLeft - around && x < kRight + around && y >= kTop - around) a[i] = b[i] = 0;
    }
    return difference(a, b);
  }

  void expect_error(const FrameFile& of, int code, const Options& more, const std::vector<std::string>& words) const {
    of.write(frame);
    const Finished finished = run(more);
    EXPECT_EQ(finished.code, code) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    for (const auto& word : words) EXPECT_THAT(finished.err, HasSubstr(word));
  }

  const FrameFile empty = wall_frame(kWindow, kWindow);
  FrameFile file = empty;
  Plane is_board;
  const std::string board = folder / "board.exr";
  const Options behind{"--behind", frame, "--set", "behind-channel=Behind.Z"};
};

TEST_F(Occluders, a_choice_that_ignores_everything_leaves_all_open) {
  set_matte(Plane(kWindow.pixels(), 1));
  for (const Options& search : kSearches) {
    EXPECT_LT(std::ranges::min(ao_of(search)), 0.7F) << "or else there is nothing to leave out";
    EXPECT_THAT(ao_of(joined(search, {"--set", std::string("ignore=") + board})), Each(1.0F))
        << testing::PrintToString(search);
  }
}

TEST_F(Occluders, what_is_ignored_is_as_if_it_were_not_there_where_it_is_known_what_is_behind) {
  for (const Options& search : kSearches) {
    const bool takes_hidden = search.empty() || (search[1] != "hbao" && search[1] != "crytek");
    const Plane with = ao_of(search), without = ao_of(empty, search);
    const Plane ignored =
        ao_of(joined(joined(search, takes_hidden ? behind : Options()), {"--set", std::string("ignore=") + board}));
    const Difference blocked = beside_board(with, without, 24), left = beside_board(ignored, without, 24);
    EXPECT_GT(blocked.rmse, 0.0008) << "or else there is nothing to leave out" << testing::PrintToString(search);
    EXPECT_LT(left.rmse, 0.25 * blocked.rmse) << testing::PrintToString(search);
    EXPECT_LT(left.max, 0.05) << testing::PrintToString(search);
  }
}

TEST_F(Occluders, what_is_ignored_still_receives) {
  // The front of the board near the floor, which blocks its lower half.
  const std::size_t foot = 135 * 320 + 160;
  ASSERT_EQ(is_board[foot], 1);
  const float before = ao_of({})[foot];
  EXPECT_LT(before, 0.8F);
  EXPECT_NEAR(ao_of({"--set", std::string("ignore=") + board})[foot], before, 0.03);
  EXPECT_EQ(ao_of({"--set", std::string("occluders=") + board})[foot], 1) << "a flat board does not block itself";
}

TEST_F(Occluders, those_that_count_are_the_others_of_those_that_are_ignored) {
  Plane rest = is_board;
  for (float& x : rest) x = 1 - x;
  for (const Options& search : {Options(), Options{"--search", "exact"}}) {
    const Plane ignored = ao_of(joined(joined(search, behind), {"--set", std::string("ignore=") + board}));
    set_matte(rest);
    EXPECT_EQ(ao_of(joined(joined(search, behind), {"--set", std::string("occluders=") + board})), ignored);
    set_matte(is_board);
  }
}

// A matte has the beauty's filter, and a depth is of one surface: nothing of the board's outline may be left.
TEST_F(Occluders, of_a_filtered_matte_are_told_by_depth) {
  Plane soft = is_board;
  for (int y = 1; y < kWindow.height - 1; y++)
    for (int x = 1; x < kWindow.width - 1; x++) {
      float sum = 0;
      for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) sum += is_board[std::size_t((y + j) * kWindow.width + x + i)];
      soft[std::size_t(y * kWindow.width + x)] = sum / 9;
    }
  const Options ignoring = joined(behind, {"--set", std::string("ignore=") + board});
  const Plane hard = ao_of(ignoring);
  set_matte(soft);
  EXPECT_EQ(ao_of(ignoring), hard);
  Plane half = soft;
  for (std::size_t i = 0; i < half.size(); i++) half[i] = soft[i] >= 0.5F ? 1.0F : 0.0F;
  set_matte(half);
  EXPECT_NE(ao_of(ignoring), hard) << "or else coverage alone tells them";
}

TEST_F(Occluders, with_nothing_known_behind_them_leave_it_open_and_confidence_says_so) {
  const auto with_confidence = [&](const Options& more) {
    file.write(frame);
    const Finished finished =
        run(joined({"--type", "float", "--aov", "ao,confidence", "--set", std::string("ignore=") + board}, more));
    EXPECT_EQ(finished.code, 0) << finished;
    return read_exr_image(ao);
  };
  const Image known = with_confidence(behind), unknown = with_confidence({});
  ASSERT_EQ(known.names, unknown.names);
  const auto confidence = std::size_t(std::ranges::find(known.names, "confidence.Y") - known.names.begin());
  ASSERT_LT(confidence, known.names.size());
  // The floor beside the foot of the board, behind which anything may stand.
  double sum_known = 0, sum_unknown = 0;
  for (int x = kRight + 2; x < kRight + 12; x++) {
    const std::size_t at = confidence * kWindow.pixels() + std::size_t(158 * kWindow.width + x);
    sum_known += known.pixels[at] / 10;
    sum_unknown += unknown.pixels[at] / 10;
  }
  EXPECT_GT(sum_known, sum_unknown + 0.05);
}

// A solid that is ignored goes with its back, which blocks as much as its front.
TEST_F(Occluders, take_their_backs_with_them) {
  Plane back = file.planes["Behind.Z"];
  for (float& z : back) z = z < 1e9F ? kBoard + 0.3F : 1e10F;
  file.planes["Back.Z"] = back;
  const Options backs{"--behind",      frame,
                      "--set",         "behind-channel=Behind.Z",
                      "--behind-kind", "fronts",
                      "--behind",      frame,
                      "--set",         "behind-channel=Back.Z",
                      "--behind-kind", "backs",
                      "--set",         std::string("ignore=") + board};
  const Plane without = ao_of(empty, {});
  EXPECT_LT(beside_board(ao_of(backs), without, 24).max, 0.02);
  Options as_fronts = backs;
  as_fronts[11] = "fronts";
  EXPECT_GT(beside_board(ao_of(as_fronts), without, 24).max, 0.02) << "or else the back blocks nothing";
}

TEST_F(Occluders, are_named_by_numbers_or_as_in_a_cryptomatte) {
  for (const auto& is_one : is_board) {
    file.planes["ViewLayer.IndexOB.X"].push_back(is_one == 1 ? 4.0F : 1.0F);
    file.planes["Crypto00.R"].push_back(std::bit_cast<float>(cryptomatte_id(is_one == 1 ? "Board" : "Wall")));
    file.planes["Crypto00.G"].push_back(1);
  }
  file.attributes["cryptomatte/abc1234/name"] = "Crypto";
  file.attributes["cryptomatte/abc1234/manifest"] =
      fmt::format(R"({{"Board":"{:08x}","Wall":"{:08x}"}})", cryptomatte_id("Board"), cryptomatte_id("Wall"));
  const Plane expected = ao_of({"--set", std::string("ignore=") + board});
  EXPECT_NE(ao_of({}), expected);
  for (const Options& by : std::vector<Options>{{"--set", "ignore=4"},
                                                {"--set", "occluders=1"},
                                                {"--set", "ignore=Board"},
                                                {"--set", "occluders=W*"},
                                                {"--set", "occluders=Wall", "--set", "object-channel=Crypto"},
                                                {"--set", "ignore=4,9", "--set", "object-channel=ViewLayer.IndexOB.X"}})
    EXPECT_EQ(ao_of(by), expected) << testing::PrintToString(by);
  const std::string named = folder / "named.exr";
  file.write(named);
  EXPECT_EQ(ao_of(empty, {"--set", "ignore=Board", "--set", std::string("objects=") + named}),
            ao_of(empty, {"--set", std::string("ignore=") + board}));

  expect_error(file, 3, {"--set", "ignore=Bord"}, {frame, "--set ignore=Bord", "did you mean Board"});
  expect_error(file, 3, {"--set", "ignore=Board", "--set", "object-channel=ViewLayer.IndexOB.X"},
               {frame, "--set ignore=Board", "IndexOB.X", "--set object-channel"});
  expect_error(empty, 3, {"--set", "occluders=Board"},
               {frame, "--set occluders=Board", "no Cryptomatte", "--set objects"});
  expect_error(empty, 3, {"--set", "ignore=4"}, {frame, "numbers of objects", "--set object-channel"});
  expect_error(file, 3, {"--set", std::string("ignore=") + folder / "none.exr"}, {"none.exr", "--set ignore"});
  expect_error(file, 2, {"--set", "ignore=4", "--set", "occluders=1"}, {"--set ignore", "--set occluders"});
  expect_error(file, 2, {"--set", "ignore=4", "--set", "other-views=true"}, {"--set ignore", "--set other-views"});
  expect_error(file, 2, {"--set", std::string("objects=") + named}, {"--set objects", "--set ignore"});
  FrameFile{{0, 0, 10, 10}, {0, 0, 10, 10}, 1, {{"Y", Plane(100, 1)}}, {}, {}}.write(folder / "small.exr");
  expect_error(file, 3, {"--set", std::string("ignore=") + folder / "small.exr"},
               {"small.exr", "--set ignore", "10x10"});
}

TEST_F(Occluders, of_a_region_are_those_of_the_whole_frame) {
  for (const Options& search : {Options(), Options{"--resolution", "half"}, Options{"--search", "exact"}}) {
    const Options ignoring = joined(joined(search, behind), {"--set", std::string("ignore=") + board});
    const Plane whole = ao_of(ignoring);
    const Plane part = ao_of(joined(ignoring, {"--roi", "170,90,60,50"}));
    EXPECT_EQ(part, cropped(whole, kWindow, {170, 90, 60, 50})) << testing::PrintToString(search);
  }
}

// What is kept from the frame before must be what blocks in this one.
TEST_F(Occluders, that_change_along_a_sequence_are_each_frame_s_own) {
  std::vector<Plane> alone;
  const Plane none(kWindow.pixels(), 0);
  const std::vector<Plane> mattes{is_board, none, is_board, is_board};
  for (std::size_t i = 0; i < mattes.size(); i++) {
    set_matte(mattes[i]);
    alone.push_back(ao_of({"--set", std::string("ignore=") + board}));
    file.write(fmt::format("{}/shot.{:04}.exr", folder.path(), i + 1));
    std::filesystem::copy_file(board, fmt::format("{}/matte.{:04}.exr", folder.path(), i + 1));
  }
  EXPECT_NE(alone[0], alone[1]);
  const Finished finished =
      run_program({"run", folder / "shot.####.exr", "-o", folder / "out.####.exr", "--camera", camera, "--radius", "1",
                   "--type", "float", "--threads", "1", "--set", std::string("ignore=") + folder / "matte.####.exr"});
  ASSERT_EQ(finished.code, 0) << finished;
  for (std::size_t i = 0; i < mattes.size(); i++)
    EXPECT_EQ(read_exr_image(fmt::format("{}/out.{:04}.exr", folder.path(), i + 1)).pixels, alone[i]) << i;
}

}  // namespace
}  // namespace alcove
