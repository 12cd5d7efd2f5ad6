// --accumulate where frames differ: turned cameras, other windows, damaged files, and a shot that grows; how many
// estimates are kept; and runs that stop.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_run.h"
#include "tests/support/device.h"
#include "tests/support/walked_shot.h"

namespace alcove::accumulate_shots_test {
namespace {

using namespace test;

const MemoryBudget kLargeBudget{.bytes = 1 << 30, .buffer_bytes = 1 << 30};

/// Frames of a shot whose estimates are taken one after the other.
struct TakenShot {
  TakenShot(const FramePlan& frames, std::span<const int> order) : plan(frames), shot(frames, nullptr, order) {}

  NeighbourEstimates estimates_of(int frame) {
    PreparationCost cost;
    return shot.estimates_of(frame, [&](int other) { return estimate_frame(lane, run, kLargeBudget, other, cost); });
  }
  EstimateSet filled(const NeighbourEstimates& taken, int frame) {
    return lane.estimates.filled(lane.gpu, plan, taken, frame, kLargeBudget.buffer_bytes);
  }

  const FramePlan& plan;
  SharedFrames shot;
  RunPreview look{plan.settings()};
  InputIdentities identities{plan};
  RunContext run{look, plan, identities, nullptr, nullptr, &shot, true, {}};
  Lane lane{device()};
};

class AccumulatedShots : public WalkedShot {
 protected:
  /// What a run that must succeed writes for a frame.
  std::vector<float> planes(int frame, const Options& more) const {
    done(joined({"--type", "float"}, more));
    return read_exr_image(output(frame)).pixels;
  }
};

TEST_F(AccumulatedShots, directions_of_a_turned_camera_are_turned_back) {
  // The second frame is the first upside down, as a camera sees it that is rolled by half a turn.
  constexpr Window kSquare{0, 0, 64, 64};
  FrameFile file = wall_frame(kSquare, kSquare);
  put_board(file, 0, {-1.2, 0.4, 0.5, 5.5});
  json cameras = wall_camera(kSquare);
  json rolled = cameras["world_to_camera"];
  for (const int row : {0, 1})
    for (auto& x : rolled[std::size_t(row)]) x = -x.get<double>();
  cameras["frames"] = {{{"frame", 1}, {"world_to_camera", cameras["world_to_camera"]}},
                       {{"frame", 2}, {"world_to_camera", rolled}}};
  write_bytes(camera, cameras.dump());
  file.write(input(1));
  for (auto& [name, plane] : file.planes) std::ranges::reverse(plane);
  file.write(input(2));

  for (const char* space : {"world", "view"}) {
    const Options alone = typed(std::string("--set stride=1 --denoise none --slices 32 --steps 32 --aov bent-normal "
                                            "--set complete=none --set aov-space=") +
                                space);
    const auto truth = planes(1, alone), found = planes(1, joined(alone, {"--accumulate", "1"}));
    EXPECT_NE(found, truth) << "nothing of the other frame counts";
    EXPECT_LT(difference(found, truth).rmse, 0.01) << space;
  }
}

TEST_F(AccumulatedShots, frames_of_other_windows_have_the_bits_that_they_have_alone) {
  constexpr int kFrames = 8;
  write_shot(kFrames, {0, 0, 64, 40});
  for (const int frame : {3, 4, 5}) {
    // A part of the frame, of another size and another place.
    const FrameFile whole = with_board(frame, {0, 0, 64, 40});
    FrameFile part = wall_frame({0, 0, 48, 30}, {0, 0, 48, 30});
    part.data = {8, 4, 48, 30};
    part.display = {0, 0, 64, 40};
    for (auto& [name, plane] : part.planes)
      for (int y = 0; y < 30; y++)
        for (int x = 0; x < 48; x++)
          plane[std::size_t(y * 48 + x)] = whole.planes.at(name)[std::size_t((y + 4) * 64 + x + 8)];
    part.write(input(frame));
  }
  const Options options = typed("--accumulate 1 --threads 1");
  planes(1, options);
  const auto together = outputs();
  for (int frame = 1; frame <= kFrames; frame++) {
    planes(frame, joined(options, {"--frames", std::to_string(frame)}));
    EXPECT_TRUE(outputs() == together) << frame;
  }
}

TEST_F(AccumulatedShots, sets_at_the_same_place_do_not_move_each_other) {
  constexpr int kCut = 3;
  write_shot(2 * kCut);
  const Options options = typed("--accumulate 2 --radius 1.5");
  ASSERT_GT(stats_of(joined(options, {"--frames", "3"}))["frames"][0]["frames_per_pixel"], 3) << "without a cut";
  // A set with the same floor, but another wall, and without the board.
  for (int frame = kCut + 1; frame <= 2 * kCut; frame++) {
    FrameFile file = wall_frame();
    put_board(file, kStep * frame, {-20, 20, 20, 5});
    file.write(input(frame));
  }
  const json frames = stats_of(options)["frames"];
  for (int frame = 1; frame <= 2 * kCut; frame++) {
    const auto of = attribute_of_whole_exr(output(frame), "alcove/accumulated");
    EXPECT_EQ(of, frame <= kCut ? "frames 1-3" : "frames 4-6") << frame;
    EXPECT_GT(frames[std::size_t(frame - 1)]["frames_per_pixel"], 2) << frame;
  }
}

TEST_F(AccumulatedShots, no_more_estimates_are_kept_than_are_counted_whatever_the_order) {
  constexpr int kLong = 20;
  write_shot(kLong, {0, 0, 16, 9});
  Settings settings = settings_of_shot();
  settings.input.accumulate = 1;
  const FramePlan plan(settings);
  const FrameSource source = open_frame(plan.at(4), 4);
  // Depth, normal and AO of an estimate, and what was read: depth and three of a normal.
  const std::uint64_t bytes = (3 + 4) * sizeof(float) * source.reading.data.pixels();
  std::vector<std::weak_ptr<const EstimatedFrame>> all;
  const auto most_kept = [&](std::span<const int> frames, std::size_t lanes) {
    TakenShot taking(plan, frames);
    SharedFrames& shot = taking.shot;
    std::size_t most = 0;
    for (std::size_t i = 0; i < frames.size(); i++) {
      shot.begin(frames[i]);
      const NeighbourEstimates taken = taking.estimates_of(frames[i]);
      EXPECT_EQ(taken.of.size(), 3u);
      taking.filled(taken, frames[i]);
      all.insert(all.end(), taken.of.begin(), taken.of.end());
      most = std::max(most, shot.estimated_count());
      if (i + 1 >= lanes) shot.done(frames[i + 1 - lanes]);
    }
    for (const int frame : frames) shot.done(frame);
    EXPECT_TRUE(std::ranges::all_of(all, [](const auto& one) { return one.expired(); })) << "somebody else keeps them";
    return most;
  };
  std::vector<int> along, back, in_turns, to_and_fro;
  for (int frame = 1; frame <= kLong; frame++) along.push_back(frame);
  back.assign(along.rbegin(), along.rend());
  for (const int first : {1, 2})
    for (int frame = first; frame <= kLong; frame += 2) in_turns.push_back(frame);
  for (int frame = 1; frame <= kLong / 2; frame++) to_and_fro.insert(to_and_fro.end(), {frame, kLong + 1 - frame});
  for (const auto& [frames, expected] :
       {std::pair(along, std::pair(4u, 5u)), {back, {4u, 5u}}, {in_turns, {6u, 8u}}, {to_and_fro, {6u, 7u}}})
    for (const int lanes : {1, 2}) {
      const std::uint64_t counted = bytes_of_estimates(plan, source, settings, frames, lanes);
      EXPECT_EQ(counted, bytes * (lanes == 1 ? expected.first : expected.second)) << testing::PrintToString(frames);
      EXPECT_LE(most_kept(frames, std::size_t(lanes)) * bytes, counted) << testing::PrintToString(frames) << lanes;
    }
}

TEST_F(AccumulatedShots, where_fewer_frames_count_as_many_are_listed) {
  write_shot(5, {0, 0, 16, 9});
  Settings settings = settings_of_shot();
  settings.input.accumulate = 2;
  const FramePlan plan(settings);
  TakenShot taking(plan, plan.frames());
  NeighbourEstimates taken = taking.estimates_of(3);
  for (const uint count : {4u, 3u, 1u}) {
    const auto is_other = [](const auto& estimated) { return estimated->frame != 3; };
    while (taken.of.size() > count + 1) taken.of.erase(std::ranges::find_if(taken.of, is_other));
    const EstimateSet set = taking.filled(taken, 3);
    ASSERT_EQ(set.groups.size(), 1u);
    EXPECT_EQ(set.groups[0].count, count);
    EXPECT_EQ(set.groups[0].listed, 4u);
  }
}

TEST_F(AccumulatedShots, no_more_of_what_estimates_see_is_kept_than_is_counted) {
  constexpr int kLong = 24;
  write_shot(kLong, {0, 0, 16, 9});
  Settings settings = settings_of_shot();
  settings.input.accumulate = 2;
  const auto counted = [&] {
    const FramePlan plan(settings);
    return bytes_of_shot(plan, open_frame(plan.at(4), 4), settings.input, 1) / (3 * sizeof(float) * 16 * 9);
  };
  EXPECT_EQ(counted(), 0u);
  settings.input.motion = in + "/f.####.exr";
  EXPECT_GE(counted(), 2u * 3 + 1) << "vectors are proved by the frames beside those of a mean";
  settings.input.motion.clear();
  settings.input.around = 1;
  const FramePlan plan(settings);
  TakenShot taking(plan, plan.frames());
  SharedFrames& shot = taking.shot;
  for (const int frame : plan.frames()) {
    shot.begin(frame);
    taking.estimates_of(frame);
    EXPECT_LE(shot.views().count(), counted()) << frame;
    shot.done(frame);
  }
}

TEST_F(AccumulatedShots, a_damaged_frame_fails_all_that_take_it_by_name) {
  write_shot(11);
  fs::resize_file(input(6), fs::file_size(input(6)) - 10);
  // What moves in a frame around is told by two more.
  for (const auto& [option, first, last] : {std::tuple("--accumulate", 5, 7), {"--around", 3, 9}}) {
    const Finished finished = run({option, "1", "--keep-going"});
    EXPECT_EQ(finished.code, 1) << finished;
    EXPECT_THAT(lines_of(finished.err).back(),
                HasSubstr(fmt::format("{} failed ({}-{})", last - first + 1, first, last)));
    for (int frame = first; frame <= last; frame++)
      EXPECT_THAT(finished.err, ContainsRegex(fmt::format("error: frame {}: .*f.0006.exr", frame)));
  }
}

// A rendered frame: what a cut leaves of it, a second one changes.
TEST_F(AccumulatedShots, ramps_are_cut_once_for_the_estimate_and_its_frame_as_a_whole_and_in_tiles) {
  const std::string example = ALCOVE_SOURCE_DIR "/examples/interior.";
  for (int frame = 1; frame <= 3; frame++) fs::copy_file(example + "gbuffer.exr", input(frame));
  const auto made = [&](const std::string& more, std::uint64_t mebibytes) {
    const Options all = typed("--radius 0.08 --frames 2 --type float --set ramps=cut --camera " + example +
                              "camera.json --stats " + folder / "stats.json" + " " + more);
    const RunReport report = run_here(arguments(all), mebibytes << 20);
    EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
    EXPECT_EQ(report.done == 1 && report.frames[0].parts > 1, mebibytes > 0);
    EXPECT_THAT(attribute_of_whole_exr(output(2), "alcove/notes").value_or(""), HasSubstr("smoothed-depth"));
    return read_exr_image(output(2)).pixels;
  };
  EXPECT_TRUE(made("--aov depth --accumulate 1", 0) == made("--aov depth", 0));
  EXPECT_TRUE(made("--aov ao,depth --accumulate 1", 118) == made("--aov ao,depth --accumulate 1", 0));
}

TEST_F(AccumulatedShots, a_run_that_stops_ends_among_the_estimates_of_its_first_frame) {
  constexpr int kFrames = 9, kStop = 8;
  write_shot(kFrames);
  int asked = 0;
  RunWatch watch;
  watch.stop = [&] { return ++asked >= kStop; };
  const RunReport report = run_here(arguments(typed("--accumulate 4 --threads 1")), 0, watch);
  EXPECT_EQ(report.done, 0);
  EXPECT_EQ(report.dropped, kFrames);
  EXPECT_LE(asked, kStop + 1) << "once more, before the next frame";
  EXPECT_TRUE(outputs().empty());
}

TEST_F(AccumulatedShots, resume_redoes_all_that_take_a_frame_that_is_new_or_was_written_again) {
  write_shot(6);
  const std::string first = read_bytes(input(1));
  fs::remove(input(1));
  done({"--accumulate", "1"});
  write_bytes(input(1), first);
  const Options options = typed("--accumulate 1 --resume");
  done(options);
  const auto resumed = outputs();
  expect_same_outputs(resumed, {{"--accumulate", "1"}});
  EXPECT_THAT(done(options).err, HasSubstr("6 kept"));
  // As large as it was, and the same at both ends: the time alone tells it.
  fs::last_write_time(input(1), fs::last_write_time(output(6)) + std::chrono::seconds(1));
  const Finished finished = done(options);
  for (const int frame : {1, 2}) EXPECT_THAT(finished.err, HasSubstr(input(frame) + " -> ")) << frame;
  EXPECT_THAT(finished.err, HasSubstr(output(6) + ": whole, kept")) << "which does not take it";
}

TEST_F(AccumulatedShots, a_folder_of_stats_that_another_run_has_taken_away_is_made_again) {
  write_shot(2);
  RunWatch watch;
  watch.frame = [&](const FrameReport&) { fs::remove(folder / "new"); };
  EXPECT_EQ(run_here(arguments({"--stats", folder / "new/stats.json"}), 0, watch).done, 2);
  EXPECT_TRUE(fs::exists(folder / "new/stats.json"));
}

}  // namespace
}  // namespace alcove::accumulate_shots_test
