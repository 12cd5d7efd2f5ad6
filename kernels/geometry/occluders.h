// Parameters of the kernel that core/chain/geometry/occluders.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_OCCLUDERS_H
#define ALCOVE_OCCLUDERS_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

// px: pixels that objects share look so far for one that tells them apart
ALCOVE_CONSTANT int kOccludersReach = 2;

struct OccludersParams {
  View view;
  uint ignores;    // 1: what the matte takes is no occluder; 0: what it does not take
  uint keeps;      // 1: where nothing is known behind such a surface, it stays
  uint lists_all;  // 1: a pixel with fewer hidden surfaces has no more: see GBuffer::hides_no_more
};

ALCOVE_END
#endif
