// Runs with --accumulate: what a mean of many frames gains, what it leaves alone, and that nothing changes its bits.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/test.h"
#include "tests/support/walked_shot.h"

namespace alcove::accumulate_test {
namespace {

using namespace test;

constexpr int kFrames = 9;
constexpr Window kWindow{0, 0, 96, 54};

/// Every pixel has an estimate, of as much noise as there may be.
const Options kNoisy = typed("--set stride=1 --denoise none --slices 1 --steps 8 --type float");
/// As much as makes no noise.
const Options kSmooth = typed("--set stride=1 --denoise none --slices 32 --steps 32 --type float");
const Options kAlone{"--noise", "animated"}, kByOne{"--accumulate", "1"}, kByFour{"--accumulate", "4"};

/// A thing on its way to the right, px.
struct Mover {
  int width, height, top;
};
constexpr int kMoverStep = 9;  // px that it moves from frame to frame, so that it lies in tiles in every way

int left_of(int frame) { return kMoverStep * frame - 4; }

/// How far two frames differ within a rectangle of pixels.
double rmse_within(const Window& place, const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (int y = place.y; y < place.y + place.height; y++)
    for (int x = place.x; x < place.x + place.width; x++) {
      const auto at = std::size_t(y * kWindow.width + x);
      sum += (double(a[at]) - b[at]) * (double(a[at]) - b[at]);
    }
  return std::sqrt(sum / double(place.pixels()));
}

class Accumulated : public WalkedShot {
 protected:
  using Frames = std::vector<std::vector<float>>;

  /// The AO of all frames, the first one first.
  Frames ao_of(const Options& options, int frames = kFrames) const {
    remove_outputs();
    Frames ao;
    if (done(options).code != 0) return Frames(std::size_t(frames), std::vector<float>(kWindow.pixels(), -1));
    for (int frame = 1; frame <= frames; frame++) ao.push_back(ao_of_frame(frame));
    return ao;
  }
  std::vector<float> ao_of_frame(int frame) const { return read_exr_image(output(frame), {"Y"}).pixels; }
  json frames_of(const Options& options) const { return stats_of(options)["frames"]; }

  /// A camera that stands still, before a board that jumps to the right.
  void write_still_shot(double step) const {
    write_bytes(camera, wall_camera(kWindow).dump());
    for (int frame = 1; frame <= kFrames; frame++) {
      FrameFile file = wall_frame(kWindow, kWindow);
      const double left = -2.5 + step * frame;
      put_board(file, 0, {left, left + 0.8, 0.95, 5});
      file.write(input(frame));
    }
  }

  /// The same before a mover, with its motion vectors: a place in the frame before less that in this one.
  void write_mover(const Mover& mover) const {
    write_bytes(camera, wall_camera(kWindow).dump());
    for (int frame = 1; frame <= kFrames; frame++) {
      FrameFile file = wall_frame(kWindow, kWindow);
      auto& depth = file.planes.at("ViewLayer.Depth.Z");
      auto &right = file.planes["ViewLayer.Vector.X"], &up = file.planes["ViewLayer.Vector.Y"];
      right.resize(depth.size());
      up.resize(depth.size());
      for (int y = mover.top; y < mover.top + mover.height; y++)
        for (int x = left_of(frame); x < left_of(frame) + mover.width; x++) {
          const auto at = std::size_t(y * kWindow.width + x);
          depth[at] = 5.75f;
          right[at] = -kMoverStep;
        }
      file.write(input(frame));
    }
  }

