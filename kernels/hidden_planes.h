// Parameters and bindings of hidden_planes.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_HIDDEN_PLANES_H
#define ALCOVE_HIDDEN_PLANES_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kHiddenPlanesIn = 0;   // in: planes of floats, see GBuffer::hidden; not read where there are none
ALCOVE_CONSTANT uint kHiddenPlanesOut = 1;  // out: for each surface a plane of depth and one that says what it is

struct HiddenPlanesParams {
  View view;
  uint known;  // planes that there are
  uint kept;   // surfaces to write
};
ALCOVE_PARAMS(HiddenPlanesParams)

ALCOVE_END
#endif
