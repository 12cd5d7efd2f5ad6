// The axes and their values.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/stability/cases.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>

#include "cli/options.h"
#include "tests/device.h"
#include "tests/program.h"

namespace alcove::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
constexpr double kRoomWidth = 4.5, kRoomDepth = 4.3;  // from the eye at 55 degrees
const Vec3 kTarget{1, 0, 0.6}, kTowards = unit({3.5, -1.5, 1.8});

EstimatorSettings preset(const std::string& name) {
  ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
  RunOptions options;
  parse_run_options({"--preset", name}, options);
  return options.settings.estimator;
}

/// One axis: its values, and how each changes a spec.
using Axis = std::vector<std::function<void(Spec&)>>;

template <class T>
Axis axis(T Spec::* member, const std::vector<T>& values) {
  Axis changes;
  for (const T value : values) changes.push_back([=](Spec& spec) { spec.*member = value; });
  return changes;
}

const std::vector<Axis>& axes() {
  using N = NormalDefect;
  static const Axis sizes = [] {
    Axis changes;
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 37}, {37, 1}, {3, 5}, {13, 31}, {47, 43}, {64, 48}, {16383, 1}, {1, 16383}})
      changes.push_back([=](Spec& spec) { spec.width = width, spec.height = height; });
    return changes;
  }();
  static const std::vector<Axis> all{
      axis(&Spec::scale, {1e-6, 1e-3, 1e3, 1e6, 1e9}),
      axis(&Spec::range, {1e2, 1e4, 1e6}),
      axis(&Spec::fov, {0.0, 0.5, 5.0, 90.0, 120.0, 150.0, 170.0}),
      axis(&Spec::shift, {-3.0, 0.4, 1.0}),
      axis(&Spec::aspect, {0.25, 0.5, 4.0}),
      axis(&Spec::radius, {1e-9, 1e-4, 0.01, 1.0, 10.0, 1e4, 1e9}),
      sizes,
      axis(&Spec::normals, {N::missing, N::grazing, N::axis, N::zero, N::nan, N::infinite, N::denormal, N::huge, N::backfacing, N::random}),
      axis(&Spec::depth, {DepthDefect::zero, DepthDefect::negative, DepthDefect::denormal, DepthDefect::infinite, DepthDefect::nan, DepthDefect::largest,
                          DepthDefect::near_plane, DepthDefect::any_bits}),
      axis(&Spec::storage, {Storage::half_float, Storage::bits_16, Storage::bits_24, Storage::bits_24_reversed, Storage::far_positions}),
      axis(&Spec::place, {Place::corner})};
  return all;
}

/// A corner, seen from so near that the radius holds the eye.
Rendering corner(int width, int height) {
  const Scene scene{{Plane{.point = {}, .normal = {0, 0, 1}}, Plane{.point = {}, .normal = {1, 0, 0}}, Plane{.point = {}, .normal = {0, 1, 0}}}};
  return render(scene, Shot::perspective({0.011, 0.012, 0.01}, {0.001, 0, 0}, 120, width, height));
}

void spoil(std::vector<float>& normal, std::size_t i, std::size_t pixels, NormalDefect defect, std::mt19937& random) {
  const auto set = [&](float x, float y, float z) { normal[i] = x, normal[i + pixels] = y, normal[i + 2 * pixels] = z; };
  std::normal_distribution<float> gauss;
  switch (defect) {
    case NormalDefect::none:
    case NormalDefect::missing:
      return;
    case NormalDefect::grazing: {  // 89.99 degrees from the optical axis
      const float turn = float(2 * std::numbers::pi) * float(random() % 360) / 360;
      return set(std::cos(turn), std::sin(turn), 1.7453e-4f);
    }
    case NormalDefect::axis:
      return random() % 2 ? set(1, 0, 0) : random() % 2 ? set(0, -1, 0) : set(0, 0, 1);
    case NormalDefect::zero:
      return set(0, -0.0f, 0);
    case NormalDefect::nan:
      return set(0, kNan, 1);
    case NormalDefect::infinite:
      return set(kInfinity, 0, random() % 2 ? -kInfinity : 1);
    case NormalDefect::denormal:
      return set(1e-41f, -1e-42f, 1e-40f);
    case NormalDefect::huge:
      return set(1e30f * gauss(random), 1e30f * gauss(random), 1e25f);
    case NormalDefect::backfacing:
      return set(-normal[i], -normal[i + pixels], -normal[i + 2 * pixels]);
    case NormalDefect::random:
      return set(gauss(random), gauss(random), gauss(random));
  }
}

