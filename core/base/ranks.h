// Values by their place among others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace alcove {

/// The value that has so many smaller ones before it. Puts the values into another order.
template <class T>
T value_at_rank(std::vector<T>& values, std::size_t rank) {
  const auto at = values.begin() + std::ptrdiff_t(rank);
  std::ranges::nth_element(values, at);
  return *at;
}

/// The middle one, of any number but none; of an even number the upper one.
template <class T>
T median_of(std::vector<T> values) {
  return value_at_rank(values, values.size() / 2);
}

}  // namespace alcove
