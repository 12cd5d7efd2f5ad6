// Finds pixels past whose surface another frame may see.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth and normals of a frame, and of others.
// Out: for one pixel of each two by two, of the frame itself and of the others, which of them may see past it.
//
// Most surfaces are where another frame looks for them; what moved.comp asks of the rest takes long. What it finds is
// among the suspects unless what is seen past the surface happens to lie on its plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/time/accumulate.h"
#include "kernels/base/reprojection.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/reprojection.glsl"
#include "kernels/time/sight.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kListed = 1;  // frames that the buffer lists, 1 to kMostNeighbours
layout(scalar, push_constant) uniform Push { SuspectsParams params; };
readonly buffer Own { float own[]; };        // one float per pixel of the frame: depth as of a NeighbourFrame
readonly buffer Normal { uint normal[]; };   // one uint per pixel of the frame, see normal.glsl
readonly buffer Others { float others[]; };  // planes of other frames, as words
readonly buffer Frames { NeighbourFrame frames[]; };
// a word per square: bit i: the i-th frame may see past what the frame itself has there; bit kMostNeighbours + i: the
// frame may see past what that one has in its own picture there
writeonly buffer Bits { uint bits[]; };

/// The depth at a pixel of the frame itself, or of another one.
float depth_at(bool of_own, NeighbourFrame other, ivec2 pixel) {
  return abs(of_own ? own[index_of(params.view, pixel)] : others[other.first + uint(index_of(other.view, pixel))]);
}

vec3 position_in(View view, ivec2 pixel, float z) { return position_of(view, vec2(pixel) + 0.5, finite_depth(z)); }

/// Whether a frame may see past a surface at a position in its view space: what it has there is farther than the
/// position, and not on the surface's plane, which at a grazing angle is far off within a pixel.
bool is_past(bool by_own, NeighbourFrame other, vec3 position, vec3 normal) {
  View view = other.view;
  if (by_own) view = params.view;
  const Sight sight = sight_of(view, position, other.depth_precision);
  const float z = depth_at(by_own, other, sight.at), lift = kLifted * sight.width;
  const float tolerance = sight.same + position.z + lift;
  const float before = dot(normal, position_in(view, sight.at, z - tolerance) - position);
  const float behind = dot(normal, position_in(view, sight.at, z + tolerance) - position);
  const bool is_plane_seen = dot(normal, view.orthographic != 0 ? vec3(0, 0, 1) : -position) > 0.0;
  const bool is_on_plane = is_plane_seen && before >= 0.0 && behind <= 0.0;
  return sight.is_seen && z > sight.same + lift && !is_on_plane;
}

void main() {
  const ivec2 square = ivec2(gl_GlobalInvocationID.xy), pixel = looked_at(square);
  const ivec2 in_own = min(pixel, params.view.size - 1);
  const float z = depth_at(true, frames[0], in_own);
  const vec3 here = position_in(params.view, in_own, z);
  const uint word = normal[index_of(params.view, in_own)];
  const vec3 n = word == kNoNormal ? vec3(0) : octahedral_direction(unpackSnorm2x16(word));
  const bool is_own = inside(params.view, pixel) && z < kSkyDepth;
  uint found = 0u;
  [[unroll]] for (int i = 0; i < kListed; i++) {
    const NeighbourFrame other = frames[i];
    const ivec2 in_other = min(pixel, other.view.size - 1);
    const float z_there = depth_at(false, other, in_other);
    const vec3 there = position_in(other.view, in_other, z_there);
    const bool is_others = inside(other.view, pixel) && z_there < kSkyDepth;
    const int pixels = other.view.size.x * other.view.size.y;
    const uint packed = floatBitsToUint(others[other.first + uint(index_of(other.view, in_other) + pixels)]) & 0xffffu;
    const vec3 n_there = packed == kNoTakenNormal ? vec3(0) : octahedral_direction(unpackSnorm4x8(packed).xy);
    const bool past_own = is_past(false, other, position_there(other, here), direction_there(other, n));
    const bool past_other = is_past(true, other, position_here(other, there), direction_here(other, n_there));
    found |= uint(is_own && past_own) << i | uint(is_others && past_other) << (i + int(kMostNeighbours));
  }
  if (square.x < params.squares.x && square.y < params.squares.y) bits[square.y * params.squares.x + square.x] = found;
}
