// Completed surfaces along one side of a slice, as straight segments.
// SPDX-License-Identifier: BSD-3-Clause
//
// "Nearness" is 1 / z, or -z with an orthographic camera. That of a plane is linear on the image, and surfaces nearer
// to the eye have a larger one.
#include "core/reference/reference_slice.h"

#include <algorithm>
#include <cmath>

namespace alcove {
namespace {

/// The least height of a surface's end above the receiver's tangent plane, as a part of its distance, for it to go on.
/// Lower ends would turn the rounding of flat surfaces into occluders.
constexpr double kLeastHeight = 1e-3;
/// The least facing for which the normal's plane counts: the dot product of the normal and the view ray, which is 1
/// long along the optical axis. Surfaces seen more nearly edge on have no reliable plane.
constexpr double kLeastFacing = -0.02;
/// A surface is seen where it lies less than so many pixels' widths behind what is seen.
constexpr double kSeenWithin = 0.25;
/// Beyond the border a surface goes on no nearer and no farther than so many times its depth there, and if it stands so
/// many radii above the receiver's tangent plane: a floor stays open, whatever its normal map.
constexpr double kMostChange = 2;
/// The sine of the angle below a border pixel's tangent plane from which on what is seen is another surface.
constexpr double kMostBend = 0.55;
constexpr double kLeastRisen = 0.1;

/// The straight line along which a surface goes on from the end of its run.
struct Course {
  int edge = 0;         // index of the end's sample
  int step = 0;         // of that sample
  double nearness = 0;  // of the end, on the slice's image line
  double slope = 0;     // of nearness per step away from the receiver

  double at(double at_step) const { return nearness + slope * (at_step - step); }
};

class Completer {
 public:
  Completer(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
            const ReferenceLine& line, const ReferenceSettings& settings)
      : scene_(scene), receiver_(receiver), side_(side), line_(line), settings_(settings), steps_(line.steps()) {}

  std::vector<CompletedSegment> segments() {
    if (completes_behind(settings_)) {
      for (int first = 0; first < int(line_.samples.size()); first++) {
        if (sample(first).depth == 0 || sample(first).nearer >= 0) continue;
        const int last = last_of_run(line_, first);
        // A single pixel shows no line.
        if (last == first) continue;
        const int begin = line_.step_of(first);
        const int end = line_.step_of(last);
        if (begin > 0 && is_seen(first) && hides(begin - 1, first)) go_on_behind(first, -1);
        if (end + 1 < steps_ && is_seen(last) && hides(end + 1, last)) go_on_behind(last, 1);
      }
    }
    if (line_.at_border) add_beyond_border();
    return std::move(segments_);
  }

 private:
  const ReferenceSample& sample(int i) const { return line_[i]; }
  /// The index of the surface of a pixel behind which nothing is known: the last one, or the first one if lists may
  /// lack surfaces.
  int hiding_surface() const { return scene_.lists_all() ? line_.surfaces - 1 : 0; }
  const ReferenceSample& hider(int step) const { return line_.at(step, hiding_surface()); }
  /// Only visible surfaces go on. Hidden surfaces are facts, and guesses from them made errors larger: docs/hidden.md.
  bool is_seen(int i) const { return i % line_.surfaces == 0; }
  bool hides(int step, int what) const { return hider(step).depth > 0 && hider(step).depth < sample(what).depth; }

  double nearness_at(double depth) const { return scene_.orthographic() ? -depth : 1 / depth; }
  /// The nearness of a sample; sky is infinitely far.
  double nearness_of(const ReferenceSample& sample) const {
    return nearness_at(sample.depth > 0 ? sample.depth : INFINITY);
  }

  /// Whether a nearness is seen at a step, or known not to be there.
  bool shows(int step, double nearness) const {
    const double depth = hider(step).depth;
    const double width = (scene_.orthographic() ? 1 : nearness_of(hider(step))) / scene_.fx();
    return depth == 0 || nearness >= nearness_at(depth) - kSeenWithin * width;
  }

  /// A point on the slice, as an offset from the receiver.
  Vector point(double step, double nearness) const {
    const double depth = scene_.orthographic() ? -nearness : 1 / nearness;
    return scene_.position(receiver_.x, receiver_.y, depth) +
           scene_.across(side_.step_x * step, side_.step_y * step, depth) - receiver_.position;
  }

