// Parts of a frame: the surroundings that their AO depends on, and the tiles of a frame that is too large for memory or
// device.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/find/frame_source.h"
#include "core/run/memory.h"

namespace alcove {

/// Turns a region of the display window into pixels of the file. Fails with ErrorKind::usage where it is not within the
/// data window.
Window region_of(const FrameSource& source, const Window& roi);

/// The margins around parts of a frame. Pixels within a margin influence the results of its part. A margin follows from
/// the radius at the nearest depth, and from the filters of the settings.
class Surroundings {
 public:
  /// Gives the depth of whole rows, as it is read.
  using DepthRows = std::function<std::vector<float>(const Window& rows)>;

  /// Of a settled frame. `depth` is called for the rows that are needed.
  Surroundings(const FrameSource& source, const Settings& settings, DepthRows depth);
  /// The same with the depth of the whole frame, which must outlive this.
  Surroundings(const FrameSource& source, const Settings& settings, std::span<const float> depth);

  /// The window to compute so that the results in a part have the bits of the whole frame.
  Window around(const Window& part);
  /// Whether surfaces beyond the radius block, as they do before lights.
  bool reaches_beyond_radius() const { return occluders_ > radius_; }

 private:
  /// The reach beside a block of pixels, px.
  struct Reach {
    int x = 0, y = 0;
  };
  /// The reaches of a block, from its depths.
  struct Block {
    Reach occluders;  // within the radius, or that of shadows
    Reach runs;       // within the widest run of an exact search
  };

  /// One row of blocks.
  const std::vector<Block>& blocks_of(int block_row);
  Window window_of(int block_row, int column) const;
  std::vector<float> nearest_depths(int block_row);
  /// The part with the reach of the filters. The depths in this window decide how far the surroundings extend.
  Window direct(const Window& part) const;
  Reach reach(double distance, double nearest, const Window& block) const;
  /// A window enlarged by the reaches of its blocks.
  Window within(Reach Block::*reach, const Window& window);

  const FrameSource& source_;
  const DepthRows depth_;
  const Window file_data_;
  const int columns_;                       // blocks across the frame
  std::vector<std::vector<Block>> blocks_;  // row by row; empty: not known yet
  View view_;
  bool orthographic_;
  double radius_;      // scene units
  double occluders_;   // scene units: how far surfaces block
  int filters_;        // px that filters reach
  int lines_;          // px that the lines of an exact search need beyond the radius
  int pairs_;          // px beyond all these for the passes that pair surfaces
  double widest_run_;  // radii: wider runs block as if infinite
};

/// Fails with ErrorKind::input where a frame reaches so far that an exact search could not number its lines, however
/// the frame is cut.
void require_numbered_lines(const FrameSource& source, const EstimatorSettings& settings);

/// The reason why no part of a frame is computed alone, with its remedy; "" if there is none. Pictures show a frame on
/// a scale of its own, which no part knows.
std::string why_whole(const Settings& settings, bool is_wedge);

/// The host memory that a frame needs, in bytes, and the cost in time of the least.
struct MemoryNeeds {
  std::uint64_t least = 0, at_once = 0;
  std::size_t parts = 1;  // with the least
  double factor = 1;      // pixels that the parts compute, relative to the whole at once

  /// "in 62 parts, about 12 times as long".
  std::string cost() const;
};

/// The limits of a window that is computed at once.
struct WindowLimits {
  FrameMemory memory;
  MemoryBudget budget;
  std::uint64_t kept = 0;  // bytes of host memory that are in use for any window

  /// The limits of a frame's parts while the frame's decoded planes stay in host memory. Fails as refuse() does if the
  /// planes do not fit.
  WindowLimits in_parts(FrameSource& source, const Settings& settings) const;

  /// Whether the window is too long for the passes to number its lines.
  bool is_too_long(const Window& computed) const;
  /// `beside`: further bytes of host memory in use meanwhile.
  bool allow(const Window& computed, std::uint64_t beside = 0) const;
  /// The reason why a window is not allowed: a clause for messages.
  std::string why_not(const Window& computed) const;
  /// Fails for a frame whose smallest window is too large. `what` says so, and names remedies other than more memory.
  [[noreturn]] void refuse(const std::string& what, const Window& computed) const;
  /// The same, and the message names `needs`, which would be enough. The kind is ErrorKind::usage if the user has given
  /// less.
  [[noreturn]] void refuse(const std::string& what, const MemoryNeeds& needs) const;

  /// The --memory that leaves a frame so many bytes, including the growth of the codecs' share: "395M".
  std::string option_for(std::uint64_t bytes) const;
};

/// The needs of a frame, cut into parts or not. Reads the depth row by row, and settles the frame if it is not settled.
MemoryNeeds memory_needs(FrameSource& source, const Settings& settings, const WindowLimits& limits);

/// The parts of a frame within the limits, and their cost. Settles the frame if it is not settled. Fails as tiles_of()
/// does.
MemoryNeeds tiles_within(FrameSource& source, const Settings& settings, const WindowLimits& limits);

/// Rows of tiles from the top, each from the left.
using TileRows = std::vector<std::vector<Window>>;

/// Cuts the window of all results into rows of tiles, from the top, and each row into tiles, from the left. The limits
/// allow each tile with its surroundings, and few pixels are computed twice. Fails as WindowLimits::refuse() does if
/// the radius reaches so far that no tile is small enough.
TileRows tiles_of(const Window& whole, Surroundings& surroundings, const WindowLimits& limits,
                  const FrameSource& source);

}  // namespace alcove
