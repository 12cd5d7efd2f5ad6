// What goes wrong in long runs, done for real: damaged and vanished files, full disks, signals, a lost device; and what
// --resume makes good.
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/support/command_line.h"

namespace alcove::faults_test {
namespace {

using namespace test;

class Faults : public SequenceFolder {
 protected:
  /// Runs that end early must leave some of the files that a whole run leaves, and no others.
  void expect_some_of(const std::map<std::string, std::string>& whole) const {
    EXPECT_LT(outputs().size(), whole.size());
    for (const auto& [name, bytes] : outputs()) EXPECT_TRUE(whole.contains(name) && whole.at(name) == bytes) << name;
  }
  std::map<std::string, std::string> whole_outputs(const Options& more = {}) const {
    done(more);
    const auto whole = outputs();
    remove_outputs();
    return whole;
  }
};

void sleep_ms(double ms) { std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(ms)); }

/// Waits for the program to have written that many files, then signals it.
Launch signalled(const std::string& out, std::size_t files, int signal) {
  Launch launch;
  launch.meanwhile = [=](int process) {
    for (int i = 0; i < 3000 && names_in(out).size() < files; i++) sleep_ms(10);
    ::kill(process, signal);
  };
  return launch;
}

void cut_short(const std::string& path) { fs::resize_file(path, fs::file_size(path) - 10); }

TEST_F(Faults, damaged_frames_end_the_run_by_name_or_are_left_out) {
  write_frames(1, 6);
  cut_short(input(3));
  const Finished finished = run({"--threads", "1"});
  EXPECT_EQ(finished.code, 3) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("error: frame 3: "), HasSubstr("f.0003.exr")));
  EXPECT_THAT(lines_of(finished.err).back(), StartsWith("alcove: 2 frames done, 1 failed (3), 3 not begun"));
  EXPECT_THAT(names_in(out), ElementsAre("ao.0001.exr", "ao.0002.exr"));
  write_bytes(input(1), "no EXR");
  remove_outputs();
  const Finished going = run({"--keep-going"});
  EXPECT_EQ(going.code, 1) << going;
  EXPECT_THAT(lines_of(going.err).back(), StartsWith("alcove: 4 frames done, 2 failed (1, 3)"));
  EXPECT_THAT(names_in(out), ElementsAre("ao.0002.exr", "ao.0004.exr", "ao.0005.exr", "ao.0006.exr"));
}

TEST_F(Faults, an_input_that_vanishes_is_a_failed_frame) {
  write_frames(1, 60);
  Launch launch;
  launch.meanwhile = [&](int) {
    for (int i = 0; i < 3000 && names_in(out).empty(); i++) sleep_ms(10);
    fs::remove(input(60));
  };
  const Finished finished = run({"--keep-going"}, launch);
  EXPECT_EQ(finished.code, 1) << finished;
  EXPECT_THAT(finished.err, HasSubstr("1 failed (60)"));
  EXPECT_THAT(names_in(out), SizeIs(59));
}

TEST_F(Faults, signals_end_the_run_and_leave_whole_files_only) {
  write_frames(1, 150);
  const auto whole = whole_outputs();
  for (const auto& [signal, code] : {std::pair(SIGTERM, 143), std::pair(SIGINT, 130), std::pair(SIGHUP, 129)}) {
    remove_outputs();
    const Finished finished = run({}, signalled(out, 3, signal));
    EXPECT_EQ(finished.code, code) << finished;
    EXPECT_THAT(lines_of(finished.err).back(), HasSubstr("not begun or dropped"));
    expect_some_of(whole);
  }
}

TEST_F(Faults, a_signal_ends_a_run_whose_frames_are_means_of_many) {
  write_frames(1, 60);
  const auto whole = whole_outputs({"--accumulate", "2"});
  const Finished finished = run({"--accumulate", "2"}, signalled(out, 3, SIGINT));
  EXPECT_EQ(finished.code, 130) << finished;
  expect_some_of(whole);
}

