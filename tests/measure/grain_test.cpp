// Grain and mottle against closed forms and against their definitions, written out slowly; and the limit of grain as
// scripts see it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/metrics.h"
#include "tests/support/command_line.h"

namespace alcove::grain_test {
namespace {

using namespace test;
using Plane = std::vector<float>;
using Bytes = std::vector<std::uint8_t>;

constexpr double kSky = 1e9;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// The plain pixels of a plane are those at least 8 from the border: 32 x 32, whole periods of stripes of 8 and 16.
constexpr int kSide = 48, kBorder = 8, kPlainSide = kSide - 2 * kBorder;
constexpr Window kWindow{0, 0, kSide, kSide};

template <class Function>
Plane plane_of(Function function) {
  Plane plane;
  for (int y = 0; y < kSide; y++)
    for (int x = 0; x < kSide; x++) plane.push_back(float(function(x, y)));
  return plane;
}

Plane constant(float value) { return Plane(kWindow.pixels(), value); }

/// A plane that a perspective camera sees at a slant.
Plane slanted() {
  return plane_of([](int x, int y) { return 1 / (0.1 + 0.002 * x - 0.001 * y); });
}

Plane stripes(double amplitude, int period_x, int period_y) {
  return plane_of([&](int x, int y) {
    const double phase = (period_x ? double(x) / period_x : 0) + (period_y ? double(y) / period_y : 0);
    return amplitude * std::sin(2 * std::numbers::pi * phase);
  });
}

std::size_t at(int x, int y) { return std::size_t(y * kSide + x); }

int count_of(const Bytes& plain) { return int(std::ranges::count(plain, 1)); }

Bytes plain_of(const Plane& depth, Mask mask = {}) { return plain_pixels(kSide, kSide, depth, kSky, mask); }

std::optional<double> grain_of(const Plane& result, const Plane& reference, Values reference_b = {}) {
  return grain(kSide, kSide, plain_of(slanted()), result, reference, reference_b);
}

/// By how much 15 equal weights damp stripes of a period along their axis.
double damping(int period) {
  const double half = std::numbers::pi / period;
  return std::sin(15 * half) / (15 * std::sin(half));
}

// The definition.

/// A frame of planes, steps, sky and pixels that do not count, with errors everywhere.
struct RandomFrame {
  Plane depth, result, a, b;
  Bytes mask;

