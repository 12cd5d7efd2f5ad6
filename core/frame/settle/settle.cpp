// The order of settling, and faults of files that it finds.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/settle.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/formats/exr.h"
#include "core/frame/find/behind.h"
#include "core/frame/find/position_pass.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/pixels/radius.h"
#include "core/frame/pixels/ramps.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"
#include "core/frame/settle/settlement.h"

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

// Faults that harm AO and that no depth shows.

constexpr double kMostShortened = 0.02;     // of the normals
constexpr double kMostOfOtherLength = 0.1;  // of normals that were all scaled alike; edges are shorter

bool is_lossy(const FrameSource& source, const ChannelRef& ref) {
  return source.part_of(ref).dwa && is_lossy_in_dwa(ref.channel);
}

/// Parts that the frame does not need and whose first or last rows cannot be read: of a file that was cut short behind
/// the frame's own parts. Those are read anyway.
Notes cut_parts(ExrFile& file, const std::set<int>& needed) {
  Notes found;
  for (std::size_t p = 0; p < file.parts().size(); p++) {
    const ExrPart& part = file.parts()[p];
    const auto channel = std::ranges::find(part.channels, false, &ExrChannel::subsampled);
    if (part.deep || channel == part.channels.end() || needed.contains(int(p))) continue;
    std::vector<float> row(std::size_t(part.data.width));
    const ExrRead read{int(p), channel->name, row.data()};
    try {
      for (const int y : {0, part.data.height - 1}) file.read({&read, 1}, y, 1);
    } catch (const Error& error) {
      found.push_back({NoteCode::damaged_file, error.what()});
    }
  }
  return found;
}

/// Normals that were averaged over the pixels, by some of them. It is no warning where the program does so always, for
/// nobody can have it do otherwise.
Notes averaged_normals(const FrameSource& source, const RawPart& raw) {
  // Normals that lost components are short for that reason.
  if (!has_lengths(source) || std::ranges::count(source.notes, NoteCode::cut_normals, &Note::code) > 0) return {};
  const NormalStatistics s =
      normal_statistics(raw.normal, raw.depth, depth_map_of(source.reading), even_step(raw.window, kNormalPixels));
  const double unit = source.reading.normal_unorm ? s.unorm_unit_share : s.unit_share;
  if (!s.count || unit >= 1 - kMostShortened) return {};
  const bool is_scaled = s.usual_share > 1 - kMostOfOtherLength && std::abs(s.usual_length - 1) > kUnitTolerance;
  if (!source.reading.normal_unorm && is_scaled)
    return {
        {NoteCode::scaled_normals,
         fmt::format("the normals' length is {:.3g} on {:.0f} %: they were scaled, and AO uses their direction only",
                     s.usual_length, 100 * s.usual_share),
         source.note_file(RawPlane::normal)}};
  const bool is_usual = source.program.rules->normal_averaged;
  return {{is_usual ? NoteCode::averaged_normals : NoteCode::shortened_normals,
           fmt::format("{:.0f} % of the normals are not of unit length: they were averaged over pixels, at edges over "
                       "several surfaces{}",
                       100 * (1 - unit), is_usual ? ", as " + source.program.rules->name + " always does" : ""),
           source.note_file(RawPlane::normal)}};
}

/// Channels that DWA has quantized, and files that end too early.
Notes damage(FrameSource& source) {
  Notes found;
  std::vector<std::set<int>> needed(source.files.size());
  for (const RawPlane plane : {RawPlane::depth, RawPlane::normal})
    for (const auto& channel : source.channels[plane]) {
      needed[channel.file].insert(channel.part);
      if (is_lossy(source, channel))
        found.push_back(
            {NoteCode::lossy_compression,
             fmt::format("{} is compressed by DWA, which is lossy for a channel of that name; write data with zip",
                         channel.channel),
             source.note_file(plane)});
    }
  for (std::size_t file = 0; file < source.files.size(); file++)
    std::ranges::move(cut_parts(source.files[file], needed[file]), std::back_inserter(found));
  return found;
}

/// Windows that are not those of the depth.
Notes windows(const FrameSource& source) {
  Notes found;
  for (const auto& part : source.file_of(source.channels[RawPlane::depth][0]).parts())
    if (part.data != source.reading.data) {
      found.push_back({NoteCode::windows_differ, fmt::format("part {} is {}, and the depth is {}", part.name,
                                                             to_string(part.data), to_string(source.reading.data))});
      break;
    }
  if (source.reading.data != source.reading.display)
    found.push_back(
        {NoteCode::windows_differ,
         fmt::format("the data window is {} and the display window {}: AO is computed on the data window, and the "
                     "camera is for the display window",
                     to_string(source.reading.data), to_string(source.reading.display))});
  return found;
}

/// Gives one sentence for each: shortened normals, channels that a lossy codec has damaged, other parts that are cut
/// short or have other windows, overscan and crops. The frame's meaning is settled.
Notes faults_of(FrameSource& source, const RawPart& raw) {
  Notes found;
  for (Notes some : {averaged_normals(source, raw), damage(source), windows(source)})
    std::ranges::move(some, std::back_inserter(found));
  return found;
}

// The order.

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

bool has_lengths(const FrameSource& source) {
  return source.channels[RawPlane::normal].size() == 3 &&
         (source.reading.normal_encoding == NormalEncoding::signed_float ||
          source.reading.normal_encoding == NormalEncoding::unorm);
}

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
  Reading& reading = source.reading;
  const DepthRange own = reading.depth_range;
  static_cast<Meaning&>(reading) = settled.reading;
  // The clip planes stay this frame's own, as its own camera has them; scale and shift of disparity are no camera's.
  if (reading.depth_kind != DepthKind::disparity)
    reading.depth_range.near = own.near, reading.depth_range.far = own.far;
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
