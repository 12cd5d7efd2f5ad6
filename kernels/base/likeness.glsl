// How far two pixels show one surface, so that what is known at one tells something of the other. Pure: no bindings;
// to be included after view.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// Sites, blocks and the filters at full resolution share this measure: Tomasi and Manduchi, "Bilateral Filtering for
// Gray and Color Images", 1998, with the distance from the other pixel's tangent plane in the place of colour. It sees
// steps, and leaves a plane whole at every tilt. Along a crease pixels lie in both planes; there the normals differ.
// Normals that are mapped, coarse or reconstructed count as they are.
//
// The search asks another question, which pixels are one solid (kernels/estimate/solids.glsl): an edge joins them
// there, and two parallel faces before each other are two however near they are.

/// Pixels without an estimate of their own need some: where nothing is alike, what is least unlike counts so much, over
/// 1 and its height squared.
const float kLeastSimilarity = 1e-4;

/// A pixel's plane, by the height of others above it. Heights are in widths of the pixel: the mean of both axes.
struct Plane {
  float z;      // planar depth of the pixel
  float scale;  // scene units per unit of tangent_of(): z, or 1 where the view is orthographic, and of sky
  float ahead;  // height of a point that lies a unit further away
  vec2 across;  // height of a point a pixel to the right, or below, at scale 1
  vec3 n;
};

float width_at(View view, float scale) {
  return 0.5 * (abs(view.tangent_per_pixel.x) + abs(view.tangent_per_pixel.y)) * scale;
}

/// Sky is infinitely far from every plane. It keeps a scale of 1: with that of its depth, what is across a small
/// surface would overflow.
Plane plane_of(View view, ivec2 pixel, float z, vec3 n) {
  const bool perspective = view.orthographic == 0, known = z < kSkyDepth;
  const float scale = perspective && known ? z : 1.0, per_width = 1.0 / width_at(view, scale);
  const float toward = perspective ? dot(n.xy, tangent_of(view, vec2(pixel) + 0.5)) : 0.0;
  return Plane(z, scale, known ? (toward - n.z) * per_width : kSkyDepth, n.xy * view.tangent_per_pixel * per_width, n);
}

/// The square of how far two pixels lie from each other's planes, the larger of both, in pixels' widths. px: from a
/// to b. Unrolled, each pixel of a run has products of its own that a driver may order in its own way; but the bits of
/// a pixel must not depend on where runs begin.
float apart_sq(Plane a, Plane b, vec2 px) {
  const float further = b.z - a.z;
  precise const float above_a = a.ahead * further + (a.across.x * px.x + a.across.y * px.y) * b.scale;
  precise const float above_b = b.ahead * further + (b.across.x * px.x + b.across.y * px.y) * a.scale;
  precise const float most = greater(above_a * above_a, above_b * above_b);
  return most;
}

/// The part of a pixel's weight that counts for another one: none where one lies a pixel's width off the other's
/// plane, or where their normals are at right angles. least: 0, or kLeastSimilarity.
float similarity(Plane a, Plane b, vec2 px, float least) {
  const float apart = apart_sq(a, b, px);
  precise const float alike = a.n.x * b.n.x + a.n.y * b.n.y + a.n.z * b.n.z - apart;
  return greater(least / (1.0 + apart), alike);
}

/// The same by depth alone, in parts of it: a setting of the user's.
float similarity_of_depths(Plane a, Plane b, float sigma, float least) {
  const float steps = abs(b.z - a.z) / (sigma * min(a.z, b.z));
  return max(least / (1.0 + steps * steps), exp(-steps));
}

/// A site's plane, which is read too often to be made anew. A unit normal's z follows from its x and y, and a sign,
/// which that of the depth keeps.
vec4 pack_plane(Plane plane) { return vec4(plane.n.z < 0.0 ? -plane.z : plane.z, plane.ahead, plane.n.xy); }
Plane unpack_plane(View view, vec4 packed) {
  const vec2 xy = packed.zw;
  const float z = abs(packed.x), scale = view.orthographic == 0 ? z : 1.0, up = sqrt(max(1.0 - dot(xy, xy), 0.0));
  const vec3 n = vec3(xy, packed.x < 0.0 ? -up : up);
  return Plane(z, scale, packed.y, xy * (view.tangent_per_pixel / width_at(view, scale)), n);
}

/// What is blocked at a site, and by how much that grows per pixel to the right and below: see fit_blocks.comp.
uvec2 pack_fit(vec3 fit) { return uvec2(floatBitsToUint(fit.x), packHalf2x16(fit.yz)); }
vec3 unpack_fit(uint blocked, uint slopes) { return vec3(uintBitsToFloat(blocked), unpackHalf2x16(slopes)); }
