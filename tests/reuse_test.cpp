// What a frame has in common with the one before it is not computed again, and has the bits of what is.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/frame_run.h"
#include "tests/device.h"
#include "tests/difference.h"
#include "tests/random_scenes.h"
#include "tests/sequence_folder.h"
#include "tests/single_pass.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;

std::vector<float> values_of(const FrameOutputs& outputs) {
  std::vector<float> values;
  for (const auto* planes : {outputs.ao, outputs.scales, outputs.bent_normal}) {
    if (!planes) continue;
    const auto plane = planes->as<float>();
    values.insert(values.end(), plane.begin(), plane.end());
  }
  return values;
}

OutputSettings outputs_for(const EstimatorSettings& settings) {
  OutputSettings output;
  output.aovs = has_bent_normals(settings) ? "ao,bent-normal,ao-scales" : "ao,ao-scales";
  return output;
}

struct Outcome {
  std::vector<float> values;
  bool is_same = false;
  std::uint32_t kept = 0, listed = 0;
};

/// The next frame of a lane.
Outcome next_of(Lane& lane, const HostFrame& frame, const EstimatorSettings& settings) {
  FrameInputs inputs = upload(lane.gpu, frame);
  Outcome outcome;
  outcome.is_same = lane.last.is_same(lane.gpu, inputs, settings);
  const FrameOutputs outputs = outcome.is_same ? lane.last.outputs() : run_chain(lane.gpu, inputs, settings, outputs_for(settings));
  if (!outcome.is_same) lane.gpu.run();
  lane.last.keep(outputs);
  outcome.values = values_of(outputs);
  const auto tiles = outputs.tiles->as<TileCounts>()[0];
  outcome.kept = tiles.kept;
  outcome.listed = tiles.listed;
  return outcome;
}

std::vector<float> alone(const HostFrame& frame, const EstimatorSettings& settings) {
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, outputs_for(settings));
  recorder().run();
  return values_of(outputs);
}

/// Something is put into a rectangle of a frame, is taken from it, or turns its normals.
void change(HostFrame& frame, RandomScenes& random) {
  const int x0 = random.whole(0, frame.data.width - 1), y0 = random.whole(0, frame.data.height - 1);
  const int x1 = std::min(frame.data.width, x0 + random.whole(1, 12)), y1 = std::min(frame.data.height, y0 + random.whole(1, 12)), kind = random.whole(0, 3);
  for (int y = y0; y < y1; y++)
    for (int x = x0; x < x1; x++) {
      const std::size_t i = std::size_t(y) * std::size_t(frame.data.width) + std::size_t(x);
      if (kind == 0) frame.depth[i] *= 0.7f;
      if (kind == 1) frame.depth[i] = 2e9f;
      if (kind == 2) frame.depth[i] = 1.0f;
      if (kind == 3 && !frame.normal.empty()) frame.normal[i] += 0.2f;
    }
}

// ALCOVE_TEST_SEED: other scenes.
TEST(Reuse, of_parts_and_of_whole_frames_changes_no_bit) {
  const char* seed = std::getenv("ALCOVE_TEST_SEED");
  RandomScenes random(seed ? unsigned(std::atoi(seed)) : 61121);
  std::uint64_t kept = 0, same = 0;
  for (int i = 0; i < 120 && !HasFailure(); i++) {
    HostFrame frame = random.next(3);
    EstimatorSettings settings = plain_settings();
    settings.estimator = random.estimator();
    settings.radius = random.radius() / 10;
    settings.thickness = random.thickness();
    settings.thickness_length = *settings.radius / 4;
    settings.slices = random.whole(1, 4);
    settings.steps = settings.samples = random.whole(4, 20);
    if (random.whole(0, 3) == 0) settings.further_radii = {*settings.radius / 3};
    if (random.whole(0, 2) == 0) settings.resolution = random.whole(0, 1) == 0 ? Resolution::half : Resolution::quarter;
    if (random.whole(0, 1) == 0) settings.denoise = Denoise::bilateral;
    if (settings.denoise == Denoise::bilateral && settings.resolution == Resolution::full) settings.stride = 1 << random.whole(0, 2);
    Lane lane(device());
    for (int shot = 0; shot < 4; shot++) {
      if (shot > 0 && random.whole(0, 3) > 0) change(frame, random);
      frame.frame = shot;
      const Outcome next = next_of(lane, frame, settings);
      EXPECT_TRUE(same_bits(next.values, alone(frame, settings))) << "scene " << i << " frame " << shot << " estimator " << int(settings.estimator);
      kept += next.is_same ? 0 : next.kept;
      same += next.is_same;
    }
  }
  EXPECT_GT(kept, 2000u) << "tiles";
  EXPECT_GT(same, 50u) << "frames";
}

TEST(Reuse, is_of_what_was_computed_in_the_same_way) {
  const HostFrame room = furnished_room(96, 64).frame;
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.1;
  Lane lane(device());
  next_of(lane, room, settings);
  EXPECT_TRUE(next_of(lane, room, settings).is_same);
  HostFrame other = room;
  other.camera.cx += 1;
  EXPECT_FALSE(next_of(lane, other, settings).is_same);
  EXPECT_EQ(next_of(lane, room, settings).kept, 0u) << "the camera is another again";
  other = room;
  other.frame = 7;
  EXPECT_TRUE(next_of(lane, other, settings).is_same);
  settings.noise = Noise::animated;
  EXPECT_FALSE(next_of(lane, room, settings).is_same);
  EXPECT_FALSE(next_of(lane, other, settings).is_same);
  EXPECT_TRUE(next_of(lane, other, settings).is_same);
}

TEST(Reuse, leaves_most_of_a_frame_in_which_little_moves) {
  HostFrame room = furnished_room(320, 240).frame;
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.05;
  Lane lane(device());
  const auto listed = next_of(lane, room, settings).listed;
  for (int y = 100; y < 110; y++)
    for (int x = 200; x < 210; x++) room.depth[std::size_t(y * 320 + x)] *= 0.9f;
  const Outcome next = next_of(lane, room, settings);
  EXPECT_LT(next.listed, listed / 3);
  EXPECT_GT(next.kept, 2 * listed / 3);
}

using ReuseOfFrames = SequenceFolder;

json stats(const std::string& path) { return json::parse(read_bytes(path)); }

TEST_F(ReuseOfFrames, equal_frames_are_computed_once_a_thread) {
  write_frames(1, 6);
  const std::string path = folder / "stats.json";
  ASSERT_EQ(run({"--threads", "1", "--stats", path}).code, 0);
  const json frames = stats(path)["frames"];
  ASSERT_EQ(frames.size(), 6);
  EXPECT_FALSE(frames[0]["passes"].empty());
  for (std::size_t i = 1; i < 6; i++) {
    EXPECT_TRUE(frames[i]["passes"].empty());
    EXPECT_EQ(frames[i]["ms"]["compute"], 0);
    EXPECT_EQ(frames[i]["tiles"]["computed"], 0);
    EXPECT_EQ(frames[i]["tiles"]["kept"], frames[0]["tiles"]["computed"]);
    EXPECT_EQ(frames[i]["tiles"]["total"], frames[0]["tiles"]["total"]);
  }
  const auto reused = outputs();
  ASSERT_EQ(run({"--threads", "1", "--no-skip", "--overwrite", "--stats", path}).code, 0);
  const json computed = stats(path);
  for (const auto& frame : computed["frames"]) EXPECT_FALSE(frame["passes"].empty());
  EXPECT_EQ(reused.size(), 6);
  EXPECT_TRUE(outputs() == reused);
}

}  // namespace
}  // namespace alcove
