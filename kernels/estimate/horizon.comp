// Ambient occlusion by horizon search in slices through the view ray (GTAO), cosine weighted, with occluders of finite
// thickness.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals; how far back each pixel is solid.
// Out: visibility, 1 = open; where they are asked for, the moments of the blocked directions (see moments.glsl), what
// the receiver's own surface blocks inside and outside (pieces.glsl), and the visibility that completed surfaces took.
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
//  7. A run hidden by something nearer continues behind it until it would be visible again. A run cut by the image's
//     border continues beyond it in its plane. See pieces.glsl.
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

/// A run is so many times as thick as it is wide.
const float kThicknessPerWidth = 1.25;

/// All that is endless is one surface. Two samples of it on either side of the sphere are neighbours if their squared
/// distances are within this factor of its.
const float kSameSurface = 1.44;

#include "kernels/estimate/pieces.glsl"
#include "kernels/estimate/surfaces.glsl"

// 5. and 6. Runs, and what they block.

/// A run of samples that is not the receiver's own surface. Angles go by slope_of(); where far > near nothing of it
/// blocks.
struct Run {
  vec2 start, end;  // its outer samples
  float near, far;  // largest and smallest of the samples that block
  float gap;        // steps from the sample before it
  bool is_round;    // it begins behind a rounded outline, of which its back is the mirror image
  float deepest;    // of its samples before the sphere: how far back along the eye's ray they are told to be solid
};

/// The blocked directions: from `far` to `near`, by the receiver's own surface or all that is endless, and the sectors
/// of runs.
struct Blocked {
  float near, far;
  uint sectors;
};

/// arc_to() and, with moments, first_to() in the first column and second_to() in the second one, whose last row is 0.
mat2x3 arcs_to(Side side, vec2 place) {
  const vec2 d = place * inversesqrt(dot(place, place));
  const float cosine = side.cos_gamma, sine = side.sin_gamma;
  return mat2x3(arc_to(side, place), kOrder > 0u ? first_to(d.y, d.x, cosine, sine) : vec2(0),
                kOrder > 1u ? second_to(d.y, d.x, angle_of(d.y, d.x), cosine, sine) : vec2(0), 0);
}

/// These integrals over a set of sectors.
mat2x3 arcs_of(Side side, uint sectors) {
  return mat2x3(arc_of(side, sectors), kOrder > 0u ? first_of(side, sectors) : vec2(0),
                kOrder > 1u ? second_of(side, sectors) : vec2(0), 0);
}

/// 9. These integrals over what is blocked.
mat2x3 blocked_arcs(Side side, Blocked blocked, float shift) {
  const float plane = slope_of(side.ahead), far = max(blocked.far, plane);
  const bool is_exact = !kAllInSectors && blocked.near > far;
  mat2x3 own = mat2x3(0);
  if (is_exact) own = arcs_to(side, place_at(far)) - arcs_to(side, place_at(blocked.near));
  if (kThickness == kThicknessEndless && kSurfaces == 1 && !kAllInSectors) return own;
  uint others;
  if (kAllInSectors) {
    const uint joined = sectors_below(blocked.near, shift) & ~sectors_below(blocked.far, shift);
    others = (blocked.sectors | joined) & ~sectors_below(plane, shift);
  } else if (kThickness == kThicknessEndless) {
    const uint joined = sectors_below(max(blocked.near, plane), shift) & ~sectors_below(far, shift);
    others = blocked.sectors & ~(joined | sectors_below(plane, shift));
  } else {
    others = blocked.sectors & ~sectors_below(max(blocked.near, plane), shift);
  }
  return own + arcs_of(side, others);
}

/// How thick a run is, in scene units: with `auto` per_width times as wide. Its outer samples are a pixel nearer
/// together than its edges, and parts of the gaps beside it are its own. z: depth of its last sample. gap: steps from
/// that to the next sample; 0: there is none.
float thickness_of(Receiver r, Reach reach, Run run, float z, float per_width, float gap) {
  if (kThickness != kThicknessWidth) return reach.thickness;
  const float pixel = reach.pixel_size * (r.perspective ? z : 1.0), wider = 1.0 + kGapPart * (run.gap + gap);
  const float width = per_width * (length(run.end - run.start) + wider * pixel);
  return run.is_round ? 0.0 : levelled(width, kWidestRun * reach.radius);
}

