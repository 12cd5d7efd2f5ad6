// Values by their rank among others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace alcove {

/// The value with `rank` smaller values before it. Reorders the values.
template <class T>
T value_at_rank(std::vector<T>& values, std::size_t rank) {
  const auto at = values.begin() + std::ptrdiff_t(rank);
  std::ranges::nth_element(values, at);
  return *at;
}

/// The median of at least one value; of an even number, the upper of the two middle ones.
template <class T>
T median_of(std::vector<T> values) {
  return value_at_rank(values, values.size() / 2);
}

}  // namespace alcove
