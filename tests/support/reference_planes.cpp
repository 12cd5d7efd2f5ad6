// Each is an integral over what the reference finds in its slices, or beside them.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/reference_planes.h"

#include "core/reference/reference_slice.h"
#include "tests/support/chain.h"

namespace alcove::test {
namespace {

/// What the receiver's own surface blocks of the arcs of a slice's side.
struct OwnArcs {
  double inside = 0, outside = 0;
};

/// Follows the receiver's own surface along one side of a slice.
class OwnSurface {
 public:
  OwnSurface(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
             const ReferenceSettings& settings)
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
  bool is_behind(const ReferenceSample& last, const ReferenceSample& next) const {
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
    arcs_.inside += falloff_weight(settings_, distance) * arc_between(low, low_.value_or(limit_), side_.gamma);
    low_ = low;
  }

  void rise(double angle, double distance) {
    const double high = std::min(high_.value_or(limit_ - std::asin(settings_.bias)), angle);
    if (high < limit_)
      arcs_.outside += falloff_weight(settings_, distance) * arc_between(high, high_.value_or(limit_), side_.gamma);
    high_ = high;
  }

  const ReferenceScene& scene_;
  const ReferenceReceiver& receiver_;
  const ReferenceSide& side_;
  const ReferenceSettings& settings_;
  double limit_;                      // the tangent plane
  std::optional<double> low_, high_;  // the largest and smallest angle of the surface within the radius
  bool is_inside_ = true;             // so were all samples
  Vector place_, onward_;             // the last sample, and the way to it
  OwnArcs arcs_;
};

bool sees(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSettings& settings,
          const ReferenceLight& light, double reach) {
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
  const double angle = std::atan2(sine, cosine);
  return std::ranges::none_of(blocked_parts(scene, receiver, *side, here),
                              [&](const BlockedPart& part) { return part.from <= angle && angle <= part.to; });
}

/// The weight of Simpson's rule at the i-th end of `parts` parts.
double simpson_weight(int i, int parts) {
  if (i == 0 || i == parts) return 1;
  return i % 2 ? 4 : 2;
}

/// The integrals of cos(theta - gamma) sin(theta) Y_lm(theta), by Simpson's rule. tangent, eye: of the side.
Transfer transfer_between(double from, double to, double gamma, Vector tangent, Vector eye) {
  const int parts = 2 * (1 + int(8 * (to - from)));
  const double width = (to - from) / parts;
  Transfer sum{};
  for (int i = 0; i <= parts; i++) {
    const double theta = from + i * width;
    const double weight = simpson_weight(i, parts) * width / 3 * std::cos(theta - gamma) * std::sin(theta);
    const Vector w = std::sin(theta) * tangent + std::cos(theta) * eye;
    const Transfer y = harmonics({w.x, w.y, w.z});
    for (std::size_t k = 0; k < kTransferPlanes; k++) sum[k] += weight * y[k];
  }
  return sum;
}

}  // namespace

std::vector<float> reference_completed(const HostFrame& frame, const ReferenceSettings& settings) {
  std::vector<float> completed(frame.data.pixels(), 0.0f);
  for_receivers(frame, settings, [&](std::size_t i, const ReferenceScene& scene, const ReferenceReceiver& receiver) {
    const BlockedShare blocked = blocked_share(scene, receiver, settings);
    completed[i] =
        float(std::clamp(1 - blocked.seen, 0.0, 1.0) - std::clamp(1 - (blocked.seen + blocked.completed), 0.0, 1.0));
  });
  return completed;
}

std::vector<float> reference_shadow(const HostFrame& frame, const ReferenceSettings& settings,
                                    const ReferenceLight& light, double reach) {
  std::vector<float> seen(frame.data.pixels(), 1.0f);
  for_receivers(frame, settings, [&](std::size_t i, const ReferenceScene& scene, const ReferenceReceiver& receiver) {
    seen[i] = sees(scene, receiver, settings, light, reach) ? 1.0f : 0.0f;
  });
  return seen;
}

Transfer harmonics(Vec3 w) {
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

std::vector<float> reference_transfer(const HostFrame& frame, const ReferenceSettings& settings) {
  const std::size_t pixels = frame.data.pixels();
  std::vector<float> planes(kTransferPlanes * pixels, 0.0f);
  for_receivers(frame, settings, [&](std::size_t i, const ReferenceScene& scene, const ReferenceReceiver& receiver) {
    Transfer open{};
    const double whole = for_sides(scene, receiver, settings, [&](const ReferenceSide& side, double weight) {
      const auto add = [&](double from, double to, double times) {
        const Transfer part = transfer_between(from, to, side.gamma, side.tangent, receiver.eye);
        for (std::size_t k = 0; k < kTransferPlanes; k++) open[k] += times * part[k];
      };
      add(0, side.gamma + kPi / 2, weight);
      for (const auto& part : blocked_parts(scene, receiver, side, settings))
        add(part.from, part.to, -weight * part.weight);
    });
    for (std::size_t k = 0; k < kTransferPlanes && whole > 0; k++) planes[i + k * pixels] = float(open[k] / whole);
  });
  return planes;
}

std::vector<float> reference_curvature(const HostFrame& frame, const ReferenceSettings& settings) {
  const std::size_t pixels = frame.data.pixels();
  std::vector<float> planes(2 * pixels, 0.0f);
  for_receivers(frame, settings, [&](std::size_t i, const ReferenceScene& scene, const ReferenceReceiver& receiver) {
    OwnArcs own;
    const double whole = for_sides(scene, receiver, settings, [&](const ReferenceSide& side, double weight) {
      const OwnArcs arcs = OwnSurface(scene, receiver, side, settings).arcs();
      own.inside += weight * arcs.inside;
      own.outside += weight * arcs.outside;
    });
    if (!(whole > 0)) return;
    planes[i] = float(std::min(own.inside / whole, 1.0));
    planes[i + pixels] = float(std::min(own.outside / whole, 1.0));
  });
  return planes;
}

}  // namespace alcove::test
