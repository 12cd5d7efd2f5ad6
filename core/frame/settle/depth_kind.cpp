// Decides the kind of depth that nobody says.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/settle/settlement.h"

namespace alcove {
namespace {

/// The normals decide between distances and 1/z if so many times as many agree with one of them.
constexpr double kClearNormals = 1.5;

class DepthKindSettlement : private DepthSettlement {
 public:
  explicit DepthKindSettlement(const DepthSettlement& depth)
      : DepthSettlement(depth), usual_(facts_.program.depth_kind) {}

  void run() {
    if (is_between_planes(usual_) && values_.all.least >= 0 && values_.all.most <= 1)
      return take_usual("all in 0 to 1");
    if (is_between_planes(usual_)) usual_ = reading_.depth_kind = DepthKind::planar;
    refuse_signs();
    const auto& scores = seen_.depth_scores;
    const bool tells = !scores.empty() && scores[0].straight >= kLeastStraight;
    if (!tells) seen_.tells = false;
    if (tells || usual_ != DepthKind::inverse) refuse_fractions();
    if (tells) return take_flattest(scores);
    const std::string why =
        scores.empty() ? "too little of the frame is smooth to tell" : "no flat surfaces decide: " + text_of(scores);
    if (take_by_positions(why) || take_by_normals(why)) return;
    if (usual_ == DepthKind::inverse) return assume_passed_on(why);
    take_usual(why);
    if (!facts_.program.is_said() || facts_.program.rules->depth_kind == DepthKind::automatic) note_assumption(why);
  }

 private:
  /// Depth within 0 to 1 is more often the part of a range than a distance, and no pixel shows the length of the range.
  /// It is refused if nothing supports distances, and noted if straight lines do, since z / far has them too.
  void refuse_fractions() {
    if (!is_fraction()) return;
    const auto& scores = seen_.depth_scores;
    const double straight = scores.empty() ? 0 : scores[0].straight, from_1 = straightness_from_1();
    if (from_1 >= kLeastStraight && from_1 > kClear * straight)
      fail(ErrorKind::input,
           "{}: {}, and flat surfaces are straight on {:.0f} % as 1 - depth, on {:.0f} % as depth: it is normalized, "
           "with 1 at the eye: give {}; if it is a distance all the same, give --depth-kind planar",
           path_, text_of_range(), 100 * from_1, 100 * straight, normalized_line(true));
    const bool is_supported = straight >= kSurelyStraight;
    const bool is_inverse =
        straight >= kLeastStraight && scores[0].kind == DepthKind::inverse && straight >= kClear * scores[1].straight;
    if (facts_.program.rules->depth_kind != DepthKind::automatic && !is_supported && !is_inverse)
      return note_fractions();
    if (facts_.program.rules->depth_kind != DepthKind::automatic || is_inverse) return;
    refuse_plateau();
    if (!is_supported)
      fail(ErrorKind::input,
           "{}: {}, and no flat surfaces show that these are distances: if it is 0 at the eye, give {}; if it is 1 at "
           "the eye, {}; if it is a distance, --depth-kind planar; if it is 1/z, --depth-kind inverse; if it is a "
           "z-buffer, --depth-kind device with --near and --far{}",
           path_, text_of_range(), normalized_line(false), normalized_line(true), kDisparityHint);
    refuse_before_near_plane();
    note_fractions();
  }

  /// It is all that is said where the program is known to write distances: those of a macro scene are below 1.
  void note_fractions() {
    if (!is_distance(usual_)) return;
    note(NoteCode::depth_below_1,
         fmt::format("{} and is read as distances of less than 1 scene unit; if it is normalized, give {}",
                     text_of_range(), normalized_line(false)));
  }

  /// No surface is seen that is nearer than the near plane, so the depth of such is no distance.
  void refuse_before_near_plane() const {
    constexpr double kMostNearer = 0.01;  // of the surfaces: matrices and planes are rounded
    if (!reading_.camera.near) return;
    const double near = 0.99 * *reading_.camera.near / reading_.depth_scale;
    std::size_t count = 0, nearer = 0;
    for (std::size_t i = 0; i < raw_.depth.size(); i += values_.step)
      if (raw_.depth[i] > 0 && raw_.depth[i] < settings_.sky) count++, nearer += raw_.depth[i] < near;
    if (double(nearer) <= kMostNearer * double(count)) return;
    fail(ErrorKind::input,
         "{}: {}, and {:.0f} % of it is nearer than the camera's near plane at {:.3g}, so these are no distances: if "
         "they are normalized, give {}; if they are distances all the same, give --depth-kind planar",
         path_, text_of_range(), 100 * double(nearer) / double(count), *reading_.camera.near, normalized_line(false));
  }

