// Smooths the visibility along one axis, over each surface by itself; rows, then columns, make the separable filter.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of visibility, depth, normals.
// Out: as many planes. What is constant stays exactly constant; sky stays 1 and is never mixed in.
//
// Tomasi and Manduchi, "Bilateral Filtering for Gray and Color Images", 1998, with the distance from the other pixel's
// tangent plane in the place of colour. Two pixels mix as far as each lies in the plane of the other, which sees edges,
// steps and creases alike and leaves a plane whole at every tilt. The weight is max(0, 1 - (h / sigma)^2), where h is
// the larger of both distances, in pixels' widths there. It is the same for both pixels, so it is computed once per
// pair.
//
// Where one pixel of `stride` has an estimate, rows give every pixel the mean of those in reach and how much they weigh
// together, by which columns then weigh the rows. One invocation computes a run of pixels, so that neighbours share
// what they load.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "denoise.h"
#include "view.glsl"
#include "normal.glsl"
#include "stride.glsl"
#include "tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kDenoiseRadiusId) const int kRadius = 3;
layout(constant_id = kDenoiseByDepthId) const uint kByDepth = 0;
layout(constant_id = kDenoiseSparseId) const uint kMode = kDenoiseDense;
layout(constant_id = kDenoiseStrideId) const int kStride = 1;
layout(constant_id = kDenoisePlanesId) const int kPlanes = 1;
const uint kSparse = kMode & ~kDenoiseListed;
const bool kListed = (kMode & kDenoiseListed) != 0u;
layout(scalar, push_constant) uniform Push { DenoiseParams params; };
layout(scalar, binding = kDenoiseAo) readonly buffer Ao { uint ao[]; };
layout(scalar, binding = kDenoiseDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kDenoiseNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kDenoiseResult) writeonly buffer Result { uint result[]; };
layout(scalar, binding = kDenoiseList) readonly buffer List { uint list[]; };
layout(scalar, binding = kDenoiseCounts) readonly buffer Counts { RunCounts counts; };

/// Two pixels do not mix when one lies further from the plane of the other than this many pixels are wide there.
const float kPlaneSigma = 1.0;

/// Pixels without an estimate of their own need some: where nothing alike is in reach, they get what is least unlike,
/// for it weighs this over its height squared.
const float kLeastSimilarity = 1e-4;

/// Pixels that one invocation looks at.
const int kCount = kDenoiseRun + 2 * kRadius;

struct Tap {
  float weight, z;
  float scale;  // scene units per unit of tangent_of(): z, or 1 where the view is orthographic
  // height above this tap's plane, in sigmas, of what is a unit further away, and a pixel along the axis at scale 1
  float ahead, across;
};

/// The mean of a row, and how much its pixels weigh together: what rows hand to columns where the estimate is sparse.
uint pack_mean(float mean, float weight) { return packUnorm2x16(vec2(mean, sqrt(weight))); }

float square(float x) { return x * x; }

/// Whether tap i of a run has an estimate.
bool is_known(int i) { return (i + (kStride - 1) * kRadius) % kStride == 0; }

/// What lies outside the image is as sky: infinitely far from every plane.
Tap load(ivec2 pixel, bool has_ao) {
  const bool known = inside(params.view, pixel);
  const ivec2 nearest = clamp(pixel, ivec2(0), params.view.size - 1);
  const int index = index_of(params.view, nearest);
  Tap tap = Tap(0.0, known ? depth[index] : kSkyDepth, 1.0, kSkyDepth, 0.0);
  if (has_ao) tap.weight = kSparse == kDenoiseSparseColumns ? square(unpackUnorm2x16(ao[index]).y) : 1.0;
  if (kByDepth != 0) return tap;
  const bool perspective = params.view.orthographic == 0;
  tap.scale = perspective ? tap.z : 1.0;
  const vec3 n = unpack_normal(normal[index]);
  const vec2 pixel_step = vec2(params.axis) * params.view.tangent_per_pixel;
  const vec2 tangent = tangent_of(params.view, vec2(nearest) + 0.5);
  const float sigmas = 1.0 / (kPlaneSigma * (abs(pixel_step.x) + abs(pixel_step.y)) * tap.scale);
  if (tap.z < kSkyDepth) tap.ahead = (perspective ? dot(n.xy, tangent) - n.z : -n.z) * sigmas;
  tap.across = dot(n.xy, pixel_step) * sigmas;
  return tap;
}

