// Ambient occlusion by horizon search in slices through the view ray (GTAO), cosine weighted, with occluders of finite
// thickness.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals.
// Out: visibility, 1 = open; the mean open direction (see bent.glsl) where it is asked for.
//
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, with these differences:
// - Slices are even in azimuth about the view ray, not on the screen, so that no Jacobian is owed off axis.
// - The reach is the exact image of the sphere of the radius in the slice, clipped to the image: what is outside is
//   unknown.
// - The samples of a side form runs of one surface. What goes on from the receiver, or from any place below its tangent
//   plane, is its own surface: it blocks all below its horizon. A sample that is not above that plane says nothing
//   else, so it may be left out where `classify` knows of it.
// - Every other run blocks from its front to its back, which lies as much further along the eye's ray as the run is
//   wide ("width as thickness": a blade of grass is as thin as it is narrow, a column as thick as it is broad), or as
//   the user says. Nothing beyond the radius blocks. What the own surface blocks is an interval, exact; what all other
//   runs block is counted in 24 sectors (sectors.glsl).
// - Falloff weighs each arc by the distance of the sample that first blocks it ("incremental arcs"), which is exact for
//   height fields.
// - The result is 1 - (sum of blocked arcs) / (sum of whole arcs): exactly 1 where nothing rises above the tangent
//   plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef X_NOJUMPS
#define Y_JUMPS false
#else
#define Y_JUMPS jumps
#endif
#ifdef X_NOPENDS
#define Y_PENDS false
#else
#define Y_PENDS pends
#endif
#ifdef X_NOBORDER
#define Y_CUT false
#else
#define Y_CUT side.is_cut && last.above && last.offset > 0.0
#endif
#define VAR_SHARE 1.0
#define VAR_PIXELS 0.0
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
#ifndef VAR_COMPLETE
#define VAR_COMPLETE true
#endif
#ifdef X_NOJUMPS
#else
#endif
#ifdef X_NOPENDS
#else
#endif
#ifdef X_NOBORDER
#else
#endif
const bool kComplete = VAR_COMPLETE;
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
  const float width = kComplete ? VAR_SHARE * length(run.end - run.start) + pixel * (VAR_PIXELS + VAR_SHARE * (1.0 + kGapShare * (run.gap + gap_behind))) : length(run.end - run.start) + pixel * (1.0 + kGapShare * (run.gap + gap_behind));
  // What is as deep as wide is not clipped to the sphere: no difference in the error, and it takes a tenth off the
  // time.
  const float back = slope_of(kThickness == kThicknessWidth ? run.start + width * away_from_eye(r, run.start)
                                                            : back_of(r, run.start, reach.thickness, reach.radius));
  return run.near >= run.far ? sectors_below(run.near, shift) & ~sectors_below(min(back, run.far), shift) : 0u;
}

/// One sample of a side.
struct Sample {
  float offset;        // steps from the receiver
  float z, scale;      // planar depth; that, or 1 orthographic
  vec2 place;          // in the slice
  float slope;         // slope_of() it
  float distance_sq;   // from the receiver
  bool above, within;  // clear of the tangent plane; within the radius
};

Sample sample_at(Receiver r, Side side, Reach reach, float offset) {
  const vec2 beside = round(side.direction_px * offset);
  const ivec2 hit = r.pixel + ivec2(beside);
  Sample s;
  s.offset = offset;
  s.z = depth[hit.y * reach.width + hit.x];
  s.scale = r.perspective ? s.z : 1.0;
  s.place = place_of(r, side, beside, s.z, s.scale);
  s.slope = slope_of(s.place);
  s.distance_sq = dot(s.place, s.place);
  s.above = is_above(r, reach, s.place, s.distance_sq, offset, beside, s.z, s.scale);
  s.within = s.distance_sq < reach.radius_sq;
  return s;
}

/// The slopes that a sample blocks, largest and smallest: its own where it `blocks`, and where the surface from the
/// sample before it crosses the sphere in between, that `crossing`.
vec2 slopes_of(Sample s, bool crosses, float crossing) {
  const bool blocks = both(s.above, s.within);
  return vec2(max(blocks ? s.slope : -1.0, crosses ? crossing : -1.0),
              min(blocks ? s.slope : 1.0, crosses ? crossing : 1.0));
}

