// One pixel's estimate by slices that are searched on both sides: horizon.comp and bitmask.comp include it at their
// ends.
// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel has declared its buffers, constants and parameters, and two functions: `draw_of` gives the random numbers
// of a side, and `search` the blocked part of its integrals, and what of its arc
// completed surfaces block. The result is 1 - (sum of blocked arcs) / (sum of whole
// arcs).

void write_bent(int index, int plane, vec3 b) {
  for (int c = 0; c < 3; c++) bent[index + c * plane] = stored_bent(b)[c];
}

/// Writes the visibility of a pixel and, where it is asked for, its mean open direction.
void estimate(ivec2 pixel) {
  const View view = params.view;
  const int index = index_of(view, pixel);
  const int plane = view.size.x * view.size.y;
  const int ao_index = index + int(params.plane) * plane;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[ao_index] = 1.0;
    if (kTellsCompleted) completed[index] = 0.0;
    if (kBent) write_bent(index, plane, vec3(0));
    return;
  }
  const Receiver r = receiver_at(view, pixel, z, unpack_normal(normal[index]), params.radius, params.depth_precision);
  const Reach reach = reach_of(view, params.radius, params.falloff_start, params.thickness, params.bias);
  const vec2 noise = pixel_noise(pixel + params.noise_origin, params.noise_shift);
  float blocked = 0.0;
  float whole = 0.0;
  float completed_arcs = 0.0;
  vec3 bent_blocked = vec3(0);
  for (uint s = 0u; s < kSlices; s++) {
    const Slice slice = slice_at(view, r, s, kSlices, noise.x);
    if (slice.weight < kLeastWeight) continue;
    whole += slice.share * slice.weight * (slice.cos_gamma + slice.gamma * slice.sin_gamma);
    for (int sign = -1; sign <= 1; sign += 2) {
      const Side side = side_of(view, r, slice, float(sign), reach);
      const vec4 arcs = slice.share * slice.weight * search(r, side, reach, draw_of(noise, s, uint(sign > 0)));
      blocked += arcs.x;
      if (kTellsCompleted) completed_arcs += arcs.w;
      if (kBent) bent_blocked += arcs.y * float(sign) * slice.t + arcs.z * r.eye;
    }
  }
  const float visibility = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
  ao[ao_index] = visibility;
  if (kTellsCompleted) completed[index] = whole > 0.0 ? clamp(completed_arcs / whole, 0.0, 1.0 - visibility) : 0.0;
  if (kBent) write_bent(index, plane, open_bent(r.normal) - (whole > 0.0 ? bent_blocked / whole : vec3(0)));
}
