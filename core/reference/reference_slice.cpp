// The image line of a slice: which pixels it meets, where its runs end, and how thick they are.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference_slice.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace alcove {
namespace {

// The rules of solids, one by one. "Pixels" are pixels' widths at the depth of what is compared.

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

/// Which neighbours on a slice show one surface, and how far back behind its front it is solid: the rules of
/// docs/completion.md, by the normals of the first surfaces, at one side of a slice. Its arguments must outlive it.
class Solids {
 public:
  Solids(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
         const ReferenceSettings& settings)
      : scene_(scene), receiver_(receiver), side_(side), settings_(settings) {}

  /// Whether two samples of neighbouring steps, the nearer step first, are one surface. is_own: it is the receiver's.
  bool connect(const ReferenceLine& line, int a, int b, bool is_own) const {
    const ReferenceSample& from = line[a];
    const ReferenceSample& to = line[b];
    if (from.depth == 0 || to.depth == 0) return false;
    const bool by_normals = has_normals(line, a, b);
    const double slope = is_own && by_normals ? kOwnSlope : kRunSlope;
    if (std::abs(from.depth - to.depth) < slope * pixels_at(std::min(from.depth, to.depth)))
      return !by_normals || !are_parallel(from, to);
    return by_normals && (are_coplanar(from, to, kPlaneDot, kPlaneOff) || meet_at_edge(line, a, b));
  }

  /// Whether a run that holds two samples is so long that no more of its width counts, and its other end tells nothing.
  bool is_long(const ReferenceLine& line, int first, int last) const {
    const double chord = length(line[last].position - line[first].position);
    return settings_.width_share * chord > kWidestFlat * size_of(settings_);
  }

