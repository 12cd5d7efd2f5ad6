// The samples of a deep pixel, and the surfaces made of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace alcove {

/// A sample of a deep pixel: a point if both depths are equal, else a volume between them.
struct DeepSample {
  float front, back;  // Z and ZBack
  float opacity;      // its own, without regard to samples before it
};

/// The most surfaces that are kept per pixel; surfaces behind them count as dropped.
constexpr std::size_t kMostDeepSurfaces = 4;

/// A depth that no surface has: beyond every sky.
constexpr float kNoDeepSurface = 1e30F;

/// The rules by which samples become surfaces.
struct DeepRules {
  double opacity = 0.5;  // the least of a surface, 0 to 1
  // Points are one surface, and volumes one body, if their distance at a depth z is at most [0] + z ([1] + z [2]), in
  // the units of Z.
  std::array<double, 3> separation{};
};

/// The counts of samples and surfaces. The sums depend on no order.
struct DeepCounts {
  std::uint64_t pixels = 0, samples = 0;
  std::uint64_t most = 0;      // samples of a pixel
  std::uint64_t volumes = 0;   // samples with ZBack > Z
  std::uint64_t covered = 0;   // samples behind an opaque one, by more than the separation
  std::uint64_t repaired = 0;  // samples whose opacity was not from 0 to 1, or without a valid depth
  std::uint64_t dropped = 0;   // surfaces behind the kept ones

  void add(const DeepCounts& other);
};

/// The surfaces of a pixel, nearer first; kNoDeepSurface behind the last.
struct DeepSurfaces {
  std::array<float, kMostDeepSurfaces> front;
  std::array<float, kMostDeepSurfaces> back;  // end of the body behind the front; kNoDeepSurface: unknown
};

/// Makes surfaces of samples. Its memory is reused from pixel to pixel.
class DeepPixel {
 public:
  explicit DeepPixel(const DeepRules& rules) : rules_(rules) {}

  /// Makes the surfaces of a pixel. Points that lie together have the opacity 1 - prod(1 - a), and are a surface at the
  /// nearest point if that reaches the rules' opacity. Volumes that touch are one body, from the depth where their
  /// opacity reaches it to their end. Neither the order of the samples nor a volume cut in two changes the result.
  /// Sorts and repairs the samples.
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
