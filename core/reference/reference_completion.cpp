// Completed surfaces along one side of a slice, as straight segments.
// SPDX-License-Identifier: BSD-3-Clause
//
// "Nearness" is 1 / z, and with an orthographic camera -z: a plane's is linear on the image, and what is nearer to the
// eye has the larger one.
#include "core/reference/reference_slice.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace alcove {
namespace {

/// A surface goes on from its end only where that stands so high above the receiver's tangent plane, as a part of its
/// distance. Lower ends would turn the rounding of flat surfaces into occluders.
constexpr double kLeastHeight = 1e-3;
/// The normal's plane says nothing about a surface that is seen more nearly edge on than this: the dot product of the
/// normal and the view ray, which is 1 long along the optical axis.
constexpr double kLeastFacing = -0.02;
/// Beyond the border a surface goes on along the line through so many of its last pixels, and at least so many.
constexpr int kPixelsOfBorder = 4;
constexpr int kLeastPixelsOfBorder = 3;

/// The straight line along which a surface goes on from the end of its run.
struct Course {
  int edge = 0;         // index of the end's sample
  int step = 0;         // of it
  double nearness = 0;  // there, on the slice's image line
  double slope = 0;     // of nearness per step away from the receiver

  double at(double at_step) const { return nearness + slope * (at_step - step); }
};

class Completer {
 public:
  Completer(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
            const ReferenceLine& line, const ReferenceSettings& settings)
      : scene_(scene), receiver_(receiver), side_(side), line_(line), settings_(settings), steps_(line.steps()) {}

  std::vector<CompletedSegment> segments() {
    if (line_.at_border) beyond_border_ = course_beyond_border((steps_ - 1) * line_.surfaces);
    if (completes_behind(settings_)) {
      for (int first = 0; first < int(line_.samples.size()); first++) {
        if (sample(first).depth == 0 || sample(first).nearer >= 0) continue;
        const int last = last_of_run(line_, first);
        // The line of a single pixel is not known.
        if (last == first) continue;
        const int begin = line_.step_of(first);
        const int end = line_.step_of(last);
        if (begin > 0 && is_seen(first) && hides(begin - 1, first)) go_on_behind(first, -1);
        if (end + 1 < steps_ && is_seen(last) && hides(end + 1, last)) go_on_behind(last, 1);
      }
    }
    if (beyond_border_) add_ray(*beyond_border_, 1);
    return std::move(segments_);
  }

 private:
  const ReferenceSample& sample(int i) const { return line_[i]; }
  /// The surface of a pixel behind which nothing is known: the last, or the first where others than those that are
  /// listed may be there.
  int hiding_surface() const { return scene_.lists_all() ? line_.surfaces - 1 : 0; }
  const ReferenceSample& hider(int step) const { return line_.at(step, hiding_surface()); }
  /// Only what is seen goes on. Hidden surfaces are facts, and to guess further from them was worse: docs/hidden.md.
  bool is_seen(int i) const { return i % line_.surfaces == 0; }
  bool hides(int step, int what) const { return hider(step).depth > 0 && hider(step).depth < sample(what).depth; }

  double nearness_at(double depth) const { return scene_.orthographic() ? -depth : 1 / depth; }
  /// Sky is infinitely far.
  double nearness_of(const ReferenceSample& sample) const {
    return nearness_at(sample.depth > 0 ? sample.depth : INFINITY);
  }

  /// A point on the slice, as an offset from the receiver.
  Vector point(double step, double nearness) const {
    const double depth = scene_.orthographic() ? -nearness : 1 / nearness;
    return scene_.position(receiver_.x, receiver_.y, depth) +
           scene_.across(side_.step_x * step, side_.step_y * step, depth) - receiver_.position;
  }

  /// The change of nearness on the plane through a sample across the normal there; none where that is seen edge on.
  std::optional<double> change_on_plane(int i, double x_px, double y_px) const {
    const auto [x, y] = pixel_at(receiver_, side_, line_.step_of(i));
    const Vector ray = scene_.position(x, y, 1) - scene_.position(x, y, 0);
    const Vector normal = scene_.normal(x, y, scene_.toward_eye(sample(i).position));
    const double facing = dot(normal, ray);
    if (facing > kLeastFacing || !is_seen(i)) return std::nullopt;
    const double scale = scene_.orthographic() ? 1 : 1 / sample(i).depth;
    return dot(normal, scene_.across(x_px, y_px, 1)) / facing * scale;
  }

