// Reads deep parts of EXR files as the surfaces of each pixel. Of the program, only core/formats/exr_read.cpp includes
// this.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfHeader.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/formats/deep_surfaces.h"

namespace alcove {

/// A plane of surfaces and its destination: one float per pixel of the rows that are read.
struct DeepRead {
  std::size_t surface;  // 0: the first, to kMostDeepSurfaces - 1
  bool back;            // the end of the body behind it, instead of its front
  float* to;
};

/// A deep part of a file.
struct DeepStored {
  std::string path;
  int part;
  Imf::Header header;
  std::uint64_t offsets;  // place of its table of chunks in the file
  bool names_part;        // each chunk begins with the number of its part
};

/// Reads deep scan lines and deep tiles (level 0) of one or more files. Every failure is ErrorKind::input and names the
/// file. Chunks are checked against their file before anything is allocated by their sizes.
class DeepReader {
 public:
  /// Puts the samples of all parts together. `data` are the pixels to read; a part may lack some of them. `most_bytes`
  /// is the memory of all threads together. Fails if a part's base layer has no Z, if a chunk's sizes cannot be right,
  /// or if the largest chunks take more memory.
  DeepReader(const char* option, const Window& data, const std::vector<DeepStored>& parts, const DeepRules& rules,
             std::uint64_t most_bytes);
  ~DeepReader();

  /// Reads `rows` rows of the pixels, from the `first` one on.
  void read(std::span<const DeepRead> reads, int first, int rows);

  /// The counts over all rows read so far, each row once.
  const DeepCounts& counts() const;
  /// The bytes that reading takes, without its destination.
  std::uint64_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The compressions that deep data may have.
enum class DeepCompression { none, rle, zip };

/// The most bytes that so many packed bytes can unpack to.
std::uint64_t longest_unpacked(DeepCompression compression, std::uint64_t packed_bytes);

/// Unpacks bytes to exactly as many as `to` has. `scratch` grows as needed. Returns false if they are damaged.
bool unpack_deep(DeepCompression compression, std::span<const std::uint8_t> packed, std::span<std::uint8_t> to,
                 std::vector<std::uint8_t>& scratch);

/// Gives the number of samples of each pixel, from the table of a chunk, which adds them up along each line. Returns
/// false if a number is below 0.
bool counts_of_table(std::span<const std::uint8_t> table, std::size_t width, std::vector<std::uint32_t>& counts);

/// Gives the places, in bytes of a chunk's samples, at which each line's samples begin, and the end of the last line. A
/// sample takes `sample_bytes`. Returns false if the counts are not those of exactly `bytes`.
bool lines_of_counts(std::span<const std::uint32_t> counts, std::size_t width, std::uint64_t sample_bytes,
                     std::uint64_t bytes, std::vector<std::size_t>& lines);

}  // namespace alcove
