// Holds normals against depth and camera.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"
#include "core/frame/settle/normal_settlement.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

/// From so many on the field of view is not doubted. With half or twice the right one it was 41 % at most.
constexpr double kSurelyClose = 0.5;

/// Degrees. By their own cameras the normals of 14 frames are turned as a whole by 0.2 at most, or do not fit better
/// once they are turned back.
constexpr double kOtherFrame = 0.3;

/// Whether nearly all normals look the same way, as in tangent space.
bool are_alike(const RawPart& raw, const DepthMap& map) {
  constexpr double kAlike = 0.98;  // length of the mean of the unit vectors
  const std::size_t pixels = raw.window.pixels(), step = even_step(raw.window, kNormalPixels);
  std::array<Vector3, 2> sums{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < pixels; i += step) {
    if (std::isinf(planar_depth(map, value_at(raw.depth, pixels, i), 1))) continue;
    std::size_t unorm = 0;
    for (Vector3& sum : sums) {
      const Vector3 n = decoded_normal(raw.normal, pixels, i, NormalEncoding::signed_float, unorm++ > 0);
      const double size = length(n);
      for (std::size_t c = 0; c < 3 && size > 0; c++) sum[c] += n[c] / size;
    }
    count++;
  }
  return std::ranges::any_of(sums, [&](const Vector3& sum) { return length(sum) > kAlike * double(count); });
}

class NormalDoubts : private NormalSettlement {
 public:
  explicit NormalDoubts(const NormalSettlement& normals) : NormalSettlement(normals) {}

  void run(const std::vector<NormalScore>& scores) {
    if (source_.open.camera) return;
    const NormalScore* chosen = score_of(scores, reading_.normal_space, reading_.flip_normal);
    if (!chosen) return;
    refuse_flips(*chosen, scores);
    const NormalScore* straighter = straighter_than(*chosen, scores);
    if (straighter)
      return note(NoteCode::normals_disagree,
                  fmt::format("normals are read as {}; better fits {}: {} ({})", text_of(*chosen), text_of(*straighter),
                              rotation_text(*straighter, *chosen), kSpaceOptions));
    note_other_cause(*chosen, scores);
    doubt_centre(*chosen);
    if (doubt_rotation(*chosen)) return;
    if (chosen->explained() < kLeastAgreement || chosen->agreement < kRefuted) refuse_normals(*chosen, scores);
    if (scores[0].agreement >= kLeastAgreement && !explains(*chosen, scores))
      note(NoteCode::normals_disagree, fmt::format("normals are read as {}; better fits {} ({})", text_of(*chosen),
                                                   text_of(scores[0]), kSpaceOptions));
    else if (chosen->explained() < kLeastAgreement)
      note(NoteCode::normals_disagree, fmt::format("only {:.0f} % of the normals agree with depth, read as {}: {}",
                                                   100 * chosen->agreement, text_of(*chosen), kCheck));
    else if (const auto turned = turned_world(*chosen))
      note(NoteCode::normals_disagree, fmt::format("{} ({})", *turned, kSpaceOptions));
    else if (const auto other = turned_back(*chosen))
      note(NoteCode::normals_disagree,
           fmt::format("by the camera{} all normals are turned by {:.2g} degrees against depth: the best quarter is up "
                       "to {:.2g} degrees off, turned back {:.2g}: the camera may be another frame's",
                       from(), chosen->turn_degrees(), chosen->angle, other->angle));
    else if (!doubt_width(*chosen) && !agrees(*chosen) && !has_coarse_depth(reading_))
      note(NoteCode::normals_disagree,
           fmt::format("even the best quarter of the normals is up to {:.1f} degrees off the normals of depth: {}",
                       chosen->angle, kCheck));
  }

 private:
  /// Notes that normals which are turned round may be those of a flipped axis: depth fits both ways alike.
  void note_other_cause(const NormalScore& chosen, const std::vector<NormalScore>& scores) {
    const auto other = std::ranges::find_if(
        scores, [&](const auto& s) { return s.space == chosen.space && s.agreement >= kAsMany * chosen.explained(); });
    // Where neither way fits, something else is wrong.
    if (chosen.explained() < kLeastAgreement) return;
    if (other == scores.end() || chosen.agreement >= kAsMany * other->agreement) return;
    note(NoteCode::turned_normals,
         fmt::format("{:.0f} % of the normals are opposite to depth and are turned round, as for mirrored things; if "
                     "an axis of all normals is flipped, as in DirectX, {}",
                     100 * chosen.opposite,
                     to_string(other->flips) == "none" ? "leave --flip-normal out"
                                                       : "give --flip-normal " + to_string(other->flips)));
  }

