// What depth means is judged by flat surfaces, however coarsely their depth is stored; noise and steps are measured.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/flatness.h"
#include "tests/support/test.h"

namespace alcove::flatness_test {
namespace {

constexpr int kWidth = 320, kHeight = 180;
constexpr double kFocal = 300, kSky = 1e9;

View view_of_tests(bool orthographic = false) {
  View view{};
  view.size = {kWidth, kHeight};
  view.center = {0.5f * kWidth, 0.5f * kHeight};
  view.tangent_per_pixel = orthographic ? vec2{0.02f, -0.02f} : vec2{float(1 / kFocal), float(-1 / kFocal)};
  view.orthographic = orthographic;
  return view;
}

/// Planar depth of a room, by a camera that is rolled a little: a floor, a back wall that is turned, and a side wall.
double room(double x, double y) {
  const double across = (x - 0.5 * kWidth) / kFocal, up = -(y - 0.5 * kHeight) / kFocal;
  const double u = across - 0.1 * up, v = up + 0.1 * across;
  double z = 9 / (1 + 0.35 * u);
  if (v < 0) z = std::min(z, -1.3 / v);
  if (u > 0) z = std::min(z, 1.5 / u);
  return z;
}

double ray_length(double x, double y) {
  return std::sqrt(1 + std::pow((x - 0.5 * kWidth) / kFocal, 2) + std::pow((y - 0.5 * kHeight) / kFocal, 2));
}

std::vector<DepthScore> scores_of(const std::vector<float>& raw, bool orthographic = false) {
  return shape_of(raw, view_of_tests(orthographic), kSky, grain_of(raw, kSky)).scores;
}

using ValueAt = std::function<double(double x, double y)>;

std::vector<float> plane_of(const ValueAt& value) {
  std::vector<float> values;
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++) values.push_back(float(value(x + 0.5, y + 0.5)));
  return values;
}

/// What an 11 bit mantissa keeps of a number.
double half(double value) {
  const double unit = std::exp2(std::floor(std::log2(value)) - 10);
  return std::round(value / unit) * unit;
}

/// How a program or a person stored values.
struct Storage {
  const char* name;
  std::function<double(double)> stored;
};
const std::vector<Storage> kStorages{
    {"exact", [](double v) { return v; }},
    {"half", half},
    {"half times a scale", [](double v) { return 0.37 * half(v); }},
    {"thousandths", [](double v) { return std::round(v * 1000) / 1000; }},
    {"whole thousandths", [](double v) { return std::round(v * 1000); }},
    {"16 bits of 20", [](double v) { return std::round(v / 20 * 65535) * 20 / 65535; }}};

TEST(Flatness, tells_the_kind_however_coarse_the_values_are) {
  const std::vector<std::pair<DepthKind, ValueAt>> kinds{
      {DepthKind::planar, room},
      {DepthKind::ray, [](double x, double y) { return room(x, y) * ray_length(x, y); }},
      {DepthKind::inverse, [](double x, double y) { return 1 / room(x, y); }}};
  for (const auto& [kind, value] : kinds)
    for (const auto& storage : kStorages) {
      const ValueAt& exact = value;  // clang 14 captures no structured binding
      const auto scores = scores_of(plane_of([&](double x, double y) { return storage.stored(exact(x, y)); }));
      ASSERT_FALSE(scores.empty()) << storage.name;
      EXPECT_EQ(scores[0].kind, kind) << storage.name << " " << scores[0].straight;
      EXPECT_GT(scores[0].straight, 0.05) << storage.name;
      EXPECT_LT(scores[1].straight, 0.1 * scores[0].straight) << storage.name;
    }
}

TEST(Flatness, of_an_orthographic_view_is_that_of_the_distances_themselves) {
  const auto slanted = plane_of([](double x, double y) { return 5 + 0.004 * x + 0.01 * y; });
  const auto scores = scores_of(slanted, true);
  ASSERT_FALSE(scores.empty());
  EXPECT_EQ(scores[0].kind, DepthKind::planar);
  EXPECT_GT(scores[0].straight, 0.9);
  EXPECT_EQ(scores_of(slanted)[0].kind, DepthKind::inverse) << "so they look as 1/z";
}

TEST(Flatness, of_what_is_curved_or_rough_or_too_coarse_speaks_for_no_kind) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.02, 0.02);
  const std::vector<std::pair<const char*, ValueAt>> values{
      {"waves", [](double x, double y) { return 6 + 0.3 * std::sin(x / 40) * std::cos(y / 31) + x / 300; }},
      {"noise", [&](double x, double y) { return room(x, y) * (1 + noise(random)); }},
      {"five steps", [](double x, double y) { return std::round(room(x, y)); }}};
  for (const auto& [name, value] : values) {
    const auto scores = scores_of(plane_of(value));
    EXPECT_LT(scores.empty() ? 0 : scores[0].straight, 0.02) << name;
  }
}

