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
//   else, so it may be left out where `classify` knows of it.
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
layout(scalar, push_constant) uniform Push { HorizonParams params; };
layout(scalar, binding = kHorizonDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kHorizonNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kHorizonAo) writeonly buffer Ao { float ao[]; };
layout(scalar, binding = kHorizonList) readonly buffer List { ListedTile list[]; };
layout(scalar, binding = kHorizonSites) readonly buffer Sites { uint sites[]; };
layout(scalar, binding = kHorizonSiteCounts) readonly buffer SiteCountsBuffer { SiteCounts site_counts; };
layout(scalar, binding = kHorizonCounts) readonly buffer Counts { TileCounts counts; };
layout(scalar, binding = kHorizonBent) writeonly buffer Bent { float bent[]; };
layout(scalar, binding = kHorizonCompleted) writeonly buffer Completed { float completed[]; };

const uint kFalloff = kMode & ~(kWithBent | kWithCompleted);
const bool kBent = (kMode & kWithBent) != 0u;
const bool kTellsCompleted = (kMode & kWithCompleted) != 0u;
const uint kThickness = kSolid & ~(kCompletesBorder | kCompletesHidden);
const bool kBeyondBorder = (kSolid & kCompletesBorder) != 0u;
const bool kBehindOthers = (kSolid & kCompletesHidden) != 0u;

/// A run is wider than the distance of its outer samples by a pixel and, on average, by this part of the gaps to the
/// samples before and behind it.
const float kGapShare = 0.5;

/// All that is endless is one surface. Two samples of it on either side of the sphere are neighbours if their squared
/// distances are within this factor of its.
const float kSameSurface = 1.44;

#include "pieces.glsl"

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
  const float width = length(run.end - run.start) + pixel * (1.0 + kGapShare * (run.gap + gap_behind));
  // What is as deep as wide is not clipped to the sphere: no difference in the error, and it takes a tenth off the
  // time.
  const float back = slope_of(kThickness == kThicknessWidth ? run.start + width * away_from_eye(r, run.start)
                                                            : back_of(r, run.start, reach.thickness, reach.radius));
  return run.near >= run.far ? sectors_below(run.near, shift) & ~sectors_below(min(back, run.far), shift) : 0u;
}

/// The slopes that a sample blocks, largest and smallest: its own where it `blocks`, and where the surface from the
/// sample before it crosses the sphere in between, that `crossing`.
vec2 slopes_of(Sample s, bool crosses, float crossing) {
  const bool blocks = both(s.above, s.within);
  return vec2(max(blocks ? s.slope : -1.0, crosses ? crossing : -1.0),
              min(blocks ? s.slope : 1.0, crosses ? crossing : 1.0));
}

const bool kHard = kFalloff == kFalloffNone;

/// What a search has found to be blocked.
struct Found {
  Blocked blocked;
  Blocked completed;    // without falloff: by completed surfaces
  vec3 sum, last_arcs;  // with falloff: the weighed integrals, and those of all that is blocked so far
  float completed_sum;  // with falloff: what completed surfaces added to the sum
};

/// Adds what lies between two slopes, the larger one first, to what is blocked.
void block(inout Blocked blocked, vec2 slopes, float shift) {
  const bool exists = slopes.x >= slopes.y;
  if (kThickness == kThicknessEndless) {
    blocked.near = exists ? max(blocked.near, slopes.x) : blocked.near;
    blocked.far = exists ? min(blocked.far, slopes.y) : blocked.far;
  } else {
    blocked.sectors |= sectors_between(slopes, shift);
  }
}

/// With falloff: adds what is new of what is blocked, by the distance of a place, and returns that part of the arc.
float add_faded(inout Found found, Side side, Reach reach, Draw draw, vec2 place) {
  const vec3 arcs = blocked_arcs(side, found.blocked, draw.shift);
  const float weight = falloff_weight(kFalloff, length(place), reach.falloff_start, reach.radius);
  const vec3 added = weight * (arcs - found.last_arcs);
  found.sum += added;
  found.last_arcs = arcs;
  return added.x;
}

/// Adds what a completed surface blocks.
void add_completed(inout Found found, Side side, Reach reach, Draw draw, Piece piece) {
  if (kHard) {
    block(found.completed, slopes_of(piece), draw.shift);
    return;
  }
  block(found.blocked, slopes_of(piece), draw.shift);
  found.completed_sum += add_faded(found, side, reach, draw, 0.5 * (piece.near + piece.far));
}

/// Adds what goes on behind something nearer. behind_last: the sample after the last one.
void complete_behind(inout Found found, Receiver r, Side side, Reach reach, Draw draw, int count,
                     Interruptions interrupted, int behind_last) {
  for (uint left = interrupted.jumps; left != 0u; left &= left - 1u) {
    const Piece piece =
        piece_behind(r, side, reach, draw, count, interrupted, interrupted.first + findLSB(left), behind_last);
    add_completed(found, side, reach, draw, piece);
  }
}

/// Adds what the image's border cuts, and what goes on of it beyond the border.
void complete_beyond(inout Found found, Receiver r, Side side, Reach reach, Draw draw) {
  const Sample border = sample_at(r, side, reach, floor(side.reach));
  const Piece piece = piece_beyond(r, side, reach, border);
  block(found.blocked, slopes_at_border(r, reach, border), draw.shift);
  if (!kHard) add_faded(found, side, reach, draw, border.place);
  add_completed(found, side, reach, draw, piece);
}

