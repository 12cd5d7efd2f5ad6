// Statistics of the values of depth, normals and positions, as they stand in a file. Knows no renderer.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/camera/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// Statistics of a plane's values.
struct ValueStatistics {
  std::uint64_t pixels = 0, nan = 0, infinite = 0, negative = 0, zero = 0, one = 0, positive = 0;
  double least = 0, most = 0;  // finite ones; 0 where there are none
};
/// Counts every `step`-th value.
ValueStatistics statistics_of(std::span<const float> values, std::size_t step = 1);

constexpr double kUnitTolerance = 0.05;  // of a length that is taken for 1

/// Statistics of normals as they stand in the file, without those that are not finite or zero.
struct NormalStatistics {
  std::uint64_t count = 0;
  double least = 0, most = 0;    // of all components
  double mean_length = 0;        // 1 for signed normals
  double unorm_mean_length = 0;  // the same of 2 n - 1
  double unit_share = 0;         // the share whose length is 1 within 5 %
  double unorm_unit_share = 0;   // the same of 2 n - 1
  double usual_length = 0;       // the median
  double usual_share = 0;        // the share whose length is that within 5 %
};
/// Counts every `step`-th pixel that is no sky. `normal` has two planes or three; `raw` is the depth as in the file.
NormalStatistics normal_statistics(std::span<const float> normal, std::span<const float> raw, const DepthMap& map,
                                   std::size_t step = 1);

/// Decodes the file's values of pixel `i` into a normal of any length, as prepare.comp does.
Vector3 decoded_normal(std::span<const float> raw, std::size_t pixels, std::size_t i, NormalEncoding encoding,
                       bool unorm);

/// Gives the planar depth of each pixel, in scene units; infinite on sky. Of `row_step` rows only the first is taken.
std::vector<float> planar_depths(std::span<const float> raw, const DepthMap& map, const View& view, int row_step = 1);

/// Gives the median distance, in pixels, of positions from the pixels that hold them. It is infinite if most positions
/// are behind the camera; there is none if all are sky. `mirrored` says that the z of view positions has the other sign
/// than the camera's.
std::optional<double> reprojection_error(std::span<const float> position, PositionSpace space, bool mirrored,
                                         const Camera& camera, const View& view);

}  // namespace alcove
