// The order in which a frame's depth is settled.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/flatness.h"
#include "core/frame/samples.h"
#include "core/frame/settle/depth_settlement.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

/// All pixels of a picture are looked at if it has fewer than these.
constexpr std::size_t kFewPixels = 100'000;

/// Sorts the values.
Side side_of(std::vector<float>& values) {
  Side side{values.size(), values.size()};
  std::ranges::sort(values);
  for (auto first = values.begin(); first != values.end();) {
    const auto next = std::upper_bound(first, values.end(), *first);
    const std::size_t others = values.size() - std::size_t(next - first);
    if (others < side.others) side.others = others, side.usual = *first;
    first = next;
  }
  return side;
}

}  // namespace

DepthValues::DepthValues(std::span<const float> depth, double sky)
    : step(depth.size() < kFewPixels ? 1 : kSparse), all(statistics_of(depth, step)) {
  std::vector<float> below, above;
  for (std::size_t i = 0; i < depth.size(); i += step)
    if (std::isfinite(depth[i]) && depth[i] != 0 && std::abs(depth[i]) < sky)
      (depth[i] < 0 ? below : above).push_back(depth[i]);
  has_any = !below.empty() || !above.empty();
  surfaces = statistics_of(above);
  below_0 = side_of(below);
  above_0 = side_of(above);
  above.erase(above.begin(), std::ranges::upper_bound(above, 1.0f));
  above_1 = side_of(above);
}

std::string DepthSettlement::text_of_range() const {
  return fmt::format("all depth lies within 0 to 1 ({:.3g} to {:.3g})", values_.surfaces.least, values_.surfaces.most);
}

std::string DepthSettlement::straight(const DepthScore& score) const {
  return fmt::format("as {} alone {:.0f} % of the smooth places are flat", word_of(score.kind), 100 * score.straight);
}

double DepthSettlement::straightness(const std::vector<DepthScore>& scores, DepthKind kind) const {
  if (reading_.camera.orthographic && kind == DepthKind::ray) kind = DepthKind::planar;
  const auto found = std::ranges::find(scores, kind, &DepthScore::kind);
  return found == scores.end() ? 0 : found->straight;
}

double DepthSettlement::straightness_from_1() const {
  std::vector<float> turned(raw_.depth.begin(), raw_.depth.end());
  for (float& d : turned) d = d > 0 && d < 1 ? 1 - d : 0;
  return straightness(shape_of(turned, view_, settings_.sky, seen_.grain).scores, DepthKind::planar);
}

std::string DepthSettlement::normalized_line(bool reversed) {
  return fmt::format(
      "--depth-kind normalized{} --near 0 --far F, where F is the distance, in scene units, that {} stands for",
      reversed ? " --reversed-z" : "", reversed ? 0 : 1);
}

void settle_depth(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen) {
  const Settlement settlement(source, settings, raw, seen);
  const DepthValues values(raw.depth, settings.sky);
  seen.tells = values.has_any;
  if (source.reading.depth_kind == DepthKind::position) {
    settle_position_space(settlement);
  } else {
    DepthShape shape = shape_of(raw.depth, view_of(source.reading, raw.window), settings.sky, seen.grain);
    seen.depth_scores = std::move(shape.scores);
    seen.curve = shape.curve;
    source.open.depth_kind ? settle_depth_kind(settlement, values) : doubt_depth_kind(settlement, values);
    compare_near_planes(settlement, values);
    settle_depth_ends(settlement, values);
  }
  refuse_unused_range(source.depth_path(), settings, source.reading.depth_kind);
}

}  // namespace alcove
