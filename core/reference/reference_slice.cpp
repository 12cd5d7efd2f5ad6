// The image line of a slice: which pixels it meets, where its runs end, and how thick they are.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference_slice.h"

#include <algorithm>
#include <cmath>

namespace alcove {
namespace {

/// Neighbours on a slice whose depth differs by less than this many pixels' worth of slope are one surface.
constexpr double kRunSlope = 8;
/// What the picture's border cuts is taken to be at least so thick, in radii: its width is not known.
constexpr double kCutThickness = 0.5;

/// With Completion::all, a surface that begins so many times the reach away may go on towards the receiver into the
/// sphere. The seven rendered scenes came ever nearer to ray tracing up to 3.
constexpr double kFarReach = 3;

double size_of_pixel(const ReferenceScene& scene, double depth) {
  return scene.orthographic() ? 1 / scene.fx() : depth / scene.fx();
}

/// Whether the line must go on beyond the reach, to a sample of the run that began at `run_start` if it is `same`.
/// There a sample matters only as the other end of a crossing, as more of a run's width, and as what may go on into the
/// sphere. A run that is thicker than the sphere is wide enough. A line of sight to the sky ends all that goes on.
bool goes_on(const ReferenceSettings& settings, const ReferenceSide& side, int step, const ReferenceSample& sample,
             bool same, double width) {
  if (step <= side.reach + 1) return true;
  if (settings.thickness == ThicknessRule::width && same && width * settings.width_share <= 2 * settings.radius)
    return true;
  return completes_behind(settings) && sample.depth > 0 && step <= kFarReach * side.reach + 1;
}

ReferenceLine samples_of(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
                         const ReferenceSettings& settings) {
  ReferenceLine line;
  std::vector<ReferenceSample>& samples = line.samples;
  samples = {{receiver.position, receiver.depth, 0}};
  std::size_t run_start = 0;
  for (int k = 1;; k++) {
    const auto [x, y] = pixel_at(receiver, side, k);
    line.at_border = !scene.inside(x, y);
    if (line.at_border) break;
    ReferenceSample sample;
    sample.depth = scene.depth(x, y);
    sample.position = scene.position(x, y, sample.depth);
    const bool same = same_surface(scene, samples.back(), sample);
    if (!same) run_start = samples.size();
    if (!goes_on(settings, side, k, sample, same, same ? length(sample.position - samples[run_start].position) : 0))
      break;
    samples.push_back(sample);
  }
  return line;
}

/// The thickness of the run between these two samples.
double thickness_of_run(const ReferenceScene& scene, const ReferenceLine& line, std::size_t first, std::size_t last,
                        const ReferenceSettings& settings) {
  const bool cut = line.at_border && last + 1 == line.samples.size();
  if (first == 0) return INFINITY;
  // From outer edge to outer edge: n pixels are n wide, and their centres n - 1 apart. Without it single blades of
  // grass vanish.
  const double pixel = size_of_pixel(scene, line.samples[first].depth);
  const double chord = length(line.samples[last].position - line.samples[first].position) + pixel;
  const double thickness = settings.width_share * chord + settings.width_pixels * pixel;
  return cut && settings.complete != Completion::none ? std::max(thickness, kCutThickness * settings.radius)
                                                      : thickness;
}

void set_thickness(const ReferenceScene& scene, ReferenceLine& line, const ReferenceSettings& settings) {
  std::vector<ReferenceSample>& samples = line.samples;
  if (settings.thickness != ThicknessRule::width) {
    const double value = settings.thickness == ThicknessRule::infinite ? INFINITY : settings.thickness_length;
    for (auto& sample : samples) sample.thickness = value;
    return;
  }
  for (std::size_t first = 0; first < samples.size();) {
    const std::size_t last = last_of_run(scene, samples, first);
    const double thickness = thickness_of_run(scene, line, first, last, settings);
    for (std::size_t i = first; i <= last; i++) samples[i].thickness = thickness;
    first = last + 1;
  }
}

}  // namespace

bool completes_behind(const ReferenceSettings& settings) {
  return settings.complete == Completion::all && settings.thickness != ThicknessRule::infinite;
}

std::pair<int, int> pixel_at(const ReferenceReceiver& receiver, const ReferenceSide& side, int step) {
  return {receiver.x + int(std::lround(side.step_x * step)), receiver.y + int(std::lround(side.step_y * step))};
}

bool same_surface(const ReferenceScene& scene, const ReferenceSample& a, const ReferenceSample& b) {
  if (a.depth == 0 || b.depth == 0) return false;
  const double pixel = size_of_pixel(scene, std::min(a.depth, b.depth));
  return std::abs(a.depth - b.depth) < kRunSlope * pixel;
}

std::size_t last_of_run(const ReferenceScene& scene, const std::vector<ReferenceSample>& samples, std::size_t first) {
  std::size_t last = first;
  while (last + 1 < samples.size() && same_surface(scene, samples[last], samples[last + 1])) last++;
  return last;
}

ReferenceLine line_of(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
                      const ReferenceSettings& settings) {
  ReferenceLine line = samples_of(scene, receiver, side, settings);
  set_thickness(scene, line, settings);
  return line;
}

double angle_of(const ReferenceSide& side, Vector offset) {
  return std::atan2(dot(offset, side.along_t), dot(offset, side.along_v));
}

}  // namespace alcove
