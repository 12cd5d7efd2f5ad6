// Parameters and bindings of matte.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_MATTE_H
#define ALCOVE_MATTE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kMatteRaw = 0;      // in: planes of floats, as in the file
ALCOVE_CONSTANT uint kMatteObjects = 1;  // in: one uint per object that is meant, the bits of its float; rising
ALCOVE_CONSTANT uint kMatteResult = 2;   // out: one float per pixel, 0 to 1

ALCOVE_CONSTANT uint kMatteCoverage = 0;  // one plane of it
ALCOVE_CONSTANT uint kMatteNumbers = 1;   // one plane of objects
ALCOVE_CONSTANT uint kMatteRanked = 2;    // pairs of planes: an object, and its coverage

ALCOVE_CONSTANT uint kMatteFormId = 0;   // specialization: one of the above
ALCOVE_CONSTANT uint kMatteRanksId = 1;  // specialization: pairs of planes; of other forms 1

struct MatteParams {
  ivec2 size;    // px
  uint objects;  // of kMatteObjects
};
ALCOVE_PARAMS(MatteParams)

ALCOVE_END
#endif
