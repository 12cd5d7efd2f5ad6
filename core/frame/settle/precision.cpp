// Looks at depth for what its values cannot tell.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/precision.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/base/error.h"

namespace alcove {
namespace {

constexpr double kStep = 0.1;     // relative change of depth that is an edge
constexpr double kSmooth = 0.02;  // relative change within a surface
constexpr double kBetween = 0.1;  // part of a step within which a value belongs to the surface on that side
constexpr int kLeastEdges = 100;
constexpr double kMostBlended = 0.3;          // of the edges; thin things give some by themselves
constexpr std::size_t kEdgePixels = 1 << 18;  // of whole rows: enough for edges, and no cost beside reading

/// Refuses depth that was saved as a grey picture: it has no more than 256 distances.
void refuse_8_bits(std::span<const float> depth, const std::string& name) {
  constexpr std::size_t kLeastLevels = 16;  // fewer may be a few walls that happen to lie there
  std::set<double> levels;
  for (std::size_t i = 0; i < depth.size(); i += kSparse) {
    const double level = 255.0 * depth[i];
    if (!(level >= 0 && level <= 255) || std::abs(level - std::round(level)) > 1e-4) return;
    levels.insert(std::round(level));
  }
  if (levels.size() >= kLeastLevels)
    fail(ErrorKind::input,
         "{} holds only values of 8 bits, too few distances for AO: give --depth as floats, as EXR and DDS hold them",
         name);
}

/// Takes down how the values were rounded.
void take_down(Reading& reading, const Grain& grain, std::span<const float> depth) {
  reading.depth_is_coarse = grain.is_coarse;
  const auto is_beyond = [&](float d) { return std::abs(d) > kLargestHalf && std::abs(d) < reading.sky; };
  if (grain.is_half && std::ranges::none_of(depth, is_beyond)) reading.found_sky = kLargestHalf;
  if (!grain.is_coarse) return;
  if (grain.is_fixed)
    reading.depth_step = grain.step;
  else
    reading.depth_rounding =
        grain.is_half ? kHalfPrecision : 0.5 * std::exp2(std::ceil(std::log2(grain.step / grain.median)));
}

/// Notes values that are coarser than floats: half floats step by a 1024th of the power of two below the value.
Notes rounded_depth(const Reading& reading, const Grain& grain, const std::string& name) {
  if (!has_coarse_depth(reading) || grain.median == 0) return {};
  const bool has_half_type = reading.depth_is_half;
  const double step = grain.is_coarse ? grain.step : std::exp2(std::floor(std::log2(grain.median)) - 10);
  return {{NoteCode::half_depth,
           fmt::format("{} {}: at its median {:.4g} it changes in steps of {:.2g}, which AO shows as bands; {}", name,
                       has_half_type   ? "is stored as half float"
                       : grain.is_half ? "holds the values of half floats"
                                       : "was rounded",
                       grain.median, step,
                       has_half_type ? "write it as float" : "write it as float, without rounding it before")}};
}

/// Notes half floats whose sky may be surfaces: those beyond the largest number became infinite.
Notes overflown_depth(const Reading& reading, std::span<const float> depth, const std::string& name) {
  constexpr float kNear = 0.9f * float(kLargestHalf);
  if (!is_distance(reading.depth_kind) || !(reading.depth_is_half || reading.found_sky == kLargestHalf)) return {};
  std::size_t beyond = 0, near = 0;
  for (const float d : depth) {
    beyond += std::abs(d) >= kLargestHalf;
    near += std::abs(d) >= kNear && std::abs(d) < kLargestHalf;
  }
  if (!beyond || !near) return {};
  return {{NoteCode::overflown_depth,
           fmt::format(
               "{:.0f} % of {} is infinite or 65504, the largest half float, and surfaces reach up to it: what lies "
               "beyond counts as sky; write depth as float, or in larger units",
               100 * double(beyond) / double(depth.size()), name)}};
}

/// Notes depth that was sampled at random places within the pixels, or averaged over few of them.
Notes jittered_depth(const Reading& reading, const Window& window, std::span<const float> depth, const Grain& grain) {
  const View view = view_of(reading, window);
  const auto jitter = jitter_of(depth, depth_map_of(reading), view, grain);
  if (!jitter) return {};
  return {
      {NoteCode::jittered_depth,
       fmt::format("flat surfaces are not flat: their depth is off by {:.2f} of its step from pixel to pixel, as if it "
                   "was sampled at random places within the pixels; AO takes that for relief; render depth at the "
                   "pixels' centres, without a filter",
                   *jitter)}};
}

/// Depth that was averaged over the pixels, by some of its rows.
Notes averaged_depth(const Reading& reading, const Window& window, std::span<const float> depth) {
  const int step = int(std::min<std::size_t>(window.pixels() / kEdgePixels + 1, std::size_t(window.height)));
  const View view = view_of(reading, window);
  const double blended = blended_edges(planar_depths(depth, depth_map_of(reading), view, step), window.width);
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

BorderRows border_rows(const Window& window, std::span<const float> depth, const DepthMap& map, bool columns,
                       bool last) {
  constexpr double kLeastSurfaces = 0.5;
  const int width = window.width, height = window.height;
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
Notes letterbox(const Reading& reading, const Window& window, std::span<const float> depth) {
  if (window != reading.data || depth.size() != window.pixels()) return {};
  const DepthMap map = depth_map_of(reading);
  for (const bool columns : {false, true}) {
    const auto border = [&](bool of_columns, bool is_last) {
      return border_rows(window, depth, map, of_columns, is_last);
    };
    const BorderRows first = border(columns, false), last = border(columns, true);
    if (!first.is_bar || !last.is_bar || first.empty == 0 || std::abs(first.empty - last.empty) > 1) continue;
    if (border(!columns, false).empty > 0 || border(!columns, true).empty > 0) continue;
    return {{NoteCode::letterbox_bars,
             fmt::format("the first {} and the last {} {} are empty: they look like bars around the picture, and count "
                         "as sky, so that AO next to them is too light; crop the data window to the picture "
                         "between them, and keep the display window",
                         first.empty, last.empty, columns ? "columns" : "rows")}};
  }
  return {};
}

}  // namespace

Grain measure_rounding(Reading& reading, const Window& window, std::span<const float> depth, const std::string& name) {
  Grain grain;
  if (depth.size() == window.pixels()) {
    refuse_8_bits(depth, name);
    grain = grain_of(depth, reading.sky);
  }
  take_down(reading, grain, depth);
  return grain;
}

void measure_levels(Reading& reading, std::span<const float> depth) {
  if (is_between_planes(reading.depth_kind)) reading.depth_step = std::max(reading.depth_step, step_of(depth));
}

Notes precision_notes(const Reading& reading, const Window& window, std::span<const float> depth, const Grain& grain,
                      const std::string& name) {
  Notes notes;
  for (Notes some : {rounded_depth(reading, grain, name), overflown_depth(reading, depth, name),
                     jittered_depth(reading, window, depth, grain), averaged_depth(reading, window, depth),
                     letterbox(reading, window, depth)})
    std::ranges::move(some, std::back_inserter(notes));
  return notes;
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

}  // namespace alcove
