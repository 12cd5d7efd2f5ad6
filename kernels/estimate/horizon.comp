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
// - With kInSectors, which is `--estimator bitmask`, what the own surface blocks is counted in these sectors too, as by
//   the mask of Therrien et al., "Screen Space Indirect Lighting with Visibility Bitmask", 2023.
// - A run that something nearer interrupts goes on behind it, as far as it would not be seen, and one that the image's
//   border cuts goes on beyond it (pieces.glsl).
// - Falloff weighs each arc by the distance of the sample that first blocks it ("incremental arcs"), which is exact for
//   height fields.
// - The result is 1 - (sum of blocked arcs) / (sum of whole arcs): exactly 1 where nothing rises above the tangent
//   plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/noise.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/estimate/falloff.glsl"
#include "kernels/estimate/bent.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"
#include "kernels/estimate/sectors.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kSlices = 3;           // slices per pixel
layout(constant_id = 1) const uint kSteps = 6;            // steps to each side of a slice
layout(constant_id = 2) const uint kMode = kFalloffNone;  // one of kFalloff* of falloff.glsl, and kWith* or not
// one of kThickness*, of what is not connected to the receiver, kCompletes* and kInSectors or not, and
// kHiddenSurface times as many surfaces as a pixel may have behind the first
layout(constant_id = 4) const uint kSolid = kThicknessWidth;
layout(constant_id = 3) const uint kSparse = 0;  // 1: only the sites of the list are estimated
layout(scalar, push_constant) uniform Push { HorizonParams params; };
readonly buffer Depth { float depth[]; };  // one float per pixel, from prepare
// one float per pixel, depth of the first surfaces that may block
readonly buffer Occluders { float occluder_depth[]; };
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
// one float per pixel, visibility in [0, 1], 1 = open; the plane of the parameters
writeonly buffer Ao { float ao[]; };
readonly buffer List { uint list[]; };                         // one uint per listed tile, from classify
readonly buffer Sites { uint sites[]; };                       // one uint per site, from list_sites; only if sparse
readonly buffer SiteCountsBuffer { SiteCounts site_counts; };  // only if sparse
readonly buffer Counts { TileCounts counts; };
// planes x, y, z of the mean open direction b in view space as 0.5 + 0.5 b; only with kWithBent
writeonly buffer Bent { float bent[]; };
// one float per pixel, the visibility that completed surfaces took; only with kWithCompleted
writeonly buffer Completed { float completed[]; };
readonly buffer Hidden { float hidden[]; };  // planes of hidden surfaces that may block, see GBuffer; with layers only

// How many surfaces a pixel has at most: 1, or for horizon_layers as kSolid says. CMakeLists.txt makes two kernels of
// this file, since drivers take long over code that is left out by a specialization constant alone.
const int kSurfaces = ALCOVE_SURFACES;

#include "kernels/estimate/horizon.glsl"
#include "kernels/estimate/receivers.glsl"

void write_bent(int index, int plane, vec3 b) {
  for (int c = 0; c < 3; c++) bent[index + c * plane] = stored_bent(b)[c];
}

/// Writes the visibility of a pixel and, where it is asked for, its mean open direction.
void estimate(ivec2 pixel) {
  const View view = params.view;
  const int index = index_of(view, pixel);
  const int plane = view.size.x * view.size.y;
  const int ao_index = index + int(params.plane) * plane;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[ao_index] = 1.0;
    if (kTellsCompleted) completed[index] = 0.0;
    if (kBent) write_bent(index, plane, vec3(0));
    return;
  }
  const Receiver r = receiver_at(view, pixel, z, unpack_normal(normal[index]), params.radius, params.depth_precision);
  const Reach reach = reach_of(view, params.radius, params.falloff_start, params.thickness, params.bias);
  const vec2 noise = pixel_noise(pixel + params.noise_origin, params.noise_shift);
  float blocked = 0.0;
  float whole = 0.0;
  float completed_arcs = 0.0;
  vec3 bent_blocked = vec3(0);
  for (uint s = 0u; s < kSlices; s++) {
    const Slice slice = slice_at(view, r, s, kSlices, noise.x);
    if (slice.weight < kLeastWeight) continue;
    whole += slice.share * slice.weight * (slice.cos_gamma + slice.gamma * slice.sin_gamma);
    for (int sign = -1; sign <= 1; sign += 2) {
      const Side side = side_of(view, r, slice, float(sign), reach);
      const vec4 arcs = slice.share * slice.weight * search(r, side, reach, draw_of(noise, s, uint(sign > 0)));
      blocked += arcs.x;
      if (kTellsCompleted) completed_arcs += arcs.w;
      if (kBent) bent_blocked += arcs.y * float(sign) * slice.t + arcs.z * r.eye;
    }
  }
  const float visibility = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
  ao[ao_index] = visibility;
  if (kTellsCompleted) completed[index] = whole > 0.0 ? clamp(completed_arcs / whole, 0.0, 1.0 - visibility) : 0.0;
  if (kBent) write_bent(index, plane, open_bent(r.normal) - (whole > 0.0 ? bent_blocked / whole : vec3(0)));
}

void main() {
  const ListedPixel here = listed_pixel(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
  if (both(here.exists, is_mine(list[here.tile]))) estimate(here.pixel);
}
