// Ambient occlusion by horizon search in slices through the view ray (GTAO), cosine weighted, with occluders of finite
// thickness.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals.
// Out: visibility, 1 = open; where they are asked for, the mean open direction (see bent.glsl), and what of the
// visibility completed surfaces took.
//
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, with these differences:
// - Slices are even in azimuth about the view ray, not on the screen, so that no Jacobian is owed off axis.
// - The reach is the exact image of the sphere of the radius in the slice, clipped to the image: what is outside is
//   unknown.
// - The samples of a side form runs of one surface. What goes on from the receiver, or from any place below its tangent
//   plane, is its own surface: it blocks all below its horizon. A sample that is not above that plane says nothing
//   else.
// - Every other run blocks from its front to its back, which lies as much further along the eye's ray as the run is
//   wide ("width as thickness": a blade of grass is as thin as it is narrow, a column as thick as it is broad), or as
//   the user says. Nothing beyond the radius blocks. What the own surface blocks is an interval, exact; what all other
//   runs block is counted in 24 sectors (sectors.glsl).
// - A run that something nearer interrupts goes on behind it, as far as it would not be seen, and one that the image's
//   border cuts goes on beyond it (pieces.glsl).
// - Falloff weighs each arc by the distance of the sample that first blocks it ("incremental arcs"), which is exact for
//   height fields.
// - The result is 1 - (sum of blocked arcs) / (sum of whole arcs): exactly 1 where nothing rises above the tangent
//   plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "horizon.h"
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

// That of this kernel; `hidden` is not looked at.
const int kSurfaces = 1;

#include "horizon.glsl"

void main() {
  const ListedPixel here = listed_pixel(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
  if (both(here.exists, is_mine(list[here.tile]))) estimate(here.pixel);
}
