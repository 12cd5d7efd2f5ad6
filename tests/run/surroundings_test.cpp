// The same run under other surroundings: threads, homes, folders, names, links. What it computes stays the same.
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "core/base/file.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove::surroundings_test {
namespace {

using namespace test;

class SurroundingsTest : public CommandLine {
 protected:
  /// The AO file's bytes, of a run that must succeed.
  std::string result(const Options& more, const Launch& launch = {}) const {
    return done(more, launch).code == 0 ? read_bytes(ao) : "";
  }
  /// A run must succeed and give the file that a plain run gives.
  void expect_plain(const Options& more, const Launch& launch = {}) {
    if (plain.empty()) plain = result({});
    EXPECT_TRUE(result(more, launch) == plain)
        << "another file with " << testing::PrintToString(more) << " " << testing::PrintToString(launch.environment);
  }
  void expect_plain_with(const std::map<std::string, std::optional<std::string>>& environment) {
    expect_plain({}, {.environment = environment});
  }

  std::string plain;
};

TEST_F(SurroundingsTest, that_repeat_or_thread_a_run_give_the_same_file_and_a_seed_gives_other_pixels) {
  for (const Options& more : {Options{}, {"--threads", "1"}, {"--threads", "3"}}) expect_plain(more);
  EXPECT_NE(computed({"--seed", "1"}).pixels, computed({}).pixels);
}

TEST_F(SurroundingsTest, a_quiet_run_prints_nothing_and_a_verbose_one_every_pass) {
  const Finished quiet = done({"--quiet"}), plain = run({}), verbose = run({"-v"});
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_THAT(plain.out, IsEmpty());
  EXPECT_THAT(plain.err, HasSubstr("wall.0042.exr"));
  for (const char* pass : {"prepare", "horizon"}) EXPECT_THAT(verbose.err, HasSubstr(pass));
}

TEST_F(SurroundingsTest, the_validation_layer_has_nothing_to_say) {
  FrameFile input = wall_frame();
  add_beauty(input);
  input.write(frame);
  const Finished finished = run({"--validate", "--composite", folder / "composite.exr", "--set", "power=2"});
  if (finished.err.find("is not installed") != std::string::npos) GTEST_SKIP() << finished;
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.err, Not(HasSubstr("vulkan validation")));
}

TEST_F(SurroundingsTest, without_a_home_or_with_a_read_only_one_cost_nothing_but_time) {
  expect_plain_with({{"HOME", std::nullopt}, {"XDG_CACHE_HOME", std::nullopt}});
  expect_plain_with({{"HOME", "/nonexistent"}, {"XDG_CACHE_HOME", std::nullopt}});
  expect_plain_with({{"HOME", ""}, {"XDG_CACHE_HOME", "relative"}});
  expect_plain_with({{"HOME", std::nullopt}, {"XDG_CACHE_HOME", "/dev/null"}});
  const std::string home = folder / "home";
  fs::create_directory(home);
  if (!mount_memory(home, "size=64k") || !make_read_only(home)) GTEST_SKIP() << "this process may not mount";
  expect_plain_with({{"HOME", home}, {"XDG_CACHE_HOME", std::nullopt}});
  expect_plain_with({{"HOME", home}, {"XDG_CACHE_HOME", home}});
  unmount(home);
}

TEST_F(SurroundingsTest, with_a_full_cache_folder_cost_nothing_but_time_and_leave_it_as_it_was) {
  const std::string home = folder / "home";
  fs::create_directory(home);
  if (!mount_memory(home, "size=4k")) GTEST_SKIP() << "this process may not mount";
  write_bytes(home + "/full", std::string(4096, 'x'));
  // Mesa 22.3 maps the index of its own cache before there is room for it, and dies of the first write.
  expect_plain_with({{"XDG_CACHE_HOME", home}, {"MESA_SHADER_CACHE_DISABLE", "true"}});
  unmount(home);
}

TEST_F(SurroundingsTest, presets_are_found_beside_the_program_above_it_and_in_share) {
  for (const char* place : {"bin/presets", "presets", "share/alcove/presets"}) {
    const std::string install = folder / ("install of " + fs::path(place).begin()->string());
    fs::create_directories(install + "/bin");
    fs::create_directories(install + "/" + place);
    fs::copy_file(ALCOVE_PROGRAM, install + "/bin/alcove");
    write_bytes(install + "/" + place + "/mine.toml", "slices = 4\n");
    const Finished finished = run_program(
        {"presets"}, {.environment = {{"ALCOVE_PRESETS", std::nullopt}}, .program = install + "/bin/alcove"});
    EXPECT_THAT(finished.out, HasSubstr("\n  mine\n")) << place << " " << finished;
  }
}

TEST_F(SurroundingsTest, help_needs_no_presets) {
  for (const char* command : {"run", "presets"})
    EXPECT_EQ(run_program({command, "--help"}, {.environment = {{"ALCOVE_PRESETS", "/nonexistent"}}}).code, 0)
        << command;
}

