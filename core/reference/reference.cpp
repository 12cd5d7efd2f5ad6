// The CPU reference: slices about the view ray, every pixel along them, exact unions of blocked angles.
// SPDX-License-Identifier: BSD-3-Clause
//
// Written for reading, not for speed, and apart from the kernels: nothing but the formulas is shared.
#include "core/reference/reference.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <thread>
#include <utility>

#include "core/reference/reference_scene.h"
#include "core/reference/reference_slice.h"

namespace alcove {
namespace {

constexpr double kPi = std::numbers::pi;
/// A completed segment blocks in parts, so many if it is as long as the sphere is wide: each blocks what is behind its
/// ends, and in between.
constexpr int kPartsOfDiameter = 32;

using Scene = ReferenceScene;
using Sample = ReferenceSample;
using Receiver = ReferenceReceiver;
using Side = ReferenceSide;

/// The integral of cos(theta - gamma) |sin(theta)| from 0 to h (Jimenez et al. 2016, equation 7).
double arc(double h, double gamma) {
  return 0.25 * (std::cos(gamma) + 2 * h * std::sin(gamma) - std::cos(2 * h - gamma));
}

/// The weight of Simpson's rule at the i-th end of `parts` parts.
double simpson_weight(int i, int parts) {
  if (i == 0 || i == parts) return 1;
  return i % 2 ? 4 : 2;
}

/// The integrals over angles of a slice's side: of the arc, and of the arc times the spherical harmonics up to l = 2.
struct Integrals {
  double arc = 0;
  std::array<double, kTransferPlanes> transfer{};
};
Integrals operator+(Integrals a, const Integrals& b) {
  a.arc += b.arc;
  for (std::size_t k = 0; k < kTransferPlanes; k++) a.transfer[k] += b.transfer[k];
  return a;
}
Integrals operator*(double s, Integrals a) {
  a.arc *= s;
  for (double& x : a.transfer) x *= s;
  return a;
}
Integrals operator-(const Integrals& a, const Integrals& b) { return a + -1 * b; }

/// Y_00, Y_1-1, Y_10, Y_11, Y_2-2, Y_2-1, Y_20, Y_21, Y_22 of a direction.
std::array<double, kTransferPlanes> harmonics(Vector w) {
  const double linear = std::sqrt(3 / kPi) / 2, mixed = std::sqrt(15 / kPi) / 2;
  return {std::sqrt(1 / kPi) / 2,
          linear * w.y,
          linear * w.z,
          linear * w.x,
          mixed * w.x * w.y,
          mixed * w.y * w.z,
          std::sqrt(5 / kPi) / 4 * (3 * w.z * w.z - 1),
          mixed * w.x * w.z,
          mixed / 2 * (w.x * w.x - w.y * w.y)};
}

/// The integrals of cos(theta - gamma) sin(theta) Y_lm(theta), by Simpson's rule. tangent, eye: of the side.
std::array<double, kTransferPlanes> transfer_between(double from, double to, double gamma, Vector tangent, Vector eye) {
  const int parts = 2 * (1 + int(8 * (to - from)));
  const double width = (to - from) / parts;
  std::array<double, kTransferPlanes> sum{};
  for (int i = 0; i <= parts; i++) {
    const double theta = from + i * width;
    const double weight = simpson_weight(i, parts) * width / 3 * std::cos(theta - gamma) * std::sin(theta);
    const auto y = harmonics(std::sin(theta) * tangent + std::cos(theta) * eye);
    for (std::size_t k = 0; k < kTransferPlanes; k++) sum[k] += weight * y[k];
  }
  return sum;
}

/// The blocked angles of one side of a slice: disjoint, sorted intervals.
class Blocked {
 public:
  using Transfer = std::function<std::array<double, kTransferPlanes>(double from, double to)>;

  /// Without a transfer only arcs are integrated.
  Blocked(double gamma, const Transfer& transfer) : gamma_(gamma), transfer_(transfer) {}

