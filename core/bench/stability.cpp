// A room and a step, seen in every extreme way; and the report as text, JSON and a page.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/stability.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/text.h"
#include "core/chain/compute.h"
#include "core/chain/estimate/estimate.h"
#include "core/frame/pixels/radius.h"
#include "core/measure/report.h"
#include "core/reference/reference.h"
#include "core/reference/reference_scene.h"

namespace alcove {
namespace {

constexpr int kWidth = 48, kHeight = 36;
// narrow: pixels as small as in a picture 1920 wide
constexpr double kRoomWidth = 4.5, kRadius = 0.65, kFov = 55, kNarrowFov = 1.5;
constexpr float kSky = 1e25f;
constexpr std::size_t kCompared = 3;  // every so many pixels

/// A frame, and the one that its reference is computed from: the same picture without what the axis does to it.
struct Trial {
  HostFrame exact, tried;
  double exact_radius = kRadius, radius = kRadius;  // scene units of each
  std::string picture;                              // a name for the exact frame
};

/// Gives the distance, in lengths of d, to the nearest of a floor, a wall and a ball; infinite where the ray hits none.
double hit_of(Vector o, Vector d, Vector& normal) {
  double nearest = std::numeric_limits<double>::infinity();
  const auto take = [&](double t, bool covers, Vector n) {
    if (!(t > 1e-9 && t < nearest && covers)) return;
    nearest = t;
    normal = n;
  };
  const double floor = -o.z / d.z, wall = -o.x / d.x;
  const Vector on_floor = o + floor * d, on_wall = o + wall * d;
  take(floor, on_floor.x >= 0 && on_floor.x <= 4 && std::abs(on_floor.y) <= 3, {0, 0, 1});
  take(wall, on_wall.z >= 0 && on_wall.z <= 1.5 && std::abs(on_wall.y) <= 3, {1, 0, 0});
  const Vector center{1.2, 0.4, 0.5}, off = o - center;
  const double a = dot(d, d), b = dot(off, d), inside = b * b - a * (dot(off, off) - 0.25);
  const double ball = (-b - std::sqrt(std::max(0.0, inside))) / a;
  take(ball, inside > 0, 2.0 * (off + ball * d));
  return nearest;
}

HostFrame empty_frame() {
  HostFrame frame;
  frame.data = frame.display = {0, 0, kWidth, kHeight};
  frame.camera.width = kWidth;
  frame.camera.height = kHeight;
  frame.camera.cx = 0.5 * kWidth;
  frame.camera.cy = 0.5 * kHeight;
  frame.sky = 1e24;
  frame.depth.assign(frame.data.pixels(), kSky);
  frame.normal.assign(3 * frame.data.pixels(), 0);
  return frame;
}

/// Sets one pixel of three planes that stand one behind the other.
void set_vector(std::vector<float>& planes, std::size_t i, Vector v) {
  const std::size_t pixels = planes.size() / 3;
  planes[i] = float(v.x);
  planes[i + pixels] = float(v.y);
  planes[i + 2 * pixels] = float(v.z);
}

void set_pixel(HostFrame& frame, std::size_t i, double z, Vector n) {
  frame.depth[i] = float(z);
  set_vector(frame.normal, i, n);
}

const Vector kTarget{1, 0, 0.6};

struct Axes {
  Vector right, up, back;
};
Axes axes_of_view() {
  const Vector back = normalized({3.5, -1.5, 1.8}), right = normalized(cross({0, 0, 1}, back));
  return {right, cross(back, right), back};
}
/// The view ray of a pixel, 1 long along the optical axis.
Vector ray_of(const Camera& camera, const Axes& view, std::size_t pixel) {
  const double x = (double(pixel % kWidth) + 0.5 - camera.cx) / camera.fx,
               y = (camera.cy - double(pixel / kWidth) - 0.5) / camera.fy;
  return x * view.right + y * view.up - view.back;
}
/// Gives the distance from which the room fills a picture of this field of view.
double distance_of(double fov) { return 0.5 * kRoomWidth / std::tan(fov * std::numbers::pi / 360); }

/// Renders the room from the distance where it fills a picture of this field of view.
HostFrame room(double fov) {
  HostFrame frame = empty_frame();
  frame.camera.fx = frame.camera.fy = 0.5 * kWidth / std::tan(fov * std::numbers::pi / 360);
  const Axes view = axes_of_view();
  const Vector eye = kTarget + distance_of(fov) * view.back;
  for (std::size_t i = 0; i < frame.data.pixels(); i++) {
    Vector n;
    const double z = hit_of(eye, ray_of(frame.camera, view, i), n);
    if (std::isfinite(z)) set_pixel(frame, i, z, {dot(n, view.right), dot(n, view.up), dot(n, view.back)});
  }
  return frame;
}

Trial trial(const std::string& picture, const HostFrame& frame, double radius) {
  return {frame, frame, radius, radius, picture};
}

Trial in_room(double fov, double radius = kRadius) { return trial(fmt::format("room {}", fov), room(fov), radius); }

Trial at_scale(double scale) {
  Trial made = in_room(kFov);
  for (float& z : made.tried.depth) z = z < kSky ? float(z * scale) : kSky;
  made.radius *= scale;
  return made;
}

Trial before_background(double range) {
  HostFrame frame = room(kFov);
  for (std::size_t i = 0; i < frame.depth.size(); i++)
    if (frame.depth[i] >= kSky) set_pixel(frame, i, distance_of(kFov) * 2 * range, {0, 0, 1});
  return trial(fmt::format("background {}", range), frame, kRadius);
}

/// A plane, parallel projection, tilted to the right; its right half is a step nearer. The radius is seen 8 pixels wide
/// along the tilt.
Trial tilted(double degrees) {
  HostFrame frame = empty_frame();
  const double cosine = std::cos(degrees * std::numbers::pi / 180), sine = std::sin(degrees * std::numbers::pi / 180),
               pixel = 0.1, radius = 8 * pixel / cosine;
  frame.camera.orthographic = true;
  frame.camera.fx = frame.camera.fy = 1 / pixel;
  for (std::size_t i = 0; i < frame.data.pixels(); i++) {
    const double x = (double(i % kWidth) + 0.5 - 0.5 * kWidth) * pixel;
    set_pixel(frame, i, (10 * radius) + x * sine / cosine - (x > 0 ? 0.4 * radius / std::max(cosine, 0.1) : 0),
              {sine, 0, cosine});
  }
  return trial(fmt::format("tilt {}", degrees), frame, radius);
}

/// Rounds to so many bits of mantissa.
double rounded(double x, int bits) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::round(std::ldexp(mantissa, bits)), exponent - bits);
}

