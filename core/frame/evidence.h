// Evidence of the pixels on depth and normals: statistics, and scores of the ways to read them. Knows no renderer.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/camera/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// Statistics of a plane's values.
struct ValueStatistics {
  std::uint64_t pixels = 0, nan = 0, infinite = 0, negative = 0, zero = 0, one = 0, positive = 0;
  double least = 0, most = 0;  // finite ones; 0 where there are none
};
/// Counts every `step`-th value.
ValueStatistics statistics_of(std::span<const float> values, std::size_t step = 1);

constexpr double kUnitTolerance = 0.05;  // of a length that is taken for 1

/// Statistics of normals as they stand in the file, without those that are not finite or zero.
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
/// Agreement of a frame with normals that lost their components below 0. Depth tells, in the normals' own space.
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

// Flat surfaces as the measure of what depth values mean.

/// The coarseness of stored values, whatever their sample type.
struct Grain {
  double median = 0;  // of the values' distances from 0; where there is a step, each of them counts once
  double step = 0;    // from one value to the next at the median; 0: as fine as floats are, or too few values to tell
  bool is_coarse = false;  // the step is more than a 2^14th of the median
  bool is_fixed = false;   // the step is the same for small and large values
  bool is_half = false;    // the steps are those of half floats, or of half floats times a scale
};
/// Finds the common divisor of the differences between neighbouring values, at three places of their distribution.
/// Values of some 17 bits or fewer have a step; `sky`: values at or beyond it count for none.
Grain grain_of(std::span<const float> raw, double sky);

/// A way to read depth and how well the frame's flat surfaces agree with it.
struct DepthScore {
  DepthKind kind;
  // The share of the smooth blocks that are flat by this kind and by no other.
  double straight = 0;
};
/// Scores planar, ray and inverse depth, the best first. Inverse stands for all that is affine in 1/z, as device depth
/// is. In an orthographic view planar stands for ray and device depth too, and inverse for itself. Gives nothing where
/// too little of the frame is smooth. `sky`: values at or beyond it, and 0, are no surface.
///
/// On a plane 1/z is affine over the image (orthographic: z). Over each block a polynomial of second degree is fitted
/// to the quantity that would be affine by each kind. A block is flat by the kind whose second-degree terms vanish
/// within the block's own noise: its residual, and the step of the values. So neither rounding nor samples beside the
/// pixels' centres speak for a kind. If two kinds are flat, the block does not tell.
std::vector<DepthScore> score_depth(std::span<const float> raw, const View& view, double sky, const Grain& grain);

/// Gives the noise of flat surfaces whose pixels show places beside their centres: the standard deviation of depth,
/// relative to its change from one pixel to the next. A random place within each pixel gives 0.29, the mean of n of
/// them 0.29 / sqrt(n). Gives none if the flat surfaces are exact, or if the noise does not follow the slope. `grain`
/// is that of the raw values.
std::optional<double> jitter_of(std::span<const float> raw, const DepthMap& map, const View& view, const Grain& grain);

// Samples of a frame that is read window by window.

/// The step, in pixels, that is fine enough for the statistics of a frame. It is a prime: no column is favoured.
constexpr std::size_t kSparse = 31;

/// A pixel of the sample.
struct SampledPixel {
  std::size_t number;            // in the sample of the whole
  std::size_t at;                // in the planes of the window
  std::array<double, 3> values;  // of the depth as the file has it: one, or three of a position
  double ray;                    // length of the pixel's ray of unit depth; 1 where it is orthographic
};

/// Gives the step, in pixels, of a sample of about `count` pixels of the whole.
inline std::size_t sampling_step(const Window& whole, std::size_t count) { return whole.pixels() / count + 1; }

/// Calls `visit` with the pixels of `window` that belong to a sample of about `count` pixels of `whole`. A pixel has
/// the same number in every window, so the sample does not depend on how the whole is cut. `depth` and `view` are the
/// window's.
template <class Visit>
void for_each_sampled(const View& view, std::span<const float> depth, const Window& window, const Window& whole,
                      std::size_t count, const Visit& visit) {
  const std::size_t pixels = window.pixels(), step = sampling_step(whole, count);
  for (std::size_t i = step / 2; i < whole.pixels(); i += step) {
    const int column = whole.x + int(i % std::size_t(whole.width)) - window.x,
              row = whole.y + int(i / std::size_t(whole.width)) - window.y;
    if (column < 0 || column >= window.width || row < 0 || row >= window.height) continue;
    SampledPixel pixel{i / step,
                       std::size_t(row) * std::size_t(window.width) + std::size_t(column),
                       {},
                       ray_length(view, column, row)};
    for (std::size_t axis = 0; axis < 3 && pixel.at + axis * pixels < depth.size(); axis++)
      pixel.values[axis] = depth[pixel.at + axis * pixels];
    visit(pixel);
  }
}

// The facts together.

/// A choice that neither settings nor camera make.
struct Guess {
  std::string what, chosen, why, option;  // the option makes the choice
};

/// Facts that the pixels of a frame show.
struct Evidence {
  bool tells = true;                     // false: the pixels left a question open
  Grain grain;                           // of the depth's values
  std::vector<DepthScore> depth_scores;  // of depth that is no position
  // of the surfaces, scene units; none until the frame is settled, and where all is sky
  std::optional<double> median_depth;
  std::vector<Guess> guesses;
};

}  // namespace alcove
