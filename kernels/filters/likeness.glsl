// How far two pixels on a line of the image show one surface, for the filters along it.
// SPDX-License-Identifier: BSD-3-Clause
//
// Tomasi and Manduchi, "Bilateral Filtering for Gray and Color Images", 1998, with the distance from the other pixel's
// tangent plane in the place of colour. Two pixels mix as far as each lies in the plane of the other, which sees edges,
// steps and creases alike and leaves a plane whole at every tilt. The weight is max(0, 1 - (h / sigma)^2), where h is
// the larger of both distances, in pixels' widths there.
//
// The kernel has declared its parameters, with the members view, axis and depth_sigma, kByDepth, and the buffers
// `depth` and `normal`.

/// Two pixels do not mix when one lies further from the plane of the other than this many pixels are wide there.
const float kPlaneSigma = 1.0;

/// Pixels without an estimate of their own need some: where nothing alike is in reach, they get what is least unlike,
/// for it weighs this over its height squared.
const float kLeastSimilarity = 1e-4;

struct Tap {
  float z;
  float scale;  // scene units per unit of tangent_of(): z, or 1 where the view is orthographic, and of sky
  // height above this tap's plane, in sigmas, of what is a unit further away, and a pixel along the axis at scale 1
  float ahead, across;
};

/// A pixel outside the image is as sky: infinitely far from every plane.
Tap tap_at(ivec2 pixel) {
  const bool known = inside(params.view, pixel);
  const ivec2 nearest = clamp(pixel, ivec2(0), params.view.size - 1);
  const int index = index_of(params.view, nearest);
  Tap tap = Tap(known ? depth[index] : kSkyDepth, 1.0, kSkyDepth, 0.0);
  if (kByDepth != 0) return tap;
  const bool perspective = params.view.orthographic == 0;
  // Sky keeps a scale of 1: times that of its depth, what is across a small surface would overflow.
  tap.scale = perspective && tap.z < kSkyDepth ? tap.z : 1.0;
  const vec3 n = unpack_normal(normal[index]);
  const vec2 pixel_step = vec2(params.axis) * params.view.tangent_per_pixel;
  const vec2 tangent = tangent_of(params.view, vec2(nearest) + 0.5);
  const float sigmas = 1.0 / (kPlaneSigma * (abs(pixel_step.x) + abs(pixel_step.y)) * tap.scale);
  if (tap.z < kSkyDepth) tap.ahead = (perspective ? dot(n.xy, tangent) - n.z : -n.z) * sigmas;
  tap.across = dot(n.xy, pixel_step) * sigmas;
  return tap;
}

/// The weight with which two taps mix that lie this many pixels apart. least: of pixels that must get something.
float similarity(Tap a, Tap b, float pixels, float least) {
  const float further = b.z - a.z;
  if (kByDepth != 0) {
    const float steps = abs(further) / (params.depth_sigma * min(a.z, b.z));
    return max(least / (1.0 + steps * steps), exp(-steps));
  }
  // Unrolled, each pixel of a run has a product of its own that a driver may order in its own way; but the bits of a
  // pixel must not depend on where runs begin.
  precise const float above_a = a.ahead * further + a.across * pixels * b.scale;
  precise const float above_b = b.ahead * further + b.across * pixels * a.scale;
  precise const float above_sq = greater(above_a * above_a, above_b * above_b);
  return greater(least / (1.0 + above_sq), 1.0 - above_sq);
}
