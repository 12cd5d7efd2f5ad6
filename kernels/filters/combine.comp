// Makes one AO of several radii: the mean of their visibilities.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of visibility, one per radius.
// Out: visibility.
//
// It is the mean, and neither the product nor the least, because the mean is itself ambient occlusion: that of a
// falloff which drops by an equal step at each radius. The occlusion with a falloff W is the integral of -W'(r) times
// the occlusion with the hard radius r (superposition), which for steps is a mean.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/filters/filters.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { CombineParams params; };
readonly buffer Scales { float scales[]; };  // planes of visibility in [0, 1], one per radius
writeonly buffer Ao { float ao[]; };         // one float per pixel, visibility in [0, 1]

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = params.size;
  if (any(greaterThanEqual(pixel, size))) return;
  const int index = pixel.y * size.x + pixel.x;
  const int plane = size.x * size.y;
  const int count = int(params.count);
  float blocked = 0.0;  // where all is open the mean is exactly 1: n / n need not be
  for (int p = 0; p < count; p++) blocked += 1.0 - scales[index + p * plane];
  ao[index] = 1.0 - blocked / float(count);
}
