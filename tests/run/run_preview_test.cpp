// What is looked at before a run: holes of sequences, the frame's number, all that is missing, the radius.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"
#include "core/run/batch.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove::run_preview_test {
namespace {

using namespace test;

class Holes : public SequenceFolder {
 protected:
  void keep(const std::vector<int>& frames) const {
    write_frames(frames.front(), frames.front());
    for (const int frame : frames)
      if (frame != frames.front()) fs::copy_file(input(frames.front()), input(frame));
  }
};

TEST_F(Holes, of_a_pattern_without_a_list_are_a_warning) {
  keep({1, 2, 4, 7});
  const std::string stats = folder / "stats.json", log = folder / "log.jsonl";
  const Finished finished = done({"--stats", stats, "--log-json", log});
  EXPECT_THAT(lines_of(finished.err), Contains(AllOf(HasSubstr("alcove: warning: "), HasSubstr("f.%04d.exr"),
                                                     HasSubstr("3, 5-6"), HasSubstr("[sequence-hole]"))));
  EXPECT_EQ(json::parse(read_bytes(stats))["notes"][0]["code"], "sequence-hole");
  EXPECT_EQ(json::parse(read_bytes(stats))["totals"]["missing"], json({3, 5, 6}));
  EXPECT_EQ(json::parse(lines_of(read_bytes(log))[0])["notes"][0]["code"], "sequence-hole");
  EXPECT_EQ(text_in(read_header(output(1)), "alcove/notes"), "(none)") << "it says nothing about this frame";
  EXPECT_THAT(run({"--dry-run"}).out, HasSubstr("3, 5-6"));
  EXPECT_THAT(run({"--frames", "1-2,4,7"}).err, Not(HasSubstr("sequence-hole")));
  EXPECT_THAT(run({"--set", "missing=skip"}).err,
              AllOf(Not(HasSubstr("sequence-hole")), HasSubstr("3 missing (3, 5-6)")));
  EXPECT_THAT(run({"--chunk", "2/2"}).err, HasSubstr("3, 5-6")) << "the same in every chunk";
  remove_outputs();
  EXPECT_EQ(run({"--set", "warnings-as-errors=true"}).code, 3);
  EXPECT_THAT(names_in(out), IsEmpty());
}

TEST_F(Holes, are_none_where_frames_keep_a_step) {
  keep({1, 3, 5, 9});
  EXPECT_THAT(run({"--dry-run"}).out, AllOf(HasSubstr("sequence-hole"), HasSubstr(": 7 is missing")));
  fs::remove(input(9));
  EXPECT_THAT(run({"--dry-run"}).out, Not(HasSubstr("sequence-hole")));
  fs::remove(input(5));
  EXPECT_THAT(run({"--dry-run"}).out, HasSubstr(": 2 is missing")) << "two frames keep no step";
}

TEST_F(Holes, stand_in_order_with_other_frames_that_are_left_out) {
  keep({1, 2, 4, 5});
  for (const int frame : {1, 2, 4}) fs::copy_file(input(frame), fmt::format("{}/n.{:04}.exr", in, frame));
  EXPECT_EQ(stats_of({"--set", "missing=skip", "--normal", in + "/n.%04d.exr"})["totals"]["missing"], (json{3, 5}));
}

TEST_F(Holes, of_all_frames_fail_in_a_chunk_without_frames_too) {
  for (const auto& more : {Options(), {"--set", "missing=skip"}})
    expect_refused(3, joined(more, {"--frames", "1-3", "--chunk", "5/8"}), {"INPUT", "3 of 3 frames are missing"});
  keep({2});
  EXPECT_EQ(run({"--frames", "1-3", "--chunk", "5/8"}).code, 0) << "another chunk tells of the others";
}

/// A frame and a list of cameras: at frame 5 it is that of the frame, at all others it sees half as wide.
class CameraList : public CommandLine {
 protected:
  CameraList() {
    json list = wall_camera();
    json narrow = {{"fx", 2 * list["fx"].get<double>()}, {"fy", 2 * list["fy"].get<double>()}};
    for (const int number : {1, 2, 5, 10, 12}) {
      json entry = number == 5 ? json::object() : narrow;
      entry["frame"] = number;
      list["frames"].push_back(entry);
    }
    write_bytes(cameras, list.dump());
    done();
    right = read_exr_image(ao).pixels;
    fs::remove(ao);
  }

