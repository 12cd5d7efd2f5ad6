// How far back what each pixel shows is solid, as far as other pixels of its surface tell.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of the first surfaces that may block, view normals, the chains of pixels of one surface along rows
// and columns.
// Out: a word per pixel, see backs.glsl.
//
// Of the four chains that go from a pixel to the left, to the right, up and down some places tell, none farther away
// than kLongestChain, so that a part of the frame has the words of the whole.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/estimate/solids.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { BacksParams params; };
readonly buffer Depth { float depth[]; };    // one float per pixel
readonly buffer Normal { uint normal[]; };   // one uint per pixel, from prepare
readonly buffer Chains { uint chains[]; };   // from chains
writeonly buffer Backs { uint backs[]; };

/// Places of a chain that tell, evenly from a pixel to the chain's end, or as far as it tells.
const int kTelling = 2;

/// How many steps a chain goes on from a pixel of a line before it, and after it, at most so many. words: the line's
/// first.
ivec2 steps_of_chain(int words, int step, int most, int steps) {
  const int word = step >> 5;
  const uint here = ~chains[words + 3 * word];
  uint ends = here & 0xffffffffu >> 31 - (step & 31);
  int at = word;
  const int first = max(step - most, 0) >> 5, last = min(step + most, steps - 1) >> 5;
  if (ends == 0u && at > first) do
      ends = ~chains[words + 3 * --at];
    while (ends == 0u && at > first);
  ivec2 chain;
  chain.x = min(step - 32 * at - max(findMSB(ends), 0), most);
  ends = here & 0xfffffffeu << (step & 31);
  at = word;
  if (ends == 0u && at < last) do
      ends = ~chains[words + 3 * ++at];
    while (ends == 0u && at < last);
  chain.y = min(32 * at + (ends == 0u ? 32 : findLSB(ends)) - 1 - step, most);
  return chain;
}

float distance_from_eye(View view, vec3 position) { return view.orthographic == 0 ? length(position) : -position.z; }

/// What a chain tells of a pixel, in scene units along the eye's ray.
struct Told {
  float depth;     // how much deeper than its front it is solid
  float size;      // of what is seen of its surface
  float mirrored;  // as depth, by a rounded outline; below 0: the chain has none
};

/// away: from the pixel to the end of the chain.
Told told_by(View view, vec3 here, vec3 n, ivec2 pixel, ivec2 away, bool is_round) {
  const float e = distance_from_eye(view, here);
  float farther = 0.0;
  Told told = Told(0.0, 0.0, -1.0);
  for (int i = 1; i <= kTelling; i++) {
    const ivec2 place = pixel + away * i / kTelling;
    const vec3 other = position_of(view, vec2(place) + 0.5, depth[index_of(view, place)]);
    farther = distance_from_eye(view, other) - e;
    told.depth = max(told.depth, min(farther, -dot(n, other - here)));
    told.size = length(other - here);
  }
  if (is_round) told.mirrored = max(2.0 * farther, 0.0);
  return told;
}

/// The same of both chains of a line.
struct Line {
  float depth, size;
  vec2 mirrored;  // by the outline before, and after
};

Line line_of(View view, vec3 here, vec3 n, ivec2 pixel, int most, bool is_column) {
  const ivec2 along = is_column ? ivec2(0, 1) : ivec2(1, 0);
  const int step = is_column ? pixel.y : pixel.x, steps = is_column ? view.size.y : view.size.x;
  const int words = first_word(view, is_column, is_column ? pixel.x : pixel.y);
  const ivec2 away = steps_of_chain(words, step, most, steps);
  const ivec2 ends = step + ivec2(-away.x, away.y);
  const uint begins = chains[words + 3 * (ends.x >> 5) + 1] >> (ends.x & 31) & 1u;
  const uint stops = chains[words + 3 * (ends.y >> 5) + 2] >> (ends.y & 31) & 1u;
  const Told before = told_by(view, here, n, pixel, -away.x * along, begins != 0u && away.x >= 2 && away.x < most);
  const Told after = told_by(view, here, n, pixel, away.y * along, stops != 0u && away.y >= 2 && away.y < most);
  return Line(max(before.depth, after.depth), before.size + after.size, vec2(before.mirrored, after.mirrored));
}

void main() {
  const View view = params.view;
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(view, pixel)) return;
  const int index = index_of(view, pixel);
  const float z = depth[index], width = pixels_of(view, z);
  const vec3 here = position_of(view, vec2(pixel) + 0.5, z), n = unpack_normal(normal[index]);
  const vec2 longest = kLongestChain * params.radius / (view.orthographic == 0 ? z : 1.0) / abs(view.tangent_per_pixel);
  const ivec2 most = ivec2(min(longest, 1e5));
  const Line row = line_of(view, here, n, pixel, most.x, false), column = line_of(view, here, n, pixel, most.y, true);
  const vec2 widths = kBackPerWidth * (vec2(row.size, column.size) + width);
  const float told = max(min(row.depth, widths.y), min(column.depth, widths.x));
  // Of depth along the eye's ray that along the axis, in pixels' widths.
  const float scale = z / (distance_from_eye(view, here) * width), farthest = kMostBack * params.radius * scale;
  backs[index] = pack_back(min(told * scale, farthest), min(vec4(row.mirrored, column.mirrored) * scale, farthest));
}