  /// The change of nearness on the plane through a sample across its normal; none if the plane is seen edge on.
  std::optional<double> change_on_plane(int i, double x_px, double y_px) const {
    const auto [x, y] = pixel_at(receiver_, side_, line_.step_of(i));
    const Vector ray = scene_.position(x, y, 1) - scene_.position(x, y, 0);
    const Vector normal = scene_.normal(x, y, scene_.toward_eye(sample(i).position));
    const double facing = dot(normal, ray);
    if (facing > kLeastFacing || !is_seen(i)) return std::nullopt;
    const double scale = scene_.orthographic() ? 1 : 1 / sample(i).depth;
    return dot(normal, scene_.across(x_px, y_px, 1)) / facing * scale;
  }

  /// The nearness of sample `i`, moved from its pixel's centre to the slice's image line along the plane of sample
  /// `edge`.
  double on_line(int i, int edge) const {
    const int step = line_.step_of(i);
    const auto [x, y] = pixel_at(receiver_, side_, step);
    const double off_x = receiver_.x + side_.step_x * step - x;
    const double off_y = receiver_.y + side_.step_y * step - y;
    return nearness_of(sample(i)) + change_on_plane(edge, off_x, off_y).value_or(0);
  }

  /// The course from the end of a run: the mean of the line from sample `other` of the same run, and of the plane at
  /// the end. The line follows curved surfaces, and the plane serves surfaces a few pixels wide.
  Course course_from(int edge, int other) const {
    Course course;
    course.edge = edge;
    course.step = line_.step_of(edge);
    course.nearness = on_line(edge, edge);
    course.slope = (course.nearness - on_line(other, edge)) / (course.step - line_.step_of(other));
    const auto plane = change_on_plane(edge, side_.step_x, side_.step_y);
    if (plane) course.slope = 0.5 * (course.slope + *plane);
    return course;
  }

  bool stands_above(int i) const {
    const Vector offset = sample(i).position - receiver_.position;
    return dot(receiver_.normal, offset) >= kLeastHeight * length(offset);
  }

  /// Whether a surface that goes on has left for good the range of depth in which its solid may reach into the sphere.
  bool has_left(const Course& course, double nearness, double change) const {
    const double nearest = receiver_.depth - settings_.radius - reach_of(course);
    if (change < 0) return nearness < nearness_at(receiver_.depth + settings_.radius);
    return (nearest > 0 || scene_.orthographic()) && nearness > nearness_at(nearest);
  }

  /// Continues the end of a run of several pixels: away from the receiver (way 1), or towards it (-1).
  void go_on_behind(int edge, int way) {
    if (!stands_above(edge)) return;
    const Course course = course_from(edge, way > 0 ? sample(edge).nearer : sample(edge).farther);
    for (int step = course.step + way;; step += way) {
      if (step == 0) return add(course, 1);
      if (step == steps_) return add(course, step - way);
      const double nearness = course.at(step);
      if (shows(step, nearness)) return add(course, step - way);
      if ((way > 0 && step > side_.reach + 1) || has_left(course, nearness, course.slope * way))
        return add_ray(course, way);
    }
  }

  /// Whether a surface of the border is seen to end inside: the pixel mirrored at the border's shows something behind
  /// its tangent plane.
  bool is_seen_to_end(int x, int y, int near_x, int near_y, double depth, Vector normal) const {
    const int mirrored_x = std::clamp(2 * near_x - x, 0, scene_.width() - 1);
    const int mirrored_y = std::clamp(2 * near_y - y, 0, scene_.height() - 1);
    const double mirrored = scene_.depth(mirrored_x, mirrored_y);
    if (mirrored == 0) return true;
    const Vector inward = scene_.position(mirrored_x, mirrored_y, mirrored) - scene_.position(near_x, near_y, depth);
    return dot(normal, inward) < -kMostBend * length(inward);
  }

  /// A step beyond the picture's border: the plane of the border's nearest pixel goes on there. None where that is seen
  /// edge on, comes much nearer to the eye or farther away, or where its surface has ended.
  std::optional<Vector> beyond_border(int step) const {
    const auto [x, y] = pixel_at(receiver_, side_, step);
    const int near_x = std::clamp(x, 0, scene_.width() - 1);
    const int near_y = std::clamp(y, 0, scene_.height() - 1);
    const double depth = scene_.depth(near_x, near_y);
    if (depth == 0) return std::nullopt;
    const Vector normal = scene_.normal(near_x, near_y, scene_.toward_eye(scene_.position(near_x, near_y, depth)));
    if (is_seen_to_end(x, y, near_x, near_y, depth, normal)) return std::nullopt;
    const double facing = dot(normal, scene_.position(near_x, near_y, 1) - scene_.position(near_x, near_y, 0));
    const double off_x = receiver_.x + side_.step_x * step - near_x;
    const double off_y = receiver_.y + side_.step_y * step - near_y;
    const double turn = dot(normal, scene_.across(off_x, off_y, 1));
    const double there = scene_.orthographic() ? depth - turn / facing : depth * facing / (facing + turn);
    const double facing_there = scene_.orthographic() ? facing : facing + turn;
    if (std::max(facing, facing_there) > kLeastFacing || there < depth / kMostChange || there > depth * kMostChange)
      return std::nullopt;
    return point(step, nearness_at(there));
  }

