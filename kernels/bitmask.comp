// Ambient occlusion by a visibility bitmask in slices through the view ray, cosine weighted.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals.
// Out: visibility, 1 = open; where they are asked for, the mean open direction (see bent.glsl), and what of the
// visibility completed surfaces took.
//
// Therrien et al., "Screen Space Indirect Lighting with Visibility Bitmask", 2023: every sample blocks the angles
// between its front and its back, and the bits of a mask say which angles are blocked. The differences are these:
// - The 64 sectors of a slice, 32 per side, have equal measure of the cosine-weighted arc integral, not equal angles:
//   counting bits is integrating.
// - An interval begins and ends at floor(32 F + u), with one random u per slice, which is unbiased. Rounding outwards
//   would block 1.6 % too much.
// - The back lies along the sample's own eye ray, clipped to the sphere of the radius.
// - Between two samples of one surface nothing is open. A sample that is not above the tangent plane says nothing else,
//   so it may be left out. What rises from there is treated as the receiver's own surface.
// - A surface that something nearer interrupts goes on behind it, and one that the image's border cuts goes on beyond
//   it (pieces.glsl).
//
// With occluders that are infinitely thick the result is that of horizon.comp. With `thickness` 0 a sample is as thick
// as its surface is wide up to there.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "bitmask.h"
#include "view.glsl"
#include "normal.glsl"
#include "arcs.glsl"
#include "noise.glsl"
#include "tiles.glsl"
#include "falloff.glsl"
#include "bent.glsl"
#include "clearance.glsl"
#include "slice.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kBitmaskSlicesId) const uint kSlices = 3;
layout(constant_id = kBitmaskStepsId) const uint kSteps = 6;
layout(constant_id = kBitmaskModeId) const uint kMode = kFalloffNone;
layout(constant_id = kBitmaskSparseId) const uint kSparse = 0;
layout(constant_id = kBitmaskCompleteId) const uint kComplete = 0;
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

#include "bitmask.glsl"

void main() {
  const ListedPixel here = listed_pixel(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
  if (both(here.exists, is_mine(list[here.tile]))) estimate(here.pixel);
}
