// The moments of directions: what a surface sees of its surroundings, up to second order. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Of a cosine-weighted set of directions w, (1 / pi) Integral of max(0, n.w) f(w) dw with f of first order x, y, z, in
// column 0, and of second order 2xy, 2yz, 2zx, in column 1, and x^2 - y^2, (3 z^2 - 1) / 2, in column 2. With its AO
// they are the nine products with the real spherical harmonics up to l = 2, each over a constant: see transfer.comp.
//
// Estimators hold those of what is blocked, as filters do: so filters blur no normal, and a pixel that nothing blocks
// keeps those of its own open hemisphere.

/// The planes that are kept: of first order 3, of second order 8.
const int kMostMoments = 8;
int moments_in(uint order) { return order == 0u ? 0 : order == 1u ? 3 : kMostMoments; }
float moment(mat3 moments, int k) { return moments[k / 3][k % 3]; }

/// The forms of second order of a dyad a b, made symmetric.
mat3 second_order(vec3 a, vec3 b) {
  const vec3 d = a * b;
  return mat3(vec3(0), a * b.yzx + a.yzx * b, vec3(d.x - d.y, d.z - 0.5 * (d.x + d.y), 0));
}

/// The moments of arcs, see arc_moments.glsl: the arc and the first order in the first column, the second order in the
/// second one. across, toward: T and V.
mat3 moments_of(mat2x3 arcs, vec3 across, vec3 toward) {
  const float mixed = arcs[1].x, along = arcs[1].y;
  mat3 moments =
      second_order(across, (arcs[0].x - along) * across + 2.0 * mixed * toward) + second_order(toward, along * toward);
  moments[0] = arcs[0].y * across + arcs[0].z * toward;
  return moments;
}

/// Turns moments, by a rotation.
mat3 turned(mat3 rotation, mat3 moments) {
  const vec3 mixed = 0.5 * moments[1];
  const float zz = 2.0 / 3.0 * moments[2].y, difference = 0.5 * moments[2].x;
  const mat3 dyads =
      mat3(difference - 0.5 * zz, mixed.x, mixed.z, mixed.x, -difference - 0.5 * zz, mixed.y, mixed.z, mixed.y, zz);
  const mat3 r = rotation * dyads * transpose(rotation);
  return mat3(rotation * moments[0], 2.0 * vec3(r[0].y, r[1].z, r[2].x), vec3(r[0].x - r[1].y, 1.5 * r[2].z, 0));
}

/// The moments of an open hemisphere, whichever slices are drawn.
mat3 open_moments(vec3 normal) {
  mat3 moments = 0.25 * second_order(normal, normal);
  moments[0] = 2.0 / 3.0 * normal;
  return moments;
}

/// A moment of what is blocked as it is stored. It lies in [0, 1], so that filters of visibility take it as it is.
/// Nothing blocked: 1/2.
float stored_moment(float blocked) { return 0.5 - 0.5 * blocked; }
float blocked_moment(float stored) { return 1.0 - 2.0 * stored; }
