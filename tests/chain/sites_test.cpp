// Which pixels have an estimate of their own: the kernels against their rule written out slowly, and what follows from
// it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/sites.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/filters/filters.h"
#include "tests/support/chain.h"
#include "tests/support/scenes.h"
#include "tests/support/site_frames.h"

namespace alcove::sites_test {
namespace {

using namespace test;

constexpr int kSpacings[] = {16, 8, 4, 2, 1};
constexpr SiteRule kAdaptive{16, true};

// The rule, written out slowly.

/// The pixels of a block in the order of the rule, row by row, and how alike one must be that a site stands for.
constexpr int kOrder[] = {5, 10, 6, 9, 0, 15, 3, 12, 1, 14, 2, 13, 4, 11, 7, 8};
constexpr double kCovered = 0.64;

using Places = std::set<std::pair<int, int>>;

/// The sites of the block that begins at this pixel; `is_doubtful` where floats may decide otherwise.
Places sites_slowly(const Picture& picture, const Geometry& geometry, const SiteRule& rule, int x, int y,
                    bool& is_doubtful) {
  std::vector<std::pair<int, int>> left;
  Places sites;
  for (const int place : kOrder) {
    const int u = x + place % kBlock, v = y + place / kBlock;
    const bool is_there = u >= 0 && v >= 0 && geometry.is_surface(u, v);
    if (is_there && picture.is_on_lattice(u, v, rule.spacing)) sites.emplace(u, v);
    if (is_there && rule.is_adaptive) left.emplace_back(u, v);
  }
  const auto all = left;
  for (bool is_first = true; !left.empty(); is_first = false) {
    const auto site = left.front();
    sites.insert(site);
    const auto is_alike = [&](const auto& pixel) {
      const double likeness = geometry.likeness(site.first, site.second, pixel.first, pixel.second);
      is_doubtful = is_doubtful || std::abs(likeness - kCovered) < 1e-3;
      return likeness > kCovered && geometry.is_surface(pixel.first, site.second);
    };
    const auto is_beside = [&](const auto& pixel) {
      return std::abs(pixel.first - site.first) <= 1 && std::abs(pixel.second - site.second) <= 1;
    };
    const bool is_dense = rule.edges && is_first && !std::ranges::all_of(all, is_alike);
    std::erase_if(left, [&](const auto& pixel) {
      if (pixel == site) return true;
      if (picture.is_on_lattice(pixel.first, pixel.second, rule.spacing)) return false;
      return is_alike(pixel) && (!is_dense || is_beside(pixel));
    });
  }
  return sites;
}

TEST(Sites, are_those_of_the_rule) {
  std::mt19937 random(5);
  RandomScenes scenes(78);
  std::size_t doubtful = 0, compared = 0, several = 0, added = 0;
  for (int i = 0; i < 80; i++) {
    const GBuffer gbuffer = prepared(i % 2 ? scenes.next() : random_picture(random)).gbuffer;
    SiteRule rule{i % 3 ? 16 : 1 << (1 + i % 4), i % 7 != 6};
    rule.edges = rule.is_adaptive && i % 2 == i % 4 / 2;
    const Geometry geometry(gbuffer);
    const Sites sites = alcove::sites(recorder(), gbuffer, rule);
    const Picture picture = picture_of(sites, gbuffer);
    for (int y = -sites.grid.overhang.y; y < picture.height; y += kBlock)
      for (int x = -sites.grid.overhang.x; x < picture.width; x += kBlock) {
        bool is_doubtful = false;
        const Places expected = sites_slowly(picture, geometry, rule, x, y, is_doubtful);
        Places found;
        for (int v = std::max(y, 0); v < std::min(y + kBlock, picture.height); v++)
          for (int u = std::max(x, 0); u < std::min(x + kBlock, picture.width); u++)
            if (picture.is_site(u, v)) found.emplace(u, v);
        (is_doubtful ? doubtful : compared)++;
        several += expected.size() > 1;
        for (const auto& [u, v] : expected) added += !picture.is_on_lattice(u, v, rule.spacing);
        if (!is_doubtful)
          ASSERT_EQ(found, expected) << i << ": " << x << " " << y << ", spacing " << rule.spacing << ", adaptive "
                                     << rule.is_adaptive << ", dense at edges " << rule.edges;
      }
  }
  EXPECT_GT(several, 500);
  EXPECT_GT(added, 500) << "or else nothing is adaptive";
  EXPECT_GT(compared, 20 * doubtful);
}

TEST(Sites, of_a_plain_wall_are_those_of_the_widest_lattice_and_of_blocks_that_the_border_cuts) {
  for (const Vec3& normal : {Vec3{-1, 0, 0}, unit({-1, 0.4, 0.1}), unit({-1, -1, 1})})
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 5}, {8, 8}, {24, 8}, {29, 13}, {97, 31}})
      for (const auto& [x, y] : {std::pair{0, 0}, {1, 3}, {-5, 2}, {1000003, -70001}})
        for (const bool orthographic : {false, true}) {
          const Prepared frame = prepared(wall_at(x, y, width, height, normal, orthographic));
          const Sites sites = alcove::sites(recorder(), frame.gbuffer, kAdaptive);
          const Picture picture = picture_of(sites, frame.gbuffer);
          EXPECT_EQ(picture.count_of_sites(), sites.grid.blocks.x * sites.grid.blocks.y) << "one for each";
          for (int v = 0; v < height; v++)
            for (int u = 0; u < width; u++)
              if (picture.is_on_lattice(u, v, 16)) ASSERT_TRUE(picture.is_site(u, v)) << u << " " << v;
        }
}