float spoilt(float z, DepthDefect defect, std::mt19937& random) {
  switch (defect) {
    case DepthDefect::none: return z;
    case DepthDefect::zero: return random() % 2 ? 0.0f : -0.0f;
    case DepthDefect::negative: return -z;
    case DepthDefect::denormal: return 1e-40f;
    case DepthDefect::infinite: return random() % 2 ? kInfinity : -kInfinity;
    case DepthDefect::nan: return kNan;
    case DepthDefect::largest: return random() % 2 ? std::numeric_limits<float>::max() : 1e30f;
    case DepthDefect::near_plane: return 1e-4f * z;
    case DepthDefect::any_bits: return std::bit_cast<float>(std::uint32_t(random()));
  }
  return z;
}

/// Rounded to so many bits of mantissa.
double rounded(double x, int bits) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::round(std::ldexp(mantissa, bits)), exponent - bits);
}

HostFrame as_far_positions(HostFrame frame, double far) {
  frame.depth_kind = DepthKind::position;
  frame.position_space = PositionSpace::world;
  frame.camera.view_from_world = Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  frame.camera.view_from_world_offset = {-far, -far, -far};
  const std::size_t pixels = frame.data.pixels();
  std::vector<float> positions(3 * pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    const double z = frame.depth[i], scale = frame.camera.orthographic ? 1 : z;
    if (!(std::abs(z) < frame.sky)) continue;
    positions[i] = float(scale * (double(i % std::size_t(frame.data.width)) + 0.5 - frame.camera.cx) / frame.camera.fx + far);
    positions[i + pixels] = float(scale * (frame.camera.cy - double(i / std::size_t(frame.data.width)) - 0.5) / frame.camera.fy + far);
    positions[i + 2 * pixels] = float(far - z);
  }
  frame.depth = positions;
  return frame;
}

}  // namespace

EstimatorSettings with_radius(EstimatorSettings settings, double radius) {
  settings.radius = radius;
  settings.thickness_length = radius / 4;
  return settings;
}

std::vector<Variant> estimators() {
  EstimatorSettings plain = plain_settings();
  plain.slices = 3;
  plain.steps = 8;
  plain.samples = 64;  // so many that tiles are proved to be open
  std::vector<Variant> all;
  const auto add = [&](const char* name, Estimator estimator, ThicknessKind thickness, SliceSearch search) {
    EstimatorSettings settings = plain;
    settings.estimator = estimator;
    settings.thickness = thickness;
    settings.search = search;
    all.push_back({name, settings});
  };
  add("gtao", Estimator::gtao, ThicknessKind::automatic, SliceSearch::steps);
  add("gtao infinite", Estimator::gtao, ThicknessKind::infinite, SliceSearch::steps);
  add("gtao constant", Estimator::gtao, ThicknessKind::constant, SliceSearch::steps);
  add("gtao exact", Estimator::gtao, ThicknessKind::automatic, SliceSearch::exact);
  add("bitmask", Estimator::bitmask, ThicknessKind::automatic, SliceSearch::steps);
  add("hbao", Estimator::hbao, ThicknessKind::infinite, SliceSearch::steps);
  add("crytek", Estimator::crytek, ThicknessKind::infinite, SliceSearch::steps);
  return all;
}

std::vector<Variant> variants() {
  std::vector<Variant> all;
  std::vector<Variant> full = estimators();
  for (const auto& file : names_in(ALCOVE_SOURCE_DIR "/presets")) {
    const std::filesystem::path path(file);
    if (path.extension() == ".toml" && !file.starts_with("input/")) full.push_back({path.stem().string(), preset((path.parent_path() / path.stem()).string())});
  }
  for (const Resolution resolution : {Resolution::full, Resolution::half, Resolution::quarter})
    for (Variant variant : full) {
      variant.settings.resolution = resolution;
      if (resolution != Resolution::full) variant.name += resolution == Resolution::half ? ", half" : ", quarter";
      all.push_back(std::move(variant));
    }
  return all;
}

