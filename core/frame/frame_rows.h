// The rows of a frame that windows are taken from: each is decoded once, however many windows show it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/system.h"
#include "core/frame/gbuffer.h"

namespace alcove {

/// Fails with ErrorKind::device where a single row of the frame holds more pixels than any window may have.
void require_rows(const FrameSource& source);

/// Whole rows of all planes of a frame, for that is how files are stored. The first ones stay in memory, and where they
/// are more than it has room for, the others go to a file without a name. That costs a part of what decoding them again
/// would.
class FrameRows {
 public:
  /// Nothing is read yet. `most_bytes` may stay in memory; the file is made in `folder` once it is needed. Fails as
  /// require_rows() does.
  FrameRows(FrameSource& source, std::uint64_t most_bytes, const std::string& folder);

  /// Decodes what is not there yet of the rows from `top` to the one above `bottom`, and of those between them and what
  /// is there. They are rows of the file; those beyond its data window do not count. Fails as reading a frame does, and
  /// with ErrorKind::output where the file has no room for them.
  void need(int top, int bottom);

  /// What is there, over the whole width.
  Window window() const;
  /// Copies the channels, one behind the other, within a part of window().
  void copy(const std::vector<ChannelRef>& channels, const Window& part, float* to) const;

  /// Puts all rows aside, those too that are decoded later. Fails as need() does.
  void leave_memory();

  std::uint64_t bytes_in_memory() const { return bytes_in_memory_; }
  /// Of a row of all planes.
  std::uint64_t row_bytes() const;

 private:
  /// Rows that were decoded together: each channel's one behind the other.
  struct Block {
    int top, rows;
    std::unique_ptr<float[]> pixels;  // null: it lies in the file
    std::uint64_t offset;             // in the file, bytes
  };
  void decode(int top, int bottom);
  void decode_block(int top, int rows);
  void put_aside(Block& block);
  void copy_rows(const Block& block, std::size_t channel, const Window& part, float* to) const;

  FrameSource& source_;
  std::uint64_t most_bytes_;
  const std::string folder_;
  std::vector<ChannelRef> channels_;  // of all planes, each once
  int together_ = 1;                  // rows that the files compress together
  std::vector<Block> blocks_;
  int top_, bottom_;  // of what is there
  std::uint64_t bytes_in_memory_ = 0;
  ScratchFile file_;
  std::uint64_t file_bytes_ = 0;
};

}  // namespace alcove
