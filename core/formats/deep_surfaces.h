// The samples of a deep pixel, and the surfaces that they make.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace alcove {

/// A sample of a deep pixel: a point where both depths are one, or a volume between them.
struct DeepSample {
  float front, back;  // Z and ZBack
  float opacity;      // its own, as seen with nothing before it
};

/// The most surfaces of a pixel that are kept; what lies behind them is counted as dropped.
constexpr std::size_t kMostDeepSurfaces = 4;

/// What no surface has as its depth: beyond every sky.
constexpr float kNoDeepSurface = 1e30F;

/// Which samples are surfaces.
struct DeepRules {
  double opacity = 0.5;  // from which they are, 0 to 1
  // Points are one surface, and volumes one body, if they are no farther apart than this at a depth z:
  // [0] + z ([1] + z [2]), in the units of Z.
  std::array<double, 3> separation{};
};

/// What was met while surfaces were made. The sums depend on no order.
struct DeepCounts {
  std::uint64_t pixels = 0, samples = 0;
  std::uint64_t most = 0;      // samples of a pixel
  std::uint64_t volumes = 0;   // samples with ZBack > Z
  std::uint64_t covered = 0;   // samples behind an opaque one, by more than the separation
  std::uint64_t repaired = 0;  // samples whose opacity was no number from 0 to 1, or whose depth was none
  std::uint64_t dropped = 0;   // surfaces behind those that are kept

  void add(const DeepCounts& other);
};

/// The surfaces of a pixel, nearer first; kNoDeepSurface behind the last.
struct DeepSurfaces {
  std::array<float, kMostDeepSurfaces> front;
  std::array<float, kMostDeepSurfaces> back;  // where the body behind a front ends; kNoDeepSurface: not known
};

/// Makes surfaces of samples. It keeps its memory from pixel to pixel.
class DeepPixel {
 public:
  explicit DeepPixel(const DeepRules& rules) : rules_(rules) {}

  /// Points that lie together have the opacity 1 - prod(1 - a) and are a surface at the nearest of them where that is
  /// enough. Volumes that touch are one body from the depth where their opacity has grown to enough, to their end.
  /// Neither the order of the samples nor volumes that were cut in two change the result. Sorts and repairs the
  /// samples.
  DeepSurfaces surfaces(std::span<DeepSample> samples, DeepCounts& counts);

 private:
  struct Surface {
    float front, back;
  };
  static std::span<DeepSample> repair(std::span<DeepSample> samples, DeepCounts& counts);
  void count_covered(std::span<const DeepSample> samples, DeepCounts& counts) const;
  void add_points(std::span<const DeepSample> samples);
  void add_volumes(std::span<const DeepSample> samples);
  void add_body(std::span<const DeepSample> volumes, float end);
  double reach(double z) const;

  DeepRules rules_;
  std::vector<Surface> found_;
  std::vector<DeepSample> volumes_, by_end_;
};

}  // namespace alcove
