// The radius that Alcove proposes, and notes on radii that a frame cannot carry: lost in the depth's precision, below a
// pixel, or larger than the picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/base/image.h"
#include "core/base/note.h"
#include "core/frame/reading.h"

namespace alcove {

/// Gives the median planar depth of the surfaces, in scene units; none where all is sky. `raw` is the depth as the file
/// has it, or the positions, of the pixels of `reading.data`; a few ten thousand of them are looked at.
std::optional<double> median_depth(const Reading& reading, std::span<const float> raw);

/// Gives a radius in scene units by one figure, which is as much as a guess deserves. None where the frame shows no
/// surface, and so has no median depth. It is the same for every frame of a sequence if it is asked of the one by which
/// the sequence is settled.
std::optional<double> proposed_radius(const Camera& camera, std::optional<double> median_depth);

/// Gives radii that a frame has to tell, in scene units: the proposed one, or parts of the median depth, to four
/// figures. Empty where the frame shows no surface.
std::vector<double> radii_by_depth(const EstimatorSettings& settings, const Camera& camera,
                                   std::optional<double> median_depth);

/// Planar depths of a frame's surfaces, in scene units: enough of them for a median.
class DepthSample {
 public:
  /// Takes a few thousand pixels of a window. `raw` is its depth as the file has it: one plane, or three of positions.
  void add(const View& view, const DepthMap& map, const DepthPrecision& precision, std::span<const float> raw);
  /// Takes the pixels of `window` that belong to a sample of a few thousand of `whole`. A pixel counts once, however
  /// many windows share it: the result does not depend on how the whole is cut.
  void add(const View& view, const DepthMap& map, const DepthPrecision& precision, std::span<const float> raw,
           const Window& window, const Window& whole);

  /// Gives a sentence with the numbers for everything that makes the AO at these radii unsound; none where all is well.
  /// `width` and `height` are those of the whole picture, in pixels. The smallest radius must be at least
  /// kLeastPrecisions times the depth's precision at the median depth, and at least a pixel over half of the surfaces.
  /// The largest must not be seen wider than the picture's longer side at the median depth.
  Notes notes(double smallest_radius, double largest_radius, int width, int height) const;

  /// The largest depth; 0 where there is none.
  double farthest() const;

 private:
  double pixel_at(double depth) const;

  std::map<std::size_t, double> depths_;  // by the pixel's number: SampledPixel
  View view_{};
  DepthPrecision precision_;
};

/// Two depths may each be wrong by the precision, and so feign an occluder twice as high. At a radius of 8 precisions
/// that is a quarter of the radius. `alcove bench --stability` measures an RMSE that is 0.01 higher there, and 0.06
/// higher at 2.6 precisions.
constexpr double kLeastPrecisions = 8;

}  // namespace alcove
