// Turns the visibility of white light into that of light which is thrown back and forth between coloured surfaces, for
// each of red, green and blue.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: visibility, the surface's diffuse colour (or one for all).
// Out: planes r, g, b.
//
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016: a cubic in the visibility, its
// coefficients linear in the albedo, fitted to path-traced scenes of one albedo. The result is never below the
// visibility. At visibility 1 the cubic misses by up to 0.0004: what is open stays 1.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { MultiBounceParams params; };
readonly buffer Ao { float ao[]; };           // one float per pixel, visibility in [0, 1]
readonly buffer Albedo { float albedo[]; };   // planes r, g, b of the diffuse colour, linear; not read without
writeonly buffer Result { float result[]; };  // planes r, g, b, visibility in [0, 1]

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const int plane = params.size.x * params.size.y, index = pixel.y * params.size.x + pixel.x;
  const float v = ao[index];
  for (int c = 0; c < 3; c++) {
    const float raw = params.has_planes != 0 ? albedo[index + c * plane] : params.albedo;
    const float rho = raw > 0.0 ? min(raw, 1.0) : 0.0;  // NaN too is no colour that returns light
    const float a = 2.0404 * rho - 0.3324;
    const float b = 0.6417 - 4.7951 * rho;
    const float d = 2.7552 * rho + 0.6903;
    result[index + c * plane] = clamp(((a * v + b) * v + d) * v, v, 1.0);
  }
}
