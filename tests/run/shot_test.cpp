// What the frames of a shot take from each other: the same whatever is computed beside them, each read once.
// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <gmock/gmock.h>

#include "core/formats/exr.h"
#include "core/run/frame_files.h"
#include "core/run/memory.h"
#include "core/run/plan.h"
#include "core/run/shot.h"
#include "tests/support/device.h"
#include "tests/support/walked_shot.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;
using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::Eq;
using testing::FloatEq;
using testing::HasSubstr;
using testing::Not;
using testing::Pointwise;

constexpr int kFrames = 7;

class Shots : public WalkedShot {
 protected:
  Shots() { write_shot(kFrames); }

  /// The first surface that a frame hides, as it is written.
  std::vector<float> hidden(int frame) const { return read_exr_image(output(frame), {"hidden1.Z"}).pixels; }
  Finished run_hidden(int frame, std::vector<std::string> more) const {
    more.insert(more.end(), {"--frames", std::to_string(frame), "--aov", "hidden", "--type", "float"});
    return run_with_stats(more);
  }

  json stats() const { return json::parse(read_bytes(folder / "stats.json")); }
  Finished run_with_stats(std::vector<std::string> more) const {
    more.insert(more.end(), {"--stats", folder / "stats.json"});
    return run(more);
  }
  std::string header(int frame) const { return attribute_of_whole_exr(output(frame), "alcove/hidden").value_or(""); }
};

/// The word that stands behind another text.
std::string word_behind(const std::string& text, const std::string& before) {
  const std::size_t at = text.find(before);
  if (at == text.npos) return "";
  const std::size_t begin = at + before.size();
  return text.substr(begin, text.find_first_of(" \n", begin) - begin);
}

TEST_F(Shots, threads_chunks_and_order_change_no_bit) {
  ASSERT_EQ(run({"--threads", "1", "--around", "2"}).code, 0);
  const auto before = outputs();
  EXPECT_EQ(before.size(), kFrames);
  expect_same_outputs(before, {{"--around", "2", "--threads", "3", "--frames", "7-1"}});
  expect_same_outputs(before, {{"--around", "2", "--chunk", "3/3", "--threads", "1"},
                               {"--around", "2", "--chunk", "1/3", "--threads", "1"},
                               {"--around", "2", "--chunk", "2/3", "--threads", "1"}});
}

TEST_F(Shots, each_frame_is_read_once_for_all_around_it) {
  ASSERT_EQ(run_with_stats({"--around", "2", "--threads", "1"}).code, 0);
  std::uint64_t rows = 0;
  const json frames = stats()["frames"];
  for (const auto& frame : frames) rows += frame["rows_read"].get<std::uint64_t>();
  EXPECT_EQ(rows, 2 * kFrames * 36) << "once as itself, and once as one of those around";
  EXPECT_THAT(frames[0]["frames_around"], Eq(json({2, 3})));
  EXPECT_THAT(frames[3]["frames_around"], Eq(json({2, 3, 5, 6})));
}

TEST_F(Shots, headers_name_the_frames_around) {
  const auto run_two = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--frames", "1,4", "--aov", "depth,normal", "--threads", "1"});
    const Finished finished = run(more);
    EXPECT_EQ(finished.code, 0) << finished;
  };
  run_two({"--around", "2"});
  EXPECT_EQ(header(1), "frames 2-3");
  EXPECT_EQ(header(4), "frames 2-3, 5-6");
  run_two({"--around", "all"});
  EXPECT_EQ(header(1), "frames 2-7");
  run_two({});
  EXPECT_EQ(header(1), "");
}

TEST_F(Shots, of_one_frame_have_none_around_it) {
  for (int frame = 2; frame <= kFrames; frame++) fs::remove(input(frame));
  for (const char* around : {"3", "all"}) {
    const Finished finished = run({"--around", around});
    ASSERT_EQ(finished.code, 0) << finished;
    EXPECT_EQ(header(1), "");
  }
}

TEST_F(Shots, of_a_single_file_are_none) {
  const auto run_single = [&](const std::string& file, const char* around) {
    return run_program({"run", file, "-o", output(1), "--camera", camera, "--radius", "1", "--around", around});
  };
  for (const char* around : {"3", "all"}) {
    const Finished single = run_single(input(1), around);
    EXPECT_EQ(single.code, 2) << single;
    EXPECT_THAT(single.err, AllOf(HasSubstr("--around"), HasSubstr("such as " + in + "/f.####.exr")));
  }
  fs::copy_file(input(1), folder / "wall.exr");
  EXPECT_THAT(run_single(folder / "wall.exr", "3").err, HasSubstr("such as shot.####.exr"));
}

