// A copy of an EXR file in which some channels are others: all else passes through.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/formats/exr.h"

namespace alcove {

/// A channel that is written: one float per pixel of the window. It replaces that of the original, or is a new one.
struct CopiedPlane {
  int part;
  std::string channel;
  SampleType type;
};

struct ExrCopySettings {
  std::string original;  // the file's path
  Window window;         // that is written of the parts below; the data window of the planes' parts, or a part of it
  std::string compression = "keep";  // of the planes' parts: as in ExrOutput; keep: as it is, or zip if that loses bits
  std::vector<CopiedPlane> planes;   // at least one
  std::map<std::string, std::string> own_attributes;  // added as strings to the first part and to those of the planes
};

/// Writes the copy from top to bottom; it has its name once it is finished, and is gone if it is not.
///
/// A part without planes is copied chunk by chunk as it is compressed, deep samples, tiles and their levels too. In a
/// part with planes all other channels keep their type and every bit, and its tiles become scan lines. Where the window
/// is smaller than the planes' data window, so are all flat parts that have this data window. Fails with
/// ErrorKind::output, or with ErrorKind::input where the original cannot be read.
class ExrCopy {
 public:
  ExrCopy(const std::string& path, const ExrCopySettings& settings);
  ~ExrCopy();
  ExrCopy(ExrCopy&&) noexcept;

  /// The next rows of every plane, as wide as the window.
  void write(std::span<const std::span<const float>> planes);
  /// Ends the file after its last row, as ExrWriter::finish() does.
  void finish(const std::map<std::string, std::string>& late = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether DWAA and DWAB lose bits of a channel, which they judge by the last part of its name.
bool is_lossy_in_dwa(const std::string& channel);

/// The rows of an original that are copied at a time.
constexpr std::uint64_t kRowsOfOriginal = 64;

}  // namespace alcove
