// What must hold of the AO whatever the scene and the settings: invariances, limits, repairs, odd sizes.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"
#include "tests/support/scenes.h"
#include "tests/support/site_frames.h"

namespace alcove::property_test {
namespace {

using namespace test;

constexpr Estimator kOfTheirOwn[]{Estimator::gtao, Estimator::hbao, Estimator::crytek};  // bitmask searches as gtao

EstimatorSettings gtao(double radius, int slices, int steps) { return sampled(Estimator::gtao, radius, slices, steps); }

HostResult run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings);
}

/// gtao and bitmask, and gtao at a half and a quarter of the resolution.
std::vector<EstimatorSettings> slice_searches(double radius) {
  std::vector<EstimatorSettings> all{gtao(radius, 1, 1), gtao(radius, 3, 6), gtao(radius, 8, 40),
                                     sampled(Estimator::bitmask, radius, 3, 6)};
  for (const Falloff falloff : {Falloff::linear, Falloff::quadratic, Falloff::smooth}) {
    all.push_back(gtao(radius, 2, 3));
    all.back().falloff = falloff;
    all.back().falloff_start = 0.3;
  }
  for (const Resolution resolution : {Resolution::half, Resolution::quarter})
    for (const Denoise denoise : {Denoise::none, Denoise::bilateral, Denoise::box}) {
      all.push_back(gtao(radius, 3, 6));
      all.back().resolution = resolution;
      all.back().denoise = denoise;
    }
  return all;
}

/// hbao and Crytek's estimator with all their variants.
std::vector<EstimatorSettings> other_estimators(double radius) {
  std::vector<EstimatorSettings> all;
  for (const Elevation elevation : {Elevation::view, Elevation::surface})
    for (const Falloff falloff : {Falloff::none, Falloff::linear, Falloff::quadratic, Falloff::smooth}) {
      all.push_back(sampled(Estimator::hbao, radius, 3, 8));
      all.back().elevation = elevation;
      all.back().falloff = falloff;
      all.back().falloff_start = 0.2;
    }
  for (const SampleKernel kernel : {SampleKernel::clustered, SampleKernel::uniform})
    for (const RangeCheck check : {RangeCheck::none, RangeCheck::ratio, RangeCheck::smoothstep}) {
      all.push_back(sampled(Estimator::crytek, radius, 3, 6));
      all.back().samples = check == RangeCheck::none ? 7 : 16;
      all.back().bias = check == RangeCheck::ratio ? 0.01 : 0;
      all.back().sample_kernel = kernel;
      all.back().range_check = check;
    }
  return all;
}

/// Estimates at some pixels, on an adaptive lattice of each spacing or a uniform one.
std::vector<EstimatorSettings> sparse_searches(double radius) {
  std::vector<EstimatorSettings> all;
  for (const Density density : {Density::adaptive, Density::uniform})
    for (const int stride : {2, 4, 8, 16}) {
      all.push_back(gtao(radius, 2, 12));
      all.back().denoise = Denoise::bilateral;
      all.back().density = density;
      all.back().stride = stride;
    }
  return all;
}

/// All of these, every denoiser, and the searches that take no samples.
std::vector<EstimatorSettings> all_kinds(double radius) {
  std::vector<EstimatorSettings> all = slice_searches(radius);
  for (const auto& more : {other_estimators(radius), sparse_searches(radius)})
    all.insert(all.end(), more.begin(), more.end());
  for (int filter = 0; filter < 4; filter++) {
    all.push_back(gtao(radius, 1, 6));
    all.back().denoise = filter == 3 ? Denoise::box : Denoise::bilateral;
    if (filter == 1) all.back().denoise_kernel = {0.227, 0.194, 0.121, 0.054, 0.016};
    if (filter == 2) all.back().denoise_depth_sigma = 0.1;
  }
  all.push_back(exact(radius));
  all.push_back(shared_directions(radius));
  all.push_back(exact(radius));
  all.back().tolerance = 0.05;
  return all;
}

// Flat surfaces.

