// Scores the ways in which a frame's normals may be read, chooses one, and refuses what depth and camera refute.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/error.h"
#include "core/frame/evidence.h"
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
/// If this part of the normals has unit length, they are vectors.
constexpr double kUnit = 0.9;

class NormalSettlement : private Settlement {
 public:
  using Settlement::Settlement;

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
    return score.agreement >= kLeastAgreement && score.angle <= kLargestAngle;
  }

  void settle_encoding() {
    const bool is_open = source_.normal_encoding_open;
    const NormalStatistics n = normal_statistics(normal_, depth_, depth_map_of(source_), kSparse);
    if (!is_open) doubt_encoding(n);
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
    const bool tells = source_[RawPlane::normal].size() == 3 && std::max(n.unit_share, n.unorm_unit_share) > kUnit;
    const bool differs = !tells && compare_encodings(in_unit_range, why);
    if (is_open)
      guess("normal encoding", name_of(source_.normal_encoding, source_.normal_unorm), why, "--normal-encoding",
            differs || source_.normal_unorm);
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
      source_.notes.push_back({NoteCode::said_otherwise, why + ": is --normal-encoding right?"});
      return false;
    }
    source_.normal_encoding = best->first;
    source_.normal_unorm = in_unit_range;
    return true;
  }

  /// Notes where the lengths of the normals speak against the encoding that is said.
  void doubt_encoding(const NormalStatistics& n) {
    constexpr double kFew = 0.5;  // of the normals
    if (source_[RawPlane::normal].size() != 3) return;
    const bool is_signed = n.unit_share > kUnit && n.unorm_unit_share < kFew;
    const bool is_unorm = n.unorm_unit_share > kUnit && n.unit_share < kFew;
    if (is_signed && source_.normal_encoding != NormalEncoding::signed_float)
      source_.notes.push_back(
          {NoteCode::said_otherwise,
           fmt::format("the normals are signed vectors by their lengths (of 1 on {:.0f} %), and --normal-encoding or "
                       "the camera file says otherwise",
                       100 * n.unit_share)});
    if (is_unorm && source_.normal_encoding == NormalEncoding::signed_float)
      source_.notes.push_back(
          {NoteCode::said_otherwise,
           fmt::format("2 n - 1 of the normals is of unit length on {:.0f} %: are they unorm (--normal-encoding)?",
                       100 * n.unorm_unit_share)});
  }

  NormalPlanes planes() const {
    return {normal_, source_.normal_encoding, source_.normal_unorm, depth_, depth_map_of(source_)};
  }

  void settle_space() {
    const bool has_world = source_.camera.view_from_world.has_value();
    const bool usually_view = source_.usual_normal_space == NormalSpace::view;
    const auto all_scores = score_normals(planes(), source_.camera, view_);
    if (!source_.normal_space_open) return doubt_normals(all_scores);
    const std::string given = to_string(settings_.flip_normal);
    auto scores = all_scores;
    if (given != "none") std::erase_if(scores, [&](const auto& s) { return to_string(s.flips) != given; });
    const auto usual = std::ranges::find_if(
        scores, [&](const auto& s) { return s.space == source_.usual_normal_space && to_string(s.flips) == given; });
    const bool tells = !scores.empty() && scores[0].agreement >= kLeastAgreement;
    if (!tells) source_.has_evidence = false;
    if ((has_world || usually_view) && (!tells || usual->agreement >= kNoBetter * scores[0].agreement)) {
      source_.normal_space = source_.usual_normal_space;
      guess("normal space", name_of(source_.normal_space), tells ? text_of(*usual) : "the frame does not tell",
            "--normal-space", false);
      return doubt_normals(all_scores);
    }
    if (!tells) refuse_without_matrix(scores);
    // By a camera along an axis of the world, normals in view space look like those of a turned world.
    if (usual != scores.end()) refuse_turned_camera(*usual, kSharper * scores[0].close);
    const auto other = std::ranges::find_if(scores, [&](const auto& s) { return s.space != scores[0].space; });
    if (other != scores.end() && other->agreement >= kAsGood * scores[0].agreement)
      fail(ErrorKind::input,
           "{}: its normals may be in {} or in {} space ({}; {}): say which with --normal-space, and --flip-normal",
           normal_path(), name_of(scores[0].space), name_of(other->space), text_of(scores[0]), text_of(*other));
    source_.normal_space = scores[0].space;
    source_.flip_normal = scores[0].flips;
    guess("normal space", name_of(source_.normal_space), text_of(scores[0]), "--normal-space with --flip-normal",
          source_.normal_space != source_.usual_normal_space || has_world || to_string(scores[0].flips) != "none");
    doubt_normals(all_scores);
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
    return fmt::format("{} with flips {}: {:.0f} % agree with depth, {:.0f} % face the camera", name_of(s.space),
                       to_string(s.flips), 100 * s.agreement, 100 * s.facing);
  }

  /// Notes where depth speaks against the normals as they are read, and refuses what it refutes.
  void doubt_normals(const std::vector<NormalScore>& scores) {
    if (source_.camera_is_assumed) return;
    const auto chosen = std::ranges::find_if(scores, [&](const auto& s) {
      return s.space == source_.normal_space && to_string(s.flips) == to_string(source_.flip_normal);
    });
    if (chosen == scores.end()) return;
    doubt_centre(*chosen);
    if (doubt_rotation(*chosen)) return;
    if (chosen->agreement < kLeastAgreement) refuse_normals(*chosen, scores[0]);
    const bool another = scores[0].agreement >= kLeastAgreement && chosen->agreement < kNoBetter * scores[0].agreement;
    if (another)
      note(NoteCode::normals_disagree, fmt::format("normals are read as {}; better fits {} ({})", text_of(*chosen),
                                                   text_of(scores[0]), kSpaceOptions));
    else if (chosen->agreement < kLeastAgreement)
      note(NoteCode::normals_disagree, fmt::format("only {:.0f} % of the normals agree with depth, read as {}: {}",
                                                   100 * scores[0].agreement, text_of(scores[0]), kCheck));
    else if (!doubt_width(*chosen) && !agrees(*chosen) && depth_rounding(source_) == kFloatRounding)
      note(NoteCode::normals_disagree,
           fmt::format("even the best quarter of the normals is up to {:.1f} degrees off those of depth: {}",
                       chosen->angle, kCheck));
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
    // Half floats turn the normals of depth themselves by so much.
    if (chosen.agreement < kRefuted && depth_rounding(source_) == kFloatRounding)
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
