// Host side of reduce.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/reduce.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/chain/base/planes.h"
#include "kernels/results/results.h"

namespace alcove {
namespace {

/// Whether an AOV is filtered. The depths of first and of hidden surfaces are not.
bool is_filtered(const AovRow& row) {
  return row.planes != &FrameOutputs::depth && row.planes != &FrameOutputs::hidden;
}

/// At a distance from the middle, in widths of the filter: at most 1/2.
double weight_at(PixelFilterKind kind, double distance) {
  switch (kind) {
    case PixelFilterKind::box: return 1;
    case PixelFilterKind::gaussian: return std::exp(-8 * distance * distance);
    case PixelFilterKind::blackman_harris: {
      const double angle = 2 * std::numbers::pi * (distance + 0.5);
      return 0.35875 - 0.48829 * std::cos(angle) + 0.14128 * std::cos(2 * angle) - 0.01168 * std::cos(3 * angle);
    }
  }
  return 0;
}

/// The distance of a pixel from its block's middle, in widths of the filter. `pixel` counts along the block's row.
double distance_of(int pixel, double width, int factor) { return ((pixel + 0.5) / factor - 0.5) / width; }

}  // namespace

FilterWeights filter_weights(const PixelFilter& filter, int factor) {
  const double width = filter.width.value_or(usual_width(filter.kind));
  FilterWeights result;
  while (std::abs(distance_of(result.first - 1, width, factor)) <= 0.5) result.first--;
  for (int pixel = result.first; pixel < factor - result.first; pixel++)
    result.weights.push_back(float(weight_at(filter.kind, distance_of(pixel, width, factor))));
  return result;
}

int reduce_reach(const PixelFilter& filter, int factor) {
  return factor == 1 ? 0 : factor - filter_weights(filter, factor).first;
}

FrameOutputs reduce(gpu::Recorder& gpu, const FrameInputs& frame, const PixelFilter& filter, const FrameOutputs& out) {
  const int factor = frame.supersampling;
  if (factor == 1) return out;
  const FilterWeights along = filter_weights(filter, factor);
  gpu::Buffer& weights = gpu.buffer("filter weights", along.weights.size() * sizeof(float), gpu::Use::upload);
  std::ranges::copy(along.weights, weights.as<float>().begin());
  const auto within = [&](int place) { return (place % factor + factor) % factor; };
  ReduceParams params{};
  params.size = frame.view.size;
  params.offset = {within(frame.noise_origin.x), within(frame.noise_origin.y)};
  params.factor = factor;
  params.first = along.first;
  params.count = int(along.weights.size());
  FrameOutputs reduced = out;
  const auto filter_planes = [&](gpu::Buffer* FrameOutputs::*planes, const std::string& name) {
    if (!(out.*planes)) return;
    gpu::Buffer& result = gpu.buffer("reduced " + name, (out.*planes)->bytes());
    params.planes = planes_in(result, frame.view);
    gpu.dispatch("reduce", params, {{"Planes", out.*planes}, {"Weights", weights}, {"Result", result}},
                 {groups_of(params.size.x + params.offset.x, uint(factor)),
                  groups_of(params.size.y + params.offset.y, uint(factor))});
    reduced.*planes = &result;
  };
  for (const auto& row : kAovs)
    if (is_filtered(row)) filter_planes(row.planes, row.name);
  filter_planes(&FrameOutputs::color_ao, "color ao");
  return reduced;
}

}  // namespace alcove
