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

namespace alcove {
namespace {

/// All pixels of a picture are looked at if it has fewer than these.
constexpr std::size_t kFewPixels = 100'000;

Side side_of(std::vector<float> values) {
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

/// Refuses options of the user for a range that depth of this kind lacks. Presets serve frames of every kind.
void refuse_unused_range(const PlanesToSettle& planes) {
  auto unused = unused_range_options(planes.settings.depth_range, planes.reading.depth_kind);
  std::erase_if(unused, [&](const auto& option) { return planes.settings.from_presets.contains(option); });
  if (!unused.empty()) refuse_range_options(planes.path, unused, planes.reading.depth_kind);
}

void settle_plane(const DepthSettlement& depth, bool is_kind_open) {
  is_kind_open ? settle_depth_kind(depth) : doubt_depth_kind(depth);
  compare_near_planes(depth);
  settle_depth_ends(depth);
}

}  // namespace

DepthValues::DepthValues(std::span<const float> depth, double sky)
    : step(depth.size() < kFewPixels ? 1 : kSparse), all(statistics_of(depth, step)) {
  std::vector<float> below;
  for (std::size_t i = 0; i < depth.size(); i += step)
    if (std::isfinite(depth[i]) && depth[i] != 0 && std::abs(depth[i]) < sky)
      (depth[i] < 0 ? below : above_0).push_back(depth[i]);
  has_any = !below.empty() || !above_0.empty();
  surfaces = statistics_of(above_0);
  below_0 = side_of(std::move(below));
}

Side DepthValues::side_above(float limit) const {
  std::vector<float> above;
  std::ranges::copy_if(above_0, std::back_inserter(above), [&](float d) { return d > limit; });
  return side_of(std::move(above));
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
  return fmt::format("--depth-kind normalized{} --near 0 --far F, where F is the distance of {} in scene units",
                     reversed ? " --reversed-z" : "", reversed ? 0 : 1);
}

void settle_depth(const PlanesToSettle& planes, const DepthFacts& facts) {
  const auto depth = planes.raw.depth;
  const double sky = planes.settings.sky;
  const DepthValues values(depth, sky);
  planes.seen.tells = values.has_any;
  if (planes.reading.depth_kind == DepthKind::position) {
    settle_position_space(planes);
  } else {
    DepthShape shape = shape_of(depth, view_of(planes.reading, planes.raw.window), sky, planes.seen.grain);
    planes.seen.depth_scores = std::move(shape.scores);
    planes.seen.curve = shape.curve;
    const DepthSettlement depth(planes, facts, values);
    if (planes.reading.depth_kind == DepthKind::disparity) settle_disparity(depth);
    settle_plane(depth, facts.is_kind_open);
  }
  refuse_unused_range(planes);
}

}  // namespace alcove
