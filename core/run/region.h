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
  /// Reads the depth of all rows of a settled frame that results within `whole` depend on directly, a few at a time.
  Surroundings(FrameSource& source, const Settings& settings, const Window& whole);

  /// The window to compute for the results in `part` of `whole` to be, to the bit, what they are in the whole frame.
  Window around(const Window& part) const;

 private:
  /// The nearest depth that a window shows.
  double nearest_in(const Window& window) const;
  /// The window of everything that may be seen within this distance of what a window shows.
  Window within(double distance, const Window& window) const;

  const Window file_data_;
  Window read_;                 // what the grid of nearest depths covers
  int columns_ = 0;             // blocks of that grid, across
  std::vector<float> nearest_;  // the nearest depth of every block, row by row
  View view_;
  bool orthographic_;
  double radius_;      // scene units
  int filters_;        // px that filters reach
  int lines_;          // px that the lines of an exact search need beyond the radius
  double widest_run_;  // radii, beyond which they need no more of a run
};

}  // namespace alcove
