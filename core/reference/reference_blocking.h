// The angles that a frame blocks in the slices at a pixel. Visibility is an integral over the others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/reference/reference_slice.h"

namespace alcove {

/// A blocked part of a side's angles, which begin at the view ray.
struct BlockedPart {
  double from = 0, to = 0;
  double weight = 1;          // by the falloff
  bool is_completed = false;  // by a completed surface, where no visible one blocks it
};

/// Calls `take` with the index and the receiver of every pixel that was asked for and is not sky, from several threads.
void for_receivers(const HostFrame& frame, const ReferenceSettings& settings,
                   const std::function<void(std::size_t, const ReferenceScene&, const ReferenceReceiver&)>& take);

/// Calls `take` with each side of the receiver's slices and the weight of its slice. Gives the weighted sum of whole
/// sides' arcs; 0 without sides.
double for_sides(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSettings& settings,
                 const std::function<void(const ReferenceSide&, double)>& take);

/// The side towards a unit vector across the eye's ray; none where the normal is nearly perpendicular to its slice.
std::optional<ReferenceSide> side_along(const ReferenceScene& scene, const ReferenceReceiver& receiver, Vector tangent,
                                        double radius);

/// The blocked angles of a side: disjoint parts, visible surfaces' first.
std::vector<BlockedPart> blocked_parts(const ReferenceScene& scene, const ReferenceReceiver& receiver,
                                       const ReferenceSide& side, const ReferenceSettings& settings);

/// The weighted parts of a receiver's hemisphere that are blocked: by visible surfaces, and by completed ones alone.
struct BlockedShare {
  double seen = 0, completed = 0;
};
BlockedShare blocked_share(const ReferenceScene& scene, const ReferenceReceiver& receiver,
                           const ReferenceSettings& settings);

/// The integral of cos(theta - gamma) |sin(theta)| between two angles (Jimenez et al. 2016, equation 7).
double arc_between(double from, double to, double gamma);

/// The weight of what lies at a distance, by a falloff from `start` to `end`.
double falloff_weight(Falloff falloff, double start, double end, double distance);
double falloff_weight(const ReferenceSettings& settings, double distance);

/// The point where the line between two offsets, one within the radius and one beyond, leaves the sphere.
Vector crossing(Vector within, Vector beyond, double radius);

}  // namespace alcove
