// Settles the sign of depth, its ends, and the sky.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/settle/depth_settlement.h"

namespace alcove {
namespace {

class DepthEnds : private DepthSettlement {
 public:
  explicit DepthEnds(const DepthSettlement& depth) : DepthSettlement(depth) {}

  void run() {
    settle_sign();
    settle_ends();
    find_sky();
  }

 private:
  /// Distances below 0 are those of cameras that look along -z. One value above 0 beside them is their sky.
  void settle_sign() {
    if (!is_distance(reading_.depth_kind) && reading_.depth_kind != DepthKind::inverse) return;
    const bool are_errors =
        double(values_.below_0.count) <= kFewErrors * double(values_.below_0.count + values_.above_0.size());
    if (!values_.below_0.varies() || are_errors) return;
    const Side above = values_.side_above(0);
    if (!above.is_mostly_one()) return;
    reading_.depth_range.negative = true;
    note(NoteCode::negative_depth,
         above.count ? fmt::format("depth is negative, and its distance from 0 is taken; {} is the sky", above.usual)
                     : "all depth values are negative: their distance from 0 is the depth");
  }

  /// Settles depth at the ends of a range and beyond them: normalized depth may go on, and the sky is at the far end.
  void settle_ends() {
    auto& range = reading_.depth_range;
    if (reading_.depth_kind == DepthKind::normalized) {
      const bool below = goes_on(values_.below_0, values_.all.zero, 0),
                 above = goes_on(values_.side_above(1), values_.all.one, 1);
      range.goes_before_near = range.reversed ? above : below;
      range.goes_beyond_far = range.reversed ? below : above;
      if (below || above)
        note(NoteCode::beyond_planes,
             fmt::format("depth goes from {:.3g} to {:.3g}: it was not cut off at its planes, and is read beyond them",
                         values_.all.least, values_.surfaces.most));
    }
    if (reading_.depth_kind == DepthKind::device) settle_direction();
  }

  /// Whether normalized depth goes on beyond an end of its range. If many pixels are exactly at the end, it was cut off
  /// there: a filter made the values beyond from the edges of these, and they count as these do.
  bool goes_on(const Side& beyond, std::uint64_t at_end, int end) {
    if (!beyond.varies()) return false;
    if (double(at_end) < kPlateau * double(values_.all.pixels)) return true;
    if (double(beyond.count) > kFewErrors * double(values_.all.pixels))
      note(NoteCode::beyond_planes,
           fmt::format("{:.2g} % of the depth lies beyond {}, and {:.2g} % is exactly {}: all of these count as sky",
                       100 * double(beyond.count) / double(values_.all.pixels), end,
                       100 * double(at_end) / double(values_.all.pixels), end));
    return false;
  }

  /// Nothing is seen at exactly the near plane, so that many pixels there are sky of a depth that runs the other way.
  void settle_direction() {
    auto& range = reading_.depth_range;
    const float low = range.device == DeviceRange::minus_one_to_one ? -1 : 0, near = range.reversed ? 1 : low,
                far = range.reversed ? low : 1;
    const auto at_near = std::size_t(std::ranges::count(raw_.depth, near));
    if (double(at_near) < kPlateau * double(raw_.depth.size()) ||
        std::ranges::find(raw_.depth, far) != raw_.depth.end())
      return;
    const std::string what = fmt::format(
        "{:.0f} % of the pixels have exactly {}, the near plane's value{}, and none has {}",
        100 * double(at_near) / double(raw_.depth.size()), near, range.reversed ? " of reversed depth" : "", far);
    const bool is_by_rules = !settings_.depth_range.reversed && !reading_.camera.reversed_z && range.reversed;
    if (!is_by_rules) {
      note(NoteCode::said_otherwise,
           fmt::format("{}: that looks like the sky of depth that is {}reversed: {} --reversed-z", what,
                       range.reversed ? "not " : "", range.reversed ? "leave out" : "give"));
      return;
    }
    range.reversed = false;
    guess("depth's direction", "not reversed", what, "--reversed-z", true);
  }

