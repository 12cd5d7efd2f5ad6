// Convexity, cavity and curvature: closed forms, rays within solids, the CPU reference, and what must leave them alone.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/furnished.h"
#include "tests/support/wall_frame.h"

namespace alcove::curvature_test {
namespace {

using namespace test;

constexpr const char* kAll = "ao,convexity,cavity,curvature";

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
    for (int k = 0; k < 50; k++) {
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
View view_of(const Solid& solid, const Shot& shot, double far) {
  View view{render({}, shot).frame, {}};
  const std::size_t pixels = shot.data.pixels();
  view.points.resize(pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    const auto width = std::size_t(shot.data.width);
    const Ray ray = shot.ray(double(i % width) + 0.5, double(i / width) + 0.5);
    const double z = crossing(solid, ray.origin, ray.direction, 0, far, 600);
    if (z == kNowhere) continue;
    view.points[i] = ray.origin + z * ray.direction;
    const Vec3 n = shot.view_from_world(normal_of(solid, *view.points[i]));
    view.frame.depth[i] = float(z);
    view.frame.normal[i] = float(n.x);
    view.frame.normal[i + pixels] = float(n.y);
    view.frame.normal[i + 2 * pixels] = float(n.z);
  }
  return view;
}

/// The part of the cosine-weighted hemisphere about a direction whose rays cross the surface within the radius.
double blocked(const Solid& solid, Vec3 point, Vec3 normal, double radius) {
  constexpr int kAcross = 24, kAround = 48;
  const Vec3 helper = std::abs(normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 x = unit(cross(helper, normal)), y = cross(normal, x);
  int hits = 0;
  for (int i = 0; i < kAcross; i++)
    for (int j = 0; j < kAround; j++) {
      const double s = std::sqrt((i + 0.5) / kAcross), a = 2 * kPi * (j + 0.5) / kAround;
      const Vec3 way = s * std::cos(a) * x + s * std::sin(a) * y + std::sqrt(1 - s * s) * normal;
      // What is nearer than this to the point is flat.
      hits += crossing(solid, point, way, 0.01 * radius, radius, 200) < kNowhere ? 1 : 0;
    }
  return double(hits) / (kAcross * kAround);
}

/// What is expected of the pixels about the middle of a picture.
struct Case {
  std::string name;
  Solid solid;
  Shot shot;
  double radius, far;
  std::function<double(Vec3)> convexity, cavity;  // none: by rays
  int half_px = 10;
};

void expect_truth(const Case& c) {
  SCOPED_TRACE(c.name);
  const View view = view_of(c.solid, c.shot, c.far);
  const Planes planes = planes_of(view.frame, fine(c.radius), kAll);
  int count = 0;
  double worst = 0, mean = 0;
  std::string where;
  const int width = c.shot.data.width, height = c.shot.data.height;
  for (int y = height / 2 - c.half_px; y <= height / 2 + c.half_px; y += 2)
    for (int x = width / 2 - c.half_px; x <= width / 2 + c.half_px; x += 2) {
      const auto i = std::size_t(y * width + x);
      ASSERT_TRUE(view.points[i]) << x << " " << y;
      const Vec3 p = *view.points[i], n = normal_of(c.solid, p);
      const double in = c.convexity ? c.convexity(p) : blocked(c.solid, p, -n, c.radius);
      const double out = c.cavity ? c.cavity(p) : blocked(c.solid, p, n, c.radius);
      ASSERT_NEAR(planes.curvature[i], 0.5 + 0.5 * (planes.convexity[i] - planes.cavity[i]), 1e-6);
      for (const auto& [value, truth, what] : {std::tuple{planes.convexity[i], in, "convexity"},
                                               {planes.cavity[i], out, "cavity"}}) {
        const double error = std::abs(value - truth);
        mean += error;
        count++;
        if (error <= worst) continue;
        worst = error;
        where = fmt::format("{} {} where {} is right, at {}, {}", what, value, truth, x, y);
      }
    }
  EXPECT_LE(worst, 0.02) << where;
  EXPECT_LE(mean / count, 0.01);
  std::cerr << c.name << " worst " << worst << " mean " << mean / count << "\n";
}

const auto kNothing = [](Vec3) { return 0.0; };
Shot from_above(double units = 2) { return Shot::orthographic({0, 0, 3}, {}, units, 120, 120); }
Shot aslant(double fov = 40) { return Shot::perspective({1.5, -1, 4}, {0, 0, 0.6}, fov, 120, 120); }

double ball(Vec3 p, double radius) { return length(p) - radius; }

TEST(Curvature, of_a_sphere_is_the_square_of_the_radius_to_the_diameter) {
  const auto sphere = [](Vec3 p) { return ball(p, 1); };
  for (const double radius : {0.3, 0.6}) {
    const double truth = radius * radius / 4;
    expect_truth({"from above", sphere, from_above(), radius, 10, [=](Vec3) { return truth; }, kNothing});
    expect_truth({"aslant", sphere, Shot::perspective({2, -1, 3}, {}, 25, 120, 120), radius, 10,
                  [=](Vec3) { return truth; }, kNothing});
    // A block with a hollow.
    const auto hollow = [](Vec3 p) { return std::max(p.z - 0.2, 1 - length(p)); };
    expect_truth({"hollow", hollow, from_above(), radius, 10, kNothing, [=](Vec3) { return truth; }});
  }
}

TEST(Curvature, of_a_box_edge_is_the_mirror_of_an_inner_corner) {
  const double radius = 0.8;
  const auto edge = [](Vec3 p) { return std::max(p.z, p.x); };     // within z < 0 and x < 0
  const auto corner = [](Vec3 p) { return std::min(p.z, -p.x); };  // a floor and a wall at x > 0
  const auto beside = [=](double d) { return segment(std::min(1.0, std::abs(d) / radius)) / kPi; };
  for (const double d : {0.04, 0.16, 0.32, 0.56})
    expect_truth({fmt::format("edge, {} away", d), edge, Shot::perspective({2.4, 0.6, 3}, {-d, 0, 0}, 30, 120, 120),
                  radius, 10, [=](Vec3 p) { return beside(std::min(std::abs(p.x), std::abs(p.x) + std::abs(p.z))); },
                  kNothing, 1});
  const Shot into = Shot::perspective({-2.4, 0.6, 3}, {-0.35, 0, 0}, 30, 120, 120);
  expect_truth({"corner", corner, into, radius, 10, kNothing,
                [=](Vec3 p) { return beside(std::max(std::abs(p.x), std::abs(p.z))); }});
}

TEST(Curvature, of_wedges_is_what_rays_find_within) {
  for (const double degrees : {60, 90, 120}) {
    const double half = degrees * kPi / 360;
    // Symmetrical about z, its edge along y at the origin.
    const auto wedge = [=](Vec3 p) { return std::cos(half) * std::abs(p.x) + std::sin(half) * p.z; };
    expect_truth({fmt::format("{} degrees", degrees), wedge, Shot::perspective({0, -1, 5}, {0.2 * std::sin(half), 0, -0.2 * std::cos(half)}, 22, 120, 120),
                  0.6, 10, {}, kNothing, 4});
    const auto groove = [=](Vec3 p) { return -(std::cos(half) * std::abs(p.x) - std::sin(half) * p.z); };
    if (degrees > 60)
      expect_truth({fmt::format("a groove of {} degrees", degrees), groove, Shot::perspective({0, -1, 5}, {0.2 * std::sin(half), 0, 0.2 * std::cos(half)}, 22, 120, 120),
                    0.6, 10, kNothing, {}, 4});
  }
}

TEST(Curvature, of_cylinder_torus_and_saddles_is_what_rays_find) {
  const auto cylinder = [](Vec3 p) { return std::hypot(p.x, p.z) - 1; };
  expect_truth({"cylinder", cylinder, from_above(), 0.6, 10, {}, {}});
  expect_truth({"cylinder aslant", cylinder, aslant(), 0.6, 10, {}, {}});
  const auto torus = [](Vec3 p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.5; };
  expect_truth({"torus, outside", torus, Shot::perspective({4, 0, 2}, {1.3, 0, 0.35}, 25, 120, 120), 0.4, 10, {}, {}});
  expect_truth({"torus, inside", torus, Shot::perspective({-1.2, 0, 4}, {0.7, 0, 0.3}, 25, 120, 120), 0.4, 10, {}, {}});
  const auto saddle = [](double a, double b) { return [=](Vec3 p) { return p.z - 0.5 * (a * p.x * p.x + b * p.y * p.y); }; };
  expect_truth({"a bent ridge", saddle(-1, 0.4), from_above(), 0.6, 10, {}, {}});
  // Where the sum of the principal curvatures is 0, both sides block the same.
  const View even = view_of(saddle(-1, 1), from_above(), 10);
  const Planes planes = planes_of(even.frame, fine(0.6), kAll);
  EXPECT_NEAR(planes.curvature[60 * 120 + 60], 0.5, 0.003);
  // A quarter of the square of R / 2: half of the mean of cos^2 of the double angle.
  EXPECT_NEAR(planes.convexity[60 * 120 + 60], 0.25 * 0.09, 0.01);
  EXPECT_NEAR(planes.cavity[60 * 120 + 60], 0.25 * 0.09, 0.01);
}

}  // namespace
}  // namespace alcove::curvature_test