TEST_F(Shots, resumed_runs_compute_what_a_changed_neighbour_changes) {
  ASSERT_EQ(run({"--around", "1", "--aov", "depth,hidden"}).code, 0);
  FrameFile changed = with_board(1);
  changed.planes.at("ViewLayer.Depth.Z")[0] = 5;
  changed.write(input(1));
  const auto old = fs::last_write_time(input(2));
  fs::last_write_time(input(1), old);
  ASSERT_EQ(run_with_stats({"--around", "1", "--aov", "depth,hidden", "--resume"}).code, 0);
  std::vector<int> computed;
  const json frames = stats()["frames"];
  for (const auto& frame : frames)
    if (frame["state"] == "done") computed.push_back(frame["frame"]);
  // Frame 1 tells what moves in 2 and 3, which 4 takes.
  EXPECT_THAT(computed, ElementsAre(1, 2, 3, 4));
}

TEST_F(Shots, missing_frames_are_an_error_or_left_out) {
  fs::remove(input(4));
  const Finished refused = run({"--around", "2", "--frames", "2"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("f.0004.exr"), HasSubstr("--around"), HasSubstr("--set missing=skip")));
  const Finished skipped = run({"--around", "2", "--set", "missing=skip", "--aov", "depth,hidden"});
  ASSERT_EQ(skipped.code, 0) << skipped;
  EXPECT_EQ(lines_of(skipped.err).front(),
            "alcove: warning: " + in +
                "/f.%04d.exr: a frame of the shot is missing: 4; those around do without, and their headers say so "
                "(--set missing=skip) [sequence-hole]");
  EXPECT_EQ(header(3), "frames 1-2, 5; missing 4");
  EXPECT_EQ(header(1), "frames 2-3");
}

TEST_F(Shots, need_to_know_where_every_camera_stands) {
  json cameras = json::parse(read_bytes(camera));
  cameras.erase("world_to_camera");
  cameras["frames"][3].erase("world_to_camera");
  cameras["normal_space"] = "view";
  write_bytes(camera, cameras.dump());
  for (int frame = 1; frame <= kFrames; frame++) {
    FrameFile file = with_board(frame);
    turn_normals_to_view(file);
    file.write(input(frame));
  }
  const Finished finished = run({"--around", "2", "--frames", "2"});
  EXPECT_EQ(finished.code, 3) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("f.0004.exr"), HasSubstr("frame 4"), HasSubstr("--camera")));
}

TEST_F(Shots, refuse_two_projections) {
  json cameras = json::parse(read_bytes(camera));
  cameras["frames"][3]["projection"] = "orthographic";
  write_bytes(camera, cameras.dump());
  const Finished finished = run({"--around", "1", "--frames", "3"});
  EXPECT_EQ(finished.code, 3) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("orthographic"), HasSubstr("frame 4"), HasSubstr("--camera")));
}

TEST_F(Shots, know_the_frames_around_each) {
  Settings settings;
  settings.input.input = in + "/f.####.exr";
  settings.input.around = 1;
  const FramePlan plan(settings);
  EXPECT_THAT(plan.around(1, 2).there, ElementsAre(2, 3));
  EXPECT_THAT(plan.around(7, 1).there, ElementsAre(6));
  EXPECT_THAT(plan.around(4, kWholeShot).there, ElementsAre(1, 2, 3, 5, 6, 7));
  EXPECT_THAT(judges_of(plan, 4), ElementsAre(2, 3, 5, 6));
  EXPECT_THAT(judges_of(plan, 1), ElementsAre(2, 3, 4, 5)) << "at the ends of the shot the others are on one side";
  EXPECT_THAT(judges_of(plan, 6), ElementsAre(3, 4, 5, 7));
  EXPECT_THAT(frames_seen_for(plan, 4), ElementsAre(1, 2, 3, 5, 6, 7));
  EXPECT_THAT(frames_seen_for(plan, 1), ElementsAre(2, 3, 4, 5));
  settings.input.around = 3;
  EXPECT_THAT(judges_of(FramePlan(settings), 4), ElementsAre(1, 2, 3, 5, 6, 7));
}

