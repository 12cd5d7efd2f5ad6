// The quick search: its margin, what it gives for scenes whose AO is known, and where another search
// takes its place.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/scenes.h"
#include "tests/support/site_frames.h"

namespace alcove::quick_test {
namespace {

using namespace test;

/// The quick search, with so many samples that its noise is small where they are not the preset's.
EstimatorSettings quick(double radius, int slices = 2, int steps = 12) {
  EstimatorSettings settings = preset("draft", radius);
  settings.slices = slices;
  settings.steps = steps;
  settings.stride = 16;
  return settings;
}

// The margin.

TEST(Margin, shows_a_plane_where_it_goes_on_and_nothing_of_sky) {
  for (const bool orthographic : {false, true}) {
    const Scene wall{{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.2, 0.3})}}};
    Shot shot =
        orthographic ? Shot::orthographic({}, {1, 0, 0}, 1, 40, 30) : Shot::perspective({}, {1, 0, 0}, 12, 40, 30);
    const Prepared frame = prepared(render(wall, shot).frame);
    shot.data = {-kDepthMargin, -kDepthMargin, 40 + 2 * kDepthMargin, 30 + 2 * kDepthMargin};
    const HostFrame around = render(wall, shot).frame;
    const gpu::Buffer& buffer = margin(recorder(), frame.gbuffer);
    sites(recorder(), frame.gbuffer, {16, true}, "", &buffer);
    const auto wide = downloaded<float>(buffer);
    ASSERT_EQ(wide.size(), around.depth.size());
    std::size_t told = 0;
    for (std::size_t i = 0; i < wide.size(); i++) {
      const int x = int(i) % (40 + 2 * kDepthMargin) - kDepthMargin,
                y = int(i) / (40 + 2 * kDepthMargin) - kDepthMargin;
      const bool is_inside = x >= 0 && y >= 0 && x < 40 && y < 30;
      if (wide[i] == kSkyDepth) continue;  // it would be more than twice as far, or half
      ASSERT_NEAR(wide[i], is_inside ? around.depth[i] : -around.depth[i], 2e-3 * around.depth[i]) << x << " " << y;
      told++;
    }
    EXPECT_GT(told, wide.size() / 2);
  }
}

TEST(Margin, keeps_a_crease_dark_that_leaves_the_picture) {
  const Scene scene{{kFloor, kWallX}};
  const Rendering whole = render(scene, Shot::perspective({2.4, -1, 1.5}, {0.3, 0, 0.2}, 60, 160, 120));
  const Window window{50, 0, 110, 120};
  const auto all = ao_of(whole.frame, quick(0.5, 4, 32)), part = ao_of(crop_of(whole.frame, window), quick(0.5, 4, 32));
  double bias = 0, dark = 0;
  int count = 0;
  for (int y = 0; y < 120; y++)
    for (int x = 0; x < 6; x++) {
      const double truth = all[std::size_t(y * 160 + x + window.x)];
      if (truth > 0.9) continue;
      bias += part[std::size_t(y * window.width + x)] - truth;
      dark += 1 - truth;
      count++;
    }
  ASSERT_GT(count, 60);
  EXPECT_LT(std::abs(bias), 0.1 * dark) << "without a margin the border misses .3 of it";
}

// The search.

/// The truth beside an endless bar of a rectangle's section over a floor, by even directions of the cosine-weighted
/// hemisphere. The bar lies along y from `left` to `right` and from `low` to `high`.
double beside_bar(Vec3 point, double left, double right, double low, double high, double radius) {
  constexpr int kSide = 96;
  double open = 0;
  for (int i = 0; i < kSide; i++)
    for (int j = 0; j < kSide; j++) {
      const double r = std::sqrt((i + 0.5) / kSide), angle = 2 * kPi * (j + 0.5) / kSide;
      const Vec3 d{r * std::cos(angle), r * std::sin(angle), std::sqrt(1 - r * r)};
      const double a = (left - point.x) / d.x, b = (right - point.x) / d.x;
      const double enters = std::max(std::min(a, b), (low - point.z) / d.z);
      const double leaves = std::min(std::max(a, b), (high - point.z) / d.z);
      open += enters > leaves || leaves < 0 || enters > radius ? 1 : 0;
    }
  return open / (kSide * kSide);
}

