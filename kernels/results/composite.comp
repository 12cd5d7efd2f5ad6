// Puts AO into a beauty: into its ambient lights where they are known, else into all of it.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: visibility (one, or one per colour), beauty, the ambient lights and the colours of some, planar depth where there
// is fog.
// Out: colour; alpha as it was.
//
// beauty - D o (1 - tint), where D is the sum of weight x light x colour, or the beauty, and o = mix alpha t
// min(gain (1 - ao), 1 - least) is the occlusion, or 1 - ao where a matte's outside is darker than `least`. A pixel at
// an edge is part background, which the AO of the surface must not dim: so alpha. The difference form keeps all other
// light as it is, even where the passes do not sum to the beauty exactly. t = exp(-density distance) is how much of the
// surface's light comes through the fog that the beauty shows (Beer and Lambert's law): the fog before a surface is not
// in its corners.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"
#include "kernels/base/finite.glsl"
#include "kernels/base/view.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { CompositeParams params; };
readonly buffer Ao { float ao[]; };          // one float per pixel, visibility; with has_color planes R, G, B
readonly buffer Beauty { float beauty[]; };  // planes R, G, B and, with alpha, A; premultiplied scene-linear colour
readonly buffer Light { float light[]; };    // planes R, G, B of every ambient light; not read without
// planes R, G, B of the colours that multiply some of them; not read without
readonly buffer Color { float light_color[]; };
readonly buffer Lights { AmbientLight lights[]; };  // one for each; not read without
writeonly buffer Result { float result[]; };        // the beauty's planes, alpha too
readonly buffer Depth { float depth[]; };  // one float per pixel, planar depth, kSkyDepth for sky; not read without fog
buffer Counts { FrameCounts counts; };

bool broken = false;  // this pixel had a value that is NaN or infinite

/// Nothing that leaves the tool is NaN or infinite: such a value becomes 0, and is counted.
float sane(float x) {
  if (is_finite(x)) return x;
  broken = true;
  return 0.0;
}

/// The light of a colour that AO may dim.
float ambient_at(int index, int component, int plane, float beauty_color) {
  if (params.lights == 0u) return beauty_color;
  float sum = 0.0;
  for (uint k = 0u; k < params.lights; k++) {
    const int at = index + (3 * int(k) + component) * plane;
    const int color = lights[k].color;
    const float of_color = color < 0 ? 1.0 : light_color[index + (3 * color + component) * plane];
    sum += lights[k].weight * sane(light[at] * of_color);
  }
  return sum;
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
    const float ambient = ambient_at(index, c, plane, color);
    const float visible = ao[params.has_color != 0 ? i : index];
    const float most = 1.0 - min(params.least, visible);
    const float occlusion = params.mix * clamp(params.gain * (1.0 - visible), 0.0, most);
    result[i] = sane(color - ambient * surface * occlusion * (1.0 - params.tint[c]));
  }
  if (broken) atomicAdd(counts.repaired_beauty, 1u);
}
