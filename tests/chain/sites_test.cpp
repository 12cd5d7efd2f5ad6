// Which pixels have an estimate of their own: the kernels against their rule written out slowly, and what follows from
// it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/sites.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/filters/filters.h"
#include "tests/support/chain.h"
#include "tests/support/random_scenes.h"
#include "tests/support/site_frames.h"
#include "tests/support/site_picture.h"

namespace alcove::sites_test {
namespace {

using namespace test;

constexpr int kSpacings[] = {16, 8, 4, 2, 1};

/// The sites by the rule, lattice by lattice, from surfaces and links.
Picture chosen_slowly(Picture picture, const SiteRule& rule) {
  for (int y = 0; y < picture.height; y++)
    for (int x = 0; x < picture.width; x++)
      picture.at(x, y).is_site = picture.at(x, y).is_surface && (picture.is_on_lattice(x, y, rule.spacing) ||
                                                                 (rule.is_adaptive && picture.is_on_border(x, y)));
  for (int spacing = rule.spacing / 2; rule.is_adaptive && spacing > 0; spacing /= 2) {
    const Picture wider = picture;
    for (int y = 0; y < picture.height; y++)
      for (int x = 0; x < picture.width; x++) {
        Pixel& pixel = picture.at(x, y);
        if (!pixel.is_surface || !picture.is_on_lattice(x, y, spacing)) continue;
        if (wider.quadrants_with_sites(x, y, spacing) < (spacing >= 2 ? 3 : 2)) pixel.is_site = true;
      }
  }
  return picture;
}

constexpr SiteRule kAdaptive{16, true};

void expect_same_sites(const Picture& picture, const Picture& expected, const std::string& what) {
  for (int y = 0; y < picture.height; y++)
    for (int x = 0; x < picture.width; x++)
      ASSERT_EQ(picture.at(x, y).is_site, expected.at(x, y).is_site)
          << what << ", pixel " << x << " " << y << " of " << picture.width << " x " << picture.height;
}

constexpr double kLinked = 0.9;                  // of links.comp
constexpr double kFlat = 1 - (1 - kLinked) / 9;  // the same

/// What the kernel says of two neighbours, against the geometry.
struct LinkCounts {
  int linked = 0, parted = 0, doubtful = 0;