TEST_F(Shots, keep_no_more_frames_than_their_windows) {
  constexpr int kLong = 16;
  json cameras = json::parse(read_bytes(camera));
  for (int frame = kFrames + 1; frame <= kLong; frame++) {
    json of_frame = cameras["frames"].back();
    of_frame["frame"] = frame;
    cameras["frames"].push_back(of_frame);
    fs::copy_file(input(kFrames), input(frame));
  }
  write_bytes(camera, cameras.dump());
  Settings settings = settings_of_shot();
  settings.input.around = 2;
  for (const char* order : {"1-16", "16-1", "1-16x3,2-16x3,3-16x3"}) {
    settings.frames.frames = order;
    const FramePlan plan(settings);
    SharedFrames shared(plan, nullptr, plan.frames());
    gpu::Recorder gpu(device());
    for (const int frame : plan.frames()) {
      PreparedOthers took;
      FrameSource target = open_frame(plan.at(frame), frame);
      shared.begin(frame);
      shared.others_of(gpu, target, frame, took);
      EXPECT_LE(shared.seen_count(), std::size_t(2 * with_judges(2) + 1)) << order << " " << frame;
      EXPECT_GE(shared.seen_count(), 5u) << order << " " << frame;
      shared.done(frame);
    }
    EXPECT_EQ(shared.seen_count(), 0u);
  }
}

TEST_F(Shots, regions_have_the_bits_of_the_whole) {
  const Window region{9, 6, 40, 22};
  ASSERT_EQ(run({"--around", "2", "--type", "float", "--frames", "4"}).code, 0);
  const Image whole = read_exr_image(output(4));
  const Finished finished = run({"--around", "2", "--type", "float", "--frames", "4", "--roi", "9,6,40,22"});
  ASSERT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(read_exr_image(output(4)).pixels, Pointwise(FloatEq(), cropped(whole.pixels, whole.data, region)));
}

/// Frames that are so large that their number matters.
TEST_F(Shots, tell_how_many_frames_memory_has_room_for) {
  const Window large{0, 0, 480, 270};
  wall_frame(large, large).write(input(1));
  for (int frame = 2; frame <= kFrames; frame++)
    fs::copy_file(input(1), input(frame), fs::copy_options::overwrite_existing);
  json cameras = wall_camera(large);
  write_bytes(camera, cameras.dump());
  const Finished refused = run({"--around", "all", "--memory", "182M"});
  ASSERT_EQ(refused.code, 2) << refused;
  EXPECT_THAT(refused.err, AllOf(HasSubstr("f.0001.exr"), HasSubstr("--around "), HasSubstr("--memory ")));
  const Finished dry = run({"--around", "all", "--memory", "182M", "--dry-run"});
  EXPECT_EQ(dry.code, 2) << dry;
  const std::string enough = word_behind(refused.err, "or --memory ");
  const Finished with_enough = run({"--around", "all", "--memory", enough, "--frames", "4"});
  EXPECT_EQ(with_enough.code, 0) << with_enough;
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
  const auto numbers = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--around", "2"});
    const Finished finished = run_hidden(5, more);
    EXPECT_EQ(finished.code, 0) << finished;
    const json frame = stats()["frames"][0];
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
  const auto ghosts = [&](const std::vector<std::string>& more) {
    const Finished finished = run_hidden(kTarget, more);
    EXPECT_EQ(finished.code, 0) << finished;
    const std::vector<float> planes = hidden(kTarget);
    EXPECT_GT(std::ranges::count_if(planes, [](float z) { return std::abs(z - 6) < 0.01f; }), 50)
        << "the wall behind the post";
    return std::ranges::count_if(planes, [](float z) { return std::abs(z - 4) < 0.1f; });
  };
  EXPECT_EQ(ghosts({"--around", "8"}), 0);
  EXPECT_EQ(ghosts({"--around", "all"}), 0);
  EXPECT_EQ(ghosts({"--around", "8", "--motion", in + "/f.%04d.exr"}), 0) << "it rests by its vectors too";
}

TEST_F(Shots, refuse_motion_vectors_that_no_camera_agrees_with) {
  for (int frame = 1; frame <= kFrames; frame++) {
    FrameFile file = with_board(frame);
    add_motion(file, 3.7f);
    file.write(input(frame));
  }
  const Finished finished = run({"--around", "2", "--motion", in + "/f.%04d.exr"});
  EXPECT_EQ(finished.code, 3) << finished;
  EXPECT_THAT(finished.err,
              AllOf(HasSubstr("f.000"), HasSubstr("--set motion-channels"), HasSubstr("--set motion-kind")));
}

