// Puts AO into a beauty: beauty - D + D f where the ambient part D is known, beauty x f where it is not.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: visibility (one, or one per colour), beauty, the parts of D, planar depth where there is fog.
// Out: colour; alpha as it was.
//
// f = 1 - alpha t (1 - ao): a pixel at an edge is part background, which the AO of the surface must not dim. The
// difference form keeps all other light as it is, even where the passes do not sum to the beauty exactly. t =
// exp(-density distance) is how much of the surface's light comes through the fog that the beauty shows (Beer and
// Lambert's law): the fog before a surface is not in its corners.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "composite.h"
#include "finite.glsl"
#include "view.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { CompositeParams params; };
layout(scalar, binding = kCompositeAo) readonly buffer Ao { float ao[]; };
layout(scalar, binding = kCompositeBeauty) readonly buffer Beauty { float beauty[]; };
layout(scalar, binding = kCompositeIndirect) readonly buffer Indirect { float indirect[]; };
layout(scalar, binding = kCompositeDiffuseColor) readonly buffer DiffuseColor { float diffuse_color[]; };
layout(scalar, binding = kCompositeResult) writeonly buffer Result { float result[]; };
layout(scalar, binding = kCompositeDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kCompositeCounts) buffer Counts { FrameCounts counts; };

bool broken = false;  // this pixel had a value that is NaN or infinite

/// Nothing that leaves the tool is NaN or infinite: such a value becomes 0, and is counted.
float sane(float x) {
  if (is_finite(x)) return x;
  broken = true;
  return 0.0;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int plane = params.view.size.x * params.view.size.y, index = index_of(params.view, pixel);
  float alpha = 1.0;
  if (params.has_alpha != 0) {
    alpha = sane(beauty[index + 3 * plane]);
    result[index + 3 * plane] = alpha;
  }
  float surface = clamp(alpha, 0.0, 1.0);
  if (params.fog_density > 0.0) surface *= exp(-params.fog_density * eye_distance(params.view, pixel, depth[index]));
  for (int c = 0; c < 3; c++) {
    const int i = index + c * plane;
    const float color = sane(beauty[i]);
    float ambient = color;
    if (params.has_ambient != 0) ambient = sane(indirect[i] * (params.has_diffuse_color != 0 ? diffuse_color[i] : 1.0));
    result[i] = sane(color - ambient * surface * (1.0 - ao[params.has_color != 0 ? i : index]));
  }
  if (broken) atomicAdd(counts.repaired_beauty, 1u);
}
