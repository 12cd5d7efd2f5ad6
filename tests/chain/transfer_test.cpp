// The nine coefficients: closed forms, the CPU reference, turned cameras, and what is to be their sum.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"
#include "tests/support/reference_planes.h"
#include "tests/support/scenes.h"

namespace alcove::transfer_test {
namespace {

using namespace test;

/// The coefficients in view space that a receiver in the world has by quadrature over what is open about its normal.
Transfer truth_of(const Shot& shot, Vec3 normal, const std::function<bool(Vec3)>& is_open) {
  const Vec3 aside = unit(std::abs(normal.z) < 0.9 ? cross(normal, {0, 0, 1}) : cross(normal, {1, 0, 0}));
  const Vec3 beside = cross(normal, aside);
  Transfer sum{};
  constexpr int kRings = 60, kTurns = 120;
  for (int r = 0; r < kRings; r++)
    for (int t = 0; t < kTurns; t++) {
      const double out = std::sqrt((r + 0.5) / kRings), turn = 2 * kPi * (t + 0.5) / kTurns;
      const Vec3 w = out * std::cos(turn) * aside + out * std::sin(turn) * beside + std::sqrt(1 - out * out) * normal;
      if (!is_open(w)) continue;
      const Transfer y = harmonics(shot.view_from_world(w));
      for (std::size_t k = 0; k < y.size(); k++) sum[k] += y[k] / (kRings * kTurns);
    }
  return sum;
}

Transfer at(const std::vector<float>& transfer, std::size_t i) {
  Transfer nine{};
  for (std::size_t k = 0; k < nine.size(); k++) nine[k] = transfer[i + k * transfer.size() / nine.size()];
  return nine;
}

double distance(const Transfer& a, const Transfer& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum);
}

std::vector<EstimatorSettings> searches(double radius) {
  std::vector<EstimatorSettings> all{sampled(Estimator::gtao, radius, 16, 64),
                                     sampled(Estimator::bitmask, radius, 16, 64), exact(radius), exact(radius)};
  all.back().tolerance = 0.005;
  return all;
}

TEST(Transfer, truth_of_these_tests_is_the_closed_form) {
  const Shot shot = Shot::orthographic({0, 0, 9}, {0, 0, 0}, 1, 8, 8);  // view space is the world's
  const Transfer half = truth_of(shot, {0, 0, 1}, [](Vec3 w) { return w.x > 0; });
  const double first = std::sqrt(3 / kPi) / 2, second = std::sqrt(15 / kPi) / 2;
  EXPECT_NEAR(half[0], std::sqrt(1 / kPi) / 4, 1e-3);
  EXPECT_NEAR(half[2], first / 3, 1e-3);
  EXPECT_NEAR(half[3], first * 2 / (3 * kPi), 1e-3);
  EXPECT_NEAR(half[7], second / 8, 1e-3);
  EXPECT_NEAR(half[6], std::sqrt(5 / kPi) / 4 * (3.0 / 4 - 1.0 / 2), 1e-3);
  EXPECT_NEAR(std::abs(half[1]) + std::abs(half[4]) + std::abs(half[5]) + std::abs(half[8]), 0, 1e-3);
}

TEST(Transfer, of_an_open_plane_is_that_of_its_hemisphere_at_every_tilt_through_every_filter) {
  for (const auto& [what, rendering] : slanted_planes({0, 40, 80}, {37, 200}, {0, 80})) {
    SCOPED_TRACE(what);
    const Transfer truth = truth_of(rendering.shot, rendering.at(32, 24).normal, [](Vec3) { return true; });
    std::vector<EstimatorSettings> all = searches(1);
    all.push_back(sampled(Estimator::gtao, 1, 1, 8));
    all.back().denoise = Denoise::bilateral;
    all.back().stride = 16;
    all.push_back(all.back());
    all.back().stride = 1;
    all.back().resolution = Resolution::half;
    for (const EstimatorSettings& settings : all) {
      const auto transfer = planes_of(rendering.frame, settings, "transfer").transfer;
      for (std::size_t i = 0; i < rendering.hits.size(); i += 7)
        ASSERT_LE(distance(at(transfer, i), rendering.hits[i].primitive < 0 ? Transfer{} : truth), 2e-3)
            << name_of(settings) << " pixel " << i;
    }
  }
}

/// Compares floors beside one wall or two with the quadrature.
void expect_walls(int count, const Shot& shot, const EstimatorSettings& settings) {
  SCOPED_TRACE(name_of(settings) + ", walls " + std::to_string(count));
  const FloorByWalls floor = floor_by_walls(count, shot, *settings.radius);
  const auto transfer = planes_of(floor.rendering.frame, settings, "transfer").transfer;
  double worst = 0, sum = 0;
  for (const std::size_t i : floor.pixels) {
    const double error = distance(
        at(transfer, i), truth_of(shot, floor.rendering.hits[i].normal, [&](Vec3 w) { return floor.is_open(i, w); }));
    worst = std::max(worst, error);
    sum += error;
  }
  EXPECT_LE(worst, 0.018);
  EXPECT_LE(sum / double(floor.pixels.size()), 0.006);
}

TEST(Transfer, beside_a_wall_and_in_a_corner_turns_with_the_camera) {
  const Vec3 eye{2.4, 1.9, 2.6}, target{0.3, 0.3, 0.1};
  for (const double roll : {0.0, 50.0, 190.0})
    for (const int count : {1, 2}) {
      const Shot shot = rolled(Shot::perspective(eye, target, 50, 180, 135), roll);
      for (const EstimatorSettings& settings : searches(0.6)) expect_walls(count, shot, settings);
    }
  for (const EstimatorSettings& settings : searches(0.6))
    expect_walls(2, Shot::orthographic(eye, target, 3, 180, 135), settings);
}

/// The light that comes of nine coefficients of light from a direction.
double light_from(const Transfer& transfer, Vec3 direction) {
  const Transfer y = harmonics(direction);
  double sum = 0;
  for (std::size_t k = 0; k < y.size(); k++) sum += y[k] * transfer[k];
  return sum;
}

TEST(Transfer, in_another_space_means_the_same_directions) {
  const Rendering room = furnished_room(60, 45);
  const double a = std::cos(0.7), b = std::sin(0.7);
  const Matrix3 turn{{{a, -b, 0}, {0.6 * b, 0.6 * a, -0.8}, {0.8 * b, 0.8 * a, 0.6}}};
  const auto in_space = [&](const Matrix3& aov_from_view) {
    OutputSettings output;
    output.aovs = "transfer";
    FrameInputs inputs = upload(recorder(), room.frame);
    inputs.aov_from_view = aov_from_view;
    const FrameOutputs outputs = run_chain(recorder(), inputs, exact(0.6), output);
    recorder().run();
    return values_of(outputs.transfer);
  };
  const auto view = in_space({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), turned = in_space(turn);
  for (std::size_t i = 0; i < room.hits.size(); i++)
    for (const Vec3 w : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, unit({1, 2, -3}), unit({-2, 1, 1})}) {
      const auto row = [&](std::size_t r) { return turn[r][0] * w.x + turn[r][1] * w.y + turn[r][2] * w.z; };
      ASSERT_NEAR(light_from(at(view, i), w), light_from(at(turned, i), {row(0), row(1), row(2)}), 2e-6) << i;
    }
}

/// Searches, and samples through every filter.
std::vector<EstimatorSettings> filtered_searches(double radius) {
  std::vector<EstimatorSettings> all = searches(radius);
  all.push_back(shared_directions(radius));
  for (const auto& [resolution, denoise, stride] : {std::tuple{Resolution::full, Denoise::box, 1},
                                                    {Resolution::full, Denoise::bilateral, 16},
                                                    {Resolution::half, Denoise::bilateral, 4},
                                                    {Resolution::quarter, Denoise::none, 1}}) {
    all.push_back(sampled(Estimator::gtao, radius, 1, 12));
    all.back().resolution = resolution;
    all.back().denoise = denoise;
    all.back().stride = stride;
    all.push_back(all.back());
    all.back().further_radii = {radius / 3};
  }
  return all;
}

// The AO is the light of an even sky, of which only the first coefficient is not 0.
TEST(Transfer, of_an_even_sky_is_the_ao_through_every_filter) {
  const Rendering room = furnished_room(121, 83);
  for (const EstimatorSettings& settings : filtered_searches(0.6)) {
    const Planes planes = planes_of(room.frame, settings, "ao-scales,transfer");
    const std::size_t pixels = room.hits.size(), last = planes.scales.size() - pixels;
    for (std::size_t i = 0; i < pixels; i++)
      ASSERT_NEAR(2 * std::sqrt(kPi) * planes.transfer[i], room.hits[i].primitive < 0 ? 0 : planes.scales[last + i],
                  1e-6)
          << name_of(settings) << " pixel " << i;
  }
}

// No visibility is turned to one side more than one that is all in one direction.
TEST(Transfer, of_each_band_is_possible_with_the_visibility) {
  const Rendering room = furnished_room(121, 83);
  for (const EstimatorSettings& settings : filtered_searches(0.6)) {
    const Planes planes = planes_of(room.frame, settings, "ao,transfer");
    for (std::size_t i = 0; i < room.hits.size(); i++) {
      const Transfer nine = at(planes.transfer, i);
      const double first = std::hypot(nine[1], nine[2], nine[3]);
      const double second = std::hypot(std::hypot(nine[4], nine[5], nine[6]), nine[7], nine[8]);
      ASSERT_LE(first, std::sqrt(3) * nine[0] + 1e-6) << name_of(settings) << " pixel " << i;
      ASSERT_LE(second, std::sqrt(5) * nine[0] + 1e-6) << name_of(settings) << " pixel " << i;
    }
  }
}

TEST(Transfer, leaves_the_visibility_and_has_the_bent_normal_as_its_first_band) {
  const Rendering room = furnished_room(64, 48);
  for (const EstimatorSettings& settings : searches(0.6)) {
    const Planes planes = planes_of(room.frame, settings, "ao,bent-normal,transfer");
    EXPECT_LE(difference(planes.ao, ao_of(room.frame, settings)).max, 1e-6) << name_of(settings);
    const auto bent = vectors_in(planes.bent), band = first_band(planes.transfer);
    for (std::size_t i = 0; i < bent.size(); i++)
      if (length(band[i]) > 0.05) ASSERT_LE(length(bent[i] - unit(band[i])), 0.02) << name_of(settings) << " " << i;
  }
}

TEST(Transfer, is_that_of_the_cpu_reference) {
  const Rendering room = furnished_room(120, 90);
  for (const ThicknessKind thickness : {ThicknessKind::infinite, ThicknessKind::automatic})
    for (EstimatorSettings settings : {sampled(Estimator::gtao, 0.6, 24, 96), exact(0.6, 24)}) {
      settings.thickness = thickness;
      settings.complete = Completion::none;
      ReferenceSettings reference = reference_settings_of(settings);
      for (std::size_t i = 11; i < room.hits.size(); i += 53)
        if (room.hits[i].primitive >= 0) reference.pixels.push_back(i);
      const auto expected = reference_transfer(room.frame, reference);
      const auto expected_ao = reference_ao(room.frame, reference);
      const Planes planes = planes_of(room.frame, settings, "ao,transfer");
      double error = 0, ao_error = 0;
      for (const std::size_t i : reference.pixels) {
        error += distance(at(planes.transfer, i), at(expected, i)) / double(reference.pixels.size());
        ao_error += std::abs(planes.ao[i] - expected_ao[i]) / double(reference.pixels.size());
      }
      EXPECT_LE(error, 1.25 * ao_error + 0.002) << name_of(settings) << ", visibility " << ao_error;
    }
}

}  // namespace
}  // namespace alcove::transfer_test
