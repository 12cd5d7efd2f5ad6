// Looks at depth for what its values cannot tell.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/settlement.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "core/frame/pixels/detectors.h"
#include "core/frame/pixels/flatness.h"
#include "core/frame/pixels/ramps.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/pixels/walk.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

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
         "{} holds only values of 8 bits, too few distances for AO: give --depth as floats, in EXR or DDS{}", name,
         kDisparityHint);
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

}  // namespace

Grain measure_rounding(Reading& reading, const Window& window, std::span<const float> depth, const std::string& name) {
  Grain grain;
  if (depth.size() == window.pixels()) {
    if (reading.depth_kind != DepthKind::disparity) refuse_8_bits(depth, name);
    grain = grain_of(depth, reading.sky, reading.camera.orthographic);
  }
  take_down(reading, grain, depth);
  return grain;
}

void measure_levels(Reading& reading, std::span<const float> depth) {
  if (is_between_planes(reading.depth_kind) || reading.depth_kind == DepthKind::disparity)
    reading.depth_step = std::max(reading.depth_step, step_of(depth));
}

namespace {

Overflow overflow_of(const Reading& reading, std::span<const float> depth) {
  constexpr float kNear = 0.9f * float(kLargestHalf);
  if (!is_distance(reading.depth_kind) || !(reading.depth_is_half || reading.found_sky == kLargestHalf)) return {};
  std::size_t beyond = 0;
  bool is_reached = false;
  for (const float d : depth) {
    beyond += std::abs(d) >= kLargestHalf;
    is_reached |= std::abs(d) >= kNear && std::abs(d) < kLargestHalf;
  }
  return {double(beyond) / double(depth.size()), is_reached};
}

/// Whether most values are below 0 and are not read as distances from it.
bool begins_behind(const Reading& reading, std::span<const float> depth) {
  std::size_t below = 0, all = 0;
  for (std::size_t i = 0; i < depth.size(); i += kSparse) all++, below += depth[i] < 0;
  return !reading.depth_range.negative && 2 * below > all;
}

}  // namespace

Findings findings_of(const Reading& frame, const RawPart& raw, const Evidence& seen, const std::string& name,
                     bool has_read_normals) {
  const Reading reading = over(frame, raw.window);
  Findings found{.depth_channel = name,
                 .depth_kind = reading.depth_kind,
                 .has_half_type = reading.depth_is_half,
                 .grain = seen.grain,
                 .curve = seen.curve,
                 .begins_behind = begins_behind(reading, raw.depth),
                 .said_offset = said_offset(reading),
                 .overflow = overflow_of(reading, raw.depth)};
  if (reading.depth_kind == DepthKind::disparity)
    found.above_shift = seen.grain.median - reading.depth_range.disparity_shift.value_or(0);
  found.jitter = jitter_of(raw.depth, depth_map_of(reading), view_of(reading, raw.window), seen.grain);
  if (raw.window == frame.data && raw.depth.size() == raw.window.pixels())
    found.borders = borders_of(raw.depth, raw.window, depth_map_of(reading));
  const std::vector<float> cut = with_ramps_cut(reading, raw.depth);
  for (std::size_t i = 0; i < cut.size(); i++) found.cut_pixels += !std::isnan(cut[i]) && cut[i] != raw.depth[i];
  walk({reading, frame.data, reading.cuts_ramps ? std::span(cut) : raw.depth, raw.normal, has_read_normals}, found);
  return found;
}

}  // namespace alcove
