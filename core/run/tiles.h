// Parts of a frame: the surroundings that the AO within them depends on, and how a frame that is too large for memory
// or device is cut into tiles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/find/frame_source.h"
#include "core/run/memory.h"

namespace alcove {

/// Turns a region of the display window into pixels of the file. Fails with ErrorKind::usage where it is not within the
/// data window.
Window region_of(const FrameSource& source, const Region& roi);

/// How far around the parts of a frame its results reach back, by the nearest depth in them: occluders of the radius,
/// and the filters of the settings.
class Surroundings {
 public:
  /// Gives the depth of whole rows, as it is read.
  using DepthRows = std::function<std::vector<float>(const Window& rows)>;

  /// Of a settled frame, by its depth, which is asked for when it is needed.
  Surroundings(const FrameSource& source, const Settings& settings, DepthRows depth);
  /// The same by the depth of all of it, which must stay.
  Surroundings(const FrameSource& source, const Settings& settings, std::span<const float> depth);

  /// The window to compute for the results in a part to be, to the bit, what they are in the whole frame.
  Window around(const Window& part);

 private:
  /// How far what is seen beside a block of pixels may be from it, px.
  struct Reach {
    int x = 0, y = 0;
  };
  /// What is known of a block once its depths have been looked at.
  struct Block {
    Reach occluders;  // within the radius
    Reach runs;       // within the widest run of an exact search
  };

  /// One row of blocks.
  const std::vector<Block>& blocks_of(int block_row);
  Window window_of(int block_row, int column) const;
  std::vector<float> nearest_depths(int block_row);
  /// The window whose depths decide how far the surroundings of a part reach: the part with what filters need.
  Window direct(const Window& part) const;
  Reach reach(double distance, double nearest, const Window& block) const;
  /// The window of everything that may be seen beside what a window shows.
  Window within(Reach Block::*reach, const Window& window);

  const FrameSource& source_;
  const DepthRows depth_;
  const Window file_data_;
  const int columns_;                       // blocks across the frame
  std::vector<std::vector<Block>> blocks_;  // row by row; empty: not known yet
  View view_;
  bool orthographic_;
  double radius_;      // scene units
  int filters_;        // px that filters reach
  int lines_;          // px that the lines of an exact search need beyond the radius
  int pairs_;          // px beyond all these within which solids are closed
  double widest_run_;  // radii, beyond which they need no more of a run
};

/// Fails with ErrorKind::input where a frame reaches so far that an exact search could not number its lines, however
/// the frame is cut.
void require_numbered_lines(const FrameSource& source, const EstimatorSettings& settings);

/// The host memory that a frame needs, in bytes, and the cost of having no more than the least.
struct MemoryNeeds {
  std::uint64_t least = 0, at_once = 0;
  std::size_t parts = 1;  // with the least
  double factor = 1;      // pixels that the parts compute, for each that is computed at once

  /// "in 62 parts, about 12 times as long".
  std::string cost() const;
};

/// What decides whether a window can be computed at once.
struct WindowLimits {
  FrameMemory memory;
  Room room;
  int longest_side = std::numeric_limits<int>::max();  // px
  std::uint64_t kept = 0;                              // bytes of host memory that are taken whatever is computed

  /// The limits of a frame's parts, whose planes stay in host memory as they were read. Fails as refuse() does where
  /// that has no room for them.
  WindowLimits in_parts(FrameSource& source, const Settings& settings) const;

  /// `beside`: bytes of host memory that are taken meanwhile.
  bool allow(const Window& computed, std::uint64_t beside = 0) const;
  /// Why a window is not allowed: a clause for messages.
  std::string why_not(const Window& computed) const;
  /// Fails for a frame that cannot be computed since this window is too large. `what` says so, and names what would
  /// mend it beside more memory.
  [[noreturn]] void refuse(const std::string& what, const Window& computed) const;
  /// The same where so much host memory would do. It is ErrorKind::usage where the user has given less.
  [[noreturn]] void refuse(const std::string& what, const MemoryNeeds& needs) const;

  /// The --memory that leaves a frame so many bytes, with what codecs take beyond their present bytes where a run has
  /// them: "395M".
  std::string option_for(std::uint64_t bytes) const;
};

/// What a frame needs, cut into parts or not. It must be settled.
MemoryNeeds memory_needs(const FrameSource& source, Surroundings& surroundings, const WindowLimits& limits);
/// The same by a depth that is read for it, row by row. Settles the frame where nobody has.
MemoryNeeds memory_needs(FrameSource& source, const Settings& settings, const WindowLimits& limits);

/// The parts that a frame is computed in within the limits, and their cost. Settles the frame where nobody has. Fails
/// as tiles_of() does.
MemoryNeeds tiles_within(FrameSource& source, const Settings& settings, const WindowLimits& limits);

/// Rows of tiles from the top, each from the left.
using TileRows = std::vector<std::vector<Window>>;

/// Cuts the window of all results into rows of tiles, from the top, and each row into tiles, from the left, so that
/// each tile is allowed with its surroundings, and few pixels are computed twice. Fails as WindowLimits::refuse() does
/// where the radius reaches so far that no tile is small enough.
TileRows tiles_of(const Window& whole, Surroundings& surroundings, const WindowLimits& limits,
                  const FrameSource& source);

}  // namespace alcove
