// The chain on frames of tests: settings, what comes out, and how far that is from a truth.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/chain.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace alcove::test {

constexpr double kPi = std::numbers::pi, kRadian = kPi / 180;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

/// plain_settings() of an estimator.
EstimatorSettings sampled(Estimator estimator, double radius, int slices, int steps);
/// An exact search whose occluders are as deep as wide.
EstimatorSettings exact(double radius, int slices = 16);
/// The one of the preset `reference`, whose pixels of a block share their directions.
EstimatorSettings shared_directions(double radius);
/// What tells settings apart, for messages.
std::string name_of(const EstimatorSettings& settings);

/// A frame on the device with its G-buffer.
struct Prepared {
  FrameInputs inputs;
  GBuffer gbuffer;
};
Prepared prepared(const HostFrame& frame);

/// The values of a buffer that the chain left; none: empty.
std::vector<float> values_of(const gpu::Buffer* buffer);

std::vector<float> ao_of(const HostFrame& frame, const EstimatorSettings& settings);
/// The same at these pixels, and 1 elsewhere: see with_matte().
std::vector<float> ao_at(const HostFrame& frame, const EstimatorSettings& settings,
                         const std::vector<std::size_t>& pixels);

/// What the chain makes of a frame for a list of AOVs, and what of it completed surfaces took.
struct Planes {
  std::vector<float> ao, scales, normal, bent, transfer, confidence, error, specular, completed, convexity, cavity,
      curvature;
  TileCounts tiles{};
  std::vector<std::string> passes;
};
Planes planes_of(const HostFrame& frame, const EstimatorSettings& settings, const std::string& aovs,
                 bool completed = false);

/// One of the small rendered frames: examples/bench/SCENE.
HostFrame rendered_frame(const std::string& scene);

/// The part of a frame in that window of its own pixels.
HostFrame crop_of(const HostFrame& whole, const Window& window);

/// Expects that a frame's AO is 1 everywhere.
void expect_open(const HostFrame& frame, const EstimatorSettings& settings, double tolerance);

// Closed forms. Distances are divided by the radius where it is left out.

const Plane kFloor{.point = {}, .normal = {0, 0, 1}}, kWallX{.point = {}, .normal = {1, 0, 0}},
    kWallY{.point = {}, .normal = {0, 1, 0}};

/// Area of the segment of the unit disk beyond the chord at x.
double segment(double x);
/// The AO beside an endless wall.
double beside_wall(double distance);
/// The same beside two of them at a right angle; far within the radius it is 1/4.
double beside_corner(double distance_a, double distance_b);

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
using Truth = std::function<double(const Hit&)>;  // the AO there; kNone: not known, or not to be compared

/// How far the AO is from the truth at those pixels that have one and from whose surface another is farther than so
/// many pixels; vertices are two pixels away from all.
struct Errors {
  double mean = 0, bias = 0, worst = 0;
  std::vector<std::size_t> pixels = {};
  std::vector<double> truths = {};
  std::string where = {};  // it is worst
};
Errors errors_of(const Rendering& rendering, const std::vector<float>& ao, const Truth& truth, int clear_px = 2);
/// The same of the AO by these settings, which sampled searches compute in the tiles of those pixels alone.
Errors errors_of(const Rendering& rendering, const EstimatorSettings& settings, const Truth& truth, int clear_px = 2);

/// Those of the floor and one wall, or two, wherever the picture shows all that is within the radius.
Truth wall_truth(const Shot& shot, double radius);

/// A plane 5 before the camera, seen under a tilt, a turn and a horizontal field of view, degrees; 0: parallel.
struct SlantedPlane {
  std::string name;
  Rendering rendering;
};
std::vector<SlantedPlane> slanted_planes(const std::vector<double>& tilts, const std::vector<double>& turns,
                                         const std::vector<double>& fovs, int width = 64, int height = 48,
                                         double distance = 5, double units = 0.5);
/// From the origin along x.
Shot along_x(double fov, int width, int height, double units = 0.5);

// Single passes after the estimate, with any visibility in its place.

/// What the settings' denoiser makes of this visibility of the frame.
std::vector<float> denoised(const HostFrame& frame, const std::vector<float>& ao, const EstimatorSettings& settings);

/// What upsampling makes of a visibility that is given by block: its column and row at the settings' resolution.
std::vector<float> upsampled(const HostFrame& frame, const std::function<double(int, int)>& ao_of_block,
                             const EstimatorSettings& settings);

