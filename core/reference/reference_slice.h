// A side of a slice at a receiver: the samples along its image line, the thickness of each, completed surfaces, and the
// angles that all of them block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/reference/reference.h"
#include "core/reference/reference_scene.h"

namespace alcove {

/// The least thickness, in radii, of a run that the picture's border cuts: its width is unknown.
constexpr double kThicknessOfCut = 0.5;

/// A surface of a pixel on a slice's image line.
struct ReferenceSample {
  int x = 0, y = 0;  // its pixel
  Vector position;
  Vector normal;         // unit; of the first surface, where the thickness goes by the width
  double depth = 0;      // 0: no surface; for the first surface: sky
  double thickness = 0;  // scene units, infinite allowed
  bool closes = false;   // it closes the solid of the surface before it in its pixel
  // Continuations of the same surface, one step nearer to the receiver and one farther: indices of samples; -1: it
  // ends.
  int nearer = -1, farther = -1;
};

struct ReferenceReceiver {
  int x, y;
  double depth;
  Vector position, eye, normal;
};

/// A side of a slice at a receiver.
struct ReferenceSide {
  Vector tangent;           // unit, across the eye's ray
  Vector along_t, along_v;  // in-slice coordinates of an offset, moved into the slice parallel to the tangent plane
  double gamma;
  double step_x, step_y;  // pixels per step; the longer component is +-1
  double reach;           // steps within the radius; infinite when the sphere of the radius holds the eye
};

/// The samples of a side: for each step as many as a pixel may have surfaces, nearer to the eye first. Sample 0 is the
/// receiver.
struct ReferenceLine {
  std::vector<ReferenceSample> samples;
  int surfaces = 1;        // per step
  bool at_border = false;  // the line ends where the picture does
  // Faces without thickness that close solids and are not seen, from and to: offsets from the receiver.
  std::vector<std::pair<Vector, Vector>> closing = {};

  int steps() const { return int(samples.size()) / surfaces; }
  int step_of(int index) const { return index / surfaces; }
  const ReferenceSample& operator[](int index) const { return samples[std::size_t(index)]; }
  ReferenceSample& operator[](int index) { return samples[std::size_t(index)]; }
  const ReferenceSample& at(int step, int surface) const { return (*this)[step * surfaces + surface]; }
};

/// Whether surfaces go on behind nearer ones. Behind endless occluders they do not: these block everything there
/// anyway.
bool completes_behind(const ReferenceSettings& settings);

/// The pixel at so many steps from the receiver.
std::pair<int, int> pixel_at(const ReferenceReceiver& receiver, const ReferenceSide& side, int step);

/// A surface of a pixel, 0 being the first one.
ReferenceSample sample_of(const ReferenceScene& scene, int x, int y, int surface);

/// The index of the last sample of the run that begins with sample `first`.
int last_of_run(const ReferenceLine& line, int first);

/// The line with the thickness of every sample, as long as the settings need it.
ReferenceLine line_of(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
                      const ReferenceSettings& settings);

/// The t, from the first to the last, for which from + t along is no farther away than a distance; none: the first is
/// not before the last.
std::pair<double, double> within(Vector from, Vector along, double distance);

/// The angle between an offset and the view ray, in the slice; negative on the other side.
double angle_of(const ReferenceSide& side, Vector offset);

/// The part of a completed surface within the sphere of the radius.
struct CompletedSegment {
  Vector nearer, farther;  // its ends as offsets from the receiver; the nearer is fewer steps away on the image
  double thickness = 0;    // of the run that it continues
};

std::vector<CompletedSegment> completed_segments(const ReferenceScene& scene, const ReferenceReceiver& receiver,
                                                 const ReferenceSide& side, const ReferenceLine& line,
                                                 const ReferenceSettings& settings);

// The angles that a frame blocks in the slices at a pixel. Visibility is an integral over the others.

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
