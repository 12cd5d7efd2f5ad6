// Parameters of the kernel that core/chain/results/confidence.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_CONFIDENCE_H
#define ALCOVE_CONFIDENCE_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct ConfidenceParams {
  View view;
  float radius;          // scene units
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

ALCOVE_END
#endif