  void compare(const Geometry& geometry, int x, int y, int u, int v, bool is_linked, double bound) {
    const bool surfaces = geometry.is_surface(x, y) && geometry.is_surface(u, v);
    const double likeness = surfaces ? geometry.likeness(x, y, u, v) : 0;
    // Floats may decide otherwise so near to the bound.
    if (std::abs(likeness - bound) < 2e-4) {
      doubtful++;
      return;
    }
    (is_linked ? linked : parted)++;
    ASSERT_EQ(is_linked, likeness > bound)
        << "pixels " << x << " " << y << " and " << u << " " << v << ", " << likeness;
  }
};

TEST(Links, join_neighbours_that_lie_in_each_others_planes) {
  std::mt19937 random(5);
  RandomScenes scenes(77);
  LinkCounts counts, flat;
  for (int i = 0; i < 60 && !HasFatalFailure(); i++) {
    const GBuffer gbuffer = prepared(i % 2 ? scenes.next() : random_picture(random)).gbuffer;
    const Geometry geometry(gbuffer);
    const Picture picture = picture_of(links(recorder(), gbuffer, kAdaptive), gbuffer, kAdaptive);
    for (int y = 0; y < picture.height && !HasFatalFailure(); y++)
      for (int x = 0; x < picture.width && !HasFatalFailure(); x++) {
        const Pixel& pixel = picture.at(x, y);
        ASSERT_EQ(pixel.is_surface, geometry.is_surface(x, y));
        counts.compare(geometry, x, y, x + 1, y, pixel.linked.right, kLinked);
        counts.compare(geometry, x, y, x, y + 1, pixel.linked.below, kLinked);
        flat.compare(geometry, x, y, x + 1, y, pixel.flat.right, kFlat);
        flat.compare(geometry, x, y, x, y + 1, pixel.flat.below, kFlat);
      }
  }
  EXPECT_GT(counts.linked, 20000);
  EXPECT_GT(counts.parted, 5000);
  EXPECT_LT(counts.doubtful, counts.linked / 100);
  EXPECT_LT(flat.linked, counts.linked - 200);
  EXPECT_LT(flat.doubtful, flat.linked / 100);
}

TEST(Sites, are_those_of_the_rule) {
  std::mt19937 random(11);
  RandomScenes scenes(3);
  int sites = 0, added = 0;
  for (int i = 0; i < 80 && !HasFailure(); i++) {
    const GBuffer gbuffer = prepared(i % 4 == 3 ? scenes.next() : random_picture(random)).gbuffer;
    const SiteRule rule{1 << (i % 5 == 4 ? 4 : 1 + i % 4), i % 7 != 6};
    const Picture picture = chosen(gbuffer, rule);
    const Picture expected = chosen_slowly(picture, rule);
    expect_same_sites(picture, expected, "picture " + std::to_string(i) + " spacing " + std::to_string(rule.spacing));
    sites += picture.count_of_sites();
    added += picture.count_of_sites() - chosen_slowly(picture, {rule.spacing, false}).count_of_sites();
  }
  EXPECT_GT(sites, 10000);
  EXPECT_GT(added, 1000) << "or else nothing is adaptive";
}

/// Whether a pixel of a plain wall lies in a corner of the picture that no site of the widest lattice closes off.
bool is_in_open_corner(const Picture& picture, int x, int y) {
  const auto has_lattice = [&](int from_x, int to_x, int from_y, int to_y) {
    for (int v = std::max(from_y, 0); v <= std::min(to_y, picture.height - 1); v++)
      for (int u = std::max(from_x, 0); u <= std::min(to_x, picture.width - 1); u++)
        if (picture.is_on_lattice(u, v, 16)) return true;
    return false;
  };
  return has_lattice(x - 3, x, y - 3, y) + has_lattice(x, x + 3, y - 3, y) + has_lattice(x - 3, x, y, y + 3) +
             has_lattice(x, x + 3, y, y + 3) <
         2;
}

TEST(Sites, of_a_plain_wall_are_those_of_the_widest_lattice_and_of_the_border) {
  for (const Vec3& normal : {Vec3{-1, 0, 0}, unit({-1, 0.4, 0.1}), unit({-1, -1, 1})})
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 5}, {8, 8}, {24, 8}, {29, 13}, {50, 41}, {97, 31}})
      for (const auto& [x, y] : {std::pair{0, 0}, {1, 3}, {-5, 2}, {1000003, -70001}})
        for (const bool orthographic : {false, true}) {
          const Picture picture = chosen(wall_at(x, y, width, height, normal, orthographic), kAdaptive);
          for (int v = 0; v < height; v++)
            for (int u = 0; u < width; u++)
              if (picture.is_on_lattice(u, v, 16) || !is_in_open_corner(picture, u, v))
                ASSERT_EQ(picture.at(u, v).is_site, picture.is_on_lattice(u, v, 16) || picture.is_on_border(u, v))
                    << u << " " << v << " of " << width << " x " << height << " at " << x << " " << y;
        }
}

/// Where a listed site lies.
std::pair<int, int> place_of(uint site, const std::vector<uint>& tiles) {
  const uint place = tiles[site / 64], pixel = site % 64;
  return {int(place & 0xffffu) * 8 + int(pixel % 8), int(place >> 16) * 8 + int(pixel / 8)};
}

