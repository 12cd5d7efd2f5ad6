// Makes the G-buffer at a half or a quarter of the resolution: of each block of pixels the nearest surface, with its
// own normal.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: depth, normals and hidden surfaces of the pixels.
// Out: depth, normals and hidden surfaces of the blocks.
//
// A block stands for its centre, where no pixel lies. The nearest pixel's surface is followed along its own plane to
// the centre's ray: a plane stays that plane at every tilt, and nothing shifts by part of a pixel. Where the plane
// would leave the range of depths that the block shows (a curved rim, a horizon) the range wins. What that pixel
// hides stays as far behind its surface.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/geometry/geometry.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kFactor = 2;  // pixels of a block in x and in y
layout(scalar, push_constant) uniform Push { DownsampleParams params; };
readonly buffer Depth { float depth[]; };            // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };           // one uint per pixel, from prepare
writeonly buffer LowDepth { float low_depth[]; };    // one float per block, kSkyDepth where all of it is sky
writeonly buffer LowNormal { uint low_normal[]; };   // one uint per block
readonly buffer Hidden { float hidden[]; };          // planes of hidden surfaces, see GBuffer; none if there are none
writeonly buffer LowHidden { float low_hidden[]; };  // as many of the blocks

/// The depth at which the ray of image point `to` meets the plane with normal n through image point `from` at depth z;
/// beyond all where it does not.
float follow_plane(vec3 n, vec2 from, float z, vec2 to) {
  const float moved = dot(n.xy, (to - from) * params.view.tangent_per_pixel);
  if (params.view.orthographic != 0) return z + moved / n.z;
  const float cosine = n.z - dot(n.xy, tangent_of(params.view, from));
  const float cosine_there = cosine - moved;
  return cosine_there > 0.0 ? min(z * (cosine / cosine_there), kSkyDepth) : kSkyDepth;
}

/// Writes what is hidden in a block whose surface is `moved` deeper than that of the pixel; none where it is sky.
void write_hidden(int low_index, int index, float moved, bool is_sky) {
  const int plane = params.view.size.x * params.view.size.y, low_plane = params.low_size.x * params.low_size.y;
  for (int k = 0; k < int(params.hidden); k++) {
    const float z = hidden[index + k * plane];
    const bool exists = !is_sky && abs(z) < kSkyDepth;
    low_hidden[low_index + k * low_plane] = exists ? z + (z < 0.0 ? -moved : moved) : kSkyDepth;
  }
}

void main() {
  const ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(block, params.low_size))) return;
  const int low_index = block.y * params.low_size.x + block.x;
  const ivec2 corner = block * kFactor - params.overhang;

  float nearest = kSkyDepth, farthest = 0.0;
  ivec2 chosen = clamp(corner, ivec2(0), params.view.size - 1);
  bool whole = true;
  for (int y = 0; y < kFactor; y++) {
    for (int x = 0; x < kFactor; x++) {
      const ivec2 pixel = corner + ivec2(x, y);
      if (!inside(params.view, pixel)) {
        whole = false;
        continue;
      }
      const float z = depth[index_of(params.view, pixel)];
      farthest = max(farthest, z);
      if (z >= nearest) continue;
      nearest = z;
      chosen = pixel;
    }
  }
  low_depth[low_index] = kSkyDepth;
  low_normal[low_index] = pack_normal(vec3(0, 0, 1));
  const int index = index_of(params.view, chosen);
  if (nearest >= kSkyDepth) write_hidden(low_index, index, 0.0, true);
  if (nearest >= kSkyDepth) return;

  // The centre of a block that reaches over the border lies outside of its pixels: there the range is a guess.
  const uint word = normal[index];
  const vec3 n = unpack_normal(word);
  const vec2 center = vec2(corner) + 0.5 * float(kFactor);
  const float z = clamp(follow_plane(n, vec2(chosen) + 0.5, nearest, center), whole ? nearest : 0.5 * nearest,
                        whole ? farthest : 2.0 * nearest);
  low_depth[low_index] = z;
  write_hidden(low_index, index, z - nearest, z >= kSkyDepth);
  if (z >= kSkyDepth) return;
  const vec3 eye = toward_eye(params.view, position_of(params.view, center, z));
  low_normal[low_index] = dot(n, eye) < kLeastFacing ? pack_normal(facing(n, eye)) : word;
}
