// Makes the G-buffer that every later kernel relies on: z > 0 planar or marked sky; unit view-space normals that face
// the eye, where those that are unusable or clearly face away are left to `reconstruct`; nothing that is not finite.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: raw depth of any kind or positions, raw normals of any encoding in world or view space.
// Out: planar z, view normals, and counts of what was repaired.
//
// The steps have their numbers at the code:
//  1. Raw depth becomes planar depth; whatever is no distance before the eye is sky (depth_terms.glsl).
//  2. The file's normal is decoded to a vector in its own space. Spheremap: the equal-area map about -z (Mittring, "A
//     bit more Deferred - CryEngine 3", 2009). Octahedral: see normal.glsl.
//  3. The vector is rotated to view space and made a unit vector.
//  4. A normal that leans away by little is bent back until it faces the eye. One that is clearly away, or no direction
//     at all, is left to `reconstruct`.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/geometry/geometry.h"
#include "kernels/base/view.glsl"
#include "kernels/base/depth_terms.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
// The forms are specialization constants: a kernel with all of them takes twice as long on lavapipe, which computes
// both sides of a choice.
layout(constant_id = 0) const uint kDepthForm = kDepthLinear;    // one of kDepth*
layout(constant_id = 1) const uint kNormalForm = kNormalVector;  // one of kNormal*
layout(scalar, push_constant) uniform Push { PrepareParams params; };
readonly buffer RawDepth { float raw_depth[]; };  // one float per pixel, as in the file; of positions three planes
// planes of floats, as many as normal_form needs; not read without normals
readonly buffer RawNormal { float raw_normal[]; };
writeonly buffer Depth { float depth[]; };  // one float per pixel, planar z > 0 in scene units, kSkyDepth on sky
// one uint per pixel, see normal.glsl: unit, view space, facing the eye or clearly away; kNoNormal where there is
// none
writeonly buffer Normal { uint normal[]; };
buffer Counts { FrameCounts counts; };             // zeroed before
writeonly buffer Missing { GroupCount missing; };  // of reconstruct: z becomes 1 where it has work

/// Normals shorter than this are no direction at all (a background of zeros).
const float kLeastLength = 1e-6;

/// The numbers of an invocation's pixels, as FrameCounts has them, and whether one is left to `reconstruct`.
struct Tally {
  uint sky, repaired_depth, repaired_normals;
  bool leaves_one;
};

/// 1. Planar depth in scene units, kSkyDepth where there is no surface.
float depth_at(View view, DepthTerms terms, ivec2 pixel) {
  const int index = index_of(view, pixel), plane = view.size.x * view.size.y;
  vec3 raw = vec3(raw_depth[index], 0, 0);
  if (kDepthForm == kDepthPosition) raw.yz = vec2(raw_depth[index + plane], raw_depth[index + 2 * plane]);
  return planar_depth(kDepthForm, terms, view, pixel, raw);
}

/// 2. The file's normal as a vector, in its own space and of any length; zero where it is none.
vec3 decoded_normal(int index, int plane, bool is_unorm) {
  vec3 raw = vec3(raw_normal[index], raw_normal[index + plane], 0);
  if (kNormalForm == kNormalVector) raw.z = raw_normal[index + 2 * plane];
  if (is_unorm) raw = 2.0 * raw - 1.0;
  const float squared = dot(raw.xy, raw.xy);
  switch (kNormalForm) {
    case kNormalXy: return vec3(raw.xy, sqrt(max(1.0 - squared, 0.0)));
    case kNormalOctahedral: return octahedral_direction(raw.xy);
    case kNormalSpheremap:
      return squared <= 1.0 ? vec3(2.0 * sqrt(1.0 - squared) * raw.xy, 2.0 * squared - 1.0) : vec3(0);
    default: return raw;
  }
}

void add_to_counts(Tally tally) {
  if (tally.sky > 0u) atomicAdd(counts.sky, tally.sky);
  if (tally.repaired_depth > 0u) atomicAdd(counts.repaired_depth, tally.repaired_depth);
  if (tally.repaired_normals > 0u) atomicAdd(counts.repaired_normals, tally.repaired_normals);
  if (tally.leaves_one) missing.z = 1u;  // every invocation that writes it writes the same
}

void main() {
  // lavapipe reads parameters anew in each round of a loop, so the loop has copies.
  const View view = params.view;
  const DepthTerms terms = params.depth;
  const vec3 to_x = params.view_from_normal_x, to_y = params.view_from_normal_y, to_z = params.view_from_normal_z;
  const bool is_unorm = params.normal_unorm != 0;
  const ivec2 first = ivec2(gl_GlobalInvocationID.xy * uvec2(1u, kPrepareRun));
  Tally tally = Tally(0u, 0u, 0u, false);
  int i = 0;
  do {
    const ivec2 pixel = first + ivec2(0, i);
    if (!inside(view, pixel)) continue;
    const int index = index_of(view, pixel);
    const float z = depth_at(view, terms, pixel);
    const bool is_sky = z >= kSkyDepth;
    vec3 n = vec3(0);
    if (kNormalForm != kNormalNone) {
      const vec3 raw = decoded_normal(index, view.size.x * view.size.y, is_unorm);
      n = vec3(dot(to_x, raw), dot(to_y, raw), dot(to_z, raw));  // 3.
    }
    const float size = length(n);
    const bool usable = is_finite(size) && size > kLeastLength;
    const vec3 eye = toward_eye(view, position_of(view, vec2(pixel) + 0.5, z));
    n /= size;
    const bool is_away = dot(n, eye) < -kLeastFacing;               // rounding does not make it face the eye
    const uint turned = pack_normal(is_away ? n : facing(n, eye));  // 4.
    depth[index] = z;
    normal[index] = is_sky ? pack_normal(vec3(0, 0, 1)) : usable ? turned : kNoNormal;
    tally.sky += uint(is_sky);
    tally.repaired_depth += uint(is_sky && (is_nan(raw_depth[index]) || raw_depth[index] < terms.sky_below));
    tally.repaired_normals += uint(!is_sky && !usable && kNormalForm != kNormalNone);
    tally.leaves_one = tally.leaves_one || (!is_sky && (!usable || is_away));
  } while (++i < int(kPrepareRun));
  add_to_counts(tally);
}
