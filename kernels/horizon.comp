// Ambient occlusion by horizon search in slices through the view ray (GTAO), cosine weighted, with occluders of finite thickness.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals. Out: visibility, 1 = open; the mean open direction (see bent.glsl) where it is asked for.
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, with these differences:
// - Slices are even in azimuth about the view ray, not on the screen, so that no Jacobian is owed off axis.
// - The reach is the exact image of the sphere of the radius in the slice, clipped to the image: what is outside is unknown.
// - The samples of a side form runs of one surface. The run that goes on from the receiver is its own surface: it blocks all below its horizon. Every other run
//   blocks from its front to its back, which lies as much further along the eye's ray as the run is wide ("width as thickness": a blade of grass is as thin
//   as it is narrow, a column as thick as it is broad), or as the user says. Nothing beyond the radius blocks. What is blocked is a union of intervals:
//   exact for the own surface and three more. What overlaps none of these joins the third or, with many steps, is counted in 32 sectors.
// - Falloff weighs each arc by the distance of the sample that first blocks it ("incremental arcs"), exact for height fields.
// - Result 1 - (sum of blocked arcs) / (sum of whole arcs): exactly 1 where nothing rises above the tangent plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "horizon.h"
#include "view.glsl"
#include "normal.glsl"
#include "arcs.glsl"
#include "noise.glsl"
#include "falloff.glsl"
#include "bent.glsl"
#include "slice.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kHorizonSlicesId) const uint kSlices = 3;
layout(constant_id = kHorizonStepsId) const uint kSteps = 6;
layout(constant_id = kHorizonModeId) const uint kMode = kFalloffNone;
layout(scalar, push_constant) uniform Push { HorizonParams params; };
layout(scalar, binding = kHorizonDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kHorizonNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kHorizonAo) writeonly buffer Ao { float ao[]; };
layout(scalar, binding = kHorizonBent) writeonly buffer Bent { float bent[]; };

const uint kFalloff = kMode & ~kWithBent;
const bool kBent = (kMode & kWithBent) != 0u;

/// A run is wider than the distance of its outer samples by a pixel and, on average, by this part of the gaps to the samples before and behind it.
const float kGapShare = 0.5;

/// Two samples on either side of the sphere of the radius whose squared distances are within this factor of its square are taken for one surface.
const float kSameSurface = 1.44;

const bool kDense = kSteps > uint(kManySteps);
const float kNone = 1e30;
const vec2 kEmpty = vec2(kNone, -kNone);

/// A run of samples that is not the receiver's own surface. Places are (across V, towards the eye) from the receiver.
struct Run {
  vec2 start, end;       // its outer samples
  float gap;             // steps from the sample before it
  float near, far;       // largest and smallest cotangent of the samples that block
  vec2 first;            // the first of these
};

/// What is blocked: intervals of cotangents (low, high), empty where low > high. The own surface's goes down to the tangent plane.
struct Blocked {
  float own;
  vec2 a, b, c;
  uint sectors;
  float shift;  // of the sectors' boundaries
};

// Logic without branches: `&&` and `||` would jump.
bool both(bool a, bool b) { return a ? b : false; }

/// Adds x to a if they overlap.
bool joins(inout vec2 a, vec2 x) {
  const bool overlap = both(x.x <= a.y, x.y >= a.x);
  a = overlap ? vec2(min(a.x, x.x), max(a.y, x.y)) : a;
  return overlap;
}

/// arc_to() and, with bent normals, bent_to().
vec3 arcs_to(Side side, float cot) {
  if (!kBent) return vec3(arc_to(side, cot), 0, 0);
  const float sine = inversesqrt(1.0 + cot * cot);
  return vec3(arc_to(side, cot), bent_to(cot * sine, sine, side.cos_gamma, side.sin_gamma));
}

vec3 arcs_within(Side side, vec2 interval) { return interval.x < interval.y ? arcs_to(side, interval.x) - arcs_to(side, interval.y) : vec3(0); }

