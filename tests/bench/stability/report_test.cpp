// What `alcove bench --stability` says: every estimator on every axis, and no breakdown that a run would pass over in
// silence.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/stability.h"
#include "tests/support/device.h"
#include "tests/support/test.h"

namespace alcove::stability_report_test {
namespace {

using namespace test;

TEST(StabilityReport, says_where_each_estimator_breaks_down_and_that_a_run_notes_it) {
  int lines = 0;
  // One axis on which nothing fails, and one on which all do; in the long form all.
  const StabilityPart part = test::long_tests()
                                 ? StabilityPart{}
                                 : StabilityPart{.axes = {"depth scale", "16 bits of device depth"}, .most_points = 3};
  const StabilityReport report = run_stability(
      test::device(), [&](const std::string&) { lines++; }, part);
  EXPECT_EQ(lines, int(report.axes.size()));
  ASSERT_EQ(report.axes.size(), test::long_tests() ? 13 : 2);
  ASSERT_EQ(report.plain.size(), 7);
  for (const auto& [estimator, rmse] : report.plain) EXPECT_LT(rmse, 0.06) << estimator;
  std::set<std::string> names;
  int breaks = 0;
  for (const auto& axis : report.axes) {
    EXPECT_TRUE(names.insert(axis.name).second) << axis.name;
    ASSERT_EQ(axis.curves.size(), report.plain.size()) << axis.name;
    for (const auto& curve : axis.curves) {
      ASSERT_EQ(curve.rmse.size(), axis.points.size()) << axis.name << ", " << curve.estimator;
      for (std::size_t i = 0; i < curve.rmse.size(); i++)
        EXPECT_TRUE(curve.rmse[i] >= 0 && curve.rmse[i] <= 1)
            << axis.name << " at " << axis.points[i].at << ", " << curve.estimator << ": " << curve.rmse[i];
      for (const std::size_t i : curve.breaks) {
        breaks++;
        EXPECT_FALSE(axis.points.at(i).notes.empty())
            << axis.name << " at " << axis.points[i].at << ", " << curve.estimator << ": " << curve.rmse[i];
      }
      EXPECT_TRUE(curve.said) << axis.name << ", " << curve.estimator;
    }
  }
  EXPECT_GT(breaks, 0) << "depth of 16 bits, if nothing else";
}

}  // namespace
}  // namespace alcove::stability_report_test
