// HBAO and Crytek's estimator against expected values of their own, whose derivations stand beside the tests, and
// against slow versions of themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"
#include "core/reference/reference.h"
#include "tests/support/chain.h"

namespace alcove::estimator_test {
namespace {

using namespace test;

/// The floor z = 0, and a block of that height without end in y that covers x < 0.
Scene block(double height) {
  return {{Plane{.point = {}, .normal = {0, 0, 1}}, parallelogram({0, -100, 0}, {0, 200, 0}, {0, 0, height}),
           parallelogram({0, -100, height}, {0, 200, 0}, {-100, 0, 0})}};
}

/// A parallel view of the floor about (0.5, 0, 0), `units` wide, that leans from its normal towards x by an angle. The
/// block's edge is upright in the picture at a `turn` of 0, and turns with it.
Shot leaning(double tilt_degrees, double units, int width, int height, double turn_degrees = 0) {
  const double tilt = tilt_degrees * std::numbers::pi / 180, turn = turn_degrees * std::numbers::pi / 180;
  const Vec3 target{0.5, 0, 0}, right{std::cos(tilt), 0, -std::sin(tilt)}, up{0, 1, 0};
  Shot shot = Shot::orthographic(target + 60 * Vec3{std::sin(tilt), 0, std::cos(tilt)}, target, units, width, height);
  shot.right = std::cos(turn) * right + std::sin(turn) * up;
  shot.up = std::cos(turn) * up - std::sin(turn) * right;
  return shot;
}

EstimatorSettings hbao(double radius, int slices = 16, int steps = 128) {
  return sampled(Estimator::hbao, radius, slices, steps);
}

EstimatorSettings crytek(double radius, SampleKernel kernel = SampleKernel::uniform,
                         RangeCheck check = RangeCheck::none) {
  EstimatorSettings settings = sampled(Estimator::crytek, radius, 16, 64);
  settings.samples = 64;
  settings.sample_kernel = kernel;
  settings.range_check = check;
  return settings;
}

/// Of many samples, with the defaults of each estimator.
EstimatorSettings dense(Estimator estimator, double radius) {
  EstimatorSettings settings = sampled(estimator, radius, 16, 64);
  settings.samples = 64;
  settings.sample_kernel = SampleKernel::uniform;
  return settings;
}

constexpr Estimator kOfTheirOwn[]{Estimator::gtao, Estimator::hbao, Estimator::crytek};

/// The floor's pixels about a distance from the block, in the middle of the picture, that have a truth.
struct Band {
  double distance, half_width, half_height;
  std::function<double(const Hit&)> truth;

