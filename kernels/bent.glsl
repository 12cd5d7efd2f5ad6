// The bent normal of a slice. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// On one side of a slice, theta is the angle from the view ray V towards that side's tangent T, gamma that of the
// projected normal. The integral of cos(theta - gamma) sin(theta) (sin(theta), cos(theta)) over the angles that are
// open, along T and V, times the length of the normal's projection, is what the side adds to the mean open direction.
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, in closed form; the tests hold
// it to quadrature. Any set of intervals is a sum of differences of bent_to(). Nothing blocked: 2/3 of the normal, on
// the mean over all slices.

/// The integral from the view ray to the angle of (cosine, sine), in [0, pi].
vec2 bent_to(float cosine, float sine, float cos_gamma, float sin_gamma) {
  const float cubed = sine * sine * sine, below = 1.0f - cosine;
  const float across = cos_gamma * cubed + sin_gamma * below * below * (2.0f + cosine);
  const float toward = cos_gamma * below * (1.0f + cosine + cosine * cosine) + sin_gamma * cubed;
  return vec2(across / 3.0f, toward / 3.0f);
}

/// The angle up to which a side's arc integral, down to the tangent plane at `whole` = gamma + pi/2, comes to this
/// share; error below 0.002 rad from 1/64 to 63/64.
float angle_of_share(float share, float whole, float cos_gamma, float sin_gamma) {
  const float end = cos_gamma + whole * sin_gamma;
  float theta = whole * acos(1.0f - 2.0f * share) / 3.14159265f;  // exact where gamma is 0
  for (int i = 0; i < 3; i++) {                                   // Newton's method
    const float sine = sin(theta);
    const float cosine = cos(theta);
    const float slope = 2.0f * sine * (cos_gamma * cosine + sin_gamma * sine);
    const float excess = cos_gamma * sine * sine + sin_gamma * (theta - sine * cosine) - share * end;
    theta = clamp(theta - excess / max(slope, 1e-3f), 0.0f, whole);
  }
  return theta;
}
