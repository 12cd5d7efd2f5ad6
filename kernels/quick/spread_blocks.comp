// Gives every pixel its visibility from the sites of the four blocks nearest to it, each surface by itself.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, the words of blocks, the planes of sites, what is blocked there.
// Out: visibility; sky is 1.
//
// An invocation makes a quarter of a block: 2 x 2 pixels, which have the same four blocks. A site counts by its
// distance, as in linear interpolation along x and y, and by how far it and the pixel lie in each other's planes. Where
// nothing is alike, the least unlike site counts.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/quick/quick.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/quick/blocks.glsl"

layout(local_size_x = 32, local_size_y = 2) in;
layout(scalar, push_constant) uniform Push { BlocksParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
readonly buffer Blocks { uint words[]; };   // from block_sites
readonly buffer Planes { vec4 planes[]; };  // from block_sites
readonly buffer Fitted { vec4 fitted[]; };  // from fit_blocks
writeonly buffer Ao { float ao[]; };        // one float per pixel, visibility

/// Of the slopes at the sites so much counts: all of them would bring their noise to the pixels.
const float kSlope = 0.25;

/// The weight of what is too far away, or unlike.
const float kLeastNear = 1e-3, kLeastAlike = 1e-4;

const int kQuarter = kBlock / 2;  // px a side
const int kQuarterPixels = kQuarter * kQuarter;

ivec2 place_in_quarter(int i) { return ivec2(i % kQuarter, i / kQuarter); }

/// The weight of a site by its way from the pixel.
float nearness(vec2 px) {
  const vec2 tents = 1.0 - abs(px) / float(kBlock);
  return greater(tents.x, kLeastNear) * greater(tents.y, kLeastNear);
}

void main() {
  const View view = params.view;
  const ivec2 blocks = params.blocks;  // a copy, since lavapipe reads parameters anew in each round of a loop
  const ivec2 quarter = ivec2(gl_GlobalInvocationID.xy), block = quarter / 2;
  const ivec2 first = quarter * kQuarter - params.overhang;
  if (any(greaterThanEqual(first, view.size))) return;
  const ivec2 toward = (quarter & 1) * 2 - 1;
  Plane pixels[kQuarterPixels];
  float whole[kQuarterPixels], blocked[kQuarterPixels];
  [[unroll]] for (int i = 0; i < kQuarterPixels; i++) {
    const ivec2 pixel = first + place_in_quarter(i);
    const int index = index_of(view, clamp(pixel, ivec2(0), view.size - 1));
    pixels[i] = plane_of(view, pixel, depth[index], unpack_normal(normal[index]));
    whole[i] = blocked[i] = 0.0;
  }
  int b = 0;
  do {
    const ivec2 other = block + toward * ivec2(b & 1, b >> 1), there = clamp(other, ivec2(0), blocks - 1);
    const int o = there.y * blocks.x + there.x;
    const uint word = other == there ? words[o] : 0u, count = sites_in(word);
    uint j = 0u;
    if (count > 0u) do {
        const uint site = uint(o * kBlockSites) + j;
        const Plane plane = plane_of_site(view, planes[site]);
        const vec4 fit = fitted[site];
        const vec2 at = vec2(other * kBlock - quarter * kQuarter + place_of_site(word, j));
        [[unroll]] for (int i = 0; i < kQuarterPixels; i++) {
          const vec2 px = at - vec2(place_in_quarter(i));
          const float weight = nearness(px) * similarity(pixels[i], plane, px, kLeastAlike);
          whole[i] += weight;
          blocked[i] += weight * clamp(fit.x - kSlope * dot(fit.yz, px), 0.0, 1.0);
        }
      } while (++j < count);
  } while (++b < 4);
  [[unroll]] for (int i = 0; i < kQuarterPixels; i++) {
    const ivec2 pixel = first + place_in_quarter(i);
    const bool is_told = pixels[i].z < kSkyDepth && whole[i] > 0.0;
    if (inside(view, pixel)) ao[index_of(view, pixel)] = is_told ? 1.0 - blocked[i] / whole[i] : 1.0;
  }
}