  explicit RandomFrame(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const double fold = 10 + 40 * unit(random), step = 30 * unit(random);
    depth = plane_of([&](int x, int y) {
      const double inverse = 0.2 + 0.003 * y + (x > fold ? 0.002 * (x - fold) : 0) + (y < step - 12 ? 0.1 : 0);
      const float sky[]{1e10f, 0, kNan, std::numeric_limits<float>::infinity(), -1};
      return unit(random) < 5e-4 ? double(sky[seed % 5]) : 1 / inverse;
    });
    for (Plane* plane : {&result, &a, &b}) *plane = plane_of([&](int, int) { return unit(random); });
    for (std::size_t i = 0; i < depth.size(); i++) mask.push_back(unit(random) > 5e-4);
  }
};

bool is_plain_by_definition(const RandomFrame& frame, int x, int y) {
  const auto inverse = [&](int i, int j) {
    const double z = frame.depth[at(i, j)];
    return z > 0 && z < kSky ? 1 / z : 0;
  };
  for (int j = y - 7; j <= y + 7; j++)
    for (int i = x - 7; i <= x + 7; i++) {
      if (i < 1 || j < 1 || i >= kSide - 1 || j >= kSide - 1) return false;
      const double here = inverse(i, j);
      if (here == 0 || !frame.mask[at(i, j)]) return false;
      if (inverse(i - 1, j) * inverse(i + 1, j) * inverse(i, j - 1) * inverse(i, j + 1) == 0) return false;
      if (std::abs(inverse(i - 1, j) + inverse(i + 1, j) - 2 * here) >= 1e-4 * here) return false;
      if (std::abs(inverse(i, j - 1) + inverse(i, j + 1) - 2 * here) >= 1e-4 * here) return false;
    }
  return true;
}

double residual_by_definition(const RandomFrame& frame, const Plane& truth, int x, int y) {
  const auto error = [&](int i, int j) { return double(frame.result[at(i, j)]) - truth[at(i, j)]; };
  double sum = 0;
  for (int j = y - 7; j <= y + 7; j++)
    for (int i = x - 7; i <= x + 7; i++) sum += error(i, j);
  return error(x, y) - sum / 225;
}

TEST(Grain, is_what_its_definition_says) {
  int measured = 0;
  for (unsigned seed = 0; seed < 20; seed++) {
    const RandomFrame frame(seed);
    const Bytes plain = plain_of(frame.depth, frame.mask);
    double sum = 0;
    int count = 0;
    for (int y = 0; y < kSide; y++)
      for (int x = 0; x < kSide; x++) {
        const bool expected = is_plain_by_definition(frame, x, y);
        ASSERT_EQ(plain[at(x, y)], expected) << "seed " << seed << " pixel " << x << ", " << y;
        if (!expected) continue;
        sum += residual_by_definition(frame, frame.a, x, y) * residual_by_definition(frame, frame.b, x, y);
        count++;
      }
    const auto value = grain(kSide, kSide, plain, frame.result, frame.a, frame.b);
    ASSERT_EQ(value.has_value(), count > 0) << seed;
    if (!value) continue;
    EXPECT_NEAR(*value, std::sqrt(std::max(0.0, sum / count)), 1e-12) << seed;
    measured++;
  }
  EXPECT_GE(measured, 10) << "frames with plain pixels";
}

// Which pixels are plain.

TEST(PlainPixels, need_17_pixels_either_way) {
  EXPECT_THAT(plain_pixels(16, 48, Plane(16 * 48, 5), kSky), Each(0));
  EXPECT_THAT(plain_pixels(48, 16, Plane(16 * 48, 5), kSky), Each(0));
  EXPECT_EQ(count_of(plain_pixels(17, 17, Plane(17 * 17, 5), kSky)), 1);
  EXPECT_THAT(plain_pixels(1, 1, Plane{5}, kSky), Each(0));
}

TEST(PlainPixels, take_the_sky_for_no_surface_that_is_infinitely_far) {
  // 1/z rises evenly from column 10 on, as if the sky there were a part of the plane.
  const Bytes plain = plain_of(plane_of([](int x, int) { return x <= 10 ? 1e10 : 1 / (0.01 * (x - 10)); }));
  EXPECT_FALSE(plain[at(18, 24)]) << "11 has no neighbour";
  EXPECT_TRUE(plain[at(19, 24)]);
}

TEST(PlainPixels, bend_by_less_than_a_ten_thousandth) {
  for (const bool along_x : {true, false}) {
    const auto bent = [&](double bend) {
      return plane_of([&](int x, int y) { return 1 / (1 + 0.5 * bend * std::pow((along_x ? x : y) - kSide / 2, 2)); });
    };
    EXPECT_EQ(count_of(plain_of(bent(0.95e-4))), kPlainSide * kPlainSide);
    EXPECT_EQ(count_of(plain_of(bent(-0.95e-4))), kPlainSide * kPlainSide);
    EXPECT_THAT(plain_of(bent(1.05e-4)), Each(0));
    EXPECT_THAT(plain_of(bent(-1.05e-4)), Each(0));
  }
}

TEST(PlainPixels, of_an_orthographic_camera_are_those_of_planes_that_are_not_too_steep) {
  const auto tilted = [](double slope) { return plane_of([&](int x, int) { return 10 + slope * x; }); };
  EXPECT_EQ(count_of(plain_of(tilted(0.05))), kPlainSide * kPlainSide);  // 2 (slope / z)^2 is 5e-5 at most
  EXPECT_THAT(plain_of(tilted(0.5)), Each(0));
}

// How much grain there is.

TEST(Grain, of_a_bias_and_of_a_gradient_is_0) {
  EXPECT_NEAR(*grain_of(constant(0.75f), constant(0.5f)), 0, 1e-15);
  const Plane gradient = plane_of([](int x, int y) { return (x + 2 * y) / 256.0; });
  EXPECT_NEAR(*grain_of(gradient, constant(0.5f)), 0, 1e-15);
}

TEST(Grain, of_stripes_is_their_rms_less_what_the_mean_takes) {
  for (const int period : {2, 4, 8, 16}) {
    // Stripes of two pixels are a cosine: a sine is 0 at every pixel.
    const double rms = period == 2 ? 0.125 : 0.125 / std::numbers::sqrt2;
    const Plane along_x =
        period == 2 ? plane_of([](int x, int) { return x % 2 ? 0.125 : -0.125; }) : stripes(0.125, period, 0);
    EXPECT_NEAR(*grain_of(along_x, constant(0)), rms * (1 - damping(period)), 1e-8) << period;
    if (period == 2) continue;
    EXPECT_NEAR(*grain_of(stripes(0.125, 0, period), constant(0)), rms * (1 - damping(period)), 1e-8) << period;
    EXPECT_NEAR(*grain_of(stripes(0.125, period, period), constant(0)), rms * (1 - std::pow(damping(period), 2)), 1e-8)
        << period << " diagonally";
  }
}

TEST(Grain, of_two_references_is_free_of_their_noise) {
  const Plane result = stripes(0.125, 8, 0), a = stripes(0.25, 0, 8), b = stripes(0.5, 16, 16);
  EXPECT_NEAR(*grain_of(result, a, b), 0.125 / std::numbers::sqrt2 * (1 - damping(8)), 1e-8);
  EXPECT_GT(*grain_of(result, a), 0.19);
  EXPECT_EQ(grain_of(constant(0), stripes(0.25, 8, 0), stripes(-0.25, 8, 0)), 0) << "a negative mean is no grain";
}

TEST(Grain, of_several_planes_is_the_root_of_their_mean_square) {
  const auto both = [](Plane first, const Plane& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
  };
  EXPECT_NEAR(*grain_of(both(constant(0), stripes(0.125, 8, 0)), both(constant(0), constant(0))),
              0.125 / 2 * (1 - damping(8)), 1e-8);
}

// Mottle.

/// A step of depth, a crease that normals alone show, a hole of sky, and light that falls from 1 to 0.
struct ShadedFrame {
  Plane depth = plane_of([](int x, int y) { return x == 40 && y == 20 ? 1e10 : y < 9 ? 5 : 1 / (0.3 + 2e-4 * x * x); });
  Plane light = plane_of([](int x, int y) { return std::clamp(1.15 - 0.03 * x + 0.002 * (y % 3), 0.0, 1.0); });
  Plane normal = plane_of([](int, int y) { return y < 30 ? 0 : 0.28; });  // x, y and z

