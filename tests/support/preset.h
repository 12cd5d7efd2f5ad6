// The settings of the presets that are installed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/options.h"
#include "tests/support/test.h"

namespace alcove::test {

inline EstimatorSettings preset(const std::string& name, double radius) {
  ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
  RunOptions options;
  EXPECT_TRUE(
      parse_run_options({"in.exr", "-o", "out.exr", "--preset", name, "--radius", std::to_string(radius)}, options));
  return options.settings.estimator;
}

}  // namespace alcove::test
