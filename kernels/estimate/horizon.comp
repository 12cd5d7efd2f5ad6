// Ambient occlusion by horizon search in slices through the view ray (GTAO), cosine weighted, with occluders of finite
// thickness.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals; how far back each pixel is solid.
// Out: visibility, 1 = open; where they are asked for, the moments of the blocked directions (see moments.glsl), what
// the receiver's own surface blocks inside and outside (own_surface.glsl), and the visibility that completed surfaces
// took.
//
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016. Lines are those of the listing
// of its algorithm in the edition of 2019 (Technical Memo ATVI-TR-19-01). The steps have their numbers at the code:
//  1. A receiver takes kSlices slices (lines 4 to 10). They are even in azimuth about the view ray, not on the screen,
//     so that no Jacobian is owed off axis.
//  2. The normal is projected into the slice: its angle gamma, and its length, which is the slice's weight (lines 11 to
//     15).
//  3. Each side of the slice is searched (line 17) as far as the exact image of the sphere of the radius reaches. The
//     image's border cuts it: nothing is known beyond.
//  4. A side takes up to kSteps samples (lines 19 to 23).
//  5. Samples of a side form runs of one surface, by what is seen in the middle between two of them, too. The
//     receiver's own surface is what goes on from the receiver, or from any place below its tangent plane. It blocks
//     all below its horizon (line 24). A sample below the tangent plane says nothing else.
//  6. Every other run blocks from its front to its back, and nothing beyond the radius. The back lies further along the
//     eye's ray by the run's width ("width as thickness": a blade of grass is as thin as it is narrow, a column as
//     thick as it is broad), or as far as the sample's pixel tells (backs.comp), or by what the user says. A front
//     before the sphere blocks by the part of its solid within the sphere. The paper lets the horizon sink instead
//     (section 4.3).
//     Runs are counted in 24 sectors, as in the mask of Therrien et al., "Screen Space Indirect Lighting with
//     Visibility Bitmask", 2023; see sectors.glsl. With kInSectors, which is `--estimator bitmask`, so is the own
//     surface; else its interval is exact.
//  7. A run that something nearer interrupts goes on behind it, as far as it would not be seen. What the image's border
//     cuts goes on beyond it in its plane. See pieces.glsl.
//  8. Falloff weighs each arc by the distance of the sample that first blocks it ("incremental arcs"), which is exact
//     for height fields.
//  9. The arcs that are blocked are integrated in closed form (line 28): see arc_to().
// 10. The result is 1 - (sum of blocked arcs) / (sum of whole arcs), where the paper divides by the number of slices
//     (line 30): so it is exactly 1 where nothing rises above the tangent plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/noise.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/moments.glsl"
#include "kernels/estimate/arc_moments.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"
#include "kernels/estimate/sectors.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kSlices = 3;  // slices per pixel
layout(constant_id = 1) const uint kSteps = 6;   // steps to each side of a slice
// CMakeLists.txt makes specialization constants of these two, 2 and 4, but in the twin.
ALCOVE_MODE const uint kMode = kFalloffNone;  // one of kFalloff* of slice.glsl, and kWith* or not
// one of kThickness*, of what is not connected to the receiver, kCompletes*, kInSectors and kTellsBacks or not, and
// kHiddenSurface times as many surfaces as a pixel may have behind the first
ALCOVE_SOLID const uint kSolid = kThicknessWidth | kCompletesBorder | kCompletesHidden | kTellsBacks;
layout(constant_id = 3) const uint kSparse = 0;  // 1: only the sites of the list are estimated
layout(scalar, push_constant) uniform Push { HorizonParams params; };
// Bindings have their numbers here, so that those of the twin are the same: it leaves out what it does not use.
layout(binding = 0) readonly buffer Depth { float depth[]; };  // one float per pixel, from prepare
// one float per pixel, depth of the first surfaces that may block
layout(binding = 1) readonly buffer Occluders { float occluder_depth[]; };
layout(binding = 2) readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
// one float per pixel, visibility in [0, 1], 1 = open; the plane of the parameters
layout(binding = 3) writeonly buffer Ao { float ao[]; };
layout(binding = 4) readonly buffer List { uint list[]; };    // one uint per listed tile, from classify
layout(binding = 5) readonly buffer Sites { uint sites[]; };  // one uint per site, from list_sites; only if sparse
layout(binding = 6) readonly buffer SiteCountsBuffer { SiteCounts site_counts; };  // only if sparse
layout(binding = 7) readonly buffer Counts { TileCounts counts; };
// planes of the moments of the blocked directions in view space, see stored_moment(), with kWithFirst; then for each
// radius what the own surface leaves open inside and outside, with kWithCurvature
layout(binding = 8) writeonly buffer Moments { float moments[]; };
// one float per pixel, the visibility that completed surfaces took; only with kWithCompleted
layout(binding = 9) writeonly buffer Completed { float completed[]; };
// planes of hidden surfaces that may block, see GBuffer; with layers only
layout(binding = 10) readonly buffer Hidden { float hidden[]; };
// one uint per pixel, how far back it is solid, from backs; only with kTellsBacks
layout(binding = 11) readonly buffer Backs { uint backs[]; };

// How many surfaces a pixel has at most: 1, or for horizon_layers as kSolid says. CMakeLists.txt makes kernels of
// this file, since drivers take long over code that is left out by a specialization constant alone.
const int kSurfaces = ALCOVE_SURFACES;

