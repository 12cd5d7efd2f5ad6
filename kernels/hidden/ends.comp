// Where the surfaces of each pixel end along its row or column, and whether the surface behind ends there too.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of all surfaces of a pixel.
// Out: for each surface but the last how many of its two ends it shares, and how wide it is, in pixels.
//
// An invocation goes along a line and back. A surface goes on to the neighbour's that is nearest to it in depth, if it
// is the nearest to that one, and less than kRunSlope pixels' worth of slope away. At an end of the surface the one
// behind it either ends too, within a pixel: both are sides of one solid; or it goes on: then it is another thing.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"
#include "kernels/hidden/ends.glsl"

layout(local_size_x = kEndsGroup) in;
layout(constant_id = 0) const uint kKept = kMostHidden;  // planes of `hidden`, 1 to kMostHidden
layout(scalar, push_constant) uniform Push { EndsParams params; };
readonly buffer Depth { float depth[]; };    // one float per pixel, planar depth of the first surface, from prepare
readonly buffer Hidden { float hidden[]; };  // planes of floats, from layers
buffer Result { uint result[]; };            // two planes of uints, along rows and along columns, see pack_ends

const uint kMost = kMostHidden + 1u;

/// The surfaces of a pixel.
struct Pixel {
  float z[kMost];
};
/// The ends of the surfaces on the side that the line comes from.
struct Known {
  int votes[kMost], steps[kMost];
  uint ends;  // a bit for each that the pixel before does not go on with
};

const Pixel kNothing = Pixel(float[kMost](kSkyDepth, kSkyDepth, kSkyDepth, kSkyDepth));

Pixel pixel_at(int index, int plane) {
  Pixel pixel = kNothing;
  pixel.z[0] = depth[index];
  [[unroll]] for (uint k = 1u; k <= kKept; k++) pixel.z[k] = abs(hidden[index + int(k - 1u) * plane]);
  return pixel;
}

/// The distance between two surfaces; kSkyDepth if they are not one. perspective: 1, or 0 orthographic.
float gap_of(float a, float b, float slope, float perspective) {
  const float limit = slope * (perspective != 0.0 ? min(a, b) : 1.0), gap = abs(a - b);
  return gap < limit && max(a, b) < kSkyDepth ? gap : kSkyDepth;
}

/// For each surface the one of a neighbour that goes on from it; -1: it ends.
int[kMost] links_of(Pixel from, Pixel to, float slope, float perspective) {
  float gaps[kMost * kMost];
  int links[kMost];
  [[unroll]] for (uint i = 0u; i <= kKept; i++) {
    [[unroll]] for (uint j = 0u; j <= kKept; j++) {
      gaps[i * kMost + j] = gap_of(from.z[i], to.z[j], slope, perspective);
    }
  }
  [[unroll]] for (uint i = 0u; i <= kKept; i++) {
    float least = kSkyDepth;
    links[i] = -1;
    [[unroll]] for (uint j = 0u; j <= kKept; j++) {
      const float gap = gaps[i * kMost + j];
      bool is_next = gap < least;
      [[unroll]] for (uint k = 0u; k <= kKept; k++) is_next = gaps[k * kMost + j] < gap ? false : is_next;
      links[i] = is_next ? int(j) : links[i];
      least = is_next ? gap : least;
    }
  }
  return links;
}

/// At the last pixel of a surface: 1 if the one behind it, at depth z, ends there too, -1 if it goes on, 0 if that is
/// not known. linked: what goes on from it at the next pixel, which lists surfaces up to the depth `last`.
int vote(float z, int linked, float last, Known known_next, bool has_after) {
  if (z >= kSkyDepth) return 0;
  // Behind a full list it may go on unseen.
  if (linked < 0) return last < z ? 0 : 1;
  // Its outline may lie a pixel farther out.
  return has_after && (known_next.ends >> linked & 1u) != 0u ? 1 : -1;
}

/// What is known of a pixel's surfaces from that of the one before it, `next` to them.
Known known_of(Pixel here, Pixel next, Known known_next, int gone, float slope, float perspective) {
  const int links[kMost] = links_of(here, next, slope, perspective);
  Known known = Known(int[kMost](0, 0, 0, 0), int[kMost](1, 1, 1, 1), 0u);
  [[unroll]] for (uint k = 0u; k <= kKept; k++) {
    int steps = 0, votes = 0;
    [[unroll]] for (uint j = 0u; j <= kKept; j++) {
      steps = links[k] == int(j) ? known_next.steps[j] : steps;
      votes = links[k] == int(j) ? known_next.votes[j] : votes;
    }
    const uint behind = min(k + 1u, kKept);
    const int ending = k < kKept ? vote(here.z[behind], links[behind], next.z[kKept], known_next, gone > 1) : 0;
    const bool is_known = here.z[k] < kSkyDepth && gone > 0, ends = links[k] < 0;
    known.ends |= ends ? 1u << k : 0u;
    known.votes[k] = !is_known ? 0 : ends ? ending : steps + 1 > kEndsReach ? 0 : votes;
    known.steps[k] = !is_known || ends ? 1 : min(steps + 1, kEndsReach);
  }
  return known;
}

void main() {
  const bool along_columns = params.along_columns != 0u;
  const ivec2 size = params.view.size;
  const int line = int(gl_GlobalInvocationID.x);
  if (line >= (along_columns ? size.x : size.y)) return;
  const int first = along_columns ? line : line * size.x;
  const int stride = along_columns ? size.x : 1;
  const int count = along_columns ? size.y : size.x;
  const int plane = size.x * size.y, of_line = along_columns ? plane : 0;
  const float slope = kRunSlope * params.view.tangent_per_pixel.x;
  const float perspective = params.view.orthographic != 0 ? 0.0 : 1.0;
  for (int way = 0; way < 2; way++) {
    Pixel next = kNothing;
    Known known = Known(int[kMost](0, 0, 0, 0), int[kMost](0, 0, 0, 0), 0u);
    for (int gone = 0; gone < count; gone++) {
      const int index = first + stride * (way == 0 ? gone : count - 1 - gone);
      const Pixel here = pixel_at(index, plane);
      known = known_of(here, next, known, gone, slope, perspective);
      const uint other = way == 0 ? 0u : result[of_line + index];
      uint both = 0u;
      [[unroll]] for (uint k = 0u; k < kKept; k++) {
        // A surface that ends on either side of a pixel is one pixel wide.
        both |= way == 0 ? pack_ends(k, known.votes[k], known.steps[k])
                         : pack_ends(k, votes_of(other, k) + known.votes[k], width_of(other, k) + known.steps[k] - 1);
      }
      result[of_line + index] = both;
      next = here;
    }
  }
}
