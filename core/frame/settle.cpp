// Settles what is open about a frame, and looks at it for what harms AO.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "core/frame/deep.h"
#include "core/frame/evidence.h"
#include "core/frame/findings.h"
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

/// Half floats step by a 1024th of the power of two below the value.
void note_half(FrameSource& source, std::span<const float> depth) {
  if (depth_rounding(source) != kHalfRounding) return;
  std::vector<float> values;
  for (std::size_t i = 0; i < source.data.pixels(); i += kSparse)
    if (std::isfinite(depth[i]) && depth[i] != 0 && std::abs(depth[i]) < 65504) values.push_back(std::abs(depth[i]));
  if (values.empty()) return;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  const double step = std::exp2(std::floor(std::log2(*middle)) - 10);
  source.suspicious.push_back(
      {NoteCode::half_depth,
       fmt::format("{} is stored as half float: at its median {:.4g} it changes in steps of {:.2g}, which AO shows as "
                   "bands; write it as float",
                   source[RawPlane::depth][0].channel, *middle, step)});
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

}  // namespace

void settle(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
            std::span<const float> normal) {
  refuse_8_bits(source, depth);
  const std::string refutation = settle_camera(source, settings);
  try {
    settle_meaning(source, settings, depth, normal);
  } catch (const Error& error) {
    // By a wrong lens anything may look wrong.
    if (refutation.empty()) throw;
    fail(error.kind(), "{}; {}", error.what(), refutation);
  }
  note_half(source, depth);
  source.depth_step = has_step(source.depth_kind) ? step_of(depth) : 0;
  source.median_depth = median_depth(source, depth);
  std::ranges::move(findings(source, depth, normal), std::back_inserter(source.suspicious));
  source.settled = true;
}

bool has_step(DepthKind kind) {
  return kind == DepthKind::device || kind == DepthKind::normalized || kind == DepthKind::log;
}

double depth_rounding(const Reading& reading) { return reading.depth_is_half ? kHalfRounding : kFloatRounding; }

bool settle_like(FrameSource& source, const FrameSource& settled) {
  for (const RawPlane plane : {RawPlane::depth, RawPlane::normal})
    if (source[plane].size() != settled[plane].size()) return false;
  read_like(source, settled);
  read_deep_like_meaning(source);
  return source.settled = true;
}

}  // namespace alcove