/// One of a full size; one through a shifted lens, whose pixels are oblong; and at every slant. In the short form a
/// third of the slants, in which each two of all tilts, turns and fields of view meet.
std::vector<SlantedPlane> planes() {
  std::vector<SlantedPlane> all;
  all.push_back({"full size", render({{Plane{.point = {5, 0, 0}, .normal = unit({-0.3, 0.2, 1})}}},
                                     Shot::perspective({}, {1, 0, 0}, 75, 320, 240))});
  Shot shot = along_x(80, 96, 64);
  shot.camera.cx += 70.3;
  shot.camera.cy -= 45.1;
  shot.camera.fy *= 1.7;
  all.push_back({"shifted", render({{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.6, -0.8})}}}, shot)});
  int number = 0;
  for (auto& slanted : slanted_planes({0, 30, 60, 80, 85}, {0, 37, 90, 200}, {0, 10, 60, 90, 120}))
    if (tried(number++, 3)) all.push_back(std::move(slanted));
  return all;
}

// With each change every second search on each plane, and the radii in turn.
TEST(FlatPlane, is_open_at_every_tilt_and_field_of_view) {
  int number = 0;
  for (const auto& [what, rendering] : planes()) {
    SCOPED_TRACE(what);
    const double radii[]{0.002, 0.5, 3, 1e5};
    for (std::size_t i = 0; i < 4; i++) {
      if (!tried(number + int(i), 4)) continue;
      int kind = number / 4;
      for (const EstimatorSettings& settings : slice_searches(radii[i]))
        if (tried(kind++, 2) || what == "full size") expect_open(rendering.frame, settings, 1e-4);
      for (const EstimatorSettings& settings : other_estimators(radii[i]))
        if (tried(kind++, 2)) expect_open(rendering.frame, settings, 0);
    }
    number++;
  }
}

TEST(FlatPlane, is_open_without_normals) {
  for (auto& [what, rendering] : slanted_planes({0, 45, 75}, {68}, {0, 60, 100}, 96, 72)) {
    SCOPED_TRACE(what);
    HostFrame frame = rendering.frame;
    frame.normal.clear();
    for (const double radius : {0.3, 3.0, 1e3}) expect_open(frame, gtao(radius, 3, 12), 1e-3);
    EXPECT_EQ(run(frame, gtao(1, 3, 6)).repaired_normals, 0u) << "nothing was there to repair";
  }
}

// Symmetries of space.

TEST(Scale, by_powers_of_two_and_what_was_before_change_no_bit) {
  const HostFrame room = furnished_room(120, 90).frame, other = furnished_room(31, 17).frame;
  int number = 0;
  for (const EstimatorSettings& settings : all_kinds(0.6)) {
    number++;
    const std::vector<float> expected = ao_of(room, settings);
    EXPECT_LT(*std::ranges::min_element(expected), 0.8f) << name_of(settings);
    ao_of(other, settings);
    for (const int exponent : {-50, 0, 3, 50}) {
      if (std::abs(exponent) < 50 && !tried(number + exponent, 2)) continue;
      EstimatorSettings scaled_settings = settings;
      scaled_settings.radius = std::ldexp(*settings.radius, exponent);
      if (settings.estimator == Estimator::crytek) scaled_settings.bias = std::ldexp(settings.bias, exponent);
      const std::vector<float> ao = ao_of(scaled(room, exponent), scaled_settings);
      EXPECT_TRUE(same_bits(ao, expected))
          << name_of(settings) << ", 2^" << exponent << ": max difference " << difference(ao, expected).max;
    }
  }
  HostFrame without_normals = room;
  without_normals.normal.clear();
  for (const int exponent : {-50, 50})
    EXPECT_TRUE(same_bits(ao_of(scaled(without_normals, exponent), gtao(std::ldexp(0.6, exponent), 3, 6)),
                          ao_of(without_normals, gtao(0.6, 3, 6))));
}

