// The surfaces behind the first one of each pixel, from all that was found of them: sorted, each once, and no more than
// are kept.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of planar depth in any order, from files and from other views; the first surface.
// Out: planes of planar depth, nearer first, each farther than the one before by more than the separation; what was
// kept, dropped, and lies before the first surface; which of them are of unknown kind. The order of the planes that
// were found changes no bit.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"
#include "kernels/base/reprojection.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kKept = kMostHidden;  // planes of `hidden`, 1 to kMostHidden
// planes that were found where they are few, since loops of a known length take half the time; 0: as params says
layout(constant_id = 1) const uint kPlanes = 0;
layout(constant_id = 2) const uint kWarped = 0;  // planes from other views
layout(scalar, push_constant) uniform Push { LayersParams params; };
// planes of floats: planar depth > 0 of surfaces in any order, below 0 of those that close the solid before them;
// kSkyDepth where there is none
readonly buffer Found { float found[]; };
readonly buffer Depth { float depth[]; };     // one float per pixel, planar depth of the first surface, from prepare
writeonly buffer Hidden { float hidden[]; };  // planes of floats, see GBuffer::hidden
// one uint per pixel: bit k is set if the surface k of `hidden` is of unknown kind, and may close a solid
writeonly buffer Open { uint open[]; };
buffer Counts { LayerCounts counts; };      // zeroed before
readonly buffer Warped { uint warped[]; };  // planes of keys of surfaces that other views show, see key_of()

float separation_at(float z) { return separation_at(params.view, params.depth_precision, params.separation, z); }

uint planes() { return kPlanes != 0u ? kPlanes : params.planes; }

float warped_depth(int at) { return warped[at] == 0u ? kSkyDepth : depth_of(warped[at]); }

struct Surface {
  float z;       // below 0: it closes a solid
  bool is_open;  // it may
};

/// The nearest surface farther than `beyond`; of those that are equally near, the better known one: one that closes a
/// solid, or else a front.
Surface next_surface(int index, int plane, float beyond) {
  Surface next = Surface(kSkyDepth, false);
  for (uint i = 0u; i < planes(); i++) {
    const float z = found[index + int(i) * plane];
    const bool is_open = (params.open_planes >> i & 1u) != 0u;
    const bool is_better = z < next.z || z == next.z && next.is_open && !is_open;
    const bool is_next = abs(z) > beyond && (abs(z) < abs(next.z) || abs(z) == abs(next.z) && is_better);
    next.z = is_next ? z : next.z;
    next.is_open = is_next ? is_open : next.is_open;
  }
  for (uint i = 0u; i < kWarped; i++) {
    const float z = warped_depth(index + int(i) * plane);
    const bool is_next = z > beyond && z < abs(next.z);
    next.z = is_next ? z : next.z;
    next.is_open = is_next ? false : next.is_open;
  }
  return next;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel), plane = params.view.size.x * params.view.size.y;
  const float first = depth[index];
  uint before = 0u;
  for (uint i = 0u; i < planes(); i++)
    before += abs(found[index + int(i) * plane]) < first - separation_at(first) ? 1u : 0u;
  float last = first;
  uint unknown = 0u;
  for (uint k = 0u; k < kKept; k++) {
    const Surface next =
        last < kSkyDepth ? next_surface(index, plane, last + separation_at(last)) : Surface(kSkyDepth, false);
    hidden[index + int(k) * plane] = next.z;
    unknown |= next.is_open ? 1u << k : 0u;
    last = abs(next.z);
    if (last < kSkyDepth) atomicAdd(counts.surfaces, 1u);
  }
  open[index] = unknown;
  uint dropped = 0u;
  for (; last < kSkyDepth; dropped++) last = abs(next_surface(index, plane, last + separation_at(last)).z);
  if (dropped > 1u) atomicAdd(counts.dropped, dropped - 1u);
  if (first < kSkyDepth && before > 0u) atomicAdd(counts.before, before);
}
