// Ambient occlusion by horizon search in slices through the view ray (GTAO), cosine weighted, with occluders of finite
// thickness.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals. Out: visibility, 1 = open; the mean open direction (see bent.glsl) where it is asked
// for. Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, with these differences:
// - Slices are even in azimuth about the view ray, not on the screen, so that no Jacobian is owed off axis.
// - The reach is the exact image of the sphere of the radius in the slice, clipped to the image: what is outside is
//   unknown.
// - The samples of a side form runs of one surface. What goes on from the receiver, or from any place below its tangent
//   plane, is its own surface: it blocks all below its horizon. A sample that is not above that plane says nothing
//   else, so it may be left out where `classify` knows of it. Every other run blocks from its front to its back, which
//   lies as much further along the eye's ray as the run is wide ("width as thickness": a blade of grass is as thin as
//   it is narrow, a column as thick as it is broad), or as the user says. Nothing beyond the radius blocks. What is
//   blocked is an interval, exact, of the own surface's, and 24 sectors (sectors.glsl) of all others'.
// - Falloff weighs each arc by the distance of the sample that first blocks it ("incremental arcs"), exact for height
//   fields.
// - Result 1 - (sum of blocked arcs) / (sum of whole arcs): exactly 1 where nothing rises above the tangent plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "horizon.h"
#include "view.glsl"
#include "normal.glsl"
#include "arcs.glsl"
#include "noise.glsl"
#include "stride.glsl"
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
layout(constant_id = kHorizonThicknessId) const uint kThickness = kThicknessWidth;
layout(constant_id = kHorizonStrideId) const int kStride = 1;
layout(scalar, push_constant) uniform Push { HorizonParams params; };
layout(scalar, binding = kHorizonDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kHorizonNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kHorizonAo) writeonly buffer Ao { float ao[]; };
layout(scalar, binding = kHorizonList) readonly buffer List { ListedTile list[]; };
layout(scalar, binding = kHorizonCounts) readonly buffer Counts { TileCounts counts; };
layout(scalar, binding = kHorizonBent) writeonly buffer Bent { float bent[]; };

const uint kFalloff = kMode & ~kWithBent;
const bool kBent = (kMode & kWithBent) != 0u;

/// A run is wider than the distance of its outer samples by a pixel and, on average, by this part of the gaps to the
/// samples before and behind it.
const float kGapShare = 0.5;

/// All that is endless is one surface. Two samples of it on either side of the sphere are neighbours if their squared
/// distances are within this factor of its.
const float kSameSurface = 1.44;

const float kNone = 1e30;

/// A run of samples that is not the receiver's own surface. Angles go by slope_of(); where far > near nothing of it
/// blocks.
struct Run {
  vec2 start, end;  // its outer samples
  float gap;        // steps from the sample before it
  float near, far;  // largest and smallest of the samples that block
};

/// What is blocked: from `far` to `near`, by the receiver's own surface or all that is endless, and the sectors of
/// runs.
struct Blocked {
  float near, far;
  uint sectors;
};

// Logic without branches: `&&` and `||` would jump.
bool both(bool a, bool b) { return a ? b : false; }

/// arc_to() and, with bent normals, bent_to().
vec3 arcs_to(Side side, vec2 place) {
  const vec2 direction = place * inversesqrt(dot(place, place));
  return vec3(arc_to(side, place), kBent ? bent_to(direction.y, direction.x, side.cos_gamma, side.sin_gamma) : vec2(0));
}

/// These integrals over what is blocked.
vec3 blocked_arcs(Side side, Blocked blocked, float shift) {
  const float plane = slope_of(side.ahead), far = max(blocked.far, plane);
  const vec3 own = blocked.near > far ? arcs_to(side, place_at(far)) - arcs_to(side, place_at(blocked.near)) : vec3(0);
  if (kThickness == kThicknessEndless) return own;
  const uint others = blocked.sectors & ~sectors_below(max(blocked.near, plane), shift);
  return own + vec3(arc_of(side, others), kBent ? bent_of(side, others) : vec2(0));
}

/// What a run blocks that is `gap_behind` steps wide of the sample behind it.
uint sectors_of(Receiver r, Reach reach, Run run, float z, float gap_behind, float shift) {
  const float pixel = reach.pixel_size * (r.perspective ? z : 1.0);
  const float width = length(run.end - run.start) + pixel * (1.0 + kGapShare * (run.gap + gap_behind));
  // What is as deep as wide is not clipped to the sphere: no difference in the error, and it takes a tenth off the
  // time.
  const float back = slope_of(kThickness == kThicknessWidth ? run.start + width * away_from_eye(r, run.start)
                                                            : back_of(r, run.start, reach.thickness, reach.radius));
  return run.near >= run.far ? sectors_below(run.near, shift) & ~sectors_below(min(back, run.far), shift) : 0u;
}

