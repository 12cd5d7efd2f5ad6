// Hashes of planes, block by block, and the sums that tell kernels where they differ.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/reuse.h"

#include <xxhash.h>

#include <algorithm>
#include <utility>

#include "core/chain/base/planes.h"
#include "kernels/estimate/estimate.h"

namespace alcove {
namespace {

/// Adds values to a hash, each by its own bytes: between the members of a struct there may be padding.
template <class... T>
void add(std::uint64_t& hash, const T&... values) {
  static_assert((std::is_arithmetic_v<T> && ...));
  ((hash = XXH3_64bits_withSeed(&values, sizeof(values), hash)), ...);
}

/// The parameters of kernels are hashed as a whole, since they have no padding.
void add(std::uint64_t& hash, const PrepareParams& params) {
  hash = XXH3_64bits_withSeed(&params, sizeof(params), hash);
}

void add(std::uint64_t& hash, const LayerTerms& terms) {
  static_assert(std::has_unique_object_representations_v<uint> && sizeof(DepthTerms) == 10 * sizeof(float));
  add(hash, terms.form, std::uint32_t(terms.kind));
  hash = XXH3_64bits_withSeed(&terms.depth, sizeof(terms.depth), hash);
}

void add(std::uint64_t& hash, const Matrix3& matrix) {
  for (const auto& row : matrix)
    for (const double value : row) add(hash, value);
}

void add(std::uint64_t& hash, const gpu::Buffer* plane) {
  add(hash, plane ? 1 : 0);
  if (plane) hash = XXH3_64bits_withSeed(plane->host().data(), plane->host().size(), hash);
}

/// All of what another frame or view sees: any of it may count for any pixel.
void add(std::uint64_t& hash, const OtherView& other) {
  add(hash, other.view.size.x, other.view.size.y, other.view.center.x, other.view.center.y,
      other.view.tangent_per_pixel.x, other.view.tangent_per_pixel.y, other.view.orthographic, other.depth_precision.x,
      other.depth_precision.y, other.depth_precision.z);
  for (const auto& row : other.to_here)
    for (const float value : row) add(hash, value);
  if (other.content != 0)
    add(hash, other.content);
  else
    for (const gpu::Buffer* plane : {other.depth, other.normal, other.moving}) add(hash, plane);
}

/// Blocks in x and y.
ivec2 blocks_of(const View& view) {
  return {int(groups_of(view.size.x, uint(kChangeBlock))), int(groups_of(view.size.y, uint(kChangeBlock)))};
}

/// Adds to each block's hash what it holds of planes that lie one behind the other, row by row.
void add_blocks(std::vector<std::uint64_t>& blocks, const gpu::Buffer& planes, ivec2 size) {
  const auto values = planes.as<const float>();
  const auto width = std::size_t(size.x);
  const std::size_t columns = groups_of(size.x, uint(kChangeBlock));
  for (std::size_t row = 0; row < values.size() / width; row++) {
    const std::size_t first = row % std::size_t(size.y) / kChangeBlock * columns;
    for (std::size_t x = 0; x < columns; x++) {
      const std::size_t begin = x * kChangeBlock;
      const std::size_t pixels = std::min(std::size_t(kChangeBlock), width - begin);
      std::uint64_t& hash = blocks[first + x];
      hash = XXH3_64bits_withSeed(&values[row * width + begin], pixels * sizeof(float), hash);
    }
  }
}

}  // namespace

LastFrame::Hashes LastFrame::hashes_of(const FrameInputs& frame, const EstimatorSettings& settings) {
  Hashes hashes;
  add(hashes.meaning, frame.prepare);
  add(hashes.meaning, frame.depth_map.form, frame.normal_form, frame.noise_origin.x, frame.noise_origin.y,
      frame.albedo_value, frame.behind_lists_all);
  for (const double at : frame.depth_precision.at) add(hashes.meaning, at);
  for (const double at : frame.hidden_precision.at) add(hashes.meaning, at);
  for (const auto& terms : frame.behind) add(hashes.meaning, terms);
  add(hashes.meaning, frame.aov_from_view);
  for (const auto& other : frame.others) add(hashes.meaning, other);
  for (const auto* matte : {&frame.matte, &frame.occluders}) {
    add(hashes.meaning, std::uint32_t(matte->kind), matte->outside, matte->ignores);
    for (const std::uint32_t object : matte->objects) add(hashes.meaning, object);
  }
  for (const auto& light : frame.ambient) add(hashes.colors, light.weight, light.color);
  for (const auto* plane : frame.planes.entries) add(hashes.meaning, plane ? planes_in(*plane, frame.view) : 0u);
  if (settings.noise == Noise::animated) add(hashes.meaning, frame.frame);
  hashes.blocks.assign(std::size_t(blocks_of(frame.view).x) * std::size_t(blocks_of(frame.view).y), 0);
  for (const auto& row : kRawPlanes) {
    const gpu::Buffer* plane = frame[row.plane];
    if (row.content == PlaneContent::color)
      add(hashes.colors, plane);
    else if (row.content == PlaneContent::selection)
      add(hashes.meaning, plane);
    else if (plane)
      add_blocks(hashes.blocks, *plane, frame.view.size);
  }
  return hashes;
}

bool LastFrame::is_worth_comparing(const FrameInputs& frame) const {
  constexpr double kBytesPerMs = 4e6;  // that are hashed; half of what was measured
  double bytes = 0;
  for (const auto* plane : frame.planes.entries) bytes += plane ? double(plane->bytes()) : 0;
  return ms_ == 0 || ms_ > bytes / kBytesPerMs;
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
      const std::size_t block = std::size_t(y) * std::size_t(count.x) + std::size_t(x);
      const std::size_t at = std::size_t(y + 1) * std::size_t(columns) + std::size_t(x + 1);
      sums[at] = (before.blocks[block] != last_.blocks[block] ? 1u : 0u) + sums[at - 1] +
                 sums[at - std::size_t(columns)] - sums[at - std::size_t(columns) - 1];
    }
  return false;
}

}  // namespace alcove
