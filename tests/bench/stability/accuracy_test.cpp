// How far each estimator is from its reference in double precision, and that this grows no faster than the depth's own
// precision explains.
// SPDX-License-Identifier: BSD-3-Clause
//
// The bound. A depth that is off by d turns the direction to a sample one pixel aside by no more than d / p, p the
// width of a pixel there; both the sample's and the receiver's depth may be off, and visibility changes by no more than
// the angle: 2 d / p. Farther samples turn less. So the RMSE is at most the root mean square of min(1, 2 d / p), what
// the drawn samples leave (kSampling, that of exact depth), and what a sphere of few pixels leaves to chance: whether
// the one next pixel is within it (kFewPixels p / R; not of crytek, which looks at no next pixel). A bound above the
// reference's own occlusion is none: an AO that is 1 everywhere would pass. Where depth is to show that it is precise
// enough, such bounds are refused.
//
// All of it holds with and without completed surfaces. Only what goes on beyond the picture's border do kernels see by
// a few samples, and the reference at every step. Where most of the sphere is beyond the border, a bound of its own
// says how far they may differ.

#include "core/chain/compute.h"
#include "core/chain/estimate/estimate.h"
#include "core/reference/reference.h"
#include "tests/bench/stability/cases.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::accuracy_test {
namespace {

using namespace test;

/// Of 16 slices with a sample at every pixel, or 64 samples. With a constant thickness gtao takes the receiver's own
/// surface for endless, and its reference does not. With the automatic one a search by samples has other rules of how
/// far back solids go than its reference, and than the exact search: see docs/completion.md.
const std::map<std::string, double> kSampling{{"gtao", 0.055},      {"gtao infinite", 0.015}, {"gtao constant", 0.055},
                                              {"gtao exact", 0.02}, {"bitmask", 0.055},       {"hbao", 0.03},
                                              {"crytek", 0.035}};
constexpr double kFewPixels = 0.2;

/// Made once for all storages of a spec and estimators that are meant to compute the same.
const std::vector<float>& reference_of(const Spec& spec, const HostFrame& frame, const EstimatorSettings& settings,
                                       const std::vector<std::size_t>& pixels) {
  static std::map<std::string, std::vector<float>> made;
  const bool by_slices = settings.estimator == Estimator::gtao || settings.estimator == Estimator::bitmask;
  auto& ao = made[fmt::format("{} {} {} {}", to_string(spec), by_slices ? 0 : int(settings.estimator),
                              int(settings.thickness), by_slices ? int(settings.complete) : 0)];
  if (!ao.empty()) return ao;
  if (!by_slices) return ao = reference_estimate(frame, settings, pixels);
  ReferenceSettings reference = reference_settings_of(settings);
  reference.pixels = pixels;
  return ao = reference_ao(frame, reference);
}

/// How far depth may be off: half a step of its storage; of positions twice a float's half step of their distance from
/// the origin (see depth_precision()).
double step_at(const Spec& spec, double z, double room_depth) {
  const double near = 0.1 * room_depth, far = 1000 * room_depth, slope = z * z * (1 / near - 1 / far);
  switch (spec.storage) {
    case Storage::single_float:
    case Storage::device_reversed: return z * 0x1p-24;
    case Storage::half_float: return z * 0x1p-11;
    case Storage::bits_16:
    case Storage::bits_16_reversed: return slope * 0x1p-17;
    case Storage::bits_24:
    case Storage::bits_24_reversed:
    case Storage::device: return slope * 0x1p-25;
    case Storage::far_positions: return 2 * std::sqrt(3) * spec.far * room_depth * 0x1p-24;
  }
  return 0;
}

struct Measured {
  std::string estimator;
  Completion complete;
  double rmse, bound;
  double occlusion;  // RMS, of the reference: the error of an AO that is 1 everywhere
};

/// With each change half of the estimators, the other half with another completion. beyond: the least bound, before
/// that of the depth's precision, of what completes surfaces.
std::vector<Measured> measured(Spec spec, Completion complete, double beyond = 0) {
  spec.width = 48;
  spec.height = 36;
  Spec clean = spec;
  clean.storage = Storage::single_float;
  const Case exact = made(clean), tried = made(spec);
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < exact.frame.depth.size(); i += 5)
    if (!exact.sky[i]) pixels.push_back(i);
  EXPECT_GT(pixels.size(), 100u) << to_string(spec);
  std::vector<Measured> all;
  int turn = int(std::hash<std::string>()(to_string(spec)) % 2) + (complete == Completion::all);
  for (const auto& variant : estimators()) {
    if (!test::tried(turn++, 2)) continue;
    EstimatorSettings settings = with_radius(variant.settings, exact.radius);
    settings.complete = complete;
    settings.slices = 16;
    settings.steps = 64;
    settings.samples = 64;
    const std::vector<float>&reference = reference_of(clean, exact.frame, settings, pixels),
          ao = compute_ao(recorder(), tried.frame, settings).ao;
    double sum = 0, turned = 0, few = 0, occlusion = 0;
    for (const std::size_t i : pixels) {
      const double z = exact.frame.depth[i];
      const double pixel = (exact.frame.camera.orthographic ? 1 : z) / exact.frame.camera.fx,
                   highest = pixel * std::max(1.0, exact.frame.camera.fx / exact.frame.camera.fy);
      sum += std::pow(ao[i] - reference[i], 2);
      occlusion += std::pow(1 - reference[i], 2);
      turned += std::pow(std::min(1.0, 2 * step_at(spec, z, exact.depth) / pixel), 2);
      if (settings.estimator != Estimator::crytek) few += std::pow(kFewPixels * highest / exact.radius, 2);
    }
    const auto mean = [&](double squares) { return std::sqrt(squares / double(pixels.size())); };
    double sampling = kSampling.at(variant.name);
    if (completes_anywhere(settings)) sampling = std::max(sampling, beyond);
    all.push_back({variant.name, complete, mean(sum), sampling + mean(turned) + mean(few), mean(occlusion)});
    testing::Test::RecordProperty(fmt::format("{}, completion {}, {}", variant.name, int(complete), to_string(spec)),
                                  std::to_string(mean(sum)));
  }
  return all;
}

