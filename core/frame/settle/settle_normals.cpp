// Settles normals: what the steps share, their space, and those that lost their components below 0.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/normal_settlement.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

/// Degrees. As kLeastTurn, where nothing but the turn speaks for another space.
constexpr double kClearTurn = 2;

/// Normals are cut if none is below this, if by depth this part of them should be, and if this part of those is as
/// depth and the cut make them.
constexpr double kBelowZero = -1.0 / 256, kLeastNeeded = 0.02, kLeastCut = 0.8;

class SpaceSettlement : private NormalSettlement {
 public:
  explicit SpaceSettlement(const NormalSettlement& normals) : NormalSettlement(normals) {}

  void run(const NormalStatistics& statistics) {
    const bool has_world = reading_.camera.view_from_world.has_value();
    // The usual reading, and that of view space where the camera knows no world.
    const NormalSpace usual = lacks_sign(source_.channels[RawPlane::normal].size(), reading_.normal_encoding)
                                  ? NormalSpace::view
                                  : source_.program.normal_space;
    const bool has_usual = has_world || usual == NormalSpace::view;
    if (statistics.count == 0) {
      seen_.tells = false;
      if (source_.open.normal_space) reading_.normal_space = has_usual ? usual : NormalSpace::view;
      return;
    }
    if (seen_.space_by_shift) return take_by_shift(*seen_.space_by_shift);
    auto all_scores = score_normals(planes());
    if (lacks_sign(source_.channels[RawPlane::normal].size(), reading_.normal_encoding)) refuse_world(all_scores);
    if (settle_cut(all_scores, statistics)) return;
    if (!all_scores.empty()) refuse_other_components(all_scores, statistics);
    if (!source_.open.normal_space) return doubt_normals(*this, all_scores);
    const std::string given = to_string(settings_.flip_normal);
    auto scores = all_scores;
    if (given != "none") std::erase_if(scores, [&](const auto& s) { return to_string(s.flips) != given; });
    const NormalScore* plain = score_of(scores, has_usual ? usual : NormalSpace::view, settings_.flip_normal);
    const bool tells = plain && best_of(scores).explained() >= kLeastAgreement;
    if (!tells) {
      seen_.tells = false;
      if (!has_usual) refuse_without_matrix(scores);
      reading_.normal_space = usual;
      guess("normal space", word_of(reading_.normal_space), "the frame does not tell", "--normal-space", false);
      return doubt_normals(*this, all_scores);
    }
    const bool is_plain = explains(*plain, scores);
    // By a camera along an axis of the world, normals in view space look like those of a turned world.
    if (!is_plain && has_usual) refuse_turned_camera(*plain, kSharper * scores[0].close);
    const NormalScore& best = is_plain ? *plain : best_of(scores);
    const NormalScore* straighter = straighter_than(best, scores);
    if (!straighter && !is_plain) refuse_ambiguous(best, scores);
    if (!has_world && !source_.open.camera) refuse_turned_world(best);
    take(straighter ? *straighter : best, straighter ? rotation_text(*straighter, best) : text_of(best), has_world);
    doubt_normals(*this, all_scores);
  }

 private:
  /// Takes normals without components below 0 if depth says that they lost some: the file does not hold the lost ones.
  /// Returns whether they are such.
  bool settle_cut(const std::vector<NormalScore>& scores, const NormalStatistics& statistics) {
    if (statistics.least < kBelowZero || !has_lengths(source_) || reading_.normal_unorm || source_.open.camera)
      return false;
    const NormalScore* as = nullptr;
    CutScore best;
    for (const auto& score : scores) {
      if (to_string(score.flips) != "none" || (!source_.open.normal_space && score.space != reading_.normal_space))
        continue;
      const auto cut = score_cut(score.space, planes());
      if (!cut || cut->needed < kLeastNeeded || std::max(cut->absolute, cut->clamped) < kLeastCut) continue;
      if (as && std::max(cut->absolute, cut->clamped) <= std::max(best.absolute, best.clamped)) continue;
      best = *cut;
      as = &score;
    }
    if (!as) return false;
    const std::string why = fmt::format(
        "no component of the normals ({}) is below 0, and by depth {:.0f} % of them need one: {}; save them signed or "
        "as 0.5 + 0.5 n",
        channels(), 100 * best.needed,
        best.absolute > best.clamped ? "their absolute values were saved" : "values below 0 were cut off");
    if (as->explained() < kLeastAgreement) fail(ErrorKind::input, "{}: {}; {}", path_, why, kWithout);
    if (source_.open.normal_space) {
      reading_.normal_space = as->space;
      guess("normal space", word_of(as->space), text_of(*as), "--normal-space", false);
    }
    note(NoteCode::cut_normals, why + "; " + kWithout);
    return true;
  }

