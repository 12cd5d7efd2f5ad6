// Runs the cases of a room, or of one of its sources by name: `build/tests/chain_tests skip_test`.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace {

/// A filter of GoogleTest for the cases of the source NAME.cpp; empty where it has none.
std::string cases_of(const std::string& name) {
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  std::string filter;
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const testing::TestInfo& test = *suite.GetTestInfo(t);
      if (std::filesystem::path(test.file()).stem() == name) filter += fmt::format("{}.{}:", suite.name(), test.name());
    }
  }
  return filter;
}

}  // namespace

int main(int count, char** arguments) {
  testing::InitGoogleMock(&count, arguments);
  if (count == 1) return RUN_ALL_TESTS();
  const std::string filter = cases_of(arguments[1]);
  if (count > 2 || filter.empty()) {
    fmt::print(stderr, "usage: {} [SOURCE] [options of GoogleTest]\nSOURCE is the name of one here, without .cpp\n",
               arguments[0]);
    return 2;
  }
  GTEST_FLAG_SET(filter, filter);
  return RUN_ALL_TESTS();
}
