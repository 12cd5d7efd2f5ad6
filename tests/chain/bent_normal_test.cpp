// Bent normals: closed forms, the CPU reference, and what the filters make of them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/results.h"
#include "tests/support/chain.h"
#include "tests/support/reference_planes.h"
#include "tests/support/scenes.h"

namespace alcove::bent_normal_test {
namespace {

using namespace test;

/// The kernels' own function, compiled as C++.
namespace glsl {
struct vec2 {
  vec2(float along_x, float along_y) : x(along_x), y(along_y) {}
  float x, y;
};
#include "kernels/estimate/arc_moments.glsl"
}  // namespace glsl

constexpr Estimator kSliced[]{Estimator::gtao, Estimator::bitmask};

/// All kinds of exact searches: by outlines and by pixels, directions shared by a block, and by the error.
std::vector<EstimatorSettings> exact_searches(double radius) {
  std::vector<EstimatorSettings> all(4, exact(radius));
  all[1].every_pixel = true;
  all[2].slices = 4;
  all[2].denoise = Denoise::bilateral;
  all[3].tolerance = 0.02;
  return all;
}

// Closed forms.

TEST(Moments, of_a_side_are_its_integrals) {
  for (double gamma = -1.5; gamma <= 1.5; gamma += 0.25)
    for (double part = 0; part <= 1; part += 0.125) {
      const double h = part * (gamma + kPi / 2);
      double across = 0, toward = 0, mixed = 0, along = 0;
      constexpr int kSteps = 2000;
      for (int i = 0; i < kSteps; i++) {
        const double theta = h * (i + 0.5) / kSteps, weight = std::cos(theta - gamma) * std::sin(theta) * h / kSteps;
        across += weight * std::sin(theta);
        toward += weight * std::cos(theta);
        mixed += weight * std::sin(theta) * std::cos(theta);
        along += weight * std::cos(theta) * std::cos(theta);
      }
      const auto c = float(std::cos(h)), s = float(std::sin(h)), c_gamma = float(std::cos(gamma)),
                 s_gamma = float(std::sin(gamma));
      const glsl::vec2 first = glsl::first_to(c, s, c_gamma, s_gamma);
      const glsl::vec2 second = glsl::second_to(c, s, float(h), c_gamma, s_gamma);
      ASSERT_NEAR(first.x, across, 2e-6) << gamma << " " << h;
      ASSERT_NEAR(first.y, toward, 2e-6) << gamma << " " << h;
      ASSERT_NEAR(second.x, mixed, 2e-6) << gamma << " " << h;
      ASSERT_NEAR(second.y, along, 2e-6) << gamma << " " << h;
    }
}

/// How far vectors are at most from the normals times a length, on surfaces.
double farthest_from_normals(const std::vector<Vec3>& vectors, const HostFrame& frame, double length_of_normals) {
  double farthest = 0;
  for (std::size_t i = 0; i < vectors.size(); i++)
    if (frame.depth[i] < frame.sky)
      farthest = std::max(farthest, length(vectors[i] - length_of_normals * normal_at(frame, i)));
  return farthest;
}

// A third of all combinations with each change.
TEST(BentNormals, of_an_open_plane_are_its_normal_and_two_thirds_long_at_every_tilt) {
  int number = -1;
  for (const auto& [what, rendering] : slanted_planes({0, 40, 75, 85}, {0, 37, 200}, {0, 60, 110})) {
    number++;
    if (!tried(number + number / 3 + number / 9, 3)) continue;  // the numbers of field of view, turn and tilt
    SCOPED_TRACE(what);
    const HostFrame& frame = rendering.frame;
    for (const Estimator estimator : kSliced)
      for (const auto& [slices, steps] : {std::pair{1, 4}, {3, 40}}) {
        EstimatorSettings settings = sampled(estimator, 1, slices, steps);
        EXPECT_LE(farthest_from_normals(raw_bent(frame, settings), frame, 2.0 / 3), 1e-3) << name_of(settings);
        settings.denoise = Denoise::bilateral;
        for (const auto& [resolution, stride] : {std::pair{Resolution::full, 1},
                                                 {Resolution::full, 4},
                                                 {Resolution::full, 16},
                                                 {Resolution::half, 2},
                                                 {Resolution::quarter, 1}}) {
          settings.resolution = resolution;
          settings.stride = stride;
          EXPECT_LE(farthest_from_normals(bent_normals(frame, settings), frame, 1), 1e-3) << name_of(settings);
        }
      }
  }
}

// Nothing is blocked, so nothing is subtracted by either search. What is left is rounding: of packed normals, within
// 4e-5 rad, and of stored means.
TEST(BentNormals, of_an_open_plane_are_its_normal_to_rounding_in_an_exact_search) {
  for (const auto& [what, rendering] : slanted_planes({0, 25, 50}, {53.13010235415598}, {0, 60})) {
    SCOPED_TRACE(what);
    const auto by_samples = raw_bent(rendering.frame, sampled(Estimator::gtao, 1, 1, 4));
    for (EstimatorSettings settings : exact_searches(1))
      for (const Completion complete : {Completion::none, Completion::all}) {
        settings.complete = complete;
        const auto raw = raw_bent(rendering.frame, settings);
        for (std::size_t i = 0; i < raw.size(); i++)
          ASSERT_LE(length(raw[i] - by_samples[i]), 1e-6) << name_of(settings) << " pixel " << i;
        EXPECT_LE(farthest_from_normals(raw, rendering.frame, 2.0 / 3), 4e-5) << name_of(settings);
      }
  }
}

/// Even points of the unit disk below the hemisphere about z, as directions.
const std::vector<Vec3> kEven = [] {
  std::vector<Vec3> directions;
  for (int r = 0; r < 100; r++)
    for (int t = 0; t < 200; t++) {
      const double out = std::sqrt((r + 0.5) / 100), turn = 2 * kPi * (t + 0.5) / 200;
      directions.push_back({out * std::cos(turn), out * std::sin(turn), std::sqrt(1 - out * out)});
    }
  return directions;
}();

/// The cosine-weighted mean over the open directions.
Vec3 mean_open(const std::function<bool(Vec3)>& is_open) {
  Vec3 sum;
  for (const Vec3& direction : kEven)
    if (is_open(direction)) sum = sum + direction;
  return (1.0 / double(kEven.size())) * sum;
}

/// The floor before one wall or two, and the truths of its pixels in view space.
struct KnownFloor {
  FloorByWalls floor;
  std::vector<Vec3> truths = {};

