// Specialization of horizon.comp; its parameters and bindings are those of slices.h.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_HORIZON_H
#define ALCOVE_HORIZON_H
#include "slices.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kHorizonSlicesId = 0;  // specialization: slices per pixel
ALCOVE_CONSTANT uint kHorizonStepsId = 1;   // specialization: steps to each side of a slice
ALCOVE_CONSTANT uint kHorizonModeId = 2;    // specialization: one of kFalloff* of falloff.glsl, and kWith* or not
ALCOVE_CONSTANT uint kHorizonSparseId = 3;  // specialization: 1: only the sites of the list are estimated
// specialization: one of kThickness*, of what is not connected to the receiver, kCompletes* or not, and kHiddenSurface
// times as many surfaces as a pixel may have behind the first
ALCOVE_CONSTANT uint kHorizonSolidId = 4;

ALCOVE_CONSTANT uint kWithBent = 4;          // a bit beside kFalloff*: bent normals too
ALCOVE_CONSTANT uint kWithCompleted = 8;     // another one: what completed surfaces take, too
ALCOVE_CONSTANT uint kThicknessWidth = 0;    // as deep as wide
ALCOVE_CONSTANT uint kThicknessLength = 1;   // as SlicesParams says
ALCOVE_CONSTANT uint kThicknessEndless = 2;  // solid as far as the sphere of the radius
ALCOVE_CONSTANT uint kCompletesBorder = 4;   // a bit beside them: surfaces go on beyond the image's border
ALCOVE_CONSTANT uint kCompletesHidden = 8;   // another one: they go on behind what is nearer, if not kThicknessEndless
ALCOVE_CONSTANT uint kHiddenSurface = 16;

ALCOVE_END
#endif
