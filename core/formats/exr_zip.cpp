// Chunks go one by one to whichever thread is free; each unpacks the channels that are wanted into their planes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_zip.h"

#include <ImfChannelList.h>
#include <ImfPartType.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/formats/exr_attributes.h"
#include "core/formats/exr_threads.h"
#include "core/formats/zip_chunk.h"

namespace alcove {
namespace {

std::size_t bytes_of(const Imf::Channel& channel) { return channel.type == Imf::HALF ? 2 : 4; }

/// Rows of a part being read.
class ZipReading {
 public:
  ZipReading(const Imf::InputPart& part, std::span<const ZipRead> reads, int first, int rows)
      : part_(part),
        data_(window_of(part.header().dataWindow())),
        row_bytes_(zip_row_bytes(part.header())),
        chunk_rows_(rows_of_zip_chunk(part.header())),
        first_(first),
        end_(first + rows),
        next_(first / chunk_rows_) {
    std::size_t offset = 0;
    const auto& channels = part.header().channels();
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      for (const auto& read : reads)
        if (read.channel == at.name())
          channels_.push_back(
              {sample_type_of(at.channel().type), offset, static_cast<std::byte*>(read.to), read.as_floats});
      offset += bytes_of(at.channel()) * std::size_t(data_.width);
    }
  }

  int chunks() const { return (end_ + chunk_rows_ - 1) / chunk_rows_ - first_ / chunk_rows_; }

  /// Reads chunks until none is left, or one fails. Several threads may do so together.
  void read() {
    ZipUnpacker unpacker;
    const auto packed = std::make_unique_for_overwrite<std::uint8_t[]>(chunk_bytes());
    while (const auto chunk = next(packed.get())) try {
        unpack(*chunk, unpacker);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        fail_with(chunk->top / chunk_rows_);
      }
  }

  /// Throws what the first chunk of those that failed has thrown. Call it once all have read.
  void end() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  struct Chunk {
    int top;  // of its rows, counted from the data window's first
    std::span<const std::uint8_t> packed;
  };

  std::size_t chunk_bytes() const { return row_bytes_ * std::size_t(chunk_rows_); }

  /// Keeps the exception that is on its way, and lets nobody take another chunk. Who calls it holds the mutex.
  void fail_with(int chunk) {
    next_ = std::numeric_limits<int>::max();
    if (chunk >= failed_) return;
    failed_ = chunk;
    failure_ = std::current_exception();
  }

  /// Takes the next chunk from the file. Chunks are taken in their order, so that OpenEXR need not look for them; all
  /// before one that fails are done, so that a damaged file ends the same on any number of threads.
  std::optional<Chunk> next(std::uint8_t* to) {
    const std::lock_guard lock(mutex_);
    if (std::int64_t(next_) * chunk_rows_ >= end_) return std::nullopt;
    const int number = next_++;
    try {
      int bytes = int(chunk_bytes());  // OpenEXR 3.3 looks at it
      part_.rawPixelDataToBuffer(data_.y + number * chunk_rows_, reinterpret_cast<char*>(to), bytes);
      return Chunk{number * chunk_rows_, {to, std::size_t(bytes)}};
    } catch (...) {
      fail_with(number);
      return std::nullopt;
    }
  }

  void unpack(const Chunk& chunk, ZipUnpacker& unpacker) const {
    const int bottom = std::min(chunk.top + chunk_rows_, data_.height);
    const int from = std::max(chunk.top, first_), to = std::min(bottom, end_);
    std::vector<ZipChannel> channels = channels_;
    for (auto& channel : channels)
      channel.to += std::size_t(from - first_) * std::size_t(data_.width) *
                    (channel.as_floats ? sizeof(float) : bytes_of(channel.type));
    const ZipRows rows{std::size_t(data_.width), row_bytes_, std::size_t(bottom - chunk.top),
                       std::size_t(from - chunk.top), std::size_t(to - from)};
    if (!unpacker.unpack(chunk.packed, rows, channels))
      throw std::runtime_error(fmt::format("the rows from {} on cannot be inflated", data_.y + chunk.top));
  }

  const Imf::InputPart& part_;
  const Window data_;
  const std::size_t row_bytes_;
  const int chunk_rows_, first_, end_;
  std::vector<ZipChannel> channels_;
  std::mutex mutex_;  // of the file, and of
  int next_;          // chunk
  int failed_ = std::numeric_limits<int>::max();
  std::exception_ptr failure_;
};

}  // namespace

std::size_t zip_row_bytes(const Imf::Header& header) {
  std::size_t bytes = 0;
  for (auto at = header.channels().begin(); at != header.channels().end(); ++at) bytes += bytes_of(at.channel());
  return bytes * std::size_t(window_of(header.dataWindow()).width);
}

int rows_of_zip_chunk(const Imf::Header& header) { return header.compression() == Imf::ZIPS_COMPRESSION ? 1 : 16; }

bool is_zip_rows(const Imf::Header& header) {
  const bool is_zip = header.compression() == Imf::ZIP_COMPRESSION || header.compression() == Imf::ZIPS_COMPRESSION;
  if (!is_zip || header.hasTileDescription()) return false;
  if (header.hasType() && header.type() != Imf::SCANLINEIMAGE) return false;
  for (auto at = header.channels().begin(); at != header.channels().end(); ++at)
    if (at.channel().xSampling != 1 || at.channel().ySampling != 1) return false;
  // OpenEXR counts the bytes of a chunk in an int.
  constexpr std::size_t kMost = std::numeric_limits<int>::max();
  return zip_row_bytes(header) <= kMost / std::size_t(rows_of_zip_chunk(header));
}

void read_zip_rows(const Imf::InputPart& part, std::span<const ZipRead> reads, int first, int rows, int most_threads) {
  ZipReading reading(part, reads, first, rows);
  on_exr_threads(exr_threads_for(reading.chunks(), most_threads), [&] { reading.read(); });
  reading.end();
}

}  // namespace alcove
