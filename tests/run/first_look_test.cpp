// What is looked at before a run: holes of sequences, the frame's number, all that is missing, the radius.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "core/formats/exr.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"
#include "tests/support/sequence_folder.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;
using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

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
  const Finished finished = run({"--stats", stats, "--log-json", log});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(lines_of(finished.err), Contains(AllOf(HasSubstr("alcove: warning: "), HasSubstr("f.%04d.exr"),
                                                     HasSubstr("3, 5-6"), HasSubstr("[sequence-hole]"))));
  EXPECT_EQ(json::parse(read_bytes(stats))["notes"][0]["code"], "sequence-hole");
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
  const std::string stats = folder / "stats.json";
  EXPECT_EQ(run({"--set", "missing=skip", "--normal", in + "/n.%04d.exr", "--stats", stats}).code, 0);
  EXPECT_EQ(json::parse(read_bytes(stats))["totals"]["missing"], (json{3, 5}));
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
    wall_frame().write(folder / "right.exr");
    EXPECT_EQ(compute("right.exr", {"--camera", camera}).code, 0);
    right = read_exr_image(ao).pixels;
  }

  Finished compute(const std::string& name, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", folder / name, "-o", ao, "--radius", "1"});
    if (std::ranges::find(more, "--camera") == more.end()) more.insert(more.end(), {"--camera", cameras});
    return run_program(more);
  }

  const std::string cameras = folder / "cameras.json";
  std::vector<float> right;
};

TEST_F(CameraList, is_asked_for_the_frame_that_the_name_tells_and_says_so) {
  for (const char* name : {"shot.0005.exr", "shot_v002.0005.exr", "shot.0005.left.exr", "shot_0005_v2.exr"}) {
    wall_frame().write(folder / name);
    const Finished finished = compute(name);
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_THAT(lines_of(finished.err), Contains(AllOf(HasSubstr("alcove: note: "), HasSubstr("frame 5 "),
                                                       HasSubstr("0005"), HasSubstr("[frame-number]"))))
        << name;
    EXPECT_TRUE(read_exr_image(ao).pixels == right) << name;
  }
}

TEST_F(CameraList, needs_a_frame_where_the_name_tells_none) {
  for (const char* name : {"shot_v002.exr", "sh010.exr", "shot.exr"}) {
    wall_frame().write(folder / name);
    fs::remove(ao);
    const Finished finished = compute(name);
    EXPECT_EQ(finished.code, 2) << finished;
    EXPECT_THAT(finished.err, AllOf(HasSubstr(name), HasSubstr(cameras), HasSubstr("--frames")));
    EXPECT_FALSE(fs::exists(ao));
    EXPECT_EQ(compute(name, {"--dry-run"}).code, 2);
    EXPECT_EQ(compute(name, {"--frames", "5"}).code, 0);
    EXPECT_TRUE(read_exr_image(ao).pixels == right) << name;
  }
  wall_frame().write(folder / "shot.0042.exr");
  const Finished other = compute("shot.0042.exr");
  EXPECT_EQ(other.code, 3) << other;
  EXPECT_THAT(lines_of(other.err), ElementsAre(AllOf(HasSubstr("no frame 42"), HasSubstr("0042 of the name"))));
  EXPECT_EQ(compute("shot_v002.exr", {"--camera", camera}).code, 0) << "one camera is that of every frame";
}

TEST_F(CameraList, needs_a_frame_for_all_that_looks_at_it) {
  json list = json::parse(read_bytes(cameras));
  list["frames"][0]["frame"] = 0;
  write_bytes(cameras, list.dump());
  wall_frame().write(folder / "shot_v002.exr");
  const auto refused = AllOf(HasSubstr("shot_v002.exr"), HasSubstr(cameras), HasSubstr("--frames"));
  const std::vector<std::string> run{"run", folder / "shot_v002.exr", "--camera", cameras};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), run.begin(), run.end());
    return run_program(more);
  };
  for (const auto& finished :
       {run_program({"inspect", folder / "shot_v002.exr", "--camera", cameras}), with({"-o", ao, "--radius", "auto"}),
        with({"-o", ao, "--radius", "auto", "--dry-run"}), with({"-o", ao}), with({"--radius", "1"}), with({})}) {
    EXPECT_EQ(finished.code, 2) << finished;
    EXPECT_THAT(finished.err, refused);
    EXPECT_THAT(finished.err, Not(HasSubstr("such as"))) << "no command would do";
  }
  EXPECT_EQ(with({"-o", ao, "--radius", "auto", "--frames", "5"}).code, 0);
}

