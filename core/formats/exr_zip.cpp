// ZIP lines: chunks are packed and unpacked with libdeflate, on as many threads as are free, in the order of the file.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_zip.h"

#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>
#include <vector>

#include "core/base/error.h"
#include "core/formats/exr.h"
#include "core/formats/exr_shared.h"
#include "core/formats/sample_loops.h"

namespace alcove {

namespace {

// OpenEXR's own level. Levels 1 and 9 take 0.7 and 7 times as long for AO, and make files 3 % larger and 5 % smaller.
constexpr int kLevel = 4;

/// Makes floats of integers.
void round_integers(const std::uint8_t* from, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; i++) to[i] = float(number_at<std::uint32_t>(from + i * sizeof(float)));
}

/// The bytes of a row of all channels.
std::size_t zip_row_bytes(const Imf::Header& header) {
  std::size_t bytes = 0;
  for (auto at = header.channels().begin(); at != header.channels().end(); ++at) bytes += bytes_of(at.channel().type);
  return bytes * std::size_t(window_of(header.dataWindow()).width);
}

/// The rows of a chunk of ZIP or ZIPS.
int rows_of_zip_chunk(const Imf::Header& header) { return header.compression() == Imf::ZIPS_COMPRESSION ? 1 : 16; }

std::size_t bytes_in_memory(const ZipChannel& channel) {
  return channel.as_floats ? sizeof(float) : bytes_of(channel.type);
}

/// Converts a row. `from` holds samples as the file has them.
void write_row(const ZipChannel& channel, const std::uint8_t* from, std::size_t width, std::byte* to) {
  if (channel.as_floats && channel.type == SampleType::half_float)
    widen(from, width, reinterpret_cast<float*>(to));
  else if (channel.as_floats && channel.type == SampleType::integer)
    round_integers(from, width, reinterpret_cast<float*>(to));
  else
    std::memcpy(to, from, width * bytes_of(channel.type));
}

}  // namespace

std::size_t bytes_of(SampleType type) { return type == SampleType::half_float ? 2 : 4; }

ZipUnpacker::ZipUnpacker() : inflater_(libdeflate_alloc_decompressor(), libdeflate_free_decompressor) {
  if (!inflater_) throw std::bad_alloc();
}

ZipUnpacker::~ZipUnpacker() = default;

bool ZipUnpacker::unpack(std::span<const std::uint8_t> packed, const ZipRows& rows,
                         std::span<const ZipChannel> channels) {
  const std::size_t bytes = rows.row_bytes * rows.rows;
  // Bytes that packing would not shorten are stored as they are.
  if (packed.size() >= bytes) {
    read_stored(packed, rows, channels);
    return true;
  }
  if (!inflate(packed, bytes)) return false;
  sum_up(rows, channels);
  read_split(rows, channels);
  return true;
}

/// Inflates into split_. Succeeds if there are exactly `bytes` bytes and their checksum is right.
bool ZipUnpacker::inflate(std::span<const std::uint8_t> packed, std::size_t bytes) {
  if (room_ < bytes) {
    split_ = std::make_unique_for_overwrite<std::uint8_t[]>(bytes);
    room_ = bytes;
  }
  return libdeflate_zlib_decompress(inflater_.get(), packed.data(), packed.size(), split_.get(), bytes, nullptr) ==
         LIBDEFLATE_SUCCESS;
}

/// Sums up the wanted bytes. Of the bytes between them only the sum is needed.
void ZipUnpacker::sum_up(const ZipRows& rows, std::span<const ZipChannel> channels) {
  constexpr std::uint8_t kBeforeFirst = 128;  // so that the first byte is itself
  const std::size_t half = rows.row_bytes * rows.rows / 2;
  std::size_t at = 0;
  std::uint8_t last = kBeforeFirst;
  for (const std::size_t begin : {std::size_t(0), half})
    for (std::size_t row = rows.first; row < rows.first + rows.count; row++)
      for (const auto& channel : channels) {
        const std::size_t from = begin + (row * rows.row_bytes + channel.offset) / 2;
        const std::size_t count = rows.width * bytes_of(channel.type) / 2;
        last = sum_of(split_.get() + at, from - at, last);
        last = alcove::sum_up(split_.get() + from, count, last);
        at = from + count;
      }
}

void ZipUnpacker::read_split(const ZipRows& rows, std::span<const ZipChannel> channels) {
  const std::size_t half = rows.row_bytes * rows.rows / 2;
  row_.resize(sizeof(float) * rows.width);
  for (const auto& channel : channels)
    for (std::size_t row = 0; row < rows.count; row++) {
      const std::uint8_t* even = split_.get() + ((rows.first + row) * rows.row_bytes + channel.offset) / 2;
      std::byte* const to = channel.to + row * rows.width * bytes_in_memory(channel);
      const bool changes = channel.as_floats && channel.type != SampleType::single_float;
      std::uint8_t* const together = changes ? row_.data() : reinterpret_cast<std::uint8_t*>(to);
      interleave(even, even + half, rows.width * bytes_of(channel.type) / 2, together);
      if (changes) write_row(channel, together, rows.width, to);
    }
}

void ZipUnpacker::read_stored(std::span<const std::uint8_t> bytes, const ZipRows& rows,
                              std::span<const ZipChannel> channels) {
  for (const auto& channel : channels)
    for (std::size_t row = 0; row < rows.count; row++)
      write_row(channel, bytes.data() + (rows.first + row) * rows.row_bytes + channel.offset, rows.width,
                channel.to + row * rows.width * bytes_in_memory(channel));
}

ZipPacker::ZipPacker() : deflater_(libdeflate_alloc_compressor(kLevel), libdeflate_free_compressor) {
  if (!deflater_) throw std::bad_alloc();
}