  /// Adds what goes on beyond the picture's border, step by step, in planes. With `width` it is as thick as it is wide
  /// there so far, and half a radius at most.
  void add_beyond_border() {
    std::optional<Vector> last, start;
    const double farthest = std::min(side_.reach, double(steps_ + std::max(scene_.width(), scene_.height())));
    for (int step = steps_ - 1; step <= farthest + 1; step++) {
      std::optional<Vector> here = step == 0 ? std::nullopt : beyond_border(step);
      if (here && dot(receiver_.normal, *here) < kLeastRisen * size_of(settings_)) here.reset();
      const double pixel = here ? (scene_.orthographic() ? 1 : -(receiver_.position + *here).z) / scene_.fx() : 0;
      const bool joins = here && last && std::abs(here->z - last->z) < kRunSlope * pixel;
      if (!joins) start = here;
      if (here) segments_.push_back({joins ? *last : *here, *here, thickness_beyond(length(*here - *start) + pixel)});
      last = here;
    }
  }

  double thickness_beyond(double width) const {
    if (settings_.thickness == ThicknessRule::infinite) return INFINITY;
    if (settings_.thickness == ThicknessRule::constant) return settings_.thickness_length;
    return std::min(width, kThicknessOfCut * size_of(settings_));
  }

  /// Adds the segment of a course up to `step` steps from the receiver.
  void add(const Course& course, double step) {
    if (step == course.step) return;
    const Vector from = sample(course.edge).position - receiver_.position;
    add_part(course, from, point(step, course.at(step)) - from, 1, step > course.step);
  }

  /// Adds the segment of a course up to the sphere, or to the plane of the eye.
  void add_ray(const Course& course, int way) {
    const Vector from = sample(course.edge).position - receiver_.position;
    // The direction is that to a point one step away, or half way to the step where the surface would be infinitely
    // far.
    const double change = course.slope * way;
    const bool vanishes = !scene_.orthographic() && change < 0;
    const double step = course.step + way * (vanishes ? std::min(1.0, 0.5 * course.nearness / -change) : 1);
    const Vector along = point(step, course.at(step)) - point(course.step, course.nearness);
    const bool meets_eye = !scene_.orthographic() && along.z > 0;
    add_part(course, from, along, meets_eye ? sample(course.edge).depth / along.z : INFINITY, way > 0);
  }

  /// Adds the points from + t along, 0 <= t <= most, that lie in the sphere, and apart those whose solid may reach into
  /// it from before it.
  void add_part(const Course& course, Vector from, Vector along, double most, bool away) {
    const auto [first, last] = within(from, along, settings_.radius);
    const auto [nearest, farthest] = within(from, along, settings_.radius + reach_of(course));
    std::vector<double> cuts{std::max(0.0, nearest), std::min(most, farthest)};
    for (const double cut : {first, last})
      if (first < last && cut > cuts.front() && cut < cuts.back()) cuts.insert(cuts.end() - 1, cut);
    for (std::size_t i = 1; i < cuts.size() && cuts.front() < cuts.back(); i++) {
      const Vector begin = from + cuts[i - 1] * along;
      const Vector end = from + cuts[i] * along;
      segments_.push_back({away ? begin : end, away ? end : begin, sample(course.edge).thickness});
    }
  }

  /// How far before the sphere a surface may lie for its solid to reach into it.
  double reach_of(const Course& course) const {
    const double thickness = sample(course.edge).thickness;
    return thickness < INFINITY ? thickness : 0;
  }

  const ReferenceScene& scene_;
  const ReferenceReceiver& receiver_;
  const ReferenceSide& side_;
  const ReferenceLine& line_;
  const ReferenceSettings& settings_;
  int steps_;  // of the line
  std::vector<CompletedSegment> segments_;
};

}  // namespace

std::vector<CompletedSegment> completed_segments(const ReferenceScene& scene, const ReferenceReceiver& receiver,
                                                 const ReferenceSide& side, const ReferenceLine& line,
                                                 const ReferenceSettings& settings) {
  if (settings.complete == Completion::none) return {};
  return Completer(scene, receiver, side, line, settings).segments();
}

}  // namespace alcove