// Seen from above, a bar hides its sides. Most slices see less than its width between two samples, so twice that is
// less than two widths.
TEST(Quick, takes_a_bar_for_thicker_than_wide) {
  constexpr double kHigh = 0.6, kHalf = 0.06, kRadius = 1;
  Scene scene{{kFloor}};
  scene.add(parallelepiped({-kHalf, -9, kHigh - 0.01}, {2 * kHalf, 0, 0}, {0, 18, 0}, {0, 0, 0.01}));
  for (const bool orthographic : {true, false}) {
    const Vec3 eye{0, 0.001, 40}, target{0, 0, 0};
    const Rendering seen = render(scene, orthographic ? Shot::orthographic(eye, target, 3, 150, 150)
                                                      : Shot::perspective(eye, target, 4.3, 150, 150));
    const auto ao = ao_of(seen.frame, quick(kRadius, 16, 64));
    const auto error = [&](double depth) {
      double sum = 0;
      int count = 0;
      for (int x = 50; x < 100; x++) {
        const Hit& hit = seen.at(x, 75);
        if (hit.position.z > 0.01 || std::abs(hit.position.x) > 0.45 || std::abs(hit.position.x) < 0.1) continue;
        sum += ao[std::size_t(75 * 150 + x)] - beside_bar(hit.position, -kHalf, kHalf, kHigh - depth, kHigh, kRadius);
        count++;
      }
      return sum / count;
    };
    const double width = 2 * kHalf;
    EXPECT_LT(error(1.25 * width), -0.01) << orthographic;
    EXPECT_GT(error(2 * width), 0.01) << orthographic;
  }
}

TEST(Quick, gives_a_crease_its_closed_form) {
  for (const bool orthographic : {false, true}) {
    const Vec3 eye{3, 3.4, 2.6}, target{0.4, 0.4, 0.2};
    const Shot shot =
        orthographic ? Shot::orthographic(eye, target, 4, 240, 200) : Shot::perspective(eye, target, 55, 240, 200);
    const Rendering seen = render({{kFloor, kWallX}}, shot);
    const Errors errors = errors_of(seen, ao_of(seen.frame, quick(0.5, 8, 48)), wall_truth(shot, 0.5), 2);
    ASSERT_GT(errors.pixels.size(), 3000);
    EXPECT_LT(errors.mean, 0.02) << orthographic;
    EXPECT_LT(std::abs(errors.bias), 0.01) << orthographic;
  }
}

TEST(Quick, finds_what_the_general_search_finds) {
  const HostFrame room = furnished_room(160, 120).frame;
  EstimatorSettings general = quick(0.5, 8, 48);
  general.search = SliceSearch::steps;
  general.stride = 1;
  const auto truth = ao_of(room, general);
  EXPECT_LT(difference(ao_of(room, quick(0.5, 8, 48)), truth).rmse, 0.04);
  EXPECT_LT(difference(ao_of(room, quick(0.5)), truth).rmse, 0.06);
}

// Where another search takes its place.

bool is_quick(const EstimatorSettings& settings, const std::string& aovs = "ao") {
  const auto passes = planes_of(furnished_room(32, 24).frame, settings, aovs).passes;
  const auto runs = [&](const char* name) { return std::ranges::find(passes, name) != passes.end(); };
  EXPECT_NE(runs("quick_horizon"), runs("horizon"));
  return runs("quick_horizon");
}

TEST(Quick, leaves_what_it_does_not_know_to_the_general_search) {
  EXPECT_TRUE(is_quick(quick(0.5)));
  EXPECT_TRUE(is_quick(quick(0.5), "ao,normal,depth"));
  EstimatorSettings by_radius = quick(0.5);
  by_radius.denoise_radius = 5;
  EXPECT_TRUE(is_quick(by_radius)) << "the filter has no say";
  EXPECT_FALSE(is_quick(quick(0.5), "ao,bent-normal"));
  using Change = void (*)(EstimatorSettings&);
  for (const Change change : std::initializer_list<Change>{
           [](auto& s) { s.further_radii = {0.2}; }, [](auto& s) { s.falloff = Falloff::linear; },
           [](auto& s) { s.thickness = ThicknessKind::infinite; }, [](auto& s) { s.complete = Completion::border; },
           [](auto& s) { s.density = Density::uniform; }, [](auto& s) { s.estimator = Estimator::bitmask; }}) {
    EstimatorSettings settings = quick(0.5);
    change(settings);
    EXPECT_FALSE(is_quick(settings)) << name_of(settings);
  }
}

}  // namespace
}  // namespace alcove::quick_test
