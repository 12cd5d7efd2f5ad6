// Analytic scenes, ray-cast in double precision, for tests that know what the AO must be.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/compute.h"
#include "tests/support/test.h"

namespace alcove::test {

struct Vec3 {
  double x = 0, y = 0, z = 0;
};
inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Vec3 a) { return std::sqrt(dot(a, a)); }
inline Vec3 unit(Vec3 a) { return (1 / length(a)) * a; }

constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr float kSky = 1e10f;  // what a rendering holds where nothing is hit

struct Ray {
  Vec3 origin, direction;
};

struct Plane {
  Vec3 point, normal;
  double hole = 0;  // radius of a round hole about the point
};

/// A flat convex polygon, corners in either turn.
struct Polygon {
  std::vector<Vec3> corners;
};
/// The parallelogram of that corner and those two sides.
Polygon parallelogram(Vec3 corner, Vec3 a, Vec3 b);
/// The six sides of the parallelepiped of that corner and those three edges.
std::vector<Polygon> parallelepiped(Vec3 corner, Vec3 a, Vec3 b, Vec3 c);

/// The part of a sphere within a polar half-angle of an axis, seen from either side; without more, all of it.
struct Sphere {
  Vec3 center;
  double radius = 1;
  Vec3 axis{0, 0, 1};
  double cos_half_angle = -1;
};

struct Hit {
  double distance = kNowhere;  // in units of the ray's direction
  int primitive = -1;          // index in the scene; -1: sky
  Vec3 position, normal;       // the unit normal faces the ray's origin
};

struct Scene {
  std::vector<std::variant<Plane, Polygon, Sphere>> primitives;
  void add(const std::vector<Polygon>& sides) { primitives.insert(primitives.end(), sides.begin(), sides.end()); }
  /// The nearest surface before the origin.
  Hit hit(const Ray& ray) const;
};

/// A camera in the world and the part of its picture that is made.
struct Shot {
  Vec3 eye, right, up, back;  // the axes of view space; the camera looks along -back
  Camera camera;
  Window data, display;

  /// Looks at the target; `fov` is horizontal, degrees.
  static Shot perspective(Vec3 eye, Vec3 target, double fov, int width, int height);
  /// The same from a parallel projection that is `units` of the scene wide.
  static Shot orthographic(Vec3 eye, Vec3 target, double units, int width, int height);

  Vec3 view_from_world(Vec3 direction) const {
    return {dot(direction, right), dot(direction, up), dot(direction, back)};
  }
  /// The ray through a point of the display window; its parameter is planar depth.
  Ray ray(double x_px, double y_px) const;
  /// Whether all that is within `radius` of a point is seen in the picture, between the centres of its outermost
  /// pixels.
  bool sees_ball(Vec3 center, double radius) const;
};

/// A frame, and what each of its pixels shows in the world.
struct Rendering {
  Shot shot;
  HostFrame frame;
  std::vector<Hit> hits;

  const Hit& at(int x, int y) const { return hits[std::size_t(y) * std::size_t(shot.data.width) + std::size_t(x)]; }
  /// How many primitives (the sky is one) show within so many pixels, diagonals included: 2 at an edge, 3 at a vertex,
  /// which are the most that it counts.
  int primitives_within(int reach_px, int x, int y) const;
  /// The largest distance in the world to what the four neighbours show, as far as there are.
  double footprint(int x, int y) const;
};
Rendering render(const Scene& scene, const Shot& shot);

}  // namespace alcove::test
