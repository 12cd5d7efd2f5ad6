// Gives every pixel the values of the sites of the four blocks nearest to it, each surface by itself.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, the words of blocks, the planes of sites, what is blocked there.
// Out: planes of visibility or the like; of sky 1, and moments 1/2.
//
// An invocation makes a quarter of a block: 2 x 2 pixels, which have the same four blocks. A site counts by its
// distance, as in linear interpolation along x and y, and by how far it and the pixel show one surface (likeness.glsl).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/filters/filters.h"
#include "kernels/base/view.glsl"
#include "kernels/base/likeness.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/blocks.glsl"

layout(local_size_x = 32, local_size_y = 2) in;
layout(constant_id = 0) const int kPlanes = 1;   // how many planes; they share their weights
layout(constant_id = 1) const int kMoments = 0;  // those of them that are moments: the first ones
layout(scalar, push_constant) uniform Push { SpreadBlocksParams params; };
readonly buffer Depth { float depth[]; };     // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };    // one uint per pixel, from prepare
readonly buffer Blocks { uint words[]; };     // from sites
readonly buffer Planes { vec4 planes[]; };    // from sites
readonly buffer Fitted { uint fitted[]; };    // from fit_blocks
writeonly buffer Result { float result[]; };  // as many planes, one float per pixel

const bool kReadsNormals = true;
#include "kernels/base/plane_at.glsl"

/// The likeness of a site on another surface. Each pixel has one of its own in its block, but for a uniform density.
const float kUnlike = 1e-6;

/// The weight of a site that is too far away.
const float kLeastNear = 1e-3;

const int kQuarter = kBlock / 2;  // px a side
const int kQuarterPixels = kQuarter * kQuarter;

ivec2 place_in_quarter(int i) { return ivec2(i % kQuarter, i / kQuarter); }

/// The weight of a site by its way from the pixel.
float nearness(vec2 px) {
  const vec2 tents = 1.0 - abs(px) / float(kBlock);
  return greater(tents.x, kLeastNear) * greater(tents.y, kLeastNear);
}

void main() {
  // Copies, since lavapipe reads parameters anew in each round of a loop.
  const View view = params.view;
  const SiteGrid grid = params.grid;
  const float slope = params.slope;
  const int plane_size = view.size.x * view.size.y, all = grid.blocks.x * grid.blocks.y * kBlockPixels;
  const ivec2 quarter = ivec2(gl_GlobalInvocationID.xy), block = quarter / 2;
  const ivec2 first = quarter * kQuarter - grid.overhang;
  if (any(greaterThanEqual(first, view.size))) return;
  const ivec2 toward = (quarter & 1) * 2 - 1;
  Plane pixels[kQuarterPixels];
  float whole[kQuarterPixels], blocked[kQuarterPixels * kPlanes];
  [[unroll]] for (int i = 0; i < kQuarterPixels; i++) {
    const ivec2 pixel = first + place_in_quarter(i);
    pixels[i] = plane_at(view, pixel);
    whole[i] = 0.0;
    [[unroll]] for (int p = 0; p < kPlanes; p++) blocked[i * kPlanes + p] = 0.0;
  }
  int b = 0;
  do {
    const ivec2 other = block + toward * ivec2(b & 1, b >> 1), there = clamp(other, ivec2(0), grid.blocks - 1);
    const int o = there.y * grid.blocks.x + there.x;
    const vec2 corner = vec2(other * kBlock - grid.overhang - first);
    uint left = other == there ? words[o] : 0u;
    if (left != 0u) do {
        const int bit = findLSB(left), number = number_of_site(grid, o, bit);
        left &= left - 1u;
        const Plane plane = unpack_plane(view, planes[number]);
        const vec2 at = corner + vec2(place_in_block(bit));
        float weight[kQuarterPixels];
        [[unroll]] for (int i = 0; i < kQuarterPixels; i++) {
          const vec2 px = at - vec2(place_in_quarter(i));
          weight[i] = nearness(px) * similarity(pixels[i], plane, px, kUnlike);
          whole[i] += weight[i];
        }
        [[unroll]] for (int p = 0; p < kPlanes; p++) {
          const int from = 2 * (p * all + number);
          const vec3 fit = unpack_fit(fitted[from], fitted[from + 1]);
          [[unroll]] for (int i = 0; i < kQuarterPixels; i++) {
            const vec2 px = at - vec2(place_in_quarter(i));
            blocked[i * kPlanes + p] += weight[i] * clamp(fit.x - slope * dot(fit.yz, px), 0.0, 1.0);
          }
        }
      } while (left != 0u);
  } while (++b < 4);
  [[unroll]] for (int i = 0; i < kQuarterPixels; i++) {
    const ivec2 pixel = first + place_in_quarter(i);
    if (!inside(view, pixel)) continue;
    const bool is_told = pixels[i].z < kSkyDepth && whole[i] > 0.0;
    [[unroll]] for (int p = 0; p < kPlanes; p++) {
      const float open = p < kMoments ? 0.5 : 1.0;
      result[index_of(view, pixel) + p * plane_size] = is_told ? 1.0 - blocked[i * kPlanes + p] / whole[i] : open;
    }
  }
}
