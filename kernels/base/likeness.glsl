// How far two pixels show one surface, so that what is known at one tells something of the other. Pure: no bindings;
// to be included after view.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// Sites, blocks and filters share this measure: Tomasi and Manduchi, "Bilateral Filtering for Gray and Color Images",
// 1998, with the distance from the other pixel's tangent plane in the place of colour, which sees edges and steps
// alike and leaves a plane whole at every tilt. Along a crease pixels lie in both planes; there the normals differ.
// Normals that are mapped, coarse or reconstructed count as they are: 8 bits bend a plane by less than a hundredth.
//
// The search asks another question, which pixels are one solid (kernels/estimate/solids.glsl): an edge joins them
// there, and two parallel faces before each other are two however near they are.

/// A pixel's plane, by the height of others above it, in pixels' widths.
struct Plane {
  float z;      // planar depth of the pixel
  float scale;  // scene units per unit of tangent_of(): z, or 1 where the view is orthographic, and of sky
  float ahead;  // height of what is a unit further away
  vec2 across;  // height of what is a pixel to the right, or below, at scale 1
  vec3 n;
};

/// Sky is infinitely far from every plane. It keeps a scale of 1: times that of its depth, what is across a small
/// surface would overflow.
Plane plane_of(View view, ivec2 pixel, float z, vec3 n) {
  const bool perspective = view.orthographic == 0, known = z < kSkyDepth;
  const float scale = perspective && known ? z : 1.0;
  const float per_width = 1.0 / (abs(view.tangent_per_pixel.x) * scale);
  const float toward = perspective ? dot(n.xy, tangent_of(view, vec2(pixel) + 0.5)) : 0.0;
  return Plane(z, scale, known ? (toward - n.z) * per_width : kSkyDepth, n.xy * view.tangent_per_pixel * per_width, n);
}

/// The square of how far two pixels lie from each other's planes, the larger of both, in pixels' widths. px: from a
/// to b. Unrolled, each pixel of a run has a product of its own that a driver may order in its own way; but the bits
/// of a pixel must not depend on where runs begin.
float apart_sq(Plane a, Plane b, vec2 px) {
  const float further = b.z - a.z;
  precise const float above_a = a.ahead * further + dot(a.across, px) * b.scale;
  precise const float above_b = b.ahead * further + dot(b.across, px) * a.scale;
  return greater(above_a * above_a, above_b * above_b);
}

/// The part of a pixel's weight that counts for another one: none where one lies a pixel's width off the other's
/// plane, or where their normals are at right angles. least: of pixels that must get something: where nothing is
/// alike, what is least unlike weighs this over its height squared.
float similarity(Plane a, Plane b, vec2 px, float least) {
  const float apart = apart_sq(a, b, px);
  precise const float alike = dot(a.n, b.n) - apart;
  return greater(least / (1.0 + apart), alike);
}
