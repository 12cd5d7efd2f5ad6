// Finds which hidden surfaces close the solid of the surface before them, where the files do not say it.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of all surfaces of a pixel; which of them are of unknown kind; their ends.
// Out: the depth of those that close a solid, negated.
//
// Two surfaces are front and back of one solid if they share more of their ends than they do not, and if it is no more
// than kMostThickness times as thick as it is wide. docs/hidden.md says what that is worth.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"
#include "kernels/hidden/ends.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kKept = kMostHidden;  // planes of `hidden`, 1 to kMostHidden
layout(scalar, push_constant) uniform Push { PairParams params; };
readonly buffer Depth { float depth[]; };  // one float per pixel, planar depth of the first surface, from prepare
buffer Hidden { float hidden[]; };         // planes of floats, from layers; see GBuffer::hidden
readonly buffer Open { uint open[]; };     // one uint per pixel, from layers
readonly buffer Ends { uint ends[]; };     // two planes of uints, from ends

/// Without it grass that stands before other grass becomes solid.
const float kMostThickness = 2.0;

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel), plane = params.view.size.x * params.view.size.y;
  const uint along_row = ends[index], along_column = ends[index + plane];
  float last = depth[index];
  bool last_closes = false;
  for (uint k = 0u; k < kKept; k++) {
    const int at = index + int(k) * plane;
    const float z = hidden[at];
    if (abs(z) >= kSkyDepth) break;
    const int votes = votes_of(along_row, k) + votes_of(along_column, k);
    const float width = float(min(width_of(along_row, k), width_of(along_column, k)));
    const bool is_open = (open[index] >> k & 1u) != 0u;
    const bool closes = is_open && !last_closes && votes > 0 &&
                        abs(z) - last <= kMostThickness * width * pixel_width(params.view, last);
    if (closes) hidden[at] = -z;
    last_closes = closes || z < 0.0;
    last = abs(z);
  }
}