  Truth in_band() const {
    return [this](const Hit& hit) {
      const bool is_in = hit.primitive == 0 && std::abs(hit.position.x - distance) < half_width &&
                         std::abs(hit.position.y) < half_height;
      return is_in ? truth(hit) : kNone;
    };
  }
};

/// The bounds of the mean of the errors and of each, and the fewest pixels that are compared.
struct Bounds {
  double mean, each;
  std::size_t pixels;
};

void expect_mean(const Rendering& rendering, const EstimatorSettings& settings, const Truth& truth,
                 const Bounds& bounds) {
  const Errors errors = errors_of(rendering, settings, truth, 0);
  ASSERT_GE(errors.pixels.size(), bounds.pixels);
  EXPECT_LE(std::abs(errors.bias), bounds.mean) << errors.pixels.size() << " pixels";
  EXPECT_LE(errors.worst, bounds.each) << errors.where;
}

/// The same in several bands of the picture.
void expect_bands(const std::string& what, const Rendering& rendering, const EstimatorSettings& settings,
                  const std::vector<Band>& bands, const Bounds& bounds) {
  for (const Band& band : bands) {
    SCOPED_TRACE(what + ", distance " + std::to_string(band.distance));
    expect_mean(rendering, settings, band.in_band(), bounds);
  }
}

/// The mean over the floor's pixels at about that distance from the block, in the middle of the picture.
double beside_block(const Rendering& rendering, const EstimatorSettings& settings, double d) {
  const Band band{d, 0.025, 0.3, [](const Hit&) { return 0; }};
  const Errors errors = errors_of(rendering, settings, band.in_band(), 0);
  EXPECT_GE(errors.pixels.size(), 10u);
  return errors.bias;
}

// Every estimator.

TEST(EveryEstimator, is_the_same_to_all_sides) {
  for (const Estimator estimator : kOfTheirOwn)
    for (const double tilt : {0.0, 35.0}) {
      std::vector<double> means;
      for (const double turn : {0.0, 90.0, 180.0, 270.0}) {
        const Rendering rendering = render(block(0.4), leaning(tilt, 3, 120, 120, turn));
        means.push_back(beside_block(rendering, dense(estimator, 0.6), 0.2));
      }
      EXPECT_LE(std::ranges::max(means) - std::ranges::min(means), 0.01) << int(estimator) << " tilt " << tilt;
      EXPECT_LE(std::ranges::max(means), 0.92) << int(estimator) << " tilt " << tilt;
    }
}

TEST(EveryEstimator, reaches_as_far_at_every_resolution) {
  for (const Estimator estimator : kOfTheirOwn) {
    const EstimatorSettings settings = dense(estimator, 0.5);
    double near[2];
    for (const int fine : {0, 1}) {
      const int width = fine ? 480 : 120;
      const Rendering rendering = render(block(2), leaning(20, 3, width, width / 2));
      near[fine] = beside_block(rendering, settings, 0.25);
      EXPECT_NEAR(beside_block(rendering, settings, 0.56), 1, 1e-6) << int(estimator) << ", " << width << " px";
    }
    EXPECT_NEAR(near[0], near[1], 0.015) << int(estimator);
    EXPECT_LT(near[1], 0.93) << int(estimator);
  }
}

TEST(EveryEstimator, has_its_noise_by_pixel_at_every_resolution) {
  // The noise of a few samples: over any 8 x 8 pixels nearly all of it averages out, however large the picture is.
  for (const int width : {64, 160, 2400}) {
    const Rendering rendering = render(block(2), leaning(30, 2.0 * width / 64, width, 24));
    for (const Estimator estimator : kOfTheirOwn) {
      EstimatorSettings few = dense(estimator, 0.5);
      few.slices = 1, few.steps = few.samples = 4;
      const std::vector<float> ao = ao_of(rendering.frame, few), fine = ao_of(rendering.frame, dense(estimator, 0.5));
      double noise = 0, left = 0;
      for (int y = 0; y + 8 <= 24; y += 8)
        for (int x = 0; x + 8 <= width; x += 8) {
          double sum = 0;
          for (int v = 0; v < 8; v++)
            for (int u = 0; u < 8; u++) {
              const auto i = std::size_t((y + v) * width + x + u);
              sum += (ao[i] - fine[i]) / 64;
              noise += std::pow(ao[i] - fine[i], 2) / 64;
            }
          left += sum * sum;
        }
      EXPECT_GT(noise, 0.01) << int(estimator) << ": there is noise to average";
      EXPECT_LT(left, 0.3 * noise) << int(estimator) << " width " << width << ": " << left << " of " << noise;
    }
  }
}

// HBAO, after Bavoil and Sainz: the mean of sin h - sin t over the azimuth, which weighs the hemisphere uniformly and
// not by the cosine.

// In the azimuth phi from the wall its rim stands at sin h = H / sqrt(H^2 + d^2 / cos^2 phi), as long as d / cos phi <
// R. What is below the bias blocks nothing. An endless wall blocks acos(d / R) / pi.
double hbao_beside_wall(double d, double height, double radius, double bias = 0) {
  constexpr int kParts = 2000;
  const double limit = std::acos(std::min(1.0, d / radius));
  double sum = 0;
  for (int i = 0; i < kParts; i++)
    sum += std::max(0.0, height / std::hypot(height, d / std::cos(limit * (i + 0.5) / kParts)) - bias) / kParts;
  return 1 - sum * limit / kPi;
}

// A rim at the elevation of the bias blocks nothing, and a higher rim blocks what lies between.
TEST(Hbao, beside_a_wall_seen_along_the_normal_is_the_mean_sine_of_its_rim_above_the_bias) {
  EXPECT_NEAR(hbao_beside_wall(0.5, 1e6, 1), 1 - std::acos(0.5) / kPi, 1e-6);
  for (const auto& [height, bias, elevation, bounds] : {std::tuple{50.0, 0.0, Elevation::view, Bounds{0.01, 0.04, 50}},
                                                        {0.2, 0.0, Elevation::view, {0.01, 0.03, 50}},
                                                        {0.5, 0.0, Elevation::view, {0.01, 0.03, 50}},
                                                        {1.0, 0.0, Elevation::view, {0.01, 0.03, 50}},
                                                        {0.1, 0.5, Elevation::view, {0.005, 0.02, 50}},
                                                        {0.4, 0.5, Elevation::view, {0.005, 0.02, 50}},
                                                        {0.1, 0.5, Elevation::surface, {0.005, 0.02, 50}},
                                                        {0.4, 0.5, Elevation::surface, {0.005, 0.02, 50}}}) {
    EstimatorSettings settings = hbao(0.6);
    settings.bias = bias;
    settings.elevation = elevation;
    const auto truth = [height = height, bias = bias](const Hit& hit) {
      return hbao_beside_wall(hit.position.x, height, 0.6, bias);
    };
    std::vector<Band> bands;
    for (const double d : {0.06, 0.1, 0.25, 0.4, 0.48})
      if (bias == 0 || d == 0.4) bands.push_back({d, 0.006, 0.35, truth});
    expect_bands(name_of(settings) + ", height " + std::to_string(height),
                 render(block(height), leaning(0, 3, 300, 200)), settings, bands, bounds);
  }
}

// Perfect horizons: half of the hemisphere beside an endless wall, a quarter below a rim at 45 degrees, whatever the
// tilt of the view. The part of the uniform hemisphere that a rectangle of width 2 w at distance d, standing on the
// tangent plane, fills (van Oosterom and Strackee).
double rectangle_share(double d, double height, double from, double to) {
  const auto quarter = [&](double w) {
    return std::asin(w * height / std::sqrt((w * w + d * d) * (height * height + d * d)));
  };
  return (quarter(to) - quarter(from)) / (2 * kPi);
}

TEST(Hbao, sees_the_uniform_hemisphere_at_every_tilt_of_the_view) {
  EXPECT_NEAR(rectangle_share(1, 1e7, -1e7, 1e7), 0.5, 1e-6);  // an endless wall: 0.5
  // a rim at 45 degrees: 0.25, where the cosine-weighted is 0.146
  EXPECT_NEAR(rectangle_share(1, 1, -1e7, 1e7), 0.25, 1e-6);
  constexpr double kHalf = 3;
  for (const double tilt : {0.0, 30.0, 60.0, 75.0}) {
    // Pixels oblong in y: the picture is long and has few of them.
    Shot shot = leaning(tilt, 6, 300, 120);
    shot.camera.fy = 120 / (2 * kHalf);
    for (const auto& [height, d] : {std::pair{1.0, 1.0}, {2.0, 0.2}})
      expect_bands("tilt " + std::to_string(tilt), render(block(height), shot), hbao(1e3, 32, 256),
                   {{d, 0.05, 0.2,
                     [height = height](const Hit& hit) {
                       const Vec3 at = hit.position;
                       return 1 - rectangle_share(at.x, height, -kHalf - at.y, kHalf - at.y);
                     }}},
                   {0.01, 0.03, 8});
  }
}

// Without the weights that the kernel's head describes, even directions of the image get this wrong.
TEST(Hbao, off_axis_is_what_it_is_on_axis) {
  const double half = 0.4, height = 0.3;
  const Scene scene{{kFloor, parallelogram({0, -half, 0}, {0, 2 * half, 0}, {0, 0, height})}};
  for (const double aside : {0.0, 0.6, 1.0})
    expect_bands("aside " + std::to_string(aside),
                 render(scene, Shot::perspective({1, aside, 1.2}, {1, aside, 0}, 120, 240, 240)), hbao(1e3, 16, 200),
                 {{0.3, 0.02, 0.1,
                   [&](const Hit& hit) {
                     const Vec3 at = hit.position;
                     return 1 - rectangle_share(at.x, height, -half - at.y, half - at.y);
                   }}},
                 {0.01, 0.03, 8});
}

/// The kernel against its slow version at every so many pixels: the errors of `bias` and each.
Errors against_slow_version(const HostFrame& frame, const EstimatorSettings& settings, const std::vector<float>& ao,
                            std::size_t first, std::size_t every) {
  Errors errors;
  for (std::size_t i = first; i < frame.depth.size(); i += every) errors.pixels.push_back(i);
  const std::vector<float> slow = reference_estimate(frame, settings, errors.pixels);
  for (const std::size_t i : errors.pixels) {
    const double error = ao[i] - slow[i];
    errors.truths.push_back(slow[i]);
    errors.mean += std::abs(error) / double(errors.pixels.size());
    errors.bias += error / double(errors.pixels.size());
    errors.worst = std::max(errors.worst, std::abs(error));
  }
  return errors;
}

TEST(Hbao, from_the_surface_is_the_same_where_it_faces_the_eye_and_the_sine_above_it_elsewhere) {
  for (const double tilt : {0.0, 40.0}) {
    const Rendering rendering = render(block(0.5), leaning(tilt, 3, 300, 200));
    EstimatorSettings settings = hbao(100);
    settings.elevation = Elevation::surface;
    const std::vector<float> surface = ao_of(rendering.frame, settings);
    const Difference d = difference(surface, ao_of(rendering.frame, hbao(100)));
    if (tilt == 0)
      EXPECT_LE(d.max, 1e-4) << place(d, rendering.frame);
    else
      EXPECT_GE(d.rmse, 0.01);
    EXPECT_LE(against_slow_version(rendering.frame, settings, surface, 50, 977).worst, 0.04) << "tilt " << tilt;
  }
}

// Crytek's estimator: the hidden part of the volume.

// The visibility is 1 - (1 - c)^2 (2 + c) / 4, from wherever on the open side it is seen.
TEST(Crytek, beside_an_endless_wall_is_the_volume_before_it) {
  for (const Shot& shot : {Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 60, 320, 240),
                           Shot::perspective({5, 0, 1.5}, {0, 0, 0.6}, 50, 320, 240),
                           Shot::perspective({2.2, -0.6, 1.8}, {0.6, 0.2, 0.2}, 100, 320, 240),
                           Shot::orthographic({4, -1, 3}, {0.5, 0, 0.5}, 5, 320, 240)}) {
    const Rendering rendering = render({{kFloor, kWallX}}, shot);
    for (const double c : {0.1, 0.3, 0.5, 0.7}) {
      SCOPED_TRACE("c = " + std::to_string(c) + " fx " + std::to_string(shot.camera.fx));
      const auto truth = [&](const Hit& hit) {
        const double d = hit.primitive == 0 ? hit.position.x : hit.position.z;
        return std::abs(d - c) < 0.05 && shot.sees_ball(hit.position, 1) ? 1 - (1 - d) * (1 - d) * (2 + d) / 4 : kNone;
      };
      expect_mean(rendering, crytek(1), truth, {0.008, 0.12, 100});
    }
  }
}

// A sample of length s R is behind the wall with probability (1 - c / s) / 2.
TEST(Crytek, clustered_kernel_has_the_lengths_of_its_formula) {
  const Shot shot = Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 60, 320, 240);
  const Rendering rendering = render({{kFloor, kWallX}}, shot);
  for (const int samples : {8, 64}) {
    EstimatorSettings settings = crytek(1, SampleKernel::clustered);
    settings.samples = samples;
    const auto truth = [&](const Hit& hit) {
      const double c = hit.primitive == 0 ? hit.position.x : hit.position.z;
      if (c < 0.1 || c > 0.4 || !shot.sees_ball(hit.position, 1)) return kNone;
      double blocked = 0;
      for (int i = 0; i < samples; i++) {
        const double longest = 0.1 + 0.9 * std::pow(double(i) / samples, 2);  // s = u longest, u even in [0, 1)
        if (longest > c) blocked += 0.5 * (1 - c / longest * (1 + std::log(longest / c))) / samples;
      }
      return 1 - blocked;
    };
    expect_mean(rendering, settings, truth, {0.004, 0.3, 500});
  }
}