/// These integrals over all that is blocked.
vec3 blocked_arcs(Side side, Blocked blocked) {
  vec2 own = vec2(side.plane_cot, blocked.own), a = max(blocked.a, side.plane_cot), b = max(blocked.b, side.plane_cot), c = max(blocked.c, side.plane_cot);
  a = joins(own, a) ? kEmpty : a;
  b = joins(own, b) ? kEmpty : b;
  b = joins(a, b) ? kEmpty : b;
  c = joins(own, c) ? kEmpty : c;
  c = joins(a, c) ? kEmpty : c;
  c = joins(b, c) ? kEmpty : c;
  const vec3 sum = arcs_within(side, own) + arcs_within(side, a) + arcs_within(side, b) + arcs_within(side, c);
  if (!kDense) return sum;
  const float whole = whole_arc(side);
  uint others = blocked.sectors & sectors_to(side, whole, own.y, blocked.shift);
  others &= a.x < a.y ? sectors_to(side, whole, a.y, blocked.shift) | ~sectors_to(side, whole, a.x, blocked.shift) : ~0u;
  others &= b.x < b.y ? sectors_to(side, whole, b.y, blocked.shift) | ~sectors_to(side, whole, b.x, blocked.shift) : ~0u;
  others &= c.x < c.y ? sectors_to(side, whole, c.y, blocked.shift) | ~sectors_to(side, whole, c.x, blocked.shift) : ~0u;
  return sum + vec3(whole * float(bitCount(others)) / float(kSectors), kBent ? bent_of_sectors(side, others, blocked.shift) : vec2(0));
}

void block(Side side, inout Blocked blocked, vec2 span) {
  const bool real = span.x <= span.y, in_a = joins(blocked.a, span), in_b = joins(blocked.b, span), in_c = joins(blocked.c, span);
  const bool left = both(real, both(both(!in_a, !in_b), !in_c));
  const bool to_a = both(left, blocked.a.y < blocked.a.x), to_b = both(both(left, !to_a), blocked.b.y < blocked.b.x);
  const bool rest = both(left, both(!to_a, !to_b)), to_c = both(rest, kDense ? blocked.c.y < blocked.c.x : true);
  blocked.a = to_a ? span : blocked.a;
  blocked.b = to_b ? span : blocked.b;
  blocked.c = to_c ? vec2(min(blocked.c.x, span.x), max(blocked.c.y, span.y)) : blocked.c;
  if (kDense) {
    const float whole = whole_arc(side);
    const uint sectors = sectors_to(side, whole, span.x, blocked.shift) & ~sectors_to(side, whole, span.y, blocked.shift);
    blocked.sectors |= both(rest, !to_c) ? sectors : 0u;
  }
}

/// Ends a run: what it blocks is known now. Returns the weighted arcs that are newly blocked, 0 without falloff, where the union is integrated at the end.
vec3 end_run(Receiver r, Side side, Reach reach, Run run, float z, float gap_behind, inout Blocked blocked) {
  const float pixel = reach.pixel_size * (r.perspective ? z : 1.0);
  const float width = length(run.end - run.start) + pixel * (1.0 + kGapShare * (run.gap + gap_behind));
  const float back = back_cot(r, run.first, reach.thickness > 0.0 ? reach.thickness : width, reach.radius);
  const vec2 span = run.near >= run.far ? vec2(min(back, run.far), run.near) : kEmpty;
  if (kFalloff == kFalloffNone) {
    block(side, blocked, span);
    return vec3(0);
  }
  const vec3 before = blocked_arcs(side, blocked);
  block(side, blocked, span);
  return run.near >= run.far ? falloff_weight(kFalloff, length(run.first), reach.falloff_start, reach.radius) * (blocked_arcs(side, blocked) - before) : vec3(0);
}

