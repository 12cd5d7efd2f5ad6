// Deep parts of EXR files, read as the surfaces of each pixel. Only core/formats/exr.cpp includes this.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfHeader.h>

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

}  // namespace alcove
