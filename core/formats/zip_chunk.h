// ZIP chunks of EXR files: rows of some channels out of them, without touching the others more than it must; and in.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

struct libdeflate_compressor;
struct libdeflate_decompressor;

namespace alcove {

enum class SampleType;

/// What a chunk holds, and which rows of it are wanted.
struct ZipRows {
  std::size_t width;         // samples of a channel in a row
  std::size_t row_bytes;     // of all channels
  std::size_t rows;          // of the chunk
  std::size_t first, count;  // that are wanted
};

/// A channel that is wanted.
struct ZipChannel {
  SampleType type;
  std::size_t offset;  // bytes from a row's beginning, even
  std::byte* to;       // where the wanted rows go, one behind the other
  bool as_floats;      // half floats are widened and integers rounded; else samples stay as they are stored
};

/// The bytes of a sample in the file.
std::size_t bytes_of(SampleType type);

/// Unpacks chunks one after the other; each thread has one of its own.
class ZipUnpacker {
 public:
  ZipUnpacker();
  ~ZipUnpacker();

  /// Writes the wanted rows of the channels, which stand in the order of their offsets. Returns false where the chunk
  /// is damaged: then the rows hold anything.
  bool unpack(std::span<const std::uint8_t> packed, const ZipRows& rows, std::span<const ZipChannel> channels);

 private:
  bool inflate(std::span<const std::uint8_t> packed, std::size_t bytes);
  void sum_up(const ZipRows& rows, std::span<const ZipChannel> channels);
  void read_stored(std::span<const std::uint8_t> bytes, const ZipRows& rows, std::span<const ZipChannel> channels);
  void read_split(const ZipRows& rows, std::span<const ZipChannel> channels);

  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflater_;
  std::unique_ptr<std::uint8_t[]> split_;
  std::size_t room_ = 0;  // of it, bytes
  std::vector<std::uint8_t> row_;
};

/// Packs chunks one after the other; each thread has one of its own.
class ZipPacker {
 public:
  ZipPacker();

  /// Gives a chunk as it is stored: packed, or as it is where that is no longer. It stays until the next one is packed.
  /// The number of its bytes is even.
  std::span<const std::uint8_t> pack(std::span<const std::uint8_t> rows);

 private:
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> deflater_;
  std::vector<std::uint8_t> split_, packed_;
};

}  // namespace alcove
