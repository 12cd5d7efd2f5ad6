// The AO of scenes whose truth has a closed form: walls, corners and ceilings with every falloff, and bodies from
// spheres to pits.
// SPDX-License-Identifier: BSD-3-Clause
//
// The cosine-weighted hemisphere is the unit disk below it, seen from above (Nusselt's analogue), so each truth is an
// area of that disk over pi. A direction that meets an infinite wall at distance d within the radius r lies beyond the
// chord at d / r.

#include "core/reference/reference.h"
#include "tests/support/chain.h"

namespace alcove::closed_form_test {
namespace {

using namespace test;

constexpr double kUnlimited = 1e3;  // a radius larger than any scene here
// that a radius must span on the receiver: near a horizon no search can resolve it
constexpr double kLeastPixels = 16;

/// A scene, and the AO of a hit at a hard radius.
struct Picture {
  std::string name;
  Scene scene;
  Shot shot;
  double radius;
  std::function<double(const Hit&, double radius)> truth;
  int least_pixels;
  double reference_mean;  // error of the CPU reference at 64 slices, from the size of the pixels
};
using Pictures = std::vector<Picture>;

/// A search, and the bounds of its errors.
struct Search {
  EstimatorSettings settings;
  double mean, worst;
  int clear_px;
  bool has_reference;
};

Search fine(double radius) { return {sampled(Estimator::gtao, radius, 16, 64), 0.005, 0.02, 1, true}; }

/// The AO of a falloff from the AO of hard radii: the integral of -W'(r) A(r) dr, by the midpoint rule.
double superposed(const EstimatorSettings& settings, const std::function<double(double)>& hard) {
  if (settings.falloff == Falloff::none) return hard(*settings.radius);
  constexpr int kParts = 64;
  const double radius = *settings.radius, start = radius * settings.falloff_start;
  double sum = 0;
  for (int i = 0; i < kParts; i++) {
    const double x = (i + 0.5) / kParts;
    const double slope = settings.falloff == Falloff::linear      ? 1
                         : settings.falloff == Falloff::quadratic ? 2 * x
                                                                  : 6 * x * (1 - x);
    sum += slope * hard(start + x * (radius - start)) / kParts;
  }
  return sum;
}

/// The CPU reference at 25 of the pixels.
void compare_reference(const Picture& picture, const HostFrame& frame, const EstimatorSettings& settings,
                       const Errors& errors) {
  constexpr std::size_t kPixels = 25;
  ReferenceSettings reference;
  reference.radius = *settings.radius;
  reference.falloff = settings.falloff;
  reference.falloff_start = settings.falloff_start;
  reference.slices = 64;
  std::vector<double> expected;
  for (std::size_t i = 0; i < kPixels; i++) {
    const std::size_t at = i * errors.pixels.size() / kPixels;
    reference.pixels.push_back(errors.pixels[at]);
    expected.push_back(errors.truths[at]);
  }
  const auto ao = reference_ao(frame, reference);
  double sum = 0;
  for (std::size_t i = 0; i < kPixels; i++) sum += std::abs(ao[reference.pixels[i]] - expected[i]) / double(kPixels);
  EXPECT_LE(sum, picture.reference_mean) << "the CPU reference";
}

/// Compares the AO of every pixel that has a truth and isn't beside an edge. A sampled search leaves out other tiles.
void expect_truth(const Picture& picture, const Search& search) {
  SCOPED_TRACE(picture.name + ", " + name_of(search.settings));
  const Rendering rendering = render(picture.scene, picture.shot);
  const Truth truth = [&](const Hit& hit) {
    if (picture.radius < kUnlimited && !picture.shot.sees_ball(hit.position, picture.radius)) return kNone;
    const auto i = std::size_t(&hit - rendering.hits.data()), width = std::size_t(picture.shot.data.width);
    if (kLeastPixels * rendering.footprint(int(i % width), int(i / width)) > picture.radius) return kNone;
    return superposed(search.settings, [&](double r) { return picture.truth(hit, r); });
  };
  const Errors errors = errors_of(rendering, search.settings, truth, search.clear_px);
  ASSERT_GE(errors.pixels.size(), std::size_t(picture.least_pixels));
  EXPECT_LE(errors.worst, search.worst) << errors.where;
  EXPECT_LE(errors.mean, search.mean) << "bias " << errors.bias << " over " << errors.pixels.size() << " pixels";
  if (search.has_reference) compare_reference(picture, rendering.frame, search.settings, errors);
}

/// With each change one of every `parts` pictures.
void expect_truths(const Pictures& pictures, int parts = 1) {
  for (int i = 0; i < int(pictures.size()); i++)
    if (tried(i, parts)) expect_truth(pictures[std::size_t(i)], fine(pictures[std::size_t(i)].radius));
}

/// A scene as several cameras see it: all of them, or, of several scenes that begin at a `number` each, every second
/// combination with each change.
Pictures seen(const std::string& what, const Scene& scene, double radius,
              const std::function<double(const Hit&, double)>& truth, const std::vector<Shot>& shots,
              int least_pixels = 1000, std::optional<int> number = {}, double reference_mean = 0.002) {
  Pictures pictures;
  for (int i = 0; i < int(shots.size()); i++)
    if (!number || tried(*number + i, 2))
      pictures.push_back({fmt::format("{}, view {}", what, i), scene, shots[std::size_t(i)], radius, truth,
                          least_pixels, reference_mean});
  return pictures;
}

void append(Pictures& pictures, const Pictures& more) { pictures.insert(pictures.end(), more.begin(), more.end()); }

// Walls.

/// The crease of floor and wall along y: from the bisector, low over the floor, high, along the crease, wide, narrow,
/// through a shifted lens, with oblong pixels, and parallel.
Pictures walls() {
  Shot shifted = Shot::perspective({3, -1, 3}, {1.5, 1, 0.2}, 60, 240, 180),
       oblong = Shot::perspective({4, 1, 3.5}, {0.5, 0, 0.5}, 70, 240, 240);
  shifted.camera.cx += 50;
  shifted.camera.cy -= 30;
  oblong.camera.fy *= 2;
  return seen(
      "wall", {{kFloor, kWallX}}, 1,
      [](const Hit& hit, double r) { return beside_wall((hit.primitive == 0 ? hit.position.x : hit.position.z) / r); },
      {Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 60, 240, 180),
       Shot::perspective({5, 0, 1.5}, {0, 0, 0.6}, 50, 240, 180),
       Shot::perspective({1.5, 0, 5}, {0.8, 0, 0}, 50, 240, 180),
       Shot::perspective({2, -4, 2.5}, {0.4, 0, 0.3}, 70, 240, 180),
       Shot::perspective({2.2, -0.6, 1.8}, {0.6, 0.2, 0.2}, 100, 320, 240),
       Shot::perspective({30, -10, 25}, {0.5, 0, 0.5}, 8, 240, 180), shifted, oblong,
       Shot::orthographic({4, -1, 3}, {0.5, 0, 0.5}, 5, 240, 180)});
}

/// The AO beside a wall of that height; for large r it is (1 + d / hypot(d, height)) / 2.
double beside_low_wall(double d, double height, double r) {
  const double c = d / r, a = d / std::hypot(d, height);
  return 1 - (segment(c) - a * segment(std::min(1.0, c / a))) / kPi;
}

Pictures low_walls() {
  Pictures pictures;
  for (const auto& [number, height] : {std::pair{1, 0.5}, {2, 0.9}})
    append(pictures, seen(
                         fmt::format("wall {} high", height),
                         {{kFloor, parallelogram({0, -100, 0}, {0, 200, 0}, {0, 0, height})}}, 1.2,
                         [height = height](const Hit& hit, double r) {
                           if (hit.position.x < 0) return kNone;
                           return hit.primitive == 0 ? beside_low_wall(hit.position.x, height, r)
                                                     : beside_wall(hit.position.z / r);
                         },
                         {Shot::perspective({3.5, 0, 3}, {0.7, 0, 0.3}, 52, 320, 240),
                          Shot::orthographic({4, -1, 2.5}, {0.6, 0, 0.3}, 4.2, 320, 240),
                          Shot::perspective({5, 0, 1.5}, {0.5, 0, 0.4}, 40, 320, 240),
                          Shot::perspective({2.5, -2.5, 2}, {0.5, 0, 0.2}, 60, 320, 240)},
                         1000, number));
  return pictures;
}

Pictures trenches() {
  constexpr double kLow = 0.7, kHigh = 1.1, kWidth = 2;
  return seen(
      "trench",
      {{kFloor, parallelogram({0, -100, 0}, {0, 200, 0}, {0, 0, kLow}),
        parallelogram({kWidth, -100, 0}, {0, 200, 0}, {0, 0, kHigh})}},
      1.2,
      [](const Hit& hit, double r) {
        const double x = hit.position.x;
        if (hit.primitive != 0 || x < 0 || x > kWidth) return kNone;
        return beside_low_wall(x, kLow, r) + beside_low_wall(kWidth - x, kHigh, r) - 1;
      },
      {Shot::perspective({1, 0, 1.9}, {1, 0, 0}, 100, 320, 240),
       Shot::perspective({1, -1.6, 1.6}, {1, 0.2, 0.2}, 100, 320, 240),
       Shot::perspective({0.7, -0.8, 1.8}, {1.1, 0, 0}, 100, 320, 240)},
      500);
}

Pictures corners() {
  return seen("corner", {{kFloor, kWallX, kWallY}}, 1,
              [](const Hit& hit, double r) {
                const Vec3 at = (1 / r) * hit.position;
                return hit.primitive == 0   ? beside_corner(at.x, at.y)
                       : hit.primitive == 1 ? beside_corner(at.y, at.z)
                                            : beside_corner(at.x, at.z);
              },
              {Shot::perspective({4, 4, 4}, {0.5, 0.5, 0.5}, 50, 240, 200),
               Shot::perspective({5, 3, 1.5}, {0, 0, 0.6}, 50, 240, 200),
               Shot::perspective({2, 2.4, 4}, {0.5, 0.5, 0.2}, 50, 240, 200),
               Shot::perspective({2, 2.4, 1.8}, {0.6, 0.2, 0.4}, 100, 320, 240),
               Shot::orthographic({3, 4, 3}, {0.4, 0.4, 0.5}, 5, 240, 200)});
}

/// At other radii from 1.1 to 1.5 the mean error is up to 0.007 and the largest up to 0.022: few of 64 steps fall on so
/// small a patch. Seen so much aslant, neighbouring pixels are too far apart for the reference to be one surface.
Pictures ceilings() {
  return seen(
      "ceiling", {{kFloor, Plane{.point = {0, 0, 1}, .normal = {0, 0, 1}}}}, 1.3,
      [](const Hit&, double r) { return r <= 1 ? 1 : 1 / (r * r); },
      {Shot::perspective({0, 0, 0.5}, {3, 0, 0.5}, 90, 480, 450),
       Shot::perspective({0, 0, 0.65}, {3, 0.2, 0.4}, 90, 480, 450)},
      300, {}, 0.005);
}

// Bodies.

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

Pictures insides_of_a_sphere() {
  Pictures pictures;
  for (const auto& [number, radius] : {std::pair{0, 0.5}, {3, 1.0}})
    append(pictures, seen(
                         "in a sphere", {{Sphere{.center = {}, .radius = 2}}}, radius,
                         [](const Hit&, double r) { return 1 - std::pow(r / 4, 2); },
                         {Shot::perspective({0, 0, 0}, {1, 0, 0}, 100, 160, 120),
                          Shot::perspective({0.5, 1, 0.7}, {-0.5, -2, -0.4}, 80, 200, 150),
                          Shot::perspective({-1.5, 0.5, 0}, {2, 0, 0.2}, 60, 120, 90)},
                         250, number));
  return pictures;
}

/// A bowl that opens by twice that angle in a ground.
Pictures bowls_of(double half_angle, std::optional<int> number = {}) {
  const double cosine = std::cos(half_angle * kRadian), rim = std::sin(half_angle * kRadian);
  const Plane ground{.point = {0, 0, -cosine}, .normal = {0, 0, 1}, .hole = rim};
  std::vector<Shot> shots{Shot::perspective({0, 0, 1.5 - cosine}, {0, 0, -1}, 80, 240, 240),
                          Shot::perspective({0.1, -0.2, 1.5 - cosine}, {0, 0, -0.7}, 90, 240, 240),
                          Shot::orthographic({0, 0, 3}, {0, 0, -1}, 2.2 * rim, 240, 240)};
  if (half_angle == 90) shots.pop_back();  // its sides would be seen edge on
  for (const Shot& shot : shots)
    for (const Vec3 side : {Vec3{rim, 0, 0}, {-rim, 0, 0}, {0, rim, 0}, {0, -rim, 0}})
      EXPECT_TRUE(shot.sees_ball(ground.point + side, 0)) << half_angle;
  return seen(
      fmt::format("bowl, {}", half_angle),
      {{Sphere{.center = {}, .radius = 1, .axis = {0, 0, -1}, .cos_half_angle = cosine}, ground}}, kUnlimited,
      [cosine](const Hit& hit, double) { return hit.primitive == 0 ? (1 + cosine) / 2 : kNone; }, shots, 1000, number);
}

Pictures bowls() {
  Pictures pictures;
  for (const auto& [number, half_angle] : {std::pair{0, 40.0}, {3, 60.0}, {6, 90.0}})
    append(pictures, bowls_of(half_angle, number));
  return pictures;
}

/// Two sides of length 1 that open by beta along y, shut by triangles at the ends: the eye sees all of it, so one depth
/// layer suffices.
Pictures grooves() {
  constexpr double kHalfLength = 1.2;
  Pictures pictures;
  for (const auto& [number, beta] : {std::pair{1, 60.0}, {4, 90.0}, {7, 130.0}}) {
    const double half = beta / 2 * kRadian;
    const Vec3 left{-std::sin(half), 0, std::cos(half)}, right{std::sin(half), 0, std::cos(half)},
        end{0, kHalfLength, 0};
    Scene scene{{parallelogram(-end, 2 * end, left), parallelogram(-end, 2 * end, right),
                 Polygon{{end, end + left, end + right}}, Polygon{{-end, right - end, left - end}}}};
    const auto opening = [left, right](double half_length) {
      const Vec3 end{0, half_length, 0};
      return Polygon{{left - end, right - end, right + end, left + end}};
    };
    add_ground_around(scene, opening(kHalfLength));
    const auto truth = [=](const Hit& hit, double) {
      // Beside the tips of the end triangles an occluder is narrower than a pixel.
      if (hit.primitive > 1 || std::abs(hit.position.y) > 0.9 * kHalfLength) return kNone;
      // The sides of an endless groove block up to the angle psi, at which the other side's rim is seen: there
      // Lambert's sum is (1 - cos psi) / 2, so what is used for the finite groove is right.
      const Vec3 there{hit.position.x, 0, hit.position.z};
      const double s = length(there), cos_beta = 2 * std::cos(half) * std::cos(half) - 1;
      const double cos_psi = (cos_beta - s) / std::sqrt(1 + s * s - 2 * s * cos_beta);
      EXPECT_NEAR(form_factor(there, hit.normal, opening(1e4)), (1 - cos_psi) / 2, 1e-6) << s;
      return form_factor(hit.position, hit.normal, opening(kHalfLength));
    };
    append(pictures, seen(fmt::format("groove, {}", beta), scene, kUnlimited, truth,
                          {Shot::perspective({0, 0, 2.4}, {0, 0, 0}, 85, 130, 140),
                           Shot::perspective({0.2, -0.6, 2.4}, {0, 0, 0.4}, 95, 150, 150)},
                          250, number));
    for (const Picture& picture : pictures) expect_in_view(picture.shot, opening(kHalfLength));
  }
  return pictures;
}

/// Four walls seen from over the opening: a trench with ends, and a corner of three planes at each end.
Pictures pits() {
  const double x = 1, y = 1.5, depth = 1;
  const Polygon floor = parallelogram({-x, -y, 0}, {2 * x, 0, 0}, {0, 2 * y, 0});
  const Polygon opening = parallelogram({-x, -y, depth}, {2 * x, 0, 0}, {0, 2 * y, 0});
  Scene scene{{floor}};
  for (std::size_t i = 0; i < 4; i++)
    scene.primitives.emplace_back(
        Polygon{{floor.corners[i], floor.corners[(i + 1) % 4], opening.corners[(i + 1) % 4], opening.corners[i]}});
  add_ground_around(scene, opening);
  const auto truth = [opening](const Hit& hit, double) {
    return hit.primitive > 4 ? kNone : form_factor(hit.position, hit.normal, opening);
  };
  const Pictures pictures = seen("pit", scene, kUnlimited, truth,
                                 {Shot::perspective({0, 0, 3}, {0, 0, 0}, 62, 200, 280),
                                  Shot::perspective({0.3, -0.4, 2.8}, {0.1, -0.1, 0}, 96, 280, 320),
                                  Shot::perspective({0.7, 1.1, 2.4}, {0.2, 0.3, 0}, 100, 260, 300)},
                                 5000);
  for (const Picture& picture : pictures) expect_in_view(picture.shot, opening);
  return pictures;
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

/// From steeper than the dome's own slope, nothing of it is hidden. Its picture is whole, so the radius needn't be
/// limited.
Pictures domes() {
  const Polygon floor = parallelogram({-3, -3, 0}, {6, 0, 0}, {0, 6, 0});
  Pictures pictures;
  for (const auto& [number, slope] : {std::pair{0, 35.0}, {3, 60.0}}) {
    const double r = 1.5, h = -r * std::cos(slope * kRadian);
    append(pictures,
           seen(
               fmt::format("dome, {}", slope),
               {{floor, Sphere{.center = {0, 0, h}, .radius = r, .axis = {0, 0, 1}, .cos_half_angle = -h / r}}},
               kUnlimited,
               [=](const Hit& hit, double) {
                 return hit.primitive == 1
                            ? 1 - form_factor(hit.position, hit.normal, above(floor, hit.position, hit.normal))
                            : 1 - sphere_occlusion(r, h, std::hypot(hit.position.x, hit.position.y));
               },
               {Shot::perspective({0, 0, 11}, {0, 0, 0}, 42, 120, 100),
                Shot::perspective({1.5, -2, 14}, {0, 0, 0}, 36, 120, 100),
                Shot::orthographic({0, 0, 9}, {0, 0, 0}, 7, 120, 100)},
               1250, number));
  }
  return pictures;
}

/// The depth buffer knows nothing of the gap below the sphere: the truth of its one layer is the sphere with the
/// cylinder below it, an integral over azimuth of sin^2 of the horizon's elevation; the true AO is an upper bound.
Pictures resting_sphere() {
  const double r = 1;
  const auto one_layer = [=](double offset) {
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
  return seen(
      "resting sphere", {{parallelogram({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), Sphere{.center = {0, 0, r}, .radius = r}}},
      kUnlimited,
      [=](const Hit& hit, double) {
        const double offset = std::hypot(hit.position.x, hit.position.y);
        // Nearer to the contact the sphere's outline is so high that one half-slice of 32 is worth more than the
        // bound.
        if (hit.primitive == 1 || offset < 1.5 * r) return kNone;
        EXPECT_LE(one_layer(offset), 1 - sphere_occlusion(r, r, offset) + 1e-4) << offset;
        return one_layer(offset);
      },
      {Shot::orthographic({0, 0, 9}, {0, 0, 0}, 7, 160, 140)}, 1250);
}

TEST(ClosedForm, of_walls) { expect_truths(walls(), 3); }
TEST(ClosedForm, of_low_walls) { expect_truths(low_walls(), 2); }
TEST(ClosedForm, of_trenches) { expect_truths(trenches(), 3); }
TEST(ClosedForm, of_corners) { expect_truths(corners(), 2); }
TEST(ClosedForm, of_ceilings) { expect_truths(ceilings(), 2); }
TEST(ClosedForm, of_insides_of_a_sphere) { expect_truths(insides_of_a_sphere()); }
TEST(ClosedForm, of_bowls) { expect_truths(bowls()); }
TEST(ClosedForm, of_grooves) { expect_truths(grooves()); }
TEST(ClosedForm, of_pits) { expect_truths(pits(), 3); }
TEST(ClosedForm, of_domes) { expect_truths(domes()); }
TEST(ClosedForm, of_a_resting_sphere) { expect_truths(resting_sphere()); }

TEST(ClosedForm, with_every_falloff) {
  const Pictures wall = walls(), corner = corners();
  int number = -1;
  for (const Falloff falloff : {Falloff::linear, Falloff::quadratic, Falloff::smooth})
    for (const double start : {0.0, 0.4})
      for (const Picture* picture : {&wall[1], &wall[4], &wall[8], &corner[0]}) {
        number++;
        if (!tried(number + number / 4 + number / 8, 4)) continue;  // the numbers of picture, start and falloff
        Search search = fine(1);
        search.settings.falloff = falloff;
        search.settings.falloff_start = start;
        expect_truth(*picture, search);
      }
  Search search = fine(1.3);
  search.settings.falloff = Falloff::quadratic;
  search.settings.falloff_start = 0.4;
  expect_truth(ceilings()[0], search);
}

/// Half of the pictures with each change: wall, corner and bowl, among them a wide and a parallel view.
TEST(ClosedForm, of_an_exact_search) {
  const Pictures wall = walls(), corner = corners();
  int number = 0;
  for (const Picture& picture : {wall[8], wall[3], wall[4], wall[0], corner[0], corner[3], bowls_of(60)[1]})
    if (tried(number++, 2)) expect_truth(picture, {exact(picture.radius), 0.004, 0.02, 2, false});
  expect_truth(bowls_of(60)[1], {shared_directions(kUnlimited), 0.004, 0.02, 2, false});
}

// What is wide blocks as an endless thing does, and all below a rim is blocked.
TEST(ClosedForm, of_occluders_as_deep_as_wide) {
  for (const Picture& picture : {walls()[0], bowls_of(60)[1]}) {
    Search search{sampled(Estimator::gtao, picture.radius, 8, 64), 0.005, 1, 2, false};
    search.settings.thickness = ThicknessKind::automatic;
    expect_truth(picture, search);
  }
}

/// The mean AO of the floor under blades that hang over it, in every third row of tiles.
double floor_under_blades(ThicknessKind thickness, double length = 0) {
  Scene scene{{kFloor}};
  for (int i = -6; i <= 6; i++)
    scene.primitives.emplace_back(parallelogram({0.25 * i, -2, 0.2}, {0.03, 0, 0}, {0, 4, 0}));
  const Rendering rendering = render(scene, Shot::perspective({0.3, -2, 2.4}, {0, 0, 0}, 50, 240, 180));
  EstimatorSettings settings = sampled(Estimator::gtao, 0.6, 8, 64);
  settings.thickness = thickness;
  settings.thickness_length = length;
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < rendering.hits.size(); i++)
    if (i / std::size_t(240 * kTile) % 3 == 0 && rendering.hits[i].primitive == 0 &&
        std::abs(rendering.hits[i].position.x) < 1)
      pixels.push_back(i);
  const std::vector<float> ao = ao_at(rendering.frame, settings, pixels);
  double sum = 0;
  for (const std::size_t i : pixels) sum += ao[i];
  return sum / double(pixels.size());
}

TEST(Thickness, thin_blades_block_as_thin_ones) {
  const double measured = floor_under_blades(ThicknessKind::automatic),
               thin = floor_under_blades(ThicknessKind::constant, 1.25 * 0.03),
               endless = floor_under_blades(ThicknessKind::infinite);
  EXPECT_NEAR(measured, thin, 0.05);
  EXPECT_GE(measured, endless + 0.1);
}

}  // namespace
}  // namespace alcove::closed_form_test