/// The sample before the first one.
Sample receiver_sample(Receiver r) { return Sample(0.0, r.z, 1.0, vec2(0), 0.0, kNone, true, true); }

const bool kHard = kFalloff == kFalloffNone;

/// What falloff makes of the arcs that are blocked up to a sample: those that are new at it weigh as its distance says.
vec3 faded(vec3 sum, vec3 arcs, vec3 last_arcs, Sample s, Reach reach) {
  return sum + falloff_weight(kFalloff, sqrt(s.distance_sq), reach.falloff_start, reach.radius) * (arcs - last_arcs);
}

/// The blocked part of a side's integrals where occluders are solid as far as the sphere of the radius: one interval.
vec3 search_endless(Receiver r, Side side, Reach reach, Draw draw, uint range) {
  const int count = range != 0u ? min(int(kSteps), int(side.reach)) : 0;
  const float last_step = float(last_of_range(range)) + 0.5;
  vec3 last_arcs = vec3(0), sum = vec3(0);
  Sample last = receiver_sample(r);
  Blocked blocked = Blocked(-1.0, 1.0, 0u);
  for (int k = first_sample(range, int(kSteps), count, side.reach, draw.jitter, step_exponent(int(kSteps), side.reach));
       k < count && last.offset <= last_step; k++) {
    const Sample s = sample_at(r, side, reach, step_offset(k, int(kSteps), count, side.reach, draw.jitter));
    const bool connected = both(max(s.distance_sq, last.distance_sq) < kSameSurface * reach.radius_sq,
                                min(s.distance_sq, last.distance_sq) * kSameSurface > reach.radius_sq);
    const bool crosses = kHard ? both(both(s.above, last.above), both(connected, s.within != last.within)) : false;
    const vec2 slopes = slopes_of(
        s, crosses, mix(s.slope, last.slope, (reach.radius_sq - s.distance_sq) / (last.distance_sq - s.distance_sq)));
    const float back = slope_of(back_of(r, s.place, reach.thickness, reach.radius));
    blocked.near = max(blocked.near, slopes.x);
    blocked.far = min(blocked.far, both(s.above, s.within) ? min(slopes.y, back) : slopes.y);
    if (!kHard) {
      const vec3 arcs = blocked_arcs(side, blocked, draw.shift);
      sum = faded(sum, arcs, last_arcs, s, reach);
      last_arcs = arcs;
    }
    last = s;
    last.distance_sq = s.above ? s.distance_sq : kNone;
  }
  return kHard ? blocked_arcs(side, blocked, draw.shift) : sum;
}

/// The same where occluders are as thick as they are wide, or as the user says: the receiver's own surface, and runs.
vec3 search_runs(Receiver r, Side side, Reach reach, Draw draw, uint range) {
  const int count = range != 0u ? min(int(kSteps), int(side.reach)) : 0;
  const float last_step = float(last_of_range(range)) + 0.5;
  vec3 last_arcs = vec3(0), sum = vec3(0);
  bool own = true;
  Sample last = receiver_sample(r);
  Blocked blocked = Blocked(-1.0, -1.0, 0u);
  Run run = Run(vec2(0), vec2(0), 0.0, -1.0, 1.0);
  for (int k = first_sample(range, int(kSteps), count, side.reach, draw.jitter, step_exponent(int(kSteps), side.reach));
       k < count && last.offset <= last_step; k++) {
    const Sample s = sample_at(r, side, reach, step_offset(k, int(kSteps), count, side.reach, draw.jitter));
    const float gap = s.offset - last.offset;
    const bool connected = same_surface(r, reach, s.z, last.z, gap);
    // A run that crosses the sphere between two samples blocks half way to the one beyond.
    const bool crosses = kHard ? both(both(s.above, last.above), both(connected, s.within != last.within)) : false;
    const vec2 slopes = slopes_of(s, crosses, mix(s.slope, last.slope, 0.5));
    if (connected) run.end = s.place;
    if (!connected || !s.above) {
      if (kHard) blocked.sectors |= sectors_of(r, reach, run, last.z, gap, draw.shift);
      run = Run(s.place, s.place, gap, -1.0, 1.0);
      own = !s.above;
    }
    if (own) {
      blocked.near = max(blocked.near, slopes.x);
    } else {
      run.near = max(run.near, slopes.x);
      run.far = min(run.far, slopes.y);
    }
    if (!kHard) {
      blocked.sectors |= sectors_of(r, reach, run, s.z, 1.0, draw.shift);
      const vec3 arcs = blocked_arcs(side, blocked, draw.shift);
      sum = faded(sum, arcs, last_arcs, s, reach);
      last_arcs = arcs;
    }
    last = s;
  }
  if (kHard) blocked.sectors |= sectors_of(r, reach, run, last.z, 1.0, draw.shift);
  return kHard ? blocked_arcs(side, blocked, draw.shift) : sum;
}

