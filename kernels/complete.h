// Parameters and bindings of complete.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_COMPLETE_H
#define ALCOVE_COMPLETE_H
#include "profile.h"
ALCOVE_BEGIN

// in and out: from profile; a vertex from which its surface goes on has its depth negated
ALCOVE_CONSTANT uint kCompleteVertex = 0;
ALCOVE_CONSTANT uint kCompleteMark = 1;  // in: from profile
// out: one uint for each vertex with a negative depth: up to where its surface goes on (pack_goes_on())
ALCOVE_CONSTANT uint kCompleteGoesOn = 2;
// out: one uint per vertex: the columns of the nearest vertices before (low half) and after it (high half) whose
// surface goes on behind it; kNoVertex: none
ALCOVE_CONSTANT uint kCompleteBehind = 3;
ALCOVE_CONSTANT uint kCompleteNormal = 4;  // in: one uint per pixel, from prepare
// Only with several surfaces:
ALCOVE_CONSTANT uint kCompleteDepth = 5;   // in: as profile's
ALCOVE_CONSTANT uint kCompleteHidden = 6;  // in: planes of floats, see GBuffer::hidden

// specialization: of a pixel. Of several, the profile is a plane among others, and `behind` is of that one alone of
// which surfaces go on behind what is nearer.
ALCOVE_CONSTANT uint kCompleteSurfacesId = 0;
// specialization: 1: the frame tells all surfaces of a pixel, but for those behind as many as it may have
ALCOVE_CONSTANT uint kCompleteWholeId = 1;

ALCOVE_CONSTANT uint kCompleteGroup = 32;  // lines of a workgroup

struct CompleteParams {
  View view;
  Lines lines;   // as the profile's
  int first;     // as the profile's
  uint count;    // lines
  float radius;  // scene units: of the sphere beyond which nothing blocks
  uint behind;   // 0 or 1: surfaces go on behind what is nearer, beside beyond the border
  uint slot;     // planes of the profile before the one that is completed
};
ALCOVE_PARAMS(CompleteParams)

ALCOVE_END
#endif