/// A floor, a wall, a ball on the floor, a slab in the air, and sky.
Rendering furnished_room(int width, int height);

/// The frame upside down or left to right.
HostFrame mirrored(const HostFrame& frame, bool left_right);
std::vector<float> mirrored(const std::vector<float>& plane, const HostFrame& frame, bool left_right);

/// The frame in units 2^-exponent times as large.
HostFrame scaled(HostFrame frame, int exponent);

/// Any bits for depth and normals: NaN, infinite, negative, tiny and huge ones too.
HostFrame random_bits(int width, int height, unsigned seed);

// The truth of scenes whose surfaces hide each other: rays cast from receivers, and pixels that are good receivers.

/// The mean over across x across rays of a receiver, as dense as the cosine to its normal, of what `value`
/// gives for what a ray hits and for its direction.
inline double mean_over_rays(const Scene& scene, const Hit& receiver, int across,
                             const std::function<double(const Hit&, const Vec3&)>& value) {
  const Vec3 x = unit(cross(std::abs(receiver.normal.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, receiver.normal));
  const Vec3 y = cross(receiver.normal, x);
  double sum = 0;
  for (int i = 0; i < across; i++) {
    const double out = std::sqrt((i + 0.5) / across);
    for (int j = 0; j < across; j++) {
      const double azimuth = 2 * std::numbers::pi * (j + 0.5) / across;
      const Vec3 direction =
          out * (std::cos(azimuth) * x + std::sin(azimuth) * y) + std::sqrt(1 - out * out) * receiver.normal;
      sum += value(scene.hit({receiver.position, direction}), direction);
    }
  }
  return sum / (double(across) * across);
}

inline double true_ao(const Scene& scene, const Hit& receiver, double radius, int across) {
  return mean_over_rays(scene, receiver, across,
                        [&](const Hit& hit, const Vec3&) { return hit.distance < radius ? 0.0 : 1.0; });
}

/// A floor beside one wall or two, and some pixels of it: wherever the picture shows all that is within the radius.
struct FloorByWalls {
  int walls;
  double radius;
  Rendering rendering;
  std::vector<std::size_t> pixels;

  bool is_open(std::size_t pixel, Vec3 w) const {
    const Vec3 p = rendering.hits[pixel].position;
    return w.x > -p.x / radius && (walls < 2 || w.y > -p.y / radius);
  }
};
FloorByWalls floor_by_walls(int walls, const Shot& shot, double radius);
/// The shot turned about its axis, degrees.
Shot rolled(Shot shot, double roll);

/// The AO of the chosen pixels for a radius of 1, by rays and by what `ao_at` gives: of the whole frame, and right at
/// those pixels.
struct Means {
  double truth = 0, ao = 0, error = 0;
};
using Chosen = std::function<bool(const Hit&)>;
Means means_of(const Scene& scene, const Shot& shot, const Chosen& chosen, int every,
               const std::function<std::vector<float>(const HostFrame&, const std::vector<std::size_t>&)>& ao_at);

/// A box above the floor, so deep and high, whose front is at x = 0.
Scene box_above_floor(double depth, double above, double height);
inline bool is_below_box(const Hit& hit) {
  return hit.primitive == 0 && hit.position.x < 0 && std::abs(hit.position.y) < 1;
}

/// A round hole of that depth below z = 0. Its parts: 0 the ground, 1 the floor, further the walls.
Scene round_hole(double radius, double depth, int sides);

/// A wall x = 0 that ends behind a column, and what a receiver sees of the part of the wall's plane that the column
/// hides from the eye: of that without wall, and with it.
struct EndingWall {
  Vec3 eye{5, 0.2, 1.2};
  Polygon column = parallelogram({0.8, -0.15, 0.02}, {0, 0.3, 0}, {0, 0, 5});
  Scene scene{{kFloor, parallelogram({0, -4, 0}, {0, 4, 0}, {0, 0, 4}), column}};

  struct Share {
    double open = 0, wall = 0;
  };
  Share hidden_from(const Hit& receiver, double radius, int across) const {
    Share share;
    const Scene columns{{column}};
    share.open = mean_over_rays(scene, receiver, across, [&](const Hit& hit, const Vec3& direction) {
      const double to_plane = -receiver.position.x / direction.x;
      if (!(to_plane > 0 && to_plane < radius)) return 0.0;
      const Vec3 on_plane = receiver.position + to_plane * direction;
      if (columns.hit({eye, on_plane - eye}).distance >= 1) return 0.0;
      share.wall += hit.primitive == 1 ? 1.0 / (double(across) * across) : 0;
      return hit.distance >= radius ? 1.0 : 0.0;
    });
    return share;
  }
};

/// Pixels of a grid, `every` pixels apart, that show a chosen surface, are not beside an edge, and whose sphere of the
/// radius is in the picture.
inline std::vector<std::size_t> receivers(const Rendering& rendering, double radius, int every, const Chosen& chosen) {
  std::vector<std::size_t> pixels;
  for (int y = 2; y < rendering.shot.data.height; y += every) {
    for (int x = 2; x < rendering.shot.data.width; x += every) {
      const Hit& hit = rendering.at(x, y);
      if (hit.primitive >= 0 && rendering.primitives_within(2, x, y) == 1 &&
          rendering.shot.sees_ball(hit.position, radius) && chosen(hit))
        pixels.push_back(std::size_t(y) * std::size_t(rendering.shot.data.width) + std::size_t(x));
    }
  }
  return pixels;
}

/// Surfaces that something hides a part of, and from which of them one sees it.
struct Hiding {
  const char* what;
  Scene scene;
  double radius;
  Chosen chosen;
  Shot perspective, orthographic;
};
const Scene kPlateScene{{kFloor, kWallX, parallelogram({0.8, -0.5, 0.45}, {0, 1, 0}, {0, 0, 0.8})}};
inline bool is_floor_by_the_wall(const Hit& hit) { return hit.primitive == 0 && hit.position.x < 0.7; }

inline std::vector<Hiding> hidings(int width, int height) {
  const Sphere half{.center = {0.9, 0, 0.8}, .radius = 0.2, .axis = unit({2.1, 0, 2.7}), .cos_half_angle = 0.15};
  return {{"a plate", kPlateScene, 1, is_floor_by_the_wall,
           Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.6}, 50, width, height),
           Shot::orthographic({5, 0.3, 1.8}, {0.3, 0, 0.6}, 5, width, height)},
          {"a column",
           {{kWallY, kWallX, parallelogram({0.75, 0.35, -9}, {-0.15, 0.15, 0}, {0, 0, 18})}},
           0.8,
           [](const Hit& hit) { return hit.primitive == 1 && hit.position.y < 0.6; },
           Shot::perspective({4, 4, 1}, {0.3, 0.3, 0}, 45, width, height),
           Shot::orthographic({4, 4, 1}, {0.3, 0.3, 0}, 4, width, height)},
          {"half a sphere",
           {{kFloor, kWallX, half}},
           0.8,
           [](const Hit& hit) { return hit.primitive == 1 && hit.position.z < 0.5; },
           Shot::perspective({3, 0, 3.5}, {0.3, 0, 0.3}, 50, width, height),
           Shot::orthographic({3, 0, 3.5}, {0.3, 0, 0.3}, 4, width, height)}};
}

