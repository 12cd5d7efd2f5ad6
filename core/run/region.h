// Regions of a frame, and the surroundings that the AO within them depends on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/frame/gbuffer.h"

namespace alcove {

/// Turns a region of the display window into pixels of the file. Fails with ErrorKind::usage where it is not within the
/// data window.
Window region_of(const FrameSource& source, const Region& roi);

/// How far around the parts of a frame its results reach back, by the nearest depth in them: occluders of the radius,
/// and the filters of the settings.
class Surroundings {
 public:
  /// Of a settled frame, by its depth as it was read, which must stay.
  Surroundings(const FrameSource& source, const Settings& settings, std::span<const float> depth);

  /// The window whose depths decide how far the surroundings of a part reach: the part with what filters need.
  Window direct(const Window& part) const;
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
  Reach reach(double distance, double nearest, const Window& block) const;
  /// The window of everything that may be seen beside what a window shows.
  Window within(Reach Block::*reach, const Window& window);

  const FrameSource& source_;
  std::span<const float> depth_;  // over file_data_, components one behind the other
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

}  // namespace alcove
