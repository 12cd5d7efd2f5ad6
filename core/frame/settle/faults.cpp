// Looks for faults that harm AO and that no depth shows.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/faults.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/formats/exr.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

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

}  // namespace

bool has_lengths(const FrameSource& source) {
  return source.channels[RawPlane::normal].size() == 3 &&
         (source.reading.normal_encoding == NormalEncoding::signed_float ||
          source.reading.normal_encoding == NormalEncoding::unorm);
}

Notes faults_of(FrameSource& source, const RawPart& raw) {
  Notes found;
  for (Notes some : {averaged_normals(source, raw), damage(source), windows(source)})
    std::ranges::move(some, std::back_inserter(found));
  return found;
}

}  // namespace alcove
