// The values of a frame's depth, and the steps that settle it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/settlement.h"

namespace alcove {

/// The values on one side of a limit. One value alone stands for something that is no surface.
struct Side {
  std::size_t count = 0, others = 0;  // others: all but the most frequent value
  float usual = 0;                    // the most frequent value

  bool varies() const { return others > 0; }
  /// Edges blend one value with others.
  bool is_mostly_one() const { return 10 * others <= count; }
};

/// The values of a depth plane as they stand in the file. All pixels of a small picture are looked at.
struct DepthValues {
  DepthValues(std::span<const float> depth, double sky);

  std::size_t step;  // from one pixel that is looked at to the next
  Side below_0;      // finite, and nearer than the sky, like the next sides
  std::vector<float> above_0;
  ValueStatistics all;       // of all pixels
  ValueStatistics surfaces;  // above 0 and before the sky: all surfaces, if values are distances
  bool has_any = false;      // that may be a surface

  Side side_above(float limit) const;
};

/// If a smaller part of the smooth places is straight, the frame has too few flat surfaces to decide.
inline constexpr double kLeastStraight = 0.02;
/// From this part of the smooth places on, flat surfaces speak for a kind by themselves.
inline constexpr double kSurelyStraight = 0.1;
/// If this part of the pixels is exactly 1, that is a background.
inline constexpr double kPlateau = 0.001;
/// The remedy if an orthographic camera made the depth and another camera is given. In such depth planes are affine in
/// the picture; with a perspective camera they are so in 1/z.
inline constexpr const char* kOrthographicHint =
    "distances of an orthographic camera would look the same: for one, give --ortho-width, or a --camera file with "
    "\"projection\": \"orthographic\"";
/// The remedy if the depth may be a network's.
inline constexpr const char* kDisparityHint = "; if a network estimated it, as a / z + b, --depth-kind disparity";
/// A range of 0 to 1 may exceed 1 by so much because it was computed.
inline constexpr double kRounded = 1e-3;
/// Values on the other side of 0 count as errors if their share is smaller than this, or if rounding explains them all.
inline constexpr double kFewErrors = 0.005;

/// Facts about a depth besides its planes.
struct DepthFacts {
  Program program;
  bool is_kind_open = false;
  // Gives the kind that makes the depth agree with positions beside it, if they decide. Null: there are none.
  std::function<std::optional<DepthKind>()> kind_by_positions = nullptr;
  const char* said_by = "--depth-kind, --source or the camera file";  // the possible sources of a kind that is not open
};

/// Settles kind and sign of the depth, or the space of positions. If they are given, notes the evidence against them.
void settle_depth(const PlanesToSettle& planes, const DepthFacts& facts);

/// Depth that is being settled.
class DepthSettlement : protected Settlement {
 public:
  DepthSettlement(const PlanesToSettle& planes, const DepthFacts& facts, const DepthValues& values)
      : Settlement(planes), facts_(facts), values_(values) {}

 protected:
  /// Whether all surfaces lie within 0 to 1; the sky may have another value.
  bool is_fraction() const { return values_.surfaces.positive && values_.surfaces.most <= 1 + kRounded; }
  std::string text_of_range() const;
  std::string straight(const DepthScore& score) const;
  double straightness(const std::vector<DepthScore>& scores, DepthKind kind) const;
  /// The straightness of flat surfaces if the depth falls from 1 at the eye to 0 at its far end.
  double straightness_from_1() const;
  /// The options that read normalized depth, and the meaning of their number.
  static std::string normalized_line(bool reversed);

  bool has_vectors() const { return raw_.normal.size() == 3 * raw_.window.pixels(); }

  const DepthFacts& facts_;
  const DepthValues& values_;
};

/// Decides an open kind: by flat surfaces, else by positions, else by normals, else by the program, else the usual
/// one.
void settle_depth_kind(const DepthSettlement& depth);

/// Depth within 0 to 1 is more often the part of a range than a distance, and no pixel shows the length of the range.
/// It is refused if nothing supports distances, and noted if straight lines do, since z / far has them too. `usual`:
/// the kind that the program writes.
void refuse_fractions(const DepthSettlement& depth, DepthKind usual);

/// Notes evidence of the pixels, or of two sources of planes, against the given kind of depth. The given kind stays.
void doubt_depth_kind(const DepthSettlement& depth);
/// Notes near planes that differ.
void compare_near_planes(const DepthSettlement& depth);

/// Settles the sign, depth at the ends of a range and beyond them, and one distance that may be the sky.
void settle_depth_ends(const DepthSettlement& depth);

/// Settles scale and shift of disparity. Without a scale the median depth becomes 1. Fails with ErrorKind::input if the
/// shift is unknown.
void settle_disparity(const DepthSettlement& depth);

/// Settles the space of positions.
void settle_position_space(const PlanesToSettle& planes);

}  // namespace alcove