/// The blocked part of a side's integrals.
vec3 search(Receiver r, Side side, Reach reach, float jitter) {
  const int count = min(int(kSteps), int(side.reach));
  float last_z = r.z, last_offset = 0.0, last_cot = 0.0, last_distance_sq = kNone;
  vec3 sum = vec3(0);
  const bool endless = isinf(reach.thickness);  // then all is one run: what is behind a surface is solid
  bool own = !endless, was_within = true, last_blocks = false;
  Blocked blocked = Blocked(side.plane_cot, kEmpty, kEmpty, kEmpty, 0u, fract(11.0 * jitter));
  Run run = Run(vec2(0), vec2(0), 0.0, -kNone, kNone, vec2(1, 0));
  for (int k = 0; k < count; k++) {
    const float offset = step_offset(k, int(kSteps), count, side.reach, jitter);
    const vec2 beside = round(side.direction_px * offset);
    const ivec2 hit = r.pixel + ivec2(beside);
    const float z = depth[hit.y * reach.width + hit.x], scale = r.perspective ? z : 1.0;
    const vec2 place = place_of(r, side, beside, z, scale);
    const vec3 delta = offset_to(r, beside, z, scale);
    const float cot = place.y / place.x, distance_sq = dot(delta, delta);
    const bool above = is_above(r, reach, place, distance_sq, beside, z, scale), within = distance_sq < reach.radius_sq;
    const bool blocks = both(above, within);
    const float gap = offset - last_offset;
    const bool connected = endless ? true : same_surface(r, reach, z, last_z, gap);
    // A surface that crosses the sphere between two samples blocks up to there.
    const bool crosses = both(above, both(within != was_within,
        both(max(distance_sq, last_distance_sq) < kSameSurface * reach.radius_sq, min(distance_sq, last_distance_sq) * kSameSurface > reach.radius_sq)));
    const float crossing = mix(cot, last_cot, (reach.radius_sq - distance_sq) / (last_distance_sq - distance_sq));
    if (kFalloff == kFalloffNone ? !connected : true) {
      sum += end_run(r, side, reach, run, last_z, gap, blocked);
      if (connected) {  // falloff: each sample is weighted by itself, and goes on where the last one ended
        run.near = last_blocks ? last_cot : -kNone;
        run.far = last_blocks ? last_cot : kNone;
        run.first = run.end;
      } else {
        own = false;
        run = Run(place, place, gap, -kNone, kNone, vec2(1, 0));
      }
    }
    if (own) {
      const float horizon = max(blocks ? cot : -kNone, kFalloff == kFalloffNone && crosses ? crossing : -kNone);
      if (kFalloff != kFalloffNone && horizon > blocked.own)
        sum += falloff_weight(kFalloff, sqrt(distance_sq), reach.falloff_start, reach.radius) * (arcs_to(side, blocked.own) - arcs_to(side, horizon));
      blocked.own = max(blocked.own, horizon);
    } else {
      const bool begins = both(run.near < run.far, blocks);
      run.first = begins ? place : run.first;
      run.near = max(run.near, max(blocks ? cot : -kNone, crosses ? crossing : -kNone));
      run.far = min(run.far, min(blocks ? cot : kNone, crosses ? crossing : kNone));
    }
    run.end = place;
    last_blocks = both(blocks, !own);
    was_within = within;
    last_distance_sq = above ? distance_sq : kNone;
    last_cot = cot;
    last_z = z;
    last_offset = offset;
  }
  sum += end_run(r, side, reach, run, last_z, 1.0, blocked);
  return kFalloff == kFalloffNone ? blocked_arcs(side, blocked) : sum;
}

void write_bent(int index, int plane, vec3 b) {
  for (int c = 0; c < 3; c++) bent[index + c * plane] = stored_bent(b)[c];
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const View view = params.view;
  if (!inside(view, pixel)) return;
  const int index = index_of(view, pixel), plane = view.size.x * view.size.y, ao_index = index + int(params.plane) * plane;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[ao_index] = 1.0;
    if (kBent) write_bent(index, plane, vec3(0));
    return;
  }
  const Receiver r = receiver_at(view, pixel, z, unpack_normal(normal[index]), params.radius);
  const Reach reach = reach_of(view, params.radius, params.falloff_start, params.thickness, params.bias);
  const vec2 noise = pixel_noise(pixel + params.noise_origin, params.noise_shift);
  float blocked = 0.0, whole = 0.0;
  vec3 bent_blocked = vec3(0);
  for (uint s = 0u; s < kSlices; s++) {
    const Slice slice = slice_at(view, r, s, kSlices, noise.x);
    if (slice.weight < kLeastWeight) continue;
    whole += slice.share * slice.weight * (slice.cos_gamma + slice.gamma * slice.sin_gamma);
    for (int sign = -1; sign <= 1; sign += 2) {
      const float jitter = fract(noise.y + kGolden * float(2u * s + uint(sign > 0)));
      const vec3 side = slice.share * slice.weight * search(r, side_of(view, r, slice, float(sign), reach.radius), reach, jitter);
      blocked += side.x;
      if (kBent) bent_blocked += side.y * float(sign) * slice.t + side.z * r.eye;
    }
  }
  ao[ao_index] = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
  // The open hemisphere gives 2/3 of the normal whatever slices are drawn.
  if (kBent) write_bent(index, plane, whole > 0.0 ? 2.0 / 3.0 * r.normal - bent_blocked / whole : r.normal);
}