  /// Blocks [from, to] and returns the integrals over the part of it that was open.
  Integrals add(double from, double to) {
    if (!(to > from)) return {};
    Integrals fresh = integrals(from, to);
    std::vector<std::pair<double, double>> kept;
    for (const auto& [a, b] : intervals_) {
      if (b < from || a > to) {
        kept.emplace_back(a, b);
        continue;
      }
      fresh = fresh - integrals(std::max(a, from), std::min(b, to));
      from = std::min(from, a);
      to = std::max(to, b);
    }
    kept.emplace_back(from, to);
    intervals_ = std::move(kept);
    return fresh;
  }

  bool holds(double angle) const {
    return std::ranges::any_of(intervals_,
                               [&](const auto& part) { return part.first <= angle && angle <= part.second; });
  }

 private:
  Integrals integrals(double from, double to) const {
    Integrals sum{arc(to, gamma_) - arc(from, gamma_)};
    if (transfer_) sum.transfer = transfer_(from, to);
    return sum;
  }

  double gamma_;
  const Transfer& transfer_;
  std::vector<std::pair<double, double>> intervals_;
};

double weight_of(const ReferenceSettings& settings, double distance) {
  if (settings.falloff == Falloff::none) return 1;
  const double start = settings.falloff_start * settings.radius;
  const double x = std::clamp((distance - start) / (settings.radius - start), 0.0, 1.0);
  if (settings.falloff == Falloff::linear) return 1 - x;
  if (settings.falloff == Falloff::quadratic) return 1 - x * x;
  return 1 - x * x * (3 - 2 * x);
}

/// The point where the line between two offsets, one within the radius and one beyond, leaves the sphere.
Vector crossing(Vector within, Vector beyond, double radius) {
  const Vector step = beyond - within;
  const double a = dot(step, step);
  const double b = dot(within, step);
  const double c = dot(within, within) - radius * radius;
  return within + ((std::sqrt(std::max(0.0, b * b - a * c)) - b) / a) * step;
}

/// The part of a solid within the sphere of the radius that lies behind one point of its front, on the eye's ray.
struct Depths {
  Vector begin, end;  // offsets from the receiver
};

/// The part of a solid behind a point of its front, which is `offset` away. Where the front is before the sphere, it
/// begins where the eye's ray enters the sphere, unless the solid ends before; what has no end is no solid there.
std::optional<Depths> depths_of(const Scene& scene, const Receiver& receiver, Vector offset, double thickness,
                                double radius) {
  const Vector position = receiver.position + offset;
  const Vector away = scene.orthographic() ? Vector{0, 0, -1} : normalized(position);
  const double middle = -dot(offset, away);
  const double outside = dot(offset, offset) - radius * radius;
  const double half = std::sqrt(std::max(0.0, middle * middle - outside));
  const double leaves = middle + half;
  // The ends of what the sphere has cut lie on it, but for rounding.
  if (outside < 1e-9 * radius * radius) return Depths{offset, offset + std::min(thickness, leaves) * away};
  const double enters = middle - half;
  if (half == 0 || enters < 0 || enters >= thickness || std::isinf(thickness)) return std::nullopt;
  return Depths{offset + enters * away, offset + std::min(thickness, leaves) * away};
}

/// The angles that a solid spans within the radius between two neighbouring samples of its front; empty (first >
/// second) if it lies outside.
std::pair<double, double> span_between(const Scene& scene, const Receiver& receiver, const Side& side, const Sample& a,
                                       const Sample& b, double radius) {
  const Vector from = a.position - receiver.position;
  const Vector to = b.position - receiver.position;
  const auto first = depths_of(scene, receiver, from, a.thickness, radius);
  const auto last = depths_of(scene, receiver, to, b.thickness, radius);
  if (!first && !last) return {1, 0};
  const bool from_within = length(from) < radius;
  const bool to_within = length(to) < radius;
  std::pair<double, double> span{INFINITY, -INFINITY};
  const auto add = [&](Vector offset) {
    const double angle = angle_of(side, offset);
    span = {std::min(span.first, angle), std::max(span.second, angle)};
  };
  if (first) add(first->begin);
  if (last) add(last->begin);
  if (from_within != to_within) add(from_within ? crossing(from, to, radius) : crossing(to, from, radius));
  return span;
}

/// The integrals over the blocked angles of a slice's side.
struct Arcs {
  Integrals seen;       // blocked by visible surfaces
  Integrals completed;  // blocked by completed surfaces alone
};

/// Computes the blocked angles of one side of a slice.
class Blocking {
 public:
  Blocking(const Scene& scene, const Receiver& receiver, const Side& side, const ReferenceSettings& settings,
           const Blocked::Transfer& transfer)
      : scene_(scene),
        receiver_(receiver),
        side_(side),
        settings_(settings),
        limit_(side.gamma + kPi / 2),
        lowest_(limit_ - std::asin(settings.bias)),
        blocked_(side.gamma, transfer) {}

