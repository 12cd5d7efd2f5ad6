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

void add(std::uint64_t& hash, const gpu::Buffer& plane) {
  hash = XXH3_64bits_withSeed(plane.host().data(), plane.host().size(), hash);
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

LastFrame::Past LastFrame::past_of(const FrameInputs& frame, const EstimatorSettings& settings) {
  Past past;
  past.whole.recipe = frame;
  if (settings.noise == Noise::animated) past.whole.noise_frame = frame.frame;
  past.blocks.assign(std::size_t(blocks_of(frame.view).x) * std::size_t(blocks_of(frame.view).y), 0);
  for (const auto& row : kRawPlanes) {
    const gpu::Buffer* plane = frame[row.plane];
    if (!plane) continue;
    past.whole.bytes[std::size_t(row.plane)] = plane->bytes();
    if (row.content == PlaneContent::geometry)
      add_blocks(past.blocks, *plane, frame.view.size);
    else
      add(row.content == PlaneContent::color ? past.colors : past.whole.selection, *plane);
  }
  return past;
}

bool LastFrame::is_worth_comparing(const FrameInputs& frame) const {
  constexpr double kBytesPerMs = 4e6;  // that are hashed; half of what was measured
  double bytes = 0;
  for (const auto* plane : frame.planes.entries) bytes += plane ? double(plane->bytes()) : 0;
  return ms_ == 0 || ms_ > bytes / kBytesPerMs;
}

bool LastFrame::is_same(gpu::Recorder& gpu, FrameInputs& frame, const EstimatorSettings& settings) {
  Past now = past_of(frame, settings);
  const bool had = outputs_.has_value();
  if (had && now == last_) return true;
  forget();
  const Past before = std::exchange(last_, std::move(now));
  if (!had || before.whole != last_.whole) return false;
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
