// A frame during settling, from files or from memory: the state that the steps share, the values of its depth, and the
// steps that settle it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/note.h"
#include "core/base/option_words.h"
#include "core/base/settings.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/reading.h"

namespace alcove {

/// Planes of depth and normals that are being settled, as they were read.
struct PlanesToSettle {
  Reading& reading;
  Notes& notes;
  const InputSettings& settings;
  const RawPart& raw;
  Evidence& seen;
  std::string path;       // of the planes in question, for errors
  std::string file = {};  // the same for notes; empty: the frame's own
};

class Settlement {
 public:
  explicit Settlement(PlanesToSettle planes)
      : reading_(planes.reading),
        settings_(planes.settings),
        raw_(planes.raw),
        seen_(planes.seen),
        view_(view_of(planes.reading, planes.raw.window)),
        path_(std::move(planes.path)),
        notes_(planes.notes),
        file_(std::move(planes.file)) {}

 protected:
  /// Takes down a choice, and notes an unusual one: with a warning unless the pixels prove it.
  void take_down(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
                 bool unusual, bool proven) {
    seen_.guesses.push_back({what, chosen, why, option});
    if (unusual)
      note(proven ? NoteCode::proven_reading : NoteCode::unusual_reading,
           fmt::format("{} taken as {}: {} ({} says otherwise)", what, chosen, why, option));
  }
  /// Does the same for a guess. Fails with ErrorKind::input under --strict.
  void guess(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
             bool unusual, bool proven = false) {
    if (settings_.strict)
      fail(ErrorKind::input, "{}: --strict, and the {} is a guess, {} ({}): give {}", path_, what, chosen, why, option);
    take_down(what, chosen, why, option, unusual, proven);
  }
  void note(NoteCode code, std::string text) { notes_.push_back({code, std::move(text), file_}); }

  Reading& reading_;
  const InputSettings& settings_;
  const RawPart& raw_;
  Evidence& seen_;
  View view_;
  const std::string path_;

 private:
  Notes& notes_;
  const std::string file_;
};

// Depth.

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
  std::string text_of_range() const {
    return fmt::format("all depth lies within 0 to 1 ({:.3g} to {:.3g})", values_.surfaces.least,
                       values_.surfaces.most);
  }
  static std::string straight(const DepthScore& score) {
    return fmt::format("as {} alone {:.0f} % of the smooth places are flat", word_of(score.kind), 100 * score.straight);
  }
  double straightness(const std::vector<DepthScore>& scores, DepthKind kind) const {
    if (reading_.camera.orthographic && kind == DepthKind::ray) kind = DepthKind::planar;
    const auto found = std::ranges::find(scores, kind, &DepthScore::kind);
    return found == scores.end() ? 0 : found->straight;
  }
  /// The straightness of flat surfaces if the depth falls from 1 at the eye to 0 at its far end.
  double straightness_from_1() const;
  /// The options that read normalized depth, and the meaning of their number.
  static std::string normalized_line(bool reversed) {
    return fmt::format("--depth-kind normalized{} --near 0 --far F, where F is the distance of {} in scene units",
                       reversed ? " --reversed-z" : "", reversed ? 0 : 1);
  }

  bool has_vectors() const { return raw_.normal.size() == 3 * raw_.window.pixels(); }

  const DepthFacts& facts_;
  const DepthValues& values_;
};

/// Decides an open kind: by flat surfaces, else by positions, else by normals, else by the program, else the usual
/// one.
void settle_depth_kind(const DepthSettlement& depth);

/// Settles scale and shift of disparity. Without a scale the median depth becomes 1. Fails with ErrorKind::input if the
/// shift is unknown.
void settle_disparity(const DepthSettlement& depth);

// Measures of the pixels: the rounding of depth, and the findings of the detectors.

/// Measures the rounding of a window's depth and stores it in `reading`: it affects the judgement of values, and the
/// nearest occluders. Positions are not measured. Fails with ErrorKind::input, with `name` for the depth, if it holds
/// 256 values at most, as a grey picture does.
Grain measure_rounding(Reading& reading, const Window& window, std::span<const float> depth, const std::string& name);

/// Takes down the step of depth between planes that was stored as integers. The kind of the depth must be settled.
void measure_levels(Reading& reading, std::span<const float> depth);

/// The findings of a walk over the pixels, for the detectors. The depth, called `name`, is settled; `has_read_normals`
/// says that the normals are.
Findings findings_of(const Reading& reading, const RawPart& raw, const Evidence& seen, const std::string& name,
                     bool has_read_normals);

}  // namespace alcove
