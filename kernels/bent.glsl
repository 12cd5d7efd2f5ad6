// The bent normal of a slice. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

/// Integral of cos(theta - gamma) |sin(theta)| (sin(theta), cos(theta)) over theta from h0 to h1, for h0 in [gamma - pi/2, 0] and h1 in
/// [0, gamma + pi/2]: what the open part of a slice adds to the mean open direction, along its tangent T and along V; the slice's weight is the
/// length of the normal's projection. Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, in closed form; the tests
/// hold it to quadrature. Nothing blocked: 2/3 of the normal, on the mean over all slices.
vec2 bent_arc(float h0, float h1, float gamma) {
  const float across = 6.0 * (sin(h0 - gamma) + sin(h1 - gamma)) - sin(3.0 * h0 - gamma) - sin(3.0 * h1 - gamma) + 16.0 * sin(gamma) -
                       3.0 * (sin(h0 + gamma) + sin(h1 + gamma));
  const float toward = 8.0 * cos(gamma) - cos(3.0 * h0 - gamma) - cos(3.0 * h1 - gamma) - 3.0 * (cos(h0 + gamma) + cos(h1 + gamma));
  return vec2(across / 12.0, toward / 12.0);
}