// Else contact shadows of a few pixels would fall between sites.
TEST(Sites, stand_for_no_pixel_farther_away_than_a_part_of_the_radius) {
  for (const bool orthographic : {false, true}) {
    const HostFrame wall = wall_at(0, 0, 32, 16, {-1, 0, 0}, orthographic);
    const double px = orthographic ? 4.0 / 32 : wall.depth.front() / wall.camera.fx;
    const auto count = [&](double within) { return chosen(wall, {16, true, {}, true, within}).count_of_sites(); };
    EXPECT_EQ(count(0.9 * px), 32 * 16);
    EXPECT_THAT(count(1.1 * px), AllOf(testing::Gt(32 * 16 / 5), testing::Lt(32 * 16 / 2)));
    EXPECT_EQ(count(4.3 * px), 32 * 16 / 16);
  }
  EstimatorSettings settings;
  settings.radius = 2;
  settings.further_radii = {0.5};
  EXPECT_DOUBLE_EQ(site_rule_of(settings).within, 0.1);
}

TEST(Sites, are_listed_each_once) {
  for (const SiteRule& rule : {kAdaptive, SiteRule{4, false}}) {
    const GBuffer gbuffer = prepared(furnished_room(93, 71).frame).gbuffer;
    const Sites sites = alcove::sites(recorder(), gbuffer, rule);
    const Picture picture = picture_of(sites, gbuffer);
    const auto counts = downloaded<SiteCounts>(*sites.counts)[0];
    const auto list = downloaded<uint>(*sites.list);
    EXPECT_EQ(int(counts.listed), picture.count_of_sites());
    EXPECT_EQ(counts.groups.x, (counts.listed + 63) / 64);
    EXPECT_EQ(counts.groups.y, 1u);
    EXPECT_EQ(counts.groups.z, 1u);
    const std::set<uint> listed(list.begin(), list.begin() + counts.listed);
    EXPECT_EQ(listed.size(), counts.listed) << "none twice";
    const int blocks = sites.grid.blocks.x * sites.grid.blocks.y;
    for (const uint number : listed) {
      const int block = int(number) % blocks, bit = int(number) / blocks, columns = sites.grid.blocks.x;
      EXPECT_TRUE(picture.is_site(block % columns * 4 - sites.grid.overhang.x + bit % 4,
                                  block / columns * 4 - sites.grid.overhang.y + bit / 4));
    }
  }
}

/// Where a listed site lies.
std::pair<int, int> place_of(uint site, const std::vector<uint>& tiles) {
  const uint place = tiles[site / 64], pixel = site % 64;
  return {int(place & 0xffffu) * 8 + int(pixel % 8), int(place >> 16) * 8 + int(pixel / 8)};
}

/// A room before a sky that fills tiles.
HostFrame room_before_sky(int x, int y) {
  Shot shot = room_shot(157, 117, false, 75);
  shot.data.x = x;
  shot.data.y = y;
  return render(kBallRoom, shot).frame;
}

