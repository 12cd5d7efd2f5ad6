// The quick search: each of its passes by itself, what it gives for scenes whose AO is known, and where another search
// takes its place.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/quick/quick.h"
#include "tests/support/chain.h"
#include "tests/support/preset.h"
#include "tests/support/site_frames.h"
#include "tests/support/site_picture.h"

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

/// Blocks of a frame, and their sites as the host sees them.
struct Chosen {
  Prepared frame;
  Blocks blocks;
  std::vector<uint> words;

  explicit Chosen(const HostFrame& host, double radius = 1)
      : frame(prepared(host)),
        blocks(block_sites(recorder(), frame.gbuffer, quick(radius), frame.inputs)),
        words(downloaded<uint>(*blocks.words)) {}
  ivec2 size() const { return frame.gbuffer.view.size; }
  /// Calls back with each site's number and pixel.
  template <class Visit>
  void visit(const Visit& visit) const {
    for (std::size_t block = 0; block < words.size(); block++)
      for (std::size_t s = 0; s < (words[block] & 15); s++) {
        const int place = int(words[block] >> (4 + 4 * s) & 15), across = int(block) % blocks.params.blocks.x;
        visit(block * kBlockSites + s, across * kBlock - blocks.params.overhang.x + place % kBlock,
              int(block) / blocks.params.blocks.x * kBlock - blocks.params.overhang.y + place / kBlock);
      }
  }
  std::set<std::pair<int, int>> sites() const {
    std::set<std::pair<int, int>> result;
    visit([&](std::size_t, int x, int y) { result.emplace(x, y); });
    return result;
  }
  /// What the filters make of a visibility that is given at the sites.
  template <class Visibility>
  std::vector<float> filtered(const Visibility& visibility) const {
    gpu::Buffer& seen = recorder().buffer("seen", words.size() * kBlockSites * sizeof(float), gpu::Use::upload);
    const auto values = seen.template as<float>();
    visit([&](std::size_t site, int x, int y) { values[site] = float(visibility(x, y)); });
    const gpu::Buffer& fitted = fit_blocks(recorder(), blocks, seen);
    return downloaded<float>(spread_blocks(recorder(), frame.gbuffer, blocks, fitted));
  }
};

// Sites: the rule, written out slowly.

/// The pixels of a block in the order of the rule.
constexpr int kOrder[] = {5, 10, 6, 9, 0, 15, 3, 12, 1, 14, 2, 13, 4, 11, 7, 8};
constexpr double kCovered = 0.64;

/// The sites of the block that begins at this pixel; `is_doubtful` where floats may decide otherwise.
std::set<std::pair<int, int>> sites_slowly(const Geometry& geometry, int x, int y, bool& is_doubtful) {
  std::vector<std::pair<int, int>> left;
  std::set<std::pair<int, int>> sites;
  for (const int place : kOrder) {
    const int u = x + place % kBlock, v = y + place / kBlock;
    if (u >= 0 && v >= 0 && geometry.is_surface(u, v)) left.emplace_back(u, v);
  }
  while (!left.empty() && sites.size() < kBlockSites) {
    const auto site = left.front();
    sites.insert(site);
    std::erase_if(left, [&](const auto& pixel) {
      const double likeness = geometry.likeness(site.first, site.second, pixel.first, pixel.second);
      is_doubtful = is_doubtful || std::abs(likeness - kCovered) < 1e-3;
      return pixel == site || likeness > kCovered;
    });
  }
  return sites;
}

TEST(BlockSites, are_one_for_each_surface_of_a_block_by_the_rule) {
  std::mt19937 random(5);
  std::size_t doubtful = 0, compared = 0, several = 0;
  for (int i = 0; i < 60; i++) {
    const Chosen chosen(random_picture(random));
    const Geometry geometry(chosen.frame.gbuffer);
    const auto sites = chosen.sites();
    const ivec2 overhang = chosen.blocks.params.overhang;
    for (int y = -overhang.y; y < chosen.size().y; y += kBlock)
      for (int x = -overhang.x; x < chosen.size().x; x += kBlock) {
        bool is_doubtful = false;
        const auto expected = sites_slowly(geometry, x, y, is_doubtful);
        std::set<std::pair<int, int>> found;
        for (const auto& site : sites)
          if (site.first >= x && site.first < x + kBlock && site.second >= y && site.second < y + kBlock)
            found.insert(site);
        (is_doubtful ? doubtful : compared)++;
        several += expected.size() > 1;
        if (!is_doubtful) ASSERT_EQ(found, expected) << i << ": " << x << " " << y;
      }
  }
  EXPECT_GT(several, 500);
  EXPECT_GT(compared, 20 * doubtful);
}

