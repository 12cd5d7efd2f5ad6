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

/// The layout of a chunk, and the rows of it that are wanted.
struct ZipRows {
  std::size_t width;         // samples of a channel in a row
  std::size_t row_bytes;     // of all channels
  std::size_t rows;          // of the chunk
  std::size_t first, count;  // the wanted rows
};

/// A wanted channel of a chunk.
struct ZipChannel {
  SampleType type;
  std::size_t offset;  // bytes from a row's beginning, even
  std::byte* to;       // destination of the wanted rows, one behind the other
  bool as_floats;      // half floats are widened and integers rounded; else samples stay as stored
};

/// The bytes of a sample in the file.
std::size_t bytes_of(SampleType type);

/// Unpacks chunks one after the other. Each thread has an unpacker of its own.
class ZipUnpacker {
 public:
  ZipUnpacker();
  ~ZipUnpacker();

  /// Writes the wanted rows of the channels, which stand in the order of their offsets. Returns false if the chunk is
  /// damaged; the rows then hold anything.
  bool unpack(std::span<const std::uint8_t> packed, const ZipRows& rows, std::span<const ZipChannel> channels);

 private:
  bool inflate(std::span<const std::uint8_t> packed, std::size_t bytes);
  void sum_up(const ZipRows& rows, std::span<const ZipChannel> channels);
  void read_stored(std::span<const std::uint8_t> bytes, const ZipRows& rows, std::span<const ZipChannel> channels);
  void read_split(const ZipRows& rows, std::span<const ZipChannel> channels);

  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflater_;
  std::unique_ptr<std::uint8_t[]> split_;
  std::size_t room_ = 0;  // bytes of split_
  std::vector<std::uint8_t> row_;
};

/// Packs chunks one after the other. Each thread has a packer of its own.
class ZipPacker {
 public:
  ZipPacker();

  /// Gives the stored form of a chunk: packed, or unchanged if packing would not shorten it. It is valid until the next
  /// call. The number of bytes in `rows` is even.
  std::span<const std::uint8_t> pack(std::span<const std::uint8_t> rows);

 private:
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> deflater_;
  std::vector<std::uint8_t> split_, packed_;
};

/// Whether a part is read and written by this code instead of OpenEXR: scan lines of ZIP or ZIPS without subsampled
/// channels.
bool is_zip_rows(const Imf::Header& header);

/// A channel to read, as floats or as it is stored.
struct ZipRead {
  std::string channel;
  void* to;
  bool as_floats = true;
};

/// Reads `rows` rows of the part's data window, from the `first` one on. It uses up to `most_threads` of OpenEXR's
/// threads, or the caller's if there are none. The part has these channels. Fails with a std::exception if chunks are
/// missing or damaged.
void read_zip_rows(const Imf::InputPart& part, std::span<const ZipRead> reads, int first, int rows, int most_threads);

/// Writes a file of one part from top to bottom. Its bytes are the same on any number of threads, and however its rows
/// are split over calls.
class ZipWriter : private Imf::GenericOutputFile {
 public:
  /// The samples of a channel, row by row: as the file stores them, or floats that become half floats in the file.
  struct Source {
    const void* samples;
    bool is_float;  // the channel itself may be of half floats
  };

  /// Begins the file, of ZIP rows. Fails if a chunk takes more bytes than is_zip_rows() allows.
  ZipWriter(Imf::OStream& stream, const Imf::Header& header);

  const Imf::Header& header() const { return header_; }
  /// Writes the next rows. `sources` has one entry for each channel of the header, in its order.
  void write(std::span<const Source> sources, std::size_t rows);
  /// Writes the table of the chunks' places, after all rows.
  void finish();

 private:
  /// A chunk on its way from planes into the file.
  struct Chunk {
    std::size_t rows = 0;             // filled so far
    std::vector<std::uint8_t> bytes;  // of these rows
    ZipPacker packer;
    std::span<const std::uint8_t> stored;
  };
  std::size_t rows_of(std::size_t chunk) const;
  void add_rows(Chunk& chunk, std::span<const Source> sources, std::size_t first, std::size_t rows) const;
  void write_chunks(std::span<Chunk> chunks);

  Imf::OStream& stream_;
  const Imf::Header header_;
  std::size_t width_, height_, chunk_rows_, row_bytes_ = 0;
  std::uint64_t table_ = 0;             // place of the table of chunks in the file
  std::vector<std::uint64_t> offsets_;  // of the written chunks
  std::vector<Chunk> chunks_;           // packed at once; the first may be partly filled
};

}  // namespace alcove
