// How a frame that is too large for memory or device is cut into tiles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/run/frame_memory.h"
#include "core/run/region.h"

namespace alcove {

/// What one frame in flight may take.
struct Room {
  static constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t bytes = 0;                // of host memory
  std::uint64_t device_bytes = kEndless;  // of the device's own memory
  std::uint64_t buffer_bytes = 0;         // of one buffer of the device
  std::uint64_t pixels = kEndless;        // at once: fewer than those for which the device had no memory
  // For messages: what the process takes without frames, and whether the user has said how much it may take.
  std::uint64_t program_bytes = 0;
  bool is_chosen = false;
};

/// Fails with ErrorKind::input where a frame reaches so far that an exact search could not number its lines, however
/// the frame is cut.
void require_numbered_lines(const FrameSource& source, const EstimatorSettings& settings);

/// What decides whether a window can be computed at once.
struct WindowLimits {
  FrameMemory memory;
  Room room;
  int longest_side = std::numeric_limits<int>::max();  // px
  std::uint64_t kept = 0;                              // bytes of host memory that are taken whatever is computed

  /// The limits of a frame's parts, whose planes stay in host memory as they were read. Fails as refuse() does where
  /// that has no room for them, and names what the whole frame takes.
  WindowLimits in_parts(const FrameSource& source) const;

  /// `beside`: bytes of host memory that are taken meanwhile.
  bool allow(const Window& computed, std::uint64_t beside = 0) const;
  /// Why a window is not allowed: a clause for messages.
  std::string why_not(const Window& computed) const;
  /// Fails for a frame that cannot be computed since this window is too large. `what` says so, and names what would
  /// mend it beside more memory.
  [[noreturn]] void refuse(const std::string& what, const Window& computed) const;
  /// The same where so many bytes of host memory would do. It is ErrorKind::usage where the user has given less.
  [[noreturn]] void refuse(const std::string& what, std::uint64_t least) const;

 private:
  /// So many bytes of host memory with what codecs take beyond their present bytes where a run has them.
  std::uint64_t with_larger_codecs(std::uint64_t bytes) const;
};

/// Rows of tiles from the top, each from the left.
using TileRows = std::vector<std::vector<Window>>;

/// Cuts the window of all results into rows of tiles, from the top, and each row into tiles, from the left, so that
/// each tile is allowed with its surroundings, and few pixels are computed twice. Fails as WindowLimits::refuse() does
/// where the radius reaches so far that no tile is small enough.
TileRows tiles_of(const Window& whole, Surroundings& surroundings, const WindowLimits& limits,
                  const FrameSource& source);

}  // namespace alcove
