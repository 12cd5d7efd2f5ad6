// Settles scale and shift of disparity: by options, else by the normals, else not at all.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/base/ranks.h"
#include "core/frame/pixels/disparity.h"
#include "core/frame/settle/settlement.h"

namespace alcove {
namespace {

constexpr const char* kOptions =
    "--set disparity-shift B, the value at infinity, or --near N --far F, the distances of the values 1 and 0";
// Parts of the median value above the shift.
constexpr double kMostUncertain = 0.12, kProven = 0.02;  // of the shift's error
constexpr double kSame = 0.02;                           // of the difference of shifts that are one
constexpr double kFarthest = 1e-4;                       // what is less above the shift is the sky, as far as one knows
/// RMS of the AO for each part of the median value by which the shift is off. Measured on six rendered scenes: 0.2 to
/// 0.7 at 1 %, 0.2 to 0.4 at 5 %.
constexpr double kAoOfShift = 0.7;
/// The same for the part of the slopes that the normals do not explain. With smooth errors of 1 and 3 %: 0.4 to 1.2.
constexpr double kAoOfMisfit = 1.2, kLittleAo = 0.03;

class DisparitySettlement : private DepthSettlement {
 public:
  explicit DisparitySettlement(const DepthSettlement& depth) : DepthSettlement(depth) {}

  void run() {
    auto& range = reading_.depth_range;
    // The planes of a camera are not those where disparity is 1 and 0.
    range.near = settings_.depth_range.near;
    range.far = settings_.depth_range.far;
    if (reading_.camera.orthographic)
      fail(ErrorKind::input, "{}: disparity is of a perspective camera, and the frame's is orthographic", path_);
    const auto said = disparity_of(range).shift;
    if (values_.all.least == values_.all.most) {  // a sky, or nothing
      seen_.tells = false;
      if (!said) range.disparity_shift = values_.all.most;
    } else {
      said ? doubt_shift(*said) : take_shift(found_shift());
    }
    settle_scale();
  }

 private:
  /// The median of the surfaces' values above the shift. 0: there is none.
  double median_above(double shift) const {
    std::vector<double> above;
    for (std::size_t i = 0; i < raw_.depth.size(); i += values_.step)
      if (raw_.depth[i] - shift > kFarthest * (values_.all.most - shift) && std::isfinite(raw_.depth[i]))
        above.push_back(raw_.depth[i] - shift);
    return above.empty() ? 0 : median_of(std::move(above));
  }

  /// The shifts by those readings of the normals that the options leave open, the best first.
  std::vector<ShiftScore> scores() const {
    if (!has_vectors()) return {};
    Reading reading = over(reading_, raw_.window);
    reading.depth_range.disparity_shift = values_.all.least - 1;
    const NormalStatistics n = normal_statistics(raw_.normal, raw_.depth, depth_map_of(reading), values_.step);
    if (settings_.normal_encoding == NormalEncoding::automatic)
      reading.normal_unorm = n.unorm_unit_share > n.unit_share;
    auto scores = score_shifts({reading, raw_.normal, raw_.depth}, seen_.grain);
    const bool is_open = settings_.normal_space == NormalSpace::automatic;
    std::erase_if(scores, [&](const auto& s) { return !is_open && s.space != settings_.normal_space; });
    return scores;
  }

  /// The error as a part of the median value above the shift: so much depths of a frame may be off by one another.
  double uncertainty(const ShiftScore& score) const { return score.error / median_above(score.shift); }

  ShiftScore found_shift() const {
    const auto found = scores();
    if (found.empty())
      fail(ErrorKind::input, "{}: disparity is a / z + b, with an unknown b: give normals, by --normal, or {}{}", path_,
           kOptions, hint_of_planes());
    const ShiftScore& best = found[0];
    refuse_turned(best);
    if (best.agreement < kLeastAgreement || uncertainty(best) > kMostUncertain)
      fail(ErrorKind::input,
           "{}: disparity is a / z + b, and the normals do not show b: {}; give {}; or other normals (--normal), with "
           "--normal-space and --flip-normal",
           path_, text_of(best), kOptions);
    refuse_ambiguous(found);
    return best;
  }