  /// A background of exactly 1 behind depths of 0 to 1 is the far end of a range.
  void refuse_plateau() const {
    if (values_.all.least < 0 || values_.all.most != 1 ||
        double(values_.all.one) < kPlateau * double(values_.all.pixels))
      return;
    fail(ErrorKind::input,
         "{}: the depth may be normalized or planar (all in 0 to 1, {:.1f} % of exactly 1): say --depth-kind "
         "normalized with --near and --far (or log, with "
         "--far and --set log-constant), or --depth-kind planar",
         path_, 100 * double(values_.all.one) / double(values_.all.pixels));
  }

  /// Takes the kind by which most surfaces are flat.
  void take_flattest(const std::vector<DepthScore>& scores) {
    const auto& expected = *std::ranges::find(scores, usual_, &DepthScore::kind);
    const std::string why = text_of(scores);
    const DepthScore &best = scores[0], &second = scores[1];
    if (usual_ == DepthKind::inverse) return take_passed_on(best.kind, why);
    if (expected.straight >= kAsGood * best.straight) return take_usual(why);
    if (best.straight < kClear * second.straight)
      fail(ErrorKind::input, "{}: the depth may be {} or {} ({}): say which with --depth-kind {} or --depth-kind {}",
           path_, word_of(best.kind), word_of(second.kind), why, word_of(best.kind), word_of(second.kind));
    reading_.depth_kind = best.kind;
    if (best.kind == DepthKind::inverse && values_.all.least >= 0 && is_fraction()) return settle_device(why);
    const bool may_be_other = best.kind == DepthKind::inverse && !reading_.camera.orthographic;
    guess("depth kind", word_of(best.kind),
          may_be_other ? fmt::format("{}{}; {}", why, kDisparityHint, kOrthographicHint) : why, "--depth-kind", true);
  }

  /// Reads the depth as the program that wrote the frame, or most programs, write it. It is no guess where the user
  /// named the program.
  void take_usual(const std::string& why) {
    reading_.depth_kind = usual_;
    const std::string by = facts_.program.by.empty()
                               ? ""
                               : fmt::format("{} writes it ({}); ", facts_.program.rules->name, facts_.program.by);
    guess("depth kind", word_of(reading_.depth_kind), by + why, "--depth-kind", false);
  }

  /// Takes the kind by which the depth is that of the positions beside it. False: none.
  bool take_by_positions(const std::string& but) {
    const auto kind = facts_.kind_by_positions ? facts_.kind_by_positions() : std::nullopt;
    if (!kind) return false;
    reading_.depth_kind = *kind;
    guess("depth kind", word_of(*kind), "so it is that of the positions; " + but, "--depth-kind",
          *kind != usual_ && usual_ != DepthKind::inverse);
    return true;
  }

  /// Takes distances or 1/z, by which clearly more of the normals agree with depth. False: neither.
  bool take_by_normals(const std::string& but) {
    const double inverse = agreement_as(DepthKind::inverse), planar = agreement_as(DepthKind::planar);
    const double most = std::max(inverse, planar), least = std::min(inverse, planar);
    if (most < kLeastAgreement || most < kClearNormals * least) return false;
    const std::string why =
        fmt::format("{:.0f} % of the normals agree with 1/z, {:.0f} % with z; {}", 100 * inverse, 100 * planar, but);
    const DepthKind distance = usual_ == DepthKind::ray ? usual_ : DepthKind::planar;
    const DepthKind kind = inverse > planar ? DepthKind::inverse : distance;
    if (usual_ == DepthKind::inverse) {
      take_passed_on(kind, why);
    } else {
      reading_.depth_kind = kind;
      guess("depth kind", word_of(kind), why, "--depth-kind", kind != usual_);
    }
    return true;
  }

  /// Takes depth of a program that writes 1/z itself and passes on depth of other programs. Neither is unusual.
  void take_passed_on(DepthKind kind, const std::string& why) {
    reading_.depth_kind = kind;
    guess("depth kind", word_of(kind),
          fmt::format("{} ({}) writes 1/z, and passes on other programs' depth; {}", facts_.program.rules->name,
                      facts_.program.by, why),
          "--depth-kind", false);
  }

