// Scan lines of ZIP or ZIPS, read and written by ourselves: OpenEXR finds and checks the chunks, and has the header.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfGenericOutputFile.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/formats/exr.h"

struct libdeflate_compressor;
struct libdeflate_decompressor;

namespace alcove {

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

/// Whether a part is read and written here, and OpenEXR need not: of ZIP or ZIPS, and without subsampled channels.
bool is_zip_rows(const Imf::Header& header);

/// The bytes of a row of all channels of such a part.
std::size_t zip_row_bytes(const Imf::Header& header);

/// How many rows ZIP or ZIPS puts together.
int rows_of_zip_chunk(const Imf::Header& header);

/// A channel to read: as floats, or as it is stored.
struct ZipRead {
  std::string channel;
  void* to;
  bool as_floats = true;
};

/// Reads `rows` rows of the part's data window, from the `first` one on, on as many of OpenEXR's threads as are
/// allowed, or on the caller's where that is none. The part has these channels. Fails with a std::exception where
/// chunks are missing or damaged.
void read_zip_rows(const Imf::InputPart& part, std::span<const ZipRead> reads, int first, int rows, int most_threads);

/// A file of one part, from top to bottom. Its bytes are the same on any number of threads, and whatever rows it gets
/// at once.
class ZipWriter : private Imf::GenericOutputFile {
 public:
  /// Samples of a channel, row by row: as the file has them, or floats that become half floats there.
  struct Source {
    const void* samples;
    bool is_float;  // though the channel may be of half floats
  };

  /// Begins the file. The header is one for it.
  ZipWriter(Imf::OStream& stream, const Imf::Header& header);

  const Imf::Header& header() const { return header_; }
  /// Writes the next rows. There is a source for each channel of the header, in its order.
  void write(std::span<const Source> sources, std::size_t rows);
  /// Says where the chunks are, once all rows are written.
  void finish();

 private:
  /// A chunk on its way from planes into the file.
  struct Chunk {
    std::size_t rows = 0;             // that it has got
    std::vector<std::uint8_t> bytes;  // of these
    ZipPacker packer;
    std::span<const std::uint8_t> stored;
  };
  std::size_t rows_of(std::size_t chunk) const;
  void add_rows(Chunk& chunk, std::span<const Source> sources, std::size_t first, std::size_t rows) const;
  void write_chunks(std::span<Chunk> chunks);

  Imf::OStream& stream_;
  const Imf::Header header_;
  std::size_t width_, height_, chunk_rows_, row_bytes_ = 0;
  std::uint64_t table_ = 0;             // where it stands in the file
  std::vector<std::uint64_t> offsets_;  // of the chunks that are written
  std::vector<Chunk> chunks_;           // that are packed at once; the first may have got some rows already
};

}  // namespace alcove