  /// Sets the thickness of the samples of a run that is not the receiver's, by its width and by how far back it is seen
  /// to reach, and adds the hidden face that closes it towards the receiver.
  void thicken(ReferenceLine& line, const std::vector<int>& run) const {
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

  /// That of a run that may be the receiver's own, but is not sure to be: by its width alone.
  double thickness_of_rest(const ReferenceLine& line, const std::vector<int>& run) const {
    return by_width(line, run, false);
  }

 private:
  double pixels_at(double depth) const { return scene_.orthographic() ? 1 / scene_.fx() : depth / scene_.fx(); }

  double distance_from_eye(const ReferenceSample& sample) const {
    return scene_.orthographic() ? sample.depth : length(sample.position);
  }

  /// Rules hold for `auto`, and between first surfaces: others have no normals.
  bool has_normals(const ReferenceLine& line, int a, int b) const {
    return settings_.thickness == ThicknessRule::width && a % line.surfaces == 0 && b % line.surfaces == 0;
  }

  bool are_coplanar(const ReferenceSample& a, const ReferenceSample& b, double least_dot, double most_pixels) const {
    if (a.depth == 0 || b.depth == 0 || dot(a.normal, b.normal) < least_dot) return false;
    const double pixel = pixels_at(std::min(a.depth, b.depth));
    const Vector step = b.position - a.position;
    return std::max(std::abs(dot(a.normal, step)), std::abs(dot(b.normal, step))) < most_pixels * pixel &&
           std::abs(a.depth - b.depth) < kPlaneSlope * pixel;
  }

  bool are_parallel(const ReferenceSample& a, const ReferenceSample& b) const {
    const double pixel = pixels_at(std::min(a.depth, b.depth));
    if (std::abs(a.depth - b.depth) < kParallelSlope * pixel || dot(a.normal, b.normal) < kPlaneDot) return false;
    const Vector step = b.position - a.position;
    const double least = std::max(kParallelOff * pixel, kParallelApart * size_of(settings_));
    return std::min(std::abs(dot(a.normal, step)), std::abs(dot(b.normal, step))) >= least;
  }

  bool meet_at_edge(const ReferenceLine& line, int a, int b) const {
    const bool recedes = line[b].depth > line[a].depth;
    const int far = recedes ? b : a;
    const ReferenceSample& near = line[recedes ? a : b];
    if (!comes_to(line[far], near)) return false;
    return dot(line[far].normal, near.normal) < kClearEdge ||
           are_coplanar(line[far], first_beside(line, far, recedes ? 1 : -1), kFlatDot, kFlatOff);
  }

  bool comes_to(const ReferenceSample& far, const ReferenceSample& near) const {
    const Vector ray = scene_.position(far.x, far.y, 1) - scene_.position(far.x, far.y, 0);
    const double facing = dot(far.normal, ray);
    if (facing > kEdgeFacing) return false;
    const auto nearness = [&](double depth) { return scene_.orthographic() ? -depth : 1 / depth; };
    const double step = dot(far.normal, scene_.across(near.x - far.x, near.y - far.y, 1)) / facing *
                        (scene_.orthographic() ? 1 : 1 / far.depth);
    const double change = nearness(near.depth) - nearness(far.depth);
    return change * step > 0 && std::abs(change) < kEdgeSteps * std::abs(step);
  }

  /// The first surface of the pixel one step from a sample, away from the receiver (way 1) or towards it (-1).
  ReferenceSample first_beside(const ReferenceLine& line, int sample, int way) const {
    const auto [x, y] = pixel_at(receiver_, side_, line.step_of(sample) + way);
    return scene_.inside(x, y) ? sample_of(scene_, x, y, 0) : ReferenceSample{};
  }

  /// Whether three samples are first surfaces, and in one plane.
  bool is_flat(const ReferenceLine& line, int a, int b, int c) const {
    return has_normals(line, a, b) && has_normals(line, a, c) && are_coplanar(line[a], line[b], kFlatDot, kFlatOff) &&
           are_coplanar(line[a], line[c], kFlatDot, kFlatOff);
  }

  /// The width that counts at most of the run that begins with a sample, in scene units.
  double widest(const ReferenceLine& line, int first) const {
    const int second = line[first].farther;
    const int third = second < 0 ? -1 : line[second].farther;
    const bool flat = third >= 0 && is_flat(line, first, second, third);
    return (flat ? kWidestFlat : kWidest) * size_of(settings_);
  }

  double by_width(const ReferenceLine& line, const std::vector<int>& run, bool may_be_flat = true) const {
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
  bool hides(const ReferenceLine& line, int first) const {
    const double before = line.at(line.step_of(first) - 1, 0).depth;
    return before == 0 || before > line[first].depth;
  }

  Vector in_slice(Vector normal) const {
    const Vector projected = dot(normal, side_.tangent) * side_.tangent + dot(normal, receiver_.eye) * receiver_.eye;
    return length(projected) > 1e-6 ? normalized(projected) : receiver_.eye;
  }

  bool mirrors(const ReferenceLine& line, const std::vector<int>& run) const {
    if (int(run.size()) < kRoundSamples || !has_normals(line, run[0], run[2]) || !hides(line, run[0])) return false;
    const ReferenceSample& outline = line[run[0]];
    const Vector away = -1 * scene_.toward_eye(outline.position);
    return -dot(in_slice(outline.normal), away) < kRoundFacing && dot(outline.normal, line[run[2]].normal) < kRoundDot;
  }

  /// How far back a solid is seen to reach from a sample, by the ends of its run: farther from the eye, and behind the
  /// sample's own plane.
  double reaches_back(const ReferenceLine& line, int i, const std::vector<int>& run) const {
    const ReferenceSample& here = line[i];
    const Vector normal = in_slice(here.normal);
    double farthest = 0;
    for (const int end : {run.front(), run.back()}) {
      const double behind = -dot(normal, line[end].position - here.position);
      farthest = std::max(farthest, std::min(distance_from_eye(line[end]) - distance_from_eye(here), behind));
    }
    return std::min(farthest, kFarthestBack * size_of(settings_));
  }

  void close(ReferenceLine& line, const std::vector<int>& run) const {
    if (run.size() < 3 || !has_normals(line, run[0], run[1]) || !has_normals(line, run[0], run[2])) return;
    if (line.step_of(run[0]) > side_.reach + 1 || !hides(line, run[0])) return;
    const ReferenceSample& end = line[run[0]];
    if (std::min(dot(end.normal, line[run[1]].normal), dot(end.normal, line[run[2]].normal)) < kClosingDot) return;
    const Vector from = end.position - receiver_.position;
    line.closing.push_back({from, from - end.thickness * in_slice(end.normal)});
  }

  const ReferenceScene& scene_;
  const ReferenceReceiver& receiver_;
  const ReferenceSide& side_;
  const ReferenceSettings& settings_;
};

/// With Completion::all, surfaces that begin within so many reaches of the receiver may go on into the sphere. The
/// seven rendered scenes came ever nearer to ray tracing up to 3.
constexpr double kFarReach = 3;

/// Whether the line must go on beyond the reach. Samples there matter only as the other end of a crossing, as more of a
/// run's width, and as surfaces that may go on into the sphere. A run that is thicker than the sphere is wide enough.
/// `firsts` holds, for each sample, the first one of its run. Sky ends all continuations.
bool goes_on(const Solids& solids, const ReferenceSettings& settings, const ReferenceSide& side,
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
void link(const Solids& solids, ReferenceLine& line, const std::vector<int>& firsts) {
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
  const Solids solids(scene, receiver, side, settings);
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
int rest_of_own(const Solids& solids, const ReferenceLine& line) {
  const int last = last_of_run(line, 0), next = (line.step_of(last) + 1) * line.surfaces;
  if (next >= int(line.samples.size())) return -1;
  for (int i = next; i < next + line.surfaces; i++)
    if (line[i].nearer < 0 && solids.connect(line, last, i, false)) return i;
  return -1;
}

void set_thickness(const Solids& solids, ReferenceLine& line, const ReferenceSettings& settings) {
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
  set_thickness(Solids(scene, receiver, side, settings), line, settings);
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
