// What the pixels themselves say about depth and normals: statistics, and scores of the ways to read them. Knows no
// renderer.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// Statistics of a plane's values.
struct ValueStatistics {
  std::uint64_t pixels = 0, nan = 0, infinite = 0, negative = 0, zero = 0, one = 0, positive = 0;
  double least = 0, most = 0;  // finite ones; 0 where there are none
};
/// Counts every `step`-th value.
ValueStatistics statistics_of(std::span<const float> values, std::size_t step = 1);

/// Statistics of normals as they stand in the file, of those that are finite and not zero.
struct NormalStatistics {
  std::uint64_t count = 0;
  double least = 0, most = 0;    // of all components
  double mean_length = 0;        // 1 for signed normals
  double unorm_mean_length = 0;  // the same of 2 n - 1
  double unit_share = 0;         // the share whose length is 1 within 5 %
  double unorm_unit_share = 0;   // the same of 2 n - 1
  double usual_length = 0;       // the median
  double usual_share = 0;        // the share whose length is that within 5 %
};
/// Counts every `step`-th pixel that is no sky. `normal` has two planes or three; `raw` is the depth as in the file.
NormalStatistics normal_statistics(std::span<const float> normal, std::span<const float> raw, const DepthMap& map,
                                   std::size_t step = 1);

/// Decodes the file's values of pixel `i` into a normal of any length, as prepare.comp does.
Vector3 decoded_normal(std::span<const float> raw, std::size_t pixels, std::size_t i, NormalEncoding encoding,
                       bool unorm);

/// Gives the planar depth of each pixel, in scene units; infinite on sky. Of `row_step` rows only the first is taken.
std::vector<float> planar_depths(std::span<const float> raw, const DepthMap& map, const View& view, int row_step = 1);

/// Gives the median distance, in pixels, of positions from the pixels that hold them. It is infinite if most positions
/// are behind the camera; there is none if all are sky. `mirrored` says that the z of view positions has the other sign
/// than the camera's.
std::optional<double> reprojection_error(std::span<const float> position, PositionSpace space, bool mirrored,
                                         const Camera& camera, const View& view);

/// A way to read normals and how well the frame agrees with it.
struct NormalScore {
  NormalSpace space;
  NormalFlips flips;
  double facing = 0;     // share that faces the camera, as all that is visible does
  double agreement = 0;  // share within 20 degrees of the normal that depth gives
  double opposite = 0;   // share within 20 degrees of its opposite, which prepare.comp turns round
  double close = 0;      // share within 3 degrees of it, which only the right camera gives
  double angle = 0;      // degrees to either, of the best quarter at most
  Vector3 turn{};        // radians about an axis of view space, by which those within 20 degrees are turned as a whole

  /// The share of normals that are right once those of the other side are turned round.
  double explained() const { return agreement + opposite; }
  double turn_degrees() const;
};
/// Normals as they stand in a file, the depth that they are held against, and how both are read.
struct NormalPlanes {
  NormalPlanes(const Reading& reading, std::span<const float> normal, std::span<const float> raw);

  std::span<const float> normal, raw;  // as in the file
  NormalEncoding encoding;
  bool unorm;
  DepthMap map;
  Camera camera;
  View view;
};
/// Scores world space, where the camera knows it, and view space, each with all flips, the best agreement first. Gives
/// nothing where too little of the frame is smooth.
std::vector<NormalScore> score_normals(const NormalPlanes& planes);
/// The score of one of them; null where there is none.
const NormalScore* score_of(const std::vector<NormalScore>& scores, NormalSpace space, const NormalFlips& flips);
/// How the frame agrees with normals that lost their components below 0, going by depth in the normals' own space.
struct CutScore {
  double needed = 0;    // share of the normals with a component clearly below 0
  double absolute = 0;  // of those, the share within 20 degrees of the normal without signs
  double clamped = 0;   // and of the normal with 0 in place of components below it
};
/// Gives nothing where too little of the frame is smooth.
std::optional<CutScore> score_cut(NormalSpace space, const NormalPlanes& planes);

/// Scores one of these readings, so that another camera than the frame's can be tried.
std::optional<NormalScore> score_normals_as(NormalSpace space, const NormalFlips& flips, const NormalPlanes& planes);

/// Gives the axes, as "xz", or "none".
std::string to_string(const NormalFlips& flips);

}  // namespace alcove
