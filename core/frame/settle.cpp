// Settles what is open about a frame, and looks at it for what harms AO.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/frame/deep.h"
#include "core/frame/evidence.h"
#include "core/frame/findings.h"
#include "core/frame/flatness.h"
#include "core/frame/radius.h"
#include "core/frame/sampling.h"
#include "core/frame/settlement.h"

namespace alcove {
namespace {

/// Refuses depth that was saved as a grey picture: it has no more than 256 distances.
void refuse_8_bits(const FrameSource& source, std::span<const float> depth) {
  if (source[RawPlane::depth].size() != 1) return;
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
         source.depth_path(), source[RawPlane::depth][0].channel);
}

/// Takes down how the values were rounded. It changes how they are judged, and how near occluders may be.
void measure_grain(FrameSource& source, const Grain& grain, std::span<const float> depth) {
  source.depth_is_coarse = grain.is_coarse;
  const auto is_beyond = [&](float d) { return std::abs(d) > kLargestHalf && std::abs(d) < source.sky; };
  if (grain.is_half && std::ranges::none_of(depth, is_beyond)) source.found_sky = kLargestHalf;
  if (!grain.is_coarse) return;
  if (grain.is_fixed)
    source.depth_step = grain.step;
  else
    source.depth_rounding =
        grain.is_half ? kHalfPrecision : 0.5 * std::exp2(std::ceil(std::log2(grain.step / grain.median)));
}

/// Notes values that are coarser than floats: half floats step by a 1024th of the power of two below the value.
void note_grain(FrameSource& source, const Grain& grain) {
  if (!has_coarse_depth(source) || grain.median == 0) return;
  const bool has_half_type = source.depth_is_half;
  const double step = grain.is_coarse ? grain.step : std::exp2(std::floor(std::log2(grain.median)) - 10);
  source.suspicious.push_back(
      {NoteCode::half_depth,
       fmt::format("{} {}: at its median {:.4g} it changes in steps of {:.2g}, which AO shows as bands; {}",
                   source[RawPlane::depth][0].channel,
                   has_half_type   ? "is stored as half float"
                   : grain.is_half ? "holds the values of half floats"
                                   : "was rounded",
                   grain.median, step,
                   has_half_type ? "write it as float" : "write it as float, without rounding it before")});
}

/// Notes half floats whose sky may be surfaces: those beyond the largest number became infinite.
void note_overflow(FrameSource& source, std::span<const float> depth) {
  constexpr float kNear = 0.9f * float(kLargestHalf);
  const bool has_distances = source.depth_kind == DepthKind::planar || source.depth_kind == DepthKind::ray;
  if (!has_distances || !(source.depth_is_half || source.found_sky == kLargestHalf)) return;
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
           100 * double(beyond) / double(depth.size()), source[RawPlane::depth][0].channel)});
}

/// Notes depth that was sampled at random places within the pixels, or averaged over few of them.
void note_jitter(FrameSource& source, std::span<const float> depth, const Grain& grain) {
  const View view = view_of(source.camera, source.data, source.display);
  const auto jitter = jitter_of(depth, depth_map_of(source), view, grain);
  if (!jitter) return;
  source.suspicious.push_back(
      {NoteCode::jittered_depth,
       fmt::format("flat surfaces are not flat: their depth is off by {:.2f} of its step from pixel to pixel, as if it "
                   "was sampled at random places within the pixels; AO takes that for relief; render depth at the "
                   "pixels' centres, without a filter",
                   *jitter)});
}

/// What depth and normals are, by the camera as it is.
void settle_meaning(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                    std::span<const float> normal) {
  settle_depth(source, settings, depth, normal);
  settle_deep(source, depth);
  if (source[RawPlane::normal].empty())
    note_centre(source);
  else
    settle_normals(source, settings, depth, normal);
}

/// As many rows from the middle of source.data as have room in so many bytes, twice: as they are read, and what is made
/// of them.
Window middle_rows(const FrameSource& source, std::uint64_t most_bytes) {
  constexpr std::uint64_t kLeastPixels = 1 << 18;  // fewer tell too little
  const Window& data = source.data;
  const std::uint64_t planes = source[RawPlane::depth].size() + source[RawPlane::normal].size();
  const std::uint64_t pixels =
      std::clamp<std::uint64_t>(most_bytes / (2 * sizeof(float) * planes), kLeastPixels, kEvidencePixels);
  const int rows = int(std::clamp<std::uint64_t>(pixels / std::uint64_t(data.width), 1, std::uint64_t(data.height)));
  return {data.x, data.y + (data.height - rows) / 2, data.width, rows};
}

}  // namespace

void settle(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
            std::span<const float> normal) {
  refuse_8_bits(source, depth);
  if (source[RawPlane::depth].size() == 1) source.grain = grain_of(depth, settings.sky);
  measure_grain(source, source.grain, depth);
  const std::string refutation = settle_camera(source, settings);
  try {
    settle_meaning(source, settings, depth, normal);
  } catch (const Error& error) {
    // By a wrong lens anything may look wrong.
    if (refutation.empty()) throw;
    fail(error.kind(), "{}; {}", error.what(), refutation);
  }
  note_grain(source, source.grain);
  note_overflow(source, depth);
  note_jitter(source, depth, source.grain);
  if (has_step(source.depth_kind)) source.depth_step = std::max(source.depth_step, step_of(depth));
  source.median_depth = median_depth(source, depth);
  std::ranges::move(findings(source, depth, normal), std::back_inserter(source.suspicious));
  source.settled = true;
}

void settle_by_planes(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                      std::span<const float> normal, std::uint64_t most_bytes) {
  const Window data = source.data;
  if (data.pixels() <= kEvidencePixels && depth.size_bytes() + normal.size_bytes() <= most_bytes)
    return settle(source, settings, depth, normal);
  source.data = middle_rows(source, most_bytes);
  settle(source, settings, cropped(depth, data, source.data), cropped(normal, data, source.data));
  source.data = data;
}

void settle_by_rows(FrameSource& source, const InputSettings& settings, std::uint64_t most_bytes) {
  const Window window = middle_rows(source, most_bytes);
  if (std::size_t(window.width) > kEvidencePixels)
    fail(ErrorKind::device, "{}: rows of {} pixels are more than Alcove takes on any --device", source.depth_path(),
         window.width);
  std::vector<float> depth(source[RawPlane::depth].size() * window.pixels()),
      normal(source[RawPlane::normal].size() * window.pixels());
  const Window data = std::exchange(source.data, window);
  read_planes(source, {{&source[RawPlane::depth], depth.data()}, {&source[RawPlane::normal], normal.data()}});
  settle(source, settings, depth, normal);
  source.data = data;
}

bool has_step(DepthKind kind) {
  return kind == DepthKind::device || kind == DepthKind::normalized || kind == DepthKind::log;
}

bool settle_like(FrameSource& source, const FrameSource& settled) {
  for (const RawPlane plane : {RawPlane::depth, RawPlane::normal})
    if (source[plane].size() != settled[plane].size()) return false;
  read_like(source, settled);
  read_deep_like_meaning(source);
  return source.settled = true;
}

}  // namespace alcove
