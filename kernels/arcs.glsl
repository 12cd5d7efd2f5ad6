// The integrals of a slice through the hemisphere, and the angles they need. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016: a slice is the plane of the
// direction V to the eye and a tangent T; angles are measured from V; gamma is the angle of the normal projected into it.

const float kHalfPi = 1.57079632679489662;
const float kPi = 3.14159265358979324;

/// acos for x in [-1, 1], error below 6.8e-5 rad (Abramowitz & Stegun 4.4.45). Ours, so that all devices agree.
float arc_cosine(float x) {
  const float a = min(abs(x), 1.0);
  const float r = sqrt(1.0 - a) * (((-0.0187293 * a + 0.0742610) * a - 0.2121144) * a + 1.5707288);
  return x >= 0.0 ? r : kPi - r;
}

/// The angle of the direction (cosine, sine), in [-pi, pi], error below 1.2e-5 rad (Abramowitz & Stegun 4.4.49).
float angle_of(float cosine, float sine) {
  const float c = abs(cosine), s = abs(sine);
  const float r = min(c, s) / max(max(c, s), 1e-30), q = r * r;
  float a = r * ((((0.0208351 * q - 0.0851330) * q + 0.1801410) * q - 0.3302995) * q + 0.9998660);
  if (s > c) a = kHalfPi - a;
  if (cosine < 0.0) a = kPi - a;
  return sine < 0.0 ? -a : a;
}

/// Integral of cos(theta - gamma) |sin(theta)| over theta from 0 to h, for h in [0, pi], given cos h as well:
/// (sin^2 h cos gamma + (h - sin h cos h) sin gamma) / 2, which is equation 7 of the paper rearranged.
float arc(float h, float cos_h, float cos_gamma, float sin_gamma) {
  const float sin_h = sqrt(max(0.0, 1.0 - cos_h * cos_h));
  return 0.5 * (sin_h * sin_h * cos_gamma + (h - sin_h * cos_h) * sin_gamma);
}
