// Convexity, cavity and curvature: closed forms, rays within solids, the CPU reference, and what must leave them alone.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/reference_planes.h"
#include "tests/support/scenes.h"
#include "tests/support/wall_frame.h"

namespace alcove::curvature_test {
namespace {

using namespace test;

constexpr const char* kAll = "ao,convexity,cavity,curvature";

/// The default passes.
EstimatorSettings usual(double radius) {
  EstimatorSettings settings;
  settings.radius = radius;
  return settings;
}
EstimatorSettings fine(double radius) { return sampled(Estimator::gtao, radius, 32, 32); }

// Solids, as functions that are below 0 within.

using Solid = std::function<double(Vec3)>;

Vec3 normal_of(const Solid& solid, Vec3 p) {
  constexpr double h = 1e-5;
  return unit({solid(p + Vec3{h, 0, 0}) - solid(p - Vec3{h, 0, 0}), solid(p + Vec3{0, h, 0}) - solid(p - Vec3{0, h, 0}),
               solid(p + Vec3{0, 0, h}) - solid(p - Vec3{0, 0, h})});
}

/// The first parameter up to `most` at which a ray from outside is inside, or one from inside outside; infinite: none.
double crossing(const Solid& solid, Vec3 origin, Vec3 direction, double first, double most, int parts) {
  const bool starts_inside = solid(origin + first * direction) < 0;
  double before = first;
  for (int i = 1; i <= parts; i++) {
    double after = first + (most - first) * i / parts;
    if ((solid(origin + after * direction) < 0) == starts_inside) {
      before = after;
      continue;
    }
    for (int k = 0; k < 40; k++) {
      const double middle = 0.5 * (before + after);
      ((solid(origin + middle * direction) < 0) == starts_inside ? before : after) = middle;
    }
    return after;
  }
  return kNowhere;
}

/// What a camera sees of a solid.
struct View {
  HostFrame frame;
  std::vector<std::optional<Vec3>> points;
};
View view_of(const Solid& solid, const Shot& shot) {
  constexpr double kFar = 10;
  constexpr int kParts = 200;  // what is thinner along a ray than one of them may be missed
  View view{render({}, shot).frame, {}};
  const std::size_t pixels = shot.data.pixels();
  view.points.resize(pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    const auto width = std::size_t(shot.data.width);
    const Ray ray = shot.ray(double(i % width) + 0.5, double(i / width) + 0.5);
    const double z = crossing(solid, ray.origin, ray.direction, 0, kFar, kParts);
    if (z == kNowhere) continue;
    view.points[i] = ray.origin + z * ray.direction;
    view.frame.depth[i] = float(z);
    put_normal(view.frame, i, shot.view_from_world(normal_of(solid, *view.points[i])));
  }
  return view;
}

/// The part of the cosine-weighted hemisphere about a direction whose rays cross the surface within the radius.
double blocked(const Solid& solid, Vec3 point, Vec3 normal, double radius) {
  constexpr int kAcross = 24, kAround = 48, kParts = 50;
  const Vec3 helper = std::abs(normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 x = unit(cross(helper, normal)), y = cross(normal, x);
  int hits = 0;
  for (int i = 0; i < kAcross; i++)
    for (int j = 0; j < kAround; j++) {
      const double s = std::sqrt((i + 0.5) / kAcross), a = 2 * kPi * (j + 0.5) / kAround;
      const Vec3 way = s * std::cos(a) * x + s * std::sin(a) * y + std::sqrt(1 - s * s) * normal;
      const auto is_inside = [&](int part) {
        const double first = 0.01 * radius;  // what is nearer to the point is flat
        return solid(point + (first + (radius - first) * part / kParts) * way) < 0;
      };
      const bool starts_inside = is_inside(0);
      int part = 1;
      while (part <= kParts && is_inside(part) == starts_inside) part++;
      hits += part <= kParts ? 1 : 0;
    }
  return double(hits) / (kAcross * kAround);
}

/// What is expected of the pixels about the middle of a picture.
struct Case {
  std::string name;
  Solid solid;
  Shot shot;
  double radius;
  std::function<double(Vec3)> convexity, cavity;  // none: by rays, and with each change at every second pixel
  int half_px = 10;
};

void expect_truth(const Case& c, const View& view) {
  SCOPED_TRACE(c.name);
  const bool has_rays = !c.convexity || !c.cavity;
  const Planes planes = planes_of(view.frame, fine(c.radius), kAll);
  int count = 0;
  double worst = 0, mean = 0;
  std::string where;
  const int width = c.shot.data.width, height = c.shot.data.height;
  for (int y = height / 2 - c.half_px; y <= height / 2 + c.half_px; y += 2)
    for (int x = width / 2 - c.half_px; x <= width / 2 + c.half_px; x += 2) {
      if (has_rays && !tried((x + y) / 2, 2)) continue;
      const auto i = std::size_t(y * width + x);
      ASSERT_TRUE(view.points[i]) << x << " " << y;
      const Vec3 p = *view.points[i], n = normal_of(c.solid, p);
      const double in = c.convexity ? c.convexity(p) : blocked(c.solid, p, -n, c.radius);
      const double out = c.cavity ? c.cavity(p) : blocked(c.solid, p, n, c.radius);
      ASSERT_NEAR(planes.curvature[i], 0.5 + 0.5 * (planes.convexity[i] - planes.cavity[i]), 1e-6);
      for (const auto& [value, truth, what] :
           {std::tuple{planes.convexity[i], in, "convexity"}, {planes.cavity[i], out, "cavity"}}) {
        const double error = std::abs(value - truth);
        mean += error;
        count++;
        if (error <= worst) continue;
        worst = error;
        where = fmt::format("{} {} where {} is right, at {}, {}", what, value, truth, x, y);
      }
    }
  EXPECT_LE(worst, 0.01) << where;
  EXPECT_LE(mean / count, 0.0025);
}

void expect_truth(const Case& c) { expect_truth(c, view_of(c.solid, c.shot)); }

const auto kNothing = [](Vec3) { return 0.0; };
Shot from_above(double units = 2) { return Shot::orthographic({0, 0, 3}, {}, units, 120, 120); }
Shot aslant(double fov = 40) { return Shot::perspective({1.5, -1, 4}, {0, 0, 0.6}, fov, 120, 120); }

double ball(Vec3 p, double radius) { return length(p) - radius; }

TEST(Curvature, of_a_sphere_is_the_square_of_the_radius_to_the_diameter) {
  const auto sphere = [](Vec3 p) { return ball(p, 1); };
  const auto hollow = [](Vec3 p) { return std::max(p.z - 0.2, 1 - length(p)); };  // a block with a hollow
  const Shot above = from_above(), oblique = Shot::perspective({2, -1, 3}, {}, 25, 120, 120);
  const View of_sphere = view_of(sphere, above), of_hollow = view_of(hollow, above), beside = view_of(sphere, oblique);
  for (const int number : {0, 1}) {
    const double radius = number == 0 ? 0.3 : 0.6, truth = radius * radius / 4;
    const auto share = [=](Vec3) { return truth; };
    if (tried(number, 2)) expect_truth({"from above", sphere, above, radius, share, kNothing}, of_sphere);
    if (tried(number, 2)) expect_truth({"hollow", hollow, above, radius, kNothing, share}, of_hollow);
    if (tried(number + 1, 2)) expect_truth({"aslant", sphere, oblique, radius, share, kNothing}, beside);
    // With few samples, too: the surface goes on from the last one to the radius.
    const Planes planes = planes_of(of_sphere.frame, sampled(Estimator::gtao, radius, 16, 16), kAll);
    EXPECT_NEAR(planes.convexity[60 * 120 + 60], truth, 0.04 * truth);
  }
}

TEST(Curvature, of_a_box_edge_is_the_mirror_of_an_inner_corner) {
  const double radius = 0.8;
  const auto edge = [](Vec3 p) { return std::max(p.z, p.x); };     // within z < 0 and x < 0
  const auto corner = [](Vec3 p) { return std::min(p.z, -p.x); };  // a floor and a wall at x > 0
  const auto beside = [=](double d) { return segment(std::min(1.0, std::abs(d) / radius)) / kPi; };
  for (const double d : {0.06, 0.16, 0.32, 0.56})
    expect_truth({fmt::format("edge, {} away", d), edge, Shot::perspective({2.4, 0.6, 3}, {-d, 0, 0}, 30, 120, 120),
                  radius, [=](Vec3 p) { return beside(std::min(std::abs(p.x), std::abs(p.x) + std::abs(p.z))); },
                  kNothing, 1});
  const Shot into = Shot::perspective({-2.4, 0.6, 3}, {-0.35, 0, 0}, 30, 120, 120);
  expect_truth({"corner", corner, into, radius, kNothing,
                [=](Vec3 p) { return beside(std::max(std::abs(p.x), std::abs(p.z))); }});
}

TEST(Curvature, of_wedges_is_what_rays_find_within) {
  for (const double degrees : {60, 90, 120}) {
    const double half = degrees * kPi / 360;
    // Symmetrical about z, its edge along y at the origin.
    const auto wedge = [=](Vec3 p) { return std::cos(half) * std::abs(p.x) + std::sin(half) * p.z; };
    expect_truth({fmt::format("{} degrees", degrees),
                  wedge,
                  Shot::perspective({0, -1, 5}, {0.2 * std::sin(half), 0, -0.2 * std::cos(half)}, 22, 120, 120),
                  0.6,
                  {},
                  kNothing,
                  4});
    const auto groove = [=](Vec3 p) { return -(std::cos(half) * std::abs(p.x) - std::sin(half) * p.z); };
    if (degrees > 60)
      expect_truth({fmt::format("a groove of {} degrees", degrees),
                    groove,
                    Shot::perspective({0, -1, 5}, {0.2 * std::sin(half), 0, 0.2 * std::cos(half)}, 22, 120, 120),
                    0.6,
                    kNothing,
                    {},
                    4});
  }
}

TEST(Curvature, of_cylinder_torus_and_saddles_is_what_rays_find) {
  const auto cylinder = [](Vec3 p) { return std::hypot(p.x, p.z) - 1; };
  expect_truth({"cylinder", cylinder, from_above(), 0.6, {}, {}});
  expect_truth({"cylinder aslant", cylinder, aslant(), 0.6, {}, {}});
  const auto torus = [](Vec3 p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.5; };
  expect_truth({"torus, outside", torus, Shot::perspective({4, 0, 2}, {1.3, 0, 0.35}, 25, 120, 120), 0.4, {}, {}});
  expect_truth({"torus, inside", torus, Shot::perspective({-1.2, 0, 4}, {0.7, 0, 0.3}, 25, 120, 120), 0.4, {}, {}});
  const auto saddle = [](double a, double b) {
    return [=](Vec3 p) { return p.z - 0.5 * (a * p.x * p.x + b * p.y * p.y); };
  };
  expect_truth({"a bent ridge", saddle(-1, 0.4), from_above(), 0.6, {}, {}});
  // Where the sum of the principal curvatures is 0, both sides block the same.
  const View even = view_of(saddle(-1, 1), from_above());
  const Planes planes = planes_of(even.frame, fine(0.6), kAll);
  EXPECT_NEAR(planes.curvature[60 * 120 + 60], 0.5, 0.003);
  // A quarter of the square of R / 2: half of the mean of cos^2 of the double angle.
  EXPECT_NEAR(planes.convexity[60 * 120 + 60], 0.25 * 0.09, 0.01);
  EXPECT_NEAR(planes.cavity[60 * 120 + 60], 0.25 * 0.09, 0.01);
}

// What is not seen.

/// The largest distance of a plane from a value, over those pixels; all: none.
double farthest(const std::vector<float>& plane, double value, const std::function<bool(std::size_t)>& counts) {
  double most = plane.empty() ? kNowhere : 0;
  for (std::size_t i = 0; i < plane.size(); i++)
    if (counts(i)) most = std::max(most, std::abs(plane[i] - value));
  return most;
}

TEST(Curvature, turns_back_at_an_outline_as_at_a_box_edge) {
  // The front of a box that hides all its other sides, before a wall and before the sky.
  for (const bool has_wall : {true, false}) {
    Scene scene{{parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0})}};
    if (has_wall) scene.primitives.push_back(Plane{.point = {0, 0, -3}, .normal = {0, 0, 1}});
    const Rendering rendering = render(scene, Shot::orthographic({0, 0, 4}, {}, 3, 120, 120));
    const Planes planes = planes_of(rendering.frame, fine(0.5), kAll);
    for (int x = 22; x <= 60; x++) {
      const auto i = std::size_t(60 * 120 + x);
      const double d = rendering.hits[i].position.x + 1;
      ASSERT_NEAR(planes.convexity[i], segment(std::min(1.0, d / 0.5)) / kPi, 0.02) << x << " " << has_wall;
      ASSERT_EQ(planes.cavity[i], 0) << x;
    }
  }
}

TEST(Curvature, of_a_wall_does_not_change_behind_what_stands_before_it) {
  const Scene scene{
      {Plane{.point = {}, .normal = {0, 0, 1}}, parallelogram({-0.4, -0.4, 0.5}, {0.8, 0, 0}, {0, 0.8, 0})}};
  const Rendering rendering = render(scene, Shot::perspective({0.3, 0.2, 4}, {}, 40, 120, 90));
  for (const EstimatorSettings& settings : {fine(1), usual(1)}) {
    const Planes planes = planes_of(rendering.frame, settings, kAll);
    const auto is_wall = [&](std::size_t i) { return rendering.hits[i].primitive == 0; };
    // Between two samples that lie far apart a surface may seem to rise.
    EXPECT_LE(farthest(planes.curvature, 0.5, is_wall), settings.steps == 32 ? 0 : 0.006) << name_of(settings);
    EXPECT_LT(std::ranges::min(planes.ao), 0.9f) << "it does block";
  }
}

TEST(Curvature, of_planes_is_exactly_none_at_every_slant) {
  for (const auto& [what, rendering] : slanted_planes({0, 40, 75, 85}, {0, 37, 200}, {0, 60, 110})) {
    SCOPED_TRACE(what);
    for (const EstimatorSettings& settings : {sampled(Estimator::gtao, 1, 8, 16), usual(1)}) {
      const Planes planes = planes_of(rendering.frame, settings, kAll);
      const auto is_any = [](std::size_t) { return true; };
      ASSERT_EQ(farthest(planes.convexity, 0, is_any), 0) << name_of(settings);
      ASSERT_EQ(farthest(planes.cavity, 0, is_any), 0) << name_of(settings);
      ASSERT_EQ(farthest(planes.curvature, 0.5, is_any), 0) << name_of(settings);
    }
  }
}

// Beside the rest of the chain.

EstimatorSettings with(EstimatorSettings settings, const std::function<void(EstimatorSettings&)>& change) {
  change(settings);
  return settings;
}

/// Estimators, searches and filters of all kinds.
std::vector<EstimatorSettings> kinds(double radius) {
  std::vector<EstimatorSettings> all{usual(radius), sampled(Estimator::gtao, radius, 4, 12), exact(radius, 4),
                                     shared_directions(radius)};
  for (const Estimator estimator : {Estimator::hbao, Estimator::bitmask, Estimator::crytek})
    all.push_back(with(usual(radius), [=](auto& s) { s.estimator = estimator; }));
  all.push_back(with(usual(radius), [](auto& s) { s.resolution = Resolution::half; }));
  all.push_back(with(usual(radius), [](auto& s) { s.falloff = Falloff::linear; }));
  all.push_back(with(usual(radius), [](auto& s) { s.thickness = ThicknessKind::constant, s.thickness_length = 0.1; }));
  all.push_back(with(exact(radius, 8), [](auto& s) { s.tolerance = 0.02; }));
  all.push_back(with(usual(radius), [](auto& s) { s.density = Density::uniform, s.stride = 4; }));
  return all;
}

TEST(Curvature, leaves_every_bit_of_the_rest_and_is_found_by_every_search) {
  const Rendering room = furnished_room(96, 64);
  const Planes many = planes_of(room.frame, sampled(Estimator::gtao, 0.6, 32, 32), kAll);
  int number = 0;
  for (const EstimatorSettings& settings : kinds(0.6)) {
    if (number++ % 4 == 1 && !long_tests()) continue;
    const char* const others = searches_slices(settings) ? "ao,bent-normal,transfer" : "ao,specular-occlusion";
    const Planes alone = planes_of(room.frame, settings, others);
    const Planes all = planes_of(room.frame, settings, std::string(others) + "," + kAll);
    EXPECT_TRUE(same_bits(all.ao, alone.ao)) << name_of(settings);
    EXPECT_TRUE(same_bits(all.bent, alone.bent)) << name_of(settings);
    EXPECT_TRUE(same_bits(all.transfer, alone.transfer)) << name_of(settings);
    EXPECT_TRUE(same_bits(all.specular, alone.specular)) << name_of(settings);
    EXPECT_TRUE(same_bits(all.curvature, planes_of(room.frame, settings, "curvature").curvature)) << name_of(settings);
    if (settings.falloff != Falloff::none) continue;
    EXPECT_LE(difference(all.curvature, many.curvature).rmse, 0.05) << name_of(settings);
  }
}

// With each change each falloff is that of one scene.
TEST(Curvature, is_that_of_the_cpu_reference) {
  for (const char* scene : {"monkeys", "colonnade"}) {
    const HostFrame frame = rendered_frame(scene);
    const double radius = scene == std::string("monkeys") ? 0.5 : 0.75;
    for (const Falloff falloff : {Falloff::none, Falloff::linear}) {
      if (!tried((scene == std::string("monkeys")) + (falloff == Falloff::linear), 2)) continue;
      EstimatorSettings settings = sampled(Estimator::gtao, radius, 16, 64);
      settings.falloff = falloff;
      ReferenceSettings reference = reference_settings_of(settings);
      reference.slices = 16;
      for (std::size_t i = 7; i < frame.data.pixels(); i += 211)
        if (frame.depth[i] < kSky) reference.pixels.push_back(i);
      const std::vector<float> expected = reference_curvature(frame, reference);
      const Planes planes = planes_of(frame, settings, kAll);
      double inside = 0, outside = 0;
      for (const std::size_t i : reference.pixels) {
        inside += std::pow(planes.convexity[i] - expected[i], 2);
        outside += std::pow(planes.cavity[i] - expected[i + frame.data.pixels()], 2);
      }
      const double count = double(reference.pixels.size());
      EXPECT_LE(std::sqrt(inside / count), 0.05) << scene << " " << int(falloff);
      EXPECT_LE(std::sqrt(outside / count), 0.02) << scene << " " << int(falloff);
    }
  }
}

TEST(Curvature, falls_off_as_the_mean_of_hard_radii) {
  const auto edge = [](Vec3 p) { return std::max(p.z, p.x); };
  const View view = view_of(edge, Shot::perspective({2.4, 0.6, 3}, {-0.3, 0, 0}, 30, 120, 120));
  EstimatorSettings settings = fine(0.8);
  settings.falloff = Falloff::linear;
  settings.falloff_start = 0.25;
  const auto i = std::size_t(60 * 120 + 60);
  const double d = std::abs(view.points[i]->x);
  double expected = 0;
  for (int k = 0; k < 64; k++)
    expected += segment(std::min(1.0, d / (0.8 * (0.25 + 0.75 * (k + 0.5) / 64)))) / kPi / 64;
  EXPECT_NEAR(planes_of(view.frame, settings, kAll).convexity[i], expected, 0.01);
}

TEST(Curvature, of_several_radii_is_each_alone_and_their_mean) {
  const HostFrame frame = furnished_room(64, 48).frame;
  const std::size_t pixels = frame.data.pixels();
  for (EstimatorSettings settings : {sampled(Estimator::gtao, 0.2, 4, 12), sampled(Estimator::hbao, 0.2, 4, 12)}) {
    settings.further_radii = {0.6};
    const Planes both = planes_of(frame, settings, "ao,bent-normal,ao-scales,curvature");
    ASSERT_EQ(both.curvature.size(), 3 * pixels);
    for (const std::size_t k : {1, 2}) {
      const Planes one = planes_of(frame, sampled(settings.estimator, k == 1 ? 0.2 : 0.6, 4, 12), "curvature");
      const std::vector<float> plane(both.curvature.begin() + std::ptrdiff_t(k * pixels),
                                     both.curvature.begin() + std::ptrdiff_t((k + 1) * pixels));
      EXPECT_TRUE(same_bits(plane, one.curvature)) << k;
    }
    for (std::size_t i = 0; i < pixels; i++)
      ASSERT_NEAR(both.curvature[i], 0.5 * (both.curvature[i + pixels] + both.curvature[i + 2 * pixels]), 1e-6) << i;
  }
}

// Files.

class CurvatureFiles : public CommandLine {};

TEST_F(CurvatureFiles, have_a_channel_for_each_and_of_several_radii_one_for_each_of_them) {
  done({"--aov", "curvature,cavity"});
  Image image = read_exr_image(ao);
  EXPECT_THAT(image.names, UnorderedElementsAre("curvature.Y", "cavity.Y"));
  done({"--aov", "convexity", "--radius", "0.3"});
  image = read_exr_image(ao);
  EXPECT_THAT(image.names, UnorderedElementsAre("convexity.Y", "convexity1.Y", "convexity2.Y"));
}

TEST_F(CurvatureFiles, of_a_region_hold_what_the_whole_holds_there) {
  for (const char* more :
       {",ao-scales,bent-normal,transfer --radius 1.5 --radius 0.3", " --radius 1 --preset production",
        " --radius 1 --preset reference", " --radius 1 --preset draft"})
    expect_region_of_whole(typed(std::string("--aov ao,convexity,cavity,curvature") + more), {20, 18, 9, 9});
}

TEST_F(CurvatureFiles, of_the_mean_of_equal_frames_are_those_of_one) {
  for (int i = 1; i <= 3; i++) wall_frame().write(folder / fmt::format("same.{:04}.exr", i));
  const auto of = [&](const Options& more) {
    run_well(joined(
        {"run", folder / "same.%04d.exr", "-o", folder / "out.%04d.exr", "--frames", "1-3", "--camera", camera,
         "--radius", "1", "--radius", "0.5", "--aov", "ao,ao-scales,transfer,convexity,cavity", "--type", "float"},
        more));
    return read_exr_image(folder / "out.0002.exr");
  };
  const Image alone = of({}), mean = of({"--accumulate", "1"});
  EXPECT_GT(std::ranges::max(alone.plane("cavity.Y")), 0.2f);
  // The noise of each of the frames is another one.
  for (const std::string& name : alone.names) {
    const auto expected = alone.plane(name), found = mean.plane(name);
    const Difference d = difference({found.begin(), found.end()}, [&](std::size_t i) { return double(expected[i]); });
    EXPECT_LE(d.rmse, 0.03) << name;
  }
}

TEST_F(CurvatureFiles, are_flat_outside_a_matte_and_on_sky) {
  FrameFile file = wall_frame();
  file.planes["Matte.Y"] = std::vector<float>(file.data.pixels(), 0.0f);
  file.write(frame);
  done({"--aov", "cavity,curvature"});
  EXPECT_GT(std::ranges::max(read_exr_image(ao).plane("cavity.Y")), 0.2f);
  done({"--aov", "convexity,cavity,curvature", "--set", "matte-channel=Matte.Y"});
  const Image image = read_exr_image(ao);
  EXPECT_THAT(std::vector<float>(image.plane("curvature.Y").begin(), image.plane("curvature.Y").end()), Each(0.5f));
  EXPECT_THAT(std::vector<float>(image.plane("cavity.Y").begin(), image.plane("cavity.Y").end()), Each(0.0f));
}

}  // namespace
}  // namespace alcove::curvature_test
