// Looks at pixels and headers for what harms AO.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/findings.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/exr_copy.h"
#include "core/frame/evidence.h"
#include "core/frame/settle.h"

namespace alcove {
namespace {

constexpr double kStep = 0.1;     // relative change of depth that is an edge
constexpr double kSmooth = 0.02;  // relative change within a surface
constexpr double kBetween = 0.1;  // part of a step within which a value belongs to the surface on that side
constexpr int kLeastEdges = 100;
constexpr double kMostBlended = 0.3;            // of the edges; thin things give some by themselves
constexpr double kMostShortened = 0.02;         // of the normals
constexpr double kMostOfOtherLength = 0.1;      // of normals that were all scaled alike; edges are shorter
constexpr std::size_t kEdgePixels = 1 << 18;    // of whole rows: enough for edges, and no cost beside reading
constexpr std::size_t kNormalPixels = 1 << 16;  // enough for shares to a percent

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

/// Depth that was averaged over the pixels, by some of its rows.
Notes averaged_depth(const FrameSource& source, std::span<const float> depth) {
  const int step = int(std::min<std::size_t>(source.data.pixels() / kEdgePixels + 1, std::size_t(source.data.height)));
  const View view = view_of(source.camera, source.data, source.display);
  const double blended = blended_edges(planar_depths(depth, depth_map_of(source), view, step), source.data.width);
  if (blended <= kMostBlended) return {};
  return {{NoteCode::antialiased_depth,
           fmt::format("{:.0f} % of the depth's edges have a pixel in between: the depth is anti-aliased, and AO shows "
                       "seams there; render it without filtering",
                       100 * blended)}};
}

/// The rows, or columns, along a border that have no surface.
struct BorderRows {
  int empty = 0;        // how many have none, and one value
  bool is_bar = false;  // the next one is mostly of surfaces, unlike that below a sky
};

BorderRows border_rows(const FrameSource& source, std::span<const float> depth, const DepthMap& map, bool columns,
                       bool last) {
  constexpr double kLeastSurfaces = 0.5;
  const int width = source.data.width, height = source.data.height;
  const int rows = columns ? width : height, across = columns ? height : width;
  const auto value = [&](int row, int i) {
    const int at = last ? rows - 1 - row : row;
    return depth[columns ? std::size_t(i) * std::size_t(width) + std::size_t(at)
                         : std::size_t(at) * std::size_t(width) + std::size_t(i)];
  };
  for (int row = 0; row < rows; row++) {
    int surfaces = 0;
    bool is_one = true;
    for (int i = 0; i < across; i++) {
      surfaces += std::isfinite(planar_depth(map, {value(row, i), 0, 0}, 1));
      is_one = is_one && !(value(row, i) != value(row, 0) && !std::isnan(value(row, i)));
    }
    if (surfaces == 0 && is_one) continue;
    return {row, surfaces >= kLeastSurfaces * across};
  }
  return {rows, false};
}

/// Bars above and below a picture, or on both its sides, that are as wide: a sky is on one side alone. Between them the
/// picture reaches both other borders; a thing before an empty background does not.
Notes letterbox(const FrameSource& source, std::span<const float> depth) {
  if (source.data != source.file_data || source[RawPlane::depth].size() != 1) return {};
  const DepthMap map = depth_map_of(source);
  for (const bool columns : {false, true}) {
    const auto border = [&](bool of_columns, bool is_last) {
      return border_rows(source, depth, map, of_columns, is_last);
    };
    const BorderRows first = border(columns, false), last = border(columns, true);
    if (!first.is_bar || !last.is_bar || first.empty == 0 || std::abs(first.empty - last.empty) > 1) continue;
    if (border(!columns, false).empty > 0 || border(!columns, true).empty > 0) continue;
    return {{NoteCode::letterbox_bars,
             fmt::format("the first {} and the last {} {} are empty: they look like bars around the picture, and count "
                         "as sky, so that AO next to them is too light; crop the file to the data window of what is "
                         "left, and keep its display window",
                         first.empty, last.empty, columns ? "columns" : "rows")}};
  }
  return {};
}

/// Normals that were averaged over the pixels, by some of them. It is no warning where the program does so always, for
/// nobody can have it do otherwise.
Notes averaged_normals(const FrameSource& source, std::span<const float> depth, std::span<const float> normal) {
  // Normals that lost components are short for that reason.
  if (!has_lengths(source) || std::ranges::count(source.notes, NoteCode::cut_normals, &Note::code) > 0) return {};
  std::size_t step = source.data.pixels() / kNormalPixels + 1;
  while (std::gcd(step, std::size_t(source.data.width)) > 1) step++;  // so that no column is favoured
  const NormalStatistics s = normal_statistics(normal, depth, depth_map_of(source), step);
  const double unit = source.normal_unorm ? s.unorm_unit_share : s.unit_share;
  if (!s.count || unit >= 1 - kMostShortened) return {};
  if (!source.normal_unorm && s.usual_share > 1 - kMostOfOtherLength)
    return {{NoteCode::scaled_normals,
             fmt::format("the normals' length is {:.3g} on {:.0f} %: they were scaled, and AO takes their direction "
                         "alone",
                         s.usual_length, 100 * s.usual_share),
             source.normal_file()}};
  const bool is_usual = source.rules->normal_averaged;
  return {{is_usual ? NoteCode::averaged_normals : NoteCode::shortened_normals,
           fmt::format("{:.0f} % of the normals are not of unit length: they were averaged over the pixel, at edges "
                       "over several surfaces{}",
                       100 * (1 - unit), is_usual ? ", as " + source.rules->name + " always does" : ""),
           source.normal_file()}};
}

/// What DWA has quantized, and where files end too early.
Notes damage(FrameSource& source) {
  Notes found;
  std::vector<std::set<int>> needed(source.files.size());
  for (const RawPlane plane : {RawPlane::depth, RawPlane::normal})
    for (const auto& channel : source[plane]) {
      needed[channel.file].insert(channel.part);
      if (is_lossy(source, channel))
        found.push_back(
            {NoteCode::lossy_compression,
             fmt::format("{} is compressed by DWA, which is lossy for a channel of that name; write data with zip",
                         channel.channel),
             plane == RawPlane::normal ? source.normal_file() : ""});
    }
  for (std::size_t file = 0; file < source.files.size(); file++)
    std::ranges::move(cut_parts(source.files[file], needed[file]), std::back_inserter(found));
  return found;
}

/// Windows that are not those of the depth.
Notes windows(const FrameSource& source) {
  Notes found;
  for (const auto& part : source.files[source[RawPlane::depth][0].file].parts())
    if (part.data != source.file_data) {
      found.push_back({NoteCode::windows_differ, fmt::format("part {} is {}, and the depth is {}", part.name,
                                                             to_string(part.data), to_string(source.file_data))});
      break;
    }
  if (source.file_data != source.display)
    found.push_back(
        {NoteCode::windows_differ,
         fmt::format("the data window is {} and the display window {}: AO is computed on the data window, and the "
                     "camera is for the display window",
                     to_string(source.file_data), to_string(source.display))});
  return found;
}

}  // namespace

bool has_lengths(const FrameSource& source) {
  return source[RawPlane::normal].size() == 3 &&
         (source.normal_encoding == NormalEncoding::signed_float || source.normal_encoding == NormalEncoding::unorm);
}

double blended_edges(std::span<const float> planar, int width) {
  int sharp = 0, blended = 0;
  const auto close = [](double a, double b) { return std::abs(a - b) < kSmooth * std::min(a, b); };
  for (std::size_t row = 0; row + std::size_t(width) <= planar.size(); row += std::size_t(width))
    for (int x = 2; x + 2 < width; x++) {
      const float* z = &planar[row + std::size_t(x)];
      if (std::any_of(z - 2, z + 3, [](float v) { return std::isinf(v); })) continue;
      const double before = z[-1], here = z[0], after = z[1];
      if (!close(z[-2], before) || !close(after, z[2]) || std::abs(after - before) < kStep * std::min(before, after))
        continue;
      const double place = (here - before) / (after - before);
      if (place > kBetween && place < 1 - kBetween) blended++;
      // An edge without a pixel in between is seen from both of its sides, and is counted once.
      else if (place <= kBetween)
        sharp++;
    }
  return sharp + blended < kLeastEdges ? 0 : double(blended) / (sharp + blended);
}

Notes findings(FrameSource& source, std::span<const float> depth, std::span<const float> normal) {
  Notes found;
  for (Notes some : {averaged_depth(source, depth), averaged_normals(source, depth, normal), letterbox(source, depth),
                     damage(source), windows(source)})
    std::ranges::move(some, std::back_inserter(found));
  return found;
}

}  // namespace alcove