  ShadedFrame() {
    const Plane z = plane_of([](int, int y) { return y < 30 ? 1 : 0.96; });
    normal.insert(normal.end(), kWindow.pixels(), 0.0f);
    normal.insert(normal.end(), z.begin(), z.end());
  }
};

bool is_edge_by_definition(const ShadedFrame& frame, const Plane& normal, int x, int y) {
  if (x < 1 || y < 1 || x >= kSide - 1 || y >= kSide - 1) return true;
  for (const std::size_t step : {1, kSide}) {
    const std::size_t i = at(x, y);
    const auto inverse = [&](std::size_t j) { return frame.depth[j] < kSky ? 1.0 / frame.depth[j] : 0; };
    if (inverse(i) == 0 || inverse(i - step) == 0 || inverse(i + step) == 0) return true;
    if (std::abs(inverse(i - step) + inverse(i + step) - 2 * inverse(i)) >= 1e-3 * inverse(i)) return true;
    double cosine = normal.empty() ? 1 : 0;
    for (std::size_t c = 0; c < normal.size(); c += frame.depth.size()) cosine += normal[c + i] * normal[c + i - step];
    if (cosine <= 0.98) return true;
  }
  return false;
}

TEST(Mottle, is_looked_for_where_its_definition_says) {
  const ShadedFrame frame;
  for (const Plane& normal : {frame.normal, Plane()}) {
    const auto is_smooth = [&](int x, int y) {
      for (int j = y - 2; j <= y + 2; j++)
        for (int i = x - 2; i <= x + 2; i++)
          if (is_edge_by_definition(frame, normal, i, j)) return false;
      return true;
    };
    const Bytes half = half_shadow(kSide, kSide, frame.depth, kSky, normal, frame.light);
    int smooth = 0;
    for (int y = 0; y < kSide; y++)
      for (int x = 0; x < kSide; x++) {
        double sum = 0;
        int count = 0;
        for (int j = y - 4; j <= y + 4; j++)
          for (int i = x - 4; i <= x + 4; i++) {
            if (!is_smooth(i, j)) continue;
            sum += frame.light[at(i, j)];
            count++;
          }
        smooth += is_smooth(x, y);
        ASSERT_EQ(half[at(x, y)], is_smooth(x, y) && sum > 0.2 * count && sum < 0.97 * count) << x << ", " << y;
      }
    EXPECT_GT(count_of(half), 200);
    EXPECT_GT(smooth, count_of(half) + 200) << "light and darkness";
  }
}

TEST(Mottle, of_known_deviations_is_their_rms) {
  // The deviations of -d, 0, d are d, and those of three times the same 0.
  const Plane deviation = plane_of([](int x, int y) { return y >= 40 ? 100 : x % 2 ? 0.06 : 0.08; });
  std::vector<Plane> results(3, constant(0.5f));
  for (std::size_t i = 0; i < deviation.size(); i++) {
    results[0][i] -= deviation[i];
    results[2][i] += deviation[i];
  }
  Bytes half(kWindow.pixels(), 1);
  std::fill(half.begin() + 40 * kSide, half.end(), std::uint8_t(0));
  EXPECT_NEAR(mottle(half, results).value(), std::sqrt((0.06 * 0.06 + 0.08 * 0.08) / 2), 1e-7);
  for (int x = 1; x < kSide; x += 2)
    for (int y = 0; y < kSide; y++) results[1][at(x, y)] = kNan;
  EXPECT_NEAR(mottle(half, results).value(), 0.08, 1e-7) << "without the pixels that are NaN";
  EXPECT_EQ(mottle(half, std::vector<Plane>(3, deviation)), 0);
  EXPECT_EQ(mottle(Bytes(half.size(), 0), results), std::nullopt);
}

// The command.

class GrainCommand : public CompareCommand {
 protected:
  GrainCommand() {
    Plane result = stripes(0.125, 8, 0);
    for (auto& value : result) value += 0.5f;
    striped = exr("striped.exr", "Y", result);
    grey = exr("grey.exr", "Y", constant(0.5f));
    plane = exr("plane.exr", "Z", slanted());
    rough = exr("rough.exr", "Z", plane_of([](int x, int y) { return 5 + (x + y) % 2; }));
  }

