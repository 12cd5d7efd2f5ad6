// How much memory a frame takes, and how a frame that is too large for memory or device is cut into tiles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/run/region.h"

namespace alcove {

/// What each pixel that is computed takes. All are upper bounds.
struct PixelMemory {
  std::uint64_t bytes = 0;          // of host memory: buffers or their staging twins, and what is read and written
  std::uint64_t device_bytes = 0;   // of the device's own memory: buffers
  std::uint64_t read_bytes = 0;     // of `bytes`, for the planes as they are read
  std::uint64_t written_bytes = 0;  // of `bytes`, for the planes that are written
  std::uint64_t widest = 0;         // in the largest buffer
};
PixelMemory pixel_memory(const FrameSource& source, const Settings& settings);

/// What one frame in flight may take.
struct Room {
  static constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t bytes = 0;                // of host memory
  std::uint64_t device_bytes = kEndless;  // of the device's own memory
  std::uint64_t buffer_bytes = 0;         // of one buffer of the device
  std::uint64_t pixels = kEndless;        // at once: fewer than those for which the device had no memory
};

/// The longest side of a window, in pixels, for the passes of these settings: the marks of an exact search hold the
/// step along a line in 16 bits.
int longest_side(const EstimatorSettings& settings);

/// Fails with ErrorKind::input where a frame reaches so far that an exact search could not number its lines, however
/// the frame is cut.
void require_numbered_lines(const FrameSource& source, const EstimatorSettings& settings);

/// What decides whether a window can be computed at once.
struct WindowLimits {
  PixelMemory pixel;
  Room room;
  int longest_side = std::numeric_limits<int>::max();  // px

  bool allow(const Window& computed) const;
  /// The option that makes larger windows possible, for messages.
  std::string mended_by(const Window& computed) const;
};

/// Cuts the window of all results into rows of tiles, from the top, and each row into tiles, from the left, so that
/// each tile is allowed with its surroundings. Rows are cut first, since whole rows are read of a file. Fails with
/// ErrorKind::device where the radius reaches so far that no tile is small enough.
std::vector<std::vector<Window>> tiles_of(const Window& whole, const Surroundings& surroundings,
                                          const WindowLimits& limits, const FrameSource& source);

}  // namespace alcove
