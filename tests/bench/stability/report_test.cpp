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

  const json numbers = json::parse(stability_json(report));
  ASSERT_EQ(numbers.at("axes").size(), report.axes.size());
  const std::string page = stability_page(report), text = stability_text(report);
  for (std::size_t a = 0; a < report.axes.size(); a++) {
    const auto& axis = report.axes[a];
    const json& written = numbers["axes"][a];
    EXPECT_EQ(written.at("name"), axis.name);
    ASSERT_EQ(written.at("points").size(), axis.points.size());
    for (std::size_t c = 0; c < axis.curves.size(); c++) {
      EXPECT_EQ(written.at("curves")[c].at("estimator"), axis.curves[c].estimator);
      EXPECT_EQ(written["curves"][c].at("breaks_at").size(), axis.curves[c].breaks.size());
      EXPECT_EQ(written["curves"][c].at("rmse").size(), axis.points.size());
    }
    EXPECT_THAT(page, HasSubstr(axis.name));
    EXPECT_THAT(text, HasSubstr(axis.name));
  }
}

}  // namespace
}  // namespace alcove::stability_report_test
