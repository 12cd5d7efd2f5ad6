// Analytic scenes, ray-cast in double precision, for tests that know what the AO must be.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/compute.h"
#include "core/frame/reading.h"
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

// How far two results of the chain lie apart, and where they do so most.

/// How far two results, or a result and a constant, lie apart.
struct Difference {
  double max = 0, mean = 0, rmse = 0, bias = 0;
  std::size_t worst = 0;
};

inline Difference difference(const std::vector<float>& a, const std::function<double(std::size_t)>& b) {
  Difference result;
  for (std::size_t i = 0; i < a.size(); i++) {
    const double error = a[i] - b(i);
    if (!(std::abs(error) <= result.max)) result.max = std::abs(error), result.worst = i;
    result.mean += std::abs(error) / double(a.size());
    result.bias += error / double(a.size());
    result.rmse += error * error / double(a.size());
  }
  result.rmse = std::sqrt(result.rmse);
  return result;
}

inline Difference difference(const std::vector<float>& a, const std::vector<float>& b) {
  return difference(a, [&](std::size_t i) { return double(b[i]); });
}

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>, std::bit_cast<std::uint32_t, float>);
}

inline std::string place(const Difference& d, const HostFrame& frame) {
  const auto width = std::size_t(frame.data.width);
  return "worst at pixel " + std::to_string(d.worst % width) + " " + std::to_string(d.worst / width) + ", depth " +
         std::to_string(frame.depth[d.worst]);
}

/// A normal as two numbers, by the octahedral map.
inline Vec3 octahedral(Vec3 n) {
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z), x = n.x / sum, y = n.y / sum;
  return n.z >= 0 ? Vec3{x, y, 0} : Vec3{std::copysign(1 - std::abs(y), x), std::copysign(1 - std::abs(x), y), 0};
}

/// The normal of a pixel of a frame that has them as planes x, y, z.
inline Vec3 normal_at(const HostFrame& frame, std::size_t i) {
  const std::size_t pixels = frame.normal.size() / 3;
  return {frame.normal[i], frame.normal[i + pixels], frame.normal[i + 2 * pixels]};
}
inline void put_normal(HostFrame& frame, std::size_t i, Vec3 normal) {
  const std::size_t pixels = frame.normal.size() / 3;
  frame.normal[i] = float(normal.x);
  frame.normal[i + pixels] = float(normal.y);
  frame.normal[i + 2 * pixels] = float(normal.z);
}

// Analytic scenes with the surfaces behind the first one, as a renderer peels them.

/// The frame of a rendering with as many peels as there are surfaces but the first, of all faces.
HostFrame peeled(const Scene& scene, const Shot& shot, int surfaces);

/// How much farther than a surface its ray goes on from there, as a part of the surface's depth.
constexpr double kBehindSurface = 1e-6;

/// Gives the rendering's frame two planes for each of so many surfaces behind the first: one of `fronts`, and one of
/// backs, which are seen where a ray leaves a solid of the scene. What lies farther behind the first surface than
/// `within` is left out.
void add_solid_peels(Rendering& rendering, const Scene& scene, int count, const std::vector<int>& solids = {},
                     double within = kNowhere, BehindKind fronts = BehindKind::fronts);

// A furnished room as a rendering, and the depths that other programs would have written of it.

constexpr double kNear = 0.1;  // of its z-buffers, scene units

/// A floor, a wall and a ball on the floor.
inline const Scene kBallRoom{{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}),
                              parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
                              Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}}};
/// The same with a slab in the air.
inline const Scene kRoom = [] {
  Scene scene = kBallRoom;
  scene.add({parallelogram({2, -1.5, 0.3}, {0.6, 0.2, 0.1}, {0, 0.9, 0})});
  return scene;
}();
/// Sees the room and sky.
inline Shot room_shot(int width, int height, bool orthographic = false, double fov = 55, double units = 4) {
  const Vec3 eye{4.5, -1.5, 2.4}, target{1, 0, 0.6};
  return orthographic ? Shot::orthographic(eye, target, units, width, height)
                      : Shot::perspective(eye, target, fov, width, height);
}

/// A floor, a wall and a ball, from outside or from within a corner, with sky.
inline Rendering furnished(bool inside = false) {
  return render(kBallRoom,
                inside ? Shot::perspective({0.3, -0.5, 0.2}, {1, 0.6, 0.3}, 90, 160, 120) : room_shot(160, 120));
}

/// The frame with each depth of a surface replaced, and all sky by `sky`.
inline HostFrame with_depth(const Rendering& rendering, DepthKind kind, const std::function<double(const Hit&)>& value,
                            float sky) {
  HostFrame frame = rendering.frame;
  frame.depth_kind = kind;
  for (std::size_t i = 0; i < frame.depth.size(); i++)
    frame.depth[i] = rendering.hits[i].primitive < 0 ? sky : float(value(rendering.hits[i]));
  return frame;
}