Trial in_half(double fov) {
  Trial made = in_room(fov);
  for (float& z : made.tried.depth) z = z < 65504 ? float(rounded(z, 11)) : kSky;
  made.tried.depth_is_half = true;
  return made;
}

/// Stores the room as device depth of so many bits. The far plane is 10^5 times as far as the near plane, and the room
/// `over_near` times.
Trial in_bits(int bits, bool reversed, double over_near) {
  Trial made = in_room(kNarrowFov);
  const double near = distance_of(kNarrowFov) / over_near, far = 1e5 * near, steps = std::exp2(bits) - 1;
  HostFrame& frame = made.tried;
  frame.depth_kind = DepthKind::device;
  frame.depth_range = {.near = near, .far = far, .reversed = reversed};
  for (float& z : frame.depth) {
    const double at = std::min(1.0, (1 / near - 1 / z) / (1 / near - 1 / far)), value = reversed ? 1 - at : at;
    z = bits > 24 ? float(value) : float(std::round(value * steps) / steps);
  }
  frame.depth_step = step_of(frame.depth);
  return made;
}

/// Stores the room as world positions, so many room widths from the origin.
Trial far_out(double widths) {
  Trial made = in_room(kFov);
  HostFrame& frame = made.tried;
  const Axes view = axes_of_view();
  const Vector out = widths * kRoomWidth * normalized(view.right + 0.1 * view.up),
               eye = kTarget + distance_of(kFov) * view.back + out;
  frame.depth_kind = DepthKind::position;
  frame.position_space = PositionSpace::world;
  const auto row = [](Vector v) { return std::array{v.x, v.y, v.z}; };
  frame.camera.view_from_world = Matrix3{row(view.right), row(view.up), row(view.back)};
  frame.camera.view_from_world_offset = {-dot(view.right, eye), -dot(view.up, eye), -dot(view.back, eye)};
  frame.depth.assign(3 * frame.data.pixels(), 0);
  for (std::size_t i = 0; i < frame.data.pixels(); i++) {
    const double z = made.exact.depth[i];
    if (z >= kSky) continue;
    set_vector(frame.depth, i, eye + z * ray_of(frame.camera, view, i));
  }
  return made;
}

