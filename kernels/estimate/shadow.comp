// The part of a light that each pixel sees.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals; how far back each pixel is solid.
// Out: visibility of the light, 1 = lit.
//
// In the slice through the view ray and the light, the light is a direction, and horizon.comp's search (runs.glsl) says
// which directions are blocked. The steps have their numbers at the code:
//  1. A surface that faces away from the light has 0.
//  2. The search takes the one side of the slice where the light is, from pixel to pixel near the receiver, so that
//     nothing is left to noise. It ends at the image of the light, or of the farthest place that may block.
//  3. The sphere of its radius goes through the lamp: what is farther away does not block it.
//  4. Only where some sample lies before the ray to the light anything can block it: of a run its front is what is
//     nearest to the eye. Else nothing is searched.
//  5. Sectors (sectors.glsl) are shifted so that the light lies on the border of one of them, which then tells exactly
//     whether it is blocked.
//  6. A light of some size is sampled in several directions, which differ between neighbours.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/noise.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/moments.glsl"
#include "kernels/estimate/arc_moments.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"
#include "kernels/estimate/sectors.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
// bits of kThickness*, kCompletes* and kTellsBacks, and kHiddenSurface times as many surfaces as a pixel may have
// behind the first
layout(constant_id = 0) const uint kSolid = kThicknessWidth | kCompletesBorder | kCompletesHidden | kTellsBacks;
layout(constant_id = 1) const uint kDirections = 1;  // of the light
// So many samples of a side lie a pixel apart. Behind them each gap is larger than the one before.
layout(constant_id = 2) const int kDense = 32;
layout(scalar, push_constant) uniform Push { ShadowParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
// one float per pixel, depth of the first surfaces that may block
readonly buffer Occluders { float occluder_depth[]; };
readonly buffer Hidden { float hidden[]; };   // planes of hidden surfaces that may block, see GBuffer; with layers only
readonly buffer Backs { uint backs[]; };      // one uint per pixel, from backs; only with kTellsBacks
writeonly buffer Result { float result[]; };  // one float per pixel, in [0, 1]

// Of the constants that runs.glsl asks for.
const int kSurfaces = ALCOVE_SURFACES;
const uint kFalloff = kFalloffNone, kOrder = 0u;
const bool kHard = true, kCurved = false, kAllInSectors = false;
const uint kThickness = kSolid & 3u;
const bool kBeyondBorder = (kSolid & kCompletesBorder) != 0u;
const bool kBehindOthers = (kSolid & kCompletesHidden) != 0u;
const bool kHasBacks = (kSolid & kTellsBacks) != 0u;

const uint kSteps = uint(kDense) + 64u;  // of a side at most
const float kGapGrowth = 0.25;           // px for each sample, of a side that needs no more than kSteps

/// The growth of gaps with which kSteps are enough for a side.
float growth_of(float reach) {
  const float most = float(kSteps) - float(kDense);
  return max(kGapGrowth, (reach - float(kDense) - most) / (most * most));
}

int steps_of(float reach, float growth) {
  const float beyond = max(reach - float(kDense), 0.0);
  return min(int(kSteps), min(int(reach), kDense) + int((sqrt(1.0 + 4.0 * growth * beyond) - 1.0) / (2.0 * growth)));
}

/// Steps from the receiver to sample k. The draw's jitter is the growth of the gaps.
float offset_of(int k, int count, Side side, Draw draw) {
  const float beyond = max(float(k + 1 - kDense), 0.0);
  return float(k + 1) + draw.jitter * beyond * beyond;
}

// The light in the slice that is searched.
float light_slope;  // slope_of() its direction
uint light_sector;  // its bit

bool is_settled(float near, uint sectors) {
  return kThickness != kThicknessEndless && near > light_slope || (sectors & light_sector) != 0u;
}
bool is_concerned(float slope) { return slope >= light_slope; }

#include "kernels/estimate/runs.glsl"

/// Beyond the border nothing goes on farther than this: as tangent, and with parallel rays in radii. Farther away it is
/// more often wrong than right.
const float kTangentBeyond = 0.3, kSizesBeyond = 4.0;

/// A light so near to the eye's ray, by its sine, is seen wherever the eye sees.
const float kLeastSine = 1e-4;

/// 4. Whether a sample lies before the ray to the light, whose direction in the slice is (across, toward): before the
/// eye's ray and not below it as seen from the receiver.
bool is_any_before(Receiver r, Side side, Reach reach, Draw draw, int count, vec2 light) {
  const float facing = light.x * r.ray_length;
  const vec2 change = light.x * side.toward - light.y * side.across;
  // Rounding may hide nothing.
  const float most = 1.00001 * facing * r.z + 1e-6 * abs(light.y) * r.z;
  const int plane = params.view.size.x * params.view.size.y;
  bool found = false;
  int k = 0;
  if (count > 0) {
    do {
      const vec2 beside = round(side.direction_px * offset_of(k, count, side, draw));
      const int index = (r.pixel.y + int(beside.y)) * reach.width + r.pixel.x + int(beside.x);
      const float across = dot(change, beside);
      float z = occluder_depth[index];
      for (int i = 1; i < kSurfaces; i++) z = lesser(abs(hidden[index + (i - 1) * plane]), z);
      const float ahead = r.perspective ? z * (facing - across) : facing * z - across;
      found = found || ahead <= most;
    } while (++k < count && !found);
  }
  return found;
}

/// 4. The same of the samples beyond the border, each on the plane of the border's nearest pixel.
bool is_any_beyond_before(Receiver r, Side side, Reach reach, Draw draw, vec3 position, vec3 direction, float sine_px) {
  const float first = floor(side.reach), gap = gap_beyond(side, reach, first);
  bool found = false;
  int k = 0;
  do {
    const float offset = first + gap * (float(k) + draw.jitter);
    const float far = r.perspective ? offset * r.z / (sine_px + offset * direction.z) : offset / sine_px;
    const ivec2 pixel = r.pixel + ivec2(round(side.direction_px * offset));
    const ivec2 nearest = clamp(pixel, ivec2(0), params.view.size - 1);
    const int index = nearest.y * reach.width + nearest.x;
    const vec3 n = octahedral_direction(unpackSnorm2x16(normal[index]));
    const float z = occluder_depth[index];
    const vec3 from = position_of(params.view, vec2(nearest) + 0.5, z);
    found = both(z < kSkyDepth, dot(n, position + far * direction - from) <= 1e-5 * z) ? true : found;
  } while (++k <= kStepsBeyond && !found);
  return found;
}

/// Steps to the image of a place so far along the ray to the light; kEndless: it is behind the eye.
float steps_to(Receiver r, Slice slice, vec3 direction, float sine, float far) {
  const float pixels = max(abs(slice.image_t.x), abs(slice.image_t.y));
  const float z = r.perspective ? r.z - far * direction.z : 1.0;
  return z > 0.0 ? far * sine * pixels / z : kEndless;
}

/// Whether a light is blocked, from its direction and its distance, or that of the farthest place that may block.
bool is_blocked(View view, Receiver r, vec3 position, vec3 direction, float far) {
  const float cosine = dot(direction, r.eye);
  const vec3 across = direction - cosine * r.eye;
  const float sine = length(across);
  if (sine < kLeastSine) return false;
  const Slice slice = slice_along(view, r, across / sine, 1.0);
  Reach reach = reach_of(view, far, 0.0, far, params.thickness, params.bias);
  reach.size = params.size;
  reach.front_sq = kBeyondSq;
  Side side = side_of(view, r, slice, 1.0, reach);
  side.whole_reach = steps_to(r, slice, direction, sine, far);  // 2.
  side.reach = min(steps_to_border(view, r.pixel, side.direction_px), side.whole_reach);
  light_slope = slope_of(vec2(sine, cosine));
  const float sector = 0.5 * float(kSectorCount) * (light_slope + 1.0);
  light_sector = 1u << uint(sector);
  const Draw draw = Draw(growth_of(side.reach), 1.0 - fract(sector));  // 5.
  const int count = steps_of(side.reach, draw.jitter);
  const bool is_before = is_any_before(r, side, reach, draw, count, vec2(sine, cosine));
  const float most = view.orthographic == 0 ? kTangentBeyond : kSizesBeyond * params.size;
  side.whole_reach = min(side.whole_reach, side.reach + most / reach.pixel_size);
  bool is_beyond = kBeyondBorder && side.reach < side.whole_reach;
  if (is_beyond) {
    const float pixels = max(abs(slice.image_t.x), abs(slice.image_t.y));
    is_beyond = is_any_beyond_before(r, side, reach, draw, position, direction, sine * pixels);
  }
  if (!is_before && !is_beyond) return false;
  side.whole_reach = is_beyond ? side.whole_reach : side.reach;
  const Blocked all = all_of(search(r, side, reach, draw, is_before ? count : 0));
  return (all.sectors & light_sector) != 0u || both(all.near > light_slope, all.far <= light_slope);
}

/// Where nothing bounds the reach: depths of the receiver.
const float kFarther = 1048576.0;

/// A direction to the light, and how far away it is: with two numbers in [0, 1), a place of its disc.
vec4 towards(vec3 position, vec2 place) {
  const bool is_lamp = params.is_lamp != 0u;
  const vec3 way = is_lamp ? params.light - position : params.light;
  const float distance = length(way);
  vec3 direction = way / max(distance, 1e-30);
  if (kDirections > 1u) {
    vec3 x, y;
    const float turn = direction.z < 0.0 ? -1.0 : 1.0;
    basis_of(turn * direction, x, y);
    const vec2 offset = sqrt(place.x) * params.spread / (is_lamp ? max(distance, params.spread) : 1.0) *
                        direction_of(2.0 * kPi * place.y);
    direction = normalize(direction + offset.x * x + offset.y * y);
  }
  const float reach = params.reach > 0.0 ? params.reach : kFarther * power_of_two(-position.z);
  return vec4(direction, is_lamp ? min(distance, reach) : reach);
}

void main() {
  const View view = params.view;
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(view, pixel)) return;
  const int index = index_of(view, pixel), at = index + int(params.plane) * view.size.x * view.size.y;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    result[at] = 1.0;
    return;
  }
  const Receiver r = receiver_at(view, pixel, z, unpack_normal(normal[index]), params.size, params.depth_precision);
  const vec3 position = position_of(view, vec2(pixel) + 0.5, z);
  const vec2 noise = pixel_noise(pixel + params.noise_origin, params.noise_shift);
  float seen = 0.0;
  for (uint k = 0u; k < kDirections; k++) {
    const vec2 place = vec2((float(k) + noise.x) / float(kDirections), fract(noise.y + kGolden * float(k)));  // 6.
    const vec4 light = towards(position, place);
    if (dot(light.xyz, r.normal) > 0.0 && !is_blocked(view, r, position, light.xyz, light.w)) seen += 1.0;  // 1.
  }
  result[at] = seen / float(kDirections);
}