/// What a pixel holds in the plane that begins at this index. Outside 0, since 0 times what was never written may not
/// be 0.
float value_at(ivec2 pixel, int plane) {
  const uint word = ao[plane + index_of(params.view, clamp(pixel, ivec2(0), params.view.size - 1))];
  const float value = kSparse == kDenoiseSparseColumns ? unpackUnorm2x16(word).x : uintBitsToFloat(word);
  return inside(params.view, pixel) ? value : 0.0;
}

/// How far two taps mix that lie this many pixels apart.
float similarity(Tap a, Tap b, float pixels) {
  const float further = b.z - a.z;
  if (kByDepth != 0) return exp(-abs(further) / (params.depth_sigma * min(a.z, b.z)));
  const float above_a = a.ahead * further + a.across * pixels * b.scale;
  const float above_b = b.ahead * further + b.across * pixels * a.scale;
  const float above_sq = max(above_a * above_a, above_b * above_b);
  return max(kSparse == kDenoiseDense ? 0.0 : kLeastSimilarity / (1.0 + above_sq), 1.0 - above_sq);
}

void main() {
  const uint at = (gl_WorkGroupID.y * kListedRow + gl_WorkGroupID.x) * kGroupY + gl_LocalInvocationID.y;
  if (kListed && at >= counts.listed) return;
  const ivec2 run = kListed ? unpack_run(list[at]) : ivec2(gl_WorkGroupID.x, gl_GlobalInvocationID.y);
  // Runs of a sparse estimate begin where it has a pixel.
  const int line = run.x * int(kGroupX) + int(gl_LocalInvocationID.x);
  const int known = first_estimated(line, params.origin, kStride);
  const ivec2 first = line * params.axis.yx + (kDenoiseRun * run.y + known - (known > 0 ? kStride : 0)) * params.axis;
  if (any(greaterThanEqual(first, params.view.size))) return;

  const int plane = params.view.size.x * params.view.size.y;
  Tap taps[kCount];
  float whole[kCount], values[kPlanes * kCount], change[kPlanes * kCount];  // plane by plane
  for (int i = 0; i < kCount; i++) {
    const ivec2 here = first + (i - kRadius) * params.axis;
    taps[i] = load(here, is_known(i));
    whole[i] = params.weight[0] * taps[i].weight;
    for (int p = 0; p < kPlanes; p++) {
      // What has no estimate may hold anything, NaN too, which no weight of 0 takes away.
      const float value = is_known(i) && inside(params.view, here) ? value_at(here, p * plane) : 0.0;
      values[p * kCount + i] = value;
      change[p * kCount + i] = kSparse == kDenoiseSparseRows ? whole[i] * value : 0.0;
    }
    for (int apart = 1; apart <= kRadius; apart++) {
      const int j = i - apart;
      if (j < 0 || i < kRadius || j >= kDenoiseRun + kRadius || !(is_known(i) || is_known(j))) continue;
      const float weight = params.weight[apart] * similarity(taps[j], taps[i], float(apart));
      const float to_j = weight * taps[i].weight;
      const float to_i = weight * taps[j].weight;
      // Changes of a pixel's own visibility, so that what is constant stays so to the bit; in sparse rows, which have
      // none, of 0.
      for (int p = 0; p < kPlanes * kCount; p += kCount) {
        change[p + j] += to_j * (kSparse == kDenoiseSparseRows ? values[p + i] : values[p + i] - values[p + j]);
        change[p + i] += to_i * (kSparse == kDenoiseSparseRows ? values[p + j] : values[p + j] - values[p + i]);
      }
      whole[j] += to_j;
      whole[i] += to_i;
    }
    const int done = i - kRadius;
    const ivec2 pixel = first + (done - kRadius) * params.axis;
    if (done < kRadius || !inside(params.view, pixel)) continue;
    for (int p = 0; p < kPlanes; p++) {
      const float own = kSparse == kDenoiseSparseRows ? 0.0 : values[p * kCount + done];
      const float mean = taps[done].z < kSkyDepth && whole[done] > 0.0
                             ? clamp(own + change[p * kCount + done] / whole[done], 0.0, 1.0)
                             : 1.0;
      result[index_of(params.view, pixel) + p * plane] =
          kSparse == kDenoiseSparseRows ? pack_mean(mean, whole[done]) : floatBitsToUint(mean);
    }
  }
}
