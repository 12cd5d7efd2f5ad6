// Makes one plane of coverage of what a matte's file holds.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: a plane of coverage or of objects, or ranks of objects with their coverage.
// Out: how much of each pixel the matte takes, 0 to 1. What is no number takes nothing.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "matte.h"
#include "finite.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { MatteParams params; };
layout(scalar, binding = kMatteRaw) readonly buffer Raw { float raw[]; };
layout(scalar, binding = kMatteObjects) readonly buffer Objects { uint objects[]; };
layout(scalar, binding = kMatteResult) writeonly buffer Result { float result[]; };

/// Whether the value, an object, is among those that are meant.
bool is_meant(float value) {
  bool is_found = false;
  for (uint i = 0u; i < params.objects; i++) is_found = is_found || floatBitsToUint(value) == objects[i];
  return is_found;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const uint index = uint(pixel.y * params.size.x + pixel.x), plane = uint(params.size.x * params.size.y);
  float taken = 0.0;
  if (params.form == kMatteCoverage) taken = raw[index];
  if (params.form == kMatteNumbers) taken = is_meant(raw[index]) ? 1.0 : 0.0;
  if (params.form == kMatteRanked)
    for (uint i = 0u; i + 1u < params.planes; i += 2u)
      if (is_meant(raw[index + i * plane])) taken += raw[index + (i + 1u) * plane];
  result[index] = is_finite(taken) ? clamp(taken, 0.0, 1.0) : 0.0;
}
