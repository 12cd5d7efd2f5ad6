// Decodes rows block by block, and keeps the blocks in memory or in a file.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/frame_rows.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/frame/plane_windows.h"

namespace alcove {
namespace {

/// The most that is decoded at once on its way to the file: enough rows for many threads.
constexpr std::uint64_t kBlockBytes = 8 << 20;

constexpr int kLongestRow = 1 << 24;  // px

/// The largest multiple of `unit` that is no larger than a number, which is 0 or more.
int rounded_down(int number, int unit) { return number / unit * unit; }

}  // namespace

void require_rows(const FrameSource& source) {
  if (source.file_data.width > kLongestRow)
    fail(ErrorKind::device, "{}: rows of {} pixels are more than Alcove takes on any --device", source.depth_path(),
         source.file_data.width);
}

FrameRows::FrameRows(FrameSource& source, std::uint64_t most_bytes, const std::string& folder)
    : source_(source), most_bytes_(most_bytes), folder_(folder), top_(source.file_data.y), bottom_(top_) {
  require_rows(source);
  for (const auto& plane : source.planes.entries) channels_.insert(channels_.end(), plane.begin(), plane.end());
  std::ranges::sort(channels_);
  channels_.erase(std::unique(channels_.begin(), channels_.end()), channels_.end());
  for (const auto& channel : channels_) together_ = std::max(together_, source.part_of(channel).rows_together);
}

std::uint64_t FrameRows::row_bytes() const {
  return sizeof(float) * channels_.size() * std::uint64_t(source_.file_data.width);
}

Window FrameRows::window() const { return {source_.file_data.x, top_, source_.file_data.width, bottom_ - top_}; }

void FrameRows::need(int top, int bottom) {
  const Window& data = source_.file_data;
  const int end = data.y + data.height;
  top = data.y + rounded_down(std::max(top - data.y, 0), together_);
  bottom = std::min(end, data.y + rounded_down(std::clamp(bottom, data.y, end) - data.y + together_ - 1, together_));
  if (bottom <= top) return;
  if (top_ == bottom_) top_ = bottom_ = top;
  if (top < top_) {
    decode(top, top_);
    top_ = top;
  }
  if (bottom > bottom_) {
    decode(bottom_, bottom);
    bottom_ = bottom;
  }
}

void FrameRows::decode(int top, int bottom) {
  const int most = int(std::clamp<std::uint64_t>(kBlockBytes / row_bytes(), 1, std::uint64_t(bottom - top)));
  const int step = std::max(together_, rounded_down(most, together_));
  for (int first = top; first < bottom; first += step) decode_block(first, std::min(step, bottom - first));
}

void FrameRows::decode_block(int top, int rows) {
  const std::size_t plane = std::size_t(rows) * std::size_t(source_.file_data.width);
  Block block{top, rows, std::make_unique_for_overwrite<float[]>(channels_.size() * plane), 0};
  std::vector<ChannelRead> reads;
  for (std::size_t i = 0; i < channels_.size(); i++) reads.push_back({channels_[i], block.pixels.get() + i * plane});
  read_rows(source_, reads, top, rows);
  source_.rows_read += std::uint64_t(rows);
  const std::uint64_t bytes = row_bytes() * std::uint64_t(rows);
  if (bytes_in_memory_ + bytes > most_bytes_)
    put_aside(block);
  else
    bytes_in_memory_ += bytes;
  blocks_.push_back(std::move(block));
}

void FrameRows::put_aside(Block& block) {
  const auto give_up = [&](const std::error_code& error) {
    fail(ErrorKind::output,
         "{}: it is larger than memory, and its decoded rows, {} MiB, could not be put aside in {}: {} (give the run "
         "more --memory, or more room there)",
         source_.depth_path(), row_bytes() * std::uint64_t(source_.file_data.height) >> 20, folder_, error.message());
  };
  if (!file_.is_open())
    if (const auto error = file_.make(folder_, unfinished_name(folder_))) give_up(error);
  const std::uint64_t bytes = row_bytes() * std::uint64_t(block.rows);
  if (const auto error = file_.write_at(file_bytes_, {reinterpret_cast<const char*>(block.pixels.get()), bytes}))
    give_up(error);
  block.pixels.reset();
  block.offset = file_bytes_;
  file_bytes_ += bytes;
}

void FrameRows::leave_memory() {
  for (auto& block : blocks_)
    if (block.pixels) put_aside(block);
  most_bytes_ = bytes_in_memory_ = 0;
}

void FrameRows::copy(const std::vector<ChannelRef>& channels, const Window& part, float* to) const {
  for (const auto& channel : channels) {
    const auto place = std::size_t(std::ranges::lower_bound(channels_, channel) - channels_.begin());
    for (const auto& block : blocks_) {
      const int top = std::max(part.y, block.top), bottom = std::min(part.y + part.height, block.top + block.rows);
      if (top < bottom)
        copy_rows(block, place, {part.x, top, part.width, bottom - top},
                  to + std::size_t(top - part.y) * std::size_t(part.width));
    }
    to += part.pixels();
  }
}

void FrameRows::copy_rows(const Block& block, std::size_t channel, const Window& part, float* to) const {
  const auto width = std::size_t(source_.file_data.width);
  const std::size_t first = (channel * std::size_t(block.rows) + std::size_t(part.y - block.top)) * width +
                            std::size_t(part.x - source_.file_data.x);
  const bool is_whole = part.width == source_.file_data.width;
  const std::size_t length = is_whole ? part.pixels() : std::size_t(part.width);  // that lies in one piece
  for (std::size_t row = 0; row < part.pixels() / length; row++) {
    const std::size_t from = first + row * width;
    float* const there = to + row * length;
    if (block.pixels) {
      std::copy_n(block.pixels.get() + from, length, there);
    } else if (const auto error = file_.read_at(block.offset + from * sizeof(float),
                                                {reinterpret_cast<char*>(there), length * sizeof(float)})) {
      fail(ErrorKind::output, "{}: its rows that were put aside in {} cannot be read back: {}", source_.depth_path(),
           folder_, error.message());
    }
  }
}

}  // namespace alcove