/// A picture of a wall, and what is left of it when all of the wall but a height of 0.25 is cut off.
struct CutWall {
  explicit CutWall(const Shot& shot) : whole(render({{kFloor, kWallX}}, shot)) {
    while (whole.at(shot.data.width / 2, rows).position.z > 0.25) rows++;
    frame = crop_of(whole.frame, {0, rows, shot.data.width, shot.data.height - rows});
  }
  /// The pixel of the frame that shows what that pixel of the whole shows.
  std::size_t below(std::size_t pixel) const { return pixel - std::size_t(rows * frame.data.width); }

  Rendering whole;
  int rows = 0;
  HostFrame frame;
};

/// Things that have nothing but the sky about them, and so nothing that could go on.
inline std::vector<HostFrame> things_before_the_sky(int width, int height) {
  std::vector<HostFrame> frames;
  for (const Scene& scene : {Scene{{Sphere{.center = {0, 0, 0}, .radius = 1}}},
                             Scene{{parallelogram({-1, -1, -0.5}, {2, 0.3, 0}, {0, 2, 1})}},
                             Scene{{parallelogram({-1, 0, -1}, {0.05, 0, 0}, {0, 0, 2})}}})
    for (const Shot& shot : {Shot::perspective({3, -4, 2}, {0, 0, 0}, 60, width, height),
                             Shot::orthographic({3, -4, 2}, {0, 0, 0}, 6, width, height)})
      frames.push_back(render(scene, shot).frame);
  return frames;
}

}  // namespace alcove::test
