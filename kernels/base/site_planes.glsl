// What is kept of sites between passes. Pure: no bindings; to be included after likeness.glsl.
// SPDX-License-Identifier: BSD-3-Clause

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
