// The limits of a comparison: ONE table serves the options of `compare`, the keys of lists of frames, and the checks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>

namespace alcove {

/// Limits of a frame.
struct CompareLimits {
  std::optional<double> max_rmse, max_p99, min_ssim, max_flip;
  std::optional<double> max_bias;   // of its size
  std::optional<double> max_grain;  // needs CompareSettings::depth
  // share of the pixels within the mask that are finite in one file only, 0 to 1; else none may be
  std::optional<double> max_excluded;
  bool operator==(const CompareLimits&) const = default;
};

struct LimitRow {
  const char* option;
  const char* measure;  // of the report; "" for the share of holes, which breaks a limit of 0 where none is given
  std::optional<double> CompareLimits::*value;
  double low, high;  // infinite: none
  const char* sentence;

  std::string key() const { return option + 2; }
};

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();
inline constexpr std::array kLimitTable = {
    LimitRow{"--max-rmse", "rmse", &CompareLimits::max_rmse, 0, kNoLimit, "the largest rmse"},
    LimitRow{"--max-p99", "p99", &CompareLimits::max_p99, 0, kNoLimit,
             "the largest 99th percentile of the error's size"},
    LimitRow{"--min-ssim", "ssim", &CompareLimits::min_ssim, -1, 1, "the least structural similarity"},
    LimitRow{"--max-flip", "flip", &CompareLimits::max_flip, 0, 1, "the largest mean FLIP"},
    LimitRow{"--max-bias", "bias", &CompareLimits::max_bias, 0, kNoLimit, "the largest size of the mean error"},
    LimitRow{"--max-grain", "grain", &CompareLimits::max_grain, 0, kNoLimit,
             "the largest grain, which needs --depth; a frame without plain surfaces ends with exit code 3"},
    LimitRow{"--max-excluded", "", &CompareLimits::max_excluded, 0, 1,
             "the largest share of pixels that are NaN or infinite in one file only; else any breaks all limits"}};

}  // namespace alcove
