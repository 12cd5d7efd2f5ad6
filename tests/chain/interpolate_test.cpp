// The filter that gives all pixels theirs from the sites: against its formulas written out slowly, and what it keeps.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/sites.h"
#include "core/chain/filters/filters.h"
#include "tests/support/chain.h"
#include "tests/support/scenes.h"
#include "tests/support/site_frames.h"

namespace alcove::interpolate_test {
namespace {

using namespace test;

EstimatorSettings filter(int spacing, int radius, Density density = Density::adaptive) {
  EstimatorSettings settings;
  settings.radius = 1;
  settings.stride = spacing;
  settings.density = density;
  settings.denoise_radius = radius;
  return settings;
}

EstimatorSettings by_kernel(int spacing, std::vector<double> weights) {
  EstimatorSettings settings = filter(spacing, 0);
  settings.denoise_kernel = std::move(weights);
  return settings;
}

EstimatorSettings by_depth(int spacing, double sigma) {
  EstimatorSettings settings = filter(spacing, 8);
  settings.denoise_depth_sigma = sigma;
  return settings;
}

/// Each with a site in reach of every pixel.
std::vector<EstimatorSettings> all_filters() {
  return {filter(16, 8),
          filter(16, 4),
          filter(16, 8, Density::uniform),
          filter(8, 5),
          filter(4, 3, Density::uniform),
          filter(4, 1, Density::uniform),
          filter(8, 1),
          filter(2, 3),
          by_kernel(16, {5, 4, 4, 3, 3, 1}),
          by_kernel(4, {1, 0, 0.5, 2, 1}),
          by_depth(16, 0.1),
          by_depth(8, 1e-3)};
}

/// All lattices, adaptive and uniform, with filters of all reaches and by any weights.
std::vector<EstimatorSettings> every_reach() {
  std::vector<EstimatorSettings> all;
  for (const Density density : {Density::adaptive, Density::uniform})
    for (const int spacing : {2, 4, 8, 16}) {
      for (int radius = 0; radius <= 8; radius++) all.push_back(filter(spacing, radius, density));
      for (const std::vector<double>& weights :
           {std::vector<double>{1, 0}, {1, 1}, {5, 0, 0, 1}, {1, 1, 1, 1, 1, 1, 1, 1, 1}}) {
        all.push_back(by_kernel(spacing, weights));
        all.back().density = density;
      }
    }
  return all;
}

/// A frame's G-buffer with its sites.
struct Sparse {
  Prepared frame;
  Sites sites;
  Picture picture;

  Sparse(const HostFrame& host, const EstimatorSettings& settings)
      : frame(prepared(host)),
        sites(alcove::sites(recorder(), frame.gbuffer, site_rule_of(settings))),
        picture(picture_of(sites, frame.gbuffer)) {}

  /// Interpolates planes, which hold `elsewhere` where there is no site.
  std::vector<float> interpolated(std::vector<float> planes, const EstimatorSettings& settings,
                                  float elsewhere = kNan) const {
    for (std::size_t i = 0; i < planes.size(); i++)
      if (!picture.sites[i % picture.sites.size()]) planes[i] = elsewhere;
    return downloaded<float>(
        smooth(recorder(), frame.gbuffer, given("visibility of a test", planes), sites, denoiser_of(settings)));
  }
};

std::vector<float> noise(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> values(count);
  for (float& value : values) value = float(random() % 4096) / 4095;
  return values;
}

// The formulas.

/// Sites along a line, of which each has a value and a weight.
struct Taps {
  std::vector<double> away, value, weight;