  /// Takes one distance far behind all others for the sky where the normals show it, and else points it out.
  void find_sky() {
    constexpr double kLeastShare = 0.002;  // of the pixels
    constexpr double kBlended = 0.1;       // for each pixel of the sky; edges lie in between
    if (!is_distance(reading_.depth_kind) || settings_.sky != InputSettings{}.sky) return;
    const Farthest far = farthest();
    const double share = double(far.count) / double(far.all);
    if (far.next == 0 || share < kLeastShare || double(far.blended) > kBlended * double(far.count)) return;
    // A wall that faces the camera has one planar depth and one normal; a dome around it has many normals.
    if (reading_.depth_kind == DepthKind::planar && far.like_first == far.count) return;
    if (far.is_bare()) reading_.found_sky = far.value;
    note(NoteCode::finite_sky, far.is_bare()
                                   ? fmt::format("the depth {:.6g} of {:.1f} % of the pixels, all without normals, is "
                                                 "taken for the sky (--sky {:.6g} confirms it)",
                                                 far.value, 100 * share, far.value)
                                   : fmt::format("{:.1f} % of the pixels have exactly the depth {:.6g}, and all others "
                                                 "end at {:.4g}: if they are sky, and no wall, give --sky {:.6g}",
                                                 100 * share, far.value, far.next, far.value));
  }

  /// The pixels with the largest distance, and all others.
  struct Farthest {
    float value = 0, next = 0;             // next: the largest distance that is less than half of it
    std::size_t all = 0, count = 0;        // pixels that were looked at, and those with it
    std::size_t blended = 0;               // surfaces in between
    std::size_t bare = 0, other_bare = 0;  // without a normal: those with it, and other surfaces
    std::size_t like_first = 0;            // with the normal of the first one
    bool has_normals = false;

    /// Whether these pixels, and no others, have no normals.
    bool is_bare() const {
      constexpr double kAll = 0.98;
      return has_normals && double(bare) >= kAll * double(count) &&
             double(other_bare) <= (1 - kAll) * double(all - count);
    }
  };

  Farthest farthest() const {
    constexpr std::size_t kSampled = 1 << 15;
    constexpr double kFar = 2;  // times as far as all others
    const double limit = depth_map_of(reading_).sky_depth / reading_.depth_scale;
    const std::size_t step = raw_.depth.size() / kSampled + 1;
    Farthest far{.has_normals = has_vectors()};
    for (std::size_t i = 0; i < raw_.depth.size(); i += step)
      if (const float d = std::abs(raw_.depth[i]); d < limit) far.value = std::max(far.value, d);
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < raw_.depth.size(); i += step) {
      const float d = std::abs(raw_.depth[i]);
      const bool is_bare = far.has_normals && has_no_normal(i);
      far.all++;
      if (d == far.value) {
        if (!first) first = i;
        far.count++;
        far.bare += is_bare;
        far.like_first += far.has_normals && !is_bare && has_same_normal(i, *first);
      } else if (d > 0 && d < limit) {
        far.other_bare += is_bare;
        kFar* d >= far.value ? void(far.blended++) : void(far.next = std::max(far.next, d));
      }
    }
    return far;
  }

  bool has_same_normal(std::size_t pixel, std::size_t other) const {
    constexpr float kRounded = 0.01f;  // 8 bits, too
    for (std::size_t c = 0; c < 3; c++) {
      const float* const plane = &raw_.normal[c * raw_.depth.size()];
      if (!(std::abs(plane[pixel] - plane[other]) < kRounded)) return false;
    }
    return true;
  }

  /// Whether a pixel's normal is NaN, or 0 as a vector or as a colour.
  bool has_no_normal(std::size_t pixel) const {
    constexpr float kGrey = 0.5f, kRoundedGrey = 0.003f;  // 8 bits have no 0.5
    const auto all = [&](const auto& holds) {
      for (std::size_t c = 0; c < 3; c++)
        if (!holds(raw_.normal[c * raw_.depth.size() + pixel])) return false;
      return true;
    };
    return all([](float n) { return n == 0; }) || all([](float n) { return std::isnan(n); }) ||
           all([](float n) { return std::abs(n - kGrey) < kRoundedGrey; });
  }
};

}  // namespace

void settle_depth_ends(const DepthSettlement& depth) { DepthEnds(depth).run(); }

}  // namespace alcove
