// Scores of the ways to read normals: how well they agree with depth. Knows no renderer.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/camera/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// The usual reading stays where its score is at least this part of the best one.
inline constexpr double kAsGood = 0.8;
/// Another reading is taken only where it is this many times as good as the second best.
inline constexpr double kClear = 2;
/// The least share of the normals that must agree with depth. Some reading reaches half by chance: rooms have three
/// directions.
inline constexpr double kLeastAgreement = 0.6;
/// If a smaller share of the normals agrees with depth, they are not of this depth or not of this camera. Chance gives
/// some 5 %. Measured: 12 frames of rendered scenes and games that were read rightly gave 87 % and more; 30 wrongly
/// turned cameras gave 37 % at most, and 25 % but for one.
inline constexpr double kRefuted = 0.1;
/// If a smaller share of the normals agrees with depth, they are not used unless --set allow=normals-disagree says so:
/// most of them would be wrong.
inline constexpr double kUsable = 0.5;

/// A way to read normals and how well the frame agrees with it.
struct NormalScore {
  NormalSpace space;
  NormalFlips flips;
  double facing = 0;     // share that faces the camera, as all visible surfaces do
  double agreement = 0;  // share within 20 degrees of the normal that depth gives
  double opposite = 0;   // share within 20 degrees of its opposite, which prepare.comp turns round
  double close = 0;      // share within 3 degrees of it, which only the right camera gives
  // Of readings by which at least kUsable agree.
  double angle = 180;  // degrees to either one: the largest of the best quarter
  Vector3 turn{};      // radians about an axis of view space: the common turn of all within 20 degrees

  /// The share of right normals after the opposite ones are turned round.
  double explained() const { return agreement + opposite; }
  double turn_degrees() const;
  /// Whether the normals agree so as they do by the right camera and components: nearly all, and not turned as a whole.
  /// In rooms, with their three directions, another scene's normals may bring 60 %.
  bool may_be_right() const { return agreement >= 0.8 && turn_degrees() < 3; }
  /// Whether clearly more normals agree so, and enough of them.
  bool clearly_beats(const NormalScore& other) const {
    return agreement >= kLeastAgreement && agreement > kClear * other.agreement;
  }
};
/// Whether one camera, or one order of components, fits better than another by more than chance: by a factor and a
/// difference in the share of close normals, and by a least share. The right cameras of 13 frames have at least 38 %.
bool is_sharper(const NormalScore& other, const NormalScore& score);
/// Normals as in a file, the depth to compare them with, and the reading of both.
struct NormalPlanes {
  NormalPlanes(const Reading& reading, std::span<const float> normal, std::span<const float> raw);

  std::span<const float> normal, raw;  // as in the file
  NormalEncoding encoding;
  bool unorm;
  DepthMap map;
  Camera camera;
  View view;
  int sparse = 1;                            // one of so many places, across and down, is sampled
  std::vector<std::size_t> components = {};  // of the planes, in the order in which they are read; empty: as they stand
};
/// Scores world space, where the camera knows it, and view space, each with all flips, the best agreement first. Gives
/// nothing where too little of the frame is smooth.
std::vector<NormalScore> score_normals(const NormalPlanes& planes);
/// Of the scores that agree with depth, the one with the most close normals; null without any.
const NormalScore* sharpest_of(const std::vector<NormalScore>& scores);
/// The score of one of them; null where there is none.
const NormalScore* score_of(const std::vector<NormalScore>& scores, NormalSpace space, const NormalFlips& flips);
/// Agreement of a frame with normals that lost their components below 0, by depth, in the normals' own space.
struct CutScore {
  double needed = 0;    // share of the normals with a component clearly below 0
  double absolute = 0;  // of these, the share within 20 degrees of the normal without signs
  double clamped = 0;   // and of the normal with 0 in place of components below it
};
/// Gives nothing where too little of the frame is smooth.
std::optional<CutScore> score_cut(NormalSpace space, const NormalPlanes& planes);

/// Scores one of these readings, so that another camera than the frame's can be tried.
std::optional<NormalScore> score_normals_as(NormalSpace space, const NormalFlips& flips, const NormalPlanes& planes);

/// Gives the axes, as "xz", or "none".
std::string to_string(const NormalFlips& flips);

}  // namespace alcove
