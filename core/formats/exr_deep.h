// Deep parts of EXR files, read as the surfaces of each pixel. Of the program only core/formats/exr_read.cpp includes this.
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
  bool back;            // where the body behind it ends, instead of its front
  float* to;
};

/// A deep part of a file.
struct DeepStored {
  std::string path;
  int part;
  Imf::Header header;
  std::uint64_t offsets;  // where the table of its chunks' places begins in the file
  bool names_part;        // each chunk begins with the number of its part
};

/// Reads deep scan lines and deep tiles of one level, or level 0 of several, of one file or more. Every failure is
/// ErrorKind::input and names the file. Chunks are checked against their file before anything is made by their sizes.
class DeepReader {
 public:
  /// Takes the samples of all parts together: `data` are the pixels that are read, of which a part need not have all.
  /// Fails where a part's base layer has no Z, and where a chunk's sizes cannot be right. `most_bytes` is what threads
  /// may work on together; fails where the largest chunks take more.
  DeepReader(const char* option, const Window& data, const std::vector<DeepStored>& parts, const DeepRules& rules,
             std::uint64_t most_bytes);
  ~DeepReader();

  /// Reads `rows` rows of the pixels, from the `first` one on.
  void read(std::span<const DeepRead> reads, int first, int rows);

  /// What was met in all that was read so far, each row once.
  const DeepCounts& counts() const;
  /// That reading takes beside what it reads to.
  std::uint64_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The compressions that deep data may have.
enum class DeepCompression { none, rle, zip };

/// How many times as long as its packed bytes a chunk may be at most; 1 where nothing packs it.
std::uint64_t longest_unpacked(DeepCompression compression, std::uint64_t packed_bytes);

/// Unpacks bytes to exactly as many as `to` has. `scratch` is as long as it needs to be. Returns false where they are
/// damaged.
bool unpack_deep(DeepCompression compression, std::span<const std::uint8_t> packed, std::span<std::uint8_t> to,
                 std::vector<std::uint8_t>& scratch);

/// The number of samples of each pixel, from the table of a chunk, which adds them up along each line. Returns false
/// where a number is below 0.
bool counts_of_table(std::span<const std::uint8_t> table, std::size_t width, std::vector<std::uint32_t>& counts);

/// Where the samples of each line begin, and where the last line's end, in bytes of a chunk's samples. A sample takes
/// `sample_bytes`. Returns false where the counts are not those of exactly `bytes`.
bool lines_of_counts(std::span<const std::uint32_t> counts, std::size_t width, std::uint64_t sample_bytes,
                     std::uint64_t bytes, std::vector<std::size_t>& lines);

}  // namespace alcove
