// Angles for the integrals of a slice through the hemisphere. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016: a slice is the plane of the
// direction V to the eye and a tangent T; angles are measured from V; gamma is the angle of the normal projected into
// it.

const float kHalfPi = 1.57079632679489662;
const float kPi = 3.14159265358979324;

/// Cosine and sine of an angle in [0, pi], error below 2e-7, by their series about pi / 2. Vulkan lets a driver's own
/// err by 5e-4, and a direction that errs takes samples of other pixels.
vec2 direction_of(float angle) {
  const float a = kHalfPi - angle, q = a * a;
  const float odd =
      q * (1.6666667e-1 - q * (8.3333333e-3 - q * (1.9841270e-4 - q * (2.7557319e-6 - q * 2.5052108e-8))));
  const float even = q * (0.5 - q * (4.1666667e-2 - q * (1.3888889e-3 - q * (2.4801587e-5 - q * 2.7557319e-7))));
  return vec2(a - a * odd, 1.0 - even);
}

/// The angle of the direction (cosine, sine), in [-pi, pi], error below 1.2e-5 rad (Abramowitz & Stegun 4.4.49).
float angle_of(float cosine, float sine) {
  const float c = abs(cosine), s = abs(sine);
  const float r = min(c, s) / max(max(c, s), 1e-30), q = r * r;
  float a = r * ((((0.0208351 * q - 0.0851330) * q + 0.1801410) * q - 0.3302995) * q + 0.9998660);
  a = mix(a, kHalfPi - a, s > c);
  a = mix(a, kPi - a, cosine < 0.0);
  return mix(a, -a, sine < 0.0);
}
