// `alcove compare` on files whose data windows differ.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/compare_command.h"
#include "tests/support/program.h"
#include "tests/support/wall_frame.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::HasSubstr;

const Window kWindow{0, 0, 60, 32};

class CompareWindows : public CompareCommand {};

TEST_F(CompareWindows, files_of_one_display_window_are_compared_where_all_have_pixels) {
  const auto write = [&](const std::string& name, const std::string& channel, const Window& data, const auto& value) {
    FrameFile file{data, kWindow, 1, {}, {}, {}};
    for (int y = data.y; y < data.y + data.height; y++)
      for (int x = data.x; x < data.x + data.width; x++) file.planes[channel].push_back(value(x, y));
    file.write(folder / name);
    return std::string(folder / name);
  };
  const auto slope = [](int x, int y) { return float(x + 2 * y) / 256; };
  const auto raised = [&](int x, int y) { return slope(x, y) + (x >= 20 ? 0.25f : 0); };
  const auto left = [](int x, int) { return float(x < 20); };
  const auto a = write("a.exr", "Y", {-4, -4, 50, 40}, slope), b = write("b.exr", "Y", {3, 2, 60, 20}, raised);
  const json j = measured({a, b});
  EXPECT_EQ(j["common_window"], json({{"x", 3}, {"y", 2}, {"width", 43}, {"height", 20}}));
  EXPECT_EQ(j["count"], 43 * 20);
  EXPECT_EQ(j["max"], 0.25);
  EXPECT_THAT(compare({a, b}).out, HasSubstr("the files' windows differ: compared 43x20 at (3, 2)"));
  const auto mask = write("m.exr", "Y", {10, 0, 30, 10}, left);
  const json masked = measured({a, b, "--mask", mask});
  EXPECT_EQ(masked["common_window"], json({{"x", 10}, {"y", 2}, {"width", 30}, {"height", 8}}));
  EXPECT_EQ(masked["count"], 10 * 8);
  EXPECT_EQ(masked["max"], 0);
  EXPECT_TRUE(measured({a, a})["common_window"].is_null());
  expect_error(3, {a, write("far.exr", "Y", {50, 0, 5, 5}, slope)}, {"far.exr", "share no pixel"});
}

}  // namespace
}  // namespace alcove