struct Axis {
  const char *name, *unit;
  double plain;  // the value of the plain room, or what is nearest to it
  std::vector<double> values;
  std::function<Trial(double)> make;
  bool logarithmic = true;
};

std::vector<Axis> all_axes() {
  const std::vector<double> over_near{3, 10, 30, 100, 300, 1e3, 3e3, 1e4};
  const double depth = distance_of(kFov), pixel = depth * 2 * std::tan(kFov * std::numbers::pi / 360) / kWidth;
  return {
      {"depth scale",
       "scene units per unit of the room",
       1,
       {1e-15, 1e-6, 1e-4, 1e-2, 1, 1e2, 1e4, 1e9, 1e15},
       at_scale},
      {"depth range", "farthest over nearest depth", 1, {1, 10, 1e2, 1e3, 1e4, 1e5, 1e6}, before_background},
      {"field of view",
       "degrees",
       kFov,
       {0.5, 2, 10, 30, kFov, 90, 120, 150, 170},
       [](double fov) { return in_room(fov); }},
      {"radius in the scene",
       "of the median depth",
       kRadius / depth,
       {1e-9, 1e-6, 1e-3, 1e-2, 0.05, 0.15, 0.5, 2, 10, 1e2, 1e4, 1e9},
       [=](double r) { return in_room(kFov, r * depth); }},
      {"radius in pixels",
       "px at the median depth",
       kRadius / pixel,
       {0.25, 0.5, 1, 1.5, 2, 3, 4, 6, 8, 16, 32, 64, 128},
       [=](double r) { return in_room(kFov, r * pixel); }},
      {"tilt of the surface", "degrees", 0, {0, 30, 60, 75, 80, 85, 88, 89, 89.9, 89.99}, tilted, false},
      {"half depth", "field of view of 48 pixels, degrees", kFov, {0.02, 0.05, 0.15, 0.5, 1.5, 5, 15, kFov}, in_half},
      {"16 bits of device depth", "median depth over near plane", 3, over_near,
       [](double x) { return in_bits(16, false, x); }},
      {"16 bits of reversed depth", "median depth over near plane", 3, over_near,
       [](double x) { return in_bits(16, true, x); }},
      {"24 bits of device depth", "median depth over near plane", 3, over_near,
       [](double x) { return in_bits(24, false, x); }},
      {"24 bits of reversed depth", "median depth over near plane", 3, over_near,
       [](double x) { return in_bits(24, true, x); }},
      {"float reversed depth", "median depth over near plane", 3, over_near,
       [](double x) { return in_bits(32, true, x); }},
      {"world offset", "widths of the room, of position files", 1, {1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7}, far_out}};
}

struct Candidate {
  std::string name;
  EstimatorSettings settings;
};

/// Every estimator, with so many samples that what error is left comes from the numbers.
std::vector<Candidate> candidates() {
  EstimatorSettings plain;
  plain.slices = 16;
  plain.steps = plain.samples = 64;
  plain.stride = 1;
  plain.denoise = Denoise::none;
  std::vector<Candidate> all;
  const auto add = [&](const char* name, Estimator estimator, ThicknessKind thickness,
                       SliceSearch search = SliceSearch::steps) {
    EstimatorSettings& settings = all.emplace_back(Candidate{name, plain}).settings;
    settings.estimator = estimator;
    settings.thickness = thickness;
    settings.search = search;
  };
  add("gtao", Estimator::gtao, ThicknessKind::automatic);
  add("gtao, infinite", Estimator::gtao, ThicknessKind::infinite);
  add("gtao, constant", Estimator::gtao, ThicknessKind::constant);
  add("gtao, exact", Estimator::gtao, ThicknessKind::automatic, SliceSearch::exact);
  add("bitmask", Estimator::bitmask, ThicknessKind::automatic);
  add("hbao", Estimator::hbao, ThicknessKind::infinite);
  add("crytek", Estimator::crytek, ThicknessKind::infinite);
  return all;
}

