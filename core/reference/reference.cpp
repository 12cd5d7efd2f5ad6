// The CPU reference: slices about the view ray, every pixel along them, exact unions of blocked angles.
// SPDX-License-Identifier: BSD-3-Clause
//
// Written for reading, not for speed, and apart from the kernels: nothing but the formulas is shared.
#include "core/reference/reference.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <thread>

#include "core/reference/reference_scene.h"

namespace alcove {
namespace {

constexpr double kPi = std::numbers::pi;
/// Neighbours on a slice whose depth differs by less than this many pixels' worth of slope are one surface.
constexpr double kRunSlope = 8;

using Scene = ReferenceScene;

/// Integral of cos(theta - gamma) |sin(theta)| from 0 to h (Jimenez et al. 2016, equation 7).
double arc(double h, double gamma) {
  return 0.25 * (std::cos(gamma) + 2 * h * std::sin(gamma) - std::cos(2 * h - gamma));
}

/// The weight of Simpson's rule at the i-th of so many parts' ends.
double simpson_weight(int i, int parts) {
  if (i == 0 || i == parts) return 1;
  return i % 2 ? 4 : 2;
}

/// Integral of cos(theta - gamma) sin(theta) (sin(theta), cos(theta)) by Simpson's rule.
Vector bent_between(double from, double to, double gamma) {
  const int parts = 2 * (1 + int(8 * (to - from)));
  const double width = (to - from) / parts;
  Vector sum;
  for (int i = 0; i <= parts; i++) {
    const double theta = from + i * width;
    const double weight = simpson_weight(i, parts) * width / 3 * std::cos(theta - gamma) * std::sin(theta);
    sum = sum + weight * Vector{0, std::sin(theta), std::cos(theta)};
  }
  return sum;
}

/// The blocked angles of one side of a slice: disjoint, sorted intervals.
class Blocked {
 public:
  Blocked(double gamma, bool with_bent) : gamma_(gamma), with_bent_(with_bent) {}

