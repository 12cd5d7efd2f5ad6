// What the steps that settle normals share.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/normal_settlement.h"

#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "core/base/option_words.h"

namespace alcove {
namespace {

/// Degrees. If the best quarter of the normals is farther off than this, normals and depth are of different cameras or
/// planes.
constexpr double kLargestAngle = 2;
/// The same where nothing but the turn speaks for another space.
constexpr double kClearTurn = 2;

}  // namespace

bool NormalSettlement::agrees(const NormalScore& score) {
  return score.explained() >= kLeastAgreement && score.angle <= kLargestAngle;
}

bool NormalSettlement::explains(const NormalScore& score, const std::vector<NormalScore>& scores) {
  return score.agreement >= kNoBetter * scores[0].agreement || explains_most(score, scores);
}

bool NormalSettlement::explains_most(const NormalScore& score, const std::vector<NormalScore>& scores) {
  const double most = std::ranges::max_element(scores, {}, &NormalScore::explained)->explained();
  return score.explained() >= kAsMany * most && score.agreement >= kLeastOwn * score.explained();
}

bool NormalSettlement::is_straighter(const NormalScore& score, const NormalScore& other) const {
  const double least = !has_coarse_depth(reading_) ? kLeastTurn : kLeastTurnOfHalf;
  return other.turn_degrees() > least && kClear * score.turn_degrees() < other.turn_degrees() &&
         score.explained() >= kNoBetter * other.explained();
}

const NormalScore* NormalSettlement::straighter_than(const NormalScore& score,
                                                     const std::vector<NormalScore>& scores) const {
  const auto other = score.space == NormalSpace::world ? NormalSpace::view : NormalSpace::world;
  const NormalScore* reading = score_of(scores, other, score.flips);
  return reading && is_straighter(*reading, score) ? reading : nullptr;
}

std::string NormalSettlement::rotation_text(const NormalScore& chosen, const NormalScore& other) {
  return fmt::format("read in {} space, all normals are turned by {:.1f} degrees against depth, read as {} by {:.1f}",
                     word_of(other.space), other.turn_degrees(), word_of(chosen.space), chosen.turn_degrees());
}

std::optional<OtherCamera> NormalSettlement::straightened(const NormalScore& score, double least_turn,
                                                          double fitting) const {
  const double least = !has_coarse_depth(reading_) ? least_turn : kLeastTurnOfHalf;
  if (score.turn_degrees() < least) return std::nullopt;
  const auto turned = slightly_turned_camera(planes(), score);
  if (!turned) return std::nullopt;
  const NormalScore& then = turned->score;
  if (then.close <= kSharper * score.close && (score.angle <= fitting || kClear * then.angle >= score.angle))
    return std::nullopt;
  const auto width = best_other_width(planes(), score);
  return width && width->score.close >= then.close ? std::nullopt : turned;
}

std::optional<std::string> NormalSettlement::turned_world(const NormalScore& score) const {
  if (reading_.camera.view_from_world || score.space != NormalSpace::view) return std::nullopt;
  const auto turned = straightened(score, kClearTurn, kLargestAngle);
  if (!turned) return std::nullopt;
  return fmt::format(
      "by {} its normals look like world space: {:.0f} % of them agree with depth to 3 degrees then, {:.0f} % in view "
      "space",
      turned->what, 100 * turned->score.close, 100 * score.close);
}

std::string NormalSettlement::text_of(const NormalScore& s) {
  return fmt::format("{} with flips {}: {:.0f} % agree with depth, {:.0f} % face the camera{}", word_of(s.space),
                     to_string(s.flips), 100 * s.agreement, 100 * s.facing,
                     s.opposite < 0.005 ? "" : fmt::format(", {:.0f} % are opposite to depth", 100 * s.opposite));
}

std::string NormalSettlement::from() const {
  if (!source_.camera_from.empty()) return " of " + source_.camera_from;
  return settings_.camera.empty() ? std::string() : " " + settings_.camera;
}

std::string NormalSettlement::channels() const {
  std::string names;
  for (const auto& channel : source_.channels[RawPlane::normal]) names += (names.empty() ? "" : ", ") + channel.channel;
  return names;
}

}  // namespace alcove
