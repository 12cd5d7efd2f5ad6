// A plane before all surfaces of every block, and the farthest depth, by which `shadow` passes over blocks.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: depth of what may block.
// Out: four floats per block of kNearestBlock x kNearestBlock pixels, one block for each kNearestStep. The plane is of
// nearness, in which planes of the scene are planes of the image: 1 / z, or -z orthographic. Its place is that of the
// block's first pixel.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { NearestParams params; };
readonly buffer Occluders {
  float occluder_depth[];
};  // one float per pixel, depth of the first surfaces that may block
// nearness at the first pixel, and its change per pixel in x and y; the farthest depth, 0 for sky alone. Blocks are in
// rows from the upper left corner.
writeonly buffer Nearest { vec4 nearest[]; };

float depth_at(ivec2 pixel) { return occluder_depth[pixel.y * params.size.x + pixel.x]; }
float nearness(float z) { return params.orthographic != 0u ? -z : 1.0 / z; }

void main() {
  const ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 blocks = (params.size + kNearestStep - 1) / kNearestStep;
  if (any(greaterThanEqual(block, blocks))) return;
  const ivec2 first = block * kNearestStep, end = min(first + kNearestBlock, params.size);
  const vec2 middle = 0.5 * vec2(end - first - 1), halves = max(0.5 * vec2(end - first), 1.0);
  float farthest = 0.0;
  vec2 sums[2] = vec2[2](vec2(0), vec2(0)), counts[2] = vec2[2](vec2(0), vec2(0));  // of the halves in x, and in y
  for (int y = first.y; y < end.y; y++)
    for (int x = first.x; x < end.x; x++) {
      const float z = depth_at(ivec2(x, y));
      if (z >= kSkyDepth) continue;
      farthest = greater(z, farthest);
      const vec2 upper = vec2(greaterThan(vec2(x - first.x, y - first.y), middle));
      sums[0] += nearness(z) * (1.0 - upper);
      sums[1] += nearness(z) * upper;
      counts[0] += 1.0 - upper;
      counts[1] += upper;
    }
  const bvec2 has_both = greaterThan(min(counts[0], counts[1]), vec2(0));
  const vec2 change = mix(vec2(0), (sums[1] / max(counts[1], 1.0) - sums[0] / max(counts[0], 1.0)) / halves, has_both);
  float level = nearness(kSkyDepth), tilted = level;  // the greatest, of the plane in the block's middle
  for (int y = first.y; y < end.y; y++)
    for (int x = first.x; x < end.x; x++) {
      const float near = nearness(depth_at(ivec2(x, y)));
      level = greater(near, level);
      tilted = greater(near - dot(change, vec2(x - first.x, y - first.y) - middle), tilted);
    }
  const bool is_tilted = tilted < level;
  nearest[block.y * blocks.x + block.x] =
      is_tilted ? vec4(tilted - dot(change, middle), change, farthest) : vec4(level, vec2(0), farthest);
}
