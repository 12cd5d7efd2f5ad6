// The axes and their values.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bench/stability/cases.h"

#include "tests/support/command_line.h"
#include "tests/support/device.h"

namespace alcove::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
constexpr double kRoomWidth = 4.5, kRoomDepth = 4.3;  // from the eye at 55 degrees
const Vec3 kTarget{1, 0, 0.6}, kTowards = unit({3.5, -1.5, 1.8});

/// One axis: its values, and how each changes a spec.
using Axis = std::vector<std::function<void(Spec&)>>;

template <class T>
Axis axis(T Spec::*member, const std::vector<T>& values) {
  Axis changes;
  for (const T value : values) changes.push_back([=](Spec& spec) { spec.*member = value; });
  return changes;
}

const std::vector<Axis>& axes() {
  using N = NormalDefect;
  static const Axis sizes = [] {
    Axis changes;
    for (const auto& size :
         {std::pair{1, 1}, {1, 37}, {37, 1}, {3, 5}, {13, 31}, {47, 43}, {64, 48}, {16383, 1}, {1, 16383}, {16383, 2}})
      changes.push_back([=](Spec& spec) { spec.width = size.first, spec.height = size.second; });
    return changes;
  }();
  static const std::vector<Axis> all{
      axis(&Spec::scale, {1e-15, 1e-6, 1e-3, 1e3, 1e9, 1e15}),
      axis(&Spec::range, {1e2, 1e4, 1e6}),
      axis(&Spec::fov, {0.0, 0.5, 5.0, 90.0, 120.0, 150.0, 170.0}),
      axis(&Spec::shift, {-3.0, 0.4, 1.0}),
      axis(&Spec::aspect, {0.25, 0.5, 4.0}),
      axis(&Spec::radius, {1e-9, 1e-4, 0.01, 1.0, 10.0, 1e4, 1e9}),
      sizes,
      axis(&Spec::normals, {N::missing, N::grazing, N::axis, N::in_slice, N::across_slice, N::zero, N::nan, N::infinite,
                            N::denormal, N::huge, N::backfacing, N::random}),
      axis(&Spec::depth, {DepthDefect::zero, DepthDefect::negative, DepthDefect::denormal, DepthDefect::infinite,
                          DepthDefect::nan, DepthDefect::largest, DepthDefect::near_plane, DepthDefect::any_bits}),
      axis(&Spec::storage,
           {Storage::half_float, Storage::bits_16, Storage::bits_16_reversed, Storage::bits_24,
            Storage::bits_24_reversed, Storage::device, Storage::device_reversed, Storage::far_positions}),
      axis(&Spec::place, {Place::corner})};
  return all;
}

Rendering seen(const Scene& scene, Shot shot, double aspect, double shift) {
  shot.camera.fy *= aspect;
  shot.camera.cx += shift * shot.data.width;
  return render(scene, shot);
}

// of the eye from the corner; the usual radius over Spec::radius: the sphere holds the eye
constexpr double kCornerDepth = 0.018, kCornerReach = 0.2;

/// A corner between a floor, a high and a low wall, from so near.
Rendering corner(double fov, double aspect, double shift, int width, int height) {
  const Scene scene{{parallelogram({}, {0.1, 0, 0}, {0, 0.1, 0}), parallelogram({}, {0, 0.1, 0}, {0, 0, 0.05}),
                     parallelogram({}, {0.1, 0, 0}, {0, 0, 0.006})}};
  const Vec3 eye{0.011, 0.012, 0.01}, target{0.001, 0, 0};
  return seen(scene,
              fov > 0 ? Shot::perspective(eye, target, fov, width, height)
                      : Shot::orthographic(eye, target, kCornerDepth, width, height),
              aspect, shift);
}

/// A direction in the plane of one of three slices of a pixel (see pixel_noise() in kernels/base/noise.glsl), as many
/// degrees from the view ray; or across that plane.
Vec3 of_slice(const HostFrame& frame, std::size_t pixel, int slice, double degrees, bool across) {
  const double x = double(pixel % std::size_t(frame.data.width)), y = double(pixel / std::size_t(frame.data.width));
  const double jitter =
      std::fmod(0.5 + 0.75487766624669276 * std::fmod(x, 64) + 0.56984029099805327 * std::fmod(y, 64), 1.0);
  const double azimuth = std::numbers::pi * (slice + jitter) / 3, angle = degrees * std::numbers::pi / 180;
  const Camera& camera = frame.camera;
  const Vec3 v = camera.orthographic
                     ? Vec3{0, 0, 1}
                     : unit({-(x + 0.5 - camera.cx) / camera.fx, -(camera.cy - y - 0.5) / camera.fy, 1});
  const double a = 1 / (1 + v.z), b = -v.x * v.y * a;
  const Vec3 t =
      std::cos(azimuth) * Vec3{1 - v.x * v.x * a, b, -v.x} + std::sin(azimuth) * Vec3{b, 1 - v.y * v.y * a, -v.y};
  return across ? cross(t, v) : std::cos(angle) * v + std::sin(angle) * t;
}

