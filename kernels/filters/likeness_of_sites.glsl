// How far two pixels show one surface: likeness.glsl, with both axes of the image.
// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel has declared the buffers `depth` and `normal`.

struct Tap {
  float z, scale, ahead;
  vec2 across;
};

Tap tap_at(View view, ivec2 pixel) {
  const int index = index_of(view, pixel);
  Tap tap = Tap(depth[index], 1.0, kSkyDepth, vec2(0));
  const bool perspective = view.orthographic == 0;
  tap.scale = perspective ? tap.z : 1.0;
  const vec3 n = unpack_normal(normal[index]);
  const float sigmas = 1.0 / (abs(view.tangent_per_pixel.x) * tap.scale);
  if (tap.z < kSkyDepth)
    tap.ahead = ((perspective ? dot(n.xy, tangent_of(view, vec2(pixel) + 0.5)) : 0.0) - n.z) * sigmas;
  tap.across = n.xy * view.tangent_per_pixel * sigmas;
  return tap;
}

float similarity(Tap a, Tap b, vec2 pixels) {
  const float further = b.z - a.z;
  // Each site of a run has products of its own, see likeness.glsl.
  precise const float above_b = a.ahead * further + dot(a.across, pixels) * b.scale;
  precise const float above_a = b.ahead * further + dot(b.across, pixels) * a.scale;
  return greater(1.0 - greater(above_a * above_a, above_b * above_b), 0.0);
}
