// The chain on frames of tests: settings, what comes out, and how far that is from a truth.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/chain.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/long_tests.h"
#include "tests/support/single_pass.h"

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

/// The values of a buffer that the chain left; none: empty.
std::vector<float> values_of(const gpu::Buffer* buffer);

std::vector<float> ao_of(const HostFrame& frame, const EstimatorSettings& settings);

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

}  // namespace alcove::test
