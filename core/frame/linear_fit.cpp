// Points of the size of 1.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/linear_fit.h"
#include "core/base/ranks.h"

#include <algorithm>

namespace alcove {

Normalized normalized(std::span<const SeenPoint> points) {
  Normalized result{{points.begin(), points.end()}, {}, 1};
  for (std::size_t k = 0; k < 3; k++) {
    std::vector<double> values;
    for (const auto& seen : points) values.push_back(seen.position[k]);
    result.middle[k] = median_of(std::move(values));
  }
  std::vector<double> distances;
  for (const auto& seen : points) distances.push_back(length(difference(seen.position, result.middle)));
  if (const double median = median_of(std::move(distances)); median > 0) result.size = median;
  for (auto& seen : result.points) seen.position = scaled(difference(seen.position, result.middle), 1 / result.size);
  return result;
}

}  // namespace alcove
