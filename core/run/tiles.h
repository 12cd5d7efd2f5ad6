// How a frame too large for memory or device is cut up, and how much memory frames take.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/run/region.h"

namespace alcove {

/// What a pixel that is computed takes, in buffers of the device and while it is read and written. An upper bound.
struct PixelMemory {
  std::uint64_t bytes = 0;          // in all
  std::uint64_t read_bytes = 0;     // of them, for the planes as they are read
  std::uint64_t written_bytes = 0;  // for the planes that are written
  std::uint64_t widest = 0;         // in the largest buffer
};
PixelMemory pixel_memory(const FrameSource& source, const Settings& settings);

/// What one frame in flight may take.
struct Room {
  std::uint64_t bytes = 0;         // in all
  std::uint64_t buffer_bytes = 0;  // of one buffer of the device
};

/// Whether a window can be computed at once.
bool fits(const Window& computed, const PixelMemory& pixel, const Room& room);

/// The window of all results in rows of tiles from the top, each row in tiles from the left, so that each of them fits
/// with its surroundings. Rows first: what is read of a file is whole rows. Fails with ErrorKind::device where the
/// radius reaches so far that none do.
std::vector<std::vector<Window>> tiles_of(const Window& whole, const Surroundings& surroundings,
                                          const PixelMemory& pixel, const Room& room, const FrameSource& source);

/// Bytes that the frames of a run may take together: settings.device.memory, or half of what is free, less what the
/// program itself needs.
std::uint64_t memory_for_frames(const DeviceSettings& settings);

}  // namespace alcove
