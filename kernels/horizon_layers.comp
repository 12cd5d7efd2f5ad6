// horizon.comp where surfaces are hidden behind the first one, for tiles that have some within reach of a receiver.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, planes of hidden surfaces.
// Out: as that of horizon.comp.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "horizon_layers.h"
#include "view.glsl"
#include "normal.glsl"
#include "arcs.glsl"
#include "noise.glsl"
#include "tiles.glsl"
#include "falloff.glsl"
#include "bent.glsl"
#include "clearance.glsl"
#include "slice.glsl"
#include "sectors.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kHorizonSlicesId) const uint kSlices = 3;
layout(constant_id = kHorizonStepsId) const uint kSteps = 6;
layout(constant_id = kHorizonModeId) const uint kMode = kFalloffNone;
layout(constant_id = kHorizonSolidId) const uint kSolid = kThicknessWidth;
layout(constant_id = kHorizonSparseId) const uint kSparse = 0;
layout(scalar, push_constant) uniform Push { SlicesParams params; };
layout(scalar, binding = kSlicesDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kSlicesOccluders) readonly buffer Occluders { float occluder_depth[]; };
layout(scalar, binding = kSlicesNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kSlicesAo) writeonly buffer Ao { float ao[]; };
layout(scalar, binding = kSlicesList) readonly buffer List { uint list[]; };
layout(scalar, binding = kSlicesSites) readonly buffer Sites { uint sites[]; };
layout(scalar, binding = kSlicesSiteCounts) readonly buffer SiteCountsBuffer { SiteCounts site_counts; };
layout(scalar, binding = kSlicesCounts) readonly buffer Counts { TileCounts counts; };
layout(scalar, binding = kSlicesBent) writeonly buffer Bent { float bent[]; };
layout(scalar, binding = kSlicesCompleted) writeonly buffer Completed { float completed[]; };
layout(scalar, binding = kSlicesHidden) readonly buffer Hidden { float hidden[]; };

const int kSurfaces = 1 + int(kSolid / kHiddenSurface);

#include "horizon.glsl"

void main() {
  const ListedPixel here = listed_pixel(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
  if (both(here.exists, is_mine(list[here.tile]))) estimate(here.pixel);
}
