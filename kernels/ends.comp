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
#include "ends.h"
#include "ends.glsl"

layout(local_size_x = kEndsGroup) in;
layout(constant_id = kEndsKeptId) const uint kKept = kMostHidden;
layout(scalar, push_constant) uniform Push { EndsParams params; };
layout(scalar, binding = kEndsDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kEndsHidden) readonly buffer Hidden { float hidden[]; };
layout(scalar, binding = kEndsResult) buffer Result { uint result[]; };

const uint kMost = kMostHidden + 1u;
/// As slice.glsl has it.
const float kRunSlope = 8.0;

/// The surfaces of a pixel.
struct Pixel {
  float z[kMost];
};
/// What is known of their ends on the side that the line comes from.
struct Known {
  int votes[kMost], steps[kMost];
};

const Pixel kNothing = Pixel(float[kMost](kSkyDepth, kSkyDepth, kSkyDepth, kSkyDepth));

Pixel pixel_at(int index) {
  const int plane = params.view.size.x * params.view.size.y;
  Pixel pixel = kNothing;
  pixel.z[0] = depth[index];
  for (uint k = 1u; k <= kKept; k++) pixel.z[k] = abs(hidden[index + int(k - 1u) * plane]);
  return pixel;
}

bool is_same(float a, float b) {
  const float nearer = min(a, b);
  const float size = params.view.tangent_per_pixel.x * (params.view.orthographic != 0 ? 1.0 : nearer);
  return max(a, b) < kSkyDepth && abs(a - b) < kRunSlope * size;
}

/// The surface of a neighbour that goes on from this one; -1: it ends.
int link(Pixel from, uint surface, Pixel to) {
  const float z = from.z[surface];
  int best = -1;
  float least = kSkyDepth;
  for (uint j = 0u; j <= kKept; j++) {
    const float gap = abs(z - to.z[j]);
    bool is_next = is_same(z, to.z[j]) && gap < least;
    for (uint i = 0u; i <= kKept; i++)
      is_next = is_next && !(i != surface && is_same(from.z[i], to.z[j]) && abs(from.z[i] - to.z[j]) < gap);
    best = is_next ? int(j) : best;
    least = is_next ? gap : least;
  }
  return best;
}

/// At the last pixel of a surface: 1 if the one behind it ends there too, -1 if it goes on, 0 if that is not known.
int vote(Pixel here, uint surface, Pixel next, Pixel after, bool has_after) {
  if (surface >= kKept || here.z[surface + 1u] >= kSkyDepth) return 0;
  const int linked = link(here, surface + 1u, next);
  // Behind a full list it may go on unseen.
  if (linked < 0) return next.z[kKept] < here.z[surface + 1u] ? 0 : 1;
  // Its outline may lie a pixel farther out.
  return has_after && link(next, uint(linked), after) < 0 ? 1 : -1;
}

/// What is known of a pixel's surfaces from that of the one before it, `next` to them, and of the one before that.
Known known_of(Pixel here, Pixel next, Known known_next, Pixel after, int gone) {
  Known known;
  for (uint k = 0u; k < kMost; k++) {
    known.votes[k] = 0;
    known.steps[k] = 1;
    if (k > kKept || here.z[k] >= kSkyDepth || gone == 0) continue;
    const int linked = link(here, k, next);
    if (linked < 0) {
      known.votes[k] = vote(here, k, next, after, gone > 1);
    } else {
      const int steps = known_next.steps[linked] + 1;
      known.steps[k] = min(steps, kEndsReach);
      known.votes[k] = steps > kEndsReach ? 0 : known_next.votes[linked];
    }
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
  const int plane = int(params.along_columns) * size.x * size.y;
  for (int way = 0; way < 2; way++) {
    Pixel next = kNothing, after = kNothing;
    Known known = Known(int[kMost](0, 0, 0, 0), int[kMost](0, 0, 0, 0));
    for (int gone = 0; gone < count; gone++) {
      const int index = first + stride * (way == 0 ? gone : count - 1 - gone);
      const Pixel here = pixel_at(index);
      known = known_of(here, next, known, after, gone);
      const uint other = way == 0 ? 0u : result[plane + index];
      uint both = 0u;
      for (uint k = 0u; k < kKept; k++) {
        // A surface that ends on either side of a pixel is one pixel wide.
        both |= way == 0 ? pack_ends(k, known.votes[k], known.steps[k])
                         : pack_ends(k, votes_of(other, k) + known.votes[k], width_of(other, k) + known.steps[k] - 1);
      }
      result[plane + index] = both;
      after = next;
      next = here;
    }
  }
}