/// The z-buffer by its projection matrix: the third row over the fourth, for a camera that looks along -z.
inline double device_depth(double z, double far, bool reversed, DeviceRange device, double near = kNear) {
  const double zero_to_one = std::isinf(far) ? 1 - near / z : (far / (far - near)) * (1 - near / z);
  const double d = reversed ? 1 - zero_to_one : zero_to_one;
  return device == DeviceRange::zero_to_one ? d : 2 * d - 1;
}

inline DepthRange between_planes(double far, bool reversed, DeviceRange device = DeviceRange::zero_to_one,
                                 double near = kNear) {
  DepthRange range;
  range.near = near;
  range.far = far;
  range.reversed = reversed;
  range.device = device;
  return range;
}

// Scenes by chance, for what must hold in any.

constexpr Estimator kEstimators[] = {Estimator::gtao, Estimator::bitmask, Estimator::hbao, Estimator::crytek};

/// A scene of a few flat and round things, seen from anywhere, also from within a corner.
class RandomScenes {
 public:
  explicit RandomScenes(unsigned seed) : random_(seed) {}

  /// times: as many pixels in x and y.
  HostFrame next(int times = 1) {
    Scene scene;
    scene.primitives.push_back(Plane{{0, 0, 0}, {0, 0, 1}});
    if (number(0, 1) < 0.5)
      scene.primitives.push_back(Plane{{0, number(1, 5), 0}, unit({number(-1, 1), -1, number(-0.3, 0.3)})});
    if (number(0, 1) < 0.3) scene.primitives.push_back(Plane{{number(-3, -1), 0, 0}, {1, 0, 0}});
    const int things = int(number(0, 6));
    for (int i = 0; i < things; i++) {
      const Vec3 at{number(-3, 3), number(-2, 4), number(0, 1)};
      if (number(0, 1) < 0.5)
        scene.primitives.push_back(Sphere{.center = at, .radius = number(0.02, 0.5)});
      else
        scene.primitives.push_back(parallelogram(at, vector(0.6), vector(0.6)));
    }
    const Vec3 eye{number(-0.8, 0.8), number(-4, 0.5), std::exp(number(-4, 1.5))},
        target{number(-1, 1), number(0, 3), number(-0.5, 0.5)};
    const int width = times * int(number(8, 97)), height = times * int(number(8, 65));
    Shot shot = number(0, 1) < 0.8 ? Shot::perspective(eye, target, number(5, 150), width, height)
                                   : Shot::orthographic(eye, target, number(0.5, 8), width, height);
    if (number(0, 1) < 0.3) shot.camera.cx += number(-1, 1) * width, shot.camera.fy *= number(0.4, 2.5);
    HostFrame frame = render(scene, shot).frame;
    const double kind = number(0, 1);
    if (kind < 0.15) {
      frame.depth_is_half = true;
      for (float& z : frame.depth) z = std::ldexp(std::round(std::ldexp(z, 10 - std::ilogb(z))), std::ilogb(z) - 10);
    } else if (kind < 0.3) {
      for (float& n : frame.normal) n = std::round(n * 2048) / 2048;
    } else if (kind < 0.4) {
      frame.normal.clear();
    }
    return frame;
  }
  double radius() { return std::exp(number(-5, 1.5)); }
  int whole(int least, int most) { return std::uniform_int_distribution(least, most)(random_); }
  Estimator estimator() { return kEstimators[int(number(0, 4)) & 3]; }
  ThicknessKind thickness() { return ThicknessKind(int(number(0, 3)) % 3); }

 private:
  double number(double least, double most) { return std::uniform_real_distribution(least, most)(random_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }

  std::mt19937 random_;
};

// A frame for which a search takes less time.

/// The frame in upload buffers, with a matte that takes these pixels: sampled searches leave out tiles without any, and
/// the rest has the bits that it has without a matte.
FrameInputs with_matte(const HostFrame& frame, const std::vector<std::size_t>& pixels);

// Bent normals of a frame, as the chain writes them and as the estimator leaves them.

/// Makes vectors of planes x, y, z.
std::vector<Vec3> vectors_in(std::span<const float> planes, double scale = 1, double offset = 0);

/// The same of the first band of nine planes, see transfer.comp.
std::vector<Vec3> first_band(std::span<const float> transfer);

/// The AOV: unit vectors in view space.
std::vector<Vec3> bent_normals(const HostFrame& frame, const EstimatorSettings& settings);

/// The mean open directions in view space, as the estimator leaves what is blocked. `pixels`: where they are needed;
/// empty: all.
std::vector<Vec3> raw_bent(const HostFrame& frame, const EstimatorSettings& settings,
                           const std::vector<std::size_t>& pixels = {});

}  // namespace alcove::test
