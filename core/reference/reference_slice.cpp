// The image line of a slice: which pixels it meets, where its runs end, and how thick they are.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference_slice.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/reference/reference_solids.h"

namespace alcove {
namespace {

/// With Completion::all, surfaces that begin within so many reaches of the receiver may go on into the sphere. The
/// seven rendered scenes came ever nearer to ray tracing up to 3.
constexpr double kFarReach = 3;

/// Whether the line must go on beyond the reach. Samples there matter only as the other end of a crossing, as more of a
/// run's width, and as surfaces that may go on into the sphere. A run that is thicker than the sphere is wide enough.
/// `firsts` holds, for each sample, the first one of its run. Sky ends all continuations.
bool goes_on(const ReferenceSolids& solids, const ReferenceSettings& settings, const ReferenceSide& side,
             const ReferenceLine& line, const std::vector<int>& firsts) {
  const int step = line.steps() - 1;
  if (step <= side.reach + 1) return true;
  for (int k = 0; k < line.surfaces; k++) {
    const int index = step * line.surfaces + k;
    const ReferenceSample& sample = line[index];
    const int first = firsts[std::size_t(index)];
    // The step that ends the line is not kept, so that the one before it must be long already.
    if (settings.thickness == ThicknessRule::width && sample.nearer >= 0 && !solids.is_long(line, first, sample.nearer))
      return true;
  }
  return completes_behind(settings) && line.at(step, 0).depth > 0 && step <= kFarReach * side.reach + 1;
}

/// Links the samples of the last step to those of the step before that show the same surface: the nearest in depth
/// first, each to at most one. `firsts`: as for goes_on().
void link(const ReferenceSolids& solids, ReferenceLine& line, const std::vector<int>& firsts) {
  const int after = (line.steps() - 1) * line.surfaces;
  const int before = after - line.surfaces;
  for (;;) {
    int from = -1, to = -1;
    double least = INFINITY;
    for (int i = before; i < after; i++)
      for (int k = after; k < after + line.surfaces; k++) {
        const double gap = std::abs(line[i].depth - line[k].depth);
        if (line[i].farther >= 0 || line[k].nearer >= 0 || !(gap < least)) continue;
        if (solids.connect(line, i, k, firsts[std::size_t(i)] == 0)) least = gap, from = i, to = k;
      }
    if (from < 0) return;
    line[from].farther = to;
    line[to].nearer = from;
  }
}

/// Puts the surfaces of a pixel at the end of the line.
void add_step(const ReferenceScene& scene, ReferenceLine& line, int x, int y) {
  for (int k = 0; k < line.surfaces; k++) line.samples.push_back(sample_of(scene, x, y, k));
}

ReferenceLine samples_of(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
                         const ReferenceSettings& settings) {
  const ReferenceSolids solids(scene, receiver, side, settings);
  ReferenceLine line;
  line.surfaces = scene.surfaces();
  add_step(scene, line, receiver.x, receiver.y);
  line[0].position = receiver.position;
  std::vector<int> firsts(line.samples.size());  // per sample: the first one of its run
  std::iota(firsts.begin(), firsts.end(), 0);
  for (int step = 1;; step++) {
    const auto [x, y] = pixel_at(receiver, side, step);
    line.at_border = !scene.inside(x, y);
    if (line.at_border) break;
    add_step(scene, line, x, y);
    link(solids, line, firsts);
    for (int i = step * line.surfaces; i < int(line.samples.size()); i++)
      firsts.push_back(line[i].nearer >= 0 ? firsts[std::size_t(line[i].nearer)] : i);
    if (!goes_on(solids, settings, side, line, firsts)) {
      line.samples.resize(line.samples.size() - std::size_t(line.surfaces));
      for (auto& sample : line.samples)
        if (sample.farther >= int(line.samples.size())) sample.farther = -1;
      break;
    }
  }
  return line;
}

/// Sets the thickness of solids: everything between a surface and the one that closes its solid is solid. Nothing is
/// known behind the closing one.
void end_solids(ReferenceLine& line) {
  for (int i = 0; i < int(line.samples.size()); i++) {
    ReferenceSample& sample = line[i];
    if (sample.closes) sample.thickness = 0;
    const bool is_last = (i + 1) % line.surfaces == 0;
    if (!is_last && line[i + 1].closes && sample.thickness < INFINITY)
      sample.thickness = length(line[i + 1].position - sample.position);
  }
}

/// The first sample of what would be the receiver's own run if that were sure to go on; -1: there is none.
int rest_of_own(const ReferenceSolids& solids, const ReferenceLine& line) {
  const int last = last_of_run(line, 0), next = (line.step_of(last) + 1) * line.surfaces;
  if (next >= int(line.samples.size())) return -1;
  for (int i = next; i < next + line.surfaces; i++)
    if (line[i].nearer < 0 && solids.connect(line, last, i, false)) return i;
  return -1;
}

void set_thickness(const ReferenceSolids& solids, ReferenceLine& line, const ReferenceSettings& settings) {
  if (settings.thickness != ThicknessRule::width) {
    const double value = settings.thickness == ThicknessRule::infinite ? INFINITY : settings.thickness_length;
    for (auto& sample : line.samples) sample.thickness = value;
  } else {
    const int rest = rest_of_own(solids, line);
    for (int first = 0; first < int(line.samples.size()); first++) {
      if (line[first].depth == 0 || line[first].nearer >= 0) continue;
      std::vector<int> run;
      for (int i = first; i >= 0; i = line[i].farther) run.push_back(i);
      if (first > 0 && first != rest) {
        solids.thicken(line, run);
        continue;
      }
      for (const int i : run) line[i].thickness = first == 0 ? INFINITY : solids.thickness_of_rest(line, run);
    }
  }
  end_solids(line);
}

}  // namespace

bool completes_behind(const ReferenceSettings& settings) {
  return settings.complete == Completion::all && settings.thickness != ThicknessRule::infinite;
}

std::pair<int, int> pixel_at(const ReferenceReceiver& receiver, const ReferenceSide& side, int step) {
  return {receiver.x + int(std::lround(side.step_x * step)), receiver.y + int(std::lround(side.step_y * step))};
}

ReferenceSample sample_of(const ReferenceScene& scene, int x, int y, int surface) {
  ReferenceSample sample;
  sample.x = x;
  sample.y = y;
  sample.depth = scene.depth(x, y, surface);
  sample.position = scene.position(x, y, sample.depth);
  if (surface == 0 && sample.depth > 0) sample.normal = scene.normal(x, y, scene.toward_eye(sample.position));
  sample.closes = scene.closes(x, y, surface);
  return sample;
}

int last_of_run(const ReferenceLine& line, int first) {
  int last = first;
  while (line[last].farther >= 0) last = line[last].farther;
  return last;
}

ReferenceLine line_of(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
                      const ReferenceSettings& settings) {
  ReferenceLine line = samples_of(scene, receiver, side, settings);
  set_thickness(ReferenceSolids(scene, receiver, side, settings), line, settings);
  return line;
}

std::pair<double, double> within(Vector from, Vector along, double distance) {
  const double a = dot(along, along);
  const double b = dot(from, along);
  const double c = dot(from, from) - distance * distance;
  if (b * b < a * c) return {0, 0};
  const double root = std::sqrt(b * b - a * c);
  return {(-b - root) / a, (-b + root) / a};
}

double angle_of(const ReferenceSide& side, Vector offset) {
  return std::atan2(dot(offset, side.along_t), dot(offset, side.along_v));
}

}  // namespace alcove