std::span<const std::uint8_t> ZipPacker::pack(std::span<const std::uint8_t> rows) {
  split_.resize(rows.size());
  packed_.resize(rows.size());
  split_to_differences(rows.data(), rows.size() / 2, split_.data());
  // libdeflate gives 0 if the room is too small.
  const std::size_t bytes =
      libdeflate_zlib_compress(deflater_.get(), split_.data(), split_.size(), packed_.data(), rows.size() - 1);
  return bytes > 0 ? std::span<const std::uint8_t>(packed_).first(bytes) : rows;
}

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

  /// Reads the chunk whose first row is `top`, counted from the data window's first.
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

namespace {

/// Chunks per thread, as in OpenEXR's own code, so that no thread waits for the slowest.
constexpr std::size_t kChunksOfThread = 2;

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// Makes the header one of scan lines: the type in an input's header is that of another file.
Imf::Header of_lines(Imf::Header header) {
  if (header.hasType()) header.setType(Imf::SCANLINEIMAGE);
  return header;
}

void write_word(Imf::OStream& stream, std::int32_t word) {
  stream.write(reinterpret_cast<const char*>(&word), sizeof(word));
}

}  // namespace

ZipWriter::ZipWriter(Imf::OStream& stream, const Imf::Header& header) : stream_(stream), header_(of_lines(header)) {
  header_.sanityCheck();
  if (!is_zip_rows(header_))
    throw std::length_error("a chunk of rows takes more than 2 GiB; give fewer channels (--aov) or --roi");
  const Window data = window_of(header_.dataWindow());
  width_ = std::size_t(data.width);
  height_ = std::size_t(data.height);
  chunk_rows_ = std::size_t(rows_of_zip_chunk(header_));
  row_bytes_ = zip_row_bytes(header_);
  const std::size_t workers = exr_workers(kAll, kAll);
  chunks_ = std::vector<Chunk>(workers > 1 ? kChunksOfThread * workers : 1);
  Imf::StdOSStream head;  // one write instead of hundreds
  writeMagicNumberAndVersionField(head, header_);
  header_.writeTo(head);
  const std::string bytes = head.str();
  stream_.write(bytes.data(), int(bytes.size()));
  table_ = stream_.tellp();
  const std::vector<std::uint64_t> nowhere((height_ + chunk_rows_ - 1) / chunk_rows_);
  stream_.write(reinterpret_cast<const char*>(nowhere.data()), int(nowhere.size() * sizeof(std::uint64_t)));
}

std::size_t ZipWriter::rows_of(std::size_t chunk) const {
  return std::min(chunk_rows_, height_ - std::min(height_, chunk * chunk_rows_));
}

void ZipWriter::write(std::span<const Source> sources, std::size_t rows) {
  if (rows > height_ - std::min(height_, offsets_.size() * chunk_rows_) - chunks_[0].rows)
    throw std::logic_error("there are more rows than pixels");
  for (std::size_t row = 0; row < rows;) {
    std::size_t count = 0;  // full chunks
    std::vector<std::size_t> firsts, taken;
    for (; count < chunks_.size() && row < rows; count++) {
      const std::size_t filled = chunks_[count].rows, missing = rows_of(offsets_.size() + count) - filled;
      firsts.push_back(row);
      taken.push_back(std::min(missing, rows - row));
      row += taken.back();
      if (taken.back() < missing) break;
    }
    on_exr_threads(taken.size(), exr_workers(taken.size(), kAll), [&](std::size_t i, std::size_t) {
      add_rows(chunks_[i], sources, firsts[i], taken[i]);
      if (i < count) chunks_[i].stored = chunks_[i].packer.pack(chunks_[i].bytes);
    });
    write_chunks(std::span(chunks_).first(count));
    // A chunk that is not full yet becomes the first of the next round.
    if (count > 0 && count < chunks_.size()) std::swap(chunks_[0], chunks_[count]);
  }
}

void ZipWriter::add_rows(Chunk& chunk, std::span<const Source> sources, std::size_t first, std::size_t rows) const {
  chunk.bytes.resize((chunk.rows + rows) * row_bytes_);
  std::uint8_t* to = chunk.bytes.data() + chunk.rows * row_bytes_;
  for (std::size_t row = first; row < first + rows; row++) {
    auto source = sources.begin();
    for (auto at = header_.channels().begin(); at != header_.channels().end(); ++at, ++source) {
      const bool is_half = at.channel().type == Imf::HALF, narrows = is_half && source->is_float;
      const std::size_t bytes = width_ * bytes_of(at.channel().type);
      const auto* from = static_cast<const std::byte*>(source->samples) + row * (narrows ? 2 : 1) * bytes;
      if (narrows)
        narrow(reinterpret_cast<const float*>(from), width_, reinterpret_cast<std::uint16_t*>(to));
      else
        std::memcpy(to, from, bytes);
      to += bytes;
    }
  }
  chunk.rows += rows;
}

void ZipWriter::write_chunks(std::span<Chunk> chunks) {
  for (auto& chunk : chunks) {
    const int top = header_.dataWindow().min.y + int(offsets_.size() * chunk_rows_);
    offsets_.push_back(stream_.tellp());
    write_word(stream_, top);
    write_word(stream_, std::int32_t(chunk.stored.size()));
    stream_.write(reinterpret_cast<const char*>(chunk.stored.data()), int(chunk.stored.size()));
    chunk.rows = 0;
  }
}

void ZipWriter::finish() {
  if (offsets_.size() * chunk_rows_ < height_) throw std::logic_error("there are fewer rows than pixels");
  stream_.seekp(table_);
  stream_.write(reinterpret_cast<const char*>(offsets_.data()), int(offsets_.size() * sizeof(std::uint64_t)));
}

}  // namespace alcove