TEST_F(CameraList, is_asked_by_inspect_too) {
  wall_frame().write(folder / "shot.0005.exr");
  const Finished finished = run_program({"inspect", folder / "shot.0005.exr", "--camera", cameras});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.out, AllOf(HasSubstr("frame 5 "), HasSubstr("0005")));
  const auto found = json::parse(run_program({"inspect", folder / "shot.0005.exr", "--camera", cameras, "--json"}).out);
  EXPECT_THAT(found["notes"].dump(), HasSubstr("frame 5 in cameras.json"));
  const Finished none = run_program({"inspect", folder / "shot.0005.exr", "--camera", folder / "none.json"});
  EXPECT_THAT(none.out, HasSubstr("none.json")) << none;
}

TEST_F(CameraList, may_leave_its_fields_to_views) {
  json list = wall_camera(), view;
  for (const char* field : {"fx", "fy", "cx", "cy"}) {
    view[field] = list[field];
    list.erase(field);
  }
  list["frames"] = {{{"frame", 5}, {"views", {{"left", view}, {"right", view}}}}};
  write_bytes(cameras, list.dump());
  wall_frame().write(folder / "shot.0005.exr");
  const Finished finished = compute("shot.0005.exr", {"--view", "left"});
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_TRUE(read_exr_image(ao).pixels == right);
}

class SingleFrame : public CommandLine {};

TEST_F(SingleFrame, that_fails_says_why_though_others_would_go_on) {
  const Finished ends = run({"--normal-space", "view"}),
                 goes_on = run({"--normal-space", "view", "--keep-going", "-q"});
  EXPECT_EQ(ends.code, 3);
  EXPECT_EQ(goes_on.code, 1);
  EXPECT_EQ(goes_on.err, ends.err);
  EXPECT_THAT(ends.err, HasSubstr("alcove: error: "));
}

TEST_F(SingleFrame, that_a_run_refuses_is_refused_by_a_dry_one) {
  const Finished whole = run({"--normal-space", "view"}), dry = run({"--normal-space", "view", "--dry-run"});
  EXPECT_EQ(dry.code, 3) << dry;
  EXPECT_EQ(dry.err, whole.err);
}

TEST_F(SingleFrame, puts_its_number_into_the_names_of_its_outputs) {
  ASSERT_EQ(run_program({"run", frame, "-o", folder / "ao.%04d.exr", "--camera", camera, "--radius", "1"}).code, 0);
  EXPECT_TRUE(fs::exists(folder / "ao.0042.exr"));
  EXPECT_FALSE(fs::exists(folder / "ao.%04d.exr"));
  fs::rename(frame, folder / "wall_v002.exr");
  const std::vector<std::string> unclear{
      "run", folder / "wall_v002.exr", "-o", folder / "ao.####.exr", "--camera", camera, "--radius", "1"};
  const Finished finished = run_program(unclear);
  EXPECT_EQ(finished.code, 2);
  EXPECT_THAT(finished.err, AllOf(HasSubstr("ao.####.exr"), HasSubstr("wall_v002.exr"), HasSubstr("--frames")));
}

TEST_F(SingleFrame, of_which_nothing_is_used_is_said) {
  FrameFile depth = wall_frame(), normals = wall_frame();
  std::erase_if(depth.planes, [](const auto& plane) { return plane.first.find("Normal") != plane.first.npos; });
  std::erase_if(normals.planes, [](const auto& plane) { return plane.first.find("Normal") == plane.first.npos; });
  depth.write(folder / "depth.exr");
  normals.rename("ViewLayer.Normal.X", "foo.X");
  normals.rename("ViewLayer.Normal.Y", "foo.Y");
  normals.rename("ViewLayer.Normal.Z", "foo.Z");
  normals.write(frame);
  EXPECT_THAT(run({"--depth", folder / "depth.exr"}).err,
              AllOf(HasSubstr("no channel of " + frame), HasSubstr("--normal"), HasSubstr("[unused-input]")));
  EXPECT_THAT(run({"--depth", folder / "depth.exr", "--normal-channels", "foo"}).err, Not(HasSubstr("unused-input")));
  EXPECT_THAT(run({"--depth", folder / "depth.exr", "--normal", "none"}).err, Not(HasSubstr("unused-input")));
}

