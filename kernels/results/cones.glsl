// Solid angles of cones. Pure: no bindings. Needs arcs.glsl.
// SPDX-License-Identifier: BSD-3-Clause

/// The angle of this cosine, in [0, pi].
float angle_of_cosine(float cosine) {
  const float c = clamp(cosine, -1.0, 1.0);
  return angle_of(c, sqrt((1.0 - c) * (1.0 + c)));
}

/// The solid angle that two cones with one apex share, by the cosines of their half-angles, which are at most a right
/// angle, and of the angle between their axes. It is exact: the area of the intersection of two spherical caps, the two
/// sectors less the two spherical triangles between centres and corners (Oat and Sander, "Ambient Aperture Lighting",
/// 2007, give the same area and then approximate it).
float shared_solid_angle(float cos_a, float cos_b, float cos_between) {
  const float a = angle_of_cosine(cos_a);
  const float b = angle_of_cosine(cos_b);
  const float between = angle_of_cosine(cos_between);
  if (between >= a + b) return 0.0;
  if (between <= abs(a - b)) return 2.0 * kPi * (1.0 - max(cos_a, cos_b));  // the narrower one lies in the wider
  const float sin_a = sqrt((1.0 - cos_a) * (1.0 + cos_a));
  const float sin_b = sqrt((1.0 - cos_b) * (1.0 + cos_b));
  const float sin_between = sqrt((1.0 - cos_between) * (1.0 + cos_between));
  const float corner = angle_of_cosine((cos_between - cos_a * cos_b) / (sin_a * sin_b));
  const float at_a = angle_of_cosine((cos_b - cos_between * cos_a) / (sin_between * sin_a));
  const float at_b = angle_of_cosine((cos_a - cos_between * cos_b) / (sin_between * sin_b));
  return max(0.0, 2.0 * (kPi - corner - at_a * cos_a - at_b * cos_b));
}