  Arcs arcs() {
    const ReferenceLine line = line_of(scene_, receiver_, side_, settings_);
    Arcs arcs{by_samples(line), {}};
    for (const auto& [from, to] : line.closing) arcs.seen = arcs.seen + by_face(from, to);
    for (const auto& segment : completed_segments(scene_, receiver_, side_, line, settings_))
      arcs.completed = arcs.completed + by_segment(segment);
    return arcs;
  }

  /// Whether a direction is blocked.
  bool blocks(double angle) {
    arcs();
    return blocked_.holds(angle);
  }

 private:
  Integrals by_samples(const ReferenceLine& line) {
    Integrals sum;
    for (int i = line.surfaces; i < int(line.samples.size()); i++) {
      const Sample& sample = line[i];
      const Vector offset = sample.position - receiver_.position;
      const double distance = length(offset);
      if (sample.nearer >= line.surfaces) {
        const Sample& other = line[sample.nearer];
        const auto [low, high] = span_between(scene_, receiver_, side_, other, sample, settings_.radius);
        const double before = length(other.position - receiver_.position);
        const double weight = 0.5 * (weight_of(settings_, before) + weight_of(settings_, distance));
        if (low > 0 && low <= lowest_) sum = sum + weight * blocked_.add(low, std::min(high, limit_));
      }
      if (sample.depth == 0 || distance == 0) continue;
      const auto solid = depths_of(scene_, receiver_, offset, sample.thickness, settings_.radius);
      if (!solid) continue;
      const double front = angle_of(side_, solid->begin);
      if (front <= 0 || front >= lowest_) continue;
      sum = sum + weight_of(settings_, distance) * blocked_.add(front, back_of(*solid, front));
    }
    return sum;
  }

  /// The angle, as seen from the receiver, of the end of a solid.
  double back_of(const Depths& solid, double front) const {
    const double angle = angle_of(side_, solid.end);
    // An angle that wrapped round lies beyond the tangent plane. On the sphere, rounding may turn the end before the
    // front.
    return angle < 0 ? limit_ : std::min(std::max(angle, front), limit_);
  }

  /// Blocks a face without thickness.
  Integrals by_face(Vector from, Vector to) {
    const auto [first, last] = within(from, to - from, settings_.radius);
    const Vector begin = from + std::max(first, 0.0) * (to - from);
    const Vector end = from + std::min(last, 1.0) * (to - from);
    if (std::max(first, 0.0) >= std::min(last, 1.0)) return {};
    auto [low, high] = std::minmax({angle_of(side_, begin), angle_of(side_, end)});
    // It passes behind the receiver.
    if (high > low + kPi) low = std::exchange(high, limit_);
    if (high <= 0 || low >= lowest_) return {};
    const double weight = 0.5 * (weight_of(settings_, length(begin)) + weight_of(settings_, length(end)));
    return weight * blocked_.add(std::max(low, 0.0), std::min(high, limit_));
  }

