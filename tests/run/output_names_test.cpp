// Names of inputs and outputs: endings, folders that are made, what shells make of sequences.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"

namespace alcove::output_names_test {
namespace {

using namespace test;

class OutputNames : public CommandLine {
 protected:
  /// `run` to this output, with these arguments.
  Finished to(const std::string& output, const Options& more = {}) const {
    return run_program(joined({"run", frame, "-o", output, "--camera", camera, "--radius", "1"}, more));
  }
};

TEST_F(OutputNames, that_end_in_another_format_are_refused) {
  FrameFile file = wall_frame();
  add_beauty(file);
  file.write(frame);
  const auto before = names_in(folder.path());
  const auto expect_refused = [&](const Finished& finished, const char* name, const char* option, const char* ending) {
    test::expect_refused(finished, 2, {name, option, ending});
    EXPECT_EQ(names_in(folder.path()), before);
  };
  for (const char* name :
       {"x.png", "x.tif", "x.JPG", "x.png.tmp", "x.png.0001", "x.json", "x.exr.zip", "x", "x.0001"}) {
    expect_refused(to(folder / name), name, "--output", ".exr");
    expect_refused(to(ao, {"--composite", folder / name}), name, "--composite", ".exr");
  }
  for (const char* name : {"x.jpg", "x.exr", "x.tif", "x.jpg.part", "x"}) {
    const Options preview{"--preview", folder / name};
    expect_refused(to(ao, preview), name, "--preview", ".png");
    expect_refused(run_program(joined({"inspect", frame, "--camera", camera}, preview)), name, "--preview", ".png");
  }
  expect_refused(to(folder / "x.####.png", {"--frames", "1"}), "x.0001.png", "--output", ".exr");
  expect_refused(to(folder / "x.png", {"--dry-run"}), "x.png", "--output", ".exr");
}

TEST_F(OutputNames, of_files_in_the_making_are_as_good) {
  for (const char* name : {"ao.EXR", "ao.exr.tmp", "ao.exr.0001", "v1.2.exr"}) {
    const Finished finished = to(folder / name, {"--preview", folder / "preview.png.part"});
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_EQ(read_exr_image(folder / name).data, kWallWindow) << name;
    EXPECT_EQ(read_bytes(folder / "preview.png.part").substr(1, 3), "PNG");
  }
}

TEST_F(OutputNames, have_their_folders_made) {
  const std::string made = folder / "a/b";
  const std::vector<std::string> everywhere{"--preview",  folder / "p/p.png",   "--stats", folder / "s/t/s.json",
                                            "--log-json", folder / "l/l.jsonl", "--set",   "debug=edges"};
  test::expect_refused(to(made + "/ao.exr", {"--set", "no-mkdir=true"}), 4, {made});
  EXPECT_FALSE(fs::exists(folder / "a"));

  EXPECT_EQ(to(made + "/ao.exr", {"--dry-run"}).code, 0);
  EXPECT_FALSE(fs::exists(folder / "a")) << "a dry run makes nothing";
  EXPECT_NE(to(made + "/ao.exr", {"--device", "99"}).code, 0);
  EXPECT_NE(to(made + "/ao.exr", {"--normal-channels", "none.of.them"}).code, 0);
  EXPECT_FALSE(fs::exists(folder / "a")) << "a run that fails leaves no empty folders";

  const Finished finished = to(made + "/ao.exr", everywhere);
  EXPECT_EQ(finished.code, 0) << finished;
  for (const char* name : {"a/b/ao.exr", "a/b/ao.edges.png", "p/p.png", "s/t/s.json", "l/l.jsonl"})
    EXPECT_TRUE(fs::is_regular_file(folder / name)) << name;
}

TEST_F(OutputNames, in_folders_that_cannot_be_made_are_refused_before_any_work) {
  write_bytes(folder / "file", "no folder");
  const Finished finished = to(folder / "file/ao.exr");
  EXPECT_EQ(finished.code, 4) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr(folder / "file"), HasSubstr("--output"), Not(HasSubstr("read"))));
  EXPECT_EQ(to(folder / "file/a/b/ao.exr").code, 4);
  EXPECT_EQ(to("/proc/none/ao.exr").code, 4);
}

class InputNames : public SequenceFolder {};

TEST_F(InputNames, of_a_folder_are_told_from_those_of_a_file) {
  write_frames(1, 1);
  for (const std::string& name : {in, in + "/"})
    for (const Options& more : {Options{"-o", out + "/ao.exr", "--camera", camera, "--radius", "1"}, {}}) {
      const Finished finished = run_program(joined({"run", name}, more));
      test::expect_refused(finished, 3, {name + ": is a folder; INPUT takes a file", in + "/shot.####.exr"});
    }
}

TEST_F(InputNames, of_another_frame_are_a_warning) {
  FrameFile lit = wall_frame();
  add_beauty(lit);
  write_frames(5, 6, lit);
  const auto run_with = [&](const std::string& name, const std::string& beauty, const Options& more = {}) {
    return run_program(joined({"run", name, "--beauty", beauty, "--composite", out + "/c.exr", "-o", out + "/ao.exr",
                               "--camera", camera, "--radius", "1"},
                              more));
  };
  const std::string said =
      "--beauty " + input(6) + ": by the digits 0006 of its name it belongs to frame 6, and the frame ";
  EXPECT_THAT(run_with(input(5), input(6)).err, AllOf(HasSubstr(said + "is 5"), HasSubstr("[other-frame]")));
  EXPECT_THAT(run_with(in + "/f.%04d.exr", input(6), {"--frames", "5"}).err, HasSubstr("[other-frame]"));
  EXPECT_THAT(run_with(input(6), input(6)).err, Not(HasSubstr("[other-frame]")));
  EXPECT_THAT(
      run_with(input(6), input(5), {"--frames", "5"}).err,
      HasSubstr("INPUT " + input(6) + ": by the digits 0006 of its name it belongs to frame 6, and the frame is 5"));
  test::expect_refused(run_with(input(5), input(6), {"--strict"}), 3, {said, "--strict"});
}

TEST_F(InputNames, that_are_globs_are_answered_with_the_pattern) {
  write_frames(1, 2);
  const auto run_on = [&](const Options& inputs) {
    return run_program(joined(joined({"run"}, inputs), {"-o", out + "/ao.exr", "--camera", camera, "--radius", "1"}));
  };
  for (const auto& [glob, pattern] : {std::pair(in + "/f.*.exr", in + "/f.####.exr"),
                                      {in + "/f.?????.exr", in + "/f.#####.exr"},
                                      {in + "/*.*", "shot.####.exr"}}) {
    test::expect_refused(run_on({glob}), 2, {glob, "write " + pattern});
    EXPECT_THAT(names_in(out), IsEmpty());
  }
  const Finished bare = run_program({"run", in + "/f.*.exr"});
  EXPECT_EQ(bare.code, 2) << bare;
  EXPECT_THAT(bare.err, AllOf(HasSubstr("write " + in + "/f.####.exr"), Not(HasSubstr("such as"))));
  test::expect_refused(run_on({input(1), input(2)}), 2, {"write " + in + "/f.####.exr"});
  // A file of that very name is no glob.
  fs::copy_file(input(1), in + "/what?.exr");
  EXPECT_EQ(run_on({in + "/what?.exr"}).code, 0);
}

}  // namespace
}  // namespace alcove::output_names_test
