// Makes the nine coefficients of the light that a white surface reflects of distant surroundings, of AO and moments; or
// that light.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth (for the sky), packed normals, visibility, planes of the moments of what is blocked; nine colours.
// Out: planes T_00, T_1-1, T_10, T_11, T_2-2, T_2-1, T_20, T_21, T_22: (1 / pi) Integral of V(w) max(0, n.w) Y_lm(w)
// dw, with the real spherical harmonics Y_lm. With kRelights planes r, g, b: the sum of these times the colours, which
// are the integrals of the light times Y_lm. Sky: 0.
//
// Ramamoorthi and Hanrahan, "An Efficient Representation for Irradiance Environment Maps", 2001, for the order and the
// constants of Y_lm; with the visibility V within, as Sloan et al., "Precomputed Radiance Transfer", 2002.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"
#include "kernels/base/normal.glsl"
#include "kernels/base/moments.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kOpen = 0;      // 1: nothing is blocked
layout(constant_id = 1) const uint kRelights = 0;  // 1: the light instead
layout(scalar, push_constant) uniform Push { TransferParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, planar depth, kSkyDepth for sky
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
readonly buffer Ao { float ao[]; };         // planes of visibility in [0, 1]; not with kOpen
// planes of moments up to second order, see stored_moment(); not with kOpen
readonly buffer Moments { float moments[]; };
readonly buffer Light { vec3 light[]; };      // nine colours; only with kRelights
writeonly buffer Planes { float planes[]; };  // nine planes, or three

/// The constants of Y_00, of Y_1m, of the products among Y_2m over 2, of Y_20 times 2 and of Y_22.
const float kConstant = 0.28209479, kLinear = 0.48860251, kMixed = 0.54627422, kZonal = 0.63078313;

/// The moments no larger than those of so much visibility in one direction. AO and moments are filtered apart, and
/// beside an edge a little AO may meet moments of another surface: then no light would be that.
mat3 possible_moments(mat3 m, float visibility) {
  const float first = length(m[0]);
  const float second = sqrt(0.75 * (dot(m[1], m[1]) + m[2].x * m[2].x) + m[2].y * m[2].y);
  m[0] *= visibility / max(first, max(visibility, 1e-6));
  const float part = visibility / max(second, max(visibility, 1e-6));
  m[1] *= part;
  m[2] *= part;
  return m;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const int plane = params.size.x * params.size.y, index = pixel.y * params.size.x + pixel.x;
  const bool is_surface = depth[index] < kSkyDepth;
  mat3 m = open_moments(unpack_normal(normal[index]));
  for (int k = 0; k < kMostMoments && kOpen == 0u; k++) m[k / 3][k % 3] -= blocked_moment(moments[index + k * plane]);
  const float visibility = kOpen != 0u ? 1.0 : ao[index + int(params.plane) * plane];
  m = turned(transpose(mat3(params.x_from_view, params.y_from_view, params.z_from_view)),
             possible_moments(m, visibility));
  const float t[9] = float[](kConstant * visibility, kLinear * m[0].y, kLinear * m[0].z, kLinear * m[0].x,
                             kMixed * m[1].x, kMixed * m[1].y, kZonal * m[2].y, kMixed * m[1].z, kMixed * m[2].x);
  if (kRelights == 0u) {
    for (int k = 0; k < 9; k++) planes[index + k * plane] = is_surface ? t[k] : 0.0;
    return;
  }
  vec3 sum = vec3(0);
  for (int k = 0; k < 9; k++) sum += t[k] * light[k];
  for (int c = 0; c < 3; c++) planes[index + c * plane] = is_surface ? max(0.0, sum[c]) : 0.0;
}
