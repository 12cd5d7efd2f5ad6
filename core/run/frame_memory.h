// How much memory a frame takes, known before its pixels are read.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/settings.h"
#include "core/chain/aov.h"
#include "core/frame/gbuffer.h"

namespace alcove {

/// The part of a frame's memory that the codec of one of its files may take.
constexpr std::uint64_t kCodecPart = 8;

/// The longest side of a window, in pixels, for the passes of these settings: the marks of an exact search hold the
/// step along a line in 16 bits.
int longest_side(const EstimatorSettings& settings);

/// What windows of a frame take while they are computed.
struct FrameMemory {
  /// Upper bounds, in bytes.
  struct Bytes {
    std::uint64_t device;  // of the device's own memory: all buffers
    std::uint64_t host;    // buffers or their staging twins, and what is read, shown and written
    std::uint64_t buffer;  // of the largest buffer
  };
  /// Rehearses the chain for a window.
  Bytes of(const Window& computed) const;
  /// What the codecs of the frame's files take of host memory where so much is left for the frame.
  std::uint64_t codec_bytes(std::uint64_t room) const;

  Reading reading;
  Window file_data;
  RawPlaneArray<std::size_t> channels;
  EstimatorSettings estimator;
  Wanted wanted;
  bool looks_at_others = false;

  std::uint64_t beside = 0;                 // in host memory beside buffers, for each pixel
  std::uint64_t written = 0;                // of the planes that are written, for each pixel
  std::vector<std::uint64_t> codec_groups;  // bytes of the rows that each codec takes together
  std::uint64_t fixed_on_device = 0;        // in buffers, whatever the window
  std::uint64_t fixed_bytes = 0;  // in host memory whatever the window: codecs, and files that are kept decoded
};
FrameMemory memory_of(const FrameSource& source, const Settings& settings);

/// The bytes of all planes of a frame, as they are read.
std::uint64_t raw_bytes_of(const FrameSource& source);

}  // namespace alcove
