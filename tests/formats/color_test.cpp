// Colours for a display: the built-in configuration's against the sRGB standard's formula, and those of a configuration
// of one's own.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/color.h"

#include "tests/support/command_line.h"

namespace alcove::color_test {
namespace {

using namespace test;
using Color = CommandLine;

/// IEC 61966-2-1.
double srgb(double linear) { return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055; }

TEST_F(Color, built_in_is_srgb) {
  ::unsetenv("OCIO");
  const DisplayTransform transform("");
  std::array<float, 6> rgb{0, 0.001f, 0.0182f, 0.18f, 0.5f, 1};
  const auto linear = rgb;
  transform.apply(rgb);
  for (std::size_t i = 0; i < rgb.size(); i++) EXPECT_NEAR(rgb[i], srgb(linear[i]), 2e-4) << linear[i];
}

TEST_F(Color, a_configuration_is_that_of_the_option_else_of_the_variable) {
  const std::string file = folder / "half.ocio";
  write_bytes(file, R"(ocio_profile_version: 1
roles: {default: scene, scene_linear: scene}
displays:
  screen:
    - !<View> {name: darker, colorspace: dark}
colorspaces:
  - !<ColorSpace> {name: scene}
  - !<ColorSpace> {name: dark, from_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}}
)");
  const auto expect_half = [](const DisplayTransform& transform) {
    std::array<float, 3> rgb{0.2f, 0.4f, 0.8f};
    transform.apply(rgb);
    EXPECT_THAT(rgb, testing::Pointwise(testing::FloatNear(1e-6f), {0.1f, 0.2f, 0.4f}));
  };
  ::unsetenv("OCIO");
  expect_half(DisplayTransform(file));
  ::setenv("OCIO", file.c_str(), 1);
  expect_half(DisplayTransform(""));
  ::setenv("OCIO", (folder / "missing.ocio").c_str(), 1);
  expect_half(DisplayTransform(file));
  ::unsetenv("OCIO");
}

}  // namespace
}  // namespace alcove::color_test
