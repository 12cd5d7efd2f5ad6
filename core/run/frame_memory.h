// How much memory a frame takes, known before its pixels are read.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/gbuffer.h"

namespace alcove {

/// The part of a frame's memory that the codec of one of its files may take.
constexpr std::uint64_t kCodecPart = 8;

/// What a window of a frame takes while it is computed, wherever it lies. All are upper bounds, in bytes.
struct FrameMemory {
  /// What the codecs of its files take of host memory where so much is left for the frame.
  std::uint64_t codec_bytes(std::uint64_t room) const;
  /// Of the device's own memory: all buffers.
  std::uint64_t on_device(const Window& window) const;
  /// Of host memory: buffers or their staging twins, and what is read, shown and written.
  std::uint64_t on_host(const Window& computed) const;
  /// Of the largest buffer.
  std::uint64_t in_buffer(const Window& window) const { return with_margin(window).pixels() * widest; }

  /// A window with all that others show around it.
  Window with_margin(const Window& window) const;

  std::uint64_t planes = 0;                 // in buffers, for each pixel
  std::uint64_t estimate = 0;               // in buffers, for each pixel of the estimate
  std::uint64_t tile = 0;                   // in buffers, for each tile of the estimate
  int factor = 1;                           // px along a side of a pixel of the estimate
  int margin = 0;                           // px to each side that others show beside what is computed, at most
  std::uint64_t beside = 0;                 // in host memory beside buffers, for each pixel
  std::uint64_t written = 0;                // of the planes that are written, for each pixel
  std::uint64_t widest = 0;                 // in the largest buffer, for each pixel
  std::vector<std::uint64_t> codec_groups;  // bytes of the rows that each codec takes together
  std::uint64_t fixed_on_device = 0;        // in buffers, whatever the window
  std::uint64_t fixed_bytes = 0;  // in host memory whatever the window: codecs, and files that are kept decoded
};
FrameMemory memory_of(const FrameSource& source, const Settings& settings);

/// The bytes of all planes of a frame, as they are read.
std::uint64_t raw_bytes_of(const FrameSource& source);

}  // namespace alcove
