// Filters planes to the pixels of a smaller picture, of which each is a block of these.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes, and the filter's weights along an axis, which are the same for all blocks.
// Out: the same planes; every pixel of a block has the value of the smaller picture's pixel.
//
// The mean of the pixels within the filter's width, by the product of the weights of their column and row; pixels
// beyond the planes take no part, and the others then count for more.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { ReduceParams params; };
readonly buffer Planes { float planes[]; };    // planes of floats
readonly buffer Weights { float weights[]; };  // of each row or column of pixels, from params.first of the block on
writeonly buffer Result { float result[]; };   // the same planes, all pixels of a block having its value

int place(int plane, ivec2 pixel) { return (plane * params.size.y + pixel.y) * params.size.x + pixel.x; }

float filtered(int plane, ivec2 corner) {
  const ivec2 first = corner + params.first;
  const ivec2 begin = max(first, ivec2(0)), end = min(first + params.count, params.size);
  const float start = planes[place(plane, begin)];  // what is constant stays exactly so
  float sum = 0, weight = 0;
  for (int y = begin.y; y < end.y; y++)
    for (int x = begin.x; x < end.x; x++) {
      const float w = weights[x - first.x] * weights[y - first.y];
      sum += w * (planes[place(plane, ivec2(x, y))] - start);
      weight += w;
    }
  return start + sum / weight;
}

void main() {
  const ivec2 corner = ivec2(gl_GlobalInvocationID.xy) * params.factor - params.offset;
  const ivec2 begin = max(corner, ivec2(0)), end = min(corner + params.factor, params.size);
  if (any(greaterThanEqual(begin, end))) return;
  for (int i = 0; i < int(params.planes); i++) {
    const float value = filtered(i, corner);
    for (int y = begin.y; y < end.y; y++)
      for (int x = begin.x; x < end.x; x++) result[place(i, ivec2(x, y))] = value;
  }
}