  Integrals by_segment(const CompletedSegment& segment) {
    Integrals sum;
    Vector from = segment.nearer;
    const Vector along = segment.farther - segment.nearer;
    const int parts = int(std::ceil(
        std::clamp(kPartsOfDiameter * length(along) / (2 * settings_.radius), 1.0, double(kPartsOfDiameter))));
    for (int i = 1; i <= parts; i++) {
      const Vector to = segment.nearer + (double(i) / parts) * along;
      sum = sum + by_part(from, to, segment.thickness);
      from = to;
    }
    return sum;
  }

  /// Blocks a straight part: what it blocks is one interval of angles.
  Integrals by_part(Vector from, Vector to, double thickness) {
    double low = INFINITY, high = -INFINITY, back = 0, weight = 0;
    for (const Vector end : {from, to}) {
      const auto solid = depths_of(scene_, receiver_, end, thickness, settings_.radius);
      if (!solid) continue;
      const double front = angle_of(side_, solid->begin);
      low = std::min(low, front);
      high = std::max(high, front);
      back = std::max(back, back_of(*solid, front));
      weight += 0.5 * weight_of(settings_, length(end));
    }
    if (!(low > 0) || low >= lowest_ || high < low) return {};
    return weight * blocked_.add(low, std::max(back, std::min(high, limit_)));
  }

  const Scene& scene_;
  const Receiver& receiver_;
  const Side& side_;
  const ReferenceSettings& settings_;
  double limit_;   // the tangent plane
  double lowest_;  // the angle where blocking begins
  Blocked blocked_;
};

/// What the receiver's own surface blocks of the arcs of a slice's side.
struct OwnArcs {
  double inside = 0, outside = 0;
};

/// Follows the receiver's own surface along one side of a slice.
class OwnSurface {
 public:
  OwnSurface(const Scene& scene, const Receiver& receiver, const Side& side, const ReferenceSettings& settings)
      : scene_(scene), receiver_(receiver), side_(side), settings_(settings), limit_(side.gamma + kPi / 2) {}

  OwnArcs arcs() {
    const ReferenceLine line = line_of(scene_, receiver_, side_, settings_);
    int last = 0;
    for (int i = line[0].farther; i >= 0; last = i, i = line[i].farther) take(line[i].position - receiver_.position);
    if (!is_inside_) return arcs_;
    const int next = (line.step_of(last) + 1) * line.surfaces;
    if (next < int(line.samples.size()) && is_behind(line[last], line[next]))
      onward_ = scene_.orthographic() ? Vector{0, 0, -1} : normalized(line[last].position);
    else if (!falls(place_))
      return arcs_;
    block(
        angle_of(side_, crossing(place_, place_ + 2 * settings_.radius / length(onward_) * onward_, settings_.radius)),
        0.5 * (length(place_) + settings_.radius));
    return arcs_;
  }

 private:
  bool falls(Vector offset) const { return angle_of(side_, offset) > limit_ + std::asin(settings_.bias); }

  /// Whether what is seen beside the last sample lies behind it and below the receiver's plane.
  bool is_behind(const Sample& last, const Sample& next) const {
    if (next.depth > 0) return next.depth > last.depth && dot(receiver_.normal, next.position - receiver_.position) < 0;
    const Vector far = scene_.position(next.x, next.y, 1) - scene_.position(next.x, next.y, 0);
    return dot(receiver_.normal, scene_.orthographic() ? Vector{0, 0, -1} : far) < 0;
  }

