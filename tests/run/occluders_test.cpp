// What does not count blocks nothing: as if it were not there where it is known what is behind it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/matte.h"
#include "tests/support/command_line.h"
#include "tests/support/scenes.h"

namespace alcove::occluders_test {
namespace {

using namespace test;
using Plane = std::vector<float>;

const Window kWindow{0, 0, 160, 90};
constexpr int kLeft = 70, kRight = 90, kTop = 20;  // of the board, px
constexpr float kBoard = 4.6F;                     // its distance: the wall is at 6

const char* const kSearches[] = {"",
                                 "--estimator bitmask",
                                 "--estimator hbao",
                                 "--preset production",
                                 "--estimator crytek",
                                 "--thickness infinite",
                                 "--search exact",
                                 "--resolution half",
                                 "--tolerance 0.05"};

/// The floor and the wall, and a board that stands on the floor before the wall.
class Occluders : public CommandLine {
 protected:
  Occluders() {
    write_bytes(camera, wall_camera(kWindow).dump());
    Plane& z = file.planes["ViewLayer.Depth.Z"];
    Plane& behind_z = file.planes["Behind.Z"] = Plane(z.size(), 1e10F);
    for (std::size_t i = 0; i < z.size(); i++) {
      const int x = int(i) % kWindow.width, y = int(i) / kWindow.width;
      is_board.push_back(x >= kLeft && x < kRight && y >= kTop && z[i] > kBoard ? 1.0F : 0.0F);
      if (is_board[i] == 0) continue;
      behind_z[i] = z[i];
      z[i] = kBoard;
      file.planes["ViewLayer.Normal.Y"][i] = -1;
      file.planes["ViewLayer.Normal.Z"][i] = 0;
    }
    set_matte(is_board);
  }

  void set_matte(const Plane& matte) const { write_plane(board, "Y", matte, kWindow); }

  Plane ao_of(const FrameFile& of, const std::string& more) const {
    of.write(frame);
    const Image image = computed(typed(more));
    return image.pixels.empty() ? Plane(kWindow.pixels(), -1) : image.pixels;
  }
  Plane ao_of(const std::string& more) const { return ao_of(file, more); }

  /// How far two results are apart where the board is not, nor within a few px of it.
  Difference beside_board(Plane a, Plane b) const {
    constexpr int kAround = 12;
    for (std::size_t i = 0; i < a.size(); i++) {
      const int x = int(i) % kWindow.width, y = int(i) / kWindow.width;
      if (x >= kLeft - kAround && x < kRight + kAround && y >= kTop - kAround) a[i] = b[i] = 0;
    }
    return difference(a, b);
  }

