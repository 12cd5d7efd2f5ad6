// Parameters of the kernel that core/chain/estimate/completion.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_COMPLETION_H
#define ALCOVE_COMPLETION_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct CompletionParams {
  View view;
  ivec2 origin;  // px from the display window's corner to the image's
  int spacing;   // of the widest lattice of sites: see lattice.glsl; 1: all pixels have an estimate
  uint plane;    // of the visibility
};

ALCOVE_END
#endif