// ---- completion
vec2 normal_in_slice(Receiver r, Side side, Reach reach, float offset) {
  const ivec2 hit = r.pixel + ivec2(round(side.direction_px * offset));
  const vec3 n = octahedral_direction(unpackSnorm2x16(normal[hit.y * reach.width + hit.x]));
  const vec2 p = vec2(dot(n, side.t), dot(n, r.eye));
  return p * inversesqrt(max(dot(p, p), 1e-12));
}

/// Slopes (largest, smallest) of the straight piece from `end` along `direction` to the ray of `until`, in the sphere.
vec2 slopes_of_piece(Receiver r, Reach reach, vec2 end, vec2 direction, vec2 n, vec2 until) {
  const vec2 ray = r.perspective ? vec2(0, r.eye_distance) - until : vec2(0, 1);  // towards the eye
  const float down = dot(n, ray);
  const float u = dot(n, until - end) / down;
  const vec2 far = until - u * ray;
  const float b = dot(end, direction), inside = b * b - dot(end, end) + reach.radius_sq;
  const float root = sqrt(max(inside, 0.0));
  float last = down > 0.0 ? max(dot(far - end, direction), 0.0) : 1e30;
  last = direction.x < 0.0 ? min(last, 0.999 * end.x / -direction.x) : last;
  const float t0 = max(0.0, -b - root), t1 = min(last, root - b);
  const float s0 = slope_of(end + t0 * direction), s1 = slope_of(end + t1 * direction);
  return inside > 0.0 && t1 > t0 ? vec2(max(s0, s1), min(s0, s1)) : vec2(-1.0, 1.0);
}

bool faces_eye(Receiver r, vec2 n, vec2 at) { return r.perspective ? dot(n, vec2(0, r.eye_distance) - at) > 0.0 : n.y > 0.0; }

uint sectors_between(vec2 slopes, float shift) {
  return slopes.x >= slopes.y ? sectors_below(slopes.x, shift) & ~sectors_below(slopes.y, shift) : 0u;
}

/// Where a sample is in the slice.
vec2 place_at_offset(Receiver r, Side side, Reach reach, float offset) {
  const vec2 beside = round(side.direction_px * offset);
  const ivec2 hit = r.pixel + ivec2(beside);
  const float z = depth[hit.y * reach.width + hit.x];
  return place_of(r, side, beside, z, r.perspective ? z : 1.0);
}

