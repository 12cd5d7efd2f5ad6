// The order of settling.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/settle.h"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/formats/exr.h"
#include "core/frame/find/behind.h"
#include "core/frame/find/position_pass.h"
#include "core/frame/pixels/detectors.h"
#include "core/frame/pixels/radius.h"
#include "core/frame/pixels/ramps.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/depth_settlement.h"
#include "core/frame/settle/faults.h"
#include "core/frame/settle/precision.h"

namespace alcove {

namespace {

const std::string& depth_channel(const FrameSource& source) { return source.channels[RawPlane::depth][0].channel; }

/// What the walk over the frame's pixels shows. The depth is settled; `has_read_normals` says that the normals are.
Findings findings_of(const FrameSource& source, const RawPart& raw, const Evidence& seen, bool has_read_normals) {
  Findings found = findings_of(source.reading, raw, seen, depth_channel(source), has_read_normals);
  found.other_depths = other_depths(source);
  return found;
}

/// Adds what the detectors say of a settled frame.
void note_findings(FrameSource& source, const RawPart& raw, const Evidence& seen) {
  for (Note& note : detected(findings_of(source, raw, seen, true))) {
    note.file = source.note_file(note.code == NoteCode::displaced_normals ? RawPlane::normal : RawPlane::depth);
    source.suspicious.push_back(std::move(note));
  }
}

/// The faults of a frame that cannot be settled, which may be the reason: "; ..." for each.
std::string reasons_of(const FrameSource& source, const RawPart& raw, const Evidence& seen) {
  std::string text;
  const bool is_inverse = std::ranges::any_of(seen.guesses, [](const Guess& guess) {
    return guess.what == "depth kind" && guess.chosen == word_of(DepthKind::inverse);
  });
  if (is_inverse && source.program.depth_kind != DepthKind::inverse && !source.reading.camera.orthographic)
    text = fmt::format("; its flat surfaces show 1/z, and {}", kOrthographicHint);
  try {
    for (const Note& note : detected(findings_of(source, raw, seen, false))) text += "; " + note.text;
  } catch (const Error&) {  // the depth has no meaning yet
  }
  return text;
}

/// Settles depth and normals by the camera as it is.
void settle_meaning(FrameSource& source, const InputSettings& settings, const RawPart& raw,
                    std::span<const SeenPoint> points, Evidence& seen) {
  settle_depth(
      {source.reading, source.notes, settings, raw, seen, source.depth_path(), source.note_file(RawPlane::depth)},
      {source.program, source.open.depth_kind, [&] { return kind_by_positions(source, settings, raw, points); }});
  settle_deep(source, raw);
  if (source.channels[RawPlane::normal].empty())
    note_centre(source);
  else
    settle_normals(source, settings, raw, seen);
}

/// Gives as many rows from the middle of a frame as fit into so many bytes twice: as they are read, and their results.
Window middle_rows(const FrameSource& source, std::uint64_t most_bytes) {
  constexpr std::uint64_t kLeastPixels = 1 << 18;  // fewer tell too little
  const Window& data = source.reading.data;
  const std::uint64_t planes = source.channels[RawPlane::depth].size() + source.channels[RawPlane::normal].size();
  const std::uint64_t pixels =
      std::clamp<std::uint64_t>(most_bytes / (2 * sizeof(float) * planes), kLeastPixels, kEvidencePixels);
  const int rows = int(std::clamp<std::uint64_t>(pixels / std::uint64_t(data.width), 1, std::uint64_t(data.height)));
  return {data.x, data.y + (data.height - rows) / 2, data.width, rows};
}

}  // namespace

void settle(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen) {
  seen.grain =
      measure_rounding(source.reading, raw.window, raw.depth, source.depth_path() + ": " + depth_channel(source));
  const std::vector<SeenPoint> points = points_to_check(source, settings.sky);
  const std::string refutation = settle_camera(source, settings, points);
  try {
    settle_meaning(source, settings, raw, points, seen);
  } catch (const NoWorldToCamera&) {
    throw;
  } catch (const Error& error) {
    // By a wrong lens, and from pixels that are no depth's, anything may look wrong.
    const std::string why = (refutation.empty() ? "" : "; " + refutation) + reasons_of(source, raw, seen);
    if (why.empty()) throw;
    fail(error.kind(), "{}{}", error.what(), why);
  }
  check_by_positions(source, settings, raw, points);
  note_findings(source, raw, seen);
  measure_levels(source.reading, raw.depth);
  seen.median_depth = median_depth(over(source.reading, raw.window), raw.depth);
  std::ranges::move(faults_of(source, raw), std::back_inserter(source.suspicious));
}

void settle(FrameSource& source, const InputSettings& settings, const RawPart& raw) {
  Evidence seen;
  settle(source, settings, raw, seen);
  source.evidence = std::move(seen);
}

void settle_by_planes(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                      std::span<const float> normal, std::uint64_t most_bytes) {
  const Window& data = source.reading.data;
  if (depth.size() % data.pixels() != 0)
    fail(ErrorKind::input, "{}: a part of a frame cannot decide how it is read", source.depth_path());
  if (data.pixels() <= kEvidencePixels && depth.size_bytes() + normal.size_bytes() <= most_bytes)
    return settle(source, settings, {data, depth, normal});
  const Window rows = middle_rows(source, most_bytes);
  settle(source, settings, {rows, cropped(depth, data, rows), cropped(normal, data, rows)});
}

void settle_by_rows(FrameSource& source, const InputSettings& settings, std::uint64_t most_bytes) {
  const Window rows = middle_rows(source, most_bytes);
  if (std::size_t(rows.width) > kEvidencePixels)
    fail(ErrorKind::device, "{}: rows of {} pixels are more than Alcove takes on any --device", source.depth_path(),
         rows.width);
  const RawFrame raw = read_raw_frame(source, rows);
  settle(source, settings, raw);
}

HostFrame read_host_frame(const InputSettings& settings, int number) {
  FrameSource source = find_frame(settings, false, number);
  const Window& data = source.reading.data;
  require_host_room(source.depth_path(), data);
  RawFrame raw = read_raw_frame(source, data);
  settle(source, settings, raw);
  cut_ramps(source.reading, raw.depth);
  return {source.reading, std::move(raw.depth), std::move(raw.normal), {}, number};
}

bool settle_like(FrameSource& source, const FrameSource& settled) {
  for (const RawPlane plane : {RawPlane::depth, RawPlane::normal})
    if (source.channels[plane].size() != settled.channels[plane].size()) return false;
  read_like(source.reading, settled.reading);
  read_deep_like_meaning(source);
  source.evidence = settled.evidence;
  return true;
}

bool settle_like_or_alone(FrameSource& source, const FrameSource& settled, const InputSettings& settings,
                          std::uint64_t most_bytes) {
  const bool is_open = settled.reading.depth_kind == DepthKind::disparity && !disparity_of(settings.depth_range).shift;
  if (!is_open) return settle_like(source, settled);
  const Notes notes = source.notes, suspicious = source.suspicious;
  try {
    settle_by_rows(source, settings, most_bytes);
    const DepthRange &own = source.reading.depth_range, &other = settled.reading.depth_range;
    const double apart = std::abs(*own.disparity_shift - *other.disparity_shift);
    if (source.evidence->tells && apart > own.disparity_error + other.disparity_error) {
      source.notes.push_back({NoteCode::unusual_reading,
                              fmt::format("disparity's shift is {:.5g} here, and {:.5g} in the sequence: AO may change "
                                          "from frame to frame (--set disparity-shift sets one for all)",
                                          *own.disparity_shift, *other.disparity_shift)});
      return false;
    }
  } catch (const Error&) {  // it does not tell
  }
  source.notes = notes;
  source.suspicious = suspicious;
  return settle_like(source, settled);
}

}  // namespace alcove