TEST_F(Faults, a_run_that_nohup_started_outlives_its_terminal) {
  write_frames(1, 60);
  Launch launch = signalled(out, 3, SIGHUP);
  launch.program = "/bin/sh";
  run_well(joined({"-c", "trap '' HUP; exec \"$0\" \"$@\"", ALCOVE_PROGRAM, "run"}, arguments({"--noise", "animated"})),
           launch);
  EXPECT_THAT(names_in(out), SizeIs(60));
}

TEST_F(Faults, a_terminal_that_stands_still_stops_no_frame) {
  constexpr int kFrames = 120;
  write_frames(1, kFrames);
  // A pipe that nobody reads takes the place of a terminal after Ctrl-S: it holds 4 KiB, and the run says more.
  const std::string terminal = folder / "terminal";
  ASSERT_EQ(::mkfifo(terminal.c_str(), 0600), 0);
  const int reader = ::open(terminal.c_str(), O_RDWR | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  ASSERT_GT(::fcntl(reader, F_SETPIPE_SZ, 4096), 0);
  Launch launch;
  launch.err = terminal;
  std::size_t written = 0;
  launch.meanwhile = [&](int process) {
    const auto whole_files = [&] {
      return std::size_t(std::ranges::count_if(names_in(out), [](const auto& name) { return name.ends_with(".exr"); }));
    };
    for (int i = 0; i < 1000 && whole_files() < kFrames; i++) sleep_ms(20);
    written = whole_files();
    // Now the user presses Ctrl-Q.
    const auto is_running = [&] {
      siginfo_t end{};
      return ::waitid(P_PID, id_t(process), &end, WEXITED | WNOHANG | WNOWAIT) == 0 && end.si_pid == 0;
    };
    std::array<char, 4096> text;
    while (is_running())
      if (::read(reader, text.data(), text.size()) <= 0) sleep_ms(5);
  };
  const Finished finished = run({"--noise", "animated"}, launch);
  ::close(reader);
  EXPECT_EQ(finished.code, 0);
  EXPECT_EQ(written, std::size_t(kFrames)) << "before anybody read what the run has to say";
}

TEST_F(Faults, a_kill_at_any_moment_leaves_whole_files_and_what_is_cleaned_next_time) {
  write_frames(1, 40);
  const auto whole = whole_outputs();
  for (int i = 0; i < 12; i++) {
    Launch launch;
    launch.meanwhile = [&](int process) {
      sleep_ms(40 + 37 * i);
      ::kill(process, SIGKILL);
    };
    run({"--resume"}, launch);
    for (const auto& [name, bytes] : outputs())
      if (!name.starts_with(".alcove-")) EXPECT_TRUE(whole.at(name) == bytes) << name;
  }
  write_bytes(out + "/.alcove-1-deadbeef.tmp", "left by a process that was killed");
  EXPECT_EQ(run({"--resume"}).code, 0);
  EXPECT_TRUE(outputs() == whole) << testing::PrintToString(names_in(out));
}

TEST_F(Faults, resume_redoes_what_is_missing_stale_or_broken_or_has_another_input_of_any_age) {
  write_frames(1, 8);
  done();
  const auto whole = outputs();
  EXPECT_THAT(run({"--resume"}).err, HasSubstr("0 frames done, 8 kept"));
  fs::remove(output(2));
  cut_short(output(4));
  fs::last_write_time(input(5), fs::last_write_time(output(5)) + std::chrono::seconds(1));
  write_bytes(output(7), "no EXR");
  const Finished finished = done({"--resume"});
  EXPECT_THAT(finished.err, HasSubstr("4 frames done, 4 kept"));
  for (const int frame : {1, 3, 6, 8}) EXPECT_THAT(finished.err, HasSubstr(output(frame) + ": whole, kept"));
  EXPECT_TRUE(outputs() == whole);
  FrameFile other = wall_frame();
  other.change("Depth", [](float z) { return 1.5f * z; });
  other.write(input(2));
  for (const int frame : {2, 5})
    fs::last_write_time(input(frame), fs::last_write_time(output(1)) - std::chrono::hours(1));
  EXPECT_THAT(run({"--resume"}).err, HasSubstr("1 frame done, 7 kept"));
  EXPECT_NE(read_bytes(output(2)), whole.at("ao.0002.exr"));
  EXPECT_THAT(run({"--resume", "--radius", "2"}).err, HasSubstr("8 frames done"));
  EXPECT_THAT(run({"--resume", "--radius", "2"}).err, HasSubstr("8 kept"));
  EXPECT_THAT(run({"--resume", "--set", "overwrite=true", "--radius", "2"}).err, HasSubstr("8 frames done"));
}

TEST_F(Faults, resume_looks_at_every_output) {
  write_frames(1, 2);
  const Options more{"--preview", out + "/p.%04d.png", "--resume"}, other = joined(more, {"--radius", "0.5"});
  done(more);
  EXPECT_THAT(run(more).err, HasSubstr("2 kept"));
  cut_short(out + "/p.0002.png");
  EXPECT_THAT(run(more).err, HasSubstr("1 frame done, 1 kept"));
  const std::string picture = read_bytes(out + "/p.0001.png");
  done({"--radius", "0.5"});  // which leaves the pictures as they are
  EXPECT_THAT(run(other).err, HasSubstr("2 frames done, in")) << "pictures of another radius";
  EXPECT_NE(read_bytes(out + "/p.0001.png"), picture);
  EXPECT_THAT(run(other).err, HasSubstr("0 frames done, 2 kept"));
}

TEST_F(Faults, a_full_disk_leaves_nothing_half) {
  write_frames(1, 40);
  const auto whole = whole_outputs();
  const std::string disk = folder / "disk";
  fs::create_directory(disk);
  if (!mount_memory(disk, "size=48k")) GTEST_SKIP() << "this process may not mount";
  const Finished stopped = run({"-o", disk + "/ao.%04d.exr"});
  const Finished went_on = run({"-o", disk + "/ao.%04d.exr", "--keep-going"});
  const auto names = names_in(disk);
  for (const auto& name : names)
    EXPECT_TRUE(whole.contains(name) && read_bytes(disk + "/" + name) == whole.at(name)) << name;
  EXPECT_EQ(stopped.code, 4) << stopped;
  EXPECT_THAT(stopped.err, HasSubstr("No space left"));
  EXPECT_EQ(went_on.code, 1) << went_on;
  EXPECT_THAT(names.size(), AllOf(testing::Gt(1), testing::Lt(40)));
  ASSERT_TRUE(make_read_only(disk));
  EXPECT_EQ(run({"-o", disk + "/ao.%04d.exr"}).code, 4);
  unmount(disk);
}

Launch losing(const char* times) { return {.environment = {{"ALCOVE_LOSSES", times}}, .preload = ALCOVE_LOST_DEVICE}; }

TEST_F(Faults, a_lost_device_is_replaced_once) {
  write_frames(1, 6);
  // computes every frame, though they are equal
  const Options every_frame = typed("--threads 1 --keep-going --noise animated");
  const auto whole = whole_outputs(every_frame);
  done(every_frame, losing("1"));
  EXPECT_TRUE(outputs() == whole);
  const Finished always = run(every_frame, losing("100"));
  EXPECT_EQ(always.code, 5) << always;
  EXPECT_THAT(always.err, AllOf(HasSubstr("the device was lost"), HasSubstr("fresh one")));
}

TEST_F(Faults, what_frames_share_is_kept_when_a_device_is_lost) {
  write_frames(1, 8);
  const auto rows_read_by = [&](const Launch& launch) {
    return stats_of(typed("--accumulate 2 --frames 1,8 --threads 1"), launch)["frames"][0]["rows_read"].get<int>();
  };
  EXPECT_LT(rows_read_by(losing("1")), rows_read_by({})) << "two of its five frames were estimated before";
}

}  // namespace
}  // namespace alcove::faults_test