  /// Refuses values that are largest for what is farthest.
  void refuse_turned(const ShiftScore& score) const {
    if (score.agreement < kLeastAgreement || values_.all.most - score.shift > score.shift - values_.all.least) return;
    fail(ErrorKind::input,
         "{}: by the normals its larger values are farther away ({}), and in disparity they are nearer: invert the "
         "values, or give another --depth-kind",
         path_, text_of(score));
  }

  /// Refuses a shift where a reading of the normals that does as well gives another one.
  void refuse_ambiguous(const std::vector<ShiftScore>& found) const {
    const ShiftScore& best = found[0];
    for (const ShiftScore& other : found)
      if (other.agreement >= kAsGood * best.agreement && !is_near(other.shift, best))
        fail(ErrorKind::input,
             "{}: disparity is a / z + b, and the normals may give b as {} or as {}: say --normal-space"
             " and --flip-normal, or give {}",
             path_, text_of(best), text_of(other), kOptions);
  }

  bool is_near(double shift, const ShiftScore& score) const {
    return std::abs(shift - score.shift) <= score.error + kSame * median_above(score.shift);
  }

  std::string text_of(const ShiftScore& score) const {
    return fmt::format("{:.5g} +- {:.2g} fits the normals in {} space on {:.0f} %", score.shift, score.error,
                       word_of(score.space), 100 * std::max(0.0, score.agreement));
  }

  void take_shift(const ShiftScore& score) {
    reading_.depth_range.disparity_shift = score.shift;
    reading_.depth_range.disparity_error = std::max(score.error, kFarthest * median_above(score.shift));
    if (reading_.depth_is_coarse) seen_.space_by_shift = score.space;
    const double part = uncertainty(score), ao = std::max(kAoOfShift * part, kAoOfMisfit * (1 - score.agreement));
    take_down("disparity's shift", fmt::format("{:.5g}", score.shift),
              fmt::format("{}; the error is {:.2g} % of the median value above it, and with other misfits AO is off by "
                          "up to {:.1g}, apart from blurred outlines",
                          text_of(score), 100 * part, ao),
              "--set disparity-shift", true, part < kProven && ao < kLittleAo);
  }

  static std::string text_of(const RightAngles& found) {
    return fmt::format("with b = {:.5g} +- {:.2g} most planes in the picture meet at right angles", found.shift,
                       found.error);
  }

  std::string hint_of_planes() const {
    const auto found = shift_by_right_angles(view_, raw_.depth, seen_.grain);
    return found ? fmt::format("; {}: if they do, give --set disparity-shift={:.5g}", text_of(*found), found->shift)
                 : "";
  }

  /// Notes where the planes alone give another shift than the options.
  void doubt_by_planes(double shift) {
    const auto found = shift_by_right_angles(view_, raw_.depth, seen_.grain);
    if (!found || std::abs(found->shift - shift) <= 2 * found->error) return;
    note(NoteCode::said_otherwise,
         fmt::format("disparity's shift is {:.5g} by the options, and {}", shift, text_of(*found)));
  }

  /// Notes where the normals give another shift than the options.
  void doubt_shift(double shift) {
    double& error = reading_.depth_range.disparity_error;
    error = kFarthest * median_above(shift);
    const auto found = scores();
    if (found.empty()) return doubt_by_planes(shift);
    if (found[0].agreement < kLeastAgreement) return;
    if (is_near(shift, found[0])) {
      if (reading_.depth_is_coarse) seen_.space_by_shift = found[0].space;
      error = std::max(error, found[0].error);
      return;
    }
    note(NoteCode::said_otherwise,
         fmt::format("disparity's shift is {:.5g} by the options, and by the normals another: {}", shift,
                     text_of(found[0])));
  }

  /// Without a scale the median depth is 1.
  void settle_scale() {
    auto& range = reading_.depth_range;
    const Disparity found = disparity_of(range);
    range.near = range.far = std::nullopt;
    range.disparity_shift = found.shift;
    range.disparity_scale = found.scale.value_or(median_above(*found.shift));
    if (!(*range.disparity_scale > 0)) range.disparity_scale = 1;  // all is sky
  }
};

}  // namespace

void settle_disparity(const DepthSettlement& depth) { DisparitySettlement(depth).run(); }

}  // namespace alcove