class Missing : public CommandLine {};

TEST_F(Missing, is_all_listed_at_once_with_the_command_that_would_do) {
  const Finished all = run_program({"run", frame});
  EXPECT_EQ(all.code, 2);
  EXPECT_THAT(all.err, AllOf(HasSubstr("-o FILE.exr"), HasSubstr("--camera FILE.json"), HasSubstr("--fov"),
                             HasSubstr("--radius NUMBER"), HasSubstr("such as:\nalcove run " + frame + " -o ao.exr")));
  EXPECT_EQ(lines_of(all.err).size(), 6) << all << "one for each thing, and the command alone on the last";
  EXPECT_EQ(run_program({"run", frame, "--dry-run"}).code, 2);

  // The command works as it is proposed, with the radius that inspect proposes.
  const Finished some = run_program({"run", frame, "--camera", camera, "--type", "float"});
  EXPECT_EQ(some.code, 2);
  EXPECT_THAT(some.err, Not(HasSubstr("a camera: ")));
  const std::string program = "alcove ", proposed = lines_of(some.err).back();
  ASSERT_THAT(proposed, testing::StartsWith(program));
  std::istringstream words(proposed.substr(program.size()));
  const std::vector<std::string> arguments{std::istream_iterator<std::string>(words), {}};
  EXPECT_THAT(arguments, testing::IsSupersetOf({"--type", "float", "--camera", "-o", "ao.exr", "--radius"}));
  EXPECT_EQ(run_program(arguments, {.folder = folder.path()}).code, 0);
  EXPECT_THAT(run_program({"inspect", frame, "--camera", camera}).out,
              HasSubstr(" --radius " + *(std::ranges::find(arguments, "--radius") + 1)));
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
    for (float& z : file.planes.at("ViewLayer.Depth.Z")) z = number == 1 ? 1e10f : z * float(number);
    file.write(input(number));
  }
  const Finished finished = run({"--radius", "auto", "--normal-space", "world", "--depth-kind", "planar"});
  ASSERT_EQ(finished.code, 0) << finished;
  const std::string radius = text_in(read_header(output(1)), "alcove/radius");
  EXPECT_THAT(finished.err, AllOf(HasSubstr("--radius auto takes " + radius), HasSubstr("[automatic-radius]")));
  for (const int number : {2, 3}) EXPECT_EQ(text_in(read_header(output(number)), "alcove/radius"), radius);
  const auto whole = outputs();
  remove_outputs();
  for (const char* chunk : {"2/2", "1/2"})
    ASSERT_EQ(run({"--radius", "auto", "--normal-space", "world", "--depth-kind", "planar", "--chunk", chunk}).code, 0);
  EXPECT_TRUE(outputs() == whole);
  EXPECT_THAT(run({"--radius", "auto", "--resume", "--normal-space", "world", "--depth-kind", "planar"}).err,
              HasSubstr("3 kept"));
  EXPECT_THAT(run({"--radius", radius, "--resume", "--normal-space", "world", "--depth-kind", "planar"}).err,
              HasSubstr("3 kept"))
      << "the number that was found is what counts";
  EXPECT_THAT(run({"--radius", "auto", "--dry-run"}).out, HasSubstr("auto takes " + radius));
}

TEST_F(Radius, auto_is_the_only_one_and_needs_a_surface) {
  write_frames(1, 1);
  EXPECT_EQ(run({"--radius", "auto", "--radius", "1"}).code, 2);
  FrameFile sky = wall_frame();
  for (float& z : sky.planes.at("ViewLayer.Depth.Z")) z = 1e10f;
  sky.write(input(1));
  const Finished finished = run({"--radius", "auto"});
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err, HasSubstr("--radius NUMBER"));
}

}  // namespace
}  // namespace alcove