vec3 search_completed(Receiver r, Side side, Reach reach, Draw draw, uint range) {
  const int count = range != 0u ? min(int(kSteps), int(side.reach)) : 0;
  const float last_step = float(last_of_range(range)) + 0.5;
  vec3 last_arcs = vec3(0), sum = vec3(0);
  bool own = true;
  uint jumps = 0u, starts = 0u;
  Sample last = receiver_sample(r);
  Blocked blocked = Blocked(-1.0, -1.0, 0u);
  Run run = Run(vec2(0), vec2(0), 0.0, -1.0, 1.0);
  int k = first_sample(range, int(kSteps), count, side.reach, draw.jitter, step_exponent(int(kSteps), side.reach));
  for (; k < count && last.offset <= last_step; k++) {
    const Sample s = sample_at(r, side, reach, step_offset(k, int(kSteps), count, side.reach, draw.jitter));
    const float gap = s.offset - last.offset;
    const bool connected = same_surface(r, reach, s.z, last.z, gap);
    // A run that crosses the sphere between two samples blocks half way to the one beyond.
    const bool crosses = kHard ? both(both(s.above, last.above), both(connected, s.within != last.within)) : false;
    const vec2 slopes = slopes_of(s, crosses, mix(s.slope, last.slope, 0.5));
    if (connected) run.end = s.place;
    const uint bit = 1u << uint(k);
    jumps |= both(both(!connected, last.offset > 0.0), both(both(s.above, last.above), max(s.z, last.z) < kSkyDepth)) ? bit : 0u;
    if (!connected || !s.above) {
      blocked.sectors |= sectors_of(r, reach, run, last.z, gap, draw.shift);
      run = Run(s.place, s.place, gap, -1.0, 1.0);
      own = !s.above;
      starts |= bit;
    }
    if (own) {
      blocked.near = max(blocked.near, slopes.x);
    } else {
      run.near = max(run.near, slopes.x);
      run.far = min(run.far, slopes.y);
    }
    last = s;
  }
  for (uint left = jumps; left != 0u; left &= left - 1u) {
    const int at = findLSB(left);
    const uint after = at >= 31 ? 0u : starts >> uint(at + 1) << uint(at + 1);
    const uint before = starts & ((1u << uint(at)) - 1u);
    const float ob = step_offset(at, int(kSteps), count, side.reach, draw.jitter);
    const float oa = step_offset(at - 1, int(kSteps), count, side.reach, draw.jitter);
    const vec2 pb = place_at_offset(r, side, reach, ob), pa = place_at_offset(r, side, reach, oa);
    // the deeper one is further from the eye
    const vec2 eb = r.perspective ? vec2(0, r.eye_distance) - pb : vec2(0, -pb.y), ea = r.perspective ? vec2(0, r.eye_distance) - pa : vec2(0, -pa.y);
    const bool back = dot(eb, eb) > dot(ea, ea);
    const int other = back ? (before != 0u ? findMSB(before) : 0) : (after != 0u ? findLSB(after) : k) - 1;
    const vec2 po = place_at_offset(r, side, reach, step_offset(other, int(kSteps), count, side.reach, draw.jitter));
    const vec2 n = normal_in_slice(r, side, reach, back ? ob : oa);
    const vec2 end = back ? pb : pa, hider = back ? pa : pb;
    const vec2 until = dot(n, po - end) > 0.0 ? po : hider;
    const vec2 piece = slopes_of_piece(r, reach, end, back ? vec2(-n.y, n.x) : vec2(n.y, -n.x), n, until);
    blocked.sectors |= both(faces_eye(r, n, end), dot(n, hider - end) > 0.0) ? sectors_between(piece, draw.shift) : 0u;
  }
  bool endless = false;
  for (bool once = Y_CUT; once; once = false) {
    const vec2 n = normal_in_slice(r, side, reach, last.offset);
    endless = true;
    const vec2 piece = slopes_of_piece(r, reach, last.place, vec2(n.y, -n.x), vec2(0, 0), last.place);
    blocked.sectors |= faces_eye(r, n, last.place) ? sectors_between(vec2(piece.x, own ? piece.y : -1.0), draw.shift) : 0u;
  }
  if (endless && run.near >= run.far) blocked.sectors |= sectors_below(run.near, draw.shift);
  blocked.sectors |= sectors_of(r, reach, run, last.z, 1.0, draw.shift);
  return blocked_arcs(side, blocked, draw.shift);
}

/// The blocked part of a side's integrals. range: the steps at which something may stand above the tangent plane.
vec3 search(Receiver r, Side side, Reach reach, Draw draw, uint range) {
  return kThickness == kThicknessEndless ? search_endless(r, side, reach, draw, range)
                                         : kComplete ? search_completed(r, side, reach, draw, range) : search_runs(r, side, reach, draw, range);
}

/// Random numbers of a side, from those of its pixel. The boundaries of the sectors move by the fraction of a multiple
/// of the steps' jitter. Of a number that is even in [0, 1), the fraction of m times it is even too, and their
/// correlation is 1 / m: here 9 %.
Draw draw_of(vec2 noise, uint slice, uint side) {
  const float jitter = fract(noise.y + kGolden * float(2u * slice + side));
  return Draw(jitter, fract(11.0 * jitter));
}

#include "slices.glsl"

void main() {
  const ListedPlace place = listed_place(gl_WorkGroupID.xy, gl_LocalInvocationIndex, kStride);
  if (place.tile >= counts.listed) return;
  const ivec2 pixel = pixel_of_tile(unpack_tile(list[place.tile].place), place.pixel, params.noise_origin, kStride);
  if (inside(params.view, pixel)) estimate(pixel, place.tile);
}
