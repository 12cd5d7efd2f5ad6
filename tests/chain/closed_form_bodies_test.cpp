// The AO in and around bodies whose truth has a closed form, from spheres to pits.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/chain/closed_form.h"

namespace alcove {
namespace {

using namespace test;

/// The fraction of the cosine-weighted hemisphere that a polygon above the tangent plane fills, by Lambert's sum over
/// its sides.
double form_factor(Vec3 point, Vec3 normal, const Polygon& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.corners.size(); i++) {
    const Vec3 a = polygon.corners[i] - point, b = polygon.corners[(i + 1) % polygon.corners.size()] - point,
               turn = cross(a, b);
    if (length(turn) > 0) sum += std::atan2(length(turn), dot(a, b)) * dot(normal, unit(turn));
  }
  return std::abs(sum) / (2 * kPi);
}

/// What of a polygon lies above the plane through a point.
Polygon above(const Polygon& polygon, Vec3 point, Vec3 normal) {
  Polygon part;
  for (std::size_t i = 0; i < polygon.corners.size(); i++) {
    const Vec3 a = polygon.corners[i], b = polygon.corners[(i + 1) % polygon.corners.size()];
    const double height_a = dot(a - point, normal), height_b = dot(b - point, normal);
    if (height_a >= 0) part.corners.push_back(a);
    if ((height_a < 0) != (height_b < 0)) part.corners.push_back(a + (height_a / (height_a - height_b)) * (b - a));
  }
  return part;
}

/// The ground around a rectangular hole, parallel to its sides. It hides nothing from what is in the hole, and shows
/// where the rim is.
void add_ground_around(Scene& scene, const Polygon& hole) {
  const auto& c = hole.corners;
  const Vec3 middle = 0.5 * (c[0] + c[2]);
  for (std::size_t i = 0; i < 4; i++) {
    const Vec3 a = c[i], b = c[(i + 1) % 4];
    scene.primitives.emplace_back(Polygon{{a, b, b + 9 * (b - middle), a + 9 * (a - middle)}});
  }
}

void expect_in_view(const Shot& shot, const Polygon& polygon) {
  for (const Vec3 corner : polygon.corners)
    EXPECT_TRUE(shot.sees_ball(corner, 0)) << corner.x << " " << corner.y << " " << corner.z;
}

TEST_F(ClosedForm, inside_of_a_sphere_at_hard_radius) {
  const Sphere ball{.center = {0, 0, 0}, .radius = 2};
  int number = 0;
  for (const double radius : {0.5, 1.0}) {
    const std::vector<NamedShot> views{{"from the centre", Shot::perspective({0, 0, 0}, {1, 0, 0}, 100, 320, 240)},
                                       {"from aside", Shot::perspective({0.5, 1, 0.7}, {-0.5, -2, -0.4}, 80, 240, 180)},
                                       {"from behind", Shot::perspective({-1.5, 0.5, 0}, {2, 0, 0.2}, 60, 240, 180)}};
    for (const auto& [name, shot] : views) {
      if (!test::tried(number++, 2)) continue;
      compare(
          name, {{ball}}, shot, fine(radius),
          [&, &shot = shot](const test::Hit& hit) -> std::optional<double> {
            if (!shot.sees_ball(hit.position, radius)) return std::nullopt;
            return 1 - std::pow(radius / (2 * ball.radius), 2);
          },
          1000);
    }
  }
}

TEST_F(ClosedForm, spherical_bowl) {
  int number = 0;
  for (const double half_angle : {40.0, 60.0, 90.0}) {
    const double cosine = std::cos(half_angle * kPi / 180), rim = std::sin(half_angle * kPi / 180);
    const Sphere bowl{.center = {0, 0, 0}, .radius = 1, .axis = {0, 0, -1}, .cos_half_angle = cosine};
    const Plane ground{.point = {0, 0, -cosine}, .normal = {0, 0, 1}, .hole = rim};
    const std::vector<NamedShot> views{
        {"axis", Shot::perspective({0, 0, 1.5 - cosine}, {0, 0, -1}, 80, 240, 240)},
        {"off axis", Shot::perspective({0.1, -0.2, 1.5 - cosine}, {0, 0, -0.7}, 90, 240, 240)},
        {"orthographic", Shot::orthographic({0, 0, 3}, {0, 0, -1}, 2.2 * rim, 240, 240)}};
    for (const auto& [name, shot] : views) {
      if (shot.camera.orthographic && half_angle == 90) continue;  // its sides would be seen edge on
      if (!test::tried(number++, 2)) continue;
      const std::string picture = std::to_string(half_angle) + " " + name;
      for (const Vec3 side : {Vec3{rim, 0, 0}, {-rim, 0, 0}, {0, rim, 0}, {0, -rim, 0}})
        EXPECT_TRUE(shot.sees_ball(ground.point + side, 0)) << picture;
      compare(
          picture.c_str(), {{bowl, ground}}, shot, fine(kUnlimited),
          [&](const test::Hit& hit) -> std::optional<double> {
            if (hit.primitive != 0) return std::nullopt;
            return (1 + cosine) / 2;
          },
          1000);
    }
  }
}

TEST_F(ClosedForm, groove) {
  // Two sides of length 1 that open by beta along y, shut by triangles at the ends: the eye sees all of it, so one
  // depth layer suffices.
  const double half_length = 1.2;
  int number = 0;
  for (const double beta : {60.0, 90.0, 130.0}) {
    number++;
    const double half = beta * kPi / 360;
    const Vec3 left{-std::sin(half), 0, std::cos(half)}, right{std::sin(half), 0, std::cos(half)},
        end{0, half_length, 0};
    const Polygon side_a = test::parallelogram(-end, 2 * end, left), side_b = test::parallelogram(-end, 2 * end, right);
    Scene scene{{side_a, side_b, Polygon{{end, end + left, end + right}}, Polygon{{-end, right - end, left - end}}}};
    const auto opening = [&](double half_length) {
      const Vec3 end{0, half_length, 0};
      return Polygon{{left - end, right - end, right + end, left + end}};
    };
    add_ground_around(scene, opening(half_length));
    const std::vector<NamedShot> views{{"above", Shot::perspective({0, 0, 2.4}, {0, 0, 0}, 85, 260, 280)},
                                       {"aside", Shot::perspective({0.2, -0.6, 2.4}, {0, 0, 0.4}, 95, 300, 300)}};
    for (const auto& [name, shot] : views) {
      if (!test::tried(number++, 2)) continue;
      const std::string picture = std::to_string(beta) + " " + name;
      expect_in_view(shot, opening(half_length));
      compare(
          picture.c_str(), scene, shot, fine(kUnlimited),
          [&](const test::Hit& hit) -> std::optional<double> {
            // Beside the tips of the end triangles an occluder is narrower than a pixel.
            if (hit.primitive > 1 || std::abs(hit.position.y) > 0.9 * half_length) return std::nullopt;
            // The sides of an endless groove block up to the angle psi, at which the other side's rim is seen: there
            // Lambert's sum is (1 - cos psi) / 2, so what is used for the finite groove is right.
            const Vec3 there{hit.position.x, 0, hit.position.z};
            const double s = length(there), cos_beta = 2 * std::cos(half) * std::cos(half) - 1;
            const double cos_psi = (cos_beta - s) / std::sqrt(1 + s * s - 2 * s * cos_beta);
            EXPECT_NEAR(form_factor(there, hit.normal, opening(1e4)), (1 - cos_psi) / 2, 1e-6) << s;
            return form_factor(hit.position, hit.normal, opening(half_length));
          },
          1000);
    }
  }
}

TEST_F(ClosedForm, pit) {
  // Four walls seen from over the opening: a trench with ends, and a corner of three planes at each end.
  const double x = 1, y = 1.5, depth = 1;
  const Polygon floor = test::parallelogram({-x, -y, 0}, {2 * x, 0, 0}, {0, 2 * y, 0});
  const Polygon opening = test::parallelogram({-x, -y, depth}, {2 * x, 0, 0}, {0, 2 * y, 0});
  Scene scene{{floor}};
  for (std::size_t i = 0; i < 4; i++)
    scene.primitives.emplace_back(
        Polygon{{floor.corners[i], floor.corners[(i + 1) % 4], opening.corners[(i + 1) % 4], opening.corners[i]}});
  add_ground_around(scene, opening);
  const std::vector<NamedShot> views{{"above", Shot::perspective({0, 0, 3}, {0, 0, 0}, 62, 200, 280)},
                                     {"aside", Shot::perspective({0.3, -0.4, 2.8}, {0.1, -0.1, 0}, 96, 280, 320)},
                                     {"corner", Shot::perspective({0.7, 1.1, 2.4}, {0.2, 0.3, 0}, 100, 260, 300)}};
  for (const auto& [name, shot] : views) {
    expect_in_view(shot, opening);
    compare(
        name, scene, shot, fine(kUnlimited),
        [&](const test::Hit& hit) -> std::optional<double> {
          if (hit.primitive > 4) return std::nullopt;
          return form_factor(hit.position, hit.normal, opening);
        },
        5000);
  }
}

/// Three squares of that side that meet at the origin.
std::vector<Polygon> three_planes(double side) {
  const Vec3 x{side, 0, 0}, y{0, side, 0}, z{0, 0, side};
  return {test::parallelogram({}, x, y), test::parallelogram({}, y, z), test::parallelogram({}, z, x)};
}

TEST_F(ClosedForm, three_plane_corner) {
  const auto truth = [](const std::vector<Polygon>& planes, Vec3 point, Vec3 normal, int primitive) {
    return 1 - form_factor(point, normal, planes[std::size_t(primitive + 1) % 3]) -
           form_factor(point, normal, planes[std::size_t(primitive + 2) % 3]);
  };
  const auto planes = three_planes(4);
  const Shot shot = Shot::perspective({5, 5, 5}, {0.8, 0.8, 0.8}, 90, 400, 400);
  for (const Polygon& plane : planes) expect_in_view(shot, plane);
  compare(
      "diagonal", {{planes[0], planes[1], planes[2]}}, shot, fine(kUnlimited),
      [&](const test::Hit& hit) -> std::optional<double> {
        if (std::max({hit.position.x, hit.position.y, hit.position.z}) > 1) return std::nullopt;
        EXPECT_NEAR(truth(three_planes(1e6), hit.position, hit.normal, hit.primitive), 0.25, 1e-5);
        return truth(planes, hit.position, hit.normal, hit.primitive);
      },
      500);
}

/// The occlusion by a sphere of radius r whose centre lies at height h and this offset aside, at a distance D > r. A
/// sphere wholly above the tangent plane fills a cone of half-angle asin(r / D) about a direction of the cosine h / D,
/// which takes (r / D)^2 h / D of the cosine-weighted hemisphere. Else this is the configuration factor from a plane
/// element to a sphere that the element's plane cuts.
double sphere_occlusion(double r, double h, double offset) {
  const double d_squared = offset * offset + h * h, n = h / std::sqrt(d_squared);
  if (h >= r) return r * r * h / (d_squared * std::sqrt(d_squared));
  const double q = d_squared / (r * r), k = 1 - q * n * n;
  return ((n * std::acos(-n * std::sqrt((q - 1) / (1 - n * n))) - std::sqrt(k * (q - 1))) / q +
          std::atan(std::sqrt(k / (q - 1)))) /
         kPi;
}

TEST_F(ClosedForm, dome_on_a_floor) {
  // From steeper than the dome's own slope, nothing of it is hidden. Its picture is whole, so the radius needn't be
  // limited.
  const Polygon floor = test::parallelogram({-3, -3, 0}, {6, 0, 0}, {0, 6, 0});
  int number = 0;
  for (const double slope : {35.0, 60.0}) {
    const double r = 1.5, h = -r * std::cos(slope * kPi / 180);
    const Scene scene{{floor, Sphere{.center = {0, 0, h}, .radius = r, .axis = {0, 0, 1}, .cos_half_angle = -h / r}}};
    const std::vector<NamedShot> views{{"above", Shot::perspective({0, 0, 11}, {0, 0, 0}, 42, 240, 200)},
                                       {"aside", Shot::perspective({1.5, -2, 14}, {0, 0, 0}, 36, 240, 200)},
                                       {"orthographic", Shot::orthographic({0, 0, 9}, {0, 0, 0}, 7, 240, 200)}};
    for (const auto& [name, shot] : views) {
      if (!test::tried(number++, 2)) continue;
      const std::string picture = std::to_string(slope) + " " + name;
      compare(
          picture.c_str(), scene, shot, fine(kUnlimited),
          [&](const test::Hit& hit) {
            return std::optional(hit.primitive == 1
                                     ? 1 - form_factor(hit.position, hit.normal, above(floor, hit.position, hit.normal))
                                     : 1 - sphere_occlusion(r, h, std::hypot(hit.position.x, hit.position.y)));
          },
          5000);
    }
  }
}

TEST_F(ClosedForm, resting_sphere_seen_from_above) {
  // The depth buffer knows nothing of the gap below the sphere: the truth of its one layer is the sphere with the
  // cylinder below it, an integral over azimuth of sin^2 of the horizon's elevation; the true AO is an upper bound.
  const double r = 1;
  const Scene scene{{test::parallelogram({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), Sphere{.center = {0, 0, r}, .radius = r}}};
  const auto one_layer = [&](double offset) {
    constexpr int kParts = 200;
    double sum = 0;
    for (int i = 0; i < kParts; i++) {
      // In this slice the sphere's section has its centre at `along`, height r, and a radius of `section`.
      const double azimuth = std::asin(r / offset) * (2 * (i + 0.5) / kParts - 1), along = offset * std::cos(azimuth);
      const double section = std::sqrt(r * r - std::pow(offset * std::sin(azimuth), 2));
      const double elevation = std::atan2(r, along) + std::asin(std::min(1.0, section / std::hypot(r, along)));
      sum += std::pow(std::sin(elevation), 2);
    }
    return 1 - sum / kParts * std::asin(r / offset) / kPi;
  };
  const Shot shot = Shot::orthographic({0, 0, 9}, {0, 0, 0}, 7, 320, 280);
  compare(
      "orthographic", scene, shot, fine(kUnlimited),
      [&](const test::Hit& hit) -> std::optional<double> {
        const double offset = std::hypot(hit.position.x, hit.position.y);
        // Nearer to the contact the sphere's outline is so high that one half-slice of 32 is worth more than the bound.
        if (hit.primitive == 1 || offset < 1.5 * r) return std::nullopt;
        EXPECT_LE(one_layer(offset), 1 - sphere_occlusion(r, r, offset) + 1e-4) << offset;
        return one_layer(offset);
      },
      5000);
}

}  // namespace
}  // namespace alcove