  double whole() const {
    double sum = 0;
    for (const double w : weight) sum += w;
    return sum;
  }
  /// The straight line that fits best, its slope held back as by a spread of 2 px^2 more.
  struct Line {
    double at_pixel, weight;  // weight: of all sites, by the line's variance at them against that at the pixel
  };
  Line fitted() const {
    const double sum = whole();
    double middle = 0, mean = 0, spread = 2, along = 0;
    for (std::size_t i = 0; i < away.size(); i++) middle += weight[i] * away[i] / sum;
    for (std::size_t i = 0; i < away.size(); i++) mean += weight[i] * value[i] / sum;
    for (std::size_t i = 0; i < away.size(); i++) {
      spread += weight[i] * (away[i] - middle) * (away[i] - middle) / sum;
      along += weight[i] * (away[i] - middle) * (value[i] - mean) / sum;
    }
    return {std::clamp(mean - along / spread * middle, 0.0, 1.0), sum / (1 + middle * middle / spread)};
  }
};

/// How far a site shows the surface of a pixel.
double similarity(const Geometry& geometry, const Denoiser& denoiser, int x, int y, int u, int v) {
  const double z = geometry.depth[geometry.index(x, y)], other = geometry.depth[geometry.index(u, v)];
  if (denoiser.depth_sigma > 0) {
    const double steps = std::abs(other - z) / (denoiser.depth_sigma * std::min(z, other));
    return std::max(1e-4 / (1 + steps * steps), std::exp(-steps));
  }
  return std::max(1e-4 / (1 + geometry.apart_sq(x, y, u, v)), geometry.likeness(x, y, u, v));
}

/// How far filters reach at a pixel: a part of the radius, in pixels.
double reach_at(const Geometry& geometry, const Denoiser& denoiser, int x, int y) {
  const double scale = geometry.view.orthographic ? 1 : geometry.depth[geometry.index(x, y)];
  return denoiser.within.front() / (std::abs(geometry.view.tangent_per_pixel.x) * scale);
}

/// What a word of two numbers of 16 bits keeps of one.
double rounded(double x) { return std::round(x * 65535) / 65535; }
double rounded_weight(double weight) { return std::pow(std::max(rounded(std::sqrt(weight)), 1.0 / 65535), 2); }

std::vector<double> interpolated_slowly(const Sparse& sparse, const std::vector<float>& ao,
                                        const EstimatorSettings& settings) {
  const Geometry geometry(sparse.frame.gbuffer);
  const Denoiser denoiser = denoiser_of(settings);
  const int radius = int(denoiser.weights.size()) - 1, width = sparse.picture.width, height = sparse.picture.height;
  double sum = -denoiser.weights[0];
  for (const double weight : denoiser.weights) sum += 2 * weight;
  const auto weight_at = [&](int away, int x, int y) {
    if (denoiser.looks_up) return denoiser.weights[std::size_t(std::abs(away))] / sum;
    const double most = denoise_radius_of(settings);
    const double end = 1 + std::clamp(reach_at(geometry, denoiser, x, y), std::min(3.0, most), most);
    return denoiser.weights[0] / sum * std::max(1e-6, 1 - away * away / (end * end));
  };
  std::vector<double> blocked(ao.size()), weights(ao.size()), result(ao.size(), 1.0);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      if (!geometry.is_surface(x, y)) continue;
      Taps taps;
      for (int u = std::max(x - radius, 0); u <= std::min(x + radius, width - 1); u++) {
        if (!sparse.picture.is_site(u, y)) continue;
        taps.away.push_back(u - x);
        taps.value.push_back(1 - ao[geometry.index(u, y)]);
        taps.weight.push_back(weight_at(u - x, x, y) * similarity(geometry, denoiser, x, y, u, y));
      }
      if (!(taps.whole() > 0)) continue;
      blocked[geometry.index(x, y)] = rounded(taps.fitted().at_pixel);
      weights[geometry.index(x, y)] = rounded_weight(taps.fitted().weight);
    }
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      if (!geometry.is_surface(x, y)) continue;
      Taps taps;
      for (int v = std::max(y - radius, 0); v <= std::min(y + radius, height - 1); v++) {
        if (!(weights[geometry.index(x, v)] > 0)) continue;
        taps.away.push_back(v - y);
        taps.value.push_back(blocked[geometry.index(x, v)]);
        taps.weight.push_back(weights[geometry.index(x, v)] * weight_at(v - y, x, y) *
                              similarity(geometry, denoiser, x, y, x, v));
      }
      if (taps.whole() > 0) result[geometry.index(x, y)] = 1 - taps.fitted().at_pixel;
    }
  return result;
}

TEST(Interpolate, is_what_its_formulas_say) {
  std::mt19937 random(4);
  RandomScenes scenes(15);
  double mixed = 0;
  std::size_t pixels = 0, unlike = 0;
  for (int i = 0; i < 24; i++) {
    const HostFrame host = i % 3 == 2 ? scenes.next() : random_picture(random);
    const EstimatorSettings settings = all_filters()[std::size_t(i) % all_filters().size()];
    const Sparse sparse(host, settings);
    const std::vector<float> ao = noise(host.data.pixels(), unsigned(i));
    const std::vector<float> result = sparse.interpolated(ao, settings);
    const std::vector<double> expected = interpolated_slowly(sparse, ao, settings);
    pixels += result.size();
    for (std::size_t p = 0; p < result.size(); p++) {
      unlike += !(std::abs(result[p] - expected[p]) < 2e-3);
      mixed += std::abs(expected[p] - ao[p]);
      ASSERT_NEAR(result[p], expected[p], 0.05)
          << name_of(settings) << ", picture " << i << ", pixel " << p % std::size_t(host.data.width) << " "
          << p / std::size_t(host.data.width);
    }
  }
  EXPECT_LT(double(unlike) / double(pixels), 1e-3);
  EXPECT_GT(mixed / double(pixels), 0.1) << "or else it does nothing";
}

