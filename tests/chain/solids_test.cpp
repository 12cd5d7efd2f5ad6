// Solids whose fronts lie before the sphere of the radius and whose bodies reach into it, and surfaces that leave the
// picture: against rays, and against wider pictures.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference.h"
#include "tests/support/chain.h"
#include "tests/support/scenes.h"

namespace alcove::solids_test {
namespace {

using namespace test;

// All scenes are as large as a radius of 1 asks for.
enum class Search { reference, exact, slices };
constexpr Search kSearches[] = {Search::reference, Search::exact, Search::slices};
constexpr const char* kNames[] = {"the CPU reference", "the exact search", "the slice search"};

EstimatorSettings settings_of(Search search, ThicknessKind thickness = ThicknessKind::automatic, int slices = 16) {
  EstimatorSettings settings = search == Search::slices ? sampled(Estimator::gtao, 1, slices, 64) : exact(1, slices);
  settings.thickness = thickness;
  settings.complete = Completion::all;
  return settings;
}

/// The AO of some pixels.
std::vector<float> ao_at(Search search, const HostFrame& frame, const EstimatorSettings& settings,
                         const std::vector<std::size_t>& pixels) {
  ReferenceSettings reference = reference_settings_of(settings, !frame.behind.empty());
  reference.slices = settings.slices;
  reference.pixels = pixels;
  const auto all = search == Search::reference ? reference_ao(frame, reference) : ao_of(frame, settings);
  std::vector<float> ao;
  for (const std::size_t pixel : pixels) ao.push_back(all[pixel]);
  return ao;
}

/// A slot without ends in y of that depth below z = 0. Its parts: 0 the ground, 1 the floor, further the walls.
Scene slot(double half_width, double depth) {
  const Vec3 along{0, 20, 0};
  return {{parallelogram({half_width, -10, 0}, {10, 0, 0}, along),
           parallelogram({-half_width, -10, -depth}, {2 * half_width, 0, 0}, along),
           parallelogram({-half_width, -10, -depth}, {0, 0, depth}, along),
           parallelogram({half_width, -10, -depth}, {0, 0, depth}, along),
           parallelogram({-half_width, -10, 0}, {-10, 0, 0}, along)}};
}

// What is flat levels off late, so that the reference and the exact search take these flat things for thicker than they
// are by a little more than half their width.

/// A step before a wall.
Scene step(double tread, double rise) {
  return {{parallelogram({0, -10, -10}, {0, 20, 0}, {0, 0, 20}),
           parallelogram({tread, -10, -rise}, {0, 20, 0}, {0, 0, rise}),
           parallelogram({0, -10, 0}, {tread, 0, 0}, {0, 20, 0})}};
}

/// A slab before the wall x = 0, as deep as half its height, with its front at that distance from the wall.
Scene slab(double front) {
  Scene scene{{kWallX}};
  scene.add(parallelepiped({front - 0.6, -0.6, -0.6}, {0.6, 0, 0}, {0, 1.2, 0}, {0, 0, 1.2}));
  return scene;
}

struct Case {
  std::string name;
  Scene scene;
  Shot shot;
  Chosen chosen;
  double most[3] = {};  // the mean error of each search
  double gain[3] = {};  // by how much it is larger where fronts before the sphere block nothing; 0: any
};

void expect_rays(const Case& c, int every) {
  SCOPED_TRACE(c.name);
  const Rendering rendering = render(c.scene, c.shot);
  const std::vector<std::size_t> pixels = receivers(rendering, 1, every, c.chosen);
  EXPECT_GT(pixels.size(), 12u);
  std::vector<double> truth;
  for (const std::size_t pixel : pixels) truth.push_back(true_ao(c.scene, rendering.hits[pixel], 1, 20));
  const auto error = [&](Search search, ThicknessKind thickness) {
    return difference(ao_at(search, rendering.frame, settings_of(search, thickness), pixels),
                      [&](std::size_t i) { return truth[i]; })
        .mean;
  };
  // Endless occluders are none before the sphere.
  const double without = error(Search::slices, ThicknessKind::infinite);
  for (const Search search : kSearches) {
    const double with = error(search, ThicknessKind::automatic);
    EXPECT_LE(with, c.most[int(search)]) << kNames[int(search)] << ", without " << without;
    EXPECT_GE(without, c.gain[int(search)] * with) << kNames[int(search)];
  }
}

TEST(Solids, the_rim_of_a_deep_hole_hides_the_wall_below_it) {
  const auto is_floor = [](const Hit& hit) { return hit.primitive == 1 && hit.position.z < -1; };
  const auto is_wall = [](const Hit& hit) { return hit.primitive > 1 && hit.position.z < -0.6; };
  const Vec3 target{0, 0, -0.8}, steep{1.8, 0, 6}, slanted{2.7, 0, 6};
  expect_rays({"slot, floor",
               slot(0.5, 1.3),
               Shot::orthographic(steep, target, 3, 96, 96),
               is_floor,
               {0.075, 0.075, 0.12},
               {1.8, 1.8, 1.15}},
              4);
  expect_rays({"slot, wall",
               slot(0.4, 1.3),
               Shot::orthographic(slanted, target, 3.2, 96, 96),
               is_wall,
               {0.085, 0.077, 0.24},
               {5, 5, 1.8}},
              3);
  expect_rays({"cylinder, floor",
               round_hole(0.5, 1.3, 12),
               Shot::perspective(steep, target, 27, 96, 96),
               is_floor,
               {0.165, 0.165, 0.25},
               {1.7, 1.7, 1.1}},
              3);
  expect_rays({"cylinder, wall",
               round_hole(0.45, 1.3, 12),
               Shot::perspective(slanted, target, 28, 120, 120),
               is_wall,
               {0.215, 0.21, 0.37},
               {2.4, 2.4, 1.4}},
              2);
}

TEST(Solids, a_step_hides_its_tread) {
  expect_rays({"step",
               step(1.1, 2),
               Shot::perspective({6, 0.3, -0.8}, {0.5, 0, 0.2}, 40, 96, 96),
               [](const Hit& hit) { return hit.primitive == 0 && hit.position.z < 1; },
               {0.028, 0.027, 0.115},
               {4.9, 5, 1.15}},
              4);
}

TEST(Solids, a_slab_before_a_wall_blocks_as_far_as_it_reaches) {
  const auto is_near = [](const Hit& hit) {
    return hit.primitive == 0 && std::hypot(hit.position.y, hit.position.z) < 1.2;
  };
  struct Front {
    double distance, most[3], gain[3];
  };
  for (const auto& [front, most, gain] : {Front{0.6, {0.02, 0.018, 0.018}, {}},
                                          {1.0, {0.03, 0.032, 0.036}, {2.3, 2.3, 2}},
                                          {1.2, {0.052, 0.053, 0.076}, {1.7, 1.7, 1.2}},
                                          {1.4, {0.05, 0.054, 0.084}, {1.4, 1.3, 0}},
                                          {2.0, {0.002, 0.003, 0.006}, {}}}) {
    Case c{fmt::format("front at {}", front), slab(front), Shot::orthographic({6, 1.5, 0.7}, {0, 0, 0}, 4.4, 80, 80),
           is_near};
    std::ranges::copy(most, c.most);
    std::ranges::copy(gain, c.gain);
    expect_rays(c, 4);
  }
}

TEST(Solids, nothing_jumps_where_a_front_crosses_the_sphere) {
  constexpr int kSteps = 24;
  const Shot shot = Shot::orthographic({6, 0, 0}, {0, 0, 0}, 4, 72, 72);
  for (const Search search : kSearches) {
    std::vector<float> last;
    double sum = 0, largest = 0;
    for (int i = 0; i <= kSteps; i++) {
      const Rendering rendering = render(slab(0.935 + i / 200.0), shot);
      // Their spheres end between 0.954 and 1 before the wall there.
      const std::vector<std::size_t> pixels = receivers(rendering, 1, 2, [](const Hit& hit) {
        const double y = std::abs(hit.position.y), z = std::abs(hit.position.z);
        return hit.primitive == 0 && std::max(y, z) < 0.9 && std::min(y, z) < 0.3;
      });
      ASSERT_GT(pixels.size(), 8u);
      const auto ao = ao_at(search, rendering.frame, settings_of(search, ThicknessKind::automatic, 8), pixels);
      for (std::size_t k = 0; k < last.size(); k++) {
        const double change = std::abs(ao[k] - last[k]);
        sum += change / (kSteps * double(ao.size()));
        largest = std::max(largest, change);
      }
      last = ao;
    }
    // Kernels count in sectors, the CPU reference in angles.
    EXPECT_LE(largest, (search == Search::reference ? 6 : 25) * sum) << kNames[int(search)];
  }
}

/// A board so far before a wall that reaches into the spheres on the wall; a plate far before it hides it if wanted.
Scene board(double front, bool is_hidden) {
  Scene scene{{kWallX, parallelogram({front, -1.5, -1.5}, {0, 3, 0}, {0, 0, 3})}};
  if (is_hidden) scene.primitives.emplace_back(parallelogram({7, -1.9, -1.9}, {0, 3.8, 0}, {0, 0, 3.8}));
  return scene;
}

TEST(Solids, what_is_left_out_before_the_sphere_has_the_bits_of_what_is_computed) {
  for (const Search search : {Search::exact, Search::slices})
    for (const bool is_hidden : {false, true}) {
      // Slices know no more of a board's width than lies within the reach, and take less of it where it is known what
      // lies behind.
      const double front = search == Search::exact ? 1.9 : is_hidden ? 1.1 : 1.3;
      const Scene scene = board(front, is_hidden);
      Rendering rendering = render(scene, Shot::orthographic({9, 0, 0}, {0, 0, 0}, 9.6, 96, 64));
      EstimatorSettings settings = settings_of(search);
      const auto without = ao_of(rendering.frame, settings);
      if (is_hidden) add_solid_peels(rendering, scene, 2);
      const auto skipped = ao_of(rendering.frame, settings);
      settings.no_skip = true;
      const auto whole = ao_of(rendering.frame, settings);
      SCOPED_TRACE(fmt::format("{}, hidden {}", kNames[int(search)], is_hidden));
      EXPECT_TRUE(same_bits(skipped, whole));
      EXPECT_LT(*std::ranges::min_element(whole), is_hidden ? 0.995f : 0.97f) << "the board blocks";
      EXPECT_EQ(same_bits(whole, without), !is_hidden);
    }
}

// Two samples of a search may see two wires, or a wire and the wall: what is seen between them says that they are no
// slope, and no plate as wide as they are apart.
TEST(Solids, wires_before_a_wall_are_as_thin_as_they_look) {
  Scene scene{{kWallX}};
  for (int i = -6; i <= 6; i++) scene.add(parallelepiped({0.3, 0.4 * i, -9}, {0.04, 0, 0}, {0, 0.04, 0}, {0, 0, 18}));
  const Rendering rendering = render(scene, Shot::orthographic({6, 0, 0}, {0, 0, 0}, 4, 200, 200));
  const std::vector<std::size_t> pixels =
      receivers(rendering, 1, 7, [](const Hit& hit) { return hit.primitive == 0 && std::abs(hit.position.y) < 0.9; });
  ASSERT_GT(pixels.size(), 60u);
  double truth = 0;
  for (const std::size_t pixel : pixels) truth += true_ao(scene, rendering.hits[pixel], 1, 24) / double(pixels.size());
  EXPECT_LT(truth, 0.95) << "the wires block";
  EstimatorSettings settings = settings_of(Search::slices, ThicknessKind::automatic, 8);
  settings.steps = 16;
  double mean = 0;
  for (const float ao : ao_at(Search::slices, rendering.frame, settings, pixels)) mean += ao / double(pixels.size());
  EXPECT_NEAR(mean, truth, 0.07) << "0.19 without";
}

TEST(Solids, a_wide_plate_far_before_the_sphere_hides_no_board_that_reaches_into_it) {
  Scene scene{{kWallX, parallelogram({1.05, 0.3, -3}, {0, 0.15, 0}, {0, 0, 6})}};
  const Shot shot = Shot::orthographic({9, 0, 0}, {0, 0, 0}, 4.8, 96, 96);
  const Rendering alone = render(scene, shot);
  scene.primitives.emplace_back(parallelogram({4, 0.45, -3}, {0, 2, 0}, {0, 0, 6}));
  const Rendering beside = render(scene, shot);
  const std::vector<std::size_t> pixels = receivers(beside, 1, 1, [](const Hit& hit) {
    return hit.primitive == 0 && hit.position.y > 0 && std::abs(hit.position.z) < 0.5;
  });
  ASSERT_GT(pixels.size(), 60u);
  for (const Search search : kSearches) {
    EstimatorSettings settings = settings_of(search);
    settings.complete = Completion::none;
    const auto expected = ao_at(search, alone.frame, settings, pixels);
    EXPECT_LT(*std::ranges::min_element(expected), 0.95f) << kNames[int(search)] << ": the board blocks";
    EXPECT_LE(difference(ao_at(search, beside.frame, settings, pixels), expected).max, 1e-6) << kNames[int(search)];
  }
}

/// The pixels of a frame that are so near to its left or right border, or from that far on.
std::vector<std::size_t> columns(const HostFrame& frame, int from, int to) {
  std::vector<std::size_t> pixels;
  for (int y = 4; y < frame.data.height - 4; y += 3)
    for (int x = from; x < to; x++)
      for (const int column : {x, frame.data.width - 1 - x})
        pixels.push_back(std::size_t(y * frame.data.width + column));
  return pixels;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

TEST(Border, a_crease_keeps_its_ao_where_it_leaves_the_picture) {
  for (const Shot& shot : {Shot::perspective({3, 0, 1}, {0.15, 0, 0.1}, 70, 144, 48),
                           Shot::orthographic({3, 0, 1}, {0.15, 0, 0.1}, 4.8, 144, 48)}) {
    const Rendering whole = render({{kFloor, kWallX}}, shot);
    const HostFrame cut = crop_of(whole.frame, {40, 0, 64, 48});
    const std::vector<std::size_t> pixels = columns(cut, 0, 4);
    std::vector<std::size_t> pixels_of_whole;
    for (const std::size_t pixel : pixels) pixels_of_whole.push_back(pixel / 64 * 144 + 40 + pixel % 64);
    for (const Search search : kSearches) {
      EstimatorSettings settings = settings_of(search);
      const auto expected = ao_at(search, whole.frame, settings, pixels_of_whole);
      const auto error = [&](Completion complete) {
        settings.complete = complete;
        return difference(ao_at(search, cut, settings, pixels), expected);
      };
      const Difference with = error(Completion::all), without = error(Completion::none);
      EXPECT_LE(with.mean, 0.01) << kNames[int(search)] << ", without " << without.mean;
      EXPECT_GE(without.mean, 4 * with.mean) << kNames[int(search)];
    }
  }
}

TEST(Border, a_wire_along_it_becomes_no_wall) {
  const Scene scene{{kWallX, parallelogram({0.6, -5, 0.6}, {0, 10, 0}, {0, 0, 0.05})}};
  const Shot shot = Shot::orthographic({3, 0, 0}, {0, 0, 0}, 3, 60, 120);
  const Rendering whole = render(scene, shot);
  const HostFrame cut = crop_of(whole.frame, {0, 47, 60, 73});  // its first row shows the wire
  std::vector<std::size_t> pixels, pixels_of_whole;
  for (std::size_t i = 3 * 60; i < 8 * 60; i++) {
    pixels.push_back(i);
    pixels_of_whole.push_back(i + 47 * 60);
  }
  ASSERT_EQ(whole.hits[47 * 60].primitive, 1);
  ASSERT_EQ(whole.hits[pixels_of_whole.front()].primitive, 0);
  for (const Search search : kSearches) {
    EstimatorSettings settings = settings_of(search, ThicknessKind::constant);
    settings.thickness_length = 0.4;
    const auto expected = ao_at(search, whole.frame, settings, pixels_of_whole);
    EXPECT_LE(difference(ao_at(search, cut, settings, pixels), expected).mean, 0.01) << kNames[int(search)];
  }
}

TEST(Border, a_rough_floor_is_as_open_there_as_elsewhere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> tilt(-0.25f, 0.25f);
  for (const Shot& shot :
       {Shot::perspective({3, 0, 2}, {0, 0, 0}, 60, 80, 48), Shot::orthographic({3, 0, 2}, {0, 0, 0}, 4, 80, 48)}) {
    HostFrame frame = render({{kFloor}}, shot).frame;
    for (std::size_t i = 0; i < frame.depth.size(); i++)
      put_normal(frame, i, unit(normal_at(frame, i) + Vec3{tilt(random), tilt(random), tilt(random)}));
    for (const Search search : kSearches) {
      const EstimatorSettings settings = settings_of(search);
      const double at_border = mean(ao_at(search, frame, settings, columns(frame, 0, 3))),
                   inside = mean(ao_at(search, frame, settings, columns(frame, 34, 37)));
      EXPECT_GE(at_border, inside - 0.01) << kNames[int(search)];
    }
  }
}

}  // namespace
}  // namespace alcove::solids_test