/// A file of two views, each a part.
void write_stereo(const std::string& path, const FrameFile& left, const FrameFile& right) {
  std::vector<Imf::Header> headers;
  for (const char* view : {"left", "right"}) {
    Imf::Header& header = headers.emplace_back(64, 36);
    header.setName(view);
    header.setView(view);
    header.setType(Imf::SCANLINEIMAGE);
    for (const auto& [name, plane] : left.planes) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 2);
  for (int part = 0; part < 2; part++) {
    Imf::FrameBuffer pixels;
    for (const auto& [name, plane] : part == 0 ? left.planes : right.planes)
      pixels.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(plane.data())),
                                     sizeof(float), sizeof(float) * 64));
    Imf::OutputPart out(file, part);
    out.setFrameBuffer(pixels);
    out.writePixels(36);
  }
}

TEST_F(Shots, other_views_are_those_of_the_same_instant) {
  write_stereo(folder / "stereo.exr", with_board(1), with_board(2));
  const auto run_stereo = [&](const json& cameras, std::vector<std::string> more) {
    write_bytes(camera, cameras.dump());
    more.insert(more.begin(), {"run", folder / "stereo.exr", "-o", output(1), "--camera", camera, "--radius", "1"});
    return run_program(more);
  };
  json cameras = wall_camera();
  const Finished same = run_stereo(cameras, {"--set", "other-views=true"});
  EXPECT_EQ(same.code, 3) << same;
  EXPECT_THAT(same.err, AllOf(HasSubstr("stereo.exr"), HasSubstr("--camera"), HasSubstr("views")));
  for (int frame = 1; frame <= 2; frame++) {
    json matrix = cameras["world_to_camera"];
    matrix[0][3] = -kStep * frame;
    cameras["views"][frame == 1 ? "left" : "right"]["world_to_camera"] = matrix;
  }
  const Finished finished =
      run_stereo(cameras, {"--set", "other-views=true", "--aov", "ao,depth,hidden", "--type", "float"});
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
  EXPECT_EQ(run_stereo(cameras, {"--aov", "ao", "--type", "float"}).code, 0);
  EXPECT_NE(read_exr_image(output(1), {"Y"}).pixels, ao);
  EXPECT_EQ(run_stereo(cameras, {"--set", "other-views=true", "--view", "right", "--aov", "depth,hidden"}).code, 0);
  EXPECT_EQ(header(1), "views left");
  const Finished alone = run({"--set", "other-views=true", "--frames", "1"});
  EXPECT_EQ(alone.code, 3) << alone;
  EXPECT_THAT(alone.err, AllOf(HasSubstr("f.0001.exr"), HasSubstr("--set other-views")));
}

TEST_F(Shots, take_more_memory_the_more_frames_lie_around) {
  Settings settings;
  settings.input.input = in + "/f.####.exr";
  settings.input.camera = camera;
  settings.estimator.radius = 1;
  settings.output.output = out + "/ao.####.exr";
  std::uint64_t frame_before = 0, shot_before = 0;
  for (const int around : {0, 1, 2, 3}) {
    settings.input.around = around;
    const FramePlan plan(settings);
    const FrameSource source = open_frame(plan.at(4), 4);
    const std::uint64_t of_frame = memory_with_others(plan, source, settings).of(source.file_data).host;
    const std::uint64_t of_shot = bytes_of_shot(plan, source, settings.input, 1);
    if (around != 2) {
      EXPECT_GT(of_frame, frame_before) << around;
    }
    EXPECT_GE(of_frame, frame_before) << "two frames to each side tell what moves, if no more are taken";
    EXPECT_GE(of_shot, shot_before) << around;
    frame_before = of_frame, shot_before = of_shot;
  }
  EXPECT_EQ(shot_before, kFrames * 12 * kWallWindow.pixels()) << "there are no more";
}

TEST_F(Shots, take_memory_for_motion_vectors) {
  const auto bytes_with = [&](const std::string& motion, const std::string& channels, int around, int accumulate) {
    Settings settings = settings_of_shot();
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
  Settings settings;
  settings.input.input = in + "/f.####.exr";
  settings.input.camera = camera;
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
  settings.input.accumulate = 0;
}

TEST_F(Shots, dry_runs_tell_what_the_window_takes) {
  const Finished finished = run({"--around", "2", "--dry-run"});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.out, AllOf(HasSubstr("around "), HasSubstr("4 of the 7 frames")));
  EXPECT_THAT(run({"--dry-run"}).out, Not(HasSubstr("around ")));
}

}  // namespace
}  // namespace alcove