TEST(ListedSites, are_those_of_the_listed_tiles_each_once_and_are_counted_by_lattice) {
  for (const auto& [x, y] : {std::pair{0, 0}, {-3, 7}})
    for (const SiteRule& rule : {kAdaptive, SiteRule{4, true}, SiteRule{8, false}}) {
      const Prepared frame = prepared(room_before_sky(x, y));
      EstimatorSettings settings;
      settings.radius = 0.2;
      settings.stride = rule.spacing;
      settings.density = rule.is_adaptive ? Density::adaptive : Density::uniform;
      const Sites sites = alcove::sites(recorder(), frame.gbuffer, rule);
      const Estimate made = estimate(recorder(), frame.gbuffer, sites, frame.inputs, settings);
      for (const gpu::Buffer* buffer : {made.listed.tiles, made.listed.counts, made.listed.sites})
        recorder().download(*buffer);
      const auto counts = downloaded<SiteCounts>(*made.listed.site_counts)[0];
      const Picture picture = picture_of(sites, frame.gbuffer);
      const uint listed_tiles = made.listed.counts->as<TileCounts>()[0].listed;
      ASSERT_GT(listed_tiles, 64u) << "more than one workgroup lists";
      ASSERT_GT(made.listed.counts->as<TileCounts>()[0].sky, 10u);
      const auto all_tiles = made.listed.tiles->as<uint>();
      const std::vector<uint> tiles(all_tiles.begin(), all_tiles.begin() + listed_tiles);

      std::set<std::pair<int, int>> expected, listed;
      std::array<uint, kLattices> of_lattice{};
      for (const uint tile : tiles)
        for (uint pixel = 0; pixel < 64; pixel++) {
          const auto at = place_of(pixel, {tile});
          const bool exists = at.first < picture.width && at.second < picture.height;
          if (!exists || !picture.is_site(at.first, at.second)) continue;
          expected.insert(at);
          std::size_t lattice = 0;
          while (!picture.is_on_lattice(at.first, at.second, kSpacings[lattice])) lattice++;
          of_lattice[lattice]++;
        }
      const auto list = made.listed.sites->as<uint>();
      ASSERT_LE(counts.listed, list.size());
      for (uint i = 0; i < counts.listed; i++) {
        ASSERT_LT(list[i] / 64, listed_tiles);
        EXPECT_TRUE(listed.insert(place_of(list[i], tiles)).second) << "twice";
      }
      EXPECT_EQ(listed, expected);
      EXPECT_THAT(counts.of_lattice, testing::ElementsAreArray(of_lattice));
      EXPECT_EQ(counts.groups.x, (counts.listed + 63) / 64);
      EXPECT_EQ(counts.groups.y, 1u);
    }
}

// Tiles and regions are computed with so many pixels around them.
TEST(Sites, depend_on_nothing_that_is_more_than_3_pixels_away) {
  RandomScenes scenes(18);
  int compared = 0, other = 0;
  for (int i = 0; i < 60; i++) {
    const HostFrame whole = scenes.next(2);
    if (whole.normal.empty() || whole.data.width < 60 || whole.data.height < 60) continue;
    const int left = scenes.whole(0, 20), top = scenes.whole(0, 20);
    const Window window{left, top, whole.data.width - left - scenes.whole(0, 8), whole.data.height - top - 3};
    const Picture expected = chosen(whole, kAdaptive), picture = chosen(crop_of(whole, window), kAdaptive);
    for (int y = 0; y < window.height; y++)
      for (int x = 0; x < window.width; x++) {
        const int away = std::min({x, y, window.width - 1 - x, window.height - 1 - y});
        const bool is_same = picture.is_site(x, y) == expected.is_site(x + left, y + top);
        if (away >= kSiteReach) ASSERT_TRUE(is_same) << x << " " << y << " of scene " << i;
        compared += away >= kSiteReach;
        other += !is_same;
      }
  }
  EXPECT_GT(compared, 10000);
  EXPECT_GT(other, 0) << "or else no border was near anything";
}