TEST_F(SurroundingsTest, relative_paths_are_relative_to_the_working_directory_and_may_begin_with_a_dash) {
  const auto run_here = [&](const std::string& arguments) {
    run_well(typed("run --camera camera.json --radius 1 " + arguments), {.folder = folder.path(), .environment = {}});
  };
  run_here("wall.0042.exr -o ./ao.exr");
  const std::string relative = read_bytes(ao);
  EXPECT_TRUE(relative == result({})) << "another file";
  fs::copy_file(frame, folder / "-wall.0042.exr");
  run_here("-o -ao.exr -- -wall.0042.exr");
  EXPECT_TRUE(fs::exists(folder / "-ao.exr"));
}

TEST_F(SurroundingsTest, file_names_may_hold_spaces_and_any_script) {
  for (const std::string name : {"Ünïcode ☂ 框架", "100% {brace} 'quote' \"double\" a#b=c;d,e", "not utf-8 \xff"}) {
    const std::string shot = folder / (name + "/"), of = shot + name;
    fs::create_directory(shot);
    for (const char* file : {"wall.0042.exr", "camera.json"}) fs::copy_file(folder / file, of + file);
    run_well({"run", of + "wall.0042.exr", "-o", of + " ao.exr", "--camera", of + "camera.json", "--radius", "1",
              "--preview", of + ".png", "--stats", of + ".json"});
    EXPECT_EQ(names_in(shot).size(), 5) << name;
    EXPECT_EQ(text_in(read_header(of + " ao.exr"), "alcove/input"), name + "wall.0042.exr");
    EXPECT_TRUE(json::accept(read_bytes(of + ".json"))) << name;
  }
}

TEST_F(SurroundingsTest, an_output_has_the_permissions_that_the_umask_leaves) {
  const mode_t before = ::umask(0002);
  result({"--composite", "", "--stats", folder / "stats.json"});
  ::umask(before);
  for (const std::string& file : {ao, folder / "stats.json"}) {
    struct stat status {};
    ASSERT_EQ(::stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0664) << file;
  }
}

TEST_F(SurroundingsTest, an_output_that_is_a_symbolic_link_is_replaced_and_not_followed) {
  const std::string preview = folder / "p.png", stats = folder / "s.json", log = folder / "l.jsonl";
  for (const std::string& link : {ao, folder / "ao.edges.png", preview, stats, log}) {
    write_bytes(link + ".named", "before");
    fs::create_symlink(link + ".named", link);
  }
  result({"--set", "debug=edges", "--preview", preview, "--stats", stats, "--log-json", log});
  for (const std::string& file : {ao, folder / "ao.edges.png", preview, stats, log}) {
    EXPECT_TRUE(!fs::is_symlink(file) && fs::file_size(file) > 100) << file;
    EXPECT_EQ(read_bytes(file + ".named"), "before") << file;
  }
}

TEST_F(SurroundingsTest, names_of_devices_are_never_replaced) {
  // In /dev itself only the error would show what is wrong, and a mistake would harm the machine: /proc stands for it,
  // where nothing can be replaced.
  for (const std::string path : {"/proc/self/fd/1", "/proc/self/none.json"})
    expect_refused(4, {"--stats", path}, {path, "no place for files", "--stats"});
  EXPECT_FALSE(fs::exists(ao));
}

TEST_F(SurroundingsTest, a_folder_that_is_a_symbolic_link_is_followed) {
  fs::create_directory(folder / "v2");
  fs::create_directory_symlink("v2", folder / "latest");
  EXPECT_EQ(run_program({"run", frame, "-o", folder / "latest/ao.exr", "--camera", camera, "--radius", "1"}).code, 0);
  EXPECT_THAT(names_in(folder / "v2"), ElementsAre("ao.exr"));
}

TEST_F(SurroundingsTest, what_poses_as_an_unfinished_file_is_neither_followed_nor_waited_for) {
  const std::string pipe = folder / ".alcove-1-0000000a.tmp", link = folder / ".alcove-1-0000000b.tmp";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink(camera, link);
  write_bytes(folder / ".alcove-1-0000000c.tmp", "left by a process that was killed");
  const std::vector<std::string> others{".alcove-notes.tmp", ".alcove-1-0000000c.tmp.exr", ".alcove-1-c.tmp",
                                        ".alcove--0000000c.tmp", ".alcove-x1-0000000c.tmp"};
  for (const auto& name : others) write_bytes(folder / name, "somebody's own");
  EXPECT_EQ(remove_unfinished(folder.path()), 1);
  for (const auto& name : others) EXPECT_TRUE(fs::exists(folder / name)) << name;
  EXPECT_TRUE(fs::exists(pipe) && fs::exists(link) && fs::exists(camera));
}

TEST_F(SurroundingsTest, a_run_replaces_what_was_there_and_no_reader_sees_half_a_file) {
  // What was open before the run still shows the old bytes: the new file came under a name of its own.
  write_bytes(ao, "before");
  std::ifstream before(ao);
  result({"--composite", "", "--preview", folder / "p.png"});
  std::string word;
  before >> word;
  EXPECT_EQ(word, "before");
  EXPECT_THAT(names_in(folder.path()), UnorderedElementsAre("ao.exr", "camera.json", "p.png", "wall.0042.exr"));
}

}  // namespace
}  // namespace alcove::surroundings_test