TEST(Flatness, of_a_small_picture_counts_each_block_once) {
  View view = view_of_tests();
  view.size = {64, 36};
  std::vector<float> plane;
  for (int y = 0; y < 36; y++)
    for (int x = 0; x < 64; x++) plane.push_back(float(-0.8 - std::log(0.1 + 0.002 * x + 0.001 * y)));  // of no kind
  constexpr std::size_t kSide = 9, kStep = kSide / 4;
  const std::size_t planes = shape_of(plane, view, kSky, {}).curve.planes;
  EXPECT_GT(planes, 20);
  EXPECT_LE(planes, ((64 - kSide) / kStep + 1) * ((36 - kSide) / kStep + 1));
}

TEST(Grain, of_a_few_values_is_told_where_they_are_no_walls) {
  const auto grain = [](const ValueAt& value, bool orthographic = false) {
    return grain_of(plane_of(value), kSky, orthographic);
  };
  for (const double per_unit : {1.0, 2.0, 5.0}) {
    const auto rounded = [=](double x, double y) { return std::round(per_unit * room(x, y)) / per_unit; };
    EXPECT_NEAR(grain(rounded).step, 1 / per_unit, 1e-5);
    EXPECT_TRUE(grain(rounded).is_coarse && grain(rounded).is_fixed);
    EXPECT_EQ(grain(rounded, true).step, 0) << "stairs from above";
    EXPECT_EQ(grain([=](double x, double y) { return rounded(x, y) / 240; }).step, 0) << "walls within a range";
  }
  EXPECT_EQ(grain([](double x, double) { return 2.17 + 0.3 * std::floor(x / 25); }).step, 0) << "shelves";
  EXPECT_EQ(grain([](double x, double) { return 10 * std::floor(1 + x / 90); }).step, 0) << "a few cards";
}

TEST(Grain, is_the_step_of_the_values_and_not_of_their_type) {
  const auto grain = [](const std::function<double(double)>& stored) {
    return grain_of(plane_of([&](double x, double y) { return stored(room(x, y)); }), kSky);
  };
  for (const auto& storage : kStorages) {
    const Grain found = grain(storage.stored);
    const bool is_half = std::string(storage.name).starts_with("half"), is_exact = storage.name == std::string("exact");
    EXPECT_EQ(found.is_half, is_half) << storage.name;
    EXPECT_EQ(found.is_fixed, !is_half && !is_exact) << storage.name;
    EXPECT_EQ(found.is_coarse, !is_exact && !std::string(storage.name).starts_with("16")) << storage.name;
  }
  EXPECT_NEAR(grain(kStorages[3].stored).step, 0.001, 1e-6);
  EXPECT_NEAR(grain(kStorages[4].stored).step, 1, 1e-3);
  EXPECT_EQ(grain([](double) { return 3.0; }).step, 0) << "one wall tells nothing";
  int pixel = 0;
  const Grain below_sky = grain_of(
      plane_of([&](double x, double y) { return pixel++ % 5 < 3 ? 65504.0 : kStorages[3].stored(room(x, y)); }), kSky);
  EXPECT_TRUE(below_sky.is_coarse) << "beside a finite sky on most pixels";
  EXPECT_LT(below_sky.median, 100);
  EXPECT_EQ(grain_of({}, kSky).median, 0);
  EXPECT_EQ(grain_of(plane_of([](double x, double) { return 6 + x / 256; }), kSky).step, 0)
      << "a plane with one step from column to column was not rounded";
  EXPECT_EQ(grain_of(plane_of([](double, double y) { return y < 60 ? 6 : 300 / (y - 10); }), kSky).step, 0)
      << "nor was a floor whose rows are few distances";
}

TEST(Jitter, is_that_of_random_places_within_pixels) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  DepthMap map;
  const auto jitter = [&](const ValueAt& value) {
    const auto raw = plane_of(value);
    return jitter_of(raw, map, view_of_tests(), grain_of(raw, kSky));
  };
  const auto mean_of = [&](int samples) {
    return [&, samples](double x, double y) {
      double sum = 0;
      for (int i = 0; i < samples; i++) sum += room(x + within(random), y + within(random));
      return sum / samples;
    };
  };
  EXPECT_NEAR(jitter(mean_of(1)).value_or(0), 0.29, 0.03);
  EXPECT_NEAR(jitter(mean_of(4)).value_or(0), 0.145, 0.02);
  for (const auto& storage : kStorages)
    EXPECT_FALSE(jitter([&](double x, double y) { return storage.stored(room(x, y)); })) << storage.name;
  EXPECT_FALSE(jitter([&](double x, double y) { return room(x, y) + 0.002 * within(random); }))
      << "relief of one height";
}

}  // namespace
}  // namespace alcove::flatness_test
