// Holds normals against depth and camera.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/settle/normal_settlement.h"
#include "core/frame/settle/other_cameras.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

/// And if so many are close at least. Of the right cameras of 13 frames the least is 38 %.
constexpr double kLeastClose = 0.3;
/// From so many on the field of view is not doubted. With half or twice the right one it was 41 % at most.
constexpr double kSurelyClose = 0.5;

class NormalDoubts : private NormalSettlement {
 public:
  using NormalSettlement::NormalSettlement;

  /// Notes normals that depth speaks against, and refuses normals that it refutes.
  void run(const std::vector<NormalScore>& scores) {
    if (source_.open.camera) return;
    const NormalScore* chosen = score_of(scores, reading_.normal_space, reading_.flip_normal);
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
    else if (!doubt_width(*chosen) && !agrees(*chosen) && !has_coarse_depth(reading_))
      note(NoteCode::normals_disagree,
           fmt::format("even the best quarter of the normals is up to {:.1f} degrees off those of depth: {}",
                       chosen->angle, kCheck));
  }

  /// Refuses the camera where the normals agree with depth by one that is turned in a usual way, and by the given one
  /// do not. `sharpest` is the share that another reading of the normals brings close.
  void refuse_turned_camera(const NormalScore& chosen, double sharpest) const {
    const auto turned = best_turned_camera(planes(), chosen);
    if (!turned || turned->score.agreement < kLeastAgreement || turned->score.close < sharpest ||
        turned->score.agreement < kClear * chosen.agreement)
      return;
    fail(ErrorKind::input,
         "{}: the camera{} does not fit: by it {:.0f} % of the normals in {} space agree with depth; {}, then {:.0f} % "
         "agree; {}",
         normal_path(), from(), 100 * chosen.agreement, word_of(chosen.space), turned->what,
         100 * turned->score.agreement, kWithout);
  }

 private:
  /// Notes that normals which are turned round may be those of a flipped axis: depth fits both ways alike.
  void note_other_cause(const NormalScore& chosen, const std::vector<NormalScore>& scores) {
    const auto other = std::ranges::find_if(
        scores, [&](const auto& s) { return s.space == chosen.space && s.agreement >= kAsMany * chosen.explained(); });
    if (other == scores.end() || chosen.agreement >= kAsMany * other->agreement) return;
    note(NoteCode::turned_normals,
         fmt::format("{:.0f} % of the normals are opposite to depth and are turned round, as for mirrored things; if "
                     "an axis of all normals is flipped, as in DirectX, give --flip-normal {}",
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
    if (chosen.explained() < kRefuted && !has_coarse_depth(reading_))
      fail(ErrorKind::input, "{}, nor in any other space: {}; {}", read, kCheck, kWithout);
  }

  /// Refuses a principal point that fits elsewhere, and says where no pixel can tell.
  void doubt_centre(const NormalScore& chosen) {
    if (!is_off_centre(reading_.camera)) return;
    const auto other = best_other_point(planes(), chosen);
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
    const auto other = best_other_rotation(planes(), chosen);
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
    const auto other = best_other_width(planes(), chosen);
    if (!other || !is_sharper(other->score, chosen)) return false;
    note(NoteCode::field_of_view,
         fmt::format("{} fits the normals better: {:.0f} % of them agree with depth to 3 degrees then, {:.0f} % as it "
                     "is given: {}",
                     other->what, 100 * other->score.close, 100 * chosen.close, kCheck));
    return true;
  }
};

}  // namespace

void refuse_turned_camera(const Settlement& settlement, const NormalScore& chosen, double sharpest) {
  NormalDoubts(settlement).refuse_turned_camera(chosen, sharpest);
}

void doubt_normals(const Settlement& settlement, const std::vector<NormalScore>& scores) {
  NormalDoubts(settlement).run(scores);
}

}  // namespace alcove