// Left open, the stride is 16 where the density is adaptive, and 4 or 1 where it is uniform; where the denoiser does
// not share, or blocks of pixels have one estimate, it is 1.
TEST(SiteRule, follows_the_settings) {
  struct Row {
    std::function<void(EstimatorSettings&)> change;
    int adaptive, uniform;  // the spacing
  };
  const Row rows[]{{[](auto& s) { s.slices = 1; }, 16, 4},
                   {[](auto& s) { s.slices = 2; }, 16, 4},
                   {[](auto& s) { s.slices = 3; }, 16, 1},
                   {[](auto& s) { s.slices = 4; }, 16, 1},
                   {[](auto& s) { s.slices = 5; }, 16, 1},
                   {[](auto& s) { s.slices = 16; }, 16, 1},
                   {[](auto& s) { s.slices = 1, s.denoise = Denoise::none; }, 1, 1},
                   {[](auto& s) { s.slices = 1, s.denoise = Denoise::box; }, 1, 1},
                   {[](auto& s) { s.slices = 1, s.estimator = Estimator::bitmask; }, 16, 1},
                   {[](auto& s) { s.slices = 1, s.estimator = Estimator::hbao; }, 1, 1},
                   {[](auto& s) { s.slices = 1, s.estimator = Estimator::crytek; }, 1, 1},
                   {[](auto& s) { s.slices = 1, s.resolution = Resolution::half; }, 1, 1},
                   {[](auto& s) { s.stride = 1; }, 1, 1},
                   {[](auto& s) { s.stride = 2; }, 2, 2},
                   {[](auto& s) { s.stride = 4; }, 4, 4},
                   {[](auto& s) { s.stride = 8; }, 8, 8},
                   {[](auto& s) { s.stride = 16; }, 16, 16},
                   {[](auto& s) { s.stride = 8, s.search = SliceSearch::exact; }, 1, 1},
                   {[](auto& s) { s.stride = 8, s.tolerance = 0.05; }, 1, 1}};
  for (const Row& row : rows)
    for (const Density density : {Density::adaptive, Density::edges, Density::uniform}) {
      EstimatorSettings settings;
      settings.density = density;
      row.change(settings);
      const bool adapts = density != Density::uniform;
      const int spacing = adapts ? row.adaptive : row.uniform;
      EXPECT_EQ(spacing_of(settings), spacing) << name_of(settings);
      EXPECT_EQ(is_adaptive(settings), adapts && spacing > 1) << name_of(settings);
      EXPECT_EQ(site_rule_of(settings).spacing, spacing) << name_of(settings);
      EXPECT_EQ(site_rule_of(settings).is_adaptive, is_adaptive(settings)) << name_of(settings);
      EXPECT_EQ(site_rule_of(settings).edges, density == Density::edges && spacing > 1) << name_of(settings);
      if (spacing == 1) EXPECT_EQ(sites(recorder(), GBuffer{}, site_rule_of(settings)).words, nullptr);
    }
  EXPECT_EQ(EstimatorSettings{}.density, Density::adaptive);
}

TEST(DenoiseRadius, left_open_is_wide_where_estimates_are_shared) {
  for (const auto& [radius, stride, density, expected, weights] : {std::tuple{0, 0, Density::adaptive, 8, 0},
                                                                   {0, 2, Density::adaptive, 8, 9},
                                                                   {0, 1, Density::adaptive, 4, 5},
                                                                   {1, 16, Density::adaptive, 1, 4},
                                                                   {5, 16, Density::adaptive, 5, 6},
                                                                   {8, 16, Density::adaptive, 8, 9},
                                                                   {1, 16, Density::uniform, 1, 9},
                                                                   {5, 16, Density::uniform, 5, 9},
                                                                   {8, 16, Density::uniform, 8, 9},
                                                                   {1, 1, Density::adaptive, 1, 2},
                                                                   {5, 1, Density::adaptive, 5, 6},
                                                                   {8, 1, Density::adaptive, 8, 9}}) {
    EstimatorSettings settings;
    settings.denoise_radius = radius;
    settings.stride = stride;
    settings.density = density;
    EXPECT_EQ(denoise_radius_of(settings), expected) << name_of(settings);
    EXPECT_EQ(denoiser_of(settings).weights.size(), std::size_t(weights)) << name_of(settings) << ": reaches all sites";
    EXPECT_EQ(denoiser_of(settings).of_blocks.has_value(), weights == 0) << name_of(settings);
  }
}

TEST(DenoiseRadius, ends_at_a_part_of_each_radius_where_sites_are_near) {
  EstimatorSettings settings;
  settings.radius = 2;
  settings.further_radii = {0.5};
  EXPECT_EQ(denoiser_of(settings).within, (std::vector{0.2, 0.8}));
  settings.density = Density::uniform;
  EXPECT_TRUE(std::isinf(denoiser_of(settings).within.front())) << "surfaces of few pixels may have no site so near";
}

}  // namespace
}  // namespace alcove::sites_test