  KnownFloor(int walls, const Shot& shot, double radius) : floor(floor_by_walls(walls, shot, radius)) {
    for (const std::size_t i : floor.pixels)
      truths.push_back(shot.view_from_world(mean_open([&](Vec3 w) { return floor.is_open(i, w); })));
  }
};

/// Compares the estimate with the truths.
void expect_truths(const KnownFloor& known, const EstimatorSettings& settings) {
  const FloorByWalls& floor = known.floor;
  SCOPED_TRACE(name_of(settings) + ", walls " + std::to_string(floor.walls));
  const auto raw = raw_bent(floor.rendering.frame, settings, floor.pixels);
  double worst = 0, sum = 0;
  for (std::size_t k = 0; k < floor.pixels.size(); k++) {
    const double error = length(raw[floor.pixels[k]] - known.truths[k]);
    worst = std::max(worst, error);
    sum += error;
  }
  // So few steps miss as much of the visibility, and sectors round the horizon of each wall.
  const double tolerance = settings.steps < 64 ? 0.018 : settings.estimator == Estimator::bitmask ? 0.008 : 0.003;
  EXPECT_LE(worst, 3 * tolerance);
  EXPECT_LE(sum / double(floor.pixels.size()), tolerance);
}

// Half of them with each change.
TEST(BentNormals, beside_walls_are_the_closed_form_from_every_camera) {
  const Vec3 eye{2.4, 1.9, 2.6}, target{0.3, 0.3, 0.1};
  std::vector<EstimatorSettings> exact_ones(3, exact(0.6));
  exact_ones[1].complete = Completion::none;
  exact_ones[2].tolerance = 0.005;
  int number = 0, exact_number = 0;
  const auto expect_exact = [&](const KnownFloor& floor) {
    for (const EstimatorSettings& settings : exact_ones)
      if (tried(exact_number++, 2)) expect_truths(floor, settings);
  };
  for (const int count : {1, 2}) {
    for (const double roll : {0.0, 50.0, 190.0}) {
      const KnownFloor floor(count, rolled(Shot::perspective(eye, target, 50, 180, 135), roll), 0.6);
      for (const Estimator estimator : kSliced)
        for (const int steps : {16, 64}) {
          number++;
          if (tried(number + number / 2 + number / 4, 2)) expect_truths(floor, sampled(estimator, 0.6, 16, steps));
        }
      if (roll == 0) expect_exact(floor);
    }
    expect_exact({count, Shot::orthographic(eye, target, 3, 180, 135), 0.6});
    exact_number++;  // so that two walls take the combinations that one wall left out
  }
}

// The reference.

/// The mean length of the error at some pixels, and that of the mean error.
std::pair<double, double> errors_at(const std::vector<std::size_t>& pixels, const std::vector<Vec3>& vectors,
                                    const std::vector<Vec3>& expected) {
  double error = 0;
  Vec3 bias;
  for (const std::size_t i : pixels) {
    error += length(vectors[i] - expected[i]) / double(pixels.size());
    bias = bias + 1.0 / double(pixels.size()) * (vectors[i] - expected[i]);
  }
  return {error, length(bias)};
}

// Both estimators are meant to compute the same, whatever their steps: half of both with each change.
TEST(BentNormals, are_those_of_the_cpu_reference) {
  const Rendering room = furnished_room(120, 90);
  int number = 0;
  for (const ThicknessKind thickness : {ThicknessKind::infinite, ThicknessKind::constant, ThicknessKind::automatic})
    for (const bool is_other : {false, true}) {  // another falloff, or of an exact search another completion
      if (!tried(int(thickness) + !is_other, 2)) continue;
      number++;
      EstimatorSettings settings = sampled(Estimator::gtao, 0.6, 24, 16), search = exact(0.6, 24);
      settings.thickness = search.thickness = thickness;
      settings.thickness_length = search.thickness_length = 0.15;
      settings.falloff = is_other ? Falloff::quadratic : Falloff::none;
      search.complete = is_other ? Completion::all : Completion::none;
      for (const EstimatorSettings& of : {settings, search}) {
        const bool is_exact = of.search == SliceSearch::exact;
        ReferenceSettings reference = reference_settings_of(of);
        for (std::size_t i = 11; i < room.hits.size(); i += is_exact ? 19 : 109)
          if (room.hits[i].primitive >= 0) reference.pixels.push_back(i);
        const auto expected = first_band(reference_transfer(room.frame, reference));
        if (is_exact) {
          for (const bool every_pixel : {false, true}) {
            search.every_pixel = every_pixel;
            const auto [error, bias] = errors_at(reference.pixels, raw_bent(room.frame, search), expected);
            // Measured: 0.0020 to 0.0029, and bias up to 0.0003.
            EXPECT_LE(error, 0.004) << name_of(search) << every_pixel;
            EXPECT_LE(bias, 0.0006) << name_of(search) << every_pixel;
          }
          continue;
        }
        const auto expected_ao = reference_ao(room.frame, reference);
        for (const Estimator estimator : kSliced)
          for (const int steps : {16, 96}) {
            if (!tried(number + (estimator == Estimator::bitmask) + (steps == 96), 2)) continue;
            settings.estimator = estimator;
            settings.steps = steps;
            const auto raw = raw_bent(room.frame, settings, reference.pixels);
            const auto [error, bias] = errors_at(reference.pixels, raw, expected);
            // That of the same kernel.
            const auto ao = planes_of(room.frame, settings, "ao,bent-normal").ao;
            double ao_error = 0;
            for (const std::size_t i : reference.pixels)
              ao_error += std::abs(ao[i] - expected_ao[i]) / double(reference.pixels.size());
            // The bent normal is no farther from the reference than the visibility by the same samples is.
            EXPECT_LE(error, 1.25 * ao_error + 0.003) << name_of(settings) << ", visibility " << ao_error;
            EXPECT_LE(bias, ao_error + 0.002) << name_of(settings);
          }
      }
    }
}

TEST(BentNormals, of_a_search_by_its_error_are_those_of_all_its_directions) {
  const Rendering room = furnished_room(101, 77);
  EstimatorSettings settings = exact(0.6, 64);
  const auto all = raw_bent(room.frame, settings);
  for (const double tolerance : {1e-9, 0.03}) {
    settings.tolerance = tolerance;
    settings.further_radii = {0.2};  // of which the larger one counts
    const auto raw = raw_bent(room.frame, settings);
    double sum = 0;
    for (std::size_t i = 0; i < raw.size(); i++) {
      sum += dot(raw[i] - all[i], raw[i] - all[i]);
      if (room.hits[i].primitive < 0) ASSERT_EQ(length(raw[i]) + length(all[i]), 0) << "sky at " << i;
    }
    // The sums are rounded in another order.
    EXPECT_LE(std::sqrt(sum / double(raw.size())), std::max(tolerance, 1e-6));
  }
}

TEST(BentNormals, of_one_slice_are_right_in_the_mean_over_seeds) {
  const Rendering room = furnished_room(64, 48);
  for (const Estimator estimator : kSliced) {
    EstimatorSettings settings = sampled(estimator, 0.6, 1, 16);
    std::vector<Vec3> mean(room.hits.size());
    constexpr int kSeeds = 256;
    for (settings.seed = 0; settings.seed < kSeeds; settings.seed++) {
      const auto raw = raw_bent(room.frame, settings);
      for (std::size_t i = 0; i < raw.size(); i++) mean[i] = mean[i] + 1.0 / kSeeds * raw[i];
    }
    const auto many = raw_bent(room.frame, sampled(estimator, 0.6, 64, 16));
    double error = 0, surfaces = 0;
    for (std::size_t i = 0; i < many.size(); i++)
      if (room.hits[i].primitive >= 0) error += length(mean[i] - many[i]), surfaces++;
    EXPECT_LE(error / surfaces, 0.012) << name_of(settings);
  }
}

// Filters and limits.

TEST(BentNormals, are_unit_vectors_above_the_surface_and_0_on_the_sky_through_every_filter) {
  const Rendering room = furnished_room(121, 83);
  for (const Estimator estimator : kSliced)
    for (const Resolution resolution : {Resolution::full, Resolution::half, Resolution::quarter})
      for (const auto& [denoise, stride] : {std::pair{Denoise::none, 1},
                                            {Denoise::bilateral, 1},
                                            {Denoise::box, 1},
                                            {Denoise::bilateral, 2},
                                            {Denoise::bilateral, 4},
                                            {Denoise::bilateral, 16}}) {
        EstimatorSettings settings = sampled(estimator, 0.6, 1, 12);
        settings.resolution = resolution;
        settings.denoise = denoise;
        settings.stride = stride;
        const auto bent = bent_normals(room.frame, settings);
        for (std::size_t i = 0; i < bent.size(); i++) {
          const bool sky = room.hits[i].primitive < 0;
          ASSERT_NEAR(length(bent[i]), sky ? 0 : 1, 1e-3) << name_of(settings) << " " << i;
          if (!sky) ASSERT_GE(dot(bent[i], normal_at(room.frame, i)), -1e-3) << name_of(settings) << " " << i;
        }
      }
}

/// The mean angle on surfaces.
double degrees_off(const Rendering& rendering, const std::vector<Vec3>& bent, const std::vector<Vec3>& truth) {
  double error = 0, surfaces = 0;
  for (std::size_t i = 0; i < truth.size(); i++)
    if (rendering.hits[i].primitive >= 0) {
      error += std::atan2(length(cross(bent[i], truth[i])), dot(bent[i], truth[i])) / kRadian;
      surfaces++;
    }
  return error / surfaces;
}

TEST(BentNormals, of_shared_directions_and_smoothed_ones_come_close_to_all_of_them) {
  const Rendering room = furnished_room(160, 120);
  const auto truth = bent_normals(room.frame, exact(0.6, 64));
  EstimatorSettings shared = shared_directions(0.6);
  for (const auto& [resolution, bound] : {std::pair{Resolution::full, 0.5}, {Resolution::half, 1.5}}) {
    shared.resolution = resolution;
    EXPECT_LE(degrees_off(room, bent_normals(room.frame, shared), truth), bound);  // measured: 0.23 and 0.79
  }
  EstimatorSettings one = sampled(Estimator::gtao, 0.6, 1, 12);
  const auto many = bent_normals(room.frame, sampled(Estimator::gtao, 0.6, 64, 12));
  const double before = degrees_off(room, bent_normals(room.frame, one), many);
  one.denoise = Denoise::bilateral;
  EXPECT_LT(degrees_off(room, bent_normals(room.frame, one), many), 0.4 * before);
}

TEST(BentNormals, fall_back_to_the_normal_where_nothing_is_open) {
  const Rendering room = furnished_room(40, 30);
  const Prepared frame = prepared(room.frame);
  const std::vector<Vec3> normals = vectors_in(room.frame.normal);
  std::vector<float> closed(3 * normals.size());
  for (std::size_t i = 0; i < normals.size(); i++) {
    const Vec3 open = room.hits[i].primitive < 0 ? Vec3{} : 2.0 / 3 * normals[i];  // as much is blocked
    for (std::size_t c = 0; c < 3; c++)
      closed[i + c * normals.size()] = float(0.5 - 0.5 * std::array{open.x, open.y, open.z}[c]);
  }
  const auto planes = downloaded<float>(directions(recorder(), frame.gbuffer,
                                                   bent_normal(recorder(), frame.gbuffer, &given("closed", closed)),
                                                   "test directions", frame.inputs.aov_from_view));
  // Packed normals are off by up to 4e-5, and what is added to them is 7e-4 long.
  EXPECT_LE(farthest_from_normals(vectors_in(planes), room.frame, 1), 0.1);
}

// They come of another kernel, whose last bits drivers may round otherwise.
TEST(BentNormals, leave_the_visibility) {
  std::vector<EstimatorSettings> all;
  for (const EstimatorSettings& settings : exact_searches(0.6))
    for (const Completion complete : {Completion::none, Completion::border, Completion::all}) {
      all.push_back(settings);
      all.back().complete = complete;
    }
  for (const Estimator estimator : kSliced)
    for (const int steps : {6, 40})
      for (const Falloff falloff : {Falloff::none, Falloff::linear}) {
        all.push_back(sampled(estimator, 0.6, 2, steps));
        all.back().thickness = ThicknessKind::automatic;
        all.back().denoise = Denoise::bilateral;
        all.back().falloff = falloff;
      }
  const HostFrame frame = furnished_room(64, 48).frame;
  for (const EstimatorSettings& settings : all)
    EXPECT_LE(difference(planes_of(frame, settings, "ao,bent-normal").ao, ao_of(frame, settings)).max, 1e-6)
        << name_of(settings);
}

// Reflections towards the wall are hidden and those away from it open, though the visibility is the same: the cone of
// what is seen leans away from the wall.
TEST(SpecularOcclusion, follows_the_bent_normal) {
  const Scene scene{{kFloor, parallelogram({0, -6, 0}, {0, 12, 0}, {0, 0, 1.5})}};
  const Rendering rendering = render(scene, Shot::orthographic({20.4, 0, 20}, {0.4, 0, 0}, 3, 90, 60));
  const auto at_floor = [&](EstimatorSettings settings) {
    settings.roughness = 0.3;
    const std::vector<float> specular = planes_of(rendering.frame, settings, "specular-occlusion").specular;
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < rendering.hits.size(); i++)
      if (rendering.hits[i].primitive == 0 && std::abs(rendering.hits[i].position.x - 0.4) < 0.05)
        sum += specular[i], count++;
    EXPECT_GT(count, 20);
    return sum / count;
  };
  const double by_normal = at_floor(sampled(Estimator::hbao, 1, 16, 32));
  for (const EstimatorSettings& settings : {sampled(Estimator::gtao, 1, 16, 32), exact(1)})
    EXPECT_LT(at_floor(settings), by_normal - 0.05)
        << name_of(settings) << ": seen from the open side the reflection meets the wall";
}

}  // namespace
}  // namespace alcove::bent_normal_test
