// Smooths the visibility along one axis, over each surface by itself; rows, then columns, make the separable filter.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of visibility, depth, normals.
// Out: as many planes. What is constant stays exactly constant; sky stays 1 and is never mixed in.
//
// The steps have their numbers at the code:
//  1. Two pixels mix as far as they show one surface (likeness.glsl), times the kernel's weight at their distance. That
//     is the same for both of them, so it is computed once per pair.
//  2. A pair moves both visibilities towards each other. Sums are of differences, so that what is constant stays so.
//  3. A pixel moves by the mean of its differences.
// Where only sites have an estimate, `interpolate` runs instead. One invocation computes a run of pixels, so that
// neighbours share what they load.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/filters/filters.h"
#include "kernels/base/view.glsl"
#include "kernels/base/likeness.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kRadius = 3;    // pixels to each side, 1 to 8
layout(constant_id = 1) const uint kByDepth = 0;  // 1: weighs by depth_sigma, not by planes and normals
layout(constant_id = 2) const int kPlanes = 1;    // how many planes; they share their weights
layout(scalar, push_constant) uniform Push { DenoiseParams params; };
readonly buffer Ao { float ao[]; };           // planes of floats in [0, 1], visibility or the like; each by itself
readonly buffer Depth { float depth[]; };     // one float per pixel, of the G-buffer of that visibility
readonly buffer Normal { uint normal[]; };    // one uint per pixel, of the same; not read with a depth sigma
writeonly buffer Result { float result[]; };  // as many planes, in [0, 1]

const bool kReadsNormals = kByDepth == 0u;
#include "kernels/base/plane_at.glsl"

/// Pixels that one invocation looks at.
const int kCount = kDenoiseRun + 2 * kRadius;

/// A pixel's value in the plane that begins at this index; outside 0, since 0 times what was never written may not
/// be 0.
float value_at(ivec2 pixel, int plane) {
  const float value = ao[plane + index_of(params.view, clamp(pixel, ivec2(0), params.view.size - 1))];
  return inside(params.view, pixel) ? value : 0.0;
}

void main() {
  const ivec2 line_and_run = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 first = line_and_run.x * params.axis.yx + kDenoiseRun * line_and_run.y * params.axis;
  if (any(greaterThanEqual(first, params.view.size))) return;

  const int plane = params.view.size.x * params.view.size.y;
  Plane planes[kCount];
  float whole[kCount], values[kPlanes * kCount], change[kPlanes * kCount];  // plane by plane
  for (int i = 0; i < kCount; i++) {
    const ivec2 here = first + (i - kRadius) * params.axis;
    planes[i] = plane_at(params.view, here);
    whole[i] = params.weight[0];
    for (int p = 0; p < kPlanes; p++) {
      values[p * kCount + i] = value_at(here, p * plane);
      change[p * kCount + i] = 0.0;
    }
    for (int apart = 1; apart <= kRadius; apart++) {
      const int j = i - apart;
      if (j < 0 || i < kRadius || j >= kDenoiseRun + kRadius) continue;
      // 1.
      const float alike = kByDepth != 0u ? similarity_of_depths(planes[j], planes[i], params.depth_sigma, 0.0)
                                         : similarity(planes[j], planes[i], float(apart) * vec2(params.axis), 0.0);
      const float weight = params.weight[apart] * alike;
      // 2.
      for (int p = 0; p < kPlanes * kCount; p += kCount) {
        change[p + j] += weight * (values[p + i] - values[p + j]);
        change[p + i] += weight * (values[p + j] - values[p + i]);
      }
      whole[j] += weight;
      whole[i] += weight;
    }
    const int done = i - kRadius;
    const ivec2 pixel = first + (done - kRadius) * params.axis;
    if (done < kRadius || !inside(params.view, pixel)) continue;
    // 3.
    for (int p = 0; p < kPlanes; p++) {
      const float own = values[p * kCount + done];
      result[index_of(params.view, pixel) + p * plane] =
          planes[done].z < kSkyDepth ? clamp(own + change[p * kCount + done] / whole[done], 0.0, 1.0) : 1.0;
    }
  }
}