  /// The nearness of the sample `i`, moved from its pixel's centre to the slice's image line along the plane of the
  /// sample `edge`.
  double on_line(int i, int edge) const {
    const int step = line_.step_of(i);
    const auto [x, y] = pixel_at(receiver_, side_, step);
    const double off_x = receiver_.x + side_.step_x * step - x;
    const double off_y = receiver_.y + side_.step_y * step - y;
    return nearness_of(sample(i)) + change_on_plane(edge, off_x, off_y).value_or(0);
  }

  /// The mean of two: the line from the sample `other` of the same run, and the plane of the end. The line follows
  /// what curves, and the plane what is only a few pixels wide.
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

  /// Whether what goes on has left the sphere's range of depth for good.
  bool has_left(double nearness, double change) const {
    const double nearest = receiver_.depth - settings_.radius;
    if (change < 0) return nearness < nearness_at(receiver_.depth + settings_.radius);
    return (nearest > 0 || scene_.orthographic()) && nearness > nearness_at(nearest);
  }

  std::optional<Course> course_beyond_border(int last) const {
    if (sample(last).depth == 0) return std::nullopt;
    int first = last;
    int pixels = 1;
    for (; pixels < kPixelsOfBorder && sample(first).nearer >= 0; pixels++) first = sample(first).nearer;
    if (pixels < kLeastPixelsOfBorder) return std::nullopt;
    return course_from(last, first);
  }

  /// From the end of a run of several pixels: away from the receiver (way 1), or towards it (-1).
  void go_on_behind(int edge, int way) {
    if (!stands_above(edge)) return;
    const Course course = course_from(edge, way > 0 ? sample(edge).nearer : sample(edge).farther);
    for (int step = course.step + way;; step += way) {
      if (step == 0) return add(course, 1);
      if (step == steps_) return add_beyond_border(course);
      const double nearness = course.at(step);
      if (hider(step).depth == 0 || nearness >= nearness_of(hider(step))) return add(course, step - way);
      if ((way > 0 && step > side_.reach + 1) || has_left(nearness, course.slope * way)) return add_ray(course, way);
    }
  }

  /// What goes on behind the last surface before the border may come to lie before it beyond the border.
  void add_beyond_border(const Course& course) {
    const int last = steps_ - 1;
    if (!beyond_border_) return add(course, last);
    const double behind = beyond_border_->nearness - course.at(last);
    const double closing = course.slope - beyond_border_->slope;
    if (closing <= 0) return add_ray(course, 1);
    add(course, last + std::max(0.0, behind / closing));
  }

  /// As far as so many steps from the receiver.
  void add(const Course& course, double step) {
    if (step == course.step) return;
    const Vector from = sample(course.edge).position - receiver_.position;
    add_part(course, from, point(step, course.at(step)) - from, 1, step > course.step);
  }

  /// As far as the sphere, or the plane of the eye.
  void add_ray(const Course& course, int way) {
    const Vector from = sample(course.edge).position - receiver_.position;
    // The direction is that to a point a step away, or half the way to where the surface is infinitely far.
    const double change = course.slope * way;
    const bool vanishes = !scene_.orthographic() && change < 0;
    const double step = course.step + way * (vanishes ? std::min(1.0, 0.5 * course.nearness / -change) : 1);
    const Vector along = point(step, course.at(step)) - point(course.step, course.nearness);
    const bool meets_eye = !scene_.orthographic() && along.z > 0;
    add_part(course, from, along, meets_eye ? sample(course.edge).depth / along.z : INFINITY, way > 0);
  }

  /// The points from + t along, 0 <= t <= most, that are in the sphere.
  void add_part(const Course& course, Vector from, Vector along, double most, bool away) {
    const double a = dot(along, along);
    const double b = dot(from, along);
    const double c = dot(from, from) - settings_.radius * settings_.radius;
    const double root = std::sqrt(std::max(0.0, b * b - a * c));
    const double first = std::max(0.0, (-b - root) / a);
    const double last = std::min(most, (-b + root) / a);
    if (b * b < a * c || !(first < last)) return;
    const Vector begin = from + first * along;
    const Vector end = from + last * along;
    segments_.push_back({away ? begin : end, away ? end : begin, sample(course.edge).thickness});
  }

  const ReferenceScene& scene_;
  const ReferenceReceiver& receiver_;
  const ReferenceSide& side_;
  const ReferenceLine& line_;
  const ReferenceSettings& settings_;
  int steps_;  // of the line
  std::optional<Course> beyond_border_;
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
