// Scores the ways in which a frame's normals may be read, chooses one, and refuses what depth and camera refute.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/error.h"
#include "core/frame/altered_normals.h"
#include "core/frame/evidence.h"
#include "core/frame/findings.h"
#include "core/frame/other_cameras.h"
#include "core/frame/sampling.h"
#include "core/frame/settle.h"
#include "core/frame/settlement.h"

namespace alcove {
namespace {

/// Where the normals agree with depth less than this part of the best agreement, another reading of them is chosen, or
/// noted.
constexpr double kNoBetter = 0.95;
/// Degrees. If the best quarter of the normals is farther off than this, normals and depth are of different cameras or
/// planes.
constexpr double kLargestAngle = 2;
/// Another camera is the right one if so many times as many normals are close to those of depth by it, and so large a
/// share more.
constexpr double kSharper = 1.2, kLeastSharper = 0.1;
/// And if so many are close at least. Of the right cameras of 13 frames the least is 38 %.
constexpr double kLeastClose = 0.3;
/// From so many on the field of view is not doubted. With half or twice the right one it was 41 % at most.
constexpr double kSurelyClose = 0.5;
/// If this part of the normals has unit length, and less than the other part by another encoding, they are vectors.
constexpr double kUnit = 0.9, kNotUnit = 0.5;
/// A reading explains the normals as well as the best one if, with those of the other side turned round, it explains
/// this part of as many, and this part of those need not be turned.
constexpr double kAsMany = 0.98, kLeastOwn = 0.2;
/// Degrees. If all normals are turned by more than this against those of depth, they are of another space or another
/// camera. Bumps do not turn them as a whole; half depth does so by up to a degree.
constexpr double kLeastTurn = 1, kLeastTurnOfHalf = 3;
/// The same where nothing but the turn speaks for another space.
constexpr double kClearTurn = 2;
/// Normals are cut if none is below this, if by depth this part of them should be, and if this part of those is as
/// depth and the cut make them.
constexpr double kBelowZero = -1.0 / 256, kLeastNeeded = 0.02, kLeastCut = 0.8;

class NormalSettlement : private Settlement {
 public:
  NormalSettlement(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                   std::span<const float> normal)
      : Settlement(source, settings, depth, normal, RawPlane::normal) {}

  void run() {
    settle_encoding();
    settle_space();
  }

 private:
  static const char* name_of(NormalEncoding encoding, bool unorm) {
    if (encoding == NormalEncoding::octahedral) return "octahedral";
    if (encoding == NormalEncoding::spheremap) return "spheremap";
    return unorm ? "unorm" : "signed";
  }

  std::vector<NormalScore> scores_of(NormalEncoding encoding, bool unorm) const {
    return score_normals({normal_, encoding, unorm, depth_, depth_map_of(source_)}, source_.camera, view_);
  }

  static bool agrees(const NormalScore& score) {
    return score.explained() >= kLeastAgreement && score.angle <= kLargestAngle;
  }

  void settle_encoding() {
    const bool is_open = source_.normal_encoding_open;
    const NormalStatistics n = normal_statistics(normal_, depth_, depth_map_of(source_), kSparse);
    if (!is_open) doubt_encoding(n);
    has_any_ = n.count > 0 || normal_statistics(normal_, depth_, depth_map_of(source_)).count > 0;
    has_negative_ = n.least < kBelowZero;
    const bool in_unit_range = n.count && n.least >= 0 && n.most <= 1;
    const NormalEncoding said = source_.normal_encoding;
    std::string why = source_[RawPlane::normal].size() == 2
                          ? fmt::format("all in {:.2g} to {:.2g}", n.least, n.most)
                          : fmt::format("of unit length on {:.0f} %", 100 * n.unit_share);
    if (said == NormalEncoding::octahedral || said == NormalEncoding::spheremap ||
        source_[RawPlane::normal].size() == 2) {
      source_.normal_unorm =
          said == NormalEncoding::unorm || (in_unit_range && (is_open || said != NormalEncoding::signed_float));
    } else {
      const bool is_unorm =
          is_open && in_unit_range && n.unorm_unit_share > 0.5 && n.unit_share < 0.5 * n.unorm_unit_share;
      if (is_unorm)
        why = fmt::format("all in 0 to 1, and 2 n - 1 is of unit length on {:.0f} %", 100 * n.unorm_unit_share);
      source_.normal_unorm = is_unorm || said == NormalEncoding::unorm;
    }
    if (has_lengths(source_)) refuse_altered(n);
    const double unit = source_.normal_unorm ? n.unorm_unit_share : n.unit_share;
    const double otherwise = source_.normal_unorm ? n.unit_share : n.unorm_unit_share;
    const bool tells = has_lengths(source_) && std::max(unit, otherwise) > kUnit;
    const bool differs = !tells && compare_encodings(in_unit_range, why);
    if (!is_open) return;
    const std::string name = name_of(source_.normal_encoding, source_.normal_unorm);
    if (tells && unit > kUnit && otherwise < kNotUnit)
      prove("normal encoding", name, why, "--normal-encoding", source_.normal_unorm);
    else
      guess("normal encoding", name, why, "--normal-encoding", differs || source_.normal_unorm);
  }

