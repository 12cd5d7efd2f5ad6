// Chunks go one by one to whichever thread is free; each unpacks the channels that are wanted into their planes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_zip.h"

#include <ImfChannelList.h>
#include <ImfPartType.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "core/base/error.h"
#include "core/formats/exr_shared.h"
#include "core/formats/zip_chunk.h"

namespace alcove {
namespace {

/// Rows of a part being read.
class ZipReading {
 public:
  ZipReading(const Imf::InputPart& part, std::span<const ZipRead> reads, int first, int rows)
      : part_(part),
        data_(window_of(part.header().dataWindow())),
        row_bytes_(zip_row_bytes(part.header())),
        chunk_rows_(rows_of_zip_chunk(part.header())),
        first_(first),
        end_(first + rows) {
    std::size_t offset = 0;
    const auto& channels = part.header().channels();
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      const Imf::PixelType type = at.channel().type;
      for (const auto& read : reads)
        if (read.channel == at.name())
          channels_.push_back({sample_type_of(type), offset, static_cast<std::byte*>(read.to), read.as_floats});
      offset += bytes_of(type) * std::size_t(data_.width);
    }
  }

  void read(int most_threads) {
    const int begin = first_ / chunk_rows_, end = (end_ + chunk_rows_ - 1) / chunk_rows_;
    const auto chunks = std::size_t(end - begin), workers = exr_workers(chunks, std::size_t(most_threads));
    std::vector<Worker> busy(workers);
    on_exr_threads(chunks, workers, [&](std::size_t chunk, std::size_t worker) {
      read_chunk((begin + int(chunk)) * chunk_rows_, busy[worker]);
    });
  }

 private:
  struct Worker {
    ZipUnpacker unpacker;
    std::unique_ptr<std::uint8_t[]> packed;
  };

  /// `top`: of its rows, counted from the data window's first.
  void read_chunk(int top, Worker& worker) {
    const std::size_t chunk_bytes = row_bytes_ * std::size_t(chunk_rows_);
    if (!worker.packed) worker.packed = std::make_unique_for_overwrite<std::uint8_t[]>(chunk_bytes);
    int bytes = int(chunk_bytes);  // OpenEXR 3.3 looks at it
    {
      const std::lock_guard lock(mutex_);
      part_.rawPixelDataToBuffer(data_.y + top, reinterpret_cast<char*>(worker.packed.get()), bytes);
    }
    const int bottom = std::min(top + chunk_rows_, data_.height);
    const int from = std::max(top, first_), to = std::min(bottom, end_);
    std::vector<ZipChannel> channels = channels_;
    for (auto& channel : channels)
      channel.to += std::size_t(from - first_) * std::size_t(data_.width) *
                    (channel.as_floats ? sizeof(float) : bytes_of(channel.type));
    const ZipRows rows{std::size_t(data_.width), row_bytes_, std::size_t(bottom - top), std::size_t(from - top),
                       std::size_t(to - from)};
    if (!worker.unpacker.unpack({worker.packed.get(), std::size_t(bytes)}, rows, channels))
      throw std::runtime_error(fmt::format("the rows from {} on cannot be inflated", data_.y + top));
  }

  const Imf::InputPart& part_;
  const Window data_;
  const std::size_t row_bytes_;
  const int chunk_rows_, first_, end_;
  std::vector<ZipChannel> channels_;
  std::mutex mutex_;  // of the file
};

}  // namespace

std::size_t zip_row_bytes(const Imf::Header& header) {
  std::size_t bytes = 0;
  for (auto at = header.channels().begin(); at != header.channels().end(); ++at) bytes += bytes_of(at.channel().type);
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
  ZipReading(part, reads, first, rows).read(most_threads);
}

}  // namespace alcove