EstimatorSettings with(EstimatorSettings settings, double radius) {
  settings.radius = radius;
  settings.thickness_length = radius / 4;
  return settings;
}

class Bench {
 public:
  explicit Bench(gpu::Device& device) : gpu_(device) {}

  double rmse(const Trial& trial, const Candidate& candidate) {
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < trial.exact.depth.size(); i += kCompared)
      if (trial.exact.depth[i] < kSky) pixels.push_back(i);
    const auto& reference = reference_of(trial, candidate, pixels);
    const std::vector<float> ao = compute_ao(gpu_, trial.tried, with(candidate.settings, trial.radius)).ao;
    double sum = 0;
    for (const std::size_t i : pixels) sum += (ao[i] - reference[i]) * (ao[i] - reference[i]) / double(pixels.size());
    return std::sqrt(sum);
  }

  Notes notes(const Trial& trial) {
    DepthSample sample;
    const FrameInputs inputs = upload(gpu_, trial.tried);
    sample.add(inputs.view, inputs.depth_map, inputs.depth_precision, inputs[RawPlane::depth]->as<float>());
    return sample.notes(trial.radius, trial.radius, kWidth, kHeight);
  }

 private:
  /// Computes a reference once for all frames of one picture and all candidates of one definition.
  const std::vector<float>& reference_of(const Trial& trial, const Candidate& candidate,
                                         const std::vector<std::size_t>& pixels) {
    const EstimatorSettings settings = with(candidate.settings, trial.exact_radius);
    const bool by_slices = searches_slices(settings);
    auto& made = made_[fmt::format("{} {} {} {}", trial.picture, trial.exact_radius,
                                   by_slices ? -1 : int(settings.estimator), int(settings.thickness))];
    if (!made.empty()) return made;
    ReferenceSettings reference = reference_settings_of(settings);
    reference.pixels = pixels;
    return made = by_slices ? reference_ao(trial.exact, reference) : reference_estimate(trial.exact, settings, pixels);
  }

  gpu::Recorder gpu_;
  std::map<std::string, std::vector<float>> made_;
};

/// Gives the points that break down and are nearest to the plain room, one to each side of it at most.
std::vector<std::size_t> breaks_of(const std::vector<double>& rmse, std::size_t plain_point, double plain) {
  const auto breaks = [&](std::size_t i) { return !(rmse[i] <= plain + kBreakdown); };
  std::vector<std::size_t> places;
  std::size_t before = plain_point + 1, after = plain_point + 1;
  while (before > 0 && !breaks(before - 1)) before--;
  while (after < rmse.size() && !breaks(after)) after++;
  if (before > 0) places.push_back(before - 1);
  if (after < rmse.size()) places.push_back(after);
  return places;
}

/// Keeps the first value, the last, and others evenly between them.
std::vector<double> thinned(const std::vector<double>& values, std::size_t most) {
  if (values.size() <= most) return values;
  std::vector<double> some;
  for (std::size_t i = 0; i < most; i++) some.push_back(values[i * (values.size() - 1) / (most - 1)]);
  return some;
}

std::vector<Axis> axes_of(const StabilityPart& part) {
  std::vector<Axis> axes = all_axes();
  std::erase_if(axes, [&](const Axis& axis) {
    return !part.axes.empty() && std::ranges::find(part.axes, axis.name) == part.axes.end();
  });
  for (Axis& axis : axes) axis.values = thinned(axis.values, part.most_points);
  return axes;
}

}  // namespace

