// How far two results of the chain lie apart, and where they do so most.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/compute.h"
#include "tests/support/test.h"

namespace alcove::test {

/// How far two results, or a result and a constant, lie apart.
struct Difference {
  double max = 0, mean = 0, rmse = 0, bias = 0;
  std::size_t worst = 0;
};

inline Difference difference(const std::vector<float>& a, const std::function<double(std::size_t)>& b) {
  Difference result;
  for (std::size_t i = 0; i < a.size(); i++) {
    const double error = a[i] - b(i);
    if (!(std::abs(error) <= result.max)) result.max = std::abs(error), result.worst = i;
    result.mean += std::abs(error) / double(a.size());
    result.bias += error / double(a.size());
    result.rmse += error * error / double(a.size());
  }
  result.rmse = std::sqrt(result.rmse);
  return result;
}

inline Difference difference(const std::vector<float>& a, const std::vector<float>& b) {
  return difference(a, [&](std::size_t i) { return double(b[i]); });
}

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>, std::bit_cast<std::uint32_t, float>);
}

inline std::string place(const Difference& d, const HostFrame& frame) {
  const auto width = std::size_t(frame.data.width);
  return "worst at pixel " + std::to_string(d.worst % width) + " " + std::to_string(d.worst / width) + ", depth " +
         std::to_string(frame.depth[d.worst]);
}

}  // namespace alcove::test
