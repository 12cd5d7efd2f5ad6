// The moments of the arcs of a slice. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// On one side of a slice, theta is the angle from the view ray V towards that side's tangent T, gamma that of the
// projected normal. The integrals of cos(theta - gamma) sin(theta) times (sin, cos)(theta), and times (sin cos,
// cos^2)(theta), over the angles that are blocked, times the length of the normal's projection, are what the side adds
// to the moments of first and second order along T and V; that of sin^2 is the arc's less that of cos^2. Jimenez et
// al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, have the first order in closed form
// (equations 20 and 21 of the edition of 2019); here in powers of cosine and sine. The tests hold them to quadrature.
// Any set of intervals is a sum of differences. Nothing blocked: first order is 2/3 of the normal, on the mean over all
// slices.

/// The integrals of first order from the view ray to the angle of (cosine, sine), in [0, pi].
vec2 first_to(float cosine, float sine, float cos_gamma, float sin_gamma) {
  const float cubed = sine * sine * sine, below = 1.0f - cosine;
  const float across = cos_gamma * cubed + sin_gamma * below * below * (2.0f + cosine);
  const float toward = cos_gamma * below * (1.0f + cosine + cosine * cosine) + sin_gamma * cubed;
  return vec2(across / 3.0f, toward / 3.0f);
}

/// Those of second order: of sin cos, and of cos^2.
vec2 second_to(float cosine, float sine, float angle, float cos_gamma, float sin_gamma) {
  const float squared = sine * sine;
  const float mixed = 0.125f * (angle - sine * cosine * (1.0f - 2.0f * squared));
  return vec2(cos_gamma * mixed + sin_gamma * 0.25f * squared * squared,
              cos_gamma * 0.25f * squared * (1.0f + cosine * cosine) + sin_gamma * mixed);
}
