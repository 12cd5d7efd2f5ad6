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
#include "core/frame/settle/depth_settlement.h"

namespace alcove {
namespace {

constexpr const char* kOptions =
    "--set disparity-shift B, the value of what is infinitely far, or --near N --far F, the distances of the values 1 "
    "and 0";
constexpr double kMostUncertain = 0.1;  // of the median value above the shift
constexpr double kSame = 0.02;          // of the same: shifts that differ by less are one
constexpr double kFarthest = 1e-4;      // of the same: what is less above the shift is the sky, as far as anybody knows

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
    const auto values = surfaces();
    const bool is_said = disparity_of(range).shift.has_value();
    if (values.empty()) {
      seen_.tells = false;
      if (!is_said) range.disparity_shift = 0;
      return;
    }
    median_ = median_of(values);
    is_said ? doubt_shift(*disparity_of(range).shift) : take_shift(found_shift());
    settle_scale();
  }

 private:
  std::vector<float> surfaces() const {
    std::vector<float> values;
    for (std::size_t i = 0; i < raw_.depth.size(); i += values_.step)
      if (std::isfinite(raw_.depth[i])) values.push_back(raw_.depth[i]);
    return values;
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
  double uncertainty(const ShiftScore& score) const { return score.error / std::abs(median_ - score.shift); }

  ShiftScore found_shift() const {
    const auto found = scores();
    if (found.empty())
      fail(ErrorKind::input, "{}: disparity is a / z + b, and nothing tells b: give normals, by --normal, or {}", path_,
           kOptions);
    const ShiftScore& best = found[0];
    if (best.agreement < kLeastAgreement || uncertainty(best) > kMostUncertain)
      fail(ErrorKind::input,
           "{}: disparity is a / z + b, and the normals do not tell b: {}; give {}; or other normals (--normal), with "
           "--normal-space and --flip-normal",
           path_, text_of(best), kOptions);
    if (median_ < best.shift)
      fail(ErrorKind::input,
           "{}: by the normals larger values are farther away ({}), and those of disparity are nearer: give the file "
           "with its values turned round, or another --depth-kind",
           path_, text_of(best));
    refuse_ambiguous(found);
    return best;
  }

  /// Refuses a shift where a reading of the normals that does as well gives another one.
  void refuse_ambiguous(const std::vector<ShiftScore>& found) const {
    const ShiftScore& best = found[0];
    for (const ShiftScore& other : found)
      if (other.agreement >= kAsGood * best.agreement && !is_near(other.shift, best))
        fail(ErrorKind::input, "{}: disparity is a / z + b, and the normals may give b as {} or as {}: say --normal-space"
                               " and --flip-normal, or give {}",
             path_, text_of(best), text_of(other), kOptions);
  }

  bool is_near(double shift, const ShiftScore& score) const {
    return std::abs(shift - score.shift) <= score.error + kSame * std::abs(median_ - score.shift);
  }

  std::string text_of(const ShiftScore& score) const {
    return fmt::format("{:.5g} +- {:.2g} fits the normals in {} space on {:.0f} %", score.shift, score.error,
                       word_of(score.space), 100 * std::max(0.0, score.agreement));
  }

  void take_shift(const ShiftScore& score) {
    reading_.depth_range.disparity_shift = score.shift;
    reading_.depth_range.disparity_error = std::max(score.error, kFarthest * (median_ - score.shift));
    take_down("disparity's shift", fmt::format("{:.5g}", score.shift), text_of(score), "--set disparity-shift", true,
              true);
  }

  /// Notes where the normals give another shift than the options.
  void doubt_shift(double shift) {
    reading_.depth_range.disparity_error = kFarthest * std::abs(median_ - shift);
    const auto found = scores();
    if (found.empty() || found[0].agreement < kLeastAgreement || is_near(shift, found[0])) return;
    note(NoteCode::said_otherwise, fmt::format("disparity's shift is {:.5g} by the options, and by the normals another: {}",
                                               shift, text_of(found[0])));
  }

  /// Without a scale the median depth is 1.
  void settle_scale() {
    auto& range = reading_.depth_range;
    const Disparity found = disparity_of(range);
    range.near = range.far = std::nullopt;
    range.disparity_shift = found.shift;
    range.disparity_scale = found.scale.value_or(median_ - *found.shift);
  }

  double median_ = 0;  // of the values
};

}  // namespace

void settle_disparity(const DepthSettlement& depth) { DisparitySettlement(depth).run(); }

}  // namespace alcove