  void take(Vector offset) {
    const double radius = settings_.radius, distance = length(offset);
    const bool is_within = distance < radius, was_within = length(place_) < radius;
    if (length(place_) > 0 && is_within != was_within && angle_of(side_, offset) < limit_ &&
        angle_of(side_, place_) < limit_)
      rise(angle_of(side_, was_within ? crossing(place_, offset, radius) : crossing(offset, place_, radius)), radius);
    if (is_within && angle_of(side_, offset) > 0) rise(angle_of(side_, offset), distance);
    if (is_inside_ && falls(offset))
      block(angle_of(side_, is_within ? offset : crossing(place_, offset, radius)),
            is_within ? distance : 0.5 * (length(place_) + radius));
    is_inside_ = is_inside_ && is_within;
    onward_ = offset - place_;
    place_ = offset;
  }

  void block(double angle, double distance) {
    const double low = std::max(low_.value_or(limit_), angle);
    arcs_.inside += weight_of(settings_, distance) * (arc(low_.value_or(limit_), side_.gamma) - arc(low, side_.gamma));
    low_ = low;
  }

  void rise(double angle, double distance) {
    const double high = std::min(high_.value_or(limit_ - std::asin(settings_.bias)), angle);
    if (high < limit_)
      arcs_.outside +=
          weight_of(settings_, distance) * (arc(high_.value_or(limit_), side_.gamma) - arc(high, side_.gamma));
    high_ = high;
  }

