// One side of a slice at a receiver: the samples along its image line, and how thick each is.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "core/reference/reference.h"
#include "core/reference/reference_scene.h"

namespace alcove {

/// One pixel on a slice's image line.
struct ReferenceSample {
  Vector position;
  double depth = 0;      // 0: sky
  double thickness = 0;  // scene units, infinite allowed
};

struct ReferenceReceiver {
  int x, y;
  double depth;
  Vector position, eye, normal;
};

/// One side of a slice at a receiver.
struct ReferenceSide {
  Vector along_t, along_v;  // in-slice coordinates of an offset, moved into the slice parallel to the tangent plane
  double gamma;
  double step_x, step_y;  // pixels per step; the longer component is +-1
  double reach;           // steps within the radius; infinite when the sphere of the radius holds the eye
};

/// The samples of a side. The first is the receiver, and the k-th is k steps away.
struct ReferenceLine {
  std::vector<ReferenceSample> samples;
  bool at_border = false;  // the line ends where the picture does
};

/// Whether surfaces go on behind what is nearer. Endless occluders block all that is behind them anyway.
bool completes_behind(const ReferenceSettings& settings);

/// The pixel that is so many steps away from the receiver.
std::pair<int, int> pixel_at(const ReferenceReceiver& receiver, const ReferenceSide& side, int step);

/// Whether two neighbours on a slice show one surface.
bool same_surface(const ReferenceScene& scene, const ReferenceSample& a, const ReferenceSample& b);

/// The last sample of the run that the sample at index `first` begins.
std::size_t last_of_run(const ReferenceScene& scene, const std::vector<ReferenceSample>& samples, std::size_t first);

/// The line with the thickness of every sample, as far as the settings need it.
ReferenceLine line_of(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
                      const ReferenceSettings& settings);

/// The angle of an offset from the view ray, in the slice; negative on the other side.
double angle_of(const ReferenceSide& side, Vector offset);

}  // namespace alcove
