// A frame during the settling of its normals: the state that the steps share, and other cameras to try on them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/settlement.h"

namespace alcove {

/// If the normals agree with depth less than this part of the best agreement, another reading of them is chosen or
/// noted.
inline constexpr double kNoBetter = 0.95;
/// Another reading of the camera is taken for the right one if so many times as many normals are close by it.
inline constexpr double kSharper = 1.2;
/// If this part of the normals has unit length, and less than the other part by another encoding, they are vectors.
inline constexpr double kUnit = 0.9, kNotUnit = 0.5;
/// A reading counts as good as the best one if, after a turn of opposite normals, it explains this part of the best
/// one's number, and if this part of the explained normals needed no turn.
inline constexpr double kAsMany = 0.98, kLeastOwn = 0.2;
/// Degrees. If all normals are turned by more than this against depth, their space or camera is another one. Bumps do
/// not turn all normals alike; half depth turns them by up to a degree.
inline constexpr double kLeastTurn = 1, kLeastTurnOfHalf = 3;

/// Degrees. If the best quarter of the normals is farther off than this, normals and depth are of different cameras or
/// planes.
inline constexpr double kLargestAngle = 2;

// The usual mistakes of cameras, each undone and tried on the normals.

/// A tried camera, its score, and the given camera's fault if the tried one is right.
struct OtherCamera {
  std::string what;  // the sentence with the remedy, without a full stop
  NormalScore score;
};

/// Gives the best of the usual mistakes by which a camera turns the world or the picture: the inverse of its matrix,
/// axes of another convention, another axis up, angles in another order, a picture that is upside down. None if too
/// little of the frame is smooth, or if even then some normals disagree. `as` is the tried reading of the normals.
std::optional<OtherCamera> best_turned_camera(const NormalPlanes& planes, const NormalScore& as);

/// Gives the camera, turned by a small angle within the normals' world so that all of them agree. In view space this
/// world is the given camera's own. None if too little of the frame is smooth.
std::optional<OtherCamera> slightly_turned_camera(NormalPlanes planes, const NormalScore& as);

/// Gives the best of the orders in which the angles of a .chan file may turn the camera; none for other cameras, and
/// for normals in view space.
std::optional<OtherCamera> best_other_rotation(const NormalPlanes& planes, const NormalScore& as);

/// Gives the best of the cameras with the principal point on the other side of the picture's centre, by x, by y or by
/// both, or in the centre.
std::optional<OtherCamera> best_other_point(const NormalPlanes& planes, const NormalScore& as);

/// The score with pixels as high as wide.
std::optional<NormalScore> square_pixels(NormalPlanes planes, const NormalScore& as);

/// Gives the best of a few wider and narrower fields of view; none for an orthographic camera.
std::optional<OtherCamera> best_other_width(const NormalPlanes& planes, const NormalScore& as);

/// Whether the principal point is so far from the picture's centre that it matters on which side.
bool is_off_centre(const Camera& camera);

// The state.

class NormalSettlement : protected Settlement {
 public:
  NormalSettlement(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen)
      : Settlement({source.reading, source.notes, settings, raw, seen, source.path_of(RawPlane::normal),
                    source.note_file(RawPlane::normal)}),
        source_(source) {}

 protected:
  NormalPlanes planes() const { return {over(reading_, raw_.window), raw_.normal, raw_.depth}; }
  static bool agrees(const NormalScore& score) {
    return score.explained() >= kLeastAgreement && score.angle <= kLargestAngle;
  }
  /// Whether a reading is as good as any, if need be after a turn of opposite normals: opposite normals are a fault of
  /// some objects, flips a fault of all.
  static bool explains(const NormalScore& score, const std::vector<NormalScore>& scores) {
    return score.agreement >= kNoBetter * scores[0].agreement || explains_most(score, scores);
  }
  static bool explains_most(const NormalScore& score, const std::vector<NormalScore>& scores) {
    const double most = std::ranges::max_element(scores, {}, &NormalScore::explained)->explained();
    return score.explained() >= kAsMany * most && score.agreement >= kLeastOwn * score.explained();
  }
  /// Whether one reading lacks the common turn of all normals in the other reading. A slightly turned camera causes
  /// this turn in the wrong space.
  bool is_straighter(const NormalScore& score, const NormalScore& other) const {
    const double least = !has_coarse_depth(reading_) ? kLeastTurn : kLeastTurnOfHalf;
    return other.turn_degrees() > least && kClear * score.turn_degrees() < other.turn_degrees() &&
           score.explained() >= kNoBetter * other.explained();
  }
  /// The same reading in the other space, where it is straighter.
  const NormalScore* straighter_than(const NormalScore& score, const std::vector<NormalScore>& scores) const;
  static std::string rotation_text(const NormalScore& chosen, const NormalScore& other);
  /// The camera, turned back by the common turn of all normals, if the turn is at least so many degrees, and if the
  /// normals then fit better, also than with another field of view. If the best quarter's angle is below `fitting`, no
  /// camera counts as better.
  std::optional<OtherCamera> straightened(const NormalScore& score, double least_turn, double fitting) const;
  /// Whether normals that are read in view space belong to a world in which the camera is turned by little, if no
  /// matrix places it.
  std::optional<std::string> turned_world(const NormalScore& score) const;
  /// Refuses the given camera if the normals disagree with depth by it, and agree by a camera with a usual mistake
  /// undone. `sharpest` is the share of close normals in another reading.
  void refuse_turned_camera(const NormalScore& chosen, double sharpest) const;
  /// Refuses normals with components in another order, or in two of the three channels, unless another camera explains
  /// them. `scores`: of the normals as they are; none: they have no reading.
  void refuse_other_components(const std::vector<NormalScore>& scores, const NormalStatistics& statistics) const;
  static std::string text_of(const NormalScore& s);
  /// Names the file of the camera, or the header's attributes.
  std::string from() const {
    if (!source_.camera_from.empty()) return " of " + source_.camera_from;
    return settings_.camera.empty() ? std::string() : " " + settings_.camera;
  }
  /// As "N.X, N.Y, N.Z".
  std::string channels() const;

  static constexpr const char* kSpaceOptions = "--normal-space, --flip-normal";
  static constexpr const char* kWithout = "--normal none reconstructs them from depth";
  static constexpr const char* kCheck =
      "check --normal-space, --normal-encoding, --depth-kind with --near, --far and --reversed-z, and --camera, "
      "--chan-rotation or --fov: "
      "it may also be the camera of another frame";

  FrameSource& source_;
};

/// Settles the encoding of the normals, and refuses vectors that were treated as colours. Gives the statistics of some
/// of them.
NormalStatistics settle_normal_encoding(const NormalSettlement& normals);
/// Notes normals that depth speaks against, and refuses normals that it refutes.
void doubt_normals(const NormalSettlement& normals, const std::vector<NormalScore>& scores);

}  // namespace alcove
