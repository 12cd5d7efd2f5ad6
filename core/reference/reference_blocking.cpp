// The CPU reference's slices about the view ray: every pixel along them, exact unions of blocked angles.
// SPDX-License-Identifier: BSD-3-Clause
//
// Written for reading, not for speed, and apart from the kernels: nothing but the formulas is shared.
#include "core/reference/reference_slice.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

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

/// The blocked angles of one side of a slice.
class Blocked {
 public:
  /// Blocks what is open of [from, to].
  void add(double from, double to, double weight, bool is_completed) {
    if (!(to > from)) return;
    std::pair<double, double> whole{from, to};
    std::vector<std::pair<double, double>> kept;
    for (const auto& [a, b] : intervals_) {
      if (b < whole.first || a > whole.second) {
        kept.emplace_back(a, b);
        continue;
      }
      if (a > from) parts_.push_back({from, a, weight, is_completed});
      from = std::max(from, b);
      whole = {std::min(whole.first, a), std::max(whole.second, b)};
    }
    if (to > from) parts_.push_back({from, to, weight, is_completed});
    kept.insert(std::ranges::upper_bound(kept, whole), whole);
    intervals_ = std::move(kept);
  }

  std::vector<BlockedPart> take_parts() { return std::move(parts_); }

 private:
  std::vector<BlockedPart> parts_;
  std::vector<std::pair<double, double>> intervals_;  // unions of parts, disjoint and sorted
};

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

/// Computes the blocked angles of one side of a slice.
class Blocking {
 public:
  Blocking(const Scene& scene, const Receiver& receiver, const Side& side, const ReferenceSettings& settings)
      : scene_(scene),
        receiver_(receiver),
        side_(side),
        settings_(settings),
        limit_(side.gamma + kPi / 2),
        lowest_(limit_ - std::asin(settings.bias)) {}

  std::vector<BlockedPart> parts() {
    const ReferenceLine line = line_of(scene_, receiver_, side_, settings_);
    add_samples(line);
    for (const auto& [from, to] : line.closing) add_face(from, to);
    for (const auto& segment : completed_segments(scene_, receiver_, side_, line, settings_)) add_segment(segment);
    return blocked_.take_parts();
  }

 private:
  double weight_at(double distance) const { return falloff_weight(settings_, distance); }

  void add_samples(const ReferenceLine& line) {
    for (int i = line.surfaces; i < int(line.samples.size()); i++) {
      const Sample& sample = line[i];
      const Vector offset = sample.position - receiver_.position;
      const double distance = length(offset);
      if (sample.nearer >= line.surfaces) {
        const Sample& other = line[sample.nearer];
        const auto [low, high] = span_between(scene_, receiver_, side_, other, sample, settings_.radius);
        const double before = length(other.position - receiver_.position);
        const double weight = 0.5 * (weight_at(before) + weight_at(distance));
        if (low > 0 && low <= lowest_) blocked_.add(low, std::min(high, limit_), weight, false);
      }
      if (sample.depth == 0 || distance == 0) continue;
      const auto solid = depths_of(scene_, receiver_, offset, sample.thickness, settings_.radius);
      if (!solid) continue;
      const double front = angle_of(side_, solid->begin);
      if (front <= 0 || front >= lowest_) continue;
      blocked_.add(front, back_of(*solid, front), weight_at(distance), false);
    }
  }

  /// The angle, as seen from the receiver, of the end of a solid.
  double back_of(const Depths& solid, double front) const {
    const double angle = angle_of(side_, solid.end);
    // An angle that wrapped round lies beyond the tangent plane. On the sphere, rounding may turn the end before the
    // front.
    return angle < 0 ? limit_ : std::min(std::max(angle, front), limit_);
  }

  /// Blocks a face without thickness.
  void add_face(Vector from, Vector to) {
    const auto [first, last] = within(from, to - from, settings_.radius);
    const Vector begin = from + std::max(first, 0.0) * (to - from);
    const Vector end = from + std::min(last, 1.0) * (to - from);
    if (std::max(first, 0.0) >= std::min(last, 1.0)) return;
    auto [low, high] = std::minmax({angle_of(side_, begin), angle_of(side_, end)});
    // It passes behind the receiver.
    if (high > low + kPi) low = std::exchange(high, limit_);
    if (high <= 0 || low >= lowest_) return;
    const double weight = 0.5 * (weight_at(length(begin)) + weight_at(length(end)));
    blocked_.add(std::max(low, 0.0), std::min(high, limit_), weight, false);
  }