/// Expects that a constant stays one, so that no pixel is left without a share of a site, on whatever surface.
void expect_constant(const HostFrame& frame, const EstimatorSettings& settings, float constant,
                     double tolerance = 0.5 / 65535 + 1e-6) {  // half of what rows round to, of what is blocked
  const Sparse sparse(frame, settings);
  const std::vector<float> result = sparse.interpolated(std::vector<float>(frame.depth.size(), constant), settings);
  int wrong = 0;
  for (std::size_t i = 0; i < result.size(); i++) {
    const bool is_open = frame.depth[i] >= frame.sky || constant == 1;
    wrong += !(std::abs(result[i] - (is_open ? 1 : constant)) <= (is_open ? 0 : tolerance));
  }
  EXPECT_EQ(wrong, 0) << "pixels of " << result.size() << ", " << constant << ", " << name_of(settings);
}

TEST(Interpolate, keeps_what_is_constant_and_leaves_the_sky_open) {
  const HostFrame room = furnished_room(93, 71).frame;
  for (const EstimatorSettings& settings : every_reach()) expect_constant(room, settings, 0.37f);
  for (const EstimatorSettings& settings : all_filters())
    for (const float constant : {0.0f, 0.3f, 0.7317f, 1.0f}) expect_constant(room, settings, constant, 1e-4);
}

// Thin and small things too; and what the border cuts off a surface can be a single pixel, with nothing but sky beside.
TEST(Interpolate, leaves_no_pixel_of_any_scene_without_a_site) {
  RandomScenes scenes(18);
  for (int i = 0; i < 150; i++) {
    SCOPED_TRACE("scene " + std::to_string(i));
    expect_constant(scenes.next(), filter(2 << i % 4, 0), 0.37f);
  }
  for (const auto& [what, rendering] : slanted_planes({85}, {0, 37, 77, 111, 200, 301}, {60, 110})) {
    SCOPED_TRACE(what);
    for (const int spacing : {2, 4, 8, 16}) expect_constant(rendering.frame, filter(spacing, 0), 0.37f);
  }
}

/// A wall that faces the camera, tilted, or seen in parallel, up to a column; behind it another one.
HostFrame edge_at(int column, Vec3 normal, bool orthographic) {
  HostFrame frame = wall_at(0, 0, 80, 60, normal, orthographic);
  for (std::size_t i = 0; i < frame.depth.size(); i++)
    if (int(i % 80) >= column) frame.depth[i] *= 1.5f;
  return frame;
}

/// A ramp on the wall in front, dark or open on the one behind.
std::vector<float> ramp_up_to(int column, double slope_x, double slope_y, float behind) {
  std::vector<float> ao;
  for (int i = 0; i < 80 * 60; i++)
    ao.push_back(i % 80 < column ? float(0.1 + slope_x * (i % 80) + slope_y * (i / 80)) : behind);
  return ao;
}

// On each pixel of the wall, up to its edge and to the picture's border, the ramp is met as if it were read two
// pixels beside at most. A mean of the sites is up to 4 pixels off, on that side on which there are none.
TEST(Interpolate, keeps_a_ramp_up_to_an_edge) {
  constexpr double kSlope = 0.008;
  for (const bool orthographic : {false, true})
    for (const Vec3& normal : {Vec3{-1, 0, 0}, unit({-1, 0.4, -0.3})})
      for (const int column : {41, 42, 43, 44})
        for (const EstimatorSettings& settings : {filter(16, 8), filter(8, 8), filter(4, 8), filter(2, 8),
                                                  filter(16, 8, Density::uniform), filter(8, 8, Density::uniform)}) {
          const Sparse sparse(edge_at(column, normal, orthographic), settings);
          for (const auto& [slope_x, slope_y] : {std::pair{kSlope, 0.0}, {0.0, kSlope}, {0.006, 0.004}})
            for (const float behind : {0.0f, 1.0f}) {
              const std::vector<float> ramp = ramp_up_to(column, slope_x, slope_y, behind);
              const std::vector<float> result = sparse.interpolated(ramp, settings);
              const Difference d = difference(result, ramp);
              EXPECT_LT(d.max, 2 * kSlope) << name_of(settings) << " edge " << column << " slopes " << slope_x << " "
                                           << slope_y << " pixel " << d.worst % 80 << " " << d.worst / 80;
            }
        }
}

