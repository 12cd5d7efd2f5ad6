// Writes depth around the picture, where the planes of its border go on.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals. Out: below 0 what is only guessed; sky where nothing goes on. Inside of the picture
// sites writes what is seen. Invocations take first the bands above and below, then the ends of rows.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = 256) in;
layout(scalar, push_constant) uniform Push { MarginParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
writeonly buffer Wide { float wide[]; };    // one float per pixel of the image with its margin

/// The place of the margin that an invocation is for, from the margin's corner; negative: none.
ivec2 place_of(ivec2 size, int at) {
  const int beside = 2 * kDepthMargin, width = size.x + beside, bands = beside * width;
  const ivec2 band = ivec2(at % width, at / width);
  if (at < bands) return band + ivec2(0, band.y < kDepthMargin ? 0 : size.y);
  const ivec2 end = ivec2((at - bands) % beside, (at - bands) / beside);
  return end.y < size.y ? end + ivec2(end.x < kDepthMargin ? 0 : size.x, kDepthMargin) : ivec2(-1);
}

void main() {
  const View view = params.view;
  const ivec2 place = place_of(view.size, int(gl_GlobalInvocationID.x));
  if (place.x < 0) return;
  const ivec2 pixel = place - kDepthMargin, most = view.size - 1;
  const ivec2 nearest = clamp(pixel, ivec2(0), most), mirrored = clamp(2 * nearest - pixel, ivec2(0), most);
  const int index = index_of(view, nearest);
  const vec3 n = octahedral_direction(unpackSnorm2x16(normal[index]));
  const float z =
      depth_beyond(view, tangent_of(view, vec2(nearest) + 0.5), depth[index], n, tangent_of(view, vec2(mirrored) + 0.5),
                   depth[index_of(view, mirrored)], tangent_of(view, vec2(pixel) + 0.5), kLeastFacingToGoOn);
  wide[place.y * (view.size.x + 2 * kDepthMargin) + place.x] = z < kSkyDepth ? -z : kSkyDepth;
}