constexpr Completion kCompletions[] = {Completion::none, Completion::all};

/// But for an estimator whose reference knows less, or too few samples.
void expect(const Spec& spec, const std::string& without = "", double beyond = 0) {
  for (const Completion completion : kCompletions)
    for (const auto& [estimator, complete, rmse, bound, occlusion] : measured(spec, completion, beyond))
      if (estimator != without)
        EXPECT_LE(rmse, bound) << estimator << ", completion " << int(complete) << ": " << to_string(spec);
}

/// That depth so stored is precise enough, at a radius that darkens much.
void expect_precise(Spec spec) {
  spec.radius = 0.5;
  for (const Completion completion : kCompletions)
    for (const auto& [estimator, complete, rmse, bound, occlusion] : measured(spec, completion)) {
      EXPECT_LE(rmse, bound) << estimator << ", completion " << int(complete) << ": " << to_string(spec);
      EXPECT_LT(bound, occlusion) << estimator << ", whose bound says nothing: " << to_string(spec);
    }
}

TEST(Accuracy, of_the_room) { expect({}); }

// The picture's border cuts all spheres. The worst that was measured where surfaces are completed is 0.0355.
TEST(Accuracy, of_a_corner_whose_sphere_holds_the_eye) {
  for (const double fov : {0.0, 55.0, 120.0}) expect({.fov = fov, .place = Place::corner}, "", 0.034);
}

TEST(Accuracy, at_every_scale) {
  for (const double scale : {1e-15, 1e-6, 1e3, 1e9, 1e15}) expect({.scale = scale});
}

TEST(Accuracy, before_a_background_a_million_times_as_far) {
  for (const double range : {1e2, 1e4, 1e6}) expect({.range = range});
}

TEST(Accuracy, at_every_field_of_view) {
  for (const double fov : {0.0, 0.5, 5.0, 90.0, 120.0, 150.0, 170.0}) expect({.fov = fov});
}

