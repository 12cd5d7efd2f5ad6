// Holds what is said of depth against its pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/flatness.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/depth_settlement.h"

namespace alcove {
namespace {

class DepthDoubts : private DepthSettlement {
 public:
  explicit DepthDoubts(const DepthSettlement& depth) : DepthSettlement(depth) {}

  void run() {
    doubt_range();
    const bool linear = reading_.depth_kind == DepthKind::normalized || reading_.depth_kind == DepthKind::log;
    const DepthKind said = reading_.depth_kind == DepthKind::disparity ? DepthKind::inverse  // with a shift, alike
                           : reading_.depth_kind != DepthKind::device  ? reading_.depth_kind
                           : reading_.camera.orthographic              ? DepthKind::planar
                                                                       : DepthKind::inverse;
    const auto& scores = seen_.depth_scores;
    doubt_fractions(scores);
    if (scores.empty() || scores[0].straight < (linear ? kSurelyStraight : kLeastStraight)) return;
    if (kClear * straightness(linear ? scores_as_said() : scores, linear ? DepthKind::planar : said) >
        scores[0].straight)
      return;
    note(NoteCode::said_otherwise,
         fmt::format("depth is read as {} by {}, but {}: is it {}?", word_of(reading_.depth_kind), facts_.said_by,
                     straight(scores[0]),
                     scores[0].kind == DepthKind::inverse ? "inverse or device" : word_of(scores[0].kind)));
  }

  /// Notes near planes that differ. A projection matrix made for another depth range than the buffer's scales all
  /// distances, which no pixel shows.
  void compare_planes() {
    const auto near = reading_.depth_range.near;
    const auto by_file = reading_.camera.near;
    const auto by_matrix = reading_.camera.matrix_near;
    constexpr double kSame = 0.01;  // matrices are rounded
    if (reading_.depth_kind == DepthKind::device && settings_.depth_range.near && by_file &&
        std::abs(*near / *by_file - 1) >= kSame)
      note(NoteCode::near_plane, fmt::format("--near is {:.4g}, and the camera file's near plane is at {:.4g}: "
                                             "distances are {:.3g} times those by the file",
                                             *near, *by_file, *near / *by_file));
    if (reading_.depth_kind != DepthKind::device || reading_.depth_range.reversed ||
        reading_.depth_range.device != DeviceRange::automatic || settings_.depth_range.near)
      return;
    if (!near || !by_matrix || std::abs(*by_matrix / *near - 1) < kSame) return;
    note(NoteCode::near_plane,
         fmt::format("the near plane is {:.4g}, but the camera file's projection, read with z = depth, has it at "
                     "{:.4g}, for distances {:.3g} times as large; --near or --set device-range decides",
                     *near, *by_matrix, *by_matrix / *near));
  }

 private:
  /// Notes distances that look like a part of a range. They are read as distances all the same.
  void doubt_fractions(const std::vector<DepthScore>& scores) {
    if (!is_distance(reading_.depth_kind) || !is_fraction()) return;
    const double straight = scores.empty() ? 0 : scores[0].straight, from_1 = straightness_from_1();
    if (from_1 >= kLeastStraight && from_1 > kClear * straight)
      note(NoteCode::said_otherwise,
           fmt::format("{}, and flat surfaces are straight on {:.0f} % as 1 - depth, on {:.0f} % as depth: it is read "
                       "as {} by {}; if it is normalized, give {}",
                       text_of_range(), 100 * from_1, 100 * straight, word_of(reading_.depth_kind), facts_.said_by,
                       normalized_line(true)));
    else if (settings_.depth_kind == DepthKind::automatic && facts_.program.rules->depth_kind == DepthKind::automatic)
      note(NoteCode::depth_below_1,
           fmt::format("{} and is read as {}; if it is normalized, give {}; --depth-kind {} confirms distances",
                       text_of_range(), word_of(reading_.depth_kind), normalized_line(false),
                       word_of(reading_.depth_kind)));
  }

  /// The scores of the distances that the depth gives if it is read as is said.
  std::vector<DepthScore> scores_as_said() const {
    const auto planar = planar_depths(raw_.depth, depth_map_of(reading_), view_);
    return shape_of(planar, view_, settings_.sky, grain_of(planar, settings_.sky, view_.orthographic != 0)).scores;
  }

  /// Notes a z-buffer that uses only half of its range, or that leaves it.
  void doubt_range() {
    if (reading_.depth_kind != DepthKind::device) return;
    const auto below = std::ranges::count_if(raw_.depth, [](float d) { return d > -1 && d < 0; });
    if (reading_.depth_range.device == DeviceRange::automatic && below > 0)
      note(NoteCode::said_otherwise,
           fmt::format(
               "{} pixels have a depth of -1 to 0 and count as sky: does the depth need --set device-range=-1..1?",
               below));
    if (reading_.depth_range.device == DeviceRange::minus_one_to_one && values_.all.least >= 0)
      note(NoteCode::said_otherwise,
           "no depth is below 0: either all surfaces lie beyond twice the near plane, or --set device-range=-1..1 is "
           "wrong");
  }
};

}  // namespace

void doubt_depth_kind(const DepthSettlement& depth) { DepthDoubts(depth).run(); }

void compare_near_planes(const DepthSettlement& depth) { DepthDoubts(depth).compare_planes(); }

}  // namespace alcove
