// The rules one by one. "Pixels" are pixels' widths at the depth of what is compared.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference_solids.h"

#include <algorithm>
#include <cmath>

namespace alcove {
namespace {

/// The receiver's own run has no end behind it. So it must be sure: fewer pixels of slope than other runs'.
constexpr double kOwnSlope = 4;

// Neighbours that lie in one plane are one surface, however steep it is seen.
constexpr double kPlaneDot = 0.95;  // the least of their normals
constexpr double kPlaneOff = 0.5;   // px: the most from each other's planes
constexpr double kPlaneSlope = 200;

// Parallel faces before each other are two: bars of a railing, not books on a shelf.
constexpr double kParallelSlope = 1;      // px: nearer together they are one
constexpr double kParallelOff = 1.5;      // px, and
constexpr double kParallelApart = 0.125;  // radii: the least from each other's planes

// An edge between two faces of which the farther one recedes.
constexpr double kEdgeSteps = 1.05;    // within so many it comes to the depth of the nearer one
constexpr double kEdgeFacing = -0.01;  // more edge-on its plane tells nothing
constexpr double kFlatDot = 0.9995;    // the least of normals of one flat face
constexpr double kFlatOff = 0.25;      // px from each other's planes
constexpr double kClearEdge = 0.8;     // the dot of normals that differ clearly

/// Of the width so many radii count, or of what begins flat.
constexpr double kWidest = 2, kWidestFlat = 4;
/// A run that the border cuts is so thick at least, in radii, where it is flat.
constexpr double kThicknessOfFlatCut = 1;
/// Radii: solids reach back as far as they are seen to, but no farther.
constexpr double kFarthestBack = 4;

// Rounded outlines.
constexpr double kRoundFacing = 0.35;  // the sine of the angle to the eye's ray below which an outline may be rounded
constexpr double kRoundDot = 0.999;    // the dot of the normals of the first sample and the third
constexpr int kRoundSamples = 4;

/// The dot of the normals of three samples that end a flat face, to which a hidden one is joined.
constexpr double kClosingDot = 0.99;

}  // namespace

double ReferenceSolids::pixels_at(double depth) const {
  return scene_.orthographic() ? 1 / scene_.fx() : depth / scene_.fx();
}

double ReferenceSolids::distance_from_eye(const ReferenceSample& sample) const {
  return scene_.orthographic() ? sample.depth : length(sample.position);
}

bool ReferenceSolids::has_normals(const ReferenceLine& line, int a, int b) const {
  return settings_.thickness == ThicknessRule::width && a % line.surfaces == 0 && b % line.surfaces == 0;
}

bool ReferenceSolids::connect(const ReferenceLine& line, int a, int b, bool is_own) const {
  const ReferenceSample& from = line[a];
  const ReferenceSample& to = line[b];
  if (from.depth == 0 || to.depth == 0) return false;
  const bool by_normals = has_normals(line, a, b);
  const double slope = is_own && by_normals ? kOwnSlope : kRunSlope;
  if (std::abs(from.depth - to.depth) < slope * pixels_at(std::min(from.depth, to.depth)))
    return !by_normals || !are_parallel(from, to);
  return by_normals && (are_coplanar(from, to, kPlaneDot, kPlaneOff) || meet_at_edge(line, a, b));
}

bool ReferenceSolids::are_coplanar(const ReferenceSample& a, const ReferenceSample& b, double least_dot,
                                   double most_pixels) const {
  if (a.depth == 0 || b.depth == 0 || dot(a.normal, b.normal) < least_dot) return false;
  const double pixel = pixels_at(std::min(a.depth, b.depth));
  const Vector step = b.position - a.position;
  return std::max(std::abs(dot(a.normal, step)), std::abs(dot(b.normal, step))) < most_pixels * pixel &&
         std::abs(a.depth - b.depth) < kPlaneSlope * pixel;
}

bool ReferenceSolids::are_parallel(const ReferenceSample& a, const ReferenceSample& b) const {
  const double pixel = pixels_at(std::min(a.depth, b.depth));
  if (std::abs(a.depth - b.depth) < kParallelSlope * pixel || dot(a.normal, b.normal) < kPlaneDot) return false;
  const Vector step = b.position - a.position;
  const double least = std::max(kParallelOff * pixel, kParallelApart * size_of(settings_));
  return std::min(std::abs(dot(a.normal, step)), std::abs(dot(b.normal, step))) >= least;
}

bool ReferenceSolids::meet_at_edge(const ReferenceLine& line, int a, int b) const {
  const bool recedes = line[b].depth > line[a].depth;
  const int far = recedes ? b : a;
  const ReferenceSample& near = line[recedes ? a : b];
  if (!comes_to(line[far], near)) return false;
  return dot(line[far].normal, near.normal) < kClearEdge ||
         are_coplanar(line[far], first_beside(line, far, recedes ? 1 : -1), kFlatDot, kFlatOff);
}

bool ReferenceSolids::comes_to(const ReferenceSample& far, const ReferenceSample& near) const {
  const Vector ray = scene_.position(far.x, far.y, 1) - scene_.position(far.x, far.y, 0);
  const double facing = dot(far.normal, ray);
  if (facing > kEdgeFacing) return false;
  const auto nearness = [&](double depth) { return scene_.orthographic() ? -depth : 1 / depth; };
  const double step = dot(far.normal, scene_.across(near.x - far.x, near.y - far.y, 1)) / facing *
                      (scene_.orthographic() ? 1 : 1 / far.depth);
  const double change = nearness(near.depth) - nearness(far.depth);
  return change * step > 0 && std::abs(change) < kEdgeSteps * std::abs(step);
}

ReferenceSample ReferenceSolids::first_beside(const ReferenceLine& line, int sample, int way) const {
  const auto [x, y] = pixel_at(receiver_, side_, line.step_of(sample) + way);
  return scene_.inside(x, y) ? sample_of(scene_, x, y, 0) : ReferenceSample{};
}

bool ReferenceSolids::is_flat(const ReferenceLine& line, int a, int b, int c) const {
  return has_normals(line, a, b) && has_normals(line, a, c) && are_coplanar(line[a], line[b], kFlatDot, kFlatOff) &&
         are_coplanar(line[a], line[c], kFlatDot, kFlatOff);
}

double ReferenceSolids::widest(const ReferenceLine& line, int first) const {
  const int second = line[first].farther;
  const int third = second < 0 ? -1 : line[second].farther;
  const bool flat = third >= 0 && is_flat(line, first, second, third);
  return (flat ? kWidestFlat : kWidest) * size_of(settings_);
}

double ReferenceSolids::by_width(const ReferenceLine& line, const std::vector<int>& run, bool may_be_flat) const {
  // The width counts from outer edge to outer edge: n pixels are n wide, and their centres n - 1 apart. Otherwise
  // single blades of grass would vanish.
  const ReferenceSample& first = line[run.front()];
  const double pixel = pixels_at(first.depth);
  const double chord = length(line[run.back()].position - first.position) + pixel;
  // A long run levels off: a wall is not as thick as it is long.
  const double most = may_be_flat ? widest(line, run.front()) : kWidest * size_of(settings_);
  const double part = std::min((settings_.width_share * chord + settings_.width_pixels * pixel) / most, 1.0);
  const double thickness = most * part * (1 - part * part / 3);
  const bool cut = line.at_border && line.step_of(run.back()) + 1 == line.steps();
  if (!cut || settings_.complete == Completion::none) return thickness;
  const std::size_t n = run.size();
  const bool flat = may_be_flat && n > 2 && is_flat(line, run[n - 1], run[n - 2], run[n - 3]);
  return std::max(thickness, (flat ? kThicknessOfFlatCut : kThicknessOfCut) * size_of(settings_));
}

/// Whether what lies before a run's first sample towards the receiver is deeper, or sky.
bool ReferenceSolids::hides(const ReferenceLine& line, int first) const {
  const double before = line.at(line.step_of(first) - 1, 0).depth;
  return before == 0 || before > line[first].depth;
}

Vector ReferenceSolids::in_slice(Vector normal) const {
  const Vector projected = dot(normal, side_.tangent) * side_.tangent + dot(normal, receiver_.eye) * receiver_.eye;
  return length(projected) > 1e-6 ? normalized(projected) : receiver_.eye;
}

bool ReferenceSolids::mirrors(const ReferenceLine& line, const std::vector<int>& run) const {
  if (int(run.size()) < kRoundSamples || !has_normals(line, run[0], run[2]) || !hides(line, run[0])) return false;
  const ReferenceSample& outline = line[run[0]];
  const Vector away = -1 * scene_.toward_eye(outline.position);
  return -dot(in_slice(outline.normal), away) < kRoundFacing && dot(outline.normal, line[run[2]].normal) < kRoundDot;
}

/// How far back a solid is seen to reach from a sample, by the ends of its run: farther from the eye, and behind the
/// sample's own plane.
double ReferenceSolids::reaches_back(const ReferenceLine& line, int i, const std::vector<int>& run) const {
  const ReferenceSample& here = line[i];
  const Vector normal = in_slice(here.normal);
  double farthest = 0;
  for (const int end : {run.front(), run.back()}) {
    const double behind = -dot(normal, line[end].position - here.position);
    farthest = std::max(farthest, std::min(distance_from_eye(line[end]) - distance_from_eye(here), behind));
  }
  return std::min(farthest, kFarthestBack * size_of(settings_));
}

bool ReferenceSolids::is_long(const ReferenceLine& line, int first, int last) const {
  const double chord = length(line[last].position - line[first].position);
  return settings_.width_share * chord > kWidestFlat * size_of(settings_);
}

void ReferenceSolids::thicken(ReferenceLine& line, const std::vector<int>& run) const {
  const double width = by_width(line, run);
  for (const int i : run) line[i].thickness = width;
  const bool mirrored = mirrors(line, run), reaches = !is_long(line, run.front(), run.back());
  const double pixel = pixels_at(line[run[0]].depth), outline = distance_from_eye(line[run[0]]);
  const double most = kFarthestBack * size_of(settings_);
  for (const int i : run)
    line[i].thickness = mirrored ? std::max(std::min(2 * (outline - distance_from_eye(line[i])), most), pixel)
                        : reaches && has_normals(line, i, i) ? std::max(width, reaches_back(line, i, run))
                                                             : width;
  close(line, run);
}

void ReferenceSolids::close(ReferenceLine& line, const std::vector<int>& run) const {
  if (run.size() < 3 || !has_normals(line, run[0], run[1]) || !has_normals(line, run[0], run[2])) return;
  if (line.step_of(run[0]) > side_.reach + 1 || !hides(line, run[0])) return;
  const ReferenceSample& end = line[run[0]];
  if (std::min(dot(end.normal, line[run[1]].normal), dot(end.normal, line[run[2]].normal)) < kClosingDot) return;
  const Vector from = end.position - receiver_.position;
  line.closing.push_back({from, from - end.thickness * in_slice(end.normal)});
}

}  // namespace alcove