// A floor seen from above, and a block so high that all of it is dz before the floor: every hit weighs the same.
TEST(Crytek, range_checks_weigh_a_hit_by_its_depth) {
  const double radius = 0.5;
  const auto smooth = [](double x) {
    const double t = std::clamp(x, 0.0, 1.0);
    return t * t * (3 - 2 * t);
  };
  for (const double dz : {0.25, 0.4, 1.0, 2.0}) {
    const Rendering rendering = render(block(dz), leaning(0, 3, 150, 100));
    const std::vector<float> plain = ao_of(rendering.frame, crytek(radius));
    for (const auto& [check, weight] :
         {std::pair{RangeCheck::ratio, smooth(radius / dz)}, {RangeCheck::smoothstep, 1 - smooth(dz / radius)}}) {
      const auto weighed = [&plain, weight = weight](std::size_t i) { return 1 - weight * (1 - plain[i]); };
      EXPECT_LE(difference(ao_of(rendering.frame, crytek(radius, SampleKernel::uniform, check)), weighed).max, 1e-5)
          << "dz " << dz << " check " << int(check);
    }
    EXPECT_GT(-difference(plain, [](std::size_t) { return 1.0; }).bias * double(plain.size()), 100)
        << "there is something to weigh";
  }
}

TEST(Crytek, bias_is_a_depth_in_scene_units) {  // what is nearer to the eye than the sample by less does not hide it
  const Rendering rendering = render(block(0.3), leaning(0, 3, 150, 100));
  EstimatorSettings settings = crytek(0.5);
  settings.bias = 0.31;
  expect_open(rendering.frame, settings, 0);
  // Over the block from above, the samples lower than 0.3 - bias are hidden: those of a ball's slab beside the block's
  // side.
  settings.bias = 0.1;
  const double radius = 0.5, low = 0.2, d = 0.1;
  constexpr int kParts = 400;
  double hidden = 0;  // volume of the half ball beyond x = d and below z = low
  for (int i = 0; i < kParts; i++) {
    const double z = low * (i + 0.5) / kParts, r = std::sqrt(radius * radius - z * z), c = d / r;
    hidden += (std::acos(c) - c * std::sqrt(1 - c * c)) * r * r * low / kParts;
  }
  expect_bands("", rendering, settings,
               {{d, 0.011, 0.4, [&](const Hit&) { return 1 - hidden / (2 * kPi / 3 * std::pow(radius, 3)); }}},
               {0.015, 0.1, 20});
}