  const Scene& scene_;
  const Receiver& receiver_;
  const Side& side_;
  const ReferenceSettings& settings_;
  double limit_;                      // the tangent plane
  std::optional<double> low_, high_;  // the largest and smallest angle of the surface within the radius
  bool is_inside_ = true;             // so were all samples
  Vector place_, onward_;             // the last sample, and the way to it
  OwnArcs arcs_;
};

/// The side towards a unit vector across the eye's ray; none where the normal is nearly perpendicular to its slice.
std::optional<Side> side_along(const Scene& scene, const Receiver& receiver, Vector tangent, double radius) {
  const Vector v = receiver.eye, across = cross(tangent, v);
  const double n_t = dot(receiver.normal, tangent), n_v = dot(receiver.normal, v);
  const double weight = std::hypot(n_t, n_v);
  if (weight < 1e-9) return std::nullopt;
  const Vector shift = (dot(receiver.normal, across) / (weight * weight)) * across;
  // The image of the tangent at the receiver, and the distance along it at which the sphere of the radius ends.
  const double depth = receiver.depth;
  const double du = scene.orthographic() ? tangent.x : tangent.x + receiver.position.x / depth * tangent.z;
  const double dv = scene.orthographic() ? tangent.y : tangent.y + receiver.position.y / depth * tangent.z;
  const double px = du * scene.fx();
  const double py = -dv * scene.fy();
  const double pixels = std::max(std::abs(px), std::abs(py));
  double reach = radius * pixels;
  if (!scene.orthographic()) {
    const double sine = radius / length(receiver.position);
    const double cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
    const double forward = v.z * cosine - tangent.z * sine;
    reach = sine < 1 && forward > 0 ? sine * pixels / forward : INFINITY;
  }
  return Side{tangent, tangent + n_t * shift, v + n_v * shift, std::atan2(n_t, n_v), px / pixels, py / pixels, reach};
}

struct Openness {
  double visibility = 1;
  double completed = 0;                            // the visibility that completed surfaces take
  std::array<double, kTransferPlanes> transfer{};  // see reference_transfer()
  OwnArcs own;                                     // see reference_curvature()
};

/// What is asked for beside the visibility.
enum class Besides { nothing, transfer, curvature };

Openness openness(const Scene& scene, const Receiver& receiver, const ReferenceSettings& settings, Besides besides) {
  const bool with_transfer = besides == Besides::transfer;
  const Vector v = receiver.eye;
  const double a = 1 / (1 + v.z);
  const double b = -v.x * v.y * a;
  const Vector basis_x = {1 - v.x * v.x * a, b, -v.x};
  const Vector basis_y = {b, 1 - v.y * v.y * a, -v.y};
  double seen = 0;
  double completed = 0;
  double whole = 0;
  OwnArcs own;
  Integrals open;
  for (int s = 0; s < settings.slices; s++) {
    const double azimuth = kPi * (s + 0.5) / settings.slices;
    const Vector t = std::cos(azimuth) * basis_x + std::sin(azimuth) * basis_y;
    for (const int sign : {-1, 1}) {
      const Vector tangent = double(sign) * t;
      const auto found = side_along(scene, receiver, tangent, settings.radius);
      if (!found) continue;
      const Side& side = *found;
      const double weight = std::hypot(dot(receiver.normal, t), dot(receiver.normal, v));
      whole += weight * 0.5 * (std::cos(side.gamma) + (side.gamma + kPi / 2) * std::sin(side.gamma));
      if (besides == Besides::curvature) {
        const OwnArcs arcs = OwnSurface(scene, receiver, side, settings).arcs();
        own.inside += weight * arcs.inside;
        own.outside += weight * arcs.outside;
        continue;
      }
      Blocked::Transfer transfer;
      if (with_transfer)
        transfer = [&](double from, double to) { return transfer_between(from, to, side.gamma, tangent, v); };
      const Arcs blocked = Blocking(scene, receiver, side, settings, transfer).arcs();
      seen += weight * blocked.seen.arc;
      completed += weight * blocked.completed.arc;
      if (with_transfer)
        open = open + weight * (Integrals{0, transfer(0, side.gamma + kPi / 2)} - blocked.seen - blocked.completed);
    }
  }
  if (!(whole > 0)) return {};
  const double visibility = std::clamp(1 - (seen + completed) / whole, 0.0, 1.0);
  return {visibility, std::clamp(1 - seen / whole, 0.0, 1.0) - visibility, ((1 / whole) * open).transfer,
          OwnArcs{std::min(own.inside / whole, 1.0), std::min(own.outside / whole, 1.0)}};
}

}  // namespace

ReferenceSettings reference_settings_of(const EstimatorSettings& settings, bool with_hidden) {
  ReferenceSettings reference;
  reference.radius = *settings.radius * settings.falloff_end;
  reference.falloff = settings.falloff;
  reference.falloff_start = settings.falloff_start / settings.falloff_end;
  reference.thickness = settings.thickness == ThicknessKind::automatic  ? ThicknessRule::width
                        : settings.thickness == ThicknessKind::infinite ? ThicknessRule::infinite
                                                                        : ThicknessRule::constant;
  reference.thickness_length = settings.thickness_length;
  reference.bias = settings.bias;
  reference.complete = settings.complete;
  reference.hidden = settings.hidden;
  reference.separation = settings.separation.value_or(-1);
  // Width stands in for hidden surfaces. If these are known or guessed, half of it is nearer to ray tracing.
  if (settings.complete == Completion::all || (with_hidden && settings.hidden > 0)) {
    reference.width_share = 0.5;
    reference.width_pixels = 1;
  }
  return reference;
}

namespace {

/// Calls `take` with the index and the receiver of every pixel that was asked for and is not sky, from several threads.
void for_receivers(const HostFrame& frame, const ReferenceSettings& settings,
                   const std::function<void(std::size_t, const Scene&, const Receiver&)>& take) {
  const Scene scene(frame, settings.hidden, settings.separation);
  constexpr std::size_t kChunk = 64;  // pixels that a thread takes at a time
  const std::size_t total = settings.pixels.empty() ? frame.data.pixels() : settings.pixels.size();
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t first = next.fetch_add(kChunk); first < total; first = next.fetch_add(kChunk))
      for (std::size_t i = first; i < std::min(total, first + kChunk); i++) {
        const std::size_t index = settings.pixels.empty() ? i : settings.pixels[i];
        const int x = int(index % std::size_t(scene.width()));
        const int y = int(index / std::size_t(scene.width()));
        const double z = scene.depth(x, y);
        if (z == 0) continue;
        const Vector position = scene.position(x, y, z);
        const Vector eye = scene.toward_eye(position);
        take(index, scene, {x, y, z, position, eye, scene.normal(x, y, eye)});
      }
  };
  const int count = settings.threads > 0 ? settings.threads : int(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::jthread> threads;
  for (int i = 1; i < count; i++) threads.emplace_back(work);
  work();
  threads.clear();
}

/// The same with the openness.
void for_pixels(const HostFrame& frame, const ReferenceSettings& settings, Besides besides,
                const std::function<void(std::size_t, const Openness&)>& take) {
  for_receivers(frame, settings, [&](std::size_t index, const Scene& scene, const Receiver& receiver) {
    take(index, openness(scene, receiver, settings, besides));
  });
}

bool sees(const Scene& scene, const Receiver& receiver, const ReferenceSettings& settings, const ReferenceLight& light,
          double reach) {
  const Vector way = light.is_lamp ? light.at - receiver.position : light.at;
  const Vector direction = normalized(way), v = receiver.eye;
  if (dot(direction, receiver.normal) <= 0) return false;
  const double cosine = dot(direction, v), sine = length(direction - cosine * v);
  if (sine < 1e-4) return true;  // wherever the eye sees, too
  ReferenceSettings here = settings;
  here.size = size_of(settings);
  here.radius = light.is_lamp ? std::min(reach, length(way)) : reach;
  auto side = side_along(scene, receiver, (1 / sine) * (direction - cosine * v), here.radius);
  if (!side) return true;
  const Vector end = receiver.position + here.radius * direction;
  const auto [x, y] = scene.image_of(end);
  side->reach = scene.orthographic() || end.z < 0
                    ? std::max(std::abs(x - receiver.x - 0.5), std::abs(y - receiver.y - 0.5))
                    : INFINITY;
  const Blocked::Transfer none;
  return !Blocking(scene, receiver, *side, here, none).blocks(std::atan2(sine, cosine));
}

}  // namespace

