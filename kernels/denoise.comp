// Smooths the visibility along one axis, over each surface by itself; rows, then columns, make the separable filter.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of visibility, depth, normals. Out: as many planes; constant stays exactly constant, sky stays 1 and is never mixed in.
// Tomasi & Manduchi, "Bilateral Filtering for Gray and Color Images", 1998, with the distance from the other pixel's tangent plane in the place of
// colour. Two pixels mix as far as each lies in the plane of the other, which sees edges, steps and creases alike and leaves a plane whole at every
// tilt: the weight is max(0, 1 - (h / sigma)^2), h the larger of both distances, in pixels' widths there. It is the same for both, so it is
// computed once for a pair. One invocation computes a run of pixels, so that neighbours share what they load.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "denoise.h"
#include "view.glsl"
#include "normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kDenoiseRadiusId) const int kRadius = 3;
layout(constant_id = kDenoiseByDepthId) const uint kByDepth = 0;
layout(constant_id = kDenoisePlanesId) const int kPlanes = 1;
layout(scalar, push_constant) uniform Push { DenoiseParams params; };
layout(scalar, binding = kDenoiseAo) readonly buffer Ao { float ao[]; };
layout(scalar, binding = kDenoiseDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kDenoiseNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kDenoiseResult) writeonly buffer Result { float result[]; };

/// Two pixels do not mix when one lies further from the plane of the other than this many pixels are wide there.
const float kPlaneSigma = 1.0;

/// Pixels that one invocation looks at.
const int kCount = kDenoiseRun + 2 * kRadius;

struct Tap {
  float z;
  float scale;          // scene units a unit of tangent_of(): z, or 1 where the view is orthographic
  float ahead, across;  // height above this tap's plane, in sigmas, of what is a unit further away, and a pixel along the axis at scale 1
};

/// What lies outside the image is as sky: infinitely far from every plane.
Tap load(ivec2 pixel) {
  const bool known = inside(params.view, pixel);
  const ivec2 nearest = clamp(pixel, ivec2(0), params.view.size - 1);
  const int index = index_of(params.view, nearest);
  Tap tap = Tap(known ? depth[index] : kSkyDepth, 1.0, kSkyDepth, 0.0);
  if (kByDepth != 0) return tap;
  const bool perspective = params.view.orthographic == 0;
  tap.scale = perspective ? tap.z : 1.0;
  const vec3 n = unpack_normal(normal[index]);
  const vec2 pixel_step = vec2(params.axis) * params.view.tangent_per_pixel, tangent = tangent_of(params.view, vec2(nearest) + 0.5);
  const float sigmas = 1.0 / (kPlaneSigma * (abs(pixel_step.x) + abs(pixel_step.y)) * tap.scale);
  if (tap.z < kSkyDepth) tap.ahead = (perspective ? dot(n.xy, tangent) - n.z : -n.z) * sigmas;
  tap.across = dot(n.xy, pixel_step) * sigmas;
  return tap;
}

/// How far two taps mix that lie this many pixels apart.
float similarity(Tap a, Tap b, float pixels) {
  const float further = b.z - a.z;
  if (kByDepth != 0) return exp(-abs(further) / (params.depth_sigma * min(a.z, b.z)));
  const float above_a = a.ahead * further + a.across * pixels * b.scale, above_b = b.ahead * further + b.across * pixels * a.scale;
  return max(0.0, 1.0 - max(above_a * above_a, above_b * above_b));
}

void main() {
  const ivec2 first = int(gl_GlobalInvocationID.x) * params.axis.yx + kDenoiseRun * int(gl_GlobalInvocationID.y) * params.axis;
  if (!inside(params.view, first)) return;

  const int plane = params.view.size.x * params.view.size.y;
  Tap taps[kCount];
  float whole[kCount], values[kPlanes * kCount], change[kPlanes * kCount];  // plane by plane
  for (int i = 0; i < kCount; i++) {
    const ivec2 here = first + (i - kRadius) * params.axis;
    taps[i] = load(here);
    for (int p = 0; p < kPlanes * kCount; p += kCount) {
      values[p + i] = ao[index_of(params.view, clamp(here, ivec2(0), params.view.size - 1)) + p / kCount * plane];
      change[p + i] = 0.0;
    }
    whole[i] = params.weight[0];
    for (int apart = 1; apart <= kRadius; apart++) {
      const int j = i - apart;
      if (j < 0 || i < kRadius || j >= kDenoiseRun + kRadius) continue;
      const float weight = params.weight[apart] * similarity(taps[j], taps[i], float(apart));
      for (int p = 0; p < kPlanes * kCount; p += kCount) {
        const float difference = weight * (values[p + i] - values[p + j]);
        change[p + j] += difference;
        change[p + i] -= difference;
      }
      whole[j] += weight;
      whole[i] += weight;
    }
    const int done = i - kRadius;
    const ivec2 pixel = first + (done - kRadius) * params.axis;
    if (done < kRadius || !inside(params.view, pixel)) continue;
    for (int p = 0; p < kPlanes * kCount; p += kCount)
      result[index_of(params.view, pixel) + p / kCount * plane] =
          taps[done].z < kSkyDepth ? clamp(values[p + done] + change[p + done] / whole[done], 0.0, 1.0) : 1.0;
  }
}