TEST(Scale, changes_no_bit_of_what_is_hidden_or_made_of_the_ao) {
  for (const bool orthographic : {false, true}) {
    Rendering room = render(kRoom, room_shot(64, 48, orthographic));
    add_solid_peels(room, kRoom, 3, {2});
    for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::infinite, ThicknessKind::constant})
      for (const bool is_exact : {false, true}) {
        if (!tried(orthographic + int(thickness) + is_exact, 2)) continue;
        // Beside an exact search, curvature is sampled with the same slices and steps.
        EstimatorSettings settings = is_exact ? exact(0.6, 4) : gtao(0.6, 3, 12);
        settings.steps = 12;
        settings.thickness = thickness;
        settings.thickness_length = 0.2;
        const auto of = [&](int exponent) {
          EstimatorSettings there = settings;
          there.radius = std::ldexp(0.6, exponent);
          there.thickness_length = std::ldexp(0.2, exponent);
          const Planes planes =
              planes_of(scaled(room.frame, exponent), there,
                        "ao,bent-normal,transfer,confidence,specular-occlusion,convexity,cavity", !is_exact);
          return std::array{planes.ao,       planes.bent,      planes.transfer, planes.confidence,
                            planes.specular, planes.convexity, planes.cavity};
        };
        const auto expected = of(0);
        EXPECT_LT(*std::ranges::min_element(expected[0]), 0.8f) << name_of(settings);
        // At 2^-50 the square of a small component is no normal float, and the last bit of a transfer may differ.
        for (const int exponent : {-40, 50}) {
          const auto found = of(exponent);
          for (std::size_t i = 0; i < expected.size(); i++)
            EXPECT_TRUE(same_bits(found[i], expected[i]))
                << name_of(settings) << (orthographic ? ", orthographic" : "") << ", plane " << i << ", 2^" << exponent
                << ": max difference " << difference(found[i], expected[i]).max;
        }
      }
  }
}

/// Sets a pixel's normal.
TEST(NormalSpace, world_normals_are_turned_into_view_space) {
  const Rendering rendering = furnished_room(160, 120);
  HostFrame world = rendering.frame;
  world.normal_space = NormalSpace::world;
  const auto row = [](Vec3 v) { return std::array{v.x, v.y, v.z}; };
  world.camera.view_from_world = Matrix3{row(rendering.shot.right), row(rendering.shot.up), row(rendering.shot.back)};
  for (std::size_t i = 0; i < rendering.hits.size(); i++) put_normal(world, i, rendering.hits[i].normal);
  const Difference d = difference(ao_of(world, gtao(0.6, 3, 12)), ao_of(rendering.frame, gtao(0.6, 3, 12)));
  EXPECT_LE(d.max, 1e-4) << place(d, world);
}

TEST(Sky, hides_its_normals) {
  Rendering rendering = furnished_room(160, 120);
  const std::vector<float> expected = ao_of(rendering.frame, gtao(0.6, 3, 6));
  for (std::size_t i = 0; i < rendering.hits.size(); i++)
    if (rendering.hits[i].primitive < 0) put_normal(rendering.frame, i, {kNan, kNan, 1});
  const HostResult result = run(rendering.frame, gtao(0.6, 3, 6));
  EXPECT_TRUE(same_bits(result.ao, expected));
  EXPECT_EQ(result.repaired_normals, 0u);
}

// Normals of every quality.

TEST(Normals, of_any_length_are_directions) {
  const HostFrame room = furnished_room(160, 120).frame;
  const std::vector<float> expected = ao_of(room, gtao(0.6, 3, 12));
  for (const float factor : {2.0f, 0.125f, 3.0f, 1e-3f, 1e6f}) {
    HostFrame frame = room;
    for (float& n : frame.normal) n *= factor;
    const HostResult result = run(frame, gtao(0.6, 3, 12));
    const Difference d = difference(result.ao, expected);
    EXPECT_LE(d.max, 1e-4) << factor << ", " << place(d, frame);
    EXPECT_EQ(result.repaired_normals, 0u) << factor;
  }
}

TEST(Normals, that_are_no_direction_are_reconstructed_and_counted) {
  const HostFrame plane = slanted_planes({41}, {54}, {60}, 80, 60)[0].rendering.frame;
  for (const Vec3 bad : {Vec3{0, 0, 0},
                         {kNan, kNan, kNan},
                         {kInfinity, kInfinity, kInfinity},
                         {0, -kInfinity, 1},
                         {kNan, 0, 1},
                         {0, 1, kInfinity}}) {
    HostFrame frame = plane;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < frame.depth.size(); i += 3, count++) put_normal(frame, i, bad);
    for (const double radius : {0.5, 100.0}) {
      expect_open(frame, gtao(radius, 3, 12), 1e-3);
      EXPECT_EQ(run(frame, gtao(radius, 3, 12)).repaired_normals, count) << bad.x << " " << bad.y << " " << bad.z;
    }
  }
}

