// Presets as the program reads them: TOML whose keys are options, with their ranges.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"
#include "tests/fuzz/fuzz.h"

using namespace alcove;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(data, size);
  RunOptions options;
  if (fuzz::accepts([&] { parse_run_options({"--preset", input.path(), "--quiet"}, options); })) {
    const EstimatorSettings& estimator = options.settings.estimator;
    fuzz::require(!estimator.radius || *estimator.radius > 0, "a radius is above 0");
    fuzz::require(estimator.slices >= 1 && estimator.slices <= 64, "slices are in their range");
    fuzz::require(estimator.steps >= 1 && estimator.steps <= 4096, "steps are in their range");
  }
  return 0;
}
