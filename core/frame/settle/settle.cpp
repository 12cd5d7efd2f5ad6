// Settles what is open about a frame, and looks at it for what harms AO.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/settle.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/exr.h"
#include "core/frame/evidence.h"
#include "core/frame/find/behind.h"
#include "core/frame/find/position_pass.h"
#include "core/frame/settle/radius.h"

namespace alcove {

Settlement::Settlement(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen,
                       RawPlane about)
    : source_(source),
      reading_(source.reading),
      settings_(settings),
      raw_(raw),
      seen_(seen),
      view_(view_of(source.reading, raw.window)),
      about_(about) {}

void Settlement::note(NoteCode code, std::string text) {
  source_.notes.push_back({code, std::move(text), about_ == RawPlane::normal ? source_.normal_file() : ""});
}

void Settlement::take_down(const std::string& what, const std::string& chosen, const std::string& why,
                           const std::string& option, bool unusual, bool proven) {
  seen_.guesses.push_back({what, chosen, why, option});
  if (unusual)
    note(proven ? NoteCode::proven_reading : NoteCode::unusual_reading,
         fmt::format("{} taken as {}: {} ({} says otherwise)", what, chosen, why, option));
}

void Settlement::guess(const std::string& what, const std::string& chosen, const std::string& why,
                       const std::string& option, bool unusual, bool proven) {
  if (settings_.strict)
    fail(ErrorKind::input, "{}: --strict, and nothing says the {}; it would be {} ({}): give {}",
         about_ == RawPlane::normal ? normal_path() : depth_path(), what, chosen, why, option);
  take_down(what, chosen, why, option, unusual, proven);
}

// Faults that harm AO.

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
Notes averaged_depth(const FrameSource& source, const RawPart& raw) {
  const int step = int(std::min<std::size_t>(raw.window.pixels() / kEdgePixels + 1, std::size_t(raw.window.height)));
  const View view = view_of(source.reading, raw.window);
  const double blended =
      blended_edges(planar_depths(raw.depth, depth_map_of(source.reading), view, step), raw.window.width);
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

BorderRows border_rows(const RawPart& raw, const DepthMap& map, bool columns, bool last) {
  constexpr double kLeastSurfaces = 0.5;
  const int width = raw.window.width, height = raw.window.height;
  const int rows = columns ? width : height, across = columns ? height : width;
  const auto value = [&](int row, int i) {
    const int at = last ? rows - 1 - row : row;
    return raw.depth[columns ? std::size_t(i) * std::size_t(width) + std::size_t(at)
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
Notes letterbox(const FrameSource& source, const RawPart& raw) {
  if (raw.window != source.reading.data || source.channels[RawPlane::depth].size() != 1) return {};
  const DepthMap map = depth_map_of(source.reading);
  for (const bool columns : {false, true}) {
    const auto border = [&](bool of_columns, bool is_last) { return border_rows(raw, map, of_columns, is_last); };
    const BorderRows first = border(columns, false), last = border(columns, true);
    if (!first.is_bar || !last.is_bar || first.empty == 0 || std::abs(first.empty - last.empty) > 1) continue;
    if (border(!columns, false).empty > 0 || border(!columns, true).empty > 0) continue;
    return {{NoteCode::letterbox_bars,
             fmt::format("the first {} and the last {} {} are empty: they look like bars around the picture, and count "
                         "as sky, so that AO next to them is too light; crop the data window of the file to the "
                         "picture between them, and keep its display window",
                         first.empty, last.empty, columns ? "columns" : "rows")}};
  }
  return {};
}

/// Normals that were averaged over the pixels, by some of them. It is no warning where the program does so always, for
/// nobody can have it do otherwise.
Notes averaged_normals(const FrameSource& source, const RawPart& raw) {
  // Normals that lost components are short for that reason.
  if (!has_lengths(source) || std::ranges::count(source.notes, NoteCode::cut_normals, &Note::code) > 0) return {};
  std::size_t step = raw.window.pixels() / kNormalPixels + 1;
  while (std::gcd(step, std::size_t(raw.window.width)) > 1) step++;  // so that no column is favoured
  const NormalStatistics s = normal_statistics(raw.normal, raw.depth, depth_map_of(source.reading), step);
  const double unit = source.reading.normal_unorm ? s.unorm_unit_share : s.unit_share;
  if (!s.count || unit >= 1 - kMostShortened) return {};
  const bool is_scaled = s.usual_share > 1 - kMostOfOtherLength && std::abs(s.usual_length - 1) > kUnitTolerance;
  if (!source.reading.normal_unorm && is_scaled)
    return {
        {NoteCode::scaled_normals,
         fmt::format("the normals' length is {:.3g} on {:.0f} %: they were scaled, and AO uses their direction only",
                     s.usual_length, 100 * s.usual_share),
         source.normal_file()}};
  const bool is_usual = source.program.rules->normal_averaged;
  return {{is_usual ? NoteCode::averaged_normals : NoteCode::shortened_normals,
           fmt::format("{:.0f} % of the normals are not of unit length: they were averaged over the pixel, at edges "
                       "over several surfaces{}",
                       100 * (1 - unit), is_usual ? ", as " + source.program.rules->name + " always does" : ""),
           source.normal_file()}};
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
             plane == RawPlane::normal ? source.normal_file() : ""});
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

// The order of settling.

namespace {

/// Gives one sentence for each finding: anti-aliased depth, shortened normals, channels that a lossy codec has damaged,
/// other parts that are cut short or have other windows, overscan and crops. The frame's meaning is settled; of large
/// frames a part of the pixels is looked at.
Notes findings(FrameSource& source, const RawPart& raw) {
  Notes found;
  for (Notes some : {averaged_depth(source, raw), averaged_normals(source, raw), letterbox(source, raw), damage(source),
                     windows(source)})
    std::ranges::move(some, std::back_inserter(found));
  return found;
}

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

/// Notes values that are coarser than floats: half floats step by a 1024th of the power of two below the value.
void note_grain(FrameSource& source, const Grain& grain) {
  if (!has_coarse_depth(source.reading) || grain.median == 0) return;
  const bool has_half_type = source.reading.depth_is_half;
  const double step = grain.is_coarse ? grain.step : std::exp2(std::floor(std::log2(grain.median)) - 10);
  source.suspicious.push_back(
      {NoteCode::half_depth,
       fmt::format("{} {}: at its median {:.4g} it changes in steps of {:.2g}, which AO shows as bands; {}",
                   source.channels[RawPlane::depth][0].channel,
                   has_half_type   ? "is stored as half float"
                   : grain.is_half ? "holds the values of half floats"
                                   : "was rounded",
                   grain.median, step,
                   has_half_type ? "write it as float" : "write it as float, without rounding it before")});
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

/// Notes depth that was sampled at random places within the pixels, or averaged over few of them.
void note_jitter(FrameSource& source, const RawPart& raw, const Grain& grain) {
  const View view = view_of(source.reading, raw.window);
  const auto jitter = jitter_of(raw.depth, depth_map_of(source.reading), view, grain);
  if (!jitter) return;
  source.suspicious.push_back(
      {NoteCode::jittered_depth,
       fmt::format("flat surfaces are not flat: their depth is off by {:.2f} of its step from pixel to pixel, as if it "
                   "was sampled at random places within the pixels; AO takes that for relief; render depth at the "
                   "pixels' centres, without a filter",
                   *jitter)});
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
  } catch (const Error& error) {
    // By a wrong lens anything may look wrong.
    if (refutation.empty()) throw;
    fail(error.kind(), "{}; {}", error.what(), refutation);
  }
  note_grain(source, grain);
  note_overflow(source, raw.depth);
  note_jitter(source, raw, grain);
  Reading& reading = source.reading;
  if (is_between_planes(reading.depth_kind)) reading.depth_step = std::max(reading.depth_step, step_of(raw.depth));
  seen.median_depth = median_depth(over(reading, raw.window), raw.depth);
  std::ranges::move(findings(source, raw), std::back_inserter(source.suspicious));
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