  /// Refuses normals that hardly agree with depth, where another reading or another camera has clearly more of them
  /// agree, or where nothing is left that could be right.
  void refuse_normals(const NormalScore& chosen, const std::vector<NormalScore>& scores) const {
    const NormalScore& best = scores[0];
    refuse_turned_camera(chosen, best.close);
    const std::string read =
        fmt::format("{}: its normals do not belong to this depth and this camera (as {})", path_, text_of(chosen));
    if (best.clearly_beats(chosen))
      fail(ErrorKind::input, "{}; but as {} ({}); {}", read, text_of(best), kSpaceOptions, kWithout);
    // Coarse depth turns the normals of depth themselves by so much.
    if (chosen.explained() >= kUsable || has_coarse_depth(reading_)) return;
    const bool is_tangent = are_alike(raw_, depth_map_of(reading_));
    if (chosen.explained() >= kRefuted && is_listed(NoteCode::normals_disagree, settings_.allow)) return;
    fail(ErrorKind::input, "{}; no other space fits{}: {}; {}{}", read,
         is_tangent ? ", but all look the same way, as in tangent space" : "", kCheck, kWithout,
         chosen.explained() >= kRefuted ? "; --set allow=normals-disagree takes them as they are" : "");
  }

  /// How the normals of a world agree by the camera that is turned by a little, where that is surely the right one.
  std::optional<NormalScore> turned_back(const NormalScore& chosen) const {
    if (chosen.space != NormalSpace::world) return std::nullopt;
    const auto other = straightened(chosen, kOtherFrame, 0);
    return other && other->score.close >= kSurelyClose && other->score.may_be_right() ? std::optional(other->score)
                                                                                      : std::nullopt;
  }

  /// Refuses flips that are given where the normals agree with depth by others, or by none.
  void refuse_flips(const NormalScore& chosen, const std::vector<NormalScore>& scores) const {
    if (to_string(settings_.flip_normal) == "none" || to_string(chosen.flips) == "none") return;
    const NormalScore& best =
        *std::ranges::find_if(scores, [&](const NormalScore& s) { return s.space == chosen.space; });
    if (best.agreement < kLeastAgreement || chosen.agreement >= kAsGood * best.agreement) return;
    // Things may be mirrored, unless others explain all of them without that.
    const bool may_be_mirrored = explains_most(chosen, scores) && chosen.agreement >= kRefuted;
    if (may_be_mirrored && best.agreement < kAsMany * chosen.explained()) return;
    const std::string flips = to_string(best.flips);
    fail(ErrorKind::input,
         "{}: --flip-normal {} does not fit: with it {:.0f} % of the normals agree with depth, {} {:.0f} %: {}", path_,
         to_string(settings_.flip_normal), 100 * chosen.agreement,
         flips == "none" ? "without it" : "with --flip-normal " + flips, 100 * best.agreement,
         flips == "none" ? "leave it out" : "give that");
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
           path_, from(), 100 * chosen.close, other->what, 100 * other->score.close, kWithout);
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

  /// Notes where the normals show square pixels, and better than another field of view explains them. Returns whether
  /// they do.
  bool doubt_aspect(const NormalScore& chosen, const std::optional<OtherCamera>& width) {
    const auto square = square_pixels(planes(), chosen);
    if (reading_.pixel_aspect == 1 || !square || !is_sharper(*square, chosen)) return false;
    if (width && width->score.close >= square->close) return false;
    note(NoteCode::said_otherwise,
         fmt::format(
             "the frame's pixelAspectRatio is {:.4g}, but with square pixels {:.0f} % of the normals agree with depth "
             "to 3 degrees, as it is {:.0f} %; write the file with pixelAspectRatio 1, or give --camera with fx = fy",
             reading_.pixel_aspect, 100 * square->close, 100 * chosen.close));
    return true;
  }

  /// Notes where another field of view fits better, as it also may where the depth is read wrongly. Returns whether it
  /// does.
  bool doubt_width(const NormalScore& chosen) {
    // By depth that counts from elsewhere, or along a curve, another lens may seem to fit.
    if (chosen.close >= kSurelyClose || speaks_against(seen_.curve, reading_)) return false;
    const auto other = best_other_width(planes(), chosen);
    if (doubt_aspect(chosen, other)) return true;
    if (!other || !is_sharper(other->score, chosen)) return false;
    note(
        NoteCode::field_of_view,
        fmt::format(
            "{} fits the normals better: with it {:.0f} % of them agree with depth to 3 degrees, as given {:.0f} %: {}",
            other->what, 100 * other->score.close, 100 * chosen.close, kCheck));
    return true;
  }
};

}  // namespace

void NormalSettlement::refuse_turned_camera(const NormalScore& chosen, double sharpest) const {
  const auto turned = best_turned_camera(planes(), chosen);
  if (!turned || turned->score.close < sharpest || turned->score.agreement < kClear * chosen.agreement) return;
  fail(ErrorKind::input,
       "{}: the camera{} does not fit: by it {:.0f} % of the normals in {} space agree with depth; {}, then {:.0f} % "
       "agree; {}",
       path_, from(), 100 * chosen.agreement, word_of(chosen.space), turned->what, 100 * turned->score.agreement,
       kWithout);
}

void doubt_normals(const NormalSettlement& normals, const std::vector<NormalScore>& scores) {
  NormalDoubts(normals).run(scores);
}

}  // namespace alcove