// On both sides of a crease pixels lie in both planes: the normals tell them apart.
TEST(Interpolate, mixes_nothing_across_a_crease) {
  const Crease crease;
  const std::vector<float> sides = crease.sides();
  for (const EstimatorSettings& settings : {filter(16, 8), filter(8, 8), filter(4, 8), filter(2, 8)}) {
    const Difference d = difference(Sparse(crease.rendering.frame, settings).interpolated(sides, settings), sides);
    EXPECT_LT(d.max, 1e-3) << name_of(settings) << " pixel " << d.worst % 80 << " " << d.worst / 80;
  }
}

/// A thin line and a far wall, in which no plane of the one is anywhere near the other.
HostFrame line_before_far_wall() {
  HostFrame frame = wall_at(0, 0, 45, 37, {-1, 0, 0}, false);
  for (std::size_t y = 5; y < 30; y++) frame.depth[y * 45 + 22 + y % 2] = 0.01f;
  return frame;
}

// Where nothing alike is in reach, a pixel gets what is least unlike, however unlike that is.
TEST(Interpolate, leaves_no_surface_without_a_value) {
  for (const EstimatorSettings& settings : {filter(16, 8, Density::uniform), by_depth(16, 1e-4), by_depth(4, 0.01)}) {
    const Sparse sparse(line_before_far_wall(), settings);
    for (const float ao : sparse.interpolated(std::vector<float>(45 * 37, 0.25f), settings))
      ASSERT_NEAR(ao, 0.25f, 1e-4) << name_of(settings);
  }
}

TEST(Interpolate, reads_no_pixel_that_is_no_site) {
  const Rendering room = furnished_room(61, 45);
  for (const EstimatorSettings& settings : all_filters()) {
    const Sparse sparse(room.frame, settings);
    const std::vector<float> ao = noise(61 * 45, 8), expected = sparse.interpolated(ao, settings, 0.5f);
    for (const float elsewhere : {kNan, -1e30f, std::numeric_limits<float>::infinity()})
      EXPECT_TRUE(same_bits(sparse.interpolated(ao, settings, elsewhere), expected)) << name_of(settings);
  }
}

// The chain with estimates at some pixels.

std::vector<EstimatorSettings> sparse_searches(double radius) {
  std::vector<EstimatorSettings> all;
  for (const Density density : {Density::adaptive, Density::uniform})
    for (const int spacing : {2, 4, 8, 16}) {
      all.push_back(filter(spacing, 0, density));
      all.back().radius = radius;
      all.back().slices = 2;
      all.back().steps = 12;
      EXPECT_EQ(spacing_of(all.back()), spacing);
      EXPECT_EQ(is_adaptive(all.back()), density == Density::adaptive);
    }
  return all;
}

TEST(Sparse, every_pixel_of_a_plane_is_open_at_any_size_and_filter) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {2, 7}, {13, 1}, {31, 17}, {64, 40}}) {
    const HostFrame floor = render({{kFloor}}, Shot::perspective({0, -3, 2}, {0, 0, 0}, 50, width, height)).frame;
    for (EstimatorSettings settings : sparse_searches(1))
      for (const int radius : {0, 1, 2, 3, 8}) {
        settings.denoise_radius = radius;
        expect_open(floor, settings, 0);
      }
  }
}

// Nothing is left without an estimate, be it alone on its surface or beside the sky.
TEST(Sparse, is_as_near_to_the_dense_estimate_as_noise_allows) {
  const HostFrame room = furnished_room(192, 144).frame;
  EstimatorSettings many = filter(1, 1);
  many.radius = 0.5;
  many.slices = 16;
  const std::vector<float> truth = ao_of(room, many);
  EXPECT_GT(difference(truth, [](std::size_t) { return 1.0; }).rmse, 0.1) << "or else there is nothing to find";
  for (const EstimatorSettings& settings : sparse_searches(0.5))
    EXPECT_LT(difference(ao_of(room, settings), truth).rmse, 0.04) << name_of(settings);
}

}  // namespace
}  // namespace alcove::interpolate_test