/// How much deeper than its front the solid of a sample is that its pixel tells, in pixels' widths; below 0: nothing is
/// told, or it does not reach into the sphere.
float depth_told(Receiver r, Reach reach, Sample s, float pixels) {
  const float depth = pixels * reach.pixel_size * (r.perspective ? s.z : 1.0);
  return both(pixels >= 0.0, depth * r.ray_length > sqrt(s.distance_sq) - reach.radius) ? depth : -1.0;
}

/// slope_of() the end of a sample's solid that is so much deeper than its front; 1 where it does not block.
float slope_behind(Receiver r, Side side, Sample s, vec2 beside, float told) {
  const float z = s.z + told;
  const float slope = slope_of(place_of(r, side, beside, z, r.perspective ? z : 1.0));
  return both(s.above, s.within) ? slope : 1.0;
}

/// 6. The sectors that a run blocks whose front lies within the sphere. is_open: it has samples without a known back.
uint sectors_of(Receiver r, Reach reach, Run run, bool is_open, float thickness, float shift) {
  // What is as deep as wide is not clipped to the sphere: no difference in the error, and it takes a tenth off the
  // time.
  const float back = slope_of(kThickness == kThicknessWidth ? run.start + thickness * away_from_eye(r, run.start)
                                                            : back_of(r, run.start, thickness, reach.radius));
  const float far = is_open ? lesser(back, run.far) : run.far;
  return run.near >= run.far ? sectors_below(run.near, shift) & ~sectors_below(far, shift) : 0u;
}

/// A run that begins or ends before the sphere; the solid behind it may reach into the sphere.
struct Before {
  vec2 start, end;
  float thickness;
  float within;  // about how deep it reaches into the sphere, less the radius; -radius and less: it does not
};

/// Of such runs the one of a side counts that reaches deepest into the sphere.
float within_of(Run run, float thickness) {
  return thickness - sqrt(lesser(dot(run.start, run.start), dot(run.end, run.end)));
}
void take_before(inout Before before, Run run, bool is_before, float thickness, float within) {
  const bool taken = both(is_before, within > before.within);
  before.start = taken ? run.start : before.start;
  before.end = taken ? run.end : before.end;
  before.thickness = taken ? thickness : before.thickness;
  before.within = taken ? within : before.within;
}

/// The sectors that it blocks.
uint sectors_of(Receiver r, Reach reach, Before before, float shift) {
  uint sectors = 0u;
  if (before.within > -reach.radius) {
    const vec2 first = depths_of(r, before.start, before.thickness, reach.radius_sq);
    const vec2 last = depths_of(r, before.end, before.thickness, reach.radius_sq);
    sectors = sectors_between(vec2(max(first.x, last.x), min(first.y, last.y)), shift);
  }
  return sectors;
}

/// The slopes that a sample blocks, largest and smallest: its own where it `blocks`, and where the surface from the
/// sample before it crosses the sphere in between, that `crossing`.
vec2 slopes_of(Sample s, bool crosses, float crossing) {
  const bool blocks = both(s.above, s.within);
  return vec2(greater(blocks ? s.slope : -1.0, crosses ? crossing : -1.0),
              lesser(blocks ? s.slope : 1.0, crosses ? crossing : 1.0));
}