/// Searches a side where occluders are solid as far as the sphere of the radius: they block one interval.
void search_endless(inout Found found, Receiver r, Side side, Reach reach, Draw draw, uint range, int count) {
  const float last_step = float(last_of_range(range)) + 0.5;
  Sample last = receiver_sample(r);
  for (int k = first_sample(range, int(kSteps), count, side.reach, draw.jitter, step_exponent(int(kSteps), side.reach));
       k < count && last.offset <= last_step; k++) {
    const Sample s = sample_at(r, side, reach, step_offset(k, int(kSteps), count, side.reach, draw.jitter));
    const bool connected = both(max(s.distance_sq, last.distance_sq) < kSameSurface * reach.radius_sq,
                                min(s.distance_sq, last.distance_sq) * kSameSurface > reach.radius_sq);
    const bool crosses = kHard ? both(both(s.above, last.above), both(connected, s.within != last.within)) : false;
    const vec2 slopes = slopes_of(
        s, crosses, mix(s.slope, last.slope, (reach.radius_sq - s.distance_sq) / (last.distance_sq - s.distance_sq)));
    const float back = slope_of(back_of(r, s.place, reach.thickness, reach.radius));
    found.blocked.near = max(found.blocked.near, slopes.x);
    found.blocked.far = min(found.blocked.far, both(s.above, s.within) ? min(slopes.y, back) : slopes.y);
    if (!kHard) add_faded(found, side, reach, draw, s.place);
    last = s;
    last.distance_sq = s.above ? s.distance_sq : kNone;
  }
}

/// The same where occluders are as thick as they are wide, or as the user says: the receiver's own surface, and runs.
void search_runs(inout Found found, Receiver r, Side side, Reach reach, Draw draw, uint range, int count) {
  const float last_step = float(last_of_range(range)) + 0.5;
  bool own = true;
  Sample last = receiver_sample(r);
  Run run = Run(vec2(0), vec2(0), 0.0, -1.0, 1.0);
  int k = first_sample(range, int(kSteps), count, side.reach, draw.jitter, step_exponent(int(kSteps), side.reach));
  Interruptions interrupted = Interruptions(k & ~(kWordBits - 1), 0u, 0u);
  for (; k < count && last.offset <= last_step; k++) {
    const Sample s = sample_at(r, side, reach, step_offset(k, int(kSteps), count, side.reach, draw.jitter));
    const float gap = s.offset - last.offset;
    const bool connected = same_surface(r, reach, s.z, last.z, gap);
    // A run that crosses the sphere between two samples blocks half way to the one beyond.
    const bool crosses = kHard ? both(both(s.above, last.above), both(connected, s.within != last.within)) : false;
    const vec2 slopes = slopes_of(s, crosses, mix(s.slope, last.slope, 0.5));
    if (kBehindOthers) take_down(interrupted, k, s, last, connected, reach);
    if (connected) run.end = s.place;
    if (!connected || !s.above) {
      if (kHard) found.blocked.sectors |= sectors_of(r, reach, run, last.z, gap, draw.shift);
      run = Run(s.place, s.place, gap, -1.0, 1.0);
      own = !s.above;
    }
    if (own) {
      found.blocked.near = max(found.blocked.near, slopes.x);
    } else {
      run.near = max(run.near, slopes.x);
      run.far = min(run.far, slopes.y);
    }
    if (!kHard) {
      found.blocked.sectors |= sectors_of(r, reach, run, s.z, 1.0, draw.shift);
      add_faded(found, side, reach, draw, s.place);
    }
    last = s;
    for (bool once = kBehindOthers && int(kSteps) > kWordBits && (k + 1 & kWordBits - 1) == 0; once; once = false) {
      complete_behind(found, r, side, reach, draw, count, interrupted, k + 1);
      interrupted = Interruptions(k + 1, 0u, 0u);
    }
  }
  if (kHard) found.blocked.sectors |= sectors_of(r, reach, run, last.z, 1.0, draw.shift);
  if (kBehindOthers) complete_behind(found, r, side, reach, draw, count, interrupted, k);
}

/// The blocked part of a side's integrals, and what of its arc completed surfaces block. range: the steps at which
/// something may stand above the tangent plane.
vec4 search(Receiver r, Side side, Reach reach, Draw draw, uint range) {
  const int count = range != 0u ? min(int(kSteps), int(side.reach)) : 0;
  const Blocked nothing = Blocked(-1.0, kThickness == kThicknessEndless ? 1.0 : -1.0, 0u);
  Found found = Found(nothing, nothing, vec3(0), vec3(0), 0.0);
  if (kThickness == kThicknessEndless)
    search_endless(found, r, side, reach, draw, range, count);
  else
    search_runs(found, r, side, reach, draw, range, count);
  for (bool once = kBeyondBorder && side.is_cut && range != 0u && side.reach >= 1.0; once; once = false)
    complete_beyond(found, r, side, reach, draw);
  if (!kHard) return vec4(found.sum, found.completed_sum);
  const Blocked all =
      Blocked(max(found.blocked.near, found.completed.near), min(found.blocked.far, found.completed.far),
              found.blocked.sectors | found.completed.sectors);
  const vec3 arcs = blocked_arcs(side, all, draw.shift);
  return vec4(arcs, kTellsCompleted ? arcs.x - blocked_arcs(side, found.blocked, draw.shift).x : 0.0);
}

/// Random numbers of a side, from those of its pixel. The boundaries of the sectors move by the fraction of a multiple
/// of the steps' jitter. Of a number that is even in [0, 1), the fraction of m times it is even too, and their
/// correlation is 1 / m: here 9 %.
Draw draw_of(vec2 noise, uint slice, uint side) {
  const float jitter = fract(noise.y + kGolden * float(2u * slice + side));
  return Draw(jitter, fract(11.0 * jitter));
}

#include "slices.glsl"

#include "receivers.glsl"

void main() {
  const ListedPixel here = listed_pixel(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
  if (here.exists) estimate(here.pixel, here.tile);
}