// The eye is so near to a corner that many samples are behind it and more off the image; and a ball before the sky.
TEST(Crytek, counts_only_samples_before_the_eye_and_on_surfaces_of_the_image) {
  const HostFrame corner =
      render({{kFloor, kWallX}}, Shot::perspective({0.12, 0, 0.1}, {0, 0.05, 0.02}, 70, 96, 72)).frame;
  const Scene ball{{parallelogram({0, -2, 0}, {3, 0, 0}, {0, 4, 0}), Sphere{.center = {1.2, 0.3, 0.5}, .radius = 0.5}}};
  const HostFrame before_sky = render(ball, Shot::perspective({4.5, -1.5, 1.6}, {1, 0, 0.6}, 50, 120, 90)).frame;
  for (const auto& [frame, radius, bias, each] : {std::tuple{&corner, 0.1, 0.01, 0.4},
                                                  {&corner, 0.15, 0.01, 0.4},
                                                  {&corner, 0.2, 0.01, 0.4},
                                                  {&before_sky, 0.8, 0.003, 0.25}}) {
    const EstimatorSettings settings = dense(Estimator::crytek, radius);
    const Errors errors = against_slow_version(*frame, settings, ao_of(*frame, settings), 3, 23);
    EXPECT_LE(std::abs(errors.bias), bias) << radius;
    EXPECT_LE(errors.worst, each) << radius;
  }
  // A wall that covers all of the picture's left: beyond the picture's border nothing is known, so the border is no
  // brighter than the middle.
  const Rendering wall = render(block(5), leaning(30, 1, 96, 72));
  const std::vector<float> ao = ao_of(wall.frame, dense(Estimator::crytek, 0.5));
  double border = 0, middle = 0;
  int columns = 0;
  for (int x = 0; x < 96; x++) {
    if (wall.at(x, 36).primitive != 0 || wall.at(x, 36).position.x > 0.3) continue;
    columns++;
    for (int y = 0; y < 4; y++)
      border += ao[std::size_t(y * 96 + x)] / 4, middle += ao[std::size_t((y + 34) * 96 + x)] / 4;
  }
  ASSERT_GT(columns, 10);
  EXPECT_NEAR(border / columns, middle / columns, 0.02);
}

