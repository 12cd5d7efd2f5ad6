// Chunks go one by one to whichever thread is free; each unpacks the channels that are wanted into their planes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_zip.h"

#include <IlmThreadPool.h>
#include <ImfChannelList.h>
#include <ImfPartType.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "core/base/text.h"
#include "core/formats/exr_attributes.h"
#include "core/formats/zip_chunk.h"

namespace alcove {
namespace {

std::size_t bytes_of(const Imf::Channel& channel) { return channel.type == Imf::HALF ? 2 : 4; }

std::size_t row_bytes(const Imf::Header& header) {
  std::size_t bytes = 0;
  for (auto at = header.channels().begin(); at != header.channels().end(); ++at) bytes += bytes_of(at.channel());
  return bytes * std::size_t(window_of(header.dataWindow()).width);
}

int rows_of_chunk(const Imf::Header& header) { return header.compression() == Imf::ZIPS_COMPRESSION ? 1 : 16; }

/// Rows of a part being read.
class ZipReading {
 public:
  ZipReading(const Imf::InputPart& part, std::span<const ExrRead> reads, int first, int rows)
      : part_(part),
        data_(window_of(part.header().dataWindow())),
        row_bytes_(row_bytes(part.header())),
        chunk_rows_(rows_of_chunk(part.header())),
        first_(first),
        end_(first + rows),
        next_(first / chunk_rows_) {
    std::size_t offset = 0;
    const auto& channels = part.header().channels();
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      for (const auto& read : reads)
        if (read.channel == at.name()) channels_.push_back({sample_type_of(at.channel().type), offset, read.to});
      offset += bytes_of(at.channel()) * std::size_t(data_.width);
    }
  }

  int chunks() const { return (end_ + chunk_rows_ - 1) / chunk_rows_ - first_ / chunk_rows_; }

  /// Reads chunks until none is left. Several threads may do so together.
  void read() noexcept {
    try {
      ZipUnpacker unpacker;
      const auto room = row_bytes_ * std::size_t(chunk_rows_);
      const auto packed = std::make_unique_for_overwrite<std::uint8_t[]>(room);
      for (int chunk = next_++; chunk * std::int64_t(chunk_rows_) < end_; chunk = next_++)
        read_chunk(chunk * chunk_rows_, unpacker, packed.get());
    } catch (...) {
      next_ = std::numeric_limits<int>::max() / 2;  // the others end, too
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }

  void require_no_error() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  /// `top`: of its rows, counted from the data window's first.
  void read_chunk(int top, ZipUnpacker& unpacker, std::uint8_t* packed) {
    int bytes = 0;
    part_.rawPixelDataToBuffer(data_.y + top, reinterpret_cast<char*>(packed), bytes);
    const int bottom = std::min(top + chunk_rows_, data_.height);
    const int from = std::max(top, first_), to = std::min(bottom, end_);
    std::vector<ZipChannel> channels = channels_;
    for (auto& channel : channels) channel.to += std::size_t(from - first_) * std::size_t(data_.width);
    const ZipRows rows{std::size_t(data_.width), row_bytes_, std::size_t(bottom - top), std::size_t(from - top),
                       std::size_t(to - from)};
    if (!unpacker.unpack({packed, std::size_t(bytes)}, rows, channels))
      throw std::runtime_error(fmt::format("the rows from {} on cannot be inflated", data_.y + top));
  }

  const Imf::InputPart& part_;
  const Window data_;
  const std::size_t row_bytes_;
  const int chunk_rows_, first_, end_;
  std::vector<ZipChannel> channels_;
  std::atomic<int> next_;  // chunk
  std::mutex mutex_;
  std::exception_ptr error_;
};

class ReadingTask : public IlmThread::Task {
 public:
  ReadingTask(IlmThread::TaskGroup* group, ZipReading& reading) : Task(group), reading_(reading) {}
  void execute() override { reading_.read(); }

 private:
  ZipReading& reading_;
};

}  // namespace

bool is_zip_rows(const Imf::Header& header, std::span<const ExrRead> reads) {
  const bool is_zip = header.compression() == Imf::ZIP_COMPRESSION || header.compression() == Imf::ZIPS_COMPRESSION;
  if (!is_zip || header.hasTileDescription()) return false;
  if (header.hasType() && header.type() != Imf::SCANLINEIMAGE) return false;
  for (auto at = header.channels().begin(); at != header.channels().end(); ++at)
    if (at.channel().xSampling != 1 || at.channel().ySampling != 1) return false;
  // OpenEXR counts the bytes of a chunk in an int.
  constexpr std::size_t kMost = std::numeric_limits<int>::max();
  if (row_bytes(header) > kMost / std::size_t(rows_of_chunk(header))) return false;
  return std::ranges::all_of(
      reads, [&](const ExrRead& read) { return header.channels().findChannel(read.channel) != nullptr; });
}

void read_zip_rows(const Imf::InputPart& part, std::span<const ExrRead> reads, int first, int rows, int most_threads) {
  ZipReading reading(part, reads, first, rows);
  auto& pool = IlmThread::ThreadPool::globalThreadPool();
  const int threads = std::min({most_threads, pool.numThreads(), reading.chunks()});
  if (threads <= 1) {
    reading.read();
  } else {
    IlmThread::TaskGroup group;  // whose end waits for its tasks
    for (int i = 0; i < threads; i++) pool.addTask(new ReadingTask(&group, reading));
  }
  reading.require_no_error();
}

}  // namespace alcove