  const FrameFile empty = wall_frame(kWindow, kWindow);
  FrameFile file = empty;
  Plane is_board;
  const std::string board = folder / "board.exr";
  const std::string ignore = " --set ignore=" + board, behind = " --set behind-channel=Behind.Z --behind " + frame;
};

TEST_F(Occluders, a_choice_that_ignores_everything_leaves_all_open) {
  set_matte(Plane(kWindow.pixels(), 1));
  for (const std::string search : kSearches) EXPECT_THAT(ao_of(search + ignore), Each(1.0F)) << search;
}

TEST_F(Occluders, what_is_ignored_is_as_if_it_were_not_there_where_it_is_known_what_is_behind) {
  int number = 0;
  for (const std::string search : kSearches) {
    if (!tried(number++, 2)) continue;
    SCOPED_TRACE(search);
    const bool takes_hidden = search != "--estimator hbao" && search != "--estimator crytek";
    const Plane with = ao_of(search), without = ao_of(empty, search);
    const Plane ignored = ao_of(search + (takes_hidden ? behind : "") + ignore);
    EXPECT_LT(std::ranges::min(with), 0.7F) << "or else there is nothing to leave out";
    const Difference blocked = beside_board(with, without), left = beside_board(ignored, without);
    EXPECT_GT(blocked.rmse, 0.0008) << "or else there is nothing to leave out";
    EXPECT_LT(left.rmse, 0.25 * blocked.rmse);
    EXPECT_LT(left.max, 0.05);
  }
}

TEST_F(Occluders, what_is_ignored_still_receives) {
  // The front of the board near the floor, which blocks its lower half.
  const std::size_t foot = 67 * 160 + 80;
  ASSERT_EQ(is_board[foot], 1);
  const float before = ao_of("")[foot];
  EXPECT_LT(before, 0.8F);
  EXPECT_NEAR(ao_of(ignore)[foot], before, 0.03);
  EXPECT_EQ(ao_of("--set occluders=" + board)[foot], 1) << "a flat board does not block itself";
}

TEST_F(Occluders, those_that_count_are_the_others_of_those_that_are_ignored) {
  Plane rest = is_board;
  for (float& x : rest) x = 1 - x;
  for (const std::string search : {"", "--search exact"}) {
    set_matte(is_board);
    const Plane ignored = ao_of(search + behind + ignore);
    set_matte(rest);
    EXPECT_EQ(ao_of(search + behind + " --set occluders=" + board), ignored);
  }
}

TEST_F(Occluders, cast_the_shadows_of_lights_beside_any_estimator) {
  const std::string lights = folder / "lights.json";
  write_bytes(lights, R"({"lights": [{"name": "key", "kind": "sun", "direction": [-0.6, -1, 0.8]}]})");
  const auto shadow_of = [&](const FrameFile& of, const std::string& more) {
    of.write(frame);
    const Image image = computed(typed("--aov shadow,confidence --lights " + lights + more));
    const auto shadow = image.plane("shadow-key.Y");
    return Plane(shadow.begin(), shadow.end());
  };
  for (const std::string estimator : {"", " --estimator hbao"}) {
    const Plane with = shadow_of(file, estimator), without = shadow_of(empty, estimator),
                ignored = shadow_of(file, estimator + behind + ignore);
    int darker = 0, off = 0;
    for (std::size_t i = 0; i < with.size(); i++) {
      if (is_board[i] != 0) continue;
      darker += with[i] < without[i];
      off += ignored[i] != without[i];
    }
    EXPECT_GT(darker, 200) << estimator;
    EXPECT_EQ(off, 0) << estimator;
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
  const Plane hard = ao_of(behind + ignore);
  set_matte(soft);
  EXPECT_EQ(ao_of(behind + ignore), hard);
  for (float& x : soft) x = x >= 0.5F ? 1.0F : 0.0F;
  set_matte(soft);
  EXPECT_NE(ao_of(behind + ignore), hard) << "or else coverage alone tells them";
}

TEST_F(Occluders, with_nothing_known_behind_them_leave_it_open_and_confidence_says_so) {
  file.write(frame);
  const auto confidence_with = [&](const std::string& more) {
    const Image image = computed(typed("--aov ao,confidence" + ignore + more));
    // The floor beside the foot of the board, behind which anything may stand.
    double sum = 0;
    for (int x = kRight + 1; x < kRight + 6; x++)
      sum += image.plane("confidence.Y")[std::size_t(79 * kWindow.width + x)] / 5;
    return sum;
  };
  EXPECT_GT(confidence_with(behind), confidence_with("") + 0.05);
}

// A solid that is ignored goes with its back, which blocks as much as its front.
TEST_F(Occluders, take_their_backs_with_them) {
  Plane& back = file.planes["Back.Z"] = file.planes["Behind.Z"];
  for (float& z : back) z = z < 1e9F ? kBoard + 0.3F : 1e10F;
  const std::string files =
      behind + " --set behind-channel=Back.Z --behind " + frame + ignore + " --behind-kind fronts,";
  const Plane without = ao_of(empty, "");
  EXPECT_LT(beside_board(ao_of(files + "backs"), without).max, 0.02);
  EXPECT_GT(beside_board(ao_of(files + "fronts"), without).max, 0.02) << "or else the back blocks nothing";
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
  const Plane expected = ao_of(ignore);
  EXPECT_NE(ao_of(""), expected);
  for (const char* by : {"--set ignore=4", "--set occluders=1", "--set ignore=Board", "--set occluders=W*",
                         "--set occluders=Wall --set object-channel=Crypto",
                         "--set ignore=4,9 --set object-channel=ViewLayer.IndexOB.X"})
    EXPECT_EQ(ao_of(by), expected) << by;
  const std::string named = folder / "named.exr", small = folder / "small.exr";
  file.write(named);
  EXPECT_EQ(ao_of(empty, "--set ignore=Board --set objects=" + named), ao_of(empty, ignore));

  write_plane(small, "Y", Plane(100, 1), {0, 0, 10, 10});
  const std::tuple<int, const FrameFile*, std::string, Options> rows[] = {
      {3, &file, "--set ignore=Bord", {frame, "--set ignore=Bord", "did you mean Board"}},
      {3,
       &file,
       "--set ignore=Board --set object-channel=ViewLayer.IndexOB.X",
       {frame, "--set ignore=Board", "IndexOB.X", "--set object-channel"}},
      {3, &empty, "--set occluders=Board", {frame, "--set occluders=Board", "no Cryptomatte", "--set objects"}},
      {3, &empty, "--set ignore=4", {frame, "numbers of objects", "--set object-channel"}},
      {3, &file, "--set ignore=" + (folder / "none.exr"), {"none.exr", "--set ignore"}},
      {2, &file, "--set ignore=4 --set occluders=1", {"--set ignore", "--set occluders"}},
      {2, &file, "--set ignore=4 --set other-views=true", {"--set ignore", "--set other-views"}},
      {2, &file, "--set objects=" + named, {"--set objects", "--set ignore"}},
      {3, &file, "--set ignore=" + small, {"small.exr", "--set ignore", "10x10"}}};
  for (const auto& [code, of, more, texts] : rows) {
    of->write(frame);
    expect_refused(code, typed(more), texts);
  }
}

// What is kept from the frame before must be what blocks in this one.
TEST_F(Occluders, that_change_along_a_sequence_are_each_frame_s_own) {
  std::vector<Plane> alone;
  const Plane none(kWindow.pixels(), 0);
  for (const Plane& matte : {is_board, none, is_board, is_board}) {
    set_matte(matte);
    alone.push_back(ao_of(ignore));
    file.write(folder / fmt::format("shot.{:04}.exr", alone.size()));
    fs::copy_file(board, folder / fmt::format("matte.{:04}.exr", alone.size()));
  }
  EXPECT_NE(alone[0], alone[1]);
  const std::string shot = folder / "shot.####.exr", mattes = folder / "matte.####.exr";
  run_well(typed("run " + shot + " -o " + folder.path() + "/out.####.exr --camera " + camera +
                 " --radius 1 --type float --threads 1 --set ignore=" + mattes));
  for (std::size_t i = 0; i < alone.size(); i++)
    EXPECT_EQ(read_exr_image(folder / fmt::format("out.{:04}.exr", i + 1)).pixels, alone[i]) << i;
}

}  // namespace
}  // namespace alcove::occluders_test