TEST(Normals, that_are_all_broken_are_as_none) {
  const HostFrame room = furnished_room(120, 90).frame;
  HostFrame without = room;
  without.normal.clear();
  for (const Estimator estimator : kOfTheirOwn) {
    const std::vector<float> expected = ao_of(without, sampled(estimator, 0.8, 3, 12));
    EXPECT_LT(*std::ranges::min_element(expected), 0.9f) << int(estimator) << ": there is something to see";
    for (const float broken : {0.0f, kNan, kInfinity, 1e-30f}) {
      HostFrame frame = room;
      std::ranges::fill(frame.normal, broken);
      EXPECT_TRUE(same_bits(ao_of(frame, sampled(estimator, 0.8, 3, 12)), expected)) << int(estimator) << broken;
    }
  }
}

TEST(Normals, of_the_other_side_are_turned_round) {
  const Rendering rendering = furnished();
  const auto right = run(rendering.frame, gtao(1, 3, 6));
  EXPECT_EQ(right.turned_normals, 0u);
  for (const int thing : {0, 1, 2}) {  // the floor, the wall, the ball
    HostFrame frame = rendering.frame;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < rendering.hits.size(); i++) {
      if (rendering.hits[i].primitive != thing) continue;
      put_normal(frame, i, -rendering.shot.view_from_world(rendering.hits[i].normal));
      count++;
    }
    const auto turned = run(frame, gtao(1, 3, 6));
    // A pixel between two edges has no neighbour of its own surface that would show how it lies.
    EXPECT_GE(turned.turned_normals, count - count / 1000) << thing;
    EXPECT_LE(turned.turned_normals, count) << thing;
    EXPECT_LE(difference(turned.ao, right.ao).rmse, 5e-3) << thing;
  }
}

TEST(Normals, that_lean_beyond_the_horizon_are_not_turned) {
  const Scene scene{{Plane{.point = {0, 0, -1}, .normal = {0, 0, 1}}}};
  const Rendering rendering = render(scene, Shot::perspective({}, unit(Vec3{1, 0, -0.1}), 60, 80, 60));
  HostFrame frame = rendering.frame;
  std::size_t away = 0;
  for (std::size_t i = 0; i < rendering.hits.size(); i++) {
    if (rendering.hits[i].primitive < 0) continue;
    const Vec3 p = rendering.hits[i].position;
    const Vec3 n = unit(Vec3{0.6 * std::sin(7 * p.x), 0.6 * std::cos(5 * p.y), 1});
    put_normal(frame, i, rendering.shot.view_from_world(n));
    away += dot(n, p) > 0;
  }
  ASSERT_GT(away, frame.data.pixels() / 20) << "they lean away by up to 31 degrees";
  ASSERT_EQ(frame.normal_space, NormalSpace::view);
  EXPECT_EQ(run(frame, gtao(1, 3, 6)).turned_normals, 0u);
}

// Windows, sizes and any bits.

// With each change every second search at each size that is no square.
TEST(Size, may_be_anything_from_one_pixel_and_any_bits_give_an_ao_from_0_to_1) {
  int number = 0, size = 0;
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {3, 5}, {8, 8}, {9, 7}, {17, 31}, {1, 700}, {700, 3}, {161, 91}}) {
    const Rendering room = furnished_room(width, height);
    const HostFrame plane = slanted_planes({41}, {54}, {40}, width, height)[0].rendering.frame;
    HostFrame bits = random_bits(width, height, 5);
    size++;
    int turn = size;
    for (const EstimatorSettings& kind : all_kinds(0.6)) {
      if (!tried(turn++, 2) && width != height) {
        number++;
        continue;
      }
      EstimatorSettings settings = kind;
      settings.radius = std::array{1e-4, 0.6, 1e3}[std::size_t(number % 3)];
      SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height) + ", " + name_of(settings));
      bits.depth_kind = std::array{DepthKind::planar, DepthKind::ray, DepthKind::inverse}[std::size_t(number / 3 % 3)];
      number++;
      for (const float ao : ao_of(bits, settings)) ASSERT_TRUE(ao >= 0 && ao <= 1) << ao;
      const std::vector<float> ao = ao_of(room.frame, settings);
      for (std::size_t i = 0; i < ao.size(); i++)
        ASSERT_TRUE(ao[i] >= 0 && (room.hits[i].primitive < 0 ? ao[i] == 1 : ao[i] <= 1)) << ao[i] << " at " << i;
    }
    number++;  // so that each search meets each radius and kind of depth: the number of searches is a multiple of 3
    bits.normal.clear();
    for (const float ao : ao_of(bits, gtao(0.6, 3, 6))) ASSERT_TRUE(ao >= 0 && ao <= 1) << ao;
    for (const EstimatorSettings& settings : slice_searches(1))
      if (tried(turn++, 2)) expect_open(plane, settings, 1e-4);
    if (width < 3 || height < 3) continue;
    HostFrame without = plane;
    without.normal.clear();
    expect_open(without, gtao(1, 3, 6), 1e-3);
  }
}

