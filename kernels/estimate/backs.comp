// How far back what each pixel shows is solid, as far as other pixels of its surface tell.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of the first surfaces that may block, view normals, the chains of pixels of one surface along rows
// and columns.
// Out: a word per pixel, see backs.glsl.
//
// Of the four chains that go from a pixel to the left, to the right, up and down the last pixels tell, or those
// kLongestChain away, so that a part of the frame has the words of the whole.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/estimate/solids.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { BacksParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
readonly buffer Chains { uint chains[]; };  // two words per segment, from chains
readonly buffer Ends { uint ends[]; };      // the same, from chain_ends
writeonly buffer Backs { uint backs[]; };

/// How many steps the chain of a pixel goes on before it, and after it, at most so many. first: the line's segment.
ivec2 steps_of_chain(int first, int step, int most) {
  const int segment = first + (step >> 5), at = step & 31;
  const uint parted = ~chains[2 * segment];
  const uint before = parted & 0xffffffffu >> 31 - at, after = parted & 0xfffffffeu << at;
  const ivec2 beyond = ivec2(ends[2 * segment], ends[2 * segment + 1]);
  return min(ivec2(before == 0u ? at + beyond.x : at - findMSB(before),
                   after == 0u ? 31 - at + beyond.y : findLSB(after) - 1 - at),
             most);
}

bool is_round_at(int first, int step) { return (chains[2 * (first + (step >> 5)) + 1] >> (step & 31) & 1u) != 0u; }

float distance_from_eye(View view, vec3 position) { return view.orthographic == 0 ? length(position) : -position.z; }

/// What a chain tells of a pixel, in scene units along the eye's ray.
struct Told {
  float depth;     // how much deeper than its front it is solid
  float size;      // of what is seen of its surface
  float mirrored;  // as depth, by a rounded outline; below 0: the chain has none
};

/// away: from the pixel to the end of the chain, or as far as it tells.
Told told_by(View view, vec3 here, vec3 n, ivec2 pixel, ivec2 away, bool is_round) {
  const ivec2 end = pixel + away;
  const vec3 other = position_of(view, vec2(end) + 0.5, depth[index_of(view, end)]), along = other - here;
  const float farther = distance_from_eye(view, other) - distance_from_eye(view, here);
  return Told(min(farther, -dot(n, along)), length(along), is_round ? max(2.0 * farther, 0.0) : -1.0);
}

/// The same of both chains of a line.
struct Sides {
  float depth, size;
  vec2 mirrored;  // by the outline before, and after
};

Sides sides_of(View view, vec3 here, vec3 n, ivec2 pixel, int most, bool is_column) {
  const ivec2 along = is_column ? ivec2(0, 1) : ivec2(1, 0);
  const int step = is_column ? pixel.y : pixel.x;
  const int first = line_of(view, is_column, is_column ? pixel.x : pixel.y).first;
  const ivec2 away = steps_of_chain(first, step, most);
  const bool may_be_round = away.x + away.y >= kRoundPixels - 1;
  const Told before = told_by(view, here, n, pixel, -away.x * along,
                              may_be_round && away.x < most && is_round_at(first, step - away.x)),
             after = told_by(view, here, n, pixel, away.y * along,
                             may_be_round && away.y < most && is_round_at(first, step + away.y));
  return Sides(max(max(before.depth, after.depth), 0.0), before.size + after.size,
               vec2(before.mirrored, after.mirrored));
}

void main() {
  const View view = params.view;
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(view, pixel)) return;
  const int index = index_of(view, pixel);
  const float z = depth[index], width = pixel_width(view, z);
  const vec3 here = position_of(view, vec2(pixel) + 0.5, z), n = unpack_normal(normal[index]);
  const vec2 longest = kLongestChain * params.radius / (view.orthographic == 0 ? z : 1.0) / abs(view.tangent_per_pixel);
  const ivec2 most = ivec2(min(longest, 1e5));
  const Sides row = sides_of(view, here, n, pixel, most.x, false),
              column = sides_of(view, here, n, pixel, most.y, true);
  const vec2 widths = kBackPerWidth * (vec2(row.size, column.size) + width);
  const float told = max(min(row.depth, widths.y), min(column.depth, widths.x));
  // Of depth along the eye's ray that along the axis, in pixels' widths.
  const float scale = z / (distance_from_eye(view, here) * width), farthest = kMostBack * params.radius * scale;
  backs[index] = pack_back(min(told * scale, farthest), min(vec4(row.mirrored, column.mirrored) * scale, farthest));
}
