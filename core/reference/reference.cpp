// The visibility by slices, the open part of each pixel's hemisphere; and the definitions of HBAO and of Crytek's
// estimator, followed to the letter.
// SPDX-License-Identifier: BSD-3-Clause
//
// Written for reading, not for speed, and apart from the kernels: nothing but the formulas is shared.
#include "core/reference/reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/reference/reference_slice.h"

namespace alcove {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kDirections = 64;          // on the image, for hbao
constexpr int kDirectionsOfKernel = 64;  // of the hemisphere, for each length of crytek's kernel

using Receiver = ReferenceReceiver;

double smooth(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double attenuation(const EstimatorSettings& settings, double distance) {
  return falloff_weight(settings.falloff, settings.falloff_start * *settings.radius,
                        settings.falloff_end * *settings.radius, distance);
}

/// The distance in pixels, along a direction of the image, at which the sphere of the radius ends.
double reach_of(const ReferenceScene& scene, const Receiver& receiver, Vector t, double radius) {
  const double distance = length(receiver.position);
  const double sine = radius / distance;
  if (!scene.orthographic() && sine >= 1) return INFINITY;  // it holds the eye
  const Vector edge = scene.orthographic() ? receiver.position + radius * t
                                           : distance * (sine * t - std::sqrt(1 - sine * sine) * receiver.eye);
  if (!scene.orthographic() && edge.z >= 0) return INFINITY;
  const auto [x, y] = scene.image_of(edge);
  return std::max(std::abs(x - receiver.x - 0.5), std::abs(y - receiver.y - 0.5));
}

/// The attenuated sin h - sin t in the slice of the view ray and t, over every pixel of its image.
double hbao_side(const ReferenceScene& scene, const Receiver& receiver, Vector t, const EstimatorSettings& settings) {
  const Vector v = receiver.eye;
  const Vector b = cross(t, v);
  const Vector n = receiver.normal;
  const double n_t = dot(n, t);
  const double n_v = dot(n, v);
  const double weight = std::hypot(n_t, n_v);
  if (weight < 1e-9) return 0;
  const auto [x, y] = scene.image_of(receiver.position + 1e-6 * length(receiver.position) * t);
  const double dx = x - receiver.x - 0.5;
  const double dy = y - receiver.y - 0.5;
  const double scale = 1 / std::max(std::abs(dx), std::abs(dy));
  const double reach = reach_of(scene, receiver, t, *settings.radius);
  const double tangent = -std::atan2(n_t, n_v);  // the surface's elevation above the plane across the view ray
  double horizon =
      settings.elevation == Elevation::surface ? settings.bias : std::sin(tangent + std::asin(settings.bias));
  double sum = 0;
  for (int k = 1; k <= reach; k++) {
    const int px = receiver.x + int(std::lround(k * scale * dx));
    const int py = receiver.y + int(std::lround(k * scale * dy));
    if (!scene.inside(px, py)) break;
    const double z = scene.depth(px, py);
    if (z == 0) continue;
    const Vector offset = scene.position(px, py, z) - receiver.position;
    // A pixel's centre lies beside the slice, so it is moved into it along the tangent plane.
    const Vector moved =
        offset + dot(offset, b) * (dot(n, b) / (weight * weight) * (n_t * t + n_v * v)) - dot(offset, b) * b;
    const double along = dot(moved, t);
    const double height = dot(moved, n);
    if (along <= 0 || height < 1e-3 * length(offset)) continue;
    const double elevation =
        settings.elevation == Elevation::surface ? height / length(moved) : dot(moved, v) / length(moved);
    if (elevation <= horizon) continue;
    sum += attenuation(settings, length(offset)) * (elevation - horizon);
    horizon = elevation;
  }
  return sum;
}

double hbao_ao(const ReferenceScene& scene, const Receiver& receiver, const EstimatorSettings& settings) {
  double sum = 0;
  double whole = 0;
  for (int i = 0; i < kDirections; i++) {
    const double angle = 2 * kPi * (i + 0.5) / kDirections;
    const Vector direction{std::cos(angle), std::sin(angle), 0};
    const double toward = dot(direction, receiver.eye);
    const double share = 1 / (1 - toward * toward);
    sum += share * hbao_side(scene, receiver, normalized(direction - toward * receiver.eye), settings);
    whole += share;
  }
  return 1 - sum / whole;
}

double range_weight(const EstimatorSettings& settings, double dz) {
  if (settings.range_check == RangeCheck::none || dz == 0) return 1;
  return settings.range_check == RangeCheck::ratio ? smooth(*settings.radius / std::abs(dz))
                                                   : 1 - smooth(std::abs(dz) / *settings.radius);
}

double crytek_ao(const ReferenceScene& scene, const Receiver& receiver, const EstimatorSettings& settings) {
  const Vector n = receiver.normal;
  const Vector x = normalized(cross(std::abs(n.x) < 0.9 ? Vector{1, 0, 0} : Vector{0, 1, 0}, n));
  const Vector y = cross(n, x);
  const double z = -receiver.position.z;
  double hidden = 0;
  int valid = 0;
  const int count = settings.samples * kDirectionsOfKernel;
  for (int i = 0; i < count; i++) {
    // Random directions and lengths, well spread: the three-dimensional R sequence.
    const auto random = [&](double step) { return std::fmod(0.5 + i * step, 1.0); };
    const double up = random(0.81917251339616444);
    const double azimuth = 2 * kPi * random(0.67104360670378920);
    const double u = random(0.54970047790197026);
    const double part = double(i / kDirectionsOfKernel) / settings.samples;
    const double reach =
        *settings.radius *
        (settings.sample_kernel == SampleKernel::uniform ? std::cbrt(u) : u * (0.1 + 0.9 * part * part));
    const Vector offset = reach * (std::sqrt(1 - up * up) * (std::cos(azimuth) * x + std::sin(azimuth) * y) + up * n);
    const Vector sample = receiver.position + offset;
    if (!scene.orthographic() && sample.z >= 0) continue;
    const auto [image_x, image_y] = scene.image_of(sample);
    const double floor_x = std::floor(image_x);
    const double floor_y = std::floor(image_y);
    if (!(floor_x >= 0 && floor_x < scene.width() && floor_y >= 0 && floor_y < scene.height())) continue;
    const int px = int(floor_x);
    const int py = int(floor_y);
    const double hit_z = scene.depth(px, py);
    if (hit_z == 0) continue;
    valid++;
    const Vector hit = scene.position(px, py, hit_z);
    const Vector ray = scene.position(px, py, 1) - scene.position(px, py, 0);
    // The point on the pixel's ray that is as high above the surface as the sample.
    const double slope = -dot(n, ray);
    const double hit_height = dot(n, hit - receiver.position);
    const double on_ray = slope > 1e-4
                              ? std::min(hit_z + (hit_height - dot(n, offset)) / slope, -sample.z + *settings.radius)
                              : -sample.z;
    if (hit_height > 1e-3 * length(hit - receiver.position) && on_ray - hit_z > settings.bias)
      hidden += range_weight(settings, hit_z - z);
  }
  return valid > 0 ? 1 - hidden / valid : 1;
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

std::vector<float> reference_ao(const HostFrame& frame, const ReferenceSettings& settings) {
  std::vector<float> ao(frame.data.pixels(), 1.0f);
  for_receivers(frame, settings, [&](std::size_t i, const ReferenceScene& scene, const ReferenceReceiver& receiver) {
    const BlockedShare blocked = blocked_share(scene, receiver, settings);
    ao[i] = float(std::clamp(1 - (blocked.seen + blocked.completed), 0.0, 1.0));
  });
  return ao;
}

std::vector<float> reference_estimate(const HostFrame& frame, const EstimatorSettings& settings,
                                      const std::vector<std::size_t>& pixels) {
  if (settings.estimator == Estimator::bitmask)
    fail(ErrorKind::usage, "--estimator bitmask: its reference is reference_ao()");
  ReferenceSettings reference = reference_settings_of(settings);
  reference.pixels = pixels;
  std::vector<float> ao(frame.data.pixels(), 1.0f);
  if (settings.estimator == Estimator::gtao) {
    reference.slices = kDirections / 2;
    ao = reference_ao(frame, reference);
  } else {
    reference.hidden = 0;
    const auto estimate = settings.estimator == Estimator::hbao ? hbao_ao : crytek_ao;
    for_receivers(frame, reference, [&](std::size_t i, const ReferenceScene& scene, const Receiver& receiver) {
      ao[i] = float(std::clamp(estimate(scene, receiver, settings), 0.0, 1.0));
    });
  }
  for (float& value : ao) value = float(std::pow(std::max(0.0, 1 - settings.intensity * (1 - value)), settings.power));
  return ao;
}

}  // namespace alcove