/// A room before a sky that fills tiles.
HostFrame room_before_sky(int x, int y) {
  Shot shot = Shot::perspective({4.5, -1.5, 2.4}, {1, 0, 0.6}, 75, 157, 117);
  shot.data.x = x;
  shot.data.y = y;
  const Scene scene{{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
                     Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}}};
  return render(scene, shot).frame;
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
      const Picture picture = picture_of(*sites.rows, frame.gbuffer, rule);
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
          if (!picture.has(at.first, at.second) || !picture.at(at.first, at.second).is_site) continue;
          expected.insert(at);
          std::size_t lattice = 0;
          while (!picture.is_on_lattice(at.first, at.second, kSpacings[lattice])) lattice++;
          of_lattice[lattice]++;
        }
      const auto list = made.listed.sites->as<uint>();
      ASSERT_LE(counts.listed, list.size());
      for (uint i = 0; i < counts.listed; i++) {
        const uint site = list[i] & 0x7fffffffu;
        ASSERT_LT(site / 64, listed_tiles);
        const auto at = place_of(site, tiles);
        EXPECT_TRUE(listed.insert(at).second) << "twice";
        EXPECT_EQ(site != list[i], picture.is_on_lattice(at.first, at.second, 16)) << "told apart";
      }
      EXPECT_EQ(listed, expected);
      EXPECT_THAT(counts.of_lattice, testing::ElementsAreArray(of_lattice));
      EXPECT_EQ(counts.groups.x, (counts.listed + 63) / 64);
      EXPECT_EQ(counts.groups.y, 1u);
    }
}

// Tiles and regions are computed with so many pixels around them.
TEST(Sites, depend_on_nothing_that_is_more_than_13_pixels_away) {
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
        const bool is_same = picture.at(x, y).is_site == expected.at(x + left, y + top).is_site;
        if (away >= kSiteReach) ASSERT_TRUE(is_same) << x << " " << y << " of scene " << i;
        compared += away >= kSiteReach;
        other += !is_same;
      }
  }
  EXPECT_GT(compared, 10000);
  EXPECT_GT(other, 0) << "or else no border was near anything";
}

// Left open, the stride is 16 of few slices and 2 of many where the density is adaptive, and 4 or 1 where it is
// uniform; where the denoiser does not share, or blocks of pixels have one estimate, it is 1.
TEST(SiteRule, follows_the_settings) {
  struct Row {
    std::function<void(EstimatorSettings&)> change;
    int adaptive, uniform;  // the spacing
  };
  const Row rows[]{{[](auto& s) { s.slices = 1; }, 16, 4},
                   {[](auto& s) { s.slices = 2; }, 16, 4},
                   {[](auto& s) { s.slices = 3; }, 16, 1},
                   {[](auto& s) { s.slices = 4; }, 16, 1},
                   {[](auto& s) { s.slices = 5; }, 2, 1},
                   {[](auto& s) { s.slices = 16; }, 2, 1},
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
    for (const Density density : {Density::adaptive, Density::uniform}) {
      EstimatorSettings settings;
      settings.density = density;
      row.change(settings);
      const int spacing = density == Density::adaptive ? row.adaptive : row.uniform;
      EXPECT_EQ(spacing_of(settings), spacing) << name_of(settings);
      EXPECT_EQ(is_adaptive(settings), density == Density::adaptive && spacing > 1) << name_of(settings);
      EXPECT_EQ(site_rule_of(settings).spacing, spacing) << name_of(settings);
      EXPECT_EQ(site_rule_of(settings).is_adaptive, is_adaptive(settings)) << name_of(settings);
      if (spacing == 1) EXPECT_EQ(sites(recorder(), GBuffer{}, site_rule_of(settings)).rows, nullptr);
    }
  EXPECT_EQ(EstimatorSettings{}.density, Density::adaptive);
}

TEST(DenoiseRadius, left_open_is_wide_where_shared_estimates_are_not_smoothed_before) {
  for (const auto& [radius, stride, density, expected, weights] : {std::tuple{0, 0, Density::adaptive, 4, 5},
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
  }
}

TEST(DenoiseRadius, ends_at_a_part_of_the_smallest_radius_where_sites_are_near) {
  EstimatorSettings settings;
  settings.radius = 2;
  settings.further_radii = {0.5};
  EXPECT_DOUBLE_EQ(denoiser_of(settings).within, 0.2);
  settings.density = Density::uniform;
  EXPECT_TRUE(std::isinf(denoiser_of(settings).within)) << "surfaces of few pixels may have no site so near";
}

}  // namespace
}  // namespace alcove::sites_test