  void assume_passed_on(const std::string& why) {
    if (is_fraction())
      fail(ErrorKind::input,
           "{}: {}, and neither flat surfaces nor normals tell whether it is 1/z, as {} writes it: give --depth-kind "
           "inverse; if it is normalized, {}{}",
           path_, text_of_range(), facts_.program.rules->name, normalized_line(false), kDisparityHint);
    take_passed_on(DepthKind::planar, why + ", and it holds more than 1");
    note_assumption(why);
  }

  /// Says of a kind that it is a guess.
  void note_assumption(const std::string& why) {
    note(NoteCode::assumed_reading,
         fmt::format("depth is read as {}, {}: {} (--depth-kind)", word_of(reading_.depth_kind),
                     facts_.program.by.empty() || facts_.program.rules->depth_kind == DepthKind::automatic
                         ? "the usual kind"
                         : "as " + facts_.program.rules->name + " writes it",
                     why));
  }

  std::string text_of(const std::vector<DepthScore>& scores) const {
    return fmt::format("{}, as {} {:.0f} %, as {} {:.0f} %", straight(scores[0]), word_of(scores[1].kind),
                       100 * scores[1].straight, word_of(scores[2].kind), 100 * scores[2].straight);
  }

  /// The share of the normals that agree with the depth if it is of that kind, in their best space; 0 without normals.
  double agreement_as(DepthKind kind) const {
    if (!has_vectors()) return 0;
    const NormalStatistics n = normal_statistics(raw_.normal, raw_.depth, depth_map_of(reading_), values_.step);
    Reading reading = over(reading_, raw_.window);
    reading.depth_kind = kind;
    reading.normal_encoding = NormalEncoding::signed_float;
    reading.normal_unorm = n.unorm_unit_share > n.unit_share;
    const auto scores = score_normals({reading, raw_.normal, raw_.depth});
    return scores.empty() ? 0 : scores[0].agreement;
  }

  /// Fails with values on both sides of 0, which are no distances.
  void refuse_signs() const {
    const std::size_t fewer = std::min(values_.below_0.count, values_.above_0.size()),
                      all = values_.below_0.count + values_.above_0.size();
    const bool is_error =
        double(fewer) <= kFewErrors * double(all) || std::min(-values_.all.least, values_.surfaces.most) <=
                                                         kRounded * std::max(-values_.all.least, values_.surfaces.most);
    if (!values_.below_0.varies() || is_error || values_.side_above(0).is_mostly_one()) return;
    fail(ErrorKind::input,
         "{}: depth goes from {:.3g} to {:.3g}, {:.0f} % of it below 0, so these are no distances: if it is normalized "
         "and goes on beyond its planes, as V-Ray's without clamp, give --depth-kind normalized --near N --far F, the "
         "distances of 0 and of 1 (with --reversed-z, of 1 and of 0); if values below 0 are no surfaces, give "
         "--depth-kind planar{}",
         path_, values_.all.least, values_.surfaces.most, 100 * double(values_.below_0.count) / double(all),
         kDisparityHint);
  }

  /// What the normals need beside the depth's kind, so that it is no error of its own.
  std::string text_of_normals() const {
    const bool may_be_of_world = !raw_.normal.empty() && settings_.normal_space != NormalSpace::view;
    if (!may_be_of_world || reading_.camera.view_from_world) return "";
    return "; if its normals are in world space, they need a --camera file with world_to_camera, or --normal none "
           "instead";
  }

  /// Inverse depth and that of a z-buffer are both affine in 1/z. A near plane that somebody knows tells them apart.
  /// Sky is at the far plane.
  void settle_device(const std::string& why) {
    const bool reversed = reading_.depth_range.reversed || (values_.all.zero && !values_.all.one);
    if (!settings_.depth_range.near || !reading_.depth_range.far || !(reversed || values_.all.one))
      fail(ErrorKind::input,
           "{}: the depth may be device or inverse (all in 0 to 1, {}): say --depth-kind device with --near and --far "
           "(inf where there is none) and, "
           "where near is 1, --reversed-z; or --depth-kind inverse{}{}",
           path_, why, kDisparityHint, text_of_normals());
    reading_.depth_range.reversed = reversed;
    reading_.depth_kind = DepthKind::device;
    guess("depth kind", reversed ? "device with --reversed-z" : "device", "all in 0 to 1, --near is given, and " + why,
          "--depth-kind", true);
  }

  DepthKind usual_;  // of the program
};

}  // namespace

void settle_depth_kind(const DepthSettlement& depth) { DepthKindSettlement(depth).run(); }

}  // namespace alcove
