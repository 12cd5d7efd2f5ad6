// What a frame has in common with the one before it is not computed again, and has the bits of what is; so has an
// adaptive density, of which neighbours decide.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"
#include "core/formats/exr.h"
#include "core/run/frame_run.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/scenes.h"
#include "tests/support/site_frames.h"

namespace alcove::reuse_test {
namespace {

using namespace test;

std::vector<float> values_of(const FrameOutputs& outputs) {
  std::vector<float> values;
  for (const auto* planes : {outputs.ao, outputs.scales, outputs.bent_normal, outputs.transfer, outputs.confidence,
                             outputs.specular_occlusion, outputs.curvature, outputs.convexity}) {
    const std::vector<float> plane = test::values_of(planes);
    values.insert(values.end(), plane.begin(), plane.end());
  }
  return values;
}

/// all: also what is made of the AO, and by other estimates beside it.
OutputSettings outputs_for(const EstimatorSettings& settings, bool all) {
  OutputSettings output;
  output.aovs = searches_slices(settings) ? "ao,bent-normal,transfer,ao-scales" : "ao,ao-scales";
  if (all) output.aovs += ",confidence,specular-occlusion,curvature,convexity";
  return output;
}

struct Outcome {
  std::vector<float> values;
  bool is_same = false;
  std::uint32_t kept = 0, listed = 0;
};

/// The next frame of a lane.
Outcome next_of(Lane& lane, const HostFrame& frame, const EstimatorSettings& settings, bool all = false) {
  FrameInputs inputs = upload(lane.gpu, frame);
  Outcome outcome;
  outcome.is_same = lane.last.is_same(lane.gpu, inputs, settings);
  const FrameOutputs outputs =
      outcome.is_same ? lane.last.outputs() : run_chain(lane.gpu, inputs, settings, outputs_for(settings, all));
  if (!outcome.is_same) lane.gpu.run();
  lane.last.keep(outputs);
  outcome.values = values_of(outputs);
  const auto tiles = outputs.tiles->as<TileCounts>()[0];
  outcome.kept = tiles.kept;
  outcome.listed = tiles.listed;
  return outcome;
}

std::vector<float> alone(const HostFrame& frame, const EstimatorSettings& settings, bool all = false) {
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, outputs_for(settings, all));
  recorder().run();
  return values_of(outputs);
}

/// Something is put into a rectangle of a frame, is taken from it, or turns its normals: next to the border of a block
/// of 32 pixels, or anywhere.
void change(HostFrame& frame, RandomScenes& random) {
  const auto place = [&](int size) {
    const int near_border = 32 * random.whole(0, size / 32) + random.whole(0, 3);
    return random.whole(0, 1) ? random.whole(0, size - 1) : std::min(size - 1, near_border);
  };
  const int x0 = place(frame.data.width), y0 = place(frame.data.height);
  const int x1 = std::min(frame.data.width, x0 + random.whole(1, 12)),
            y1 = std::min(frame.data.height, y0 + random.whole(1, 12)), kind = random.whole(0, 3);
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
  const int count = long_tests() ? 120 : cases_of(21);
  Lane lane(device());
  for (int i = 0; i < count && !HasFailure(); i++) {
    lane.last.forget();
    HostFrame frame = random.next(3);
    EstimatorSettings settings = plain_settings();
    settings.estimator = random.estimator();
    settings.radius = random.radius() / random.whole(2, 10);  // some reach farther than a block of changes
    settings.thickness = random.thickness();
    settings.thickness_length = *settings.radius / 4;
    // Few, since the driver compiles each of them.
    std::tie(settings.slices, settings.steps) =
        std::array{std::pair(1, 4), std::pair(2, 10), std::pair(4, 19)}[std::size_t(random.whole(0, 2))];
    settings.samples = settings.steps;
    if (random.whole(0, 3) == 0) settings.further_radii = {*settings.radius / 3};
    if (random.whole(0, 2) == 0) settings.resolution = random.whole(0, 1) == 0 ? Resolution::half : Resolution::quarter;
    settings.denoise = std::array{Denoise::none, Denoise::bilateral, Denoise::bilateral,
                                  Denoise::box}[std::size_t(random.whole(0, 3))];
    if (random.whole(0, 3) == 0) settings.power = 1.5;
    const bool all = random.whole(0, 3) == 0;
    if (settings.denoise == Denoise::bilateral && settings.resolution == Resolution::full)
      settings.stride = 1 << random.whole(0, 4);
    settings.density = Density(i % 2);
    const int still = random.whole(1, 3);  // the frame that is as the one before it
    std::vector<float> expected;
    for (int shot = 0; shot < 4; shot++) {
      if (shot > 0 && shot != still) change(frame, random);
      frame.frame = shot;
      const Outcome next = next_of(lane, frame, settings, all);
      // A mistake in the first frame shows in the tiles that later frames keep.
      if (shot == 0) expected = next.values;
      if (shot > 0 && shot != still) expected = alone(frame, settings, all);
      EXPECT_TRUE(same_bits(next.values, expected))
          << "scene " << i << " frame " << shot << " estimator " << int(settings.estimator);
      kept += next.is_same ? 0 : next.kept;
      same += next.is_same;
    }
  }
  EXPECT_GT(kept, 16u * std::uint64_t(count)) << "tiles";
  EXPECT_GE(same, std::uint64_t(count)) << "frames";
}

// A low wall walks over a floor seen from above. The radius is 103 pixels wide there, more than three blocks of
// changes: whatever is within it must be computed anew.
TEST(Reuse, looks_as_far_as_a_receiver_reaches) {
  const Scene scene{{parallelogram({-9, -9, 0}, {18, 0, 0}, {0, 18, 0})}};
  const HostFrame floor = render(scene, Shot::perspective({0, 0, 3}, {0.01, 0, 0}, 50, 288, 96)).frame;
  for (const Estimator estimator : {Estimator::gtao, Estimator::crytek}) {
    EstimatorSettings settings = sampled(estimator, 1, 2, 32);
    settings.samples = 32;
    Lane lane(device());
    std::uint64_t kept = 0;
    for (int wall = 4; wall < 284; wall += 24) {
      HostFrame frame = floor;
      for (std::size_t y = 20; y < 76; y++)
        for (std::size_t x = 0; x < 4; x++) frame.depth[y * 288 + std::size_t(wall) + x] *= 0.95f;
      const Outcome next = next_of(lane, frame, settings);
      EXPECT_TRUE(same_bits(next.values, alone(frame, settings))) << "estimator " << int(estimator) << " wall " << wall;
      kept += next.kept;
    }
    EXPECT_GT(kept, 100u) << "tiles, estimator " << int(estimator);
  }
}

/// A bar before a wall, from the left border to the middle, with a step behind it that goes on below the bar, and with
/// `goes_on` to its right. Along the whole bar the step closes a solid, or does not, by how they end there.
HostFrame bar_before_step(bool goes_on) {
  constexpr std::size_t kWidth = 128, kHeight = 64, kEnd = 64;
  HostFrame frame = render({{kFloor}}, Shot::orthographic({0, 0, 5}, {0, 0.001, 0}, 1.28, kWidth, kHeight)).frame;
  frame.behind.assign(2, {});
  frame.behind_depth.assign(2 * kWidth * kHeight, 0);
  for (std::size_t y = 24; y < 40; y++)
    for (std::size_t x = 0; x < kEnd + 16; x++) {
      const std::size_t i = y * kWidth + x;
      const bool is_bar = y < 34 && x < kEnd, is_step = x < kEnd || goes_on;
      frame.depth[i] = is_bar ? 4.8f : is_step ? 4.9f : 5.0f;
      if (is_bar) frame.behind_depth[i] = 4.9f;
      if (is_step) frame.behind_depth[kWidth * kHeight + i] = 5.0f;
    }
  return frame;
}

TEST(Reuse, looks_as_far_as_the_ends_of_hidden_surfaces_are_followed) {
  const HostFrame solid = bar_before_step(false), open = bar_before_step(true);
  for (const Estimator estimator : {Estimator::gtao, Estimator::bitmask}) {
    // 25 px, and the bar's other end is 64 px away from the changed block
    const EstimatorSettings settings = sampled(estimator, 0.25, 4, 16);
    const std::vector<float> of_solid = alone(solid, settings), of_open = alone(open, settings);
    int far_changes = 0;
    for (std::size_t y = 0; y < 64; y++)
      for (std::size_t x = 0; x < 16; x++) far_changes += of_solid[y * 128 + x] != of_open[y * 128 + x] ? 1 : 0;
    EXPECT_GT(far_changes, 20) << "or else all that changes is near";
    Lane lane(device());
    next_of(lane, solid, settings);
    const Outcome opened = next_of(lane, open, settings);
    EXPECT_TRUE(same_bits(opened.values, of_open)) << int(estimator);
    EXPECT_TRUE(same_bits(next_of(lane, solid, settings).values, of_solid)) << int(estimator);
  }
}

TEST(Reuse, is_looked_for_where_a_frame_takes_longer_to_compute_than_to_compare) {
  Lane lane(device());
  const FrameInputs inputs = upload(lane.gpu, furnished_room(96, 64).frame);
  EXPECT_TRUE(lane.last.is_worth_comparing(inputs)) << "nobody knows";
  lane.last.took(1000);
  EXPECT_TRUE(lane.last.is_worth_comparing(inputs));
  lane.last.took(1e-4);
  EXPECT_FALSE(lane.last.is_worth_comparing(inputs));
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

/// A frame with device depth between planes at 0.5 and 50, and normals in world space, of a camera that is turned by a
/// quarter.
HostFrame device_frame() {
  HostFrame frame = furnished_room(96, 64).frame;
  frame.depth_kind = DepthKind::device;
  frame.depth_range.near = 0.5, frame.depth_range.far = 50;
  for (float& z : frame.depth) z = z < kSky ? float((1 / 0.5 - 1 / double(z)) / (1 / 0.5 - 1 / 50.0)) : 1.0f;
  frame.camera.view_from_world = {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}};
  frame.normal_space = NormalSpace::world;
  const auto pixels = std::ptrdiff_t(frame.data.pixels());
  std::rotate(frame.normal.begin(), frame.normal.begin() + pixels, frame.normal.begin() + 2 * pixels);
  for (std::ptrdiff_t i = 0; i < pixels; i++) frame.normal[std::size_t(i)] = -frame.normal[std::size_t(i)];
  return frame;
}

// What options tell apart: reuse_options_test.
TEST(Reuse, is_not_of_the_same_planes_under_another_camera_or_reading) {
  const HostFrame frame = device_frame();
  const std::pair<const char*, std::function<void(HostFrame&)>> changes[] = {
      {"fy", [](HostFrame& f) { f.camera.fy *= 1.1; }},
      {"cy", [](HostFrame& f) { f.camera.cy += 3; }},
      {"orthographic", [](HostFrame& f) { f.camera.orthographic = true, f.camera.fx = f.camera.fy = 20; }},
      {"world to camera",
       [](HostFrame& f) {
         f.camera.view_from_world = {{{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}};
       }},
      {"no normals", [](HostFrame& f) { f.normal.clear(); }},
      {"half depth", [](HostFrame& f) { f.depth_is_half = true; }},
      {"noise", [](HostFrame& f) { f.data.x += 5, f.camera.cx += 5; }},
  };
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.3;
  settings.denoise = Denoise::box;
  const std::vector<float> before = alone(frame, settings, true);
  for (const auto& [what, change] : changes) {
    HostFrame other = frame;
    change(other);
    const std::vector<float> after = alone(other, settings, true);
    EXPECT_FALSE(same_bits(before, after)) << what << " tells nothing";
    Lane lane(device());
    next_of(lane, frame, settings, true);
    const Outcome there = next_of(lane, other, settings, true), back = next_of(lane, frame, settings, true);
    EXPECT_TRUE(same_bits(there.values, after)) << what;
    EXPECT_TRUE(same_bits(back.values, before)) << what << ", and back";
    EXPECT_EQ(there.kept + back.kept, 0u) << what;
    EXPECT_FALSE(there.is_same || back.is_same) << what;
  }
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

// An adaptive density.

EstimatorSettings adaptive(double radius, int spacing = 16) {
  EstimatorSettings settings;
  settings.radius = radius;
  settings.stride = spacing;
  return settings;
}

/// A room with strands a pixel wide before it, so that all lattices have sites.
HostFrame hairy_room(int width, int height) {
  HostFrame frame = furnished_room(width, height).frame;
  add_strands(frame);
  return frame;
}

TEST(Density, of_kept_tiles_is_that_of_a_fresh_run) {
  RandomScenes random(99);
  std::uint64_t kept = 0;
  int frames = 0;
  for (int scene = 0; scene < 7 && !HasFailure(); scene++) {
    EstimatorSettings settings = adaptive(scene % 2 ? 0.02 : 0.05, 16 >> (scene % 3));
    settings.estimator = scene == 3 ? Estimator::bitmask : Estimator::gtao;
    settings.slices = 1;
    settings.steps = 4;
    // At a quarter of the resolution the choice of sites reaches farther than a block of changes.
    const bool is_quarter = scene >= 5;
    if (is_quarter) settings.resolution = Resolution::quarter;
    HostFrame frame = is_quarter ? hairy_room(640, 480) : hairy_room(250, 190);
    Lane lane(device());
    const int count = long_tests() ? 25 : is_quarter ? 3 : 5;
    for (int i = 0; i < count && !HasFailure(); i++, frames++) {
      if (i > 0) change(frame, random);
      frame.frame = i;
      const Outcome next = next_of(lane, frame, settings);
      if (i > 0)  // a mistake in the first frame shows in the tiles that later frames keep
        EXPECT_TRUE(same_bits(next.values, alone(frame, settings))) << "scene " << scene << " frame " << i;
      kept += next.is_same ? 0 : next.kept;
    }
  }
  EXPECT_GT(kept, std::uint64_t(frames) * 150) << "tiles";
}

TEST(Density, of_a_still_scene_does_not_flicker) {
  HostFrame frame = hairy_room(180, 140);
  frame.frame = 1;
  const std::vector<float> first = ao_of(frame, adaptive(0.5));
  frame.frame = 2;
  EXPECT_TRUE(same_bits(ao_of(frame, adaptive(0.5)), first));
  EstimatorSettings animated = adaptive(0.5);
  animated.noise = Noise::animated;
  EXPECT_FALSE(same_bits(ao_of(frame, animated), first));
}

class ReuseOfFrames : public SequenceFolder {
 protected:
  void write_with_view_normals(int first, int last) const {
    FrameFile frame = wall_frame();
    turn_normals_to_view(frame);
    for (int i = first; i <= last; i++) frame.write(input(i));
  }

  /// The third of four frames is seen from elsewhere: the planes are the same, and mean other directions.
  void write_turning_cameras() const {
    json cameras = wall_camera();
    for (int frame = 1; frame <= 4; frame++) {
      json entry{{"frame", frame}, {"world_to_camera", cameras["world_to_camera"]}};
      if (frame == 3) entry["world_to_camera"] = {{0, -1, 0, 0.5}, {0, 0, 1, -2}, {-1, 0, 0, 3}, {0, 0, 0, 1}};
      cameras["frames"].push_back(entry);
    }
    write_bytes(camera, cameras.dump());
  }

  /// A sky that is red to one side and of another colour to the other.
  void write_sky(const std::string& name, const std::array<float, 3>& color) const {
    FrameFile sky{{0, 0, 32, 16}, {0, 0, 32, 16}, 1, {}, {}, {}};
    for (std::size_t c = 0; c < 3; c++)
      for (std::size_t i = 0; i < 512; i++)
        sky.planes[std::string(1, "RGB"[c])].push_back(i % 32 < 16 ? color[c] : c == 0 ? 1.0f : 0.2f);
    sky.write(folder / name);
  }

  /// The values of the light that a frame's surfaces reflect.
  std::vector<float> relight(int frame) const {
    const Image image = read_exr_image(output(frame));
    std::vector<float> values;
    for (const char* channel : {"relight.R", "relight.G", "relight.B"})
      std::ranges::copy(image.plane(channel), std::back_inserter(values));
    return values;
  }

  /// Runs, and expects the same files of a run that computes all of each frame. Returns the statistics. A GPU computes
  /// several frames at once: which one a frame comes after is not known there.
  json stats_of(const Options& more) const {
    const Options options = joined(more, typed("--threads 1 --set overwrite=true"));
    json stats = SequenceFolder::stats_of(options);
    const auto reused = outputs();
    EXPECT_FALSE(reused.empty());
    const json all = SequenceFolder::stats_of(joined(options, {"--no-skip"}));
    for (const auto& frame : all["frames"]) EXPECT_FALSE(frame["passes"].empty());
    for (const auto& [name, bytes] : outputs()) EXPECT_TRUE(reused.at(name) == bytes) << name;
    return stats;
  }
};

TEST_F(ReuseOfFrames, equal_frames_are_computed_once_for_each_at_once) {
  write_frames(1, 6);
  const json stats = stats_of({});
  int computed = 0;
  for (const auto& frame : stats["frames"]) {
    const json& tiles = frame["tiles"];
    const bool is_computed = !frame["passes"].empty();
    computed += is_computed;
    EXPECT_EQ(tiles[is_computed ? "computed" : "kept"], tiles["total"]);
    EXPECT_EQ(tiles[is_computed ? "kept" : "computed"], 0);
    if (!is_computed) EXPECT_EQ(frame["ms"]["compute"], 0);
  }
  EXPECT_EQ(stats["frames"].size(), 6);
  EXPECT_GT(computed, 0);
  EXPECT_LE(computed, stats["totals"]["at_once"]);
}

/// Values that are other in the frame of that number.
void brighten(FrameFile& frame, const std::string& channel, int number) {
  for (float& value : frame.planes.at("ViewLayer." + channel)) value *= 1 + 0.125f * float(number);
}

TEST_F(ReuseOfFrames, other_light_over_the_same_surfaces_is_composed_anew) {
  // So large that most of it is farther from the changed part than what a choice of sites depends on.
  const Window window{0, 0, 192, 108};
  FrameFile frame = wall_frame(window, window);
  write_bytes(camera, wall_camera(window).dump());
  add_beauty(frame);
  // In turn: all anew, the beauty, the same again, the indirect light, the beauty and a part of the depth, the diffuse
  // colour.
  const std::vector<std::function<void()>> changes = {[] {},
                                                      [&] { brighten(frame, "Combined.G", 1); },
                                                      [] {},
                                                      [&] { brighten(frame, "DiffInd.R", 3); },
                                                      [&] {
                                                        brighten(frame, "Combined.B", 2);
                                                        for (std::size_t i = 0; i < 9; i++)
                                                          frame.planes.at("ViewLayer.Depth.Z")[192 * 99 + i] *= 0.95f;
                                                      },
                                                      [&] { brighten(frame, "DiffCol.R", 1); }};
  for (std::size_t i = 0; i < changes.size(); i++) {
    changes[i]();
    frame.write(input(int(i) + 1));
  }
  const json stats = stats_of({"--composite", out + "/comp.%04d.exr", "--radius", "0.3", "--aov",
                               "ao,confidence,specular-occlusion,bent-normal"});
  ASSERT_EQ(stats["totals"]["at_once"], 1) << "else it is not known which frame a frame comes after";
  std::vector<int> kept, passes;
  for (const auto& report : stats["frames"]) {
    kept.push_back(report["tiles"]["kept"].get<int>());
    passes.push_back(int(report["passes"].size()));
  }
  const int all = kept[2];
  EXPECT_THAT(kept, ElementsAre(0, all, all, all, AllOf(testing::Gt(0), testing::Lt(all)), all));
  EXPECT_THAT(passes, ElementsAre(testing::Gt(0), testing::Gt(0), 0, testing::Gt(0), testing::Gt(0), testing::Gt(0)));
}

TEST_F(ReuseOfFrames, a_camera_that_turns_turns_the_directions) {
  write_frames(1, 4);
  write_turning_cameras();
  for (const std::string space : {"world", "view"}) {
    if (space == "view") write_with_view_normals(1, 4);
    stats_of({"--aov", "ao,normal,bent-normal", "--normal-space", space});
    // Normals in world space turn the other way in the view, and are as they were when they are written.
    const std::string told = space == "world" ? "Y" : "normal.X";
    const Image before = read_exr_image(output(2)), after = read_exr_image(output(3));
    EXPECT_FALSE(std::ranges::equal(before.plane(told), after.plane(told))) << space;
  }
}

TEST_F(ReuseOfFrames, light_that_changes_over_a_still_shot_is_each_frames_own) {
  write_frames(1, 4);
  write_sky("sky.1.exr", {1, 0.1f, 0.1f});
  write_sky("sky.2.exr", {0.1f, 0.1f, 1});
  write_sky("sky.3.exr", {0.1f, 1, 0.1f});
  write_sky("sky.4.exr", {0.1f, 1, 0.1f});
  for (const std::string threads : {"1", "2"}) {
    std::map<std::string, std::string> files[2];
    for (const bool reuses : {false, true}) {
      remove_outputs();
      done(joined({"--environment", folder / "sky.%d.exr", "--aov", "ao,relight", "--threads", threads},
                  reuses ? Options{} : Options{"--no-skip"}));
      files[reuses] = outputs();
    }
    for (const auto& [name, bytes] : files[0]) EXPECT_TRUE(files[1].at(name) == bytes) << name << ", " << threads;
    EXPECT_NE(relight(1), relight(2)) << threads;
    EXPECT_NE(relight(2), relight(3)) << threads;
    EXPECT_EQ(relight(3), relight(4)) << threads;
  }
}

TEST_F(ReuseOfFrames, a_camera_that_turns_turns_the_light) {
  write_with_view_normals(1, 4);
  write_turning_cameras();
  write_sky("sky.exr", {0.1f, 0.1f, 1});
  stats_of({"--environment", folder / "sky.exr", "--aov", "ao,relight,normal", "--set", "aov-space=view",
            "--normal-space", "view"});
  EXPECT_NE(relight(2), relight(3));
  EXPECT_EQ(relight(1), relight(4));
}

/// A frame with all that results are made of beside the visibility: a beauty, and materials' own AO.
FrameInputs upload_lit(gpu::Recorder& gpu, const HostFrame& frame) {
  std::vector<float> material(frame.data.pixels(), 1), beauty(3 * frame.data.pixels());
  for (std::size_t i = 0; i < material.size(); i += 7) material[i] = 0.5f;
  for (std::size_t i = 0; i < beauty.size(); i++) beauty[i] = 0.01f * float(i % 97);
  HostPlanes planes;
  planes[RawPlane::depth] = frame.depth;
  planes[RawPlane::normal] = frame.normal;
  planes[RawPlane::material_ao] = material;
  planes[RawPlane::beauty] = beauty;
  return upload(gpu, frame, planes, 0);
}

/// The AO, that of each radius, and the composite.
std::vector<float> results_in(const FrameOutputs& outputs) {
  std::vector<float> values;
  for (const auto* planes : {outputs.ao, outputs.scales, outputs.composite}) {
    const std::vector<float> plane = test::values_of(planes);
    values.insert(values.end(), plane.begin(), plane.end());
  }
  return values;
}

TEST(Reuse, of_what_is_seen_gives_every_shaping_the_bits_of_a_run_of_its_own) {
  const HostFrame frame = furnished_room(96, 64).frame;
  std::vector<Settings> looks(6);
  looks[1].estimator.intensity = 1.6;
  looks[2].estimator.power = 0.7;
  looks[2].estimator.least = 0.3;
  looks[3].estimator.fade_start = 1;
  looks[3].estimator.fade_end = 6;
  looks[4].output.look = {0.1, 1.5, {0.2, 0.1, 0}, 0.8};
  const std::vector<std::function<void(EstimatorSettings&)>> searches{
      [](auto&) {}, [](auto& s) { s.search = SliceSearch::quick; }, [](auto& s) { s.further_radii = {0.2}; },
      [](auto& s) { s.resolution = Resolution::half; }, [](auto& s) { s.estimator = Estimator::crytek; }};
  for (const auto& search : searches) {
    gpu::Recorder gpu(device());
    std::optional<FrameVisibility> visible;
    FrameInputs inputs;
    for (auto& look : looks) {
      look.estimator.radius = 0.5;
      look.output.aovs = "ao,ao-scales";
      search(look.estimator);
      if (!visible) {
        inputs = upload_lit(gpu, frame);
        visible = frame_visibility(gpu, inputs, look.estimator, look.output);
        gpu.run();
      }
      const FrameOutputs outputs = results_of(gpu, inputs, *visible, look.estimator, look.output);
      gpu.run();
      for (const auto& pass : gpu.passes()) EXPECT_TRUE(pass.name == "shape" || pass.name == "composite") << pass.name;
      const std::vector<float> shared = results_in(outputs);
      const FrameOutputs own = run_chain(recorder(), upload_lit(recorder(), frame), look.estimator, look.output);
      recorder().run();
      EXPECT_TRUE(same_bits(shared, results_in(own))) << &look - looks.data() << " " << name_of(look.estimator);
    }
  }
}

}  // namespace
}  // namespace alcove::reuse_test
