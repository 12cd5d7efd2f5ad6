// Puts AO into a beauty: into its ambient lights where they are known, else into all of it. Puts shadows into theirs.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: visibility (one, or one per colour), shadows, beauty, the lights that these dim and the colours of some, planar
// depth where there is fog.
// Out: colour; alpha as it was.
//
// beauty - mix S - D o (1 - tint). S is the sum of dark x light x colour, where dark = t (1 - shadow). D is the sum of
// weight x (1 - dark) x light x colour, or the beauty - S: AO dims the rest. o = mix alpha t min(gain (1 - ao), 1 -
// least) is the occlusion, or 1 - ao where a matte's outside is darker than `least`. A pixel at an edge is part
// background, which the AO of the surface must not dim: so alpha. A layer of light is of surfaces alone, so its shadow
// is without. The difference form keeps all other light as it is, even where the passes do not sum to the beauty
// exactly. t = exp(-density distance) is how much of the surface's light comes through the fog that the beauty shows
// (Beer and Lambert's law): the fog before a surface is not in its corners.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"
#include "kernels/base/view.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { CompositeParams params; };
readonly buffer Ao { float ao[]; };          // one float per pixel, visibility; with has_color planes R, G, B
readonly buffer Beauty { float beauty[]; };  // planes R, G, B and, with alpha, A; premultiplied scene-linear colour
readonly buffer Light { float light[]; };    // planes R, G, B of every light; not read without
// planes R, G, B of the colours that multiply some of them; not read without
readonly buffer Color { float light_color[]; };
readonly buffer Lights { AmbientLight lights[]; };  // one for each; not read without
readonly buffer Shadow { float shadow[]; };         // a plane for each light of --lights; not read without
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

/// The light of a colour that AO may dim, and the light that shadows take.
struct Dimmed {
  float ambient, shadowed;
};
Dimmed dimmed_at(int index, int component, int plane, float beauty_color, float fog) {
  Dimmed sum = Dimmed(0.0, 0.0);
  for (uint k = 0u; k < params.lights; k++) {
    const int color = lights[k].color, from = lights[k].shadow;
    const float of_color = color < 0 ? 1.0 : light_color[index + (3 * color + component) * plane];
    const float value = sane(light[index + (3 * int(k) + component) * plane] * of_color);
    const float dark = from < 0 ? 0.0 : fog * (1.0 - shadow[index + from * plane]);
    sum.ambient += lights[k].weight * (1.0 - dark) * value;
    sum.shadowed += dark * value;
  }
  if (params.dims_beauty != 0u) sum.ambient = beauty_color - sum.shadowed;
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
  float fog = 1.0;
  if (params.fog_density > 0.0) fog = exp(-params.fog_density * eye_distance(params.view, pixel, depth[index]));
  const float surface = clamp(alpha, 0.0, 1.0) * fog;
  for (int c = 0; c < 3; c++) {
    const int i = index + c * plane;
    const float color = sane(beauty[i]);
    const Dimmed light_of = dimmed_at(index, c, plane, color, fog);
    const float visible = ao[params.has_color != 0 ? i : index];
    const float most = 1.0 - min(params.least, visible);
    const float occlusion = params.mix * clamp(params.gain * (1.0 - visible), 0.0, most);
    const float shadowed = color - params.mix * light_of.shadowed;
    result[i] = sane(shadowed - light_of.ambient * surface * occlusion * (1.0 - params.tint[c]));
  }
  if (broken) atomicAdd(counts.repaired_beauty, 1u);
}