/// A room with strands a pixel wide before it, seen with an overscan.
Rendering overscanned() {
  Scene scene = kRoom;
  scene.primitives.front() = kFloor;
  Shot shot = room_shot(192, 144);
  shot.data = {-24, -16, 240, 176};
  Rendering rendering = render(scene, shot);
  add_strands(rendering.frame);
  return rendering;
}

// Sites and blocks are counted from the display window, and no sum depends on where the image begins. A search reaches
// as far as the radius; what shares estimates a few pixels farther.
TEST(Crop, then_ao_is_ao_then_crop) {
  const Rendering whole = overscanned();
  std::vector<std::pair<EstimatorSettings, int>> rows{{gtao(0.4, 3, 12), 0}};
  for (const Resolution resolution : {Resolution::half, Resolution::quarter}) {
    rows.emplace_back(gtao(0.25, 3, 6), 36);
    rows.back().first.resolution = resolution;
    rows.back().first.denoise = Denoise::bilateral;
  }
  for (const EstimatorSettings& settings : sparse_searches(0.1)) rows.emplace_back(settings, 30);
  for (const Estimator estimator : {Estimator::bitmask, Estimator::hbao, Estimator::crytek})
    rows.emplace_back(sampled(estimator, 0.2, 3, 8), 0);
  for (const Estimator estimator : {Estimator::gtao, Estimator::bitmask}) {
    rows.emplace_back(sampled(estimator, 0.1, 3, 8), 0);
    rows.back().first.thickness = ThicknessKind::automatic;
  }
  for (const auto& [settings, farther_px] : rows) {
    // The width of an occluder is measured over 3 radii at most.
    const double seen_radius = (settings.thickness == ThicknessKind::automatic ? 3 : 1) * *settings.radius;
    const std::vector<float> expected = ao_of(whole.frame, settings);
    for (const Window& window : {Window{37, 21, 130, 110}, {35, 22, 133, 111}, {0, 0, 192, 144}, {-7, -5, 170, 145}}) {
      Shot seen = whole.shot;
      seen.data = window;
      const std::vector<float> ao = ao_of(crop_of(whole.frame, window), settings),
                               there = cropped(expected, whole.frame.data, window);
      int darkened = 0;
      for (std::size_t i = 0; i < ao.size(); i++) {
        const int x = int(i) % window.width, y = int(i) / window.width;
        const Hit& hit = whole.at(x + window.x - whole.shot.data.x, y + window.y - whole.shot.data.y);
        if (std::min({x, y, window.width - 1 - x, window.height - 1 - y}) < farther_px || hit.primitive < 0 ||
            !seen.sees_ball(hit.position, seen_radius))
          continue;
        ASSERT_EQ(ao[i], there[i]) << name_of(settings) << ", window at " << window.x << ", pixel " << x << " " << y;
        darkened += ao[i] < 0.98;
      }
      EXPECT_GT(darkened, 20) << name_of(settings) << ", window at " << window.x;
    }
  }
}

// The radius.

TEST(Radius, of_few_pixels_darkens_a_crease) {
  const HostFrame frame = render({{kFloor, kWallX}}, Shot::perspective({4, 0, 4}, {}, 30, 80, 60)).frame;
  EXPECT_LT(std::ranges::min(ao_of(frame, gtao(0.2, 3, 6))), 0.7f);
}

}  // namespace
}  // namespace alcove::property_test