// Inside of a ball, seen from its middle through a wide angle and from its rim, normals point everywhere; all are
// alike: the hidden volume is the same. A ball of radius R about a point of the sphere S: below the tangent's cap lies
// R / S * 3 / 16 of the half ball's volume.
TEST(Crytek, has_a_basis_about_every_normal) {
  for (const Vec3 eye : {Vec3{0, 0, 0}, {-1.9, 0, 0}}) {
    const Shot shot = Shot::perspective(eye, {1, 0, 0}, 130, 120, 120);
    const Rendering rendering = render({{Sphere{.center = {}, .radius = 2}}}, shot);
    const auto truth = [&](const Hit& hit) {
      return shot.sees_ball(hit.position, 0.5) ? 1 - 3 * 0.5 / (8 * 2) : kNone;
    };
    expect_mean(rendering, dense(Estimator::crytek, 0.5), truth, {0.01, 0.15, 100});
  }
}

TEST(EstimatorOptions, say_how_many_samples_each_estimator_takes) {
  EXPECT_EQ(samples_of(hbao(1, 3, 5), 10), 10 * 2 * 3 * 5);
  EstimatorSettings settings = crytek(1);
  settings.samples = 9;
  EXPECT_EQ(samples_of(settings, 10), 10 * 9);
}

