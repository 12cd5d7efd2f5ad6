// How the weight of a hit fades towards the radius. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

const uint kFalloffNone = 0;       // whatever is nearer than the radius blocks
const uint kFalloffLinear = 1;     // from 1 at the start to 0 at the radius
const uint kFalloffQuadratic = 2;  // 1 - x^2
const uint kFalloffSmooth = 3;     // 1 - smoothstep

/// How much a hit at this distance blocks.
float falloff_weight(uint falloff, float distance_to_hit, float start, float radius) {
  const float x = clamp((distance_to_hit - start) / (radius - start), 0.0, 1.0);
  if (falloff == kFalloffLinear) return 1.0 - x;
  if (falloff == kFalloffQuadratic) return 1.0 - x * x;
  if (falloff == kFalloffSmooth) return 1.0 - x * x * (3.0 - 2.0 * x);
  return 1.0;
}
