// How far back what each pixel shows is solid, as far as other pixels of its surface tell.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of the first surfaces that may block, view normals.
// Out: a word per pixel, see backs.glsl.
//
// A dispatch looks along all rows or all columns, both ways. Neighbours that show one surface (solids.glsl) are a
// chain. Of the chain that comes to a pixel one way some places tell, none farther away than kLongestChain, so that a
// part of the frame has the words of the whole.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/estimate/solids.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kBacksGroup) in;
layout(constant_id = 0) const uint kSteep = 0;  // 1: along columns, and joins what rows have told
layout(scalar, push_constant) uniform Push { BacksParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
readonly buffer Told { uint told[]; };      // from the rows; only with kSteep
buffer Backs { uint backs[]; };

/// As kRunSlope of slice.glsl.
const float kChainSlope = 8.0;

/// Places of a chain that tell, evenly from a pixel to the chain's first one, or as far as it tells.
const int kTelling = 2;

/// A chain up to a pixel.
struct Chain {
  int start;                    // its first step
  int count;                    // pixels
  vec3 normal;                  // at its start
  bool may_be_round, is_round;  // it begins with a rounded outline
};

int index_of(int line, int step) {
  return kSteep != 0u ? step * params.view.size.x + line : line * params.view.size.x + step;
}

float distance_from_eye(View view, vec3 position) { return view.orthographic == 0 ? length(position) : -position.z; }

Facet facet_at(View view, int line, int step, int steps) {
  const bool exists = step >= 0 && step < steps;
  const int at = clamp(step, 0, steps - 1);
  const int index = index_of(line, at);
  const vec2 pixel = kSteep != 0u ? vec2(line, at) : vec2(at, line);
  Facet f;
  f.z = exists ? depth[index] : kSkyDepth;
  f.position = position_of(view, pixel + 0.5, f.z);
  f.normal = unpack_normal(normal[index]);
  return f;
}

/// Whether two neighbouring pixels, the second one step on, are one surface. before, after: the pixels beside them.
bool are_one(View view, Facet before, Facet a, Facet b, Facet after) {
  const float pixel = pixels_of(view, min(a.z, b.z)), apart = abs(a.z - b.z);
  const bool recedes = b.z > a.z;
  const vec2 step = kSteep != 0u ? vec2(0, 1) : vec2(1, 0);
  bool one;
  if (apart < kChainSlope * pixel)
    one = !(apart > kParallelSlope * pixel && are_parallel(view, a, b, params.radius));
  else
    one = params.has_normals != 0u &&
          (are_coplanar(view, a, b, kPlaneDot, kPlaneOff) ||
           (recedes ? meet_at_edge(view, b, a, after, -step) : meet_at_edge(view, a, b, before, step)));
  return one && max(a.z, b.z) < kSkyDepth;
}

/// The chain up to a pixel at a step from that up to the one before.
Chain chain_to(View view, Chain last, bool goes_on, Facet before, Facet here, int step, bool is_first) {
  Chain chain = last;
  if (!goes_on) {
    const bool grazes = dot(here.normal, toward_eye(view, here.position)) < kRoundFacing;
    return Chain(step, 1, here.normal, !is_first && before.z > here.z && grazes, false);
  }
  chain.count++;
  if (chain.count == 3) chain.is_round = chain.may_be_round && dot(chain.normal, here.normal) < kRoundDot;
  return chain;
}

vec3 position_at(View view, int line, int step) {
  const vec2 pixel = kSteep != 0u ? vec2(line, step) : vec2(step, line);
  return position_of(view, pixel + 0.5, depth[index_of(line, step)]);
}

/// What a chain tells at its last pixel, at a step. Its outline is that of one side.
Back back_of(View view, Chain chain, Facet here, int line, int step) {
  const float pixel = abs(kSteep != 0u ? view.tangent_per_pixel.y : view.tangent_per_pixel.x);
  const float longest = kLongestChain * params.radius, e = distance_from_eye(view, here.position);
  const int most = int(min(longest / (pixel * (view.orthographic == 0 ? here.z : 1.0)), 1e5));
  const int away = clamp(chain.start - step, -most, most);
  float back = 0.0, size = 0.0, farther = 0.0;
  int i = 1;
  do {
    const vec3 other = position_at(view, line, step + away * i / kTelling);
    farther = distance_from_eye(view, other) - e;
    back = max(back, min(farther, -dot(here.normal, other - here.position)));
    size = length(other - here.position);
  } while (++i <= kTelling);
  const bool is_round = chain.is_round && step + away == chain.start;
  const float per_distance = here.z / e;
  const float mirrored = max(2.0 * farther, pixels_of(view, here.z)) * per_distance;
  return Back(back * per_distance, min(size, longest), is_round ? mirrored : -1.0, -1.0);
}

void main() {
  const View view = params.view;
  const int lines = kSteep != 0u ? view.size.x : view.size.y, steps = kSteep != 0u ? view.size.y : view.size.x;
  const int line = int(gl_GlobalInvocationID.x);
  if (line >= lines) return;
  Facet before = facet_at(view, line, -1, steps), a = before, here = facet_at(view, line, 0, steps);
  Chain chain;
  chain.count = 0;
  int s = 0;
  do {
    const Facet after = facet_at(view, line, s + 1, steps);
    const bool goes_on = s > 0 && are_one(view, before, a, here, after);
    chain = chain_to(view, chain, goes_on, a, here, s, s == 0);
    backs[index_of(line, s)] =
        pack_line(back_of(view, chain, here, line, s), params.radius) | (goes_on ? kBackLinked : 0u);
    before = a;
    a = here;
    here = after;
  } while (++s < steps);
  s = steps - 1;
  bool goes_on = false;
  do {
    here = facet_at(view, line, s, steps);
    chain = chain_to(view, chain, goes_on, a, here, s, s == steps - 1);
    const int index = index_of(line, s);
    const uint word = backs[index];
    goes_on = (word & kBackLinked) != 0u;
    Back back = unpack_line(word, params.radius);
    const Back backward = back_of(view, chain, here, line, s);
    back.after = backward.before;
    back.depth = max(back.depth, backward.depth);
    back.width += backward.width + pixels_of(view, here.z);
    uint result;
    if (kSteep != 0u) {
      const Back other = unpack_line(told[index], params.radius);
      const float depth =
          max(min(back.depth, kBackPerWidth * other.width), min(other.depth, kBackPerWidth * back.width));
      result = pack_back(depth, vec4(other.before, other.after, back.before, back.after), params.radius);
    } else {
      result = pack_line(back, params.radius);
    }
    backs[index] = result;
    a = here;
  } while (--s >= 0);
}