  /// Refuses two components of world space, and takes that reading away.
  void refuse_world(std::vector<NormalScore>& scores) const {
    const auto is_world = [](const NormalScore& s) { return s.space == NormalSpace::world; };
    std::vector<NormalScore> world;
    std::ranges::copy_if(scores, std::back_inserter(world), is_world);
    std::erase_if(scores, is_world);
    const auto closest = [](const std::vector<NormalScore>& all) {
      return all.empty() ? NormalScore{} : *std::ranges::max_element(all, {}, &NormalScore::close);
    };
    const bool is_of_world = source_.open.normal_space ? is_sharper(closest(world), closest(scores))
                                                       : reading_.normal_space == NormalSpace::world;
    if (!is_of_world) return;
    fail(ErrorKind::input,
         "{}: its normals ({}) have two components, without the sign of z in world space: give three channels "
         "(--normal-channels), or --normal-space view, or the right one of --normal-encoding octahedral and spheremap; "
         "{}",
         path_, channels(), kWithout);
  }

  /// Takes the space by which the normals have given the shift of the disparity. Its steps are too coarse for more.
  void take_by_shift(NormalSpace space) {
    if (!source_.open.normal_space) return;
    reading_.normal_space = space;
    guess("normal space", word_of(space), "so they give the disparity's shift", "--normal-space",
          space != source_.program.normal_space);
  }

  /// Takes a reading, and says so where it is not the usual one, or where no matrix would turn normals of the world.
  void take(const NormalScore& score, const std::string& why, bool has_world) {
    reading_.normal_space = score.space;
    reading_.flip_normal = score.flips;
    const bool is_flipped = to_string(score.flips) != to_string(settings_.flip_normal);
    const bool is_proven = score.close > kUnit && !has_coarse_depth(reading_);
    guess("normal space", word_of(score.space), why,
          is_flipped || !has_world ? "--normal-space with --flip-normal" : "--normal-space",
          score.space != source_.program.normal_space || is_flipped, is_proven);
  }

  /// The best reading: of those that explain as many normals as any, one without flips, else the one by which most face
  /// as depth does.
  static const NormalScore& best_of(const std::vector<NormalScore>& scores) {
    const auto does = [&](const NormalScore& s) { return explains_most(s, scores); };
    const auto plain =
        std::ranges::find_if(scores, [&](const auto& s) { return does(s) && to_string(s.flips) == "none"; });
    if (plain != scores.end()) return *plain;
    const auto any = std::ranges::find_if(scores, does);
    return any != scores.end() ? *any : scores[0];
  }

  /// Refuses a reading where one in the other space does about as well.
  void refuse_ambiguous(const NormalScore& best, const std::vector<NormalScore>& scores) const {
    const auto other = std::ranges::find_if(scores, [&](const auto& s) { return s.space != best.space; });
    if (other == scores.end() || other->agreement < kAsGood * best.explained() || is_straighter(best, *other)) return;
    fail(ErrorKind::input,
         "{}: its normals may be in {} or in {} space ({}; {}): say which with --normal-space, and --flip-normal",
         path_, word_of(best.space), word_of(other->space), text_of(best), text_of(*other));
  }

  /// Refuses normals that are read in view space where they look like those of a world that nothing turns.
  void refuse_turned_world(const NormalScore& score) const {
    if (source_.program.normal_space == NormalSpace::view) return;
    if (const auto turned = turned_world(score))
      fail(ErrorKind::input, "{}: {}: give a --camera file with world_to_camera; {}", path_, *turned, kWithout);
  }

  /// Refuses normals that are not those of view space where no matrix turns those of the world.
  [[noreturn]] void refuse_without_matrix(const std::vector<NormalScore>& scores) const {
    if (!source_.program.by.empty()) throw NoWorldToCamera(path_);
    fail(ErrorKind::input,
         "{}: {:.0f} % of its normals at most agree with depth in view space; normals in world space need a --camera "
         "file with world_to_camera; if they are in view space, {}; {}",
         path_, scores.empty() ? 0 : 100 * scores[0].agreement, kCheck, kWithout);
  }
};

}  // namespace

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

std::string NormalSettlement::channels() const {
  std::string names;
  for (const auto& channel : source_.channels[RawPlane::normal]) names += (names.empty() ? "" : ", ") + channel.channel;
  return names;
}

void note_centre(FrameSource& source) {
  // A renderer writes its own camera into headers.
  if (source.open.camera || !source.camera_from.empty() || !is_off_centre(source.reading.camera)) return;
  source.notes.push_back(
      {NoteCode::principal_point, fmt::format("the principal point is at ({:.6g}, {:.6g}) of {} x {} pixels, and no "
                                              "pixel shows on which side of the centre it belongs",
                                              source.reading.camera.cx, source.reading.camera.cy,
                                              source.reading.camera.width, source.reading.camera.height)});
}

void settle_normals(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen) {
  const NormalSettlement normals(source, settings, raw, seen);
  const NormalStatistics statistics = settle_normal_encoding(normals);
  SpaceSettlement(normals).run(statistics);
}

}  // namespace alcove
