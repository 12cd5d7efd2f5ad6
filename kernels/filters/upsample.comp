// Brings visibility at a half or a quarter of the resolution back to all pixels, each surface by itself.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: depth and normals of pixels and of blocks, planes of visibility of blocks.
// Out: as many planes of pixels; sky is 1.
//
// Kopf et al., "Joint Bilateral Upsampling", 2007: a pixel mixes the four blocks about it by bilinear weights between
// their centres, as far as these lie in the pixel's tangent plane and their normals agree with its own. Where none
// does, the pixel takes the block of the nearest depth. One invocation computes the pixels that lie between the same
// four centres.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/filters/filters.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kFactor = 2;  // pixels of a block in x and in y
layout(constant_id = 1) const int kPlanes = 1;  // how many planes; they share their weights
layout(scalar, push_constant) uniform Push { UpsampleParams params; };
readonly buffer Depth { float depth[]; };          // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };         // one uint per pixel, from prepare
readonly buffer LowDepth { float low_depth[]; };   // one float per block, from downsample
readonly buffer LowNormal { uint low_normal[]; };  // one uint per block, from downsample
// planes of floats in [0, 1] a block, visibility or the like; each by itself
readonly buffer LowAo { float low_ao[]; };
writeonly buffer Ao { float ao[]; };  // as many planes, in [0, 1]

/// A block has no part in a pixel if its centre lies further from the pixel's tangent plane than this many pixels are
/// wide there.
const float kPlaneSigma = 2.0;
/// If the sum of the weights is less than this, no block agrees with the pixel.
const float kLeastWeight = 1e-3;

struct Block {
  int index;
  float z;  // kSkyDepth outside the image
  vec3 position, normal;
};

Block load(ivec2 block) {
  const ivec2 nearest = clamp(block, ivec2(0), params.low_size - 1);
  const int index = nearest.y * params.low_size.x + nearest.x;
  const float z = block == nearest ? low_depth[index] : kSkyDepth;
  const vec2 center = float(kFactor) * (vec2(block) + 0.5) - vec2(params.overhang);
  return Block(index, z, position_of(params.view, center, z), unpack_normal(low_normal[index]));
}

/// The shares of four blocks in a pixel. `between`: where it lies between the centres of the first and the last of
/// them, from 0 to 1 on each axis.
vec4 parts_of(Block blocks[4], vec2 between, ivec2 pixel, float z, vec3 n) {
  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z);
  const vec2 across = abs(params.view.tangent_per_pixel);
  const float sigma = kPlaneSigma * 0.5 * (across.x + across.y) * (params.view.orthographic != 0 ? 1.0 : z);
  float whole = 0.0, least = kSkyDepth;
  vec4 parts = vec4(0), closest = vec4(0);
  for (int i = 0; i < 4; i++) {
    if (blocks[i].z >= kSkyDepth) continue;
    const float off_plane = dot(n, blocks[i].position - position) / sigma;
    const float alike = max(0.0, dot(n, blocks[i].normal));
    const float squared = alike * alike;
    const vec2 bilinear = mix(1.0 - between, between, bvec2(i & 1, i & 2));
    const float weight = bilinear.x * bilinear.y * max(0.0, 1.0 - off_plane * off_plane) * squared * squared;
    whole += weight;
    parts[i] = weight;
    const float further = abs(blocks[i].z - z);
    if (further < least) closest = vec4(i == 0, i == 1, i == 2, i == 3);
    least = min(least, further);
  }
  return whole > kLeastWeight ? parts / whole : closest;
}

void main() {
  const ivec2 block = ivec2(gl_GlobalInvocationID.xy) - 1;
  const ivec2 first = kFactor * block + kFactor / 2 - params.overhang;
  if (any(greaterThanEqual(first, params.view.size))) return;

  Block blocks[4];
  for (int i = 0; i < 4; i++) blocks[i] = load(block + ivec2(i & 1, i >> 1));
  const int plane = params.view.size.x * params.view.size.y;
  const int low_plane = params.low_size.x * params.low_size.y;
  vec4 values[kPlanes];  // of the blocks
  for (int p = 0; p < kPlanes; p++)
    for (int i = 0; i < 4; i++) values[p][i] = low_ao[blocks[i].index + p * low_plane];
  for (int y = 0; y < kFactor; y++) {
    for (int x = 0; x < kFactor; x++) {
      const ivec2 pixel = first + ivec2(x, y);
      if (!inside(params.view, pixel)) continue;
      const int index = index_of(params.view, pixel);
      const float z = depth[index];
      const vec4 parts = parts_of(blocks, (vec2(x, y) + 0.5) / float(kFactor), pixel, z, unpack_normal(normal[index]));
      for (int p = 0; p < kPlanes; p++) {
        const vec4 change = values[p] - values[p].x;
        ao[index + p * plane] = z < kSkyDepth ? clamp(values[p].x + dot(parts, change), 0.0, 1.0) : 1.0;
      }
    }
  }
}