/// The blocked part of a side's integrals. `range`: the steps at which something may stand above the tangent plane.
vec3 search(Receiver r, Side side, Reach reach, float jitter, uint range) {
  const int count = range != 0u ? min(int(kSteps), int(side.reach)) : 0;
  const float last_step = float(last_of_range(range)) + 0.5;
  const float shift = fract(11.0 * jitter);
  const bool hard = kFalloff == kFalloffNone;
  float last_z = r.z, last_offset = 0.0, last_slope = 0.0, last_distance_sq = kNone;
  vec3 last_arcs = vec3(0), sum = vec3(0);
  bool own = true, was_within = true, was_above = true;
  Blocked blocked = Blocked(-1.0, kThickness == kThicknessEndless ? 1.0 : -1.0, 0u);
  Run run = Run(vec2(0), vec2(0), 0.0, -1.0, 1.0);
  for (int k = first_sample(range, int(kSteps), count, side.reach, jitter, step_exponent(int(kSteps), side.reach));
       k < count && last_offset <= last_step; k++) {
    const float offset = step_offset(k, int(kSteps), count, side.reach, jitter), gap = offset - last_offset;
    const vec2 beside = round(side.direction_px * offset);
    const ivec2 hit = r.pixel + ivec2(beside);
    const float z = depth[hit.y * reach.width + hit.x], scale = r.perspective ? z : 1.0;
    const vec2 place = place_of(r, side, beside, z, scale);
    const float slope = slope_of(place), distance_sq = dot(place, place);
    const bool above = is_above(r, reach, place, distance_sq, offset, beside, z, scale),
               within = distance_sq < reach.radius_sq;
    const bool blocks = both(above, within);
    // A surface that crosses the sphere between two samples blocks up to there; that of a run, half way.
    const bool connected = kThickness == kThicknessEndless
                               ? both(max(distance_sq, last_distance_sq) < kSameSurface * reach.radius_sq,
                                      min(distance_sq, last_distance_sq) * kSameSurface > reach.radius_sq)
                               : same_surface(r, reach, z, last_z, gap);
    const bool crosses = hard ? both(both(above, was_above), both(connected, within != was_within)) : false;
    const float crossing =
        mix(slope, last_slope,
            kThickness == kThicknessEndless ? (reach.radius_sq - distance_sq) / (last_distance_sq - distance_sq) : 0.5);
    const float near = max(blocks ? slope : -1.0, crosses ? crossing : -1.0),
                far = min(blocks ? slope : 1.0, crosses ? crossing : 1.0);
    if (connected) run.end = place;
    if (kThickness != kThicknessEndless && (!connected || !above)) {
      if (hard) blocked.sectors |= sectors_of(r, reach, run, last_z, gap, shift);
      run = Run(place, place, gap, -1.0, 1.0);
      own = !above;
    }
    if (own) {
      blocked.near = max(blocked.near, near);
      if (kThickness == kThicknessEndless)
        blocked.far =
            min(blocked.far, blocks ? min(far, slope_of(back_of(r, place, reach.thickness, reach.radius))) : far);
    } else {
      run.near = max(run.near, near);
      run.far = min(run.far, far);
    }
    if (!hard) {
      blocked.sectors |= sectors_of(r, reach, run, z, 1.0, shift);
      const vec3 arcs = blocked_arcs(side, blocked, shift);
      sum += falloff_weight(kFalloff, sqrt(distance_sq), reach.falloff_start, reach.radius) * (arcs - last_arcs);
      last_arcs = arcs;
    }
    was_within = within;
    was_above = above;
    last_slope = slope;
    last_distance_sq = above ? distance_sq : kNone;
    last_z = z;
    last_offset = offset;
  }
  if (hard) blocked.sectors |= sectors_of(r, reach, run, last_z, 1.0, shift);
  return hard ? blocked_arcs(side, blocked, shift) : sum;
}

void write_bent(int index, int plane, vec3 b) {
  for (int c = 0; c < 3; c++) bent[index + c * plane] = stored_bent(b)[c];
}

void main() {
  const ListedPlace place = listed_place(gl_WorkGroupID.xy, gl_LocalInvocationIndex, kStride);
  if (place.tile >= counts.listed) return;
  const ivec2 pixel = pixel_of_tile(unpack_tile(list[place.tile].place), place.pixel, params.noise_origin, kStride);
  const View view = params.view;
  if (!inside(view, pixel)) return;
  const int index = index_of(view, pixel), plane = view.size.x * view.size.y,
            ao_index = index + int(params.plane) * plane;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[ao_index] = 1.0;
    if (kBent) write_bent(index, plane, vec3(0));
    return;
  }
  const Receiver r = receiver_at(view, pixel, z, unpack_normal(normal[index]), params.radius, params.depth_precision);
  const Reach reach = reach_of(view, params.radius, params.falloff_start, params.thickness, params.bias);
  const vec2 noise = pixel_noise(packed_place(pixel + params.noise_origin, kStride), params.noise_shift);
  float blocked = 0.0, whole = 0.0;
  vec3 bent_blocked = vec3(0);
  for (uint s = 0u; s < kSlices; s++) {
    const Slice slice = slice_at(view, r, s, kSlices, noise.x);
    if (slice.weight < kLeastWeight) continue;
    whole += slice.share * slice.weight * (slice.cos_gamma + slice.gamma * slice.sin_gamma);
    for (int sign = -1; sign <= 1; sign += 2) {
      const float jitter = fract(noise.y + kGolden * float(2u * s + uint(sign > 0)));
      const Side side = side_of(view, r, slice, float(sign), reach);
      const vec3 arcs = slice.share * slice.weight *
                        search(r, side, reach, jitter, list[place.tile].ranges[sector_of(side.direction_px)]);
      blocked += arcs.x;
      if (kBent) bent_blocked += arcs.y * float(sign) * slice.t + arcs.z * r.eye;
    }
  }
  ao[ao_index] = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
  if (kBent) write_bent(index, plane, open_bent(r.normal) - (whole > 0.0 ? bent_blocked / whole : vec3(0)));
}
