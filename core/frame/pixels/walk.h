// The walk over the pixels of a frame: rows and columns all over the picture, in parallel.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/frame/pixels/findings.h"
#include "core/frame/reading.h"

namespace alcove {

/// The planes that are walked over, as in the file, over a window, and how they are read.
struct WalkedPlanes {
  const Reading& reading;  // over that window
  Window frame;            // all pixels that the files hold
  std::span<const float> depth, normal;
  bool has_read_normals = false;  // the reading of the normals is settled, too
};

/// Samples rows and columns, and fills in their findings. The result does not depend on the number of threads.
void walk(const WalkedPlanes& planes, Findings& findings);

}  // namespace alcove
