// What the frames of a shot take from each other: the same whatever is computed beside them, each read once.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/estimates.h"
#include "core/run/frame_files.h"
#include "core/run/memory.h"
#include "core/run/plan.h"
#include "core/run/resume.h"
#include "tests/support/device.h"
#include "tests/support/openexr.h"
#include "tests/support/walked_shot.h"

namespace alcove::shot_test {
namespace {

using namespace test;
using testing::Eq;

constexpr int kFrames = 7;

class Shots : public WalkedShot {
 protected:
  Shots() { write_shot(kFrames); }

  /// The first surface that a frame hides, as it is written.
  std::vector<float> hidden(int frame) const { return read_exr_image(output(frame), {"hidden1.Z"}).pixels; }
  json stats_of_hidden(int frame, const Options& more) const {
    return stats_of(joined(typed(fmt::format("--frames {} --aov hidden --type float", frame)), more))["frames"][0];
  }
  std::vector<float> ao_of(int frame, const std::string& more) const {
    done(typed(fmt::format("--frames {} --type float {}", frame, more)));
    return read_exr_image(output(frame)).pixels;
  }
  std::string header(int frame, const char* attribute = "alcove/hidden") const {
    return attribute_of_whole_exr(output(frame), attribute).value_or("");
  }
};

TEST_F(Shots, each_frame_is_read_once_for_all_around_it) {
  std::uint64_t rows = 0;
  const json frames = stats_of({"--around", "2", "--threads", "1"})["frames"];
  for (const auto& frame : frames) rows += frame["rows_read"].get<std::uint64_t>();
  EXPECT_EQ(rows, 2 * kFrames * 36) << "once as itself, and once as one of those around";
  EXPECT_THAT(frames[0]["frames_around"], Eq(json({2, 3})));
  EXPECT_THAT(frames[3]["frames_around"], Eq(json({2, 3, 5, 6})));
}

TEST_F(Shots, dry_runs_count_the_reads_and_estimates_of_a_run) {
  for (const std::string more :
       {"--around 2", "--around 1 --frames 4", "--around 2 --frames 5-7", "--around all --frames 2", "--accumulate 1",
        "--accumulate 2 --frames 4", "--accumulate 1 --around 1 --frames 3-4"}) {
    const auto told = [text = done(typed(more + " --dry-run")).out](const std::string& what) {
      const std::size_t end = text.rfind(" " + what + " for ");
      EXPECT_NE(end, text.npos) << text;
      return std::atoi(text.substr(0, end).substr(text.rfind(' ', end - 1)).c_str());
    };
    std::uint64_t rows = 0;
    const json frames = stats_of(typed(more + " --threads 1"))["frames"];
    for (const auto& frame : frames) rows += frame["rows_read"].get<std::uint64_t>();
    // An estimate reads its frame, which is not read again.
    EXPECT_EQ(more.starts_with("--around") || more.ends_with("3-4") ? told("reads") : told("estimates"), rows / 36)
        << more;
  }
  EXPECT_THAT(done(typed("--around 2 --dry-run")).out, HasSubstr("; 14 reads for 7 frames, 2 for each\n"));
  EXPECT_THAT(done(typed("--accumulate 2 --frames 4 --dry-run")).out,
              HasSubstr("; 5 estimates for 1 frame, 5 for each\n"));
}

TEST_F(Shots, headers_name_the_frames_that_were_taken) {
  const std::tuple<const char*, const char*, const char*, const char*> rows[] = {
      {"--around 2", "alcove/hidden", "frames 2-3", "frames 2-3, 5-6"},
      {"--around all", "alcove/hidden", "frames 2-7", "frames 1-3, 5-7"},
      {"", "alcove/hidden", "", ""},
      {"--accumulate 1", "alcove/accumulated", "frames 1-3", "frames 3-5"},  // near an end more of the other side
      {"", "alcove/accumulated", "", ""}};
  for (const auto& [more, attribute, first, middle] : rows) {
    done(joined({"--frames", "1,4", "--threads", "1"}, typed(more)));
    EXPECT_EQ(header(1, attribute), first) << more;
    EXPECT_EQ(header(4, attribute), middle) << more;
  }
}

TEST_F(Shots, missing_frames_are_an_error_or_left_out) {
  fs::remove(input(4));
  expect_refused(3, typed("--around 2 --frames 2"), {"f.0004.exr", "--around", "--set missing=skip"});
  expect_refused(3, typed("--accumulate 2 --frames 3"), {"f.0004.exr", "--accumulate", "--set missing=skip"});
  const Finished skipped = done(typed("--around 2 --set missing=skip --aov depth,hidden"));
  EXPECT_EQ(lines_of(skipped.err).front(),
            "alcove: warning: " + in +
                "/f.%04d.exr: a frame of the shot is missing: 4; their neighbours do without, as their headers say "
                "(--set missing=skip) [sequence-hole]");
  EXPECT_EQ(header(3), "frames 1-2, 5; missing 4");
  EXPECT_EQ(header(1), "frames 2-3");
  done(typed("--accumulate 1 --set missing=skip"));
  EXPECT_EQ(header(3, "alcove/accumulated"), "frames 2-3; missing 4");
}

TEST_F(Shots, of_one_frame_have_none_around_it) {
  for (int frame = 2; frame <= kFrames; frame++) fs::remove(input(frame));
  const auto run_single = [&](const std::string& file, const char* around) {
    return run_program({"run", file, "-o", output(1), "--camera", camera, "--radius", "1", "--around", around});
  };
  for (const char* around : {"3", "all"}) {
    done({"--around", around});
    EXPECT_EQ(header(1), "");
    test::expect_refused(run_single(input(1), around), 2, {"--around", "such as " + in + "/f.####.exr"});
  }
  fs::copy_file(input(1), folder / "wall.exr");
  EXPECT_THAT(run_single(folder / "wall.exr", "3").err, HasSubstr("such as shot.####.exr"));
}

TEST_F(Shots, resumed_runs_compute_what_a_changed_neighbour_changes) {
  done(typed("--around 1 --aov depth,hidden"));
  FrameFile changed = with_board(1);
  changed.planes.at("ViewLayer.Depth.Z")[0] = 5;
  changed.write(input(1));
  fs::last_write_time(input(1), fs::last_write_time(input(2)));
  std::vector<int> computed;
  const json frames = stats_of(typed("--around 1 --aov depth,hidden --resume"))["frames"];
  for (const auto& frame : frames)
    if (frame["state"] == "done") computed.push_back(frame["frame"]);
  // Frame 1 tells what moves in 2 and 3, which 4 takes.
  EXPECT_THAT(computed, ElementsAre(1, 2, 3, 4));
}

TEST_F(Shots, have_an_identity_when_a_camera_beside_theirs_goes_away) {
  Settings settings = settings_of_shot();
  settings.input.camera = folder / "camera.%d.json";
  settings.input.around = 1;
  for (int frame = 1; frame <= kFrames; frame++)
    fs::copy_file(camera, fmt::format("{}/camera.{}.json", folder.path(), frame));
  const FramePlan plan(settings);
  const std::string before = InputIdentities(plan).of(2);
  fs::remove(folder / "camera.3.json");
  std::string after;
  EXPECT_NO_THROW(after = InputIdentities(plan).of(2));
  EXPECT_NE(after, before);
}

TEST_F(Shots, need_to_know_where_every_camera_stands_and_one_projection) {
  json cameras = json::parse(read_bytes(camera));
  json two = cameras;
  two["frames"][3]["projection"] = "orthographic";
  write_bytes(camera, two.dump());
  expect_refused(3, typed("--around 1 --frames 3"), {"orthographic", "frame 4", "--camera"});
  cameras.erase("world_to_camera");
  cameras["frames"][3].erase("world_to_camera");
  cameras["normal_space"] = "view";
  write_bytes(camera, cameras.dump());
  for (int frame = 1; frame <= kFrames; frame++) {
    FrameFile file = with_board(frame);
    turn_normals_to_view(file);
    file.write(input(frame));
  }
  expect_refused(3, typed("--around 2 --frames 2"), {"f.0004.exr", "frame 4", "--camera"});
}

TEST_F(Shots, know_the_frames_around_each) {
  Settings settings = settings_of_shot();
  settings.input.around = 1;
  const FramePlan plan(settings);
  EXPECT_THAT(plan.around(7, 1).there, ElementsAre(6));
  EXPECT_THAT(witnesses_of(plan, 4), ElementsAre(2, 3, 5, 6));
  EXPECT_THAT(witnesses_of(plan, 1), ElementsAre(2, 3, 4, 5)) << "at the ends of the shot the others are on one side";
  EXPECT_THAT(witnesses_of(plan, 6), ElementsAre(3, 4, 5, 7));
  EXPECT_THAT(frames_seen_for(plan, 4), ElementsAre(1, 2, 3, 5, 6, 7));
  EXPECT_THAT(frames_seen_for(plan, 1), ElementsAre(2, 3, 4, 5));
  settings.input.around = 3;
  EXPECT_THAT(witnesses_of(FramePlan(settings), 4), ElementsAre(1, 2, 3, 5, 6, 7));
  settings.input.accumulate = 1;
  const FramePlan means(settings);
  EXPECT_THAT(means.accumulated(7).there, ElementsAre(5, 6, 7));
  EXPECT_EQ(means.slot_of(2), means.slot_of(5));
  EXPECT_NE(means.slot_of(2), means.slot_of(3));
}

TEST_F(Shots, keep_no_more_frames_than_their_windows) {
  constexpr int kLong = 16;
  write_shot(kLong, {0, 0, 16, 9});
  Settings settings = settings_of_shot();
  settings.input.around = 2;
  for (const char* order : {"1-16", "16-1", "1-16x3,2-16x3,3-16x3"}) {
    settings.frames.frames = order;
    const FramePlan plan(settings);
    SharedFrames shared(plan, nullptr, plan.frames());
    gpu::Recorder gpu(device());
    for (const int frame : plan.frames()) {
      PreparationCost cost;
      FrameSource target = open_frame(plan.at(frame), frame);
      shared.begin(frame);
      shared.views().of(gpu, target, frame, cost);
      EXPECT_LE(shared.views().count(), std::size_t(2 * farthest_seen(2) + 1)) << order << " " << frame;
      EXPECT_GE(shared.views().count(), 5u) << order << " " << frame;
      shared.done(frame);
    }
    EXPECT_EQ(shared.views().count(), 0u);
  }
}

/// Frames that are so large that their number matters.
TEST_F(Shots, tell_how_many_frames_memory_has_room_for) {
  const Window large{0, 0, 480, 270};
  for (int frame = 1; frame <= kFrames; frame++) fs::remove(input(frame));
  write_frames(1, kFrames, wall_frame(large, large));
  write_bytes(camera, wall_camera(large).dump());
  const Finished refused = run(typed("--around all --threads 2 --thickness 0.2 --memory 182M"));
  test::expect_refused(refused, 2, {"f.0001.exr", "--around ", "--memory "});
  EXPECT_EQ(run(typed("--around all --threads 2 --thickness 0.2 --memory 182M --dry-run")).code, 2);
  const std::string enough = refused.err.substr(refused.err.find("or --memory ") + 3);
  done(joined(typed("--around all --threads 2 --thickness 0.2 --frames 4"),
              typed(enough.substr(0, enough.find_first_of("\n ", 9)))));
}

/// Adds motion vectors of what stands still, as Blender writes them: to the place in the frame before.
void add_motion(FrameFile& file, float factor) {
  const auto& depth = file.planes.at("ViewLayer.Depth.Z");
  auto& x = file.planes["ViewLayer.Vector.X"] = std::vector<float>(depth.size());
  file.planes["ViewLayer.Vector.Y"] = std::vector<float>(depth.size());
  for (std::size_t i = 0; i < depth.size(); i++) x[i] = factor * float(kStep) / depth[i] * 60;
}

TEST_F(Shots, take_what_motion_vectors_prove_to_stand_still) {
  for (int frame = 1; frame <= kFrames; frame++) {
    FrameFile file = with_board(frame);
    add_motion(file, 1);
    // The middle of the board would move.
    for (const std::size_t y : {16, 17, 18})
      for (std::size_t x = 30; x < 34; x++) file.planes.at("ViewLayer.Vector.Y")[64 * y + x] = 3;
    file.write(input(frame));
  }
  const auto numbers = [&](const Options& more) {
    const json frame = stats_of_hidden(5, joined({"--around", "2"}, more));
    return std::pair(frame["moved"].get<int>(), frame["unconfirmed"].get<int>());
  };
  const auto [moved, unconfirmed] = numbers({});
  EXPECT_GT(unconfirmed, 0) << "the last frame alone sees the wall at its right border";
  constexpr int kMoving = 5 * 6;  // pixels of a frame, with those beside them
  const auto by_vectors = numbers({"--motion", in + "/f.%04d.exr"});
  EXPECT_EQ(by_vectors, std::pair(moved + 4 * kMoving, 0)) << "vectors confirm what no other frame sees";
  // This camera's steps are all the same, so that the way back is the way on. The last frame's vectors lead nowhere.
  const auto of_next = numbers({"--motion", in + "/f.%04d.exr", "--set", "motion-kind=next"});
  EXPECT_EQ(of_next, std::pair(moved + 3 * kMoving, unconfirmed));
}

/// A box that rests for five frames where a post hides it in the ninth, and has gone before.
TEST_F(Shots, take_nothing_of_what_rested_and_has_left) {
  constexpr int kTarget = 9;
  constexpr double kStride = 0.2;
  json cameras = wall_camera();
  for (int frame = 1; frame <= kTarget; frame++) {
    json matrix = cameras["world_to_camera"];
    matrix[0][3] = -kStride * frame;
    cameras["frames"].push_back({{"frame", frame}, {"world_to_camera", matrix}});
    FrameFile file = wall_frame();
    if (frame <= 5) put_board(file, kStride * frame, {0, 0.6, 0.3, 4});
    put_board(file, kStride * frame, {0.98, 1.22, 0.4, 2});
    add_motion(file, float(kStride / kStep));
    file.write(input(frame));
  }
  write_bytes(camera, cameras.dump());
  for (const Options& more : {typed("--around 8"), typed("--around all"),  // it rests by its vectors too
                              typed("--around 8 --motion " + in + "/f.%04d.exr")}) {
    stats_of_hidden(kTarget, more);
    const std::vector<float> planes = hidden(kTarget);
    EXPECT_GT(std::ranges::count_if(planes, [](float z) { return std::abs(z - 6) < 0.01f; }), 50)
        << "the wall behind the post";
    EXPECT_EQ(std::ranges::count_if(planes, [](float z) { return std::abs(z - 4) < 0.1f; }), 0)
        << testing::PrintToString(more);
  }
}

TEST_F(Shots, refuse_motion_vectors_that_no_camera_agrees_with) {
  for (int frame = 1; frame <= kFrames; frame++) {
    FrameFile file = with_board(frame);
    add_motion(file, 3.7f);
    file.write(input(frame));
  }
  expect_refused(3, {"--around", "2", "--frames", "1", "--motion", in + "/f.%04d.exr"},
                 {"f.000", "--set motion-channels", "--set motion-kind"});
}

/// One of a file's views, as a part.
DeepFilePart view_of(const FrameFile& file, const std::string& name) {
  DeepFilePart part;
  part.data = kWallWindow;
  part.name = part.view = name;
  part.is_flat = true;
  part.channels.clear();
  part.pixels.assign(kWallWindow.pixels(), {{}});
  for (const auto& [channel, plane] : file.planes) {
    part.channels.push_back(channel);
    for (std::size_t i = 0; i < plane.size(); i++) part.pixels[i][0].push_back(plane[i]);
  }
  return part;
}

TEST_F(Shots, other_views_are_those_of_the_same_instant) {
  const std::string stereo = folder / "stereo.exr";
  write_deep(stereo, {view_of(with_board(1), "left"), view_of(with_board(2), "right")});
  const auto run_stereo = [&](const json& cameras, const std::string& more) {
    write_bytes(camera, cameras.dump());
    return run_program(typed("run " + stereo + " -o " + output(1) + " --camera " + camera + " --radius 1 " + more));
  };
  json cameras = wall_camera();
  test::expect_refused(run_stereo(cameras, "--set other-views=true"), 3, {"stereo.exr", "--camera", "views"});
  for (int frame = 1; frame <= 2; frame++) {
    json matrix = cameras["world_to_camera"];
    matrix[0][3] = -kStep * frame;
    cameras["views"][frame == 1 ? "left" : "right"]["world_to_camera"] = matrix;
  }
  const Finished finished = run_stereo(cameras, "--set other-views=true --aov ao,depth,hidden --type float");
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_EQ(header(1), "views right");
  const std::vector<float> behind = hidden(1), ao = read_exr_image(output(1), {"Y"}).pixels;
  const std::vector<float> wall = wall_frame().planes.at("ViewLayer.Depth.Z");
  int found = 0;
  for (std::size_t i = 0; i < behind.size(); i++) {
    if (behind[i] >= 1e9f) continue;
    found++;
    EXPECT_NEAR(behind[i], wall[i], 1e-4 * double(wall[i])) << i;
  }
  EXPECT_GT(found, 20) << "a step to the side shows a column or two of the wall behind the board";
  EXPECT_EQ(run_stereo(cameras, "--aov ao --type float").code, 0);
  EXPECT_NE(read_exr_image(output(1), {"Y"}).pixels, ao);
  EXPECT_EQ(run_stereo(cameras, "--set other-views=true --view right --aov depth,hidden").code, 0);
  EXPECT_EQ(header(1), "views left");
  expect_refused(3, typed("--set other-views=true --frames 1"), {"f.0001.exr", "--set other-views"});
}

TEST_F(Shots, take_memory_for_the_frames_around_and_for_motion_vectors) {
  Settings settings = settings_of_shot();
  std::uint64_t frame_before = 0, shot_before = 0;
  for (const int around : {0, 1, 2, 3}) {
    settings.input.around = around;
    const FramePlan plan(settings);
    const FrameSource source = open_frame(plan.at(4), 4);
    const std::uint64_t of_frame = memory_with_others(plan, source, settings).of(source.reading.data).host;
    const std::uint64_t of_shot = bytes_of_shot(plan, source, settings.input, 1);
    // Two frames to each side tell what moves, if no more are taken.
    EXPECT_GE(of_frame, frame_before + (around == 2 ? 0 : 1)) << around;
    EXPECT_GE(of_shot, shot_before) << around;
    frame_before = of_frame, shot_before = of_shot;
  }
  EXPECT_EQ(shot_before, kFrames * 12 * kWallWindow.pixels()) << "there are no more";

  const auto bytes_with = [&](const std::string& motion, const std::string& channels, int around, int accumulate) {
    settings.input.motion = motion;
    settings.input.motion_channels = channels;
    settings.input.around = around;
    settings.input.accumulate = accumulate;
    const FramePlan plan(settings);
    return memory_with_others(plan, open_frame(plan.at(4), 4), settings).fixed_bytes;
  };
  const std::string motion = in + "/f.####.exr";
  for (const auto& [around, accumulate] : {std::pair(1, 0), {0, 1}}) {
    const std::uint64_t without = bytes_with("", "", around, accumulate);
    EXPECT_GE(bytes_with(motion, "", around, accumulate) - without, 16 * kWallWindow.pixels()) << "two pairs";
    EXPECT_GE(bytes_with(motion, "Vector.X,Vector.Y", around, accumulate) - without, 8 * kWallWindow.pixels());
  }
}

TEST_F(Shots, need_buffers_for_whole_frames) {
  Settings settings = settings_of_shot();
  settings.input.around = 1;
  const FrameSource source = open_frame(FramePlan(settings).at(4), 4);
  const std::uint64_t plane = sizeof(float) * kWallWindow.pixels();
  const auto refusal = [&](std::uint64_t most_bytes) -> std::string {
    try {
      require_buffers_for_others(most_bytes, source, settings);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::device);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(3 * plane), "");
  EXPECT_THAT(refusal(2 * plane), AllOf(HasSubstr("f.0004.exr"), HasSubstr("--around"), HasSubstr("--normal none")));
  EXPECT_THAT(refusal(plane - 1), AllOf(HasSubstr("--around"), HasSubstr("--device"), Not(HasSubstr("--normal"))));
  settings.input.around = 0;
  EXPECT_EQ(refusal(1), "") << "a frame alone is cut into tiles";
  settings.input.accumulate = 1;
  EXPECT_EQ(refusal(2 * plane), "");
  EXPECT_THAT(refusal(2 * plane - 1), AllOf(HasSubstr("--accumulate"), HasSubstr("--device")));
  settings.estimator.further_radii = {2, 3};
  EXPECT_THAT(refusal(2 * plane), AllOf(HasSubstr("--accumulate"), HasSubstr("one --radius")));
}

TEST_F(Shots, dry_runs_tell_what_the_window_takes) {
  EXPECT_THAT(done(typed("--around 2 --dry-run")).out, AllOf(HasSubstr("around "), HasSubstr("4 of the 7 frames")));
  EXPECT_THAT(run({"--dry-run"}).out, Not(HasSubstr("around ")));
}

TEST_F(Shots, frames_without_normals_are_as_right_as_alone) {
  const auto off = [&](const std::string& more) {
    const std::string plain = "--denoise none --slices 8 " + more;
    return difference(ao_of(3, plain + " --normal none"), ao_of(3, plain)).rmse;
  };
  EXPECT_LE(off("--around 2"), off("") + 0.002);
}

TEST_F(Shots, files_that_know_what_is_hidden_leave_others_nothing_to_add) {
  for (int frame = 1; frame <= kFrames; frame++) {
    const auto first = with_board(frame).planes.at("ViewLayer.Depth.Z");
    auto behind = wall_frame().planes.at("ViewLayer.Depth.Z");
    for (std::size_t i = 0; i < behind.size(); i++) behind[i] = behind[i] == first[i] ? 0 : behind[i];
    write_plane(folder / fmt::format("peel.{}.exr", frame), "Z", behind);
  }
  const std::string known = "--set complete=none --behind " + folder.path() + "/peel.%d.exr";
  EXPECT_LT(difference(ao_of(3, known + " --around 2"), ao_of(3, known)).rmse, 0.01);
}

}  // namespace
}  // namespace alcove::shot_test
