// The planes of the pixels that a filter reads, and how far two of them mix.
// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel has declared kByDepth and the buffers `depth` and `normal`.
#include "kernels/base/likeness.glsl"

/// Pixels without an estimate of their own need some: where nothing alike is in reach, they get what is least unlike.
const float kLeastSimilarity = 1e-4;

/// A pixel outside the image is as sky.
Plane plane_at(View view, ivec2 pixel) {
  const ivec2 nearest = clamp(pixel, ivec2(0), view.size - 1);
  const int index = index_of(view, nearest);
  const float z = pixel == nearest ? depth[index] : kSkyDepth;
  if (kByDepth != 0u) return Plane(z, 1.0, 0.0, vec2(0), vec3(0));
  return plane_of(view, nearest, z, unpack_normal(normal[index]));
}

/// By depth alone, in parts of it: a setting of the user's.
float similarity_of_depths(Plane a, Plane b, float sigma, float least) {
  const float steps = abs(b.z - a.z) / (sigma * min(a.z, b.z));
  return max(least / (1.0 + steps * steps), exp(-steps));
}