  std::string exr(const std::string& name, const std::string& channel, const Plane& values) const {
    return exr_of(name, {{channel, values}}, kWindow);
  }

  std::string striped, grey, plane, rough;
  const double expected = 0.125 / std::numbers::sqrt2 * (1 - damping(8));  // 0.0943
};

TEST_F(GrainCommand, measures_where_depth_shows_plain_surfaces) {
  EXPECT_NEAR(measured({striped, grey, "--depth", plane})["grain"], expected, 1e-7);
  EXPECT_EQ(measured({grey, grey, "--depth", plane})["grain"], 0);
  for (const json& j : {measured({striped, grey}), measured({striped, grey, "--depth", rough})}) {
    ASSERT_TRUE(j.contains("grain"));
    EXPECT_TRUE(j["grain"].is_null());
  }
}

TEST_F(GrainCommand, takes_out_the_noise_of_a_second_reference) {
  const std::string a = exr("a.exr", "Y", stripes(0.25, 0, 8)), b = exr("b.exr", "Y", stripes(0.5, 16, 16));
  EXPECT_NEAR(measured({striped, a, "--reference-b", b, "--depth", plane})["grain"], expected, 1e-7);
}

TEST_F(GrainCommand, leaves_out_masked_pixels_and_nan) {
  Plane broken = constant(0.5f), mask = constant(1);
  broken[at(14, 24)] = kNan;
  mask[at(33, 24)] = 0;
  broken[at(33, 24)] = 1000;
  const json j = measured({exr("broken.exr", "Y", broken), grey, "--depth", plane, "--mask", exr("m.exr", "Y", mask)});
  EXPECT_EQ(j["grain"], 0);
  Plane unmasked = constant(0.5f);
  unmasked[at(33, 24)] = 1000;
  EXPECT_GT(measured({exr("unmasked.exr", "Y", unmasked), grey, "--depth", plane})["grain"], 1);
  for (int y = 0; y < kSide; y += 15)
    for (int x = 0; x < kSide; x += 15) broken[at(x, y)] = kNan;
  EXPECT_TRUE(measured({exr("holes.exr", "Y", broken), grey, "--depth", plane})["grain"].is_null());
}

TEST_F(GrainCommand, stands_in_the_table_and_on_the_page) {
  const std::string page = folder / "page.html";
  EXPECT_THAT(compare({striped, grey, "--depth", plane, "--report", page}).out, HasSubstr("grain 0.0943\n"));
  EXPECT_THAT(compare({striped, grey}).out, HasSubstr("grain -\n"));
  EXPECT_THAT(read_bytes(page), AllOf(HasSubstr("\"grain\": 0.0942"), HasSubstr("heading: 'grain'")));
}

TEST_F(GrainCommand, its_limit_holds_or_breaks) {
  EXPECT_EQ(compare({striped, grey, "--depth", plane, "--max-grain", "0.0943"}).code, 0);
  EXPECT_EQ(compare({grey, grey, "--depth", plane, "--max-grain", "0"}).code, 0);
  expect_error(6, {striped, grey, "--depth", plane, "--max-grain", "0.0942"},
               {"grain is 0.0942809, and --max-grain is 0.0942"});
  expect_error(2, {striped, grey, "--depth", plane, "--max-grain", "-1"}, {"--max-grain", "0 or more"});
}

TEST_F(GrainCommand, its_limit_without_depth_is_a_mistake) {
  expect_error(2, {striped, grey, "--max-grain", "0.1"}, {"--max-grain 0.1", "--depth FILE.exr"});
}

TEST_F(GrainCommand, its_limit_without_plain_pixels_is_an_input_that_cannot_be_checked) {
  const std::vector<std::string> arguments{striped, grey, "--depth", rough, "--max-grain", "0.1"};
  expect_error(3, arguments,
               {"grain cannot be measured in " + striped, "--depth shows no 15 x 15", "--max-grain is 0.1"});
  const json j = measured(arguments, 3);
  EXPECT_EQ(j["pass"], false);
  EXPECT_EQ(j["broken"].size(), 1);
}

TEST_F(GrainCommand, of_a_sequence_is_that_of_its_worst_frame) {
  exr("ao.1.exr", "Y", constant(0.5f));
  exr("ao.2.exr", "Y", stripes(0.125, 8, 0));
  exr("z.1.exr", "Z", slanted());
  exr("z.2.exr", "Z", slanted());
  std::vector<std::string> arguments{folder / "ao.%d.exr", grey, "--depth", folder / "z.%d.exr"};
  const json j = measured(arguments);
  EXPECT_NEAR(j["grain"], expected, 1e-7);
  EXPECT_NEAR(j["mean"]["grain"], expected / 2, 1e-7);
  EXPECT_EQ(j["frames"][0]["grain"], 0);
  EXPECT_THAT(compare(arguments).out, AllOf(HasSubstr("   grain\n"), HasSubstr("   0.0943\n")));
  arguments.insert(arguments.end(), {"--max-grain", "0.05"});
  expect_error(6, arguments, {"frame 2: grain is 0.0942809, and --max-grain is 0.05"});
  exr("z.1.exr", "Z", plane_of([](int x, int) { return 5 + x % 2; }));
  expect_error(3, arguments, {"frame 1: grain cannot be measured in " + folder.path() + "/ao.1.exr"});
}

}  // namespace
}  // namespace alcove::grain_test