std::string to_string(const Spec& s) {
  return fmt::format("scale {:g} range {:g} fov {:g} shift {:g} aspect {:g} radius {:g} size {}x{} normals {} depth {} storage {} place {}", s.scale, s.range, s.fov,
                     s.shift, s.aspect, s.radius, s.width, s.height, int(s.normals), int(s.depth), int(s.storage), int(s.place));
}

std::vector<Spec> sweeps() {
  std::vector<Spec> specs{{}};
  for (const Axis& values : axes())
    for (const auto& change : values) change(specs.emplace_back());
  return specs;
}

Spec drawn(std::mt19937& random) {
  Spec spec;
  for (const Axis& values : axes()) {
    const std::size_t choice = random() % (2 * values.size());  // half of the axes as usual
    if (choice < values.size()) values[choice](spec);
  }
  return spec;
}

Rendering room(double fov, double aspect, double shift, int width, int height) {
  const Scene scene{{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
                     Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}, parallelogram({2, -1.5, 0.3}, {0.6, 0.2, 0.1}, {0, 0.9, 0})}};
  const double distance = fov > 0 ? 0.5 * kRoomWidth / std::tan(fov * std::numbers::pi / 360) : 10;
  const Vec3 eye = kTarget + distance * kTowards;
  Shot shot = fov > 0 ? Shot::perspective(eye, kTarget, fov, width, height) : Shot::orthographic(eye, kTarget, kRoomWidth, width, height);
  shot.camera.fy *= aspect;
  shot.camera.cx += shift * width;
  return render(scene, shot);
}

HostFrame stored(HostFrame frame, Storage storage, double room_depth) {
  if (storage == Storage::single_float) return frame;
  if (storage == Storage::far_positions) return as_far_positions(std::move(frame), 1e7 * room_depth);
  if (storage == Storage::half_float) {
    for (float& z : frame.depth) z = z < 65504 ? float(rounded(z, 11)) : kInfinity;
    frame.depth_is_half = true;
    return frame;
  }
  const double near = 0.1 * room_depth, far = 1000 * room_depth, steps = std::exp2(storage == Storage::bits_16 ? 16 : 24) - 1;
  const bool reversed = storage == Storage::bits_24_reversed;
  frame.depth_kind = DepthKind::device;
  frame.depth_range = {.near = near, .far = far, .reversed = reversed};
  for (float& z : frame.depth) {
    const double at = frame.camera.orthographic ? (z - near) / (far - near) : (1 / near - 1 / z) / (1 / near - 1 / far), value = std::clamp(reversed ? 1 - at : at, 0.0, 1.0);
    z = float(std::round(value * steps) / steps);
  }
  frame.depth_step = step_of(frame.depth);
  return frame;
}

Case made(const Spec& spec) {
  Rendering rendering = spec.place == Place::corner ? corner(spec.width, spec.height) : room(spec.fov, spec.aspect, spec.shift, spec.width, spec.height);
  HostFrame& frame = rendering.frame;
  const std::size_t pixels = frame.data.pixels();
  const double depth = spec.place == Place::corner ? 0.02 : length(rendering.shot.eye - kTarget), size = spec.place == Place::corner ? 0.02 : kRoomDepth;
  std::mt19937 random(1);
  frame.sky = 1e24;
  for (std::size_t i = 0; i < pixels; i++) {
    float& z = frame.depth[i];
    if (z >= kSky) z = spec.range > 1 ? float(depth * spec.range * spec.scale) : 1e25f;
    else z = float(z * spec.scale);
    if (i % 3 == 1) z = spoilt(z, spec.depth, random);
    if (i % 3 == 2) spoil(frame.normal, i, pixels, spec.normals, random);
  }
  if (frame.camera.orthographic) frame.camera.fx /= spec.scale, frame.camera.fy /= spec.scale;
  if (spec.normals == NormalDefect::missing) frame.normal.clear();
  return {stored(std::move(frame), spec.storage, depth * spec.scale), std::min(spec.radius * size * spec.scale, 1e18)};
}

}  // namespace alcove::test