StabilityReport run_stability(gpu::Device& device, const std::function<void(const std::string&)>& say,
                              const StabilityPart& part) {
  StabilityReport report{device.info().name, {}, {}};
  Bench bench(device);
  const auto all = candidates();
  for (const auto& candidate : all) report.plain.emplace_back(candidate.name, bench.rmse(at_scale(1), candidate));
  for (const Axis& axis : axes_of(part)) {
    if (say) say(fmt::format("{}: {} points", axis.name, axis.values.size()));
    StabilityAxis& measured = report.axes.emplace_back(StabilityAxis{axis.name, axis.unit, {}, {}});
    for (const auto& candidate : all) measured.curves.push_back({candidate.name, {}, {}, false});
    for (const double value : axis.values) {
      const Trial trial = axis.make(value);
      measured.points.push_back({value, bench.notes(trial)});
      for (std::size_t c = 0; c < all.size(); c++) measured.curves[c].rmse.push_back(bench.rmse(trial, all[c]));
    }
    const auto nearest = std::ranges::min_element(axis.values, {}, [&](double value) {
      return axis.logarithmic ? std::abs(std::log(value / axis.plain)) : std::abs(value - axis.plain);
    });
    for (std::size_t c = 0; c < all.size(); c++) {
      StabilityCurve& curve = measured.curves[c];
      curve.breaks = breaks_of(curve.rmse, std::size_t(nearest - axis.values.begin()), report.plain[c].second);
      curve.said = std::ranges::all_of(curve.breaks, [&](std::size_t i) { return !measured.points[i].notes.empty(); });
    }
  }
  return report;
}

// Reports.

namespace {

using Json = nlohmann::ordered_json;

/// Where the curve breaks down: values of the axis.
std::string breaks_text(const StabilityAxis& axis, const StabilityCurve& curve) {
  if (curve.breaks.empty()) return "-";
  std::vector<std::string> places;
  for (const std::size_t i : curve.breaks) places.push_back(fmt::format("{:g}", axis.points[i].at));
  return fmt::format("{}, {}", fmt::join(places, ", "), curve.said ? "said" : "NOT said");
}

}  // namespace

std::string stability_text(const StabilityReport& report) {
  std::string text = fmt::format("{:<28} {:<16} {:>10} {}\n", "axis", "estimator", "worst", "breaks down at");
  for (const auto& axis : report.axes)
    for (const auto& curve : axis.curves)
      text += fmt::format("{:<28} {:<16} {:>10.4f} {}\n", axis.name, curve.estimator, std::ranges::max(curve.rmse),
                          breaks_text(axis, curve));
  return text;
}

std::string stability_json(const StabilityReport& report) {
  Json plain = Json::array(), axes = Json::array();
  for (const auto& [estimator, rmse] : report.plain) plain.push_back({{"estimator", estimator}, {"rmse", rmse}});
  for (const auto& axis : report.axes) {
    Json points = Json::array(), curves = Json::array();
    for (const auto& point : axis.points) points.push_back({{"at", point.at}, {"notes", texts_of(point.notes)}});
    for (const auto& curve : axis.curves) {
      Json breaks = Json::array();
      for (const std::size_t i : curve.breaks) breaks.push_back(axis.points[i].at);
      curves.push_back(
          {{"estimator", curve.estimator}, {"rmse", curve.rmse}, {"breaks_at", breaks}, {"said", curve.said}});
    }
    axes.push_back({{"name", axis.name}, {"unit", axis.unit}, {"points", points}, {"curves", curves}});
  }
  return json_text({{"device", report.device}, {"breakdown", kBreakdown}, {"plain", plain}, {"axes", axes}}, 1) + "\n";
}

std::string stability_page(const StabilityReport& report) {
  Json candidates = Json::array(), rows = Json::array();
  for (std::size_t c = 0; c < report.plain.size(); c++) {
    const auto& [estimator, rmse] = report.plain[c];
    std::string settings = "breaks down along";
    for (const auto& axis : report.axes) {
      const StabilityCurve& curve = axis.curves[c];
      if (!curve.breaks.empty()) settings += fmt::format(" {} at {};", axis.name, breaks_text(axis, curve));
      for (std::size_t i = 0; i < axis.points.size(); i++)
        rows.push_back({{"frame", fmt::format("{} {:g} {}", axis.name, axis.points[i].at, axis.unit)},
                        {"candidate", estimator},
                        {"rmse", curve.rmse[i]},
                        {"warnings", axis.points[i].notes.size()},
                        {"fails", std::ranges::find(curve.breaks, i) != curve.breaks.end()}});
    }
    candidates.push_back({{"name", estimator}, {"settings", settings}, {"rmse", rmse}});
  }
  return report_page(json_text({{"title", "stability"},
                                {"kind", "bench"},
                                {"device", report.device},
                                {"yardstick_ms", nullptr},
                                {"candidates", candidates},
                                {"rows", rows},
                                {"images", Json::array()}},
                               1));
}

}  // namespace alcove