  void add_segment(const CompletedSegment& segment) {
    Vector from = segment.nearer;
    const Vector along = segment.farther - segment.nearer;
    const int parts = int(std::ceil(
        std::clamp(kPartsOfDiameter * length(along) / (2 * settings_.radius), 1.0, double(kPartsOfDiameter))));
    for (int i = 1; i <= parts; i++) {
      const Vector to = segment.nearer + (double(i) / parts) * along;
      add_part(from, to, segment.thickness);
      from = to;
    }
  }

  /// Blocks a straight part: what it blocks is one interval of angles.
  void add_part(Vector from, Vector to, double thickness) {
    double low = INFINITY, high = -INFINITY, back = 0, weight = 0;
    for (const Vector end : {from, to}) {
      const auto solid = depths_of(scene_, receiver_, end, thickness, settings_.radius);
      if (!solid) continue;
      const double front = angle_of(side_, solid->begin);
      low = std::min(low, front);
      high = std::max(high, front);
      back = std::max(back, back_of(*solid, front));
      weight += 0.5 * weight_at(length(end));
    }
    if (!(low > 0) || low >= lowest_ || high < low) return;
    blocked_.add(low, std::max(back, std::min(high, limit_)), weight, true);
  }

  const Scene& scene_;
  const Receiver& receiver_;
  const Side& side_;
  const ReferenceSettings& settings_;
  double limit_;   // the tangent plane
  double lowest_;  // the angle where blocking begins
  Blocked blocked_;
};

}  // namespace

double arc_between(double from, double to, double gamma) {
  const auto from_0 = [&](double h) {
    return 0.25 * (std::cos(gamma) + 2 * h * std::sin(gamma) - std::cos(2 * h - gamma));
  };
  return from_0(to) - from_0(from);
}

double falloff_weight(Falloff falloff, double start, double end, double distance) {
  if (falloff == Falloff::none) return 1;
  const double x = std::clamp((distance - start) / (end - start), 0.0, 1.0);
  if (falloff == Falloff::linear) return 1 - x;
  if (falloff == Falloff::quadratic) return 1 - x * x;
  return 1 - x * x * (3 - 2 * x);
}

double falloff_weight(const ReferenceSettings& settings, double distance) {
  return falloff_weight(settings.falloff, settings.falloff_start * settings.radius, settings.radius, distance);
}

Vector crossing(Vector within, Vector beyond, double radius) {
  const Vector step = beyond - within;
  const double a = dot(step, step);
  const double b = dot(within, step);
  const double c = dot(within, within) - radius * radius;
  return within + ((std::sqrt(std::max(0.0, b * b - a * c)) - b) / a) * step;
}

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

double for_sides(const Scene& scene, const Receiver& receiver, const ReferenceSettings& settings,
                 const std::function<void(const Side&, double)>& take) {
  const Vector v = receiver.eye;
  const double a = 1 / (1 + v.z);
  const double b = -v.x * v.y * a;
  const Vector basis_x = {1 - v.x * v.x * a, b, -v.x};
  const Vector basis_y = {b, 1 - v.y * v.y * a, -v.y};
  double whole = 0;
  for (int s = 0; s < settings.slices; s++) {
    const double azimuth = kPi * (s + 0.5) / settings.slices;
    const Vector t = std::cos(azimuth) * basis_x + std::sin(azimuth) * basis_y;
    for (const int sign : {-1, 1}) {
      const auto side = side_along(scene, receiver, double(sign) * t, settings.radius);
      if (!side) continue;
      const double weight = std::hypot(dot(receiver.normal, t), dot(receiver.normal, v));
      whole += weight * arc_between(0, side->gamma + kPi / 2, side->gamma);
      take(*side, weight);
    }
  }
  return whole;
}

std::vector<BlockedPart> blocked_parts(const Scene& scene, const Receiver& receiver, const Side& side,
                                       const ReferenceSettings& settings) {
  return Blocking(scene, receiver, side, settings).parts();
}

BlockedShare blocked_share(const Scene& scene, const Receiver& receiver, const ReferenceSettings& settings) {
  BlockedShare share;
  const double whole = for_sides(scene, receiver, settings, [&](const Side& side, double weight) {
    for (const auto& part : blocked_parts(scene, receiver, side, settings))
      (part.is_completed ? share.completed : share.seen) +=
          weight * part.weight * arc_between(part.from, part.to, side.gamma);
  });
  if (!(whole > 0)) return {};
  return {share.seen / whole, share.completed / whole};
}

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
  const unsigned count = std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::jthread> threads;
  for (unsigned i = 1; i < count; i++) threads.emplace_back(work);
  work();
  threads.clear();
}

}  // namespace alcove
