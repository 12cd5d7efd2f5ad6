// Hashes of planes, block by block, and the sums that tell kernels where they differ.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/reuse.h"

#include <xxhash.h>

#include <algorithm>
#include <utility>

#include "core/chain/pass_common.h"
#include "kernels/classify.h"

namespace alcove {
namespace {

/// Adds values to a hash, each by its own bytes: between the members of a struct there may be others.
template <class... T>
void add(std::uint64_t& hash, const T&... values) {
  static_assert((std::is_arithmetic_v<T> && ...));
  ((hash = XXH3_64bits_withSeed(&values, sizeof(values), hash)), ...);
}

void add(std::uint64_t& hash, const Matrix3& matrix) {
  for (const auto& row : matrix)
    for (const double value : row) add(hash, value);
}

void add(std::uint64_t& hash, const gpu::Buffer* plane) {
  add(hash, plane ? 1 : 0);
  if (plane) hash = XXH3_64bits_withSeed(plane->host().data(), plane->host().size(), hash);
}

/// Blocks in x and y.
ivec2 blocks_of(const View& view) {
  return {int(groups_of(view.size.x, uint(kChangeBlock))), int(groups_of(view.size.y, uint(kChangeBlock)))};
}

}  // namespace

LastFrame::Hashes LastFrame::hashes_of(const FrameInputs& f, const EstimatorSettings& settings) {
  Hashes hashes;
  const View& v = f.view;
  add(hashes.meaning, v.size.x, v.size.y, v.center.x, v.center.y, v.tangent_per_pixel.x, v.tangent_per_pixel.y,
      v.orthographic, f.noise_origin.x, f.noise_origin.y);
  const DepthMap& d = f.depth_map;
  add(hashes.meaning, d.form, d.along_ray, d.origin, d.base, d.slope, d.sky_below, d.sky_above, d.sky_depth, d.axis[0],
      d.axis[1], d.axis[2], d.eye_distance);
  for (const double at : f.depth_precision.at) add(hashes.meaning, at);
  add(hashes.meaning, int(f.normal_encoding), f.normal_unorm, f.has_alpha, f.albedo_value,
      f.normal ? planes_in(*f.normal, v) : 0);
  add(hashes.meaning, f.view_from_normal);
  add(hashes.meaning, f.aov_from_view);
  if (settings.noise == Noise::animated) add(hashes.meaning, f.frame);
  for (const auto* plane : {f.beauty, f.indirect, f.diffuse_color, f.material_ao, f.albedo}) add(hashes.colors, plane);

  const ivec2 count = blocks_of(v);
  hashes.blocks.assign(std::size_t(count.x) * std::size_t(count.y), 0);
  for (const auto* planes : {f.depth, f.normal}) {
    if (!planes) continue;
    const auto values = planes->as<const float>();
    for (std::size_t row = 0; row < values.size() / std::size_t(v.size.x); row++)
      for (int x = 0; x < count.x; x++) {
        const std::size_t begin = std::size_t(x) * kChangeBlock,
                          pixels = std::min(std::size_t(kChangeBlock), std::size_t(v.size.x) - begin);
        std::uint64_t& hash =
            hashes.blocks[row % std::size_t(v.size.y) / kChangeBlock * std::size_t(count.x) + std::size_t(x)];
        hash = XXH3_64bits_withSeed(&values[row * std::size_t(v.size.x) + begin], pixels * sizeof(float), hash);
      }
  }
  return hashes;
}

bool LastFrame::is_same(gpu::Recorder& gpu, FrameInputs& frame, const EstimatorSettings& settings) {
  Hashes now = hashes_of(frame, settings);
  const bool had = outputs_.has_value();
  if (had && now == last_) return true;
  forget();
  const Hashes before = std::exchange(last_, std::move(now));
  if (!had || before.meaning != last_.meaning) return false;
  const ivec2 count = blocks_of(frame.view);
  const int columns = count.x + 1;
  frame.changes =
      &gpu.buffer("changes", std::size_t(columns) * std::size_t(count.y + 1) * sizeof(uint), gpu::Use::upload);
  const auto sums = frame.changes->as<uint>();
  std::ranges::fill(sums, 0u);
  for (int y = 0; y < count.y; y++)
    for (int x = 0; x < count.x; x++) {
      const std::size_t block = std::size_t(y) * std::size_t(count.x) + std::size_t(x),
                        at = std::size_t(y + 1) * std::size_t(columns) + std::size_t(x + 1);
      sums[at] = (before.blocks[block] != last_.blocks[block] ? 1u : 0u) + sums[at - 1] +
                 sums[at - std::size_t(columns)] - sums[at - std::size_t(columns) - 1];
    }
  return false;
}

}  // namespace alcove
