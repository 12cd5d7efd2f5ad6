// The order of settling.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/settle.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/exr.h"
#include "core/frame/find/behind.h"
#include "core/frame/find/position_pass.h"
#include "core/frame/pixels/detectors.h"
#include "core/frame/pixels/empty.h"
#include "core/frame/pixels/flatness.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/radius.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/pixels/walk.h"
#include "core/frame/samples.h"
#include "core/frame/settle/faults.h"

namespace alcove {

namespace {

/// Refuses depth that was saved as a grey picture: it has no more than 256 distances.
void refuse_8_bits(const FrameSource& source, std::span<const float> depth) {
  if (source.channels[RawPlane::depth].size() != 1) return;
  constexpr std::size_t kLeastLevels = 16;  // fewer may be a few walls that happen to lie there
  std::set<double> levels;
  for (std::size_t i = 0; i < depth.size(); i += kSparse) {
    const double level = 255.0 * depth[i];
    if (!(level >= 0 && level <= 255) || std::abs(level - std::round(level)) > 1e-4) return;
    levels.insert(std::round(level));
  }
  if (levels.size() >= kLeastLevels)
    fail(ErrorKind::input,
         "{}: {} holds only values of 8 bits, too few distances for AO: save depth as EXR, or as DDS (--depth)",
         source.depth_path(), source.channels[RawPlane::depth][0].channel);
}

/// Takes down how the values were rounded. It changes how they are judged, and how near occluders may be.
void measure_grain(FrameSource& source, const Grain& grain, std::span<const float> depth) {
  source.reading.depth_is_coarse = grain.is_coarse;
  const auto is_beyond = [&](float d) { return std::abs(d) > kLargestHalf && std::abs(d) < source.reading.sky; };
  if (grain.is_half && std::ranges::none_of(depth, is_beyond)) source.reading.found_sky = kLargestHalf;
  if (!grain.is_coarse) return;
  if (grain.is_fixed)
    source.reading.depth_step = grain.step;
  else
    source.reading.depth_rounding =
        grain.is_half ? kHalfPrecision : 0.5 * std::exp2(std::ceil(std::log2(grain.step / grain.median)));
}

/// Notes half floats whose sky may be surfaces: those beyond the largest number became infinite.
void note_overflow(FrameSource& source, std::span<const float> depth) {
  constexpr float kNear = 0.9f * float(kLargestHalf);
  if (!is_distance(source.reading.depth_kind) ||
      !(source.reading.depth_is_half || source.reading.found_sky == kLargestHalf))
    return;
  std::size_t beyond = 0, near = 0;
  for (const float d : depth) {
    beyond += std::abs(d) >= kLargestHalf;
    near += std::abs(d) >= kNear && std::abs(d) < kLargestHalf;
  }
  if (!beyond || !near) return;
  source.suspicious.push_back(
      {NoteCode::overflown_depth,
       fmt::format(
           "{:.0f} % of {} is infinite or 65504, the largest half float, and surfaces reach up to it: what lies "
           "beyond counts as sky; write depth as float, or in larger units",
           100 * double(beyond) / double(depth.size()), source.channels[RawPlane::depth][0].channel)});
}

/// What the walk over the frame's pixels shows. The depth is settled; `has_read_normals` says that the normals are.
Findings findings_of(const FrameSource& source, const RawPart& raw, const Evidence& seen, bool has_read_normals) {
  const Reading reading = over(source.reading, raw.window);
  const ChannelRef& channel = source.channels[RawPlane::depth][0];
  Findings found{.depth_channel = channel.channel,
                 .depth_kind = reading.depth_kind,
                 .has_half_type = reading.depth_is_half,
                 .other_depths = other_depths(source),
                 .grain = seen.grain,
                 .curve = seen.curve,
                 .said_offset = said_offset(reading)};
  found.jitter = jitter_of(raw.depth, depth_map_of(reading), view_of(reading, raw.window), seen.grain);
  if (raw.window == source.reading.data && source.channels[RawPlane::depth].size() == 1)
    found.borders = borders_of(raw.depth, raw.window, depth_map_of(reading));
  walk({reading, raw.depth, raw.normal, has_read_normals}, found);
  return found;
}

/// Adds what the detectors say of a settled frame.
void note_findings(FrameSource& source, const RawPart& raw, const Evidence& seen) {
  for (Note& note : detected(findings_of(source, raw, seen, true))) {
    if (note.code == NoteCode::displaced_normals) note.file = source.normal_file();
    source.suspicious.push_back(std::move(note));
  }
}

/// The faults of a frame that cannot be settled, which may be the reason: "; ..." for each.
std::string reasons_of(const FrameSource& source, const RawPart& raw, const Evidence& seen) {
  std::string text;
  try {
    for (const Note& note : detected(findings_of(source, raw, seen, false))) text += "; " + note.text;
  } catch (const Error&) {  // the depth has no meaning yet
  }
  return text;
}

/// Settles depth and normals by the camera as it is.
void settle_meaning(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen) {
  settle_depth(source, settings, raw, seen);
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
  Grain& grain = seen.grain;
  refuse_8_bits(source, raw.depth);
  if (source.channels[RawPlane::depth].size() == 1) grain = grain_of(raw.depth, settings.sky);
  measure_grain(source, grain, raw.depth);
  const std::string refutation = settle_camera(source, settings);
  try {
    settle_meaning(source, settings, raw, seen);
  } catch (const NoWorldToCamera&) {
    throw;
  } catch (const Error& error) {
    // By a wrong lens, and from pixels that are no depth's, anything may look wrong.
    const std::string why = (refutation.empty() ? "" : "; " + refutation) + reasons_of(source, raw, seen);
    if (why.empty()) throw;
    fail(error.kind(), "{}{}", error.what(), why);
  }
  note_overflow(source, raw.depth);
  note_findings(source, raw, seen);
  Reading& reading = source.reading;
  if (is_between_planes(reading.depth_kind)) reading.depth_step = std::max(reading.depth_step, step_of(raw.depth));
  seen.median_depth = median_depth(over(reading, raw.window), raw.depth);
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
    fail(ErrorKind::input, "{}: a part of a frame cannot settle it", source.depth_path());
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

}  // namespace alcove
