// Signals that ask a program to end.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/system.h"
#include "tests/support/test.h"

#include <csignal>

namespace alcove::system_test {
namespace {

using testing::ExitedWithCode;
using testing::KilledBySignal;

/// Catches signals, sends itself these two, and exits with the number of the signal that was caught.
[[noreturn]] void exit_after(int first, int second) {
  std::signal(SIGHUP, SIG_DFL);
  catch_ending_signals();
  std::raise(first);
  std::raise(second);
  std::_Exit(caught_signal());
}

TEST(Signals, tell_of_the_first_of_several) {
  EXPECT_EXIT(exit_after(SIGTERM, SIGINT), ExitedWithCode(SIGTERM), "");
  EXPECT_EXIT(exit_after(SIGINT, SIGHUP), ExitedWithCode(SIGINT), "");
}

TEST(Signals, end_the_process_the_second_time) {
  for (const int number : {SIGHUP, SIGINT, SIGTERM})
    EXPECT_EXIT(exit_after(number, number), KilledBySignal(number), "") << number;
}

}  // namespace
}  // namespace alcove::system_test
