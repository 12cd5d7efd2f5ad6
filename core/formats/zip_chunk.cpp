// Inflates with libdeflate, and puts together the bytes of the channels that are wanted; deflates with it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/zip_chunk.h"

#include <libdeflate.h>

#include <cstring>
#include <new>

#include "core/formats/exr.h"
#include "core/formats/sample_loops.h"

namespace alcove {
namespace {

// OpenEXR's own level. Levels 1 and 9 take 0.7 and 7 times as long for AO, and make files 3 % larger and 5 % smaller.
constexpr int kLevel = 4;

/// Makes floats of integers.
void round_integers(const std::uint8_t* from, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; i++) to[i] = float(number_at<std::uint32_t>(from + i * sizeof(float)));
}

std::size_t bytes_in_memory(const ZipChannel& channel) {
  return channel.as_floats ? sizeof(float) : bytes_of(channel.type);
}

/// `from`: samples as the file has them.
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
  // What packing would make no shorter is stored as it is.
  if (packed.size() >= bytes) {
    read_stored(packed, rows, channels);
    return true;
  }
  if (!inflate(packed, bytes)) return false;
  sum_up(rows, channels);
  read_split(rows, channels);
  return true;
}

/// It succeeds where there are exactly as many bytes, and their checksum is right.
bool ZipUnpacker::inflate(std::span<const std::uint8_t> packed, std::size_t bytes) {
  if (room_ < bytes) {
    split_ = std::make_unique_for_overwrite<std::uint8_t[]>(bytes);
    room_ = bytes;
  }
  return libdeflate_zlib_decompress(inflater_.get(), packed.data(), packed.size(), split_.get(), bytes, nullptr) ==
         LIBDEFLATE_SUCCESS;
}

/// Of what lies between the wanted bytes nothing but the sum is needed.
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
  // It gives 0 where there is not that much room.
  const std::size_t bytes =
      libdeflate_zlib_compress(deflater_.get(), split_.data(), split_.size(), packed_.data(), rows.size() - 1);
  return bytes > 0 ? std::span<const std::uint8_t>(packed_).first(bytes) : rows;
}

}  // namespace alcove
