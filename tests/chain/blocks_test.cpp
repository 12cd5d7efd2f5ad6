// The filter that gives all pixels what the sites of blocks have.
// SPDX-License-Identifier: BSD-3-Clause
#include <bit>

#include "core/base/half.h"
#include "core/chain/estimate/sites.h"
#include "core/chain/filters/filters.h"
#include "tests/support/chain.h"
#include "tests/support/site_frames.h"

namespace alcove::blocks_test {
namespace {

using namespace test;

/// A frame's sites, and the filter of so many slices over them.
struct Chosen {
  Prepared frame;
  Sites sites;
  Picture picture;
  Denoiser denoiser;

  explicit Chosen(const HostFrame& host, int slices = 2, double radius = 1)
      : frame(prepared(host)),
        sites(alcove::sites(recorder(), frame.gbuffer, {16, true})),
        picture(picture_of(sites, frame.gbuffer)) {
    EstimatorSettings settings;
    settings.radius = radius;
    settings.slices = slices;
    denoiser = denoiser_of(settings);
  }
  /// A plane with a visibility at the sites, and nothing elsewhere.
  template <class Visibility>
  std::vector<float> planes_of(const Visibility& visibility) const {
    std::vector<float> plane(picture.sites.size(), kNan);
    for (int y = 0; y < picture.height; y++)
      for (int x = 0; x < picture.width; x++)
        if (picture.is_site(x, y)) plane[picture.index(x, y)] = float(visibility(x, y));
    return plane;
  }
  std::vector<float> filtered(const std::vector<float>& planes, uint moments = 0) const {
    return downloaded<float>(
        smooth(recorder(), frame.gbuffer, given("planes of a test", planes), sites, denoiser, "", moments));
  }
  template <class Visibility>
  std::vector<float> filtered(const Visibility& visibility) const {
    return filtered(planes_of(visibility));
  }
};

TEST(Blocks, leave_a_straight_gradient_as_it_is) {
  const Chosen chosen(wall_at(3, 2, 61, 47, unit({-1, 0.3, 0.2}), false));
  const auto gradient = [](int x, int y) { return 0.3 + 0.006 * x + 0.004 * y; };
  const auto ao = chosen.filtered(gradient);
  // Slopes are held back, and beside the border a plane has sites on one side only.
  for (int y = 0; y < 47; y++)
    for (int x = 0; x < 61; x++) {
      const bool is_inside = x >= 13 && y >= 13 && x < 48 && y < 34;
      ASSERT_NEAR(ao[std::size_t(y * 61 + x)], gradient(x, y), is_inside ? 1e-3 : 0.04) << x << " " << y;
    }
}

/// The plane of least squares through sites about one of them: at that site, and its slopes, which are held back by so
/// many px^2.
std::array<double, 3> fitted_slowly(const std::vector<std::array<double, 3>>& sites, double x, double y, double reach,
                                    double held) {
  double weight = 0, sum = 0, xs = 0, ys = 0, rise_x = 0, rise_y = 0, xx = 0, xy = 0, yy = 0;
  for (const auto& [u, v, blocked] : sites) {
    const double dx = u - x, dy = v - y, w = std::max(0.0, 1 - (dx * dx + dy * dy) / (reach * reach));
    weight += w, sum += w * blocked, xs += w * dx, ys += w * dy, rise_x += w * dx * blocked, rise_y += w * dy * blocked;
    xx += w * dx * dx, xy += w * dx * dy, yy += w * dy * dy;
  }
  const double mean = sum / weight;
  xx += held * weight - xs * xs / weight, yy += held * weight - ys * ys / weight, xy -= xs * ys / weight;
  rise_x -= xs * mean, rise_y -= ys * mean;
  const double whole = xx * yy - xy * xy;
  const double slope_x = (yy * rise_x - xy * rise_y) / whole, slope_y = (xx * rise_y - xy * rise_x) / whole;
  return {std::clamp(mean - (slope_x * xs + slope_y * ys) / weight, 0.0, 1.0), slope_x, slope_y};
}

TEST(Blocks, fit_a_plane_to_their_sites) {
  for (const int slices : {2, 4}) {
    const Chosen chosen(wall_at(1, 3, 57, 45, {-1, 0, 0}, false), slices, 1.1);
    std::mt19937 random(9);
    std::vector<std::array<double, 3>> sites;
    const auto noise = chosen.planes_of([&](int x, int y) {
      const double visibility = double(random() % 1000) / 1000;
      sites.push_back({double(x), double(y), 1 - visibility});
      return visibility;
    });
    const auto& of = *chosen.denoiser.of_blocks;
    const double reach = chosen.denoiser.within.front() / chosen.frame.gbuffer.view.tangent_per_pixel.x / 5;
    ASSERT_THAT(reach, AllOf(testing::Gt(6), testing::Lt(9))) << "two blocks to each side";
    const auto fitted = downloaded<uint>(
        fit_blocks(recorder(), chosen.frame.gbuffer, given("planes of a test", noise), chosen.sites, chosen.denoiser));
    const SiteGrid grid = chosen.sites.grid;
    const auto number_of = [&](int x, int y) {
      const int u = x + grid.overhang.x, v = y + grid.overhang.y;
      return std::size_t((v % 4 * 4 + u % 4) * grid.blocks.x * grid.blocks.y + v / 4 * grid.blocks.x + u / 4);
    };
    for (const auto& [x, y, blocked] : sites) {
      const uint* words = &fitted[2 * number_of(int(x), int(y))];
      const auto expected = fitted_slowly(sites, x, y, reach, of.held);
      ASSERT_NEAR(std::bit_cast<float>(words[0]), expected[0], 1e-4) << x << " " << y;
      ASSERT_NEAR(from_half(std::uint16_t(words[1] & 0xffffu)), expected[1], 2e-4) << x << " " << y;
      ASSERT_NEAR(from_half(std::uint16_t(words[1] >> 16)), expected[2], 2e-4) << x << " " << y;
    }
  }
}

// The sites of a surface that others interrupt lie anywhere in their blocks: there slopes tell what pixels between them
// have.
TEST(Blocks, follow_slopes_between_sites_that_lie_anywhere) {
  HostFrame host = wall_at(0, 0, 64, 48, {-1, 0, 0}, false);
  const auto is_near = [](int x, int y) { return (x * 7 + y * 5) % 11 < 4; };
  for (int y = 0; y < 48; y++)
    for (int x = 0; x < 64; x++)
      if (is_near(x, y)) host.depth[std::size_t(y * 64 + x)] *= 0.8f;
  const Chosen chosen(host, 4, 2);
  const auto gradient = [](int x, int y) { return 0.1 + 0.008 * x + 0.006 * y; };
  const auto ao = chosen.filtered(gradient);
  double squares = 0;
  int count = 0;
  for (int y = 8; y < 40; y++)
    for (int x = 8; x < 56; x++, count++) squares += std::pow(ao[std::size_t(y * 64 + x)] - gradient(x, y), 2);
  EXPECT_LT(std::sqrt(squares / count), 2e-3);
}

// Moments and scales go the way of AO, all together.
TEST(Blocks, smooth_each_plane_as_if_it_were_alone) {
  const Chosen chosen(furnished_room(61, 47).frame);
  const std::size_t pixels = 61 * 47;
  std::mt19937 random(5);
  std::vector<float> planes(11 * pixels);
  for (float& value : planes) value = float(random() % 1000) / 1000;
  const std::vector<float> together = chosen.filtered(planes, 3);
  for (std::size_t p = 0; p < 11; p++) {
    const auto plane = [&](const std::vector<float>& all) {
      return std::vector<float>(all.begin() + long(p * pixels), all.begin() + long((p + 1) * pixels));
    };
    EXPECT_LT(difference(plane(together), chosen.filtered(plane(planes), p < 3 ? 1 : 0)).max, 2e-6) << p;
  }
}

TEST(Blocks, leave_sky_open_and_keep_what_is_constant) {
  HostFrame host = furnished_room(61, 47).frame;
  for (std::size_t i = 0; i < host.depth.size(); i++)
    if (i % 61 > 40) host.depth[i] = kSky;
  for (const auto& [constant, moments, sky] : {std::tuple{1.0F, 0u, 1.0F}, {0.3F, 0u, 1.0F}, {0.5F, 1u, 0.5F}}) {
    const auto ao = Chosen(host).filtered(std::vector<float>(host.depth.size(), constant), moments);
    for (std::size_t i = 0; i < ao.size(); i++)
      ASSERT_NEAR(ao[i], host.depth[i] < host.sky ? constant : sky, constant == 1 ? 0 : 1e-6)
          << i % 61 << " " << i / 61;
  }
}

TEST(Blocks, share_their_noise) {
  const Chosen chosen(wall_at(0, 0, 64, 48, unit({-1, 0.3, 0.2}), false));
  std::mt19937 random(3);
  double squares = 0, mean = 0;
  const auto ao = chosen.filtered([&](int, int) { return random() % 2 ? 0.6 : 0.4; });
  for (const float value : ao) mean += value / double(ao.size());
  for (const float value : ao) squares += (value - mean) * (value - mean) / double(ao.size());
  EXPECT_LT(std::sqrt(squares), 0.045) << "sites have .1, and linear interpolation alone leaves .067";
}

class BlocksOfLens : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Blocks, BlocksOfLens, testing::Values(false, true),
                         [](const auto& orthographic) { return orthographic.param ? "orthographic" : "perspective"; });

TEST_P(BlocksOfLens, mix_no_surfaces) {
  HostFrame host = wall_at(0, 0, 64, 48, unit({-1, 0.3, 0.2}), GetParam());
  const auto is_near = [](int x, int y) { return (x + y / 3) % 23 < 10 || x % 17 == 0; };
  for (int y = 0; y < 48; y++)
    for (int x = 0; x < 64; x++)
      if (is_near(x, y)) host.depth[std::size_t(y * 64 + x)] *= 0.8f;
  const Chosen chosen(host);
  const auto ao = chosen.filtered([&](int x, int y) { return is_near(x, y) ? 0.2 : 0.9; });
  for (int y = 0; y < 48; y++)
    for (int x = 0; x < 64; x++)
      ASSERT_NEAR(ao[std::size_t(y * 64 + x)], is_near(x, y) ? 0.2 : 0.9, 2e-3) << x << " " << y;
}

TEST(Blocks, mix_nothing_across_a_crease) {
  const Crease crease;
  const std::vector<float> sides = crease.sides();
  const auto ao = Chosen(crease.rendering.frame).filtered([&](int x, int y) { return sides[std::size_t(y * 80 + x)]; });
  const Difference d = difference(ao, sides);
  EXPECT_LT(d.max, 1e-3) << d.worst % 80 << " " << d.worst / 80;
}

// Far from the middle of a wide picture a normal that faces the eye may still point away from it along the axis.
TEST(Blocks, mix_no_surfaces_at_the_sides_of_a_wide_picture) {
  const Plane wall{.point = {1, 2, 0}, .normal = {0.8, -0.6, 0}};
  HostFrame host = render({{wall}}, Shot::perspective({}, {1, 0, 0}, 140, 160, 40)).frame;
  const auto is_near = [](int x, int y) { return (x / 5 + y / 7) % 2 == 0; };
  for (std::size_t i = 0; i < host.depth.size(); i++)
    if (is_near(int(i) % 160, int(i) / 160)) host.depth[i] *= 0.7F;
  const auto ao = Chosen(host).filtered([&](int x, int y) { return is_near(x, y) ? 0.2 : 0.9; });
  int seen = 0;
  for (std::size_t i = 0; i < host.depth.size(); i++) {
    if (i % 160 >= 25) continue;  // farther in, the walls are nearer to each other than a pixel is wide
    seen++;
    ASSERT_NEAR(ao[i], is_near(int(i) % 160, int(i) / 160) ? 0.2 : 0.9, 1e-3) << i % 160 << " " << i / 160;
  }
  EXPECT_EQ(seen, 1000);
}

}  // namespace
}  // namespace alcove::blocks_test