  /// Refuses vectors whose lengths show that they went through what is made for colours.
  void refuse_altered(const NormalStatistics& n) const {
    if (std::max(n.unit_share, n.unorm_unit_share) > kUnit || n.usual_share > kUnit) return;
    if (const auto what = alteration_of(normal_, depth_, depth_map_of(source_)))
      fail(ErrorKind::input, "{}: its normals ({}) are of unit length on {:.0f} % only: they look like {}; {}",
           normal_path(), channels(), 100 * n.unit_share, *what, kWithout);
  }

  /// Takes normals without any component below 0 where by depth there should be some: what was lost is not in the file.
  /// Returns whether they are such.
  bool settle_cut(const std::vector<NormalScore>& scores) {
    if (has_negative_ || !has_lengths(source_) || source_.normal_unorm || source_.camera_is_assumed) return false;
    const NormalScore* as = nullptr;
    CutScore best;
    for (const auto& score : scores) {
      if (to_string(score.flips) != "none" || (!source_.normal_space_open && score.space != source_.normal_space))
        continue;
      const auto cut = score_cut(score.space, planes(), source_.camera, view_);
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
    if (as->explained() < kLeastAgreement) fail(ErrorKind::input, "{}: {}; {}", normal_path(), why, kWithout);
    if (source_.normal_space_open) {
      source_.normal_space = as->space;
      guess("normal space", name_of(as->space), text_of(*as), "--normal-space", false);
    }
    note(NoteCode::cut_normals, why + "; " + kWithout);
    return true;
  }

  /// As "N.X, N.Y, N.Z".
  std::string channels() const {
    std::string names;
    for (const auto& channel : source_[RawPlane::normal]) names += (names.empty() ? "" : ", ") + channel.channel;
    return names;
  }

  /// If the normals do not agree with depth, and do so much better in another encoding, that one is chosen where nobody
  /// says one, and else noted. Returns whether it was chosen.
  bool compare_encodings(bool in_unit_range, std::string& why) {
    const auto scores = scores_of(source_.normal_encoding, source_.normal_unorm);
    if (scores.empty() || agrees(scores[0])) return false;
    std::optional<std::pair<NormalEncoding, double>> best;
    for (const auto encoding : {NormalEncoding::signed_float, NormalEncoding::octahedral, NormalEncoding::spheremap}) {
      const auto others = scores_of(encoding, in_unit_range);
      if (others.empty() || !agrees(others[0]) || (best && others[0].angle >= best->second)) continue;
      if (kClear * others[0].angle < scores[0].angle || scores[0].agreement < kAsGood * others[0].agreement)
        best = {encoding, others[0].angle};
    }
    if (!best) return false;
    why = fmt::format(
        "as {} the best quarter of the normals agrees with depth within {:.1f} degrees, as {} within {:.1f}, and "
        "{:.0f} % agree at all",
        name_of(best->first, in_unit_range), best->second, name_of(source_.normal_encoding, source_.normal_unorm),
        scores[0].angle, 100 * scores[0].agreement);
    if (!source_.normal_encoding_open) {
      note(NoteCode::said_otherwise, why + ": is --normal-encoding right?");
      return false;
    }
    source_.normal_encoding = best->first;
    source_.normal_unorm = in_unit_range;
    return true;
  }

  /// Notes where the lengths of the normals speak against the encoding that is said.
  void doubt_encoding(const NormalStatistics& n) {
    if (source_[RawPlane::normal].size() != 3) return;
    const bool is_signed = n.unit_share > kUnit && n.unorm_unit_share < kNotUnit;
    const bool is_unorm = n.unorm_unit_share > kUnit && n.unit_share < kNotUnit;
    if (is_signed && source_.normal_encoding != NormalEncoding::signed_float)
      note(NoteCode::said_otherwise,
           fmt::format("the normals are signed vectors by their lengths (of 1 on {:.0f} %), and --normal-encoding or "
                       "the camera file says otherwise",
                       100 * n.unit_share));
    if (is_unorm && source_.normal_encoding == NormalEncoding::signed_float)
      note(NoteCode::said_otherwise,
           fmt::format("2 n - 1 of the normals is of unit length on {:.0f} %: are they unorm (--normal-encoding)?",
                       100 * n.unorm_unit_share));
  }

  NormalPlanes planes() const {
    return {normal_, source_.normal_encoding, source_.normal_unorm, depth_, depth_map_of(source_)};
  }

  void settle_space() {
    const bool has_world = source_.camera.view_from_world.has_value();
    // The usual reading, and that of view space where the camera knows no world.
    const bool has_usual = has_world || source_.usual_normal_space == NormalSpace::view;
    if (!has_any_) {
      source_.has_evidence = false;
      if (source_.normal_space_open) source_.normal_space = has_usual ? source_.usual_normal_space : NormalSpace::view;
      return;
    }
    const auto all_scores = score_normals(planes(), source_.camera, view_);
    if (settle_cut(all_scores)) return;
    if (!source_.normal_space_open) return doubt_normals(all_scores);
    const std::string given = to_string(settings_.flip_normal);
    auto scores = all_scores;
    if (given != "none") std::erase_if(scores, [&](const auto& s) { return to_string(s.flips) != given; });
    const NormalScore* plain =
        reading_of(scores, has_usual ? source_.usual_normal_space : NormalSpace::view, settings_.flip_normal);
    const bool tells = plain && best_of(scores).explained() >= kLeastAgreement;
    if (!tells) {
      source_.has_evidence = false;
      if (!has_usual) refuse_without_matrix(scores);
      source_.normal_space = source_.usual_normal_space;
      guess("normal space", name_of(source_.normal_space), "the frame does not tell", "--normal-space", false);
      return doubt_normals(all_scores);
    }
    const bool is_plain = explains(*plain, scores);
    // By a camera along an axis of the world, normals in view space look like those of a turned world.
    if (!is_plain && has_usual) refuse_turned_camera(*plain, kSharper * scores[0].close);
    const NormalScore& best = is_plain ? *plain : best_of(scores);
    const NormalScore* straighter = straighter_than(best, scores);
    if (!straighter && !is_plain) refuse_ambiguous(best, scores);
    if (!has_world && !source_.camera_is_assumed) refuse_turned_world(best);
    take(straighter ? *straighter : best, straighter ? turn_of(*straighter, best) : text_of(best), has_world);
    doubt_normals(all_scores);
  }

  /// Takes a reading, and says so where it is not the usual one, or where no matrix would turn normals of the world.
  void take(const NormalScore& score, const std::string& why, bool has_world) {
    source_.normal_space = score.space;
    source_.flip_normal = score.flips;
    const bool is_flipped = to_string(score.flips) != to_string(settings_.flip_normal);
    const bool is_proven = score.close > kUnit && !has_coarse_depth(source_);
    guess("normal space", name_of(score.space), why,
          is_flipped || !has_world ? "--normal-space with --flip-normal" : "--normal-space",
          score.space != source_.usual_normal_space || is_flipped, is_proven);
  }

  /// Refuses a reading where one in the other space does about as well.
  void refuse_ambiguous(const NormalScore& best, const std::vector<NormalScore>& scores) const {
    const auto other = std::ranges::find_if(scores, [&](const auto& s) { return s.space != best.space; });
    if (other == scores.end() || other->agreement < kAsGood * best.explained() || is_straighter(best, *other)) return;
    fail(ErrorKind::input,
         "{}: its normals may be in {} or in {} space ({}; {}): say which with --normal-space, and --flip-normal",
         normal_path(), name_of(best.space), name_of(other->space), text_of(best), text_of(*other));
  }

  /// Refuses normals that are read in view space where they look like those of a world that nothing turns.
  void refuse_turned_world(const NormalScore& score) const {
    if (source_.usual_normal_space == NormalSpace::view) return;
    if (const auto turned = turned_world(score))
      fail(ErrorKind::input, "{}: {}: give a --camera file with world_to_camera; {}", normal_path(), *turned, kWithout);
  }

  static const NormalScore* reading_of(const std::vector<NormalScore>& scores, NormalSpace space,
                                       const NormalFlips& flips) {
    const auto found = std::ranges::find_if(
        scores, [&](const auto& s) { return s.space == space && to_string(s.flips) == to_string(flips); });
    return found == scores.end() ? nullptr : &*found;
  }

  /// Whether a reading does as well as any, if need be with the normals of the other side turned round: they are a
  /// fault of some objects, and flips are one of all.
  static bool explains(const NormalScore& score, const std::vector<NormalScore>& scores) {
    return score.agreement >= kNoBetter * scores[0].agreement || explains_most(score, scores);
  }
  static bool explains_most(const NormalScore& score, const std::vector<NormalScore>& scores) {
    const double most = std::ranges::max_element(scores, {}, &NormalScore::explained)->explained();
    return score.explained() >= kAsMany * most && score.agreement >= kLeastOwn * score.explained();
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

  /// Whether one reading has nothing of a turn that the normals as a whole have by the other, as those of a camera that
  /// is turned by little have in the wrong space.
  bool is_straighter(const NormalScore& score, const NormalScore& other) const {
    const double least = !has_coarse_depth(source_) ? kLeastTurn : kLeastTurnOfHalf;
    return other.turn_degrees() > least && kClear * score.turn_degrees() < other.turn_degrees() &&
           score.explained() >= kNoBetter * other.explained();
  }

  /// The same reading in the other space, where it is straighter.
  const NormalScore* straighter_than(const NormalScore& score, const std::vector<NormalScore>& scores) const {
    const auto other = score.space == NormalSpace::world ? NormalSpace::view : NormalSpace::world;
    const NormalScore* reading = reading_of(scores, other, score.flips);
    return reading && is_straighter(*reading, score) ? reading : nullptr;
  }

  static std::string turn_of(const NormalScore& chosen, const NormalScore& other) {
    return fmt::format(
        "as those of {} space the normals as a whole are turned by {:.1f} degrees against depth, as {} "
        "by {:.1f}",
        name_of(other.space), other.turn_degrees(), name_of(chosen.space), chosen.turn_degrees());
  }

  /// Where no matrix places the camera, tells whether normals that are read in view space are those of a world in which
  /// it is turned by little.
  std::optional<std::string> turned_world(const NormalScore& score) const {
    const double least = !has_coarse_depth(source_) ? kClearTurn : kLeastTurnOfHalf;
    if (source_.camera.view_from_world || score.space != NormalSpace::view || score.turn_degrees() < least)
      return std::nullopt;
    const auto turned = slightly_turned_camera(planes(), score, source_.camera, view_);
    if (!turned) return std::nullopt;
    const NormalScore& then = turned->score;
    if (then.close <= kSharper * score.close && (score.angle <= kLargestAngle || kClear * then.angle >= score.angle))
      return std::nullopt;
    const auto width = best_other_width(planes(), score, source_.camera, view_);
    if (width && width->score.close >= then.close) return std::nullopt;
    return fmt::format(
        "its normals look like those of world space by {}: {:.0f} % of them agree with depth to 3 degrees then, {:.0f} "
        "% in view space",
        turned->what, 100 * then.close, 100 * score.close);
  }

  /// Refuses normals that are not those of view space where no matrix turns those of the world.
  [[noreturn]] void refuse_without_matrix(const std::vector<NormalScore>& scores) const {
    if (!source_.rules_by.empty()) fail(ErrorKind::input, "{}: {}", normal_path(), kWorldWithoutMatrix);
    fail(
        ErrorKind::input,
        "{}: {:.0f} % of its normals at most agree with depth in view space; those of world space need a --camera file "
        "with world_to_camera; where they are in view space, {}; {}",
        normal_path(), scores.empty() ? 0 : 100 * scores[0].agreement, kCheck, kWithout);
  }

  static const char* name_of(NormalSpace space) { return space == NormalSpace::world ? "world" : "view"; }
  static const char* name_of(DepthKind kind) { return alcove::name_of(kind); }
  static std::string text_of(const NormalScore& s) {
    return fmt::format("{} with flips {}: {:.0f} % agree with depth, {:.0f} % face the camera{}", name_of(s.space),
                       to_string(s.flips), 100 * s.agreement, 100 * s.facing,
                       s.opposite < 0.005 ? "" : fmt::format(", {:.0f} % are opposite to depth", 100 * s.opposite));
  }

  /// Notes where depth speaks against the normals as they are read, and refuses what it refutes.
  void doubt_normals(const std::vector<NormalScore>& scores) {
    if (source_.camera_is_assumed) return;
    const NormalScore* chosen = reading_of(scores, source_.normal_space, source_.flip_normal);
    if (!chosen) return;
    const NormalScore* straighter = straighter_than(*chosen, scores);
    if (straighter)
      return note(NoteCode::normals_disagree,
                  fmt::format("normals are read as {}; better fits {}: {} ({})", text_of(*chosen), text_of(*straighter),
                              turn_of(*straighter, *chosen), kSpaceOptions));
    note_other_cause(*chosen, scores);
    doubt_centre(*chosen);
    if (doubt_rotation(*chosen)) return;
    if (chosen->explained() < kLeastAgreement || chosen->agreement < kRefuted) refuse_normals(*chosen, scores[0]);
    if (scores[0].agreement >= kLeastAgreement && !explains(*chosen, scores))
      note(NoteCode::normals_disagree, fmt::format("normals are read as {}; better fits {} ({})", text_of(*chosen),
                                                   text_of(scores[0]), kSpaceOptions));
    else if (chosen->explained() < kLeastAgreement)
      note(NoteCode::normals_disagree, fmt::format("only {:.0f} % of the normals agree with depth, read as {}: {}",
                                                   100 * chosen->agreement, text_of(*chosen), kCheck));
    else if (const auto turned = turned_world(*chosen))
      note(NoteCode::normals_disagree, fmt::format("{} ({})", *turned, kSpaceOptions));
    else if (!doubt_width(*chosen) && !agrees(*chosen) && !has_coarse_depth(source_))
      note(NoteCode::normals_disagree,
           fmt::format("even the best quarter of the normals is up to {:.1f} degrees off those of depth: {}",
                       chosen->angle, kCheck));
  }

  /// Notes that normals which are turned round may be those of a flipped axis: depth fits both ways alike.
  void note_other_cause(const NormalScore& chosen, const std::vector<NormalScore>& scores) {
    const auto other = std::ranges::find_if(
        scores, [&](const auto& s) { return s.space == chosen.space && s.agreement >= kAsMany * chosen.explained(); });
    if (other == scores.end() || chosen.agreement >= kAsMany * other->agreement) return;
    note(
        NoteCode::turned_normals,
        fmt::format("{:.0f} % of the normals are opposite to depth and are turned round, as for mirrored things; where "
                    "an axis of all normals is flipped, as DirectX has it, give --flip-normal {}",
                    100 * chosen.opposite, to_string(other->flips)));
  }

  /// Whether one camera fits so much better than another that it is no chance.
  static bool is_sharper(const NormalScore& other, const NormalScore& score) {
    return other.close >= kLeastClose && other.close > kSharper * score.close &&
           other.close > score.close + kLeastSharper;
  }

  /// Refuses normals that hardly agree with depth, where another reading or another camera has clearly more of them
  /// agree, or where nothing is left that could be right.
  void refuse_normals(const NormalScore& chosen, const NormalScore& best) const {
    refuse_turned_camera(chosen, best.close);
    const std::string read = fmt::format("{}: its normals, read as {}, are not those of this depth and this camera",
                                         normal_path(), text_of(chosen));
    if (best.agreement >= kLeastAgreement && best.agreement > kClear * chosen.agreement)
      fail(ErrorKind::input, "{}: as {} ({}); {}", read, text_of(best), kSpaceOptions, kWithout);
    // Coarse depth turns the normals of depth themselves by so much.
    if (chosen.explained() < kRefuted && !has_coarse_depth(source_))
      fail(ErrorKind::input, "{}, nor in any other space: {}; {}", read, kCheck, kWithout);
  }

  /// Refuses the camera where the normals agree with depth by one that is turned in a usual way, and by the given one
  /// do not. `sharpest` is the share that another reading of the normals brings close.
  void refuse_turned_camera(const NormalScore& chosen, double sharpest) const {
    const auto turned = best_turned_camera(planes(), chosen, source_.camera, view_);
    if (!turned || turned->score.agreement < kLeastAgreement || turned->score.close < sharpest ||
        turned->score.agreement < kClear * chosen.agreement)
      return;
    fail(ErrorKind::input,
         "{}: the camera{} does not fit: by it {:.0f} % of the normals in {} space agree with depth; {}, then {:.0f} % "
         "agree; {}",
         normal_path(), from(), 100 * chosen.agreement, name_of(chosen.space), turned->what,
         100 * turned->score.agreement, kWithout);
  }

  /// Refuses a principal point that fits elsewhere, and says where no pixel can tell.
  void doubt_centre(const NormalScore& chosen) {
    if (!is_off_centre(source_.camera)) return;
    const auto other = best_other_point(planes(), chosen, source_.camera, view_);
    if (!other) return;
    if (is_sharper(other->score, chosen))
      fail(ErrorKind::input,
           "{}: the camera{} does not fit: by it {:.0f} % of the normals agree with depth to 3 degrees; {}, then "
           "{:.0f} % do; {}",
           normal_path(), from(), 100 * chosen.close, other->what, 100 * other->score.close, kWithout);
    if (is_sharper(chosen, other->score)) return;
    note_centre(source_);
  }

  /// Notes where the angles of a .chan file fit better in another order. Returns whether they do.
  bool doubt_rotation(const NormalScore& chosen) {
    const auto other = best_other_rotation(planes(), chosen, source_.camera, view_);
    if (!other || !is_sharper(other->score, chosen) || chosen.agreement < kLeastAgreement) return false;
    note(NoteCode::normals_disagree,
         fmt::format("by the camera{} {:.0f} % of the normals agree with depth to 3 degrees; {}, then {:.0f} % do",
                     from(), 100 * chosen.close, other->what, 100 * other->score.close));
    return true;
  }

  /// Notes where another field of view fits better, as it also may where the depth is read wrongly. Returns whether it
  /// does.
  bool doubt_width(const NormalScore& chosen) {
    if (chosen.close >= kSurelyClose) return false;
    const auto other = best_other_width(planes(), chosen, source_.camera, view_);
    if (!other || !is_sharper(other->score, chosen)) return false;
    note(NoteCode::field_of_view,
         fmt::format("{} fits the normals better: {:.0f} % of them agree with depth to 3 degrees then, {:.0f} % as it "
                     "is given: {}",
                     other->what, 100 * other->score.close, 100 * chosen.close, kCheck));
    return true;
  }

  /// Names the file of the camera, or the header's attributes.
  std::string from() const {
    if (!source_.camera_from.empty()) return " of " + source_.camera_from;
    return settings_.camera.empty() ? std::string() : " " + settings_.camera;
  }

  static constexpr const char* kSpaceOptions = "--normal-space, --flip-normal";
  static constexpr const char* kWithout = "--normal none reconstructs them from depth";

  static constexpr const char* kCheck =
      "check --normal-space, --normal-encoding, --depth-kind with --near, --far and --reversed-z, and --camera, "
      "--chan-rotation or --fov: "
      "it may also be the camera of another frame";

  bool has_any_ = true;        // a normal that is no sky's
  bool has_negative_ = false;  // of the normals' components as they stand in the file, any
};

}  // namespace

void note_centre(FrameSource& source) {
  // What a renderer writes into headers is its own camera.
  if (source.camera_is_assumed || !source.camera_from.empty() || !is_off_centre(source.camera)) return;
  source.notes.push_back(
      {NoteCode::principal_point,
       fmt::format("the principal point is at ({:.6g}, {:.6g}) of {} x {} pixels, and no pixel shows whether it is on "
                   "the right side of the centre",
                   source.camera.cx, source.camera.cy, source.camera.width, source.camera.height)});
}

void settle_normals(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                    std::span<const float> normal) {
  NormalSettlement(source, settings, depth, normal).run();
}

}  // namespace alcove