std::vector<float> reference_shadow(const HostFrame& frame, const ReferenceSettings& settings,
                                    const ReferenceLight& light, double reach) {
  std::vector<float> seen(frame.data.pixels(), 1.0f);
  for_receivers(frame, settings, [&](std::size_t i, const Scene& scene, const Receiver& receiver) {
    seen[i] = sees(scene, receiver, settings, light, reach) ? 1.0f : 0.0f;
  });
  return seen;
}

std::vector<float> reference_ao(const HostFrame& frame, const ReferenceSettings& settings) {
  std::vector<float> ao(frame.data.pixels(), 1.0f);
  for_pixels(frame, settings, Besides::nothing,
             [&](std::size_t i, const Openness& open) { ao[i] = float(open.visibility); });
  return ao;
}

std::vector<float> reference_completed(const HostFrame& frame, const ReferenceSettings& settings) {
  std::vector<float> completed(frame.data.pixels(), 0.0f);
  for_pixels(frame, settings, Besides::nothing,
             [&](std::size_t i, const Openness& open) { completed[i] = float(open.completed); });
  return completed;
}

std::vector<float> reference_transfer(const HostFrame& frame, const ReferenceSettings& settings) {
  const std::size_t pixels = frame.data.pixels();
  std::vector<float> transfer(kTransferPlanes * pixels, 0.0f);
  for_pixels(frame, settings, Besides::transfer, [&](std::size_t i, const Openness& open) {
    for (std::size_t k = 0; k < kTransferPlanes; k++) transfer[i + k * pixels] = float(open.transfer[k]);
  });
  return transfer;
}

std::vector<float> reference_curvature(const HostFrame& frame, const ReferenceSettings& settings) {
  const std::size_t pixels = frame.data.pixels();
  std::vector<float> planes(2 * pixels, 0.0f);
  for_pixels(frame, settings, Besides::curvature, [&](std::size_t i, const Openness& open) {
    planes[i] = float(open.own.inside);
    planes[i + pixels] = float(open.own.outside);
  });
  return planes;
}

}  // namespace alcove
