// The search of horizon.comp with fewer rules, for the sites of blocks.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth with a margin, view normals, the list of sites.
// Out: visibility, at the sites.
//
// Steps 1 to 5, 9 and 10 are those of horizon.comp, but that a run counts at each of its samples, as far as it is known
// by then: sectors only grow, so nothing waits for its end. Of the others these differ:
//  6. A run is twice as thick as wide, which stands for what goes on behind others.
//  7. Nothing goes on behind others. Beyond the border samples find the depths that margin.comp has put there.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/noise.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"
#include "kernels/estimate/sectors.glsl"
#include "kernels/base/blocks.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSlices = 2;  // slices per site
layout(constant_id = 1) const uint kSteps = 12;  // steps to each side of a slice
layout(scalar, push_constant) uniform Push { QuickParams params; };
readonly buffer Wide { float wide[]; };     // one float per pixel of the image with its margin: see margin.comp
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
readonly buffer List { uint list[]; };      // from sites
readonly buffer Counts { SiteCounts counts; };
writeonly buffer Ao { float ao[]; };  // one float per pixel, visibility in [0, 1]

/// A run is so many times as thick as wide.
const float kThicknessPerWidth = 2.0;

/// The blocked part of a side's arc integral.
float search(Receiver r, Side side, Reach reach, Draw draw) {
  const int count = min(int(kSteps), int(side.reach));
  const int base = (r.pixel.y + kDepthMargin) * reach.width + r.pixel.x + kDepthMargin;
  // The sample before.
  ivec2 last_here = ivec2(0);
  float last_z = r.z, last_offset = 0.0, last_slope = 0.0;
  bool last_above = true, last_within = true;
  // The run: its first sample, the largest and smallest slope that block, and the steps to the sample before it.
  vec2 start = vec2(0);
  float near = -1.0, far = 1.0, run_gap = 0.0;
  bool own = true;
  // What is blocked: by the receiver's own surface, by runs, and by the run before the sphere that reaches deepest.
  float horizon = -1.0;
  uint sectors = 0u;
  vec2 before = vec2(0);
  float before_thickness = 0.0, deepest = 0.0;
  int k = 0;
  if (count > 0) {
    do {
      const float offset = step_offset(k, int(kSteps), count, side.reach, draw.jitter), gap = offset - last_offset;
      const vec2 beside = round(side.direction_px * offset);
      const float found = wide[base + int(beside.y) * reach.width + int(beside.x)], z = abs(found);
      const float scale = r.perspective ? z : 1.0;
      const vec2 place = place_of(r, side, beside, z, scale);
      const float distance_sq = dot(place, place), slope = slope_of(place);
      const bool is_clear = found > 0.0 || height_of(r, beside, z, scale) > kLeastRisen * reach.radius + r.least_height;
      const bool above = both(is_above(r, reach, place, distance_sq, offset, beside, z, scale), is_clear);
      const bool within = distance_sq < reach.radius_sq;
      const ivec2 here = ivec2(beside), middle = last_here + here >> 1;
      const float middle_z = middle == last_here ? last_z : abs(wide[base + middle.y * reach.width + middle.x]);
      last_here = here;
      const bool goes_on = both(is_through(r, reach, z, middle_z, last_z, gap), above);
      const bool crosses = both(both(goes_on, last_above), within != last_within);
      const float crossing = 0.5 * (slope + last_slope);
      const bool blocks = both(above, within);
      const float most = greater(blocks ? slope : -1.0, crosses ? crossing : -1.0);
      const float least = lesser(blocks ? slope : 1.0, crosses ? crossing : 1.0);
      own = goes_on ? own : !above;
      start = goes_on ? start : place;
      run_gap = goes_on ? run_gap : gap;
      near = greater(goes_on ? near : -1.0, own ? -1.0 : most);
      far = lesser(goes_on ? far : 1.0, own ? 1.0 : least);
      horizon = greater(horizon, own ? most : -1.0);
      const float width = length(place - start) + (1.0 + kGapPart * (run_gap + gap)) * reach.pixel_size * scale;
      const float thickness = levelled(kThicknessPerWidth * width, kWidestRun * reach.radius);
      const float back = lesser(slope_of(start + thickness * away_from_eye(r, start)), far);
      sectors |= sectors_between(vec2(near, back), draw.shift);
      const bool is_before = both(both(above, !own), is_before_sphere(r, reach, place));
      const float deep = reach.radius + thickness - sqrt(distance_sq);
      const bool taken = both(is_before, deep > deepest);
      before = taken ? place : before;
      before_thickness = taken ? thickness : before_thickness;
      deepest = taken ? deep : deepest;
      last_z = z;
      last_offset = offset;
      last_slope = slope;
      last_above = above;
      last_within = within;
    } while (++k < count);
  }
  const vec2 solid = depths_of(r, before, before_thickness, reach.radius_sq);
  sectors |= deepest > 0.0 ? sectors_between(solid, draw.shift) : 0u;
  const float plane = slope_of(side.ahead), top = greater(horizon, plane);
  const float arc = horizon > plane ? arc_to(side, place_at(plane)) - arc_to(side, place_at(horizon)) : 0.0;
  return arc + arc_of(side, sectors & ~sectors_below(top, draw.shift));
}

void main() {
  const View view = params.view;
  const uint at = (gl_WorkGroupID.y * kListedRow + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (at >= counts.listed) return;
  const ivec2 pixel = pixel_of_site(params.grid, int(list[at]));
  View around = view;
  around.size += 2 * kDepthMargin;
  const float z = wide[index_of(around, pixel + kDepthMargin)];
  const vec3 n = unpack_normal(normal[index_of(view, pixel)]);
  const Receiver r = receiver_at(view, pixel, z, n, params.radius, params.depth_precision);
  Reach reach = reach_of(view, params.radius, 0.0, params.radius, 0.0, params.bias);
  reach.width = around.size.x;
  const vec2 noise = pixel_noise(pixel + params.noise_origin, params.noise_shift);
  float blocked = 0.0, whole = 0.0;
  uint s = 0u;
  do {
    const Slice slice = slice_at(view, r, s, kSlices, noise.x);
    if (slice.weight < kLeastWeight) continue;
    whole += slice.share * slice.weight * (slice.cos_gamma + slice.gamma * slice.sin_gamma);  // both sides' whole_arc()
    int sign = -1;
    do {
      Side side = side_of(view, r, slice, float(sign), reach);
      side.reach = min(steps_to_border(around, pixel + kDepthMargin, side.direction_px), side.whole_reach);
      blocked += slice.share * slice.weight * search(r, side, reach, draw_of(noise, s, uint(sign > 0)));
      sign += 2;
    } while (sign <= 1);
  } while (++s < kSlices);
  ao[index_of(view, pixel)] = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
}
