// Takes the mean of what many frames estimate, each where it sees the same point.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: depth and normals of a frame and of others, what each estimates, and where something moves between them.
// Out: sums over the frames, and their mean.
//
// True AO of what stands still does not change with the camera. So what another frame estimates counts where it shows
// the same point: each lies in the plane of the other, as exactly as the depth is and half a pixel's slope, and their
// normals agree; and where nothing within the radius of it moves from the one frame to the other. Toward what moves it
// counts less and less over the width of a cell, so that no line shows where the mean ends. What a frame cannot tell of
// a point is left out, so that nothing has to be clamped, and no result is made from an earlier one. Else all count the
// same: weights by distance, by the angle or by how sure an estimate is were no nearer to ray tracing.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/time/accumulate.h"
#include "kernels/base/reprojection.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/moments.glsl"
#include "kernels/base/reprojection.glsl"
#include "kernels/time/sight.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kPlanes = 1;     // of values
layout(constant_id = 1) const int kListed = 0;     // frames that the buffer lists, 0 to kMostNeighbours
layout(constant_id = 2) const uint kOrder = 0;     // of the moments among the planes, 0 to 2
layout(constant_id = 3) const int kCurvature = 0;  // planes of curvature, after the moments
layout(scalar, push_constant) uniform Push { AccumulateParams params; };
readonly buffer Depth { float depth[]; };    // one float per pixel of the part, planar depth
readonly buffer Normal { uint normal[]; };   // one uint per pixel of the part, see normal.glsl
readonly buffer Values { float values[]; };  // planes of floats in [0, 1] over all of the frame: its own estimate
readonly buffer Others { uint others[]; };   // planes of other frames, as words
readonly buffer Frames { NeighbourFrame frames[]; };
readonly buffer Near { uint near[]; };  // words of cells, from moved
// planes of floats: how many estimates there are, or parts of them, and for each plane of values the sum of what they
// are less than 1; not read where they begin
buffer Sums { float sums[]; };
writeonly buffer Ao { float ao[]; };            // where the sums end: the first plane of values
writeonly buffer Scales { float scales[]; };    // those of radii, which follow it
writeonly buffer Moments { float moments[]; };  // those of moments and curvature, which are the last ones

/// Normals of one point differ by rounding and by how files filter them: as the cosine between them.
const float kLeastAgreement = 0.9;

/// The same surface may lie so far off a plane, in widths of a pixel: half of one changes so much on a slope.
const float kHalfPixel = 0.5;

int pixels_of(ivec2 size) { return size.x * size.y; }

/// The pixel of another frame that shows the point at this place in the frame's view space, with this normal; -1: none
/// does. second: the word of its second plane.
int index_in(NeighbourFrame other, vec3 here, vec3 n, out uint second) {
  const View to = other.view;
  const vec3 position = position_there(other, here), facing = direction_there(other, n);
  const ivec2 place = pixel_of(to, position), nearest = clamp(place, ivec2(0), to.size - 1);
  const int index = index_of(to, nearest);
  const float z = abs(uintBitsToFloat(others[other.first + uint(index)]));
  const vec3 beside = position_of(to, vec2(nearest) + 0.5, finite_depth(z)) - position;
  second = others[other.first + uint(index + pixels_of(to.size))];
  const vec3 seen = normalize(octahedral_direction(unpackSnorm4x8(second).xy));
  const float tolerance =
      kPrecisions * error_at(other.depth_precision, finite_depth(z)) + kHalfPixel * pixel_width(to, finite_depth(z));
  const bool is_same = -position.z > 0.0 && place == nearest && z < kSkyDepth && (second & 0xffffu) != kNoTakenNormal &&
                       abs(dot(beside, facing)) <= tolerance && abs(dot(beside, seen)) <= tolerance &&
                       dot(facing, seen) >= kLeastAgreement;
  return is_same ? index : -1;
}

/// The eight cells about a place: what their words say, and how far from the first towards the last it lies, 0 to 1.
struct Around {
  uint moves[8];
  vec3 within;
};

