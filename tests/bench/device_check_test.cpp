// What the device check stores is what the presets give, and a device that gives something else is told.
// SPDX-License-Identifier: BSD-3-Clause
//
// After a change of what presets compute: ALCOVE_STORE_VALUES=1 build/tests/bench_tests device_check_test writes the
// stored values anew, for the next build.
#include "core/bench/device_check.h"

#include <future>

#include "core/options/options.h"
#include "tests/support/device.h"
#include "tests/support/program.h"

namespace alcove::device_check_test {
namespace {

using namespace test;

std::vector<double> values_of(const std::string& preset) {
  const std::string text = read_bytes(ALCOVE_SOURCE_DIR "/presets/" + preset + ".toml");
  return check_values(recorder(), with_values({}, preset_values(preset, text)).estimator);
}

TEST(DeviceCheck, stores_what_the_presets_give) {
  std::string stored;
  for (const char* preset : kCheckedPresets) {
    const auto values = values_of(preset);
    EXPECT_THAT(values, AllOf(Contains(testing::Gt(0.95)), Contains(testing::Lt(0.7)))) << "a frame that says little";
    stored += '"';
    for (const double value : values) stored += fmt::format("{:04x}", std::lround(value * kStoredOne));
    stored += "\",\n";
    if (!std::getenv("ALCOVE_STORE_VALUES")) EXPECT_LE(deviation(preset, values), kMostDeviation) << preset;
  }
  if (std::getenv("ALCOVE_STORE_VALUES")) write_bytes(ALCOVE_SOURCE_DIR "/core/bench/device_check_values.inc", stored);
}

TEST(DeviceCheck, sees_one_block_that_is_wrong) {
  auto values = values_of("draft");
  values[37] += 0.002;
  EXPECT_GT(deviation("draft", values), kMostDeviation);
  values[37] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(deviation("draft", values) <= kMostDeviation);
}

TEST(DeviceCheck, is_not_waited_for_longer_than_it_may_take) {
  std::promise<std::vector<double>> end;
  const std::shared_future<std::vector<double>> ended = end.get_future().share();
  EXPECT_EQ(values_within(std::chrono::milliseconds(1), [ended] { return ended.get(); }), std::nullopt);
  end.set_value({0.5});
  EXPECT_EQ(values_within(std::chrono::hours(1), [ended] { return ended.get(); }), std::vector{0.5});
}

TEST(DeviceCheck, doctor_says_what_each_device_gives) {
  const Finished finished = run_program({"doctor", "--check-device", "--json"});
  EXPECT_EQ(finished.code, 0) << finished;
  for (const auto& device : json::parse(finished.out)["devices"])
    EXPECT_THAT(device["checked"].get<std::string>(),
                AllOf(StartsWith("RMS draft 0.0000"), HasSubstr("reference 0.0000")));
  EXPECT_THAT(run_well({"doctor"}).out, Not(HasSubstr("checked")));
}

TEST(DeviceCheck, doctor_ends_with_5_where_a_device_is_wrong) {
  const Finished finished = run_program(
      {"doctor", "--check-device"}, {.environment = {{"ALCOVE_LACKS", "right values"}}, .preload = ALCOVE_POOR_DEVICE});
  EXPECT_EQ(finished.code, 5) << finished;
  EXPECT_THAT(finished.out, AllOf(HasSubstr("problem "), HasSubstr("computes wrongly: the AO of preset draft")));
}

}  // namespace
}  // namespace alcove::device_check_test