  /// Expects that the middle frame is as it is alone wherever the mover is in the others.
  void expect_no_trail(const Mover& mover, const Options& more) const {
    constexpr int kMiddle = 5;
    write_mover(mover);
    const Options options = joined(kSmooth, {"--radius", "0.3", "--frames", std::to_string(kMiddle)});
    done(options);
    const auto alone = ao_of_frame(kMiddle);
    done(joined(joined(options, kByFour), more));
    const auto mean = ao_of_frame(kMiddle);
    for (int frame = 1; frame <= kFrames; frame++) {
      // It and what it darkens most.
      const Window place{left_of(frame) - 2, mover.top - 2, mover.width + 4, mover.height + 4};
      EXPECT_LT(rmse_within(place, mean, alone), 0.01)
          << mover.width << " x " << mover.height << " px at " << left_of(frame) << " " << mover.top;
    }
  }
  /// The same of movers of these sizes, which lie in tiles in every way.
  void expect_no_trails(const std::vector<std::pair<int, int>>& sizes, const Options& more) const {
    int number = 0;
    for (const auto& [width, height] : sizes) {
      for (const int top : {8, 11, 13})
        if (tried(number++, 3)) expect_no_trail({width, height, top}, more);
      number++;
    }
  }
};

double rmse_of(const std::vector<std::vector<float>>& frames, const std::vector<std::vector<float>>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < frames.size(); i++) sum += difference(frames[i], truth[i]).rmse;
  return sum / double(frames.size());
}

TEST_F(Accumulated, noise_falls_with_the_root_of_the_count) {
  write_still_shot(0);
  const Frames truth = ao_of(kSmooth), alone = ao_of(joined(kNoisy, kAlone));
  for (const int count : {1, 4}) {
    const Frames mean = ao_of(joined(kNoisy, {"--accumulate", std::to_string(count)}));
    EXPECT_LT(rmse_of(mean, truth), 1.2 * rmse_of(alone, truth) / std::sqrt(2 * count + 1)) << count;
  }
}

TEST_F(Accumulated, what_stands_still_does_not_change) {
  write_still_shot(0);
  const Frames mean = ao_of(joined(kNoisy, {"--accumulate", "2"}));
  for (int frame = 1; frame < kFrames; frame++)
    EXPECT_LT(difference(mean[std::size_t(frame)], mean[0]).max, 1e-5) << frame;
}

TEST_F(Accumulated, a_moving_camera_gains_as_much) {
  write_shot(kFrames, kWindow);
  const Frames truth = ao_of(kSmooth), alone = ao_of(joined(kNoisy, kAlone));
  EXPECT_LT(rmse_of(ao_of(joined(kNoisy, kByFour)), truth), 0.6 * rmse_of(alone, truth));
}

TEST_F(Accumulated, what_moves_leaves_no_trail) {
  write_still_shot(0.35);
  // With so little noise all that differs from the single frame by more is a trail.
  const Frames truth = ao_of(kSmooth);
  const Frames mean = ao_of(joined(kSmooth, kByFour));
  const Window swept{9, 10, 66, 34};
  for (std::size_t frame = 0; frame < truth.size(); frame++)
    EXPECT_LT(rmse_within(swept, mean[frame], truth[frame]), 0.01) << frame + 1;
  const json frames = frames_of(joined(kSmooth, kByFour));
  EXPECT_GT(frames[4]["frames_per_pixel"], 3) << "what is far from the board counts all the same";
}

TEST_F(Accumulated, small_things_that_move_leave_no_trail) {
  expect_no_trails({std::pair(3, 24), {4, 4}, {5, 5}, {2, 2}}, {});
}

TEST_F(Accumulated, what_lifts_slowly_off_a_wall_takes_its_shadow_along) {
  constexpr Window kBoardOnWall{36, 8, 24, 24}, kAround{28, 0, 40, 40};
  write_bytes(camera, wall_camera(kWindow).dump());
  for (int frame = 1; frame <= kFrames; frame++) {
    FrameFile file = wall_frame(kWindow, kWindow);
    for (int y = kBoardOnWall.y; y < kBoardOnWall.y + kBoardOnWall.height; y++)
      for (int x = kBoardOnWall.x; x < kBoardOnWall.x + kBoardOnWall.width; x++)
        file.planes.at("ViewLayer.Depth.Z")[std::size_t(y * kWindow.width + x)] = float(6 - 0.02 * (frame - 1));
    file.write(input(frame));
  }
  const Options options = joined(kSmooth, {"--radius", "0.5"});
  const Frames alone = ao_of(options), mean = ao_of(joined(options, kByFour));
  for (std::size_t frame = 0; frame < alone.size(); frame++)
    EXPECT_LT(rmse_within(kAround, mean[frame], alone[frame]), 0.01) << frame + 1;
}

TEST_F(Accumulated, vectors_tell_of_what_is_as_thin_as_a_pixel) {
  expect_no_trails({std::pair(1, 12), {2, 12}, {12, 1}, {2, 2}}, {"--motion", in + "/f.%04d.exr"});
}

TEST_F(Accumulated, samples_of_a_pixel_are_filtered_behind_the_mean) {
  write_shot(3, {0, 0, 128, 72});
  const Options options = typed("--accumulate 1 --frames 2 --type float");
  done(options);
  const std::vector<float> full = ao_of_frame(2);
  done(joined(options, typed("--set supersampling=2 --set filter=box")));
  const std::vector<float> small = ao_of_frame(2);
  ASSERT_EQ(small.size(), 64 * 36);
  for (std::size_t i = 0; i < small.size(); i++) {
    const std::size_t at = i / 64 * 2 * 128 + i % 64 * 2;
    ASSERT_NEAR(small[i], (full[at] + full[at + 1] + full[at + 128] + full[at + 129]) / 4, 1e-6) << i;
  }
}

TEST_F(Accumulated, what_does_not_count_blocks_in_no_frame_of_a_mean) {
  constexpr int kShort = 5;
  write_shot(kShort, kWindow);
  const std::string everything = folder / "everything.exr";
  for (int frame = 1; frame <= kShort; frame++) {
    std::vector<float> is_board;
    const FrameFile file = with_board(frame, kWindow);
    for (const float z : file.planes.at("ViewLayer.Depth.Z")) is_board.push_back(z == kBoard.depth ? 1.0f : 0.0f);
    write_plane(folder / fmt::format("board.{:04}.exr", frame), "Y", is_board, kWindow);
  }
  write_plane(everything, "Y", std::vector<float>(kWindow.pixels(), 1), kWindow);
  for (const auto& plane : ao_of(typed("--accumulate 2 --set ignore=" + everything), kShort))
    EXPECT_THAT(plane, Each(1.0f));
  const Options ignored = typed("--set ignore=" + folder.path() + "/board.%04d.exr");
  const Frames with = ao_of(kSmooth, kShort), truth = ao_of(joined(kSmooth, ignored), kShort);
  EXPECT_GT(rmse_of(with, truth), 0.02) << "the board blocks";
  const Frames alone = ao_of(joined(joined(kNoisy, ignored), kAlone), kShort);
  const Frames mean = ao_of(joined(joined(kNoisy, ignored), {"--accumulate", "2"}), kShort);
  EXPECT_LT(rmse_of(mean, truth), 0.7 * rmse_of(alone, truth));
}

TEST_F(Accumulated, nothing_is_taken_from_beyond_a_cut) {
  constexpr int kCut = 3;
  write_shot(kCut);
  const Options options{"--accumulate", "1", "--type", "float"};
  const Frames before = ao_of(options, kCut);
  json cameras = json::parse(read_bytes(camera));
  for (int frame = kCut + 1; frame <= 2 * kCut; frame++) {
    json matrix = cameras["world_to_camera"];
    matrix[0][3] = -100.0;
    cameras["frames"].push_back({{"frame", frame}, {"world_to_camera", matrix}});
    wall_frame().write(input(frame));
  }
  write_bytes(camera, cameras.dump());
  const Frames mean = ao_of(options, 2 * kCut);
  // The last frame before the cut has one neighbour less, and nothing of the other side.
  const json frames = frames_of(options);
  EXPECT_GT(frames[1]["frames_per_pixel"], 2.2);
  EXPECT_LT(frames[2]["frames_per_pixel"], 2.01);
  EXPECT_TRUE(mean[1] == before[1]);
}

TEST_F(Accumulated, frames_of_another_focal_length_count_where_they_see_the_same) {
  write_shot(2);
  FrameFile file = wall_frame();
  // Half the picture's angle: the lower middle of it at twice the size. The camera stands where it stood in frame 2.
  const FrameFile wide = with_board(2, {0, 0, 128, 72});
  for (auto& [name, plane] : file.planes)
    for (int y = 0; y < 36; y++)
      for (int x = 0; x < 64; x++)
        plane[std::size_t(y * 64 + x)] = wide.planes.at(name)[std::size_t((y + 36) * 128 + x + 32)];
  file.write(input(3));
  const json cameras = json::parse(read_bytes(camera));
  for (int frame = 1; frame <= 3; frame++) {
    json one = wall_camera();
    one["world_to_camera"] = cameras["frames"][std::size_t(std::min(frame, 2) - 1)]["world_to_camera"];
    if (frame == 3) one["fx"] = one["fy"] = 120, one["cy"] = 0;
    write_bytes(folder / fmt::format("camera.{}.json", frame), one.dump());
  }
  const Options own{"--camera", folder / "camera.%d.json", "--frames", "3"};
  const json frames = frames_of(joined(joined(kNoisy, own), kByOne));
  EXPECT_GT(frames[0]["frames_per_pixel"], 2);
  const auto of_third = [&](const Options& options) {
    done(joined(options, own));
    return ao_of_frame(3);
  };
  const auto truth = of_third(kSmooth), alone = of_third(kNoisy), mean = of_third(joined(kNoisy, kByOne));
  EXPECT_LT(difference(mean, truth).rmse, 0.9 * difference(alone, truth).rmse);
}

TEST_F(Accumulated, each_frame_is_estimated_once) {
  write_shot(kFrames);
  const json frames = frames_of({"--accumulate", "2", "--threads", "1"});
  int estimated = 0;
  for (const auto& frame : frames)
    for (const auto& pass : frame["passes"]) estimated += pass["name"] == "others horizon";
  // A frame's report has one line for all that were estimated for it.
  EXPECT_EQ(estimated, kFrames - 4) << "the first frame takes five, and near the end there is nothing new";
}

TEST_F(Accumulated, works_with_all_that_is_made_of_an_estimate) {
  write_shot(3);
  for (const char* more : {"--aov ao,bent-normal,transfer,specular-occlusion", "--radius 1,0.3 --aov ao,ao-scales",
                           "--resolution half", "--estimator hbao", "--around 1 --aov ao,hidden"})
    done(joined(typed(more), kByOne));
  EXPECT_THAT(run(typed("--accumulate 1 --set motion-channels=ViewLayer.Normal.X,ViewLayer.Normal.Y --motion " + in +
                        "/f.%04d.exr"))
                  .err,
              HasSubstr("motion vectors"))
      << "normals are no motion vectors";
}

TEST_F(Accumulated, refusals_say_what_to_do) {
  write_shot(3);
  const std::pair<const char*, const char*> rows[] = {{"--accumulate all", "number of frames to each side"},
                                                      {"--accumulate 17", "16"},
                                                      {"--accumulate 1 --search exact --tolerance 0.01", "--tolerance"},
                                                      {"--accumulate 1 --set debug=raw-ao", "mean of many"}};
  for (const auto& [more, text] : rows) expect_refused(2, typed(more), {text});
  for (const char* option : {"--accumulate", "--around"})
    expect_refused(2, {option, "1", "--motion", input(1)}, {"--motion", "f.0001.exr", "give a pattern such as"});
  json cameras = json::parse(read_bytes(camera));
  cameras.erase("world_to_camera");
  for (auto& frame : cameras["frames"]) frame.erase("world_to_camera");
  write_bytes(camera, cameras.dump());
  expect_refused(3, typed("--accumulate 1 --normal none --threads 1"), {"world_to_camera"});
}

TEST_F(Accumulated, a_frame_beside_it_that_lacks_its_place_is_refused_by_the_option_that_takes_it) {
  write_shot(3);
  for (const int frame : {1, 2, 3}) {
    json one = wall_camera();
    if (frame == 2) one.erase("world_to_camera");
    write_bytes(folder / fmt::format("camera.{}.json", frame), one.dump());
  }
  for (const auto& [option, other] : {std::pair("--accumulate", "--around"), {"--around", "--accumulate"}}) {
    const Finished finished = run(typed("--normal none --frames 1 --threads 1 --camera " + folder.path() +
                                        "/camera.%d.json --motion " + in + "/f.%04d.exr " + option + " 1"));
    EXPECT_EQ(finished.code, 3) << finished;
    EXPECT_THAT(finished.err,
                AllOf(HasSubstr("f.0002.exr"), HasSubstr(std::string(option) + " needs"), Not(HasSubstr(other))));
  }
}

TEST_F(Accumulated, views_show_how_many_frames_count) {
  write_shot(3);
  for (const char* aov : {"ao", "depth"}) {  // outputs without AO take no estimates
    remove_outputs();
    done(typed(std::string("--accumulate 1 --set debug=count --frames 2 --aov ") + aov));
    EXPECT_TRUE(fs::exists(out + "/ao.0002.count.png"));
  }
  done(typed("--accumulate 1 --aov normal"));
}

}  // namespace
}  // namespace alcove::accumulate_test