Around around(vec3 here) {
  const vec3 place = in_cells(here, params.radius) - 0.5;
  Around cells;
  [[unroll]] for (int k = 0; k < 8; k++) cells.moves[k] =
      near[place_of_cell(ivec3(floor(place)) + (ivec3(k, k >> 1, k >> 2) & 1))];
  cells.within = fract(place);
  return cells;
}

/// How much of what lies about a place stands still from the other frame of that bit to this one: 1 where no cell tells
/// of movement near it, 0 where all do, and a linear function between their middles.
float still_share(Around cells, uint bit) {
  float still[8];
  [[unroll]] for (int k = 0; k < 8; k++) still[k] = (cells.moves[k] >> bit & 1u) != 0u ? 0.0 : 1.0;
  [[unroll]] for (int k = 0; k < 4; k++) still[k] = still[2 * k] + cells.within.x * (still[2 * k + 1] - still[2 * k]);
  [[unroll]] for (int k = 0; k < 2; k++) still[k] = still[2 * k] + cells.within.y * (still[2 * k + 1] - still[2 * k]);
  return still[0] + cells.within.z * (still[1] - still[0]);
}

void main() {
  // All is loaded before the condition: see shared.h.
  const ivec2 invoked = ivec2(gl_GlobalInvocationID.xy), pixel = min(invoked, params.size - 1);
  const ivec2 in_frame = pixel + params.corner;
  const int index = pixel.y * params.size.x + pixel.x, plane = pixels_of(params.size);
  const int whole = index_of(params.view, in_frame);
  const bool begins = (params.stage & kAccumulateBegins) != 0u, ends = (params.stage & kAccumulateEnds) != 0u;
  float count = 1.0, blocked[kPlanes];
  if (!begins) count = sums[index];
  for (int k = 0; k < kPlanes; k++)
    blocked[k] = begins ? 1.0 - values[whole + k * pixels_of(params.view.size)] : sums[index + (k + 1) * plane];
  const float z = depth[index];
  const uint word = normal[index];
  const bool is_surface = z < kSkyDepth && word != kNoNormal;
  const vec3 here = position_of(params.view, vec2(in_frame) + 0.5, finite_depth(z)), n = unpack_normal(word);
  const Around cells = around(here);
  [[unroll]] for (int i = 0; i < kListed; i++) {
    const NeighbourFrame other = frames[i];
    uint words[(kPlanes + 2) / 2];
    const int at = index_in(other, here, n, words[0]), there = pixels_of(other.view.size);
    const bool is_taken = is_surface && at >= 0 && uint(i) < params.frames;
    const float weight = is_taken ? still_share(cells, params.place + uint(i)) : 0.0;
    for (int k = 1; k < (kPlanes + 2) / 2; k++) words[k] = others[other.first + uint(max(at, 0) + (k + 1) * there)];
    count += weight;
    float theirs[kPlanes + 2];
    for (int k = 0; k < kPlanes; k++) {
      const vec2 halves = unpackUnorm2x16(words[(k + 1) / 2]);
      theirs[k] = k % 2 == 0 ? halves.y : halves.x;
    }
    // Moments are of the other frame's view space.
    mat3 turns = mat3(0);
    const int first = kPlanes - moments_in(kOrder) - kCurvature;
    for (int k = 0; k < moments_in(kOrder); k++) turns[k / 3][k % 3] = blocked_moment(theirs[first + k]);
    turns = turned(mat3(other.row_x, other.row_y, other.row_z), turns);
    for (int k = 0; k < moments_in(kOrder); k++) theirs[first + k] = stored_moment(moment(turns, k));
    for (int k = 0; k < kPlanes; k++) blocked[k] += weight * (1.0 - theirs[k]);
  }
  if (any(greaterThanEqual(invoked, params.size))) return;
  sums[index] = count;
  for (int k = 0; k < kPlanes; k++) {
    const float value = 1.0 - blocked[k] / count;
    if (!ends)
      sums[index + (k + 1) * plane] = blocked[k];
    else if (k == 0)
      ao[index] = value;
    else if (k <= params.scales)
      scales[index + (k - 1) * plane] = value;
    else
      moments[index + (k - 1 - params.scales) * plane] = value;
  }
}
