// Leaves out the first surfaces that are no occluders: what is behind them blocks, where that is known.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, a matte of what blocks or of what does not, planes of hidden surfaces.
// Out: planar depth of the first surfaces that may block, kSkyDepth instead of the others; the hidden surfaces without
// those that close the solids of such, which are their backs.
//
// A matte is filtered like the beauty, and a depth belongs to one surface. So a pixel that several objects share takes
// the matte of the unmixed neighbour whose plane fits best, in both directions.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/geometry/geometry.h"
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kHidden = 0;  // planes of hidden surfaces, 0 to kMostHidden
layout(scalar, push_constant) uniform Push { OccludersParams params; };
readonly buffer Depth { float depth[]; };     // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };    // one uint per pixel, from prepare
readonly buffer Matte { float matte[]; };     // one float per pixel, from matte
readonly buffer Hidden { float hidden[]; };   // planes of hidden surfaces, see GBuffer; only where there are any
writeonly buffer Result { float result[]; };  // one float per pixel, the first surface's depth if it may block
writeonly buffer Behind { float behind[]; };  // as the planes of hidden surfaces

/// A pixel is one object's alone where so much of it is, or so much not: coverage is summed in steps of a sample.
const float kAlone = 0.98;

/// Whether the matte takes the surface that a pixel's depth is of.
bool is_taken(ivec2 pixel, float z) {
  const int own_index = index_of(params.view, pixel);
  const float own = matte[own_index];
  if (own >= kAlone || own <= 1.0 - kAlone) return own >= 0.5;
  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z), n = unpack_normal(normal[own_index]);
  bool taken = own >= 0.5;
  float least = kSkyDepth;
  for (int y = -kOccludersReach; y <= kOccludersReach; y++)
    for (int x = -kOccludersReach; x <= kOccludersReach; x++) {
      const ivec2 at = pixel + ivec2(x, y);
      if (!inside(params.view, at)) continue;
      const int index = index_of(params.view, at);
      const bool is_alone = matte[index] >= kAlone || matte[index] <= 1.0 - kAlone;
      if (!is_alone || depth[index] >= kSkyDepth) continue;
      const vec3 along = position_of(params.view, vec2(at) + 0.5, depth[index]) - position;
      const float apart = max(abs(dot(along, n)), abs(dot(along, unpack_normal(normal[index]))));
      if (apart >= least) continue;
      least = apart;
      taken = matte[index] >= 0.5;
    }
  return taken;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel), plane = params.view.size.x * params.view.size.y;
  const float z = depth[index];
  const bool leaves_out = z < kSkyDepth && is_taken(pixel, z) == (params.ignores != 0u);
  uint kept = 0u;
  for (uint k = 0u; k < kHidden; k++) {
    const float other = hidden[index + int(k) * plane];
    const bool is_its_back = leaves_out && k == 0u && other < 0.0;
    if (is_its_back || abs(other) >= kSkyDepth) continue;
    behind[index + int(kept) * plane] = other;
    kept++;
  }
  for (uint k = kept; k < kHidden; k++) behind[index + int(k) * plane] = kSkyDepth;
  const bool stays = params.keeps != 0u && params.lists_all == 0u && kept == 0u;
  result[index] = leaves_out && !stays ? kSkyDepth : z;
}
