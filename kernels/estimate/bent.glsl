// The bent normal of a slice. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// On one side of a slice, theta is the angle from the view ray V towards that side's tangent T, gamma that of the
// projected normal. The integral of cos(theta - gamma) sin(theta) (sin(theta), cos(theta)) over the angles that are
// open, along T and V, times the length of the normal's projection, is what the side adds to the mean open direction.
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, have it in closed form
// (equations 20 and 21 of the edition of 2019); here in powers of cosine and sine. The tests hold it to quadrature. Any
// set of intervals is a sum of differences of bent_to(). Nothing blocked: 2/3 of the normal, on the mean over all
// slices.

/// The integral from the view ray to the angle of (cosine, sine), in [0, pi].
vec2 bent_to(float cosine, float sine, float cos_gamma, float sin_gamma) {
  const float cubed = sine * sine * sine, below = 1.0f - cosine;
  const float across = cos_gamma * cubed + sin_gamma * below * below * (2.0f + cosine);
  const float toward = cos_gamma * below * (1.0f + cosine + cosine * cosine) + sin_gamma * cubed;
  return vec2(across / 3.0f, toward / 3.0f);
}