TEST(BlockSites, of_a_crop_are_those_of_the_whole) {
  const HostFrame whole = furnished_room(64, 48).frame;
  const auto all = Chosen(whole).sites();
  const Window window{7, 9, 41, 30};  // its first whole blocks begin at 8 and 12, its last end at 48 and 36
  std::size_t compared = 0;
  for (const auto& [x, y] : Chosen(crop_of(whole, window)).sites()) {
    const int u = x + window.x, v = y + window.y;
    if (u < 8 || v < 12 || u >= 48 || v >= 36) continue;
    EXPECT_TRUE(all.contains({u, v})) << u << " " << v;
    compared++;
  }
  EXPECT_GT(compared, 60);
}

// The margin.

TEST(Margin, shows_a_plane_where_it_goes_on_and_nothing_of_sky) {
  for (const bool orthographic : {false, true}) {
    const Scene wall{{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.2, 0.3})}}};
    Shot shot =
        orthographic ? Shot::orthographic({}, {1, 0, 0}, 1, 40, 30) : Shot::perspective({}, {1, 0, 0}, 12, 40, 30);
    const Chosen chosen(render(wall, shot).frame);
    shot.data = {-kDepthMargin, -kDepthMargin, 40 + 2 * kDepthMargin, 30 + 2 * kDepthMargin};
    const HostFrame around = render(wall, shot).frame;
    margin(recorder(), chosen.frame.gbuffer, chosen.blocks);
    const auto wide = downloaded<float>(*chosen.blocks.wide);
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

// The filters.

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

/// The plane of least squares through sites about one of them, at that site; its slopes are held back by 8 px^2.
double fitted_slowly(const std::vector<std::array<double, 3>>& sites, double x, double y, double reach) {
  double weight = 0, sum = 0, xs = 0, ys = 0, rise_x = 0, rise_y = 0, xx = 0, xy = 0, yy = 0;
  for (const auto& [u, v, blocked] : sites) {
    const double dx = u - x, dy = v - y, w = std::max(0.0, 1 - (dx * dx + dy * dy) / (reach * reach));
    weight += w, sum += w * blocked, xs += w * dx, ys += w * dy, rise_x += w * dx * blocked, rise_y += w * dy * blocked;
    xx += w * dx * dx, xy += w * dx * dy, yy += w * dy * dy;
  }
  const double mean = sum / weight;
  xx += 8 * weight - xs * xs / weight, yy += 8 * weight - ys * ys / weight, xy -= xs * ys / weight;
  rise_x -= xs * mean, rise_y -= ys * mean;
  const double whole = xx * yy - xy * xy;
  const double slope_x = (yy * rise_x - xy * rise_y) / whole, slope_y = (xx * rise_y - xy * rise_x) / whole;
  return std::clamp(mean - (slope_x * xs + slope_y * ys) / weight, 0.0, 1.0);
}

TEST(Blocks, fit_a_plane_to_their_sites) {
  const Chosen chosen(wall_at(1, 3, 57, 45, {-1, 0, 0}, false), 1.1);
  std::mt19937 random(9);
  std::vector<std::array<double, 3>> sites;
  chosen.filtered([&](int x, int y) {
    const double visibility = double(random() % 1000) / 1000;
    sites.push_back({double(x), double(y), 1 - visibility});
    return visibility;
  });
  const auto fitted = downloaded<std::array<float, 4>>(
      recorder().buffer("fitted blocks", chosen.words.size() * kBlockSites * 4 * sizeof(float)));
  const double reach = chosen.blocks.params.reach / 5;
  ASSERT_THAT(reach, AllOf(testing::Gt(6), testing::Lt(9))) << "two blocks to each side";
  std::size_t i = 0;
  chosen.visit([&](std::size_t site, int x, int y) {
    ASSERT_NEAR(fitted[site][0], fitted_slowly(sites, x, y, reach), 1e-4) << x << " " << y;
    ASSERT_EQ(sites[i++][0], x);
  });
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

TEST(Blocks, mix_no_surfaces) {
  HostFrame host = wall_at(0, 0, 64, 48, {-1, 0, 0}, false);
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
  EXPECT_FALSE(is_quick(quick(0.5), "ao,bent-normal"));
  using Change = void (*)(EstimatorSettings&);
  for (const Change change : std::initializer_list<Change>{
           [](auto& s) { s.further_radii = {0.2}; }, [](auto& s) { s.falloff = Falloff::linear; },
           [](auto& s) { s.thickness = ThicknessKind::infinite; }, [](auto& s) { s.complete = Completion::border; },
           [](auto& s) { s.density = Density::uniform; }, [](auto& s) { s.denoise_radius = 5; },
           [](auto& s) { s.estimator = Estimator::bitmask; }}) {
    EstimatorSettings settings = quick(0.5);
    change(settings);
    EXPECT_FALSE(is_quick(settings)) << name_of(settings);
  }
}

}  // namespace
}  // namespace alcove::quick_test
