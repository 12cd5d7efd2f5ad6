// Packs unit vectors into 32 bits: the octahedral map, 16 bits per coordinate, within 4e-5 rad. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", 2014 (oct32). A normal takes
// one word instead of three floats, since what a kernel costs is mostly its loads and stores.

/// No direction packs to this.
const uint kNoNormal = 0x80008000u;

uint pack_normal(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  if (n.z < 0.0) p = (1.0 - abs(p.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(p, vec2(0)));
  return packSnorm2x16(p);
}

/// A vector of any length in the direction that the map holds at p.
vec3 octahedral_direction(vec2 p) {
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  const vec2 folded = (1.0 - abs(n.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(n.xy, vec2(0)));
  return vec3(mix(n.xy, folded, bvec2(n.z < 0.0)), n.z);
}

vec3 unpack_normal(uint word) { return normalize(octahedral_direction(unpackSnorm2x16(word))); }

/// Normals are turned to the eye by at least this cosine. Were it smaller, the slices at grazing angles would
/// lose their weight to rounding.
const float kLeastFacing = 1e-3;

/// A normal is the opposite of its surface's if its cosines to the eye and to the normal by depth add up to less than
/// this. Shading normals that lean away at grazing angles stay above it, as they are near the normal by depth. Where
/// depth gives none, the eye stands in for it, and leaning by 15 degrees is enough.
const float kOpposite = -0.5;

/// Whether a normal belongs to the other side of the surface that is seen, as on mirrored things and on the backs of
/// cards. `surface` is the unit normal by depth, and faces the eye.
bool is_opposite(vec3 n, vec3 eye, vec3 surface) { return dot(n, eye) + dot(n, surface) < kOpposite; }

/// A shading normal that leans away is bent back just far enough.
vec3 facing(vec3 n, vec3 eye) {
  const float cosine = dot(n, eye);
  return cosine < kLeastFacing ? normalize(n + (kLeastFacing - cosine) * eye) : n;
}