void spoil(HostFrame& frame, std::size_t i, NormalDefect defect, std::mt19937& random) {
  const auto set = [&](float x, float y, float z) { put_normal(frame, i, {x, y, z}); };
  std::normal_distribution<float> gauss;
  switch (defect) {
    case NormalDefect::none:
    case NormalDefect::missing: return;
    case NormalDefect::grazing: {  // 89.99 degrees from the optical axis
      const float turn = float(2 * std::numbers::pi) * float(random() % 360) / 360;
      return set(std::cos(turn), std::sin(turn), 1.7453e-4f);
    }
    case NormalDefect::axis: return random() % 2 ? set(1, 0, 0) : random() % 2 ? set(0, -1, 0) : set(0, 0, 1);
    case NormalDefect::in_slice:
    case NormalDefect::across_slice: {
      const int slice = int(random() % 3), degrees = int(random() % 181) - 90;
      return put_normal(frame, i, of_slice(frame, i, slice, degrees, defect == NormalDefect::across_slice));
    }
    case NormalDefect::zero: return set(0, -0.0f, 0);
    case NormalDefect::nan: return set(0, kNan, 1);
    case NormalDefect::infinite: return set(kInfinity, 0, random() % 2 ? -kInfinity : 1);
    case NormalDefect::denormal: return set(1e-41f, -1e-42f, 1e-40f);
    case NormalDefect::huge: return set(1e30f * gauss(random), 1e30f * gauss(random), 1e25f);
    case NormalDefect::backfacing: return put_normal(frame, i, -normal_at(frame, i));
    case NormalDefect::random: return set(gauss(random), gauss(random), gauss(random));
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
    case DepthDefect::near_plane: return z < 1e24f ? 1e-4f * z : z;
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
  const Vec3 back = kTowards, right = unit(cross({0, 0, 1}, back)), up = cross(back, right), eye{far, far, -far};
  const auto row = [](Vec3 v) { return std::array{v.x, v.y, v.z}; };
  frame.depth_kind = DepthKind::position;
  frame.position_space = PositionSpace::world;
  frame.camera.view_from_world = Matrix3{row(right), row(up), row(back)};
  frame.camera.view_from_world_offset = {-dot(right, eye), -dot(up, eye), -dot(back, eye)};
  const std::size_t pixels = frame.data.pixels();
  std::vector<float> positions(3 * pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    const double z = frame.depth[i], scale = frame.camera.orthographic ? 1 : z;
    if (!(std::abs(z) < frame.sky)) continue;
    const double x = scale * (double(i % std::size_t(frame.data.width)) + 0.5 - frame.camera.cx) / frame.camera.fx;
    const double y = scale * (frame.camera.cy - double(i / std::size_t(frame.data.width)) - 0.5) / frame.camera.fy;
    const Vec3 at = eye + x * right + y * up - z * back;
    positions[i] = float(at.x);
    positions[i + pixels] = float(at.y);
    positions[i + 2 * pixels] = float(at.z);
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
  plain.samples = 64;
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
    const fs::path path(file);
    if (path.extension() == ".toml" && !file.starts_with("input/"))
      full.push_back({path.stem().string(), preset((path.parent_path() / path.stem()).string())});
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
  return fmt::format(
      "scale {:g} range {:g} fov {:g} shift {:g} aspect {:g} radius {:g} size {}x{} normals {} depth {} storage {} far "
      "{:g} place {}",
      s.scale, s.range, s.fov, s.shift, s.aspect, s.radius, s.width, s.height, int(s.normals), int(s.depth),
      int(s.storage), s.far, int(s.place));
}

std::vector<Spec> sweeps() {
  std::vector<Spec> specs{{}};
  for (const Axis& values : axes())
    for (const auto& change : values) change(specs.emplace_back());
  for (const Storage storage : {Storage::bits_16, Storage::bits_16_reversed, Storage::bits_24,
                                Storage::bits_24_reversed, Storage::device, Storage::device_reversed})
    specs.push_back({.depth = DepthDefect::near_plane, .storage = storage});
  for (const double fov : {0.0, 120.0}) specs.push_back({.fov = fov, .place = Place::corner});
  return specs;
}

Spec drawn(unsigned number) {
  Spec spec;
  std::mt19937 random(number / kRound);
  for (const Axis& values : axes()) {
    std::array<std::size_t, kRound> choices;
    for (std::size_t i = 0; i < kRound; i++)
      choices[i] = i < std::max<std::size_t>(kRound / 2, values.size()) ? i % values.size() : values.size();
    std::ranges::shuffle(choices, random);
    const std::size_t choice = choices[number % kRound];
    if (choice < values.size()) values[choice](spec);
  }
  return spec;
}

Rendering room(double fov, double aspect, double shift, int width, int height) {
  const double distance = fov > 0 ? 0.5 * kRoomWidth / std::tan(fov * std::numbers::pi / 360) : 10;
  const Vec3 eye = kTarget + distance * kTowards;
  return seen(kRoom,
              fov > 0 ? Shot::perspective(eye, kTarget, fov, width, height)
                      : Shot::orthographic(eye, kTarget, kRoomWidth, width, height),
              aspect, shift);
}

HostFrame stored(HostFrame frame, Storage storage, double room_depth, double far_positions) {
  if (storage == Storage::single_float) return frame;
  if (storage == Storage::far_positions) return as_far_positions(std::move(frame), far_positions * room_depth);
  if (storage == Storage::half_float) {
    for (float& z : frame.depth) z = z < 65504 ? float(rounded(z, 11)) : kInfinity;
    frame.depth_is_half = true;
    return frame;
  }
  const bool reversed = storage == Storage::bits_16_reversed || storage == Storage::bits_24_reversed ||
                        storage == Storage::device_reversed;
  const bool floats = storage == Storage::device || storage == Storage::device_reversed;
  const double near = 0.1 * room_depth, far = 1000 * room_depth,
               steps = std::exp2(storage == Storage::bits_16 || storage == Storage::bits_16_reversed ? 16 : 24) - 1;
  const float at_near = reversed ? 1 : 0;
  frame.depth_kind = DepthKind::device;
  frame.depth_range = {.near = near, .far = far, .reversed = reversed};
  for (float& z : frame.depth) {
    const double at = frame.camera.orthographic ? (z - near) / (far - near) : (1 / near - 1 / z) / (1 / near - 1 / far),
                 value = std::clamp(reversed ? 1 - at : at, 0.0, 1.0);
    const float kept = float(floats ? value : std::round(value * steps) / steps);
    const bool before_near = z > 0 && kept == at_near;
    z = !before_near ? kept : floats ? std::nextafter(at_near, 0.5f) : float(reversed ? 1 - 1 / steps : 1 / steps);
  }
  frame.depth_step = floats ? 0 : step_of(frame.depth);
  return frame;
}

Case made(const Spec& spec) {
  const bool in_corner = spec.place == Place::corner;
  Rendering rendering = (in_corner ? corner : room)(spec.fov, spec.aspect, spec.shift, spec.width, spec.height);
  HostFrame& frame = rendering.frame;
  const std::size_t pixels = frame.data.pixels();
  const double depth = in_corner ? kCornerDepth : length(rendering.shot.eye - kTarget),
               reach = in_corner ? kCornerReach : kRoomDepth;
  std::mt19937 random(1);
  frame.sky = 1e24;
  std::vector<bool> sky(pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    float& z = frame.depth[i];
    if (z >= kSky)
      z = spec.range > 1 ? float(depth * spec.range * spec.scale) : 1e25f;
    else
      z = float(z * spec.scale);
    if (i % 3 == 1) z = spoilt(z, spec.depth, random);
    if (i % 3 == 2) spoil(frame, i, spec.normals, random);
    sky[i] = !(z > 0 && z < frame.sky);
  }
  if (frame.camera.orthographic) {
    frame.camera.fx /= spec.scale;
    frame.camera.fy /= spec.scale;
  }
  if (spec.normals == NormalDefect::missing) frame.normal.clear();
  HostFrame kept = stored(std::move(frame), spec.storage, depth * spec.scale, spec.far);
  // So far out a depth of 0 or less cannot be told from others.
  for (std::size_t i = 0; i < pixels && spec.storage == Storage::far_positions; i++)
    sky[i] = kept.depth[i] == 0 && kept.depth[i + pixels] == 0 && kept.depth[i + 2 * pixels] == 0;
  return {std::move(kept), std::min(spec.radius * reach * spec.scale, 1e18), depth * spec.scale, std::move(sky)};
}

}  // namespace alcove::test