const uint kFalloff = kMode & ~(kWithFirst | kWithSecond | kWithCompleted | kWithCurvature);
const bool kCurved = (kMode & kWithCurvature) != 0u;
const uint kOrder = (kMode & kWithSecond) != 0u ? 2u : (kMode & kWithFirst) != 0u ? 1u : 0u;
const bool kTellsCompleted = (kMode & kWithCompleted) != 0u;
const bool kHard = kFalloff == kFalloffNone;
const uint kThickness = kSolid & 3u;
const bool kBeyondBorder = (kSolid & kCompletesBorder) != 0u;
const bool kBehindOthers = (kSolid & kCompletesHidden) != 0u;
const bool kAllInSectors = (kSolid & kInSectors) != 0u;
const bool kHasBacks = (kSolid & kTellsBacks) != 0u;

/// Steps from the receiver to sample k of `count`.
float offset_of(int k, int count, Side side, Draw draw) {
  return step_offset(k, int(kSteps), count, side.reach, draw.jitter);
}

// All that is blocked matters.
bool is_settled(float near, uint sectors) { return false; }
bool is_concerned(float slope) { return true; }

#include "kernels/estimate/runs.glsl"

/// 4. to 9. The blocked part of a side's integrals; in the last row of the second column the part of its arc that
/// completed surfaces block. curved: what the own surface blocks of the arc, inside and outside.
mat2x3 arcs_of(Receiver r, Side side, Reach reach, Draw draw, out vec2 curved) {
  Found found = search(r, side, reach, draw, min(int(kSteps), int(side.reach)));
  curved = ended(found.own, r, side, reach);
  if (!kHard) {
    found.sum[1].z = found.completed_sum;
    return found.sum;
  }
  mat2x3 arcs = blocked_arcs(side, all_of(found), draw.shift);
  if (kTellsCompleted) arcs[1].z = arcs[0].x - blocked_arcs(side, found.blocked, draw.shift)[0].x;
  return arcs;
}

/// Random numbers of a side, from those of its pixel. The boundaries of the sectors move by the fraction of a multiple
/// of the steps' jitter. Of a number that is even in [0, 1), the fraction of m times it is even too, and their
/// correlation is 1 / m: here 9 %.
Draw draw_of(vec2 noise, uint slice, uint side) {
  const float jitter = fract(noise.y + kGolden * float(2u * slice + side));
  return Draw(jitter, fract(11.0 * jitter));
}

#include "kernels/estimate/receivers.glsl"

void write_moments(int index, int plane, mat3 blocked) {
  for (int k = 0; k < moments_in(kOrder); k++) moments[index + k * plane] = stored_moment(moment(blocked, k));
}

/// Writes what of the hemispheres inside and outside the receiver's own surface leaves open.
void write_curvature(int index, int plane, vec2 blocked) {
  if (!kCurved) return;
  moments[index + int(params.curvature) * plane] = clamp(1.0 - blocked.x, 0.0, 1.0);
  moments[index + (int(params.curvature) + 1) * plane] = clamp(1.0 - blocked.y, 0.0, 1.0);
}

/// Writes the visibility of a pixel and, where they are asked for, the moments of what is blocked.
void estimate(ivec2 pixel) {
  const View view = params.view;
  const int index = index_of(view, pixel);
  const int plane = view.size.x * view.size.y;
  const int ao_index = index + int(params.plane) * plane;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[ao_index] = 1.0;
    if (kTellsCompleted) completed[index] = 0.0;
    write_moments(index, plane, mat3(0));
    write_curvature(index, plane, vec2(0));
    return;
  }
  const Receiver r = receiver_at(view, pixel, z, unpack_normal(normal[index]), params.radius, params.depth_precision);
  const Reach reach = reach_of(view, params.radius, params.falloff_start, params.front, params.thickness, params.bias);
  const vec2 noise = pixel_noise(pixel + params.noise_origin, params.noise_shift);
  float blocked = 0.0;
  float whole = 0.0;
  float completed_arcs = 0.0;
  mat3 blocked_moments = mat3(0);
  vec2 curvature = vec2(0);
  uint s = 0u;
  do {
    const Slice slice = slice_at(view, r, s, kSlices, noise.x);  // 1. and 2.
    if (slice.weight < kLeastWeight) continue;
    whole += slice.share * slice.weight * (slice.cos_gamma + slice.gamma * slice.sin_gamma);  // both sides' whole_arc()
    int sign = -1;
    do {
      const Side side = side_of(view, r, slice, float(sign), reach);  // 3.
      vec2 curved;
      const mat2x3 arcs =
          slice.share * slice.weight * arcs_of(r, side, reach, draw_of(noise, s, uint(sign > 0)), curved);
      if (kCurved) curvature += slice.share * slice.weight * curved;
      blocked += arcs[0].x;
      if (kTellsCompleted) completed_arcs += arcs[1].z;
      if (kOrder > 0u) blocked_moments += moments_of(arcs, float(sign) * slice.t, r.eye);
      sign += 2;
    } while (sign <= 1);
  } while (++s < kSlices);
  // 10.
  const float visibility = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
  ao[ao_index] = visibility;
  if (kTellsCompleted) completed[index] = whole > 0.0 ? clamp(completed_arcs / whole, 0.0, 1.0 - visibility) : 0.0;
  write_moments(index, plane, whole > 0.0 ? blocked_moments / whole : mat3(0));
  write_curvature(index, plane, whole > 0.0 ? curvature / whole : vec2(0));
}

void main() {
  const ListedPixel here = listed_pixel(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
  if (both(here.exists, is_mine(list[here.tile]))) estimate(here.pixel);
}