TEST(Accuracy, through_shifted_lenses_and_oblong_pixels) {
  for (const double aspect : {0.25, 0.5, 4.0}) expect({.aspect = aspect});
  expect({.shift = 0.4});
}

// In a sphere far beyond the picture few of Crytek's samples are seen, and all that goes on beyond the border counts:
// the worst that was measured is 0.0388.
TEST(Accuracy, at_every_radius_of_pixels) {
  for (const double radius : {0.05, 0.1, 0.5}) expect({.radius = radius});
  expect({.radius = 1}, "", 0.034);
  expect({.radius = 10}, "crytek", 0.039);
}

TEST(Accuracy, below_a_pixel_all_is_open) {
  for (const double radius : {1e-9, 0.005}) {
    const Case made = test::made({.radius = radius, .width = 48, .height = 36});
    for (const auto& variant : variants()) {
      const Difference d = difference(compute_ao(recorder(), made.frame, with_radius(variant.settings, made.radius)).ao,
                                      [](std::size_t) { return 1.0; });
      EXPECT_LE(d.max, 1e-6) << variant.name << " " << radius << " " << place(d, made.frame);
    }
  }
}

TEST(Accuracy, about_normals_that_are_not_the_surfaces) {
  for (const NormalDefect normals : {NormalDefect::grazing, NormalDefect::axis, NormalDefect::in_slice,
                                     NormalDefect::across_slice, NormalDefect::backfacing, NormalDefect::random})
    expect({.normals = normals}, "gtao constant");
}

TEST(Accuracy, beside_depths_that_are_none_or_next_to_the_eye) {
  for (const DepthDefect depth :
       {DepthDefect::zero, DepthDefect::negative, DepthDefect::infinite, DepthDefect::nan, DepthDefect::largest})
    expect({.depth = depth});
  expect({.depth = DepthDefect::near_plane}, "crytek");  // whose sphere holds the eye: few of its samples are seen
}

TEST(Accuracy, of_depth_stored_with_few_bits) {
  int number = 0;
  for (const double fov : {40.0, 55.0, 90.0})
    if (tried(number++, 2)) expect_precise({.fov = fov, .storage = Storage::half_float});
  for (const Storage storage : {Storage::bits_16, Storage::bits_16_reversed})
    for (const double fov : {8.0, 15.0, 55.0})
      if (tried(number++, 2)) expect_precise({.fov = fov, .storage = storage});
  for (const Storage storage : {Storage::bits_24, Storage::bits_24_reversed, Storage::device, Storage::device_reversed})
    for (const double fov : {1.5, 55.0}) expect_precise({.fov = fov, .storage = storage});
}

TEST(Accuracy, of_positions_1e7_units_from_their_origin) {
  for (const double far : {1e2, 1e3, 3e3})
    expect_precise({.scale = 1e7 / far, .storage = Storage::far_positions, .far = far});
}

// At 1.5 degrees pixels are as small as in a picture 1920 wide, and a bound from the nearest of them says nothing.
// These are measured.
TEST(Accuracy, of_few_bits_and_small_pixels_is_better_than_its_bound) {
  for (const Completion completion : kCompletions)
    for (const Storage storage : {Storage::half_float, Storage::bits_16, Storage::bits_16_reversed})
      for (const auto& [estimator, complete, rmse, bound, occlusion] :
           measured({.fov = 1.5, .storage = storage}, completion))
        EXPECT_LE(rmse, estimator == "gtao constant"                    ? 0.08
                        : estimator == "gtao" || estimator == "bitmask" ? 0.062
                        : storage == Storage::half_float                ? 0.055
                                                                        : 0.035)
            << estimator << " storage " << int(storage) << " completion " << int(complete);
}

// That it is lost is noted: see scale_notes_test.
TEST(Accuracy, of_positions_too_far_off_to_tell_any_height_feigns_nothing) {
  for (const Completion completion : kCompletions)
    for (const auto& [estimator, complete, rmse, bound, occlusion] :
         measured({.storage = Storage::far_positions}, completion))
      EXPECT_NEAR(rmse, occlusion, 1e-6) << estimator << ", completion " << int(complete);
}

}  // namespace
}  // namespace alcove::accuracy_test