/// The blocked directions that a search has found.
struct Found {
  Blocked blocked;
  Blocked completed;      // without falloff: by completed surfaces
  mat2x3 sum, last_arcs;  // with falloff: the weighed integrals, and those of all that is blocked so far
  float completed_sum;    // with falloff: what completed surfaces added to the sum
  OwnSurface own;         // with kCurved
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

/// 8. With falloff: adds the new part of what is blocked, weighed by the distance of a place. Returns that part of the
/// arc.
float add_faded(inout Found found, Side side, Reach reach, Draw draw, vec2 place) {
  const mat2x3 arcs = blocked_arcs(side, found.blocked, draw.shift);
  const float weight = falloff_weight(kFalloff, length(place), reach.falloff_start, reach.radius);
  const mat2x3 added = weight * (arcs - found.last_arcs);
  found.sum += added;
  found.last_arcs = arcs;
  return added[0].x;
}

/// With falloff: adds the new part of what the own surface blocks, weighed by a distance.
void add_faded(inout OwnSurface own, Side side, Reach reach, float distance_to_it) {
  const vec2 arcs = arcs_of(own, side);
  own.sum += falloff_weight(kFalloff, distance_to_it, reach.falloff_start, reach.radius) * (arcs - own.last);
  own.last = arcs;
}

/// With kCurved: follows the receiver's own surface to the next sample.
void follow(inout Found found, Receiver r, Side side, Reach reach, Sample s, Sample last, vec2 beside, bool connected,
            float rises) {
  if (!kCurved) return;
  follow(found.own, r, reach, s, last, beside, connected, rises);
  if (!kHard) add_faded(found.own, side, reach, length(s.place));
}

/// What it blocks of a side, inside and outside.
vec2 ended(OwnSurface own, Receiver r, Side side, Reach reach) {
  if (!kCurved) return vec2(0);
  end(own, r, reach);
  if (kHard) return arcs_of(own, side);
  // What it goes on to lies as far away as its end, or farther.
  add_faded(own, side, reach, 0.5 * (length(own.place) + reach.radius));
  return own.sum;
}

/// 7. Adds what a completed surface blocks.
void add_completed(inout Found found, Side side, Reach reach, Draw draw, vec2 slopes, vec2 place) {
  if (kHard) {
    block(found.completed, slopes, draw.shift);
    return;
  }
  block(found.blocked, slopes, draw.shift);
  found.completed_sum += add_faded(found, side, reach, draw, place);
}

/// Adds what goes on behind something nearer. behind_last: the sample after the last one.
void complete_behind(inout Found found, Receiver r, Side side, Reach reach, Draw draw, int count,
                     Interruptions interrupted, int behind_last) {
  uint left = interrupted.jumps;
  if (left != 0u) {
    do {
      const Piece piece =
          piece_behind(r, side, reach, draw, count, interrupted, interrupted.first + findLSB(left), behind_last);
      add_completed(found, side, reach, draw, slopes_of(piece), 0.5 * (piece.near + piece.far));
      left &= left - 1u;
    } while (left != 0u);
  }
}

/// Samples of a side beyond the border.
const int kStepsBeyond = 6;

/// Adds what goes on beyond the border where occluders are endless.
void complete_endless_beyond(inout Found found, Receiver r, Side side, Reach reach, Draw draw, Sample border,
                             float gap) {
  Sample last = border;
  for (int k = 0; k < kStepsBeyond; k++) {
    const Sample s = sample_beyond(r, side, reach, border.offset + gap * (float(k) + draw.jitter));
    const bool joins = both(both(s.above, last.above), same_surface(r, reach, s.z, last.z, s.offset - last.offset));
    const vec2 slopes = slopes_of(s, both(joins, s.within != last.within), mix(s.slope, last.slope, 0.5));
    const float back = slope_of(back_of(r, s.place, kNone, reach.radius));
    add_completed(found, side, reach, draw, vec2(slopes.x, both(s.above, s.within) ? min(slopes.y, back) : slopes.y),
                  s.place);
    last = s;
  }
}

/// Adds the runs that go on beyond the border. Their samples are far apart, so that most of a run's width is gaps.
void complete_runs_beyond(inout Found found, Receiver r, Side side, Reach reach, Draw draw, Sample border, float gap) {
  Sample last = border;
  const vec2 at_border = slopes_of(border, false, 0.0);
  Run run = Run(border.place, border.place, at_border.x, at_border.y, 0.0, false, 0.0);
  Before before = Before(vec2(0), vec2(0), 0.0, -reach.radius);
  bool is_before = kHard && border.above && is_before_sphere(r, reach, border.place);
  int k = 0;
  do {
    const Sample s = sample_beyond(r, side, reach, border.offset + gap * (float(k) + draw.jitter));
    const bool joins = both(both(k < kStepsBeyond, both(s.above, last.above)),
                            same_surface(r, reach, s.z, last.z, s.offset - last.offset));
    if (kHard && !joins) {
      const float thickness = thickness_of(r, reach, run, last.z, kThicknessPerWidth, gap);
      found.completed.sectors |= sectors_of(r, reach, run, true, thickness, draw.shift);
      take_before(before, run, is_before, thickness, within_of(run, thickness));
    }
    is_before = joins ? is_before : false;
    run = Run(joins ? run.start : s.place, s.place, joins ? run.near : -1.0, joins ? run.far : 1.0, gap, false, 0.0);
    const vec2 slopes = slopes_of(s, kHard && both(joins, s.within != last.within), mix(s.slope, last.slope, 0.5));
    run.near = max(run.near, slopes.x);
    run.far = min(run.far, slopes.y);
    is_before = kHard && s.above && is_before_sphere(r, reach, s.place) ? true : is_before;
    if (!kHard) {
      const float thickness = thickness_of(r, reach, run, s.z, kThicknessPerWidth, gap);
      found.blocked.sectors |= sectors_of(r, reach, run, true, thickness, draw.shift);
      found.completed_sum += add_faded(found, side, reach, draw, s.place);
    }
    last = s;
  } while (++k < kStepsBeyond + (kHard ? 1 : 0));  // one more ends the last run
  found.completed.sectors |= sectors_of(r, reach, before, draw.shift);
}

/// Adds what goes on beyond the image's border.
void complete_beyond(inout Found found, Receiver r, Side side, Reach reach, Draw draw) {
  const Sample border = sample_at(r, side, reach, floor(side.reach));
  const float most = min(side.whole_reach, side.reach + float(reach.width));
  const float gap = (most - border.offset) / float(kStepsBeyond);
  if (kThickness == kThicknessEndless)
    complete_endless_beyond(found, r, side, reach, draw, border, gap);
  else
    complete_runs_beyond(found, r, side, reach, draw, border, gap);
}

/// The solids at the last sample, where occluders are endless otherwise.
struct Solids {
  float z[kMostSurfaces];
  vec2 slopes[kMostSurfaces];
};

/// Adds what the surfaces of a sample block where occluders are endless: those whose backs are known from front to
/// back, and hidden ones as far as the sphere.
void add_layers(inout Found found, inout Solids last, Receiver r, Side side, Reach reach, Draw draw, Surfaces here,
                float gap) {
  for (int i = 0; i < kSurfaces; i++) {
    const Sample s = here.at[i];
    const bool joins = both(same_surface(r, reach, s.z, last.z[i], gap), last.slopes[i].x >= last.slopes[i].y);
    const vec2 solid = here.has_back[i] ? here.solid[i] : vec2(-1, 1);
    const bool exists = solid.x >= solid.y;
    const vec2 joined = joins ? vec2(max(solid.x, last.slopes[i].x), min(solid.y, last.slopes[i].y)) : solid;
    found.blocked.sectors |= exists ? sectors_between(joined, draw.shift) : 0u;
    last.z[i] = exists ? s.z : kNoLastSurface;
    last.slopes[i] = solid;
    const bool blocks = both(both(i > 0 && !here.has_back[i], here.exists[i]), both(s.above, s.within));
    const float back = slope_of(back_of(r, s.place, reach.thickness, reach.radius));
    found.blocked.near = max(found.blocked.near, blocks ? s.slope : -1.0);
    found.blocked.far = min(found.blocked.far, blocks ? min(s.slope, back) : 1.0);
    if (!kHard && here.exists[i]) add_faded(found, side, reach, draw, s.place);
  }
}

/// 4. to 6. where occluders are solid as far as the sphere of the radius: they block one interval. Solids with known
/// backs have their own.
void search_endless(inout Found found, Receiver r, Side side, Reach reach, Draw draw, int count) {
  const int plane = params.view.size.x * params.view.size.y;
  Sample last = receiver_sample(r);
  ivec2 last_pixel = r.pixel;
  Solids solids;
  for (int i = 0; i < kSurfaces; i++) solids.z[i] = kNoLastSurface;
  for (int i = 0; i < kSurfaces; i++) solids.slopes[i] = vec2(-1, 1);
  for (int k = 0; k < count; k++) {
    const float offset = step_offset(k, int(kSteps), count, side.reach, draw.jitter);
    Sample s;
    bool has_back = false;
    if (kSurfaces == 1) {
      s = sample_at(r, side, reach, offset);
    } else {
      const Surfaces here = surfaces_at(r, side, reach, offset, plane);
      add_layers(found, solids, r, side, reach, draw, here, offset - last.offset);
      s = here.at[0];
      has_back = here.has_back[0];
    }
    const bool connected = both(max(s.distance_sq, last.distance_sq) < kSameSurface * reach.radius_sq,
                                min(s.distance_sq, last.distance_sq) * kSameSurface > reach.radius_sq);
    const bool crosses = kHard ? both(both(s.above, last.above), both(connected, s.within != last.within)) : false;
    const vec2 slopes = slopes_of(
        s, crosses, mix(s.slope, last.slope, (reach.radius_sq - s.distance_sq) / (last.distance_sq - s.distance_sq)));
    const float back = slope_of(back_of(r, s.place, reach.thickness, reach.radius));
    found.blocked.near = max(found.blocked.near, has_back ? -1.0 : slopes.x);
    found.blocked.far = min(found.blocked.far, has_back                  ? 1.0
                                               : both(s.above, s.within) ? min(slopes.y, back)
                                                                         : slopes.y);
    if (!kHard) add_faded(found, side, reach, draw, s.place);
    if (kCurved) {
      const ivec2 pixel = pixel_at(r, side, offset), middle = last_pixel + pixel >> 1;
      const float middle_z = middle == last_pixel ? last.z : occluder_depth[middle.y * reach.width + middle.x];
      const bool is_one = is_through(r, reach, s.z, middle_z, last.z, offset - last.offset);
      follow(found, r, side, reach, s, last, vec2(pixel - r.pixel), is_one, slopes.x);
      last_pixel = pixel;
    }
    last = s;
    last.distance_sq = s.above ? s.distance_sq : kBeyondSq;
  }
}

/// 4. to 6. where occluders are as thick as they are wide, or as the user says: the receiver's own surface, and runs.
void search_runs(inout Found found, Receiver r, Side side, Reach reach, Draw draw, int count) {
  bool own = true;
  Sample last = receiver_sample(r);
  ivec2 last_pixel = r.pixel;
  Run run = Run(vec2(0), vec2(0), -1.0, 1.0, 0.0, false, 0.0);
  Interruptions interrupted = Interruptions(0, 0u, 0u);
  Before before = Before(vec2(0), vec2(0), 0.0, -reach.radius);
  bool is_before = false;  // the run has samples before the sphere
  const uint outline = outline_of(side.direction_px);
  int k = 0;
  if (count > 0) {
    do {
      const float offset = step_offset(k, int(kSteps), count, side.reach, draw.jitter), gap = offset - last.offset;
      const float thickness = thickness_of(r, reach, run, last.z, kThicknessPerWidth, gap);
      const uint sectors = kHard ? sectors_of(r, reach, run, true, thickness, draw.shift) : 0u;
      const float deep = max(thickness, run.deepest);
      const float within = within_of(run, deep);
      const vec2 beside = round(side.direction_px * offset);
      const ivec2 here = r.pixel + ivec2(beside);
      const ivec2 middle = last_pixel + here >> 1;
      const float z = occluder_depth[here.y * reach.width + here.x];
      // The receiver itself need be no occluder.
      const float middle_z = middle == last_pixel ? last.z : occluder_depth[middle.y * reach.width + middle.x];
      const uint word = kHasBacks ? backs[here.y * reach.width + here.x] : 0u;
      const Sample s = sample_of(r, side, reach, offset, beside, z);
      last_pixel = here;
      const bool connected = is_through(r, reach, s.z, middle_z, last.z, gap);
      // A run that crosses the sphere between two samples blocks half way to the one beyond.
      const bool crosses = kHard ? both(both(s.above, last.above), both(connected, s.within != last.within)) : false;
      const vec2 slopes = slopes_of(s, crosses, mix(s.slope, last.slope, 0.5));
      follow(found, r, side, reach, s, last, beside, connected, slopes.x);
      if (kBehindOthers) take_down(interrupted, k, s, last, connected, connected, reach);
      const bool ends = both(connected, s.above) ? false : true;
      if (kHard) {
        found.blocked.sectors |= ends ? sectors : 0u;
        take_before(before, run, both(ends, is_before), deep, within);
      }
      own = ends ? !s.above : own;
      run.start = ends ? s.place : run.start;
      run.end = s.place;
      run.near = greater(own ? -1.0 : slopes.x, ends ? -1.0 : run.near);
      float told = 0.0, far = slopes.y;
      if (kHasBacks) {
        const float mirrored = depth_told(r, reach, s, unpack_mirrored(word >> outline));
        run.is_round = ends ? mirrored >= 0.0 : run.is_round;
        told =
            both(run.is_round, mirrored >= 0.0) ? mirrored : greater(depth_told(r, reach, s, unpack_depth(word)), 0.0);
        far = lesser(far, slope_behind(r, side, s, beside, told));
      }
      run.far = lesser(own ? 1.0 : far, ends ? 1.0 : run.far);
      run.gap = ends ? gap : run.gap;
      found.blocked.near = greater(own ? slopes.x : -1.0, found.blocked.near);
      const bool here_before = both(both(s.above, !own), is_before_sphere(r, reach, s.place));
      is_before = here_before ? true : both(is_before, !ends);
      run.deepest = greater(here_before ? told * r.ray_length : 0.0, ends ? 0.0 : run.deepest);
      if (!kHard) {
        const float thickness = thickness_of(r, reach, run, s.z, kThicknessPerWidth, 0.0);
        found.blocked.sectors |= sectors_of(r, reach, run, true, thickness, draw.shift);
        add_faded(found, side, reach, draw, s.place);
      }
      last = s;
      if (kBehindOthers && int(kSteps) > kWordBits && (k + 1 & kWordBits - 1) == 0) {
        complete_behind(found, r, side, reach, draw, count, interrupted, k + 1);
        interrupted = Interruptions(k + 1, 0u, 0u);
      }
    } while (++k < count);
  }
  if (kHard) {
    const float thickness = thickness_of(r, reach, run, last.z, kThicknessPerWidth, 0.0);
    found.blocked.sectors |= sectors_of(r, reach, run, true, thickness, draw.shift);
    const float deep = max(thickness, run.deepest);
    take_before(before, run, is_before, deep, within_of(run, deep));
    found.blocked.sectors |= sectors_of(r, reach, before, draw.shift);
  }
  if (kBehindOthers) complete_behind(found, r, side, reach, draw, count, interrupted, count);
}

/// The same where it is known what lies behind the run within reach: its width stands in for what is hidden, too.
const float kKnownThicknessPerWidth = 0.6;

// Of a surface of the last sample and of its run, as bits.
const uint kSlotAbove = 1u, kSlotWithin = 2u;
const uint kSlotOwn = 4u;   // the receiver's surface
const uint kSlotOpen = 8u;  // samples of the run that block have no known back
const uint kSlotKnows = 16u;
const uint kSlotBefore = 32u;  // samples of the run without a known back are before the sphere

/// A surface of the last sample, and the run that it belongs to.
struct Slot {
  float z;  // kNoLastSurface: there is none
  float slope;
  uint bits;
  Run run;
};

Slot chosen(Slot a, Slot b, bool second) {
  Slot s;
  s.z = second ? b.z : a.z;
  s.slope = second ? b.slope : a.slope;
  s.bits = second ? b.bits : a.bits;
  s.run.start = second ? b.run.start : a.run.start;
  s.run.end = second ? b.run.end : a.run.end;
  s.run.near = second ? b.run.near : a.run.near;
  s.run.far = second ? b.run.far : a.run.far;
  s.run.gap = second ? b.run.gap : a.run.gap;
  s.run.is_round = second ? b.run.is_round : a.run.is_round;
  s.run.deepest = second ? b.run.deepest : a.run.deepest;
  return s;
}

float thickness_of(Receiver r, Reach reach, Slot slot, float gap) {
  const float per_width = (slot.bits & kSlotKnows) != 0u ? kKnownThicknessPerWidth : kThicknessPerWidth;
  return thickness_of(r, reach, slot.run, slot.z, per_width, gap);
}

/// What the runs of slots block if they end at their last samples.
struct Ends {
  uint sectors[kMostSurfaces];
  float thickness[kMostSurfaces], within[kMostSurfaces];  // of those before the sphere
};

Ends ends_of(Receiver r, Reach reach, Slot slots[kMostSurfaces], float gap, float shift) {
  Ends ends;
  for (int j = 0; j < kSurfaces; j++) {
    const bool is_open = (slots[j].bits & kSlotOpen) != 0u;
    ends.thickness[j] = thickness_of(r, reach, slots[j], gap);
    ends.sectors[j] = sectors_of(r, reach, slots[j].run, is_open, ends.thickness[j], shift);
    ends.thickness[j] = max(ends.thickness[j], slots[j].run.deepest);
    ends.within[j] = within_of(slots[j].run, ends.thickness[j]);
  }
  return ends;
}

/// Ends the runs of those slots whose bits are set; most of the time it is none or one.
void end_runs(inout Found found, inout Before before, Slot slots[kMostSurfaces], Ends ends, uint ending) {
  for (int j = 0; j < kSurfaces; j++) {
    const bool is_ending = (ending >> j & 1u) != 0u;
    found.blocked.sectors |= is_ending ? ends.sectors[j] : 0u;
    take_before(before, slots[j].run, both(is_ending, (slots[j].bits & kSlotBefore) != 0u), ends.thickness[j],
                ends.within[j]);
  }
}

/// search_runs() for pixels of several surfaces: as many runs at a time.
void search_layers(inout Found found, Receiver r, Side side, Reach reach, Draw draw, int count) {
  const int plane = params.view.size.x * params.view.size.y;
  Sample last = receiver_sample(r);
  ivec2 last_pixel = r.pixel;
  const uint outline = outline_of(side.direction_px);
  const Run nothing = Run(vec2(0), vec2(0), -1.0, 1.0, 0.0, false, 0.0);
  Slot slots[kMostSurfaces];
  for (int i = 0; i < kSurfaces; i++)
    slots[i] = Slot(i == 0 ? r.z : kNoLastSurface, 0.0, kSlotAbove | kSlotWithin | kSlotOwn, nothing);
  Interruptions interrupted = Interruptions(0, 0u, 0u);
  Before before = Before(vec2(0), vec2(0), 0.0, -reach.radius);
  int k = 0;
  if (count > 0) {
    do {
      const float offset = step_offset(k, int(kSteps), count, side.reach, draw.jitter), gap = offset - last.offset;
      const Ends ends = ends_of(r, reach, slots, gap, draw.shift);
      const Surfaces here = surfaces_at(r, side, reach, offset, plane);
      float last_z[kMostSurfaces];
      for (int j = 0; j < kSurfaces; j++) last_z[j] = slots[j].z;
      const ivec2 pixel = pixel_at(r, side, offset);
      const ivec2 middle = last_pixel + pixel >> 1;
      float middle_z[kMostSurfaces];
      for (int i = 0; i < kSurfaces; i++)
        middle_z[i] = middle == last_pixel ? last_z[i] : depth_at(r, side, reach, middle, i, plane);
      last_pixel = pixel;
      const int from[kMostSurfaces] = links_of(r, reach, here, middle_z, last_z, gap);
      const bool connected = is_through(r, reach, here.at[0].z, middle_z[0], last.z, gap);
      if (kCurved) {
        const Sample s = here.at[0];
        const bool crosses = kHard ? both(both(s.above, last.above), both(connected, s.within != last.within)) : false;
        follow(found, r, side, reach, s, last, vec2(pixel - r.pixel), connected,
               slopes_of(s, crosses, mix(s.slope, last.slope, 0.5)).x);
      }
      if (kBehindOthers) {
        const bool goes_on = here.at[0].z > last.z ? from[0] >= 0 : is_taken(from, 0);
        take_down(interrupted, k, here.at[0], last, connected, goes_on, reach);
      }
      // Runs end that no surface continues, and those of surfaces that sink below the tangent plane.
      uint ending = 0u;
      for (int j = 0; j < kSurfaces && kHard; j++) {
        bool goes_on = false;
        for (int i = 0; i < kSurfaces; i++) goes_on = both(from[i] == j, here.at[i].above) ? true : goes_on;
        ending |= goes_on ? 0u : 1u << j;
      }
      end_runs(found, before, slots, ends, ending);
      Slot now[kMostSurfaces];
      for (int i = 0; i < kSurfaces; i++) {
        const Sample s = here.at[i];
        Slot slot = slots[0];
        for (int j = 1; j < kSurfaces; j++) slot = chosen(slot, slots[j], from[i] == j);
        const bool connected = from[i] >= 0, was_above = (slot.bits & kSlotAbove) != 0u;
        const bool was_within = (slot.bits & kSlotWithin) != 0u;
        const bool crosses = kHard ? both(both(s.above, was_above), both(connected, s.within != was_within)) : false;
        const vec2 open = slopes_of(s, crosses, mix(s.slope, slot.slope, 0.5));
        const vec2 slopes = here.has_back[i] ? here.solid[i] : open;
        const bool begins = both(connected, s.above) ? false : true;
        slot.run.start = begins ? s.place : slot.run.start;
        slot.run.near = begins ? -1.0 : slot.run.near;
        slot.run.far = begins ? 1.0 : slot.run.far;
        slot.run.gap = begins ? gap : slot.run.gap;
        slot.run.end = s.place;
        const bool own = begins ? !s.above : (slot.bits & kSlotOwn) != 0u;
        const bool counts = both(here.exists[i], !own);
        const bool knows = i + 1 < kSurfaces ? here.exists[min(i + 1, kMostSurfaces - 1)] : false;
        // Of first surfaces without a known one behind them their pixel tells how far back they are solid.
        const bool is_told = kHasBacks && i == 0 && !knows && !here.has_back[i];
        const uint word = is_told ? backs[pixel.y * reach.width + pixel.x] : 0u;
        const float mirrored = is_told ? depth_told(r, reach, s, unpack_mirrored(word >> outline)) : -1.0;
        slot.run.is_round = begins ? mirrored >= 0.0 : slot.run.is_round;
        const float seen = is_told ? greater(depth_told(r, reach, s, unpack_depth(word)), 0.0) : 0.0;
        const float told = both(slot.run.is_round, mirrored >= 0.0) ? mirrored : seen;
        const float behind = is_told ? slope_behind(r, side, s, vec2(pixel - r.pixel), told) : 1.0;
        found.blocked.near = max(found.blocked.near, both(here.exists[i], own) ? open.x : -1.0);
        slot.run.near = max(slot.run.near, counts ? slopes.x : -1.0);
        slot.run.far = min(slot.run.far, counts ? min(slopes.y, behind) : 1.0);
        const bool is_open = both(counts, !here.has_back[i]);
        const bool is_before = kHard ? both(both(is_open, s.above), is_before_sphere(r, reach, s.place)) : false;
        slot.run.deepest = max(is_before ? told * r.ray_length : 0.0, begins ? 0.0 : slot.run.deepest);
        slot.bits = (begins ? 0u : slot.bits & (kSlotOpen | kSlotKnows | kSlotBefore)) | (s.above ? kSlotAbove : 0u) |
                    (s.within ? kSlotWithin : 0u) | (own ? kSlotOwn : 0u) | (knows ? kSlotKnows : 0u) |
                    (is_open ? kSlotOpen : 0u) | (is_before ? kSlotBefore : 0u);
        slot.z = here.exists[i] ? s.z : kNoLastSurface;
        slot.slope = s.slope;
        now[i] = slot;
        if (!kHard && here.exists[i]) {
          const float thickness = thickness_of(r, reach, slot, 0.0);
          found.blocked.sectors |= sectors_of(r, reach, slot.run, (slot.bits & kSlotOpen) != 0u, thickness, draw.shift);
          add_faded(found, side, reach, draw, s.place);
        }
      }
      slots = now;
      last = here.at[0];
      if (kBehindOthers && int(kSteps) > kWordBits && (k + 1 & kWordBits - 1) == 0) {
        complete_behind(found, r, side, reach, draw, count, interrupted, k + 1);
        interrupted = Interruptions(k + 1, 0u, 0u);
      }
    } while (++k < count);
  }
  if (kHard) end_runs(found, before, slots, ends_of(r, reach, slots, 0.0, draw.shift), (1u << kSurfaces) - 1u);
  if (kHard) found.blocked.sectors |= sectors_of(r, reach, before, draw.shift);
  if (kBehindOthers) complete_behind(found, r, side, reach, draw, count, interrupted, count);
}

/// 4. to 9. The blocked part of a side's integrals; in the last row of the second column the part of its arc that
/// completed surfaces block. curved: what the own surface blocks of the arc, inside and outside.
mat2x3 search(Receiver r, Side side, Reach reach, Draw draw, out vec2 curved) {
  const int count = min(int(kSteps), int(side.reach));
  const Blocked nothing = Blocked(-1.0, kThickness == kThicknessEndless ? 1.0 : -1.0, 0u);
  Found found = Found(nothing, nothing, mat2x3(0), mat2x3(0), 0.0, own_surface());
  if (kThickness == kThicknessEndless)
    search_endless(found, r, side, reach, draw, count);
  else if (kSurfaces > 1)
    search_layers(found, r, side, reach, draw, count);
  else
    search_runs(found, r, side, reach, draw, count);
  if (kBeyondBorder && side.reach < side.whole_reach) complete_beyond(found, r, side, reach, draw);
  curved = ended(found.own, r, side, reach);
  if (!kHard) {
    found.sum[1].z = found.completed_sum;
    return found.sum;
  }
  const Blocked all =
      Blocked(max(found.blocked.near, found.completed.near), min(found.blocked.far, found.completed.far),
              found.blocked.sectors | found.completed.sectors);
  mat2x3 arcs = blocked_arcs(side, all, draw.shift);
  if (kTellsCompleted) arcs[1].z = arcs[0].x - blocked_arcs(side, found.blocked, draw.shift)[0].x;
  return arcs;
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
          slice.share * slice.weight * search(r, side, reach, draw_of(noise, s, uint(sign > 0)), curved);
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
