// Counts along rows and columns.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/walk.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/ranks.h"

namespace alcove {
namespace {

/// Relative second difference, with its sign.
double bend_at(const Line& line, std::size_t i) {
  return (line.inverse[i - 1] + line.inverse[i + 1] - 2 * line.inverse[i]) / line.inverse[i];
}

bool are_surfaces(const Line& line, std::size_t first, std::size_t end) {
  for (std::size_t i = first; i < end; i++)
    if (!line.is_surface(i)) return false;
  return true;
}

constexpr double kSharp = 0.9;  // of an outline's change

bool are_close(double a, double b, double part) { return std::abs(a - b) < part * std::min(a, b); }

}  // namespace

// Repeats.

void count_repeats(const Line& line, BorderCounts& counts) {
  constexpr std::size_t kAround = 4;  // px: wider runs are of pictures that are enlarged by more than anyone would
  constexpr float kSlow = 0.05f;      // relative change within one surface
  counts.places.resize(line.size());
  counts.equal.resize(line.size());
  // The least and the largest of a value and those before it, of so many each time.
  std::vector<float> least = line.raw, most = line.raw;
  for (std::size_t span = 1; span < 2 * kAround; span *= 2)
    for (std::size_t i = line.size(); i-- > span;) {
      least[i] = std::min(least[i], least[i - span]);
      most[i] = std::max(most[i], most[i - span]);
    }
  std::size_t surfaces = 0;  // up to the end of the window
  for (std::size_t end = 1; end <= line.size(); end++) {
    surfaces = line.is_surface(end - 1) ? surfaces + 1 : 0;
    if (surfaces < 2 * kAround) continue;
    const float low = least[end - 1], high = most[end - 1];
    if (low == high || high - low > kSlow * std::min(std::abs(low), std::abs(high))) continue;
    const std::size_t border = end - kAround;
    counts.places[border]++;
    counts.equal[border] += line.raw[border] == line.raw[border - 1];
  }
}

Repeats repeats_of(const BorderCounts& counts, std::size_t lines) {
  constexpr double kNearlyAll = 0.9;
  const auto least = std::uint32_t(std::max<std::size_t>(8, lines / 50));
  Repeats repeats{.all = int(counts.places.size())};
  for (std::size_t i = 0; i < counts.places.size(); i++) {
    if (counts.places[i] < least) continue;
    repeats.borders++;
    repeats.equal += counts.equal[i] > kNearlyAll * counts.places[i];
    repeats.steps += counts.equal[i] < (1 - kNearlyAll) * counts.places[i];
  }
  return repeats;
}

// Outlines.

namespace {

/// The size of a step between two pixels. NaN between two that are infinite.
template <class Value>
double step(std::span<const Value> values, std::size_t i) {
  return std::abs(double(values[i + 1]) - double(values[i]));
}

/// The stretch about a step, within another one, along which steps are no less than a tenth of it.
template <class Value>
Ramp ramp_about(std::span<const Value> values, std::size_t peak, const Ramp& within) {
  constexpr double kEnds = 0.1;
  const double least = kEnds * step(values, peak);
  Ramp ramp{peak, peak + 1};
  while (ramp.first > within.first && step(values, ramp.first - 1) > least) ramp.first--;
  while (ramp.last < within.last && step(values, ramp.last) > least) ramp.last++;
  const double change = std::abs(double(values[ramp.last]) - double(values[ramp.first]));
  ramp.is_sharp = step(values, peak) > kSharp * change;
  return ramp;
}

template <class Value>
std::size_t largest_step(std::span<const Value> values, const Ramp& within) {
  std::size_t largest = within.first;
  for (std::size_t i = within.first; i < within.last; i++)
    if (step(values, i) > step(values, largest)) largest = i;
  return largest;
}

/// Adds the ramps of a stretch along which the raw value changes in one direction.
void add_ramps(std::span<const double> u, std::span<const float> raw, const Ramp& within, std::vector<Ramp>& ramps) {
  constexpr double kLeastStep = 0.02, kLeastChange = 0.08;  // of 1/z
  constexpr std::size_t kWidest = 24;                       // px; wider ones are slopes
  constexpr double kGoesOn = 0.4;                           // of its largest step
  const std::size_t peak = largest_step(u, within);
  if (!(step(u, peak) > kLeastStep * std::min(u[within.first], u[within.last]))) return;
  Ramp ramp = ramp_about(u, peak, within);
  // Distances that were blurred are a ramp in them: in 1/z all of it lies at the nearer end.
  const double going_on = kGoesOn * step(raw, largest_step(raw, ramp));
  if ((ramp.first > within.first && step(raw, ramp.first - 1) > going_on) ||
      (ramp.last < within.last && step(raw, ramp.last) > going_on)) {
    const Ramp in_raw = ramp_about(raw, largest_step(raw, ramp), within);
    ramp = {std::min(ramp.first, in_raw.first), std::max(ramp.last, in_raw.last), in_raw.is_sharp};
  }
  if (ramp.first > within.first) add_ramps(u, raw, {within.first, ramp.first}, ramps);
  const double from = u[ramp.first], to = u[ramp.last], least = kLeastStep * std::max(u[peak], u[peak + 1]);
  const bool is_whole = ramp.first > 0 && ramp.last + 1 < u.size(), is_narrow = ramp.last - ramp.first <= kWidest;
  if (is_whole && is_narrow && step(u, peak) >= least && std::abs(to - from) >= kLeastChange * std::max(from, to))
    ramps.push_back(ramp);
  if (ramp.last < within.last) add_ramps(u, raw, {ramp.last, within.last}, ramps);
}

}  // namespace

std::vector<Ramp> ramps_in(std::span<const double> u, std::span<const float> raw) {
  std::vector<Ramp> ramps;
  for (std::size_t first = 0, last = 1; last < raw.size(); first = last++) {
    const bool rises = raw[last] > raw[first];
    if (!rises && !(raw[last] < raw[first])) continue;
    while (last + 1 < raw.size() && (rises ? raw[last + 1] > raw[last] : raw[last + 1] < raw[last])) last++;
    add_ramps(u, raw, {first, last}, ramps);
  }
  return ramps;
}

namespace {

/// Steps from one smooth surface to another with a pixel in between, or none.
void count_steps(std::span<const double> u, Outlines& outlines) {
  constexpr double kStep = 0.1;     // relative change of depth that is an edge
  constexpr double kSmooth = 0.02;  // relative change within a surface
  constexpr double kBetween = 0.1;  // part of a step within which a value belongs to the surface on that side
  for (std::size_t x = 2; x + 2 < u.size(); x++) {
    if (are_close(u[x - 1], u[x + 1], kStep)) continue;
    if (!are_close(u[x - 2], u[x - 1], kSmooth) || !are_close(u[x + 1], u[x + 2], kSmooth)) continue;
    const double before = 1 / u[x - 1], here = 1 / u[x], after = 1 / u[x + 1];
    const double place = (here - before) / (after - before);
    const bool is_between = place > kBetween && place < 1 - kBetween;
    outlines.blended += is_between;
    // An edge without a pixel in between is seen from both of its sides, and is counted once.
    outlines.steps += is_between || place <= kBetween;
  }
}

}  // namespace

void count_outlines(const Line& line, Outlines& outlines) {
  for (std::size_t first = 0; first < line.size(); first++) {
    std::size_t end = first;
    while (end < line.size() && line.is_surface(end)) end++;
    const auto surfaces = std::span(line.inverse).subspan(first, end - first);
    for (const Ramp& ramp : ramps_in(surfaces, std::span(line.raw).subspan(first, end - first)))
      outlines.count++, outlines.sharp += ramp.is_sharp;
    count_steps(surfaces, outlines);
    first = end;
  }
}

// Holes.

namespace {

/// Whether the pixels on both sides of a hole are of one plane.
bool is_within_plane(const Line& line, std::size_t first, std::size_t end) {
  constexpr double kSame = 5e-4;  // of 1/z
  if (first < 2 || end + 2 > line.size() || !line.is_surface(first - 2) || !line.is_surface(end + 1)) return false;
  const auto& u = line.inverse;
  const double before = u[first - 1] - u[first - 2], after = u[end + 1] - u[end];
  const double beyond = u[first - 1] + before * double(end - first + 1);
  return std::abs(beyond - u[end]) < kSame * u[end] && std::abs(before - after) < kSame * u[end];
}

}  // namespace

HoleCounts count_holes(const Line& line, Holes& holes) {
  constexpr std::size_t kWidest = 4;  // px
  constexpr double kSame = 0.02;      // relative change of depth
  HoleCounts counts;
  const auto eighth = [&](std::size_t i) { return 8 * i / line.size(); };
  for (std::size_t i = 0; i < line.size(); i++) {
    if (line.is_surface(i)) {
      holes.surfaces++;
      counts.surfaces[eighth(i)]++;
      continue;
    }
    std::size_t end = i;
    while (end < line.size() && !line.is_surface(end)) end++;
    const bool is_hole =
        i > 0 && end < line.size() && end - i <= kWidest && are_close(line.inverse[i - 1], line.inverse[end], kSame);
    if (is_hole) {
      holes.between += end - i;
      holes.within_planes += is_within_plane(line, i, end) ? end - i : 0;
      counts.holes[eighth(i)] += end - i;
    }
    i = end - 1;
  }
  return counts;
}

// Unevenness.

void sample_bends(const Line& line, BendSample& sample) {
  constexpr std::size_t kStep = 5;  // px
  for (std::size_t i = 2; i + 2 < line.size(); i += kStep) {
    if (!are_surfaces(line, i - 1, i + 3)) continue;
    const double here = bend_at(line, i), next = bend_at(line, i + 1);
    sample.sizes.push_back(std::abs(here));
    sample.neighbours++;
    sample.opposite += here * next < 0;
  }
}

// A range that began again.

void sample_drops(const Line& line, DropSample& sample) {
  constexpr double kSmooth = 0.05;  // of the largest value, from pixel to pixel of one surface
  double most = 0;
  for (std::size_t i = 0; i < line.size(); i++)
    if (line.is_surface(i)) most = std::max(most, double(line.raw[i]));
  sample.most = std::max(sample.most, most);
  for (std::size_t i = 1; i + 2 < line.size(); i++) {
    const double here = line.raw[i], next = line.raw[i + 1];
    if (std::abs(here - next) < 0.5 * most || !are_surfaces(line, i - 1, i + 3)) continue;
    const double before = here - line.raw[i - 1], after = line.raw[i + 2] - next;
    if (std::max(std::abs(before), std::abs(after)) > kSmooth * most) continue;
    // One surface has about the same slope on both sides; a sky of one value has none.
    if (!(before * after > 0) || std::max(before / after, after / before) > 2) continue;
    const double slope = 0.5 * (before + after);
    sample.drops.push_back(here > next ? here - next + slope : next - here - slope);
  }
}

Wrapping wrapping_of(DropSample sample) {
  constexpr double kSame = 0.005;   // of the range
  constexpr double kNearly = 0.97;  // of the largest value
  std::erase_if(sample.drops, [&](double drop) { return drop < kNearly * sample.most; });
  Wrapping wrapping{.drops = sample.drops.size(), .most = sample.most};
  if (sample.drops.empty()) return wrapping;
  wrapping.period = median_of(sample.drops);
  const auto is_whole = [&](double drop) { return std::abs(drop - wrapping.period) < kSame * wrapping.period; };
  wrapping.whole = std::size_t(std::ranges::count_if(sample.drops, is_whole));
  return wrapping;
}

// Normals beside outlines.

namespace {

constexpr std::size_t kReach = 5;  // px to both sides of an outline

/// Whether the pixels lie on one plane.
bool are_plane(const Line& line, std::size_t first, std::size_t end) {
  constexpr double kFlat = 1e-3;  // relative second difference
  if (!are_surfaces(line, first, end)) return false;
  for (std::size_t i = first + 1; i + 1 < end; i++)
    if (std::abs(bend_at(line, i)) > kFlat) return false;
  return true;
}

double squared_distance(const Line& line, std::size_t i, std::size_t k) {
  double sum = 0;
  const std::size_t at = line.first + i * line.stride, other = line.first + k * line.stride;
  for (std::size_t plane = 0; plane < line.normals.size(); plane += line.pixels)
    sum += std::pow(double(line.normals[plane + at]) - line.normals[plane + other], 2);
  return sum;
}

}  // namespace

void sample_normal_shifts(const Line& line, std::vector<int>& shifts) {
  constexpr double kEdge = 0.1;         // relative change of depth
  constexpr double kOther = 0.3 * 0.3;  // squared distance of normals of two surfaces
  constexpr int kMostWrong = 1;         // pixels that belong to the other side
  if (line.normals.empty()) return;
  for (std::size_t i = kReach; i + kReach + 1 < line.size(); i++) {
    if (!line.is_surface(i) || !line.is_surface(i + 1) || are_close(line.inverse[i], line.inverse[i + 1], kEdge))
      continue;
    const std::size_t first = i - kReach, last = i + kReach + 1;
    if (!are_plane(line, first, i + 1) || !are_plane(line, i + 1, last + 1)) continue;
    if (!(squared_distance(line, first, last) > kOther)) continue;
    int best_wrong = kMostWrong + 1, best = 0;
    for (int shift = -int(kReach) + 1; shift < int(kReach); shift++) {
      int wrong = 0;
      for (std::size_t k = first; k <= last; k++) {
        const bool is_first = squared_distance(line, k, first) < squared_distance(line, k, last);
        wrong += is_first != (int(k) <= int(i) + shift);
      }
      if (wrong < best_wrong || (wrong == best_wrong && std::abs(shift) < std::abs(best)))
        best_wrong = wrong, best = shift;
    }
    if (best_wrong <= kMostWrong) shifts.push_back(best);
  }
}

// Stretches without surfaces.

std::vector<EmptyRun> empty_runs(const Line& line) {
  constexpr std::size_t kLeast = 8;  // px
  std::vector<EmptyRun> runs;
  for (std::size_t i = 0; i < line.size(); i++) {
    if (line.is_surface(i)) continue;
    std::size_t end = i + 1;
    const auto is_same = [&](float v) { return v == line.raw[i] || (std::isnan(v) && std::isnan(line.raw[i])); };
    while (end < line.size() && !line.is_surface(end) && is_same(line.raw[end])) end++;
    if (end - i >= kLeast) runs.push_back({i, end, line.raw[i]});
    i = end - 1;
  }
  return runs;
}

}  // namespace alcove
