// Shapes the visibility as the user asks: o + c (max(m (v + (1 - v) f), l) - o), with v = max(0, 1 - intensity (1 -
// ao)) ^ p, f how far the distance fade has come, from 0 to 1, m the material's own AO, l the least AO, c the matte and
// o what is outside of it.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of visibility, each by itself; planar depth and material AO where they are asked for.
// Out: visibility, and how many values of the material AO were repaired.
//
// Without fade and material 1 stays 1, and sky within the matte is 1 in any case. The fade is of the screen-space AO
// alone: what a material's own AO holds is as true far away as nearby.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
// What is asked for is a specialization constant: lavapipe computes both sides of a choice, and powers are slow.
layout(constant_id = 0) const uint kMode = 0;  // bits of kShape*
layout(scalar, push_constant) uniform Push { ShapeParams params; };
readonly buffer Ao { float ao[]; };  // planes of visibility in [0, 1]
// one float per pixel, planar depth, kSkyDepth for sky; not read without fade and material
readonly buffer Depth { float depth[]; };
readonly buffer Material { float material[]; };  // one float per pixel, visibility; not read without
readonly buffer Matte { float matte[]; };        // one float per pixel, from matte; not read without
writeonly buffer Shaped { float shaped[]; };     // as many planes, in [0, 1]
buffer Counts { FrameCounts counts; };

bool shapes_by(uint what) { return (kMode & what) != 0u; }

/// The shaped visibility of the pixel of that index. What is not asked for leaves every bit as it is.
float shaped_of(float value, int index) {
  if (shapes_by(kShapeByIntensity)) value = clamp(1.0 - params.intensity * (1.0 - value), 0.0, 1.0);
  if (shapes_by(kShapeByPower)) value = value > 0.0 ? pow(value, params.power) : 0.0;
  if (shapes_by(kShapeByFade))
    value +=
        (1.0 - value) * clamp((depth[index] - params.fade_start) / (params.fade_end - params.fade_start), 0.0, 1.0);
  if (shapes_by(kShapeByMaterial) && depth[index] < kSkyDepth) {
    const float own = material[index];
    if (is_finite(own)) value *= clamp(own, 0.0, 1.0);
  }
  if (shapes_by(kShapeByLeast)) value = max(value, params.least);
  if (shapes_by(kShapeByMatte) && matte[index] < 1.0) value = params.outside + matte[index] * (value - params.outside);
  return value;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const int index = pixel.y * params.size.x + pixel.x, plane = params.size.x * params.size.y;
  for (int p = 0; p < int(params.planes); p++) shaped[index + p * plane] = shaped_of(ao[index + p * plane], index);
  if (!shapes_by(kShapeCountsRepaired) || depth[index] >= kSkyDepth) return;
  if (!is_finite(material[index])) atomicAdd(counts.repaired_material, 1u);
}