  /// Blocks [from, to] and returns the integrals over what was open of it: the arc's, and the bent normal's along T and
  /// V.
  Vector add(double from, double to) {
    if (!(to > from)) return {};
    Vector fresh = integrals(from, to);
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

 private:
  Vector integrals(double from, double to) const {
    const Vector arcs{arc(to, gamma_) - arc(from, gamma_), 0, 0};
    return with_bent_ ? arcs + bent_between(from, to, gamma_) : arcs;
  }

  double gamma_;
  bool with_bent_;
  std::vector<std::pair<double, double>> intervals_;
};

/// One pixel on a slice's image line.
struct Sample {
  Vector position;
  double depth = 0;      // 0: sky
  double thickness = 0;  // scene units, infinite allowed
};

struct Receiver {
  int x, y;
  double depth;
  Vector position, eye, normal;
};

/// One side of a slice at a receiver.
struct Side {
  Vector along_t, along_v;  // in-slice coordinates of an offset, moved into the slice parallel to the tangent plane
  double gamma;
  double step_x, step_y;  // pixels per step; the longer component is +-1
  double reach;           // steps within the radius; infinite when the sphere of the radius holds the eye
};

double weight_of(const ReferenceSettings& settings, double distance) {
  if (settings.falloff == Falloff::none) return 1;
  const double start = settings.falloff_start * settings.radius;
  const double x = std::clamp((distance - start) / (settings.radius - start), 0.0, 1.0);
  if (settings.falloff == Falloff::linear) return 1 - x;
  if (settings.falloff == Falloff::quadratic) return 1 - x * x;
  return 1 - x * x * (3 - 2 * x);
}

bool same_surface(const Scene& scene, const Sample& a, const Sample& b) {
  if (a.depth == 0 || b.depth == 0) return false;
  const double pixel = scene.orthographic() ? 1 / scene.fx() : std::min(a.depth, b.depth) / scene.fx();
  return std::abs(a.depth - b.depth) < kRunSlope * pixel;
}

/// The samples of a side, the receiver first. With runs to be measured the line goes on until the last run within reach
/// has ended.
std::vector<Sample> line_of(const Scene& scene, const Receiver& receiver, const Side& side,
                            const ReferenceSettings& settings) {
  std::vector<Sample> line = {{receiver.position, receiver.depth, 0}};
  std::size_t run_start = 0;
  for (int k = 1;; k++) {
    const int x = receiver.x + int(std::lround(side.step_x * k));
    const int y = receiver.y + int(std::lround(side.step_y * k));
    if (!scene.inside(x, y)) break;
    Sample sample;
    sample.depth = scene.depth(x, y);
    sample.position = scene.position(x, y, sample.depth);
    const bool same = same_surface(scene, line.back(), sample);
    if (!same) run_start = line.size();
    // Beyond the reach a sample matters only as the other end of a crossing and as more of a run's width; a run wider
    // than the sphere is wide enough.
    if (k > side.reach + 1 && (settings.thickness != ThicknessRule::width || !same ||
                               length(sample.position - line[run_start].position) > 2 * settings.radius))
      break;
    line.push_back(sample);
  }
  return line;
}

void set_thickness(const Scene& scene, std::vector<Sample>& line, const ReferenceSettings& settings) {
  if (settings.thickness != ThicknessRule::width) {
    const double value = settings.thickness == ThicknessRule::infinite ? INFINITY : settings.thickness_length;
    for (auto& sample : line) sample.thickness = value;
    return;
  }
  for (std::size_t first = 0; first < line.size();) {
    std::size_t last = first;
    while (last + 1 < line.size() && same_surface(scene, line[last], line[last + 1])) last++;
    // From outer edge to outer edge: n pixels are n wide, and their centres n - 1 apart. Without it single blades of
    // grass vanish.
    const double pixel = scene.orthographic() ? 1 / scene.fx() : line[first].depth / scene.fx();
    const double chord = first == 0 ? INFINITY : length(line[last].position - line[first].position) + pixel;
    for (std::size_t i = first; i <= last; i++) line[i].thickness = chord;
    first = last + 1;
  }
}

/// The angle of an offset from the view ray, in the slice; negative on the other side.
double angle_of(const Side& side, Vector offset) {
  return std::atan2(dot(offset, side.along_t), dot(offset, side.along_v));
}

/// Where the line between two offsets, one within the radius and one beyond, leaves the sphere.
Vector crossing(Vector within, Vector beyond, double radius) {
  const Vector step = beyond - within;
  const double a = dot(step, step);
  const double b = dot(within, step);
  const double c = dot(within, within) - radius * radius;
  return within + ((std::sqrt(std::max(0.0, b * b - a * c)) - b) / a) * step;
}

/// The angles that the surface between two neighbouring samples spans, as far as it lies within the radius; empty
/// (first > second) where it does not.
std::pair<double, double> span_between(const Scene& scene, const Receiver& receiver, const Side& side, const Sample& a,
                                       const Sample& b, double radius) {
  Vector from = a.position - receiver.position;
  Vector to = b.position - receiver.position;
  const bool from_within = length(from) < radius;
  const bool to_within = length(to) < radius;
  if (!same_surface(scene, a, b) || (!from_within && !to_within)) return {1, 0};
  if (!to_within) to = crossing(from, to, radius);
  if (!from_within) from = crossing(to, from, radius);
  return std::minmax({angle_of(side, from), angle_of(side, to)});
}

Vector blocked_arcs(const Scene& scene, const Receiver& receiver, const Side& side, const ReferenceSettings& settings,
                    bool with_bent) {
  auto line = line_of(scene, receiver, side, settings);
  set_thickness(scene, line, settings);
  // the tangent plane; and where blocking begins
  const double limit = side.gamma + kPi / 2;
  const double lowest = limit - std::asin(settings.bias);
  Blocked blocked(side.gamma, with_bent);
  Vector sum;
  for (std::size_t i = 1; i < line.size(); i++) {
    const Vector offset = line[i].position - receiver.position;
    const double distance = length(offset);
    if (i > 1) {
      const auto [low, high] = span_between(scene, receiver, side, line[i - 1], line[i], settings.radius);
      const double before = length(line[i - 1].position - receiver.position);
      const double weight = 0.5 * (weight_of(settings, before) + weight_of(settings, distance));
      if (low > 0 && low <= lowest) sum = sum + weight * blocked.add(low, std::min(high, limit));
    }
    if (line[i].depth == 0 || distance >= settings.radius || distance == 0) continue;
    const double front = angle_of(side, offset);
    if (front <= 0 || front >= lowest) continue;
    // What is behind the surface, as seen from the eye, blocks too, as far as it is thick and within the sphere of the
    // radius.
    const Vector away = scene.orthographic() ? Vector{0, 0, -1} : normalized(line[i].position);
    const double along = dot(offset, away);
    const double exit =
        -along + std::sqrt(std::max(0.0, along * along - distance * distance + settings.radius * settings.radius));
    const double angle = angle_of(side, offset + std::min(line[i].thickness, exit) * away);
    // an angle that wrapped round is beyond the tangent plane
    const double back = angle < front ? limit : std::min(angle, limit);
    sum = sum + weight_of(settings, distance) * blocked.add(front, back);
  }
  return sum;
}

struct Openness {
  double visibility = 1;
  Vector bent;  // the mean open direction
};

Openness openness(const Scene& scene, const Receiver& receiver, const ReferenceSettings& settings, bool with_bent) {
  const Vector v = receiver.eye;
  const double a = 1 / (1 + v.z);
  const double b = -v.x * v.y * a;
  const Vector basis_x = {1 - v.x * v.x * a, b, -v.x};
  const Vector basis_y = {b, 1 - v.y * v.y * a, -v.y};
  double sum = 0;
  double whole = 0;
  Vector bent;
  for (int s = 0; s < settings.slices; s++) {
    const double azimuth = kPi * (s + 0.5) / settings.slices;
    const Vector t = std::cos(azimuth) * basis_x + std::sin(azimuth) * basis_y;
    const Vector across = cross(t, v);
    const double n_t = dot(receiver.normal, t);
    const double n_v = dot(receiver.normal, v);
    const double n_b = dot(receiver.normal, across);
    const double weight = std::hypot(n_t, n_v);
    if (weight < 1e-9) continue;
    const double gamma = std::atan2(n_t, n_v);
    whole += weight * (std::cos(gamma) + gamma * std::sin(gamma));
    const Vector shift = (n_b / (weight * weight)) * across;
    for (const int sign : {-1, 1}) {
      const Vector tangent = double(sign) * t;
      // The image of the tangent at the receiver, and how far along it the sphere of the radius is seen.
      const double depth = receiver.depth;
      const double du = scene.orthographic() ? tangent.x : tangent.x + receiver.position.x / depth * tangent.z;
      const double dv = scene.orthographic() ? tangent.y : tangent.y + receiver.position.y / depth * tangent.z;
      const double px = du * scene.fx();
      const double py = -dv * scene.fy();
      const double pixels = std::max(std::abs(px), std::abs(py));
      double reach = settings.radius * pixels;
      if (!scene.orthographic()) {
        const double sine = settings.radius / length(receiver.position);
        const double cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
        const double forward = v.z * cosine - tangent.z * sine;
        reach = sine < 1 && forward > 0 ? sine * pixels / forward : INFINITY;
      }
      const Side side{
          tangent + double(sign) * n_t * shift, v + n_v * shift, sign * gamma, px / pixels, py / pixels, reach};
      const Vector blocked = blocked_arcs(scene, receiver, side, settings, with_bent);
      sum += weight * blocked.x;
      if (with_bent) {
        const double end = side.gamma + kPi / 2;
        const Vector open = bent_between(0, end, side.gamma) - blocked;
        bent = bent + weight * (open.y * tangent + open.z * v);
      }
    }
  }
  return whole > 0 ? Openness{std::clamp(1 - sum / whole, 0.0, 1.0), (1 / whole) * bent} : Openness{};
}

}  // namespace

ReferenceSettings reference_settings_of(const EstimatorSettings& settings) {
  ReferenceSettings reference;
  reference.radius = *settings.radius * settings.falloff_end;
  reference.falloff = settings.falloff;
  reference.falloff_start = settings.falloff_start / settings.falloff_end;
  reference.thickness = settings.thickness == ThicknessKind::automatic  ? ThicknessRule::width
                        : settings.thickness == ThicknessKind::infinite ? ThicknessRule::infinite
                                                                        : ThicknessRule::constant;
  reference.thickness_length = settings.thickness_length;
  reference.bias = settings.bias;
  return reference;
}

namespace {

/// Calls `take` with the index and the openness of every pixel that was asked for and is no sky, from several threads.
void for_pixels(const HostFrame& frame, const ReferenceSettings& settings, bool with_bent,
                const std::function<void(std::size_t, const Openness&)>& take) {
  const Scene scene(frame);
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
        take(index, openness(scene, {x, y, z, position, eye, scene.normal(x, y, eye)}, settings, with_bent));
      }
  };
  const int count = settings.threads > 0 ? settings.threads : int(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::jthread> threads;
  for (int i = 1; i < count; i++) threads.emplace_back(work);
  work();
  threads.clear();
}

}  // namespace

std::vector<float> reference_ao(const HostFrame& frame, const ReferenceSettings& settings) {
  std::vector<float> ao(frame.data.pixels(), 1.0f);
  for_pixels(frame, settings, false, [&](std::size_t i, const Openness& open) { ao[i] = float(open.visibility); });
  return ao;
}

std::vector<float> reference_bent(const HostFrame& frame, const ReferenceSettings& settings) {
  const std::size_t pixels = frame.data.pixels();
  std::vector<float> bent(3 * pixels, 0.0f);
  for_pixels(frame, settings, true, [&](std::size_t i, const Openness& open) {
    bent[i] = float(open.bent.x), bent[i + pixels] = float(open.bent.y), bent[i + 2 * pixels] = float(open.bent.z);
  });
  return bent;
}

}  // namespace alcove
