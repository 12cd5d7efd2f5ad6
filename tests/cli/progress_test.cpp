// A frame that takes long is told of while it is computed: at a terminal all the time, in logs ever more seldom.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/progress.h"

#include "tests/support/program.h"

namespace alcove::progress_test {
namespace {

using namespace test;

/// What farms are told while so many frames run, of which the first has done so much, and then so much.
std::vector<std::string> told_to_farm(const std::string& kind, int frames, const std::vector<double>& done) {
  ProgressSettings options;
  options.kind = kind;
  options.quiet = true;
  Progress progress(options, "");
  progress.begin({}, frames);
  testing::internal::CaptureStdout();
  for (const double share : done) {
    const FrameProgress frame{.frame = 1, .input = "shot.exr", .seconds = 1, .part = 1, .done = share};
    progress.working({&frame, 1});
  }
  FrameReport report;
  report.frame = 1;
  report.state = FrameState::done;
  progress.frame(report);
  return lines_of(testing::internal::GetCapturedStdout());
}

/// What is printed while one frame is in work for so many seconds, and then for so many.
std::string printed(const std::string& kind, bool is_quiet, const std::vector<double>& seconds,
                    FrameProgress frame = {.frame = 1, .input = "shot.exr", .part = 3, .parts = 17}) {
  ProgressSettings options;
  options.kind = kind;
  options.quiet = is_quiet;
  Progress progress(options, "");
  testing::internal::CaptureStderr();
  for (const double s : seconds) {
    frame.seconds = s;
    progress.working({&frame, 1});
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Progress, tells_a_terminal_of_a_frame_from_two_seconds_on) {
  EXPECT_THAT(printed("bar", false, {0.5, 1.9}), IsEmpty());
  EXPECT_THAT(printed("bar", false, {2.5}), AllOf(HasSubstr("shot.exr: 0:02"), HasSubstr("part 3 of 17")));
}

TEST(Progress, tells_logs_of_a_frame_ever_more_seldom_and_at_least_every_five_minutes) {
  EXPECT_THAT(printed("plain", false, {2.5, 9.5}), IsEmpty());
  const auto lines = lines_of(printed("plain", false, {10, 11, 19, 20, 21, 39, 40}));
  ASSERT_EQ(lines.size(), 3);
  EXPECT_THAT(lines[1], AllOf(HasSubstr("shot.exr: 0:20"), HasSubstr("part 3 of 17")));
  EXPECT_EQ(lines_of(printed("plain", false, {2000, 2001, 2299, 2300, 2301, 2599, 2600})).size(), 3);
  EXPECT_THAT(printed("plain", false, {10}, {.frame = 1, .input = "shot.exr", .part = 1, .done = 0.377}),
              HasSubstr("shot.exr: 0:10 so far, 37 % of it computed"));
}

TEST(Progress, tells_farms_how_far_a_frame_is_and_never_goes_back) {
  EXPECT_THAT(told_to_farm("percent", 1, {0, 0.004, 0.011, 0.014, 0.5, 0.2, 1}),
              ElementsAre("Progress: 1%", "Progress: 50%", "Progress: 99%", "Progress: 100%"));
  EXPECT_THAT(told_to_farm("percent", 4, {0.5, 0.2}), ElementsAre("Progress: 12%", "Progress: 25%"));
  EXPECT_THAT(told_to_farm("openjd", 2, {0, 0.001, 0.25, 0.1, 0.251}),
              ElementsAre("openjd_progress: 12.5", "openjd_progress: 50.0", "openjd_status: frame 1 done"));
  EXPECT_THAT(told_to_farm("plain", 1, {0.5}), IsEmpty());
}

TEST(Progress, takes_its_line_away_at_the_end_of_a_run) {
  ProgressSettings options;
  options.kind = "bar";
  Progress progress(options, "");
  const FrameProgress work{.frame = 1, .input = "shot.exr", .seconds = 5};
  FrameReport failed;
  failed.state = FrameState::failed;
  failed.error = Error(ErrorKind::input, "shot.exr: damaged");
  testing::internal::CaptureStderr();
  progress.working({&work, 1});
  progress.frame(failed);
  progress.end({});
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::EndsWith("\r\x1b[K")) << "an error follows it";
}

TEST(Progress, is_silent_where_nobody_wants_it) {
  for (const char* kind : {"bar", "plain"}) EXPECT_THAT(printed(kind, true, {60}), IsEmpty());
  EXPECT_THAT(printed("none", false, {60}), IsEmpty());
}

}  // namespace
}  // namespace alcove::progress_test