// Both, whatever the variant.
TEST(EveryVariant, agrees_with_its_slow_version) {
  const HostFrame frame = furnished_room(120, 90).frame;
  std::vector<EstimatorSettings> variants;
  for (const Elevation elevation : {Elevation::view, Elevation::surface})
    for (const Falloff falloff : {Falloff::none, Falloff::linear, Falloff::quadratic, Falloff::smooth}) {
      variants.push_back(hbao(0.5, 16, 64));
      variants.back().elevation = elevation;
      variants.back().falloff = falloff;
      variants.back().falloff_start = 0.2;
    }
  for (const SampleKernel kernel : {SampleKernel::clustered, SampleKernel::uniform})
    for (const RangeCheck check : {RangeCheck::none, RangeCheck::ratio, RangeCheck::smoothstep})
      variants.push_back(crytek(0.5, kernel, check));
  for (const EstimatorSettings& settings : variants) {
    const std::vector<float> ao = ao_of(frame, settings);
    const Errors errors = against_slow_version(frame, settings, ao, 0, 37);
    double squares = 0;
    for (std::size_t i = 0; i < errors.pixels.size(); i++)
      squares += std::pow(ao[errors.pixels[i]] - errors.truths[i], 2);
    EXPECT_LE(std::abs(errors.bias), 0.003) << name_of(settings);
    // crytek: the noise of 64 samples
    EXPECT_LE(std::sqrt(squares / double(errors.pixels.size())), settings.estimator == Estimator::hbao ? 0.015 : 0.04)
        << name_of(settings);
  }
}

}  // namespace
}  // namespace alcove::estimator_test