  /// A run on the frame under another name, with the list.
  Finished compute(const std::string& name, const Options& more = {}) const {
    wall_frame().write(folder / name);
    return run_program(joined({"run", folder / name, "-o", ao, "--radius", "1", "--camera", cameras}, more));
  }
  void expect_right(const Finished& finished) const {
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_TRUE(read_exr_image(ao).pixels == right);
  }

  const std::string cameras = folder / "cameras.json";
  std::vector<float> right;
};

TEST_F(CameraList, is_asked_for_the_frame_that_the_name_tells_and_says_so) {
  for (const char* name : {"shot.0005.exr", "shot_v002.0005.exr", "shot.0005.left.exr", "shot_0005_v2.exr"}) {
    SCOPED_TRACE(name);
    const Finished finished = compute(name);
    expect_right(finished);
    EXPECT_THAT(lines_of(finished.err), Contains(AllOf(HasSubstr("alcove: note: "), HasSubstr("frame 5 "),
                                                       HasSubstr("0005"), HasSubstr("[frame-number]"))));
  }
  const Options inspect{"inspect", folder / "shot.0005.exr", "--camera"};
  EXPECT_THAT(run_program(joined(inspect, {cameras})).out, AllOf(HasSubstr("frame 5 "), HasSubstr("0005")));
  EXPECT_THAT(json::parse(run_program(joined(inspect, {cameras, "--json"})).out)["notes"].dump(),
              HasSubstr("frame 5 in cameras.json"));
  EXPECT_THAT(run_program(joined(inspect, {folder / "none.json"})).out, HasSubstr("none.json"));
}

TEST_F(CameraList, needs_a_frame_where_the_name_tells_none) {
  for (const char* name : {"shot_v002.exr", "sh010.exr", "shot.exr"}) {
    SCOPED_TRACE(name);
    fs::remove(ao);
    const Finished finished = compute(name);
    EXPECT_EQ(finished.code, 2) << finished;
    EXPECT_THAT(finished.err, AllOf(HasSubstr(name), HasSubstr(cameras), HasSubstr("--frames")));
    EXPECT_FALSE(fs::exists(ao));
    EXPECT_EQ(compute(name, {"--dry-run"}).code, 2);
    expect_right(compute(name, {"--frames", "5"}));
  }
  test::expect_refused(compute("shot.0042.exr"), 3, {"no frame 42", "0042 of the name"});
  for (const char* name : {"no.0042.exr", "no.exr"})
    test::expect_refused(run_program({"run", folder / name, "-o", ao, "--radius", "1", "--camera", cameras}), 3,
                         {name, "file not found"});
  EXPECT_EQ(run_program({"run", folder / "shot_v002.exr", "-o", ao, "--radius", "1", "--camera", camera}).code, 0)
      << "one camera is that of every frame";
}

TEST_F(CameraList, needs_a_frame_for_all_that_looks_at_it) {
  json list = json::parse(read_bytes(cameras));
  list["frames"][0]["frame"] = 0;
  write_bytes(cameras, list.dump());
  const std::string name = folder / "shot_v002.exr", with = name + " --camera " + cameras + " ";
  wall_frame().write(name);
  for (const std::string& command :
       {"inspect " + with, "run " + with + "--radius auto -o " + ao, "run " + with + "--dry-run --radius auto -o " + ao,
        "run " + with + "-o " + ao, "run " + with + "--radius 1", "run " + with}) {
    const Finished finished = run_program(typed(command));
    EXPECT_EQ(finished.code, 2) << finished;
    EXPECT_THAT(finished.err,
                AllOf(HasSubstr("shot_v002.exr"), HasSubstr(cameras), HasSubstr("--frames"), Not(HasSubstr("such as"))))
        << "no command would do";
  }
  EXPECT_EQ(run_program(typed("run " + with + "--radius auto --frames 5 -o " + ao)).code, 0);
}

TEST_F(CameraList, may_leave_its_fields_to_views) {
  json list = wall_camera(), view;
  for (const char* field : {"fx", "fy", "cx", "cy"}) {
    view[field] = list[field];
    list.erase(field);
  }
  list["frames"] = {{{"frame", 5}, {"views", {{"left", view}, {"right", view}}}}};
  write_bytes(cameras, list.dump());
  expect_right(compute("shot.0005.exr", {"--view", "left"}));
}

class SingleFrame : public CommandLine {};

TEST_F(SingleFrame, that_fails_says_why_in_a_dry_run_too_and_though_others_would_go_on) {
  const Options refused{"--normal-space", "view"};
  const Finished ends = run(refused), goes_on = run(joined(refused, {"--keep-going", "-q"})),
                 dry = run(joined(refused, {"--dry-run"}));
  EXPECT_EQ(ends.code, 3);
  EXPECT_EQ(goes_on.code, 1);
  EXPECT_EQ(dry.code, 3);
  EXPECT_EQ(goes_on.err, ends.err);
  EXPECT_EQ(dry.err, ends.err);
  EXPECT_THAT(ends.err, HasSubstr("alcove: error: "));
}

TEST_F(SingleFrame, puts_its_number_into_the_names_of_its_outputs) {
  const auto run_to = [&](const std::string& input, const char* output) {
    return run_program({"run", input, "-o", folder / output, "--camera", camera, "--radius", "1"});
  };
  ASSERT_EQ(run_to(frame, "ao.%04d.exr").code, 0);
  EXPECT_TRUE(fs::exists(folder / "ao.0042.exr"));
  EXPECT_FALSE(fs::exists(folder / "ao.%04d.exr"));
  fs::rename(frame, folder / "wall_v002.exr");
  test::expect_refused(run_to(folder / "wall_v002.exr", "ao.####.exr"), 2,
                       {"ao.####.exr", "wall_v002.exr", "--frames"});
}

TEST_F(SingleFrame, of_which_nothing_is_used_is_said) {
  FrameFile depth = wall_frame(), normals = wall_frame();
  depth.erase("Normal");
  normals.erase("Depth");
  depth.write(folder / "depth.exr");
  for (const std::string axis : {"X", "Y", "Z"}) normals.rename("ViewLayer.Normal." + axis, "foo." + axis);
  normals.write(frame);
  const Options by_depth{"--depth", folder / "depth.exr"};
  EXPECT_THAT(run(by_depth).err,
              AllOf(HasSubstr("no channel of " + frame), HasSubstr("--normal"), HasSubstr("[unused-input]")));
  for (const char* more : {"--normal-channels foo", "--normal none"})
    EXPECT_THAT(run(joined(by_depth, typed(more))).err, Not(HasSubstr("unused-input"))) << more;
}

TEST_F(SingleFrame, is_opened_once) {
  RunOptions options;
  ASSERT_TRUE(parse_run_options({frame, "-o", ao, "--camera", camera, "--radius", "auto"}, options));
  RunPreview look(options.settings);
  look.prepare();
  fs::remove(frame);  // which stays readable for those who have it open
  EXPECT_EQ(run_frames(look, {}).done, 1);
}

class Missing : public CommandLine {};

TEST_F(Missing, is_all_listed_at_once_with_the_command_that_would_do) {
  const Finished all = run_program({"run", frame});
  EXPECT_EQ(all.code, 2);
  EXPECT_THAT(all.err, AllOf(HasSubstr("-o FILE.exr"), HasSubstr("--camera FILE.json"), HasSubstr("--fov"),
                             HasSubstr("--radius NUMBER"), HasSubstr("such as:\nalcove run " + frame + " -o ao.exr")));
  EXPECT_EQ(lines_of(all.err).size(), 6) << all << "one for each thing, and the command alone on the last";
  EXPECT_EQ(run_program({"run", frame, "--dry-run"}).code, 2);

  // An empty value says nothing, and no output has the name of the input.
  fs::copy_file(frame, folder / "ao.exr");
  const std::string rest = " --camera " + camera + " --radius 1";
  for (const auto& [given, proposed] :
       {std::pair(Options{"run", frame, "-o", ""}, "alcove run " + frame + rest + " -o ao.exr"),
        {{"run", ""}, "alcove run frame.exr" + rest + " -o ao.exr"},
        {{"run", "ao.exr", "--composite", ""}, "alcove run ao.exr" + rest + " -o new-ao.exr"}}) {
    const Finished refused =
        run_program(joined(given, {"--camera", camera, "--radius", "1"}), {.folder = folder.path()});
    EXPECT_EQ(refused.code, 2);
    EXPECT_EQ(lines_of(refused.err).back(), proposed);
  }

  // The command works as it is proposed, with the radius that inspect proposes.
  const Finished some = run_program({"run", frame, "--camera", camera, "--type", "float"});
  EXPECT_EQ(some.code, 2);
  EXPECT_THAT(some.err, Not(HasSubstr("a camera: ")));
  const std::string program = "alcove ", proposed = lines_of(some.err).back();
  ASSERT_THAT(proposed, StartsWith(program));
  const Options arguments = typed(proposed.substr(program.size()));
  EXPECT_THAT(arguments, IsSupersetOf({"--type", "float", "--camera", "-o", "ao.exr", "--radius"}));
  EXPECT_EQ(run_program(arguments, {.folder = folder.path()}).code, 0);
  EXPECT_THAT(run_program({"inspect", frame, "--camera", camera}).out,
              HasSubstr(" --radius " + *(std::ranges::find(arguments, "--radius") + 1)));
}

TEST_F(Missing, of_a_camera_for_normals_in_world_space_is_said_and_the_proposal_does_without) {
  EXPECT_THAT(run_program({"run", frame}).err,
              AllOf(HasSubstr("a camera: --camera FILE.json with world_to_camera, for normals in world space"),
                    HasSubstr("each with --normal none"), HasSubstr(" --camera CAMERA.json")));
  const Finished lens = run_program({"run", frame, "--fov", "60"});
  EXPECT_EQ(lens.code, 2);
  EXPECT_THAT(lens.err, AllOf(HasSubstr("\n  world_to_camera, for normals "), Not(HasSubstr("a frame to look at"))));
  const std::string program = "alcove ", proposed = lines_of(lens.err).back();
  ASSERT_THAT(proposed, StartsWith(program));
  const Options arguments = typed(proposed.substr(program.size()));
  EXPECT_THAT(arguments, IsSupersetOf({"--fov", "60", "--normal", "none"}));
  EXPECT_EQ(run_program(arguments, {.folder = folder.path()}).code, 0) << proposed;
}

TEST_F(Missing, is_said_once_each) {
  FrameFile file = wall_frame();
  file.erase("Depth");
  file.write(frame);
  const std::string said = run_program({"run", frame}).err, words = "no depth channel found";
  EXPECT_EQ(said.find(words), said.rfind(words)) << said;
  EXPECT_THAT(said, HasSubstr(words));
}

TEST_F(Missing, of_a_frame_that_cannot_be_read_is_listed_too) {
  const Finished finished = run_program({"run", folder / "none.exr"});
  EXPECT_EQ(finished.code, 2);
  EXPECT_THAT(finished.err, AllOf(HasSubstr("-o FILE.exr"), HasSubstr("--radius"), HasSubstr("none.exr")));
  const Finished nothing =
      run_program({"run", folder / "none.####.exr", "--frames", "1-2", "--chunk", "1/5", "-o", folder / "ao.####.exr"});
  EXPECT_EQ(nothing.code, 2) << nothing << "the chunk is empty, and nothing can be looked at";
  EXPECT_THAT(run_program({"run"}).err, AllOf(HasSubstr("INPUT"), HasSubstr("-o FILE.exr"), HasSubstr("--radius")));
}

class Radius : public SequenceFolder {};

TEST_F(Radius, auto_is_one_number_for_a_whole_sequence) {
  // Frames of other distances would each have a radius of their own.
  for (const int number : {1, 2, 3}) {
    FrameFile file = wall_frame();
    file.change("Depth", [&](float z) { return number == 1 ? 1e10f : z * float(number); });
    file.write(input(number));
  }
  const auto done_with = [&](const std::string& more) {
    return done(typed("--normal-space world --depth-kind planar --radius " + more));
  };
  const Finished finished = done_with("auto");
  const std::string radius = text_in(read_header(output(1)), "alcove/radius");
  EXPECT_THAT(finished.err, AllOf(HasSubstr("--radius auto takes " + radius), HasSubstr("[automatic-radius]")));
  for (const int number : {2, 3}) EXPECT_EQ(text_in(read_header(output(number)), "alcove/radius"), radius);
  const auto whole = outputs();
  remove_outputs();
  for (const char* chunk : {"2/2", "1/2"}) done_with(std::string("auto --chunk ") + chunk);
  EXPECT_TRUE(outputs() == whole);
  for (const std::string& known : {std::string("auto"), radius})  // the number that was found is what counts
    EXPECT_THAT(done_with(known + " --resume").err, HasSubstr("3 kept"));
  EXPECT_THAT(run({"--radius", "auto", "--dry-run"}).out, HasSubstr("auto takes " + radius));

  // Another chunk may find the beauty whole.
  for (const int number : {1, 2, 3}) write_bytes(fmt::format("{}/b.{:04}.exr", in, number), "begun");
  const Finished without_beauty =
      run(typed("--normal-space world --depth-kind planar --radius auto --keep-going --beauty " + in +
                "/b.%04d.exr --composite " + out + "/c.%04d.exr"));
  EXPECT_EQ(without_beauty.code, 1) << without_beauty;
  EXPECT_THAT(without_beauty.err, HasSubstr("--radius auto takes " + radius));
}

TEST_F(Radius, in_percent_is_of_the_median_depth_and_one_for_all_frames_and_parts) {
  for (const int number : {1, 2, 3}) {
    FrameFile file = wall_frame();
    file.change("Depth", [&](float z) { return z * float(number); });
    file.write(input(number));
  }
  const auto done_with = [&](const std::string& more) {
    return done(typed("--normal-space world --depth-kind planar --radius " + more));
  };
  const auto radius_of = [&](int number) { return text_in(read_header(output(number)), "alcove/radius"); };
  done_with("100%");
  const double median = std::stod(radius_of(1));
  remove_outputs();
  done_with("5%,10%");
  const std::vector<std::string> radii = typed(radius_of(1));
  ASSERT_EQ(radii.size(), 2);
  EXPECT_NEAR(std::stod(radii[0]), 0.05 * median, 1e-3 * median);
  EXPECT_NEAR(std::stod(radii[1]), 0.1 * median, 1e-3 * median);
  for (const int number : {2, 3}) EXPECT_EQ(radius_of(number), radius_of(1));
  const auto whole = outputs();
  for (const std::string& more : {std::string("5%,10%"), radii[0] + "," + radii[1]})
    EXPECT_THAT(done_with(more + " --resume").err, HasSubstr("3 kept"));
  remove_outputs();
  for (const char* chunk : {"2/2", "1/2"}) done_with(std::string("5% --radius 10% --chunk ") + chunk);
  EXPECT_TRUE(outputs() == whole);
  const std::string of_whole = radius_of(2);
  done_with("5%,10% --roi 3,4,8,6");
  EXPECT_EQ(radius_of(2), of_whole) << "of a region";

  for (const char* wrong : {"5%,0.1", "%", "-5%", "0%", "auto,5%"})
    EXPECT_EQ(run({"--radius", wrong}).code, 2) << wrong;
}

TEST_F(Radius, auto_is_the_only_one_and_needs_a_surface) {
  write_frames(1, 1);
  EXPECT_EQ(run({"--radius", "auto", "--radius", "1"}).code, 2);
  FrameFile sky = wall_frame();
  sky.change("Depth", [](float) { return 1e10f; });
  sky.write(input(1));
  const Finished finished = run({"--radius", "auto"});
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err, HasSubstr("--radius NUMBER"));
}

}  // namespace
}  // namespace alcove::run_preview_test
