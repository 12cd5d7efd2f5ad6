// Estimates ambient occlusion by samples in the hemisphere above the surface, as engines do it after Crytek: how much
// of its volume is hidden.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals.
// Out: visibility, 1 = open.
//
// Mittring, "Finding Next Gen: CryEngine 2", 2007, with the hemisphere in the place of the sphere. It measures volume,
// not visibility: beside an infinite wall at distance c R the uniform kernel gives 1 - (1 - c)^2 (2 + c) / 4. What is
// particular here:
// - A sample is compared with the depth of the pixel that it falls into, on the ray of that pixel's centre. It is moved
//   there parallel to the receiver's tangent plane, which keeps its height above it. A flat surface stays open at every
//   tilt, with no bias at all.
// - The basis about the normal is built from the normal alone and turned by the noise, so no noise vector can be
//   parallel to it.
// - Samples behind the eye, outside the image and before the sky do not count. What is hidden is divided by the number
//   of those that do.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/noise.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kSamples = 16;  // samples per pixel
layout(constant_id = 1) const uint kSparse = 0;    // 1: only the sites of the list are estimated
layout(scalar, push_constant) uniform Push { CrytekParams params; };
readonly buffer Depth { float depth[]; };  // one float per pixel, from prepare
// one float per pixel, depth of the first surfaces that may block
readonly buffer Occluders { float occluder_depth[]; };
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
// one float per pixel, visibility in [0, 1], 1 = open; the plane of the parameters
writeonly buffer Ao { float ao[]; };
readonly buffer List { uint list[]; };                         // one uint per listed tile, from classify
readonly buffer Sites { uint sites[]; };                       // one uint per site, from list_sites; only if sparse
readonly buffer SiteCountsBuffer { SiteCounts site_counts; };  // only if sparse
readonly buffer Counts { TileCounts counts; };

/// The least turn of a pixel's ray towards the tangent plane with which it meets the plane at a usable place.
const float kLeastSlope = 1e-4;

/// The distance of sample i from the receiver, in radii, by a random number in [0, 1). Clustered samples spread with
/// the square of their number from a tenth of the radius on, as engines usually scale them.
float reach_of(uint i, float random) {
  const float x = float(i) / float(kSamples);
  return params.uniform_volume != 0 ? pow(x + random / float(kSamples), 1.0 / 3.0) : (0.1 + 0.9 * x * x) * random;
}

/// The weight of a hit whose depth differs by this much from the receiver's.
float range_weight(float depth_difference) {
  if (params.range_check == kRangeNone) return 1.0;
  const float dz = abs(depth_difference);
  if (params.range_check == kRangeSmoothstep) return 1.0 - smoothstep(0.0, params.radius, dz);
  return smoothstep(0.0, 1.0, params.radius / max(dz, 1e-6 * params.radius));  // 1 for dz = 0
}

#include "kernels/estimate/receivers.glsl"

void main() {
  const ListedPixel here = listed_pixel(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
  if (!here.exists) return;
  const ivec2 pixel = here.pixel;
  const int index = index_of(params.view, pixel);
  const int ao_index = index + int(params.plane) * params.view.size.x * params.view.size.y;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[ao_index] = 1.0;
    return;
  }

  const bool perspective = params.view.orthographic == 0;
  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z);
  const vec3 n = unpack_normal(normal[index]);
  vec3 tangent, bitangent;
  const float turn_z = n.z < 0.0 ? -1.0 : 1.0;
  basis_of(turn_z * n, tangent, bitangent);
  bitangent *= turn_z;

  const uint first_point = kSamples * hilbert_index(uvec2(pixel + params.noise_origin));
  const float clearance = least_height(
      params.depth_precision, z, (perspective ? dot(n.xy, tangent_of(params.view, vec2(pixel) + 0.5)) : 0.0) - n.z);
  float valid = 0.0, blocked = 0.0;
  for (uint i = 0u; i < kSamples; i++) {
    const vec3 random = r3_point(first_point + i, params.noise_shift);
    // a full turn, the half of it by its sign
    const float azimuth = kPi * fract(2.0 * random.x);
    const vec2 turn = random.x < 0.5 ? direction_of(azimuth) : -direction_of(azimuth);
    const float up = random.y;
    const float across = sqrt(1.0 - up * up);
    const float reach = params.radius * reach_of(i, random.z);
    const float height = reach * up;  // above the tangent plane
    const vec3 at = position + reach * (across * (turn.x * tangent + turn.y * bitangent) + up * n);
    if (perspective && !(-at.z > 0.0)) continue;
    const ivec2 hit = pixel_of(params.view, at);
    if (!inside(params.view, hit)) continue;
    const float hit_z = occluder_depth[index_of(params.view, hit)];
    if (hit_z >= kSkyDepth) continue;
    valid += 1.0;

    // of unit depth
    const vec3 ray = position_of(params.view, vec2(hit) + 0.5, 1.0) - position_of(params.view, vec2(hit) + 0.5, 0.0);
    const vec3 offset = position_of(params.view, vec2(hit) + 0.5, hit_z) - position;
    const float hit_height = dot(n, offset), slope = -dot(n, ray);
    // How much deeper than the hit the sample lies on the hit's ray: by height; where that ray does not meet the
    // tangent plane, by depth.
    const float deeper =
        slope > kLeastSlope ? min((hit_height - height) / slope, -at.z + params.radius - hit_z) : -at.z - hit_z;
    const ivec2 aside = abs(hit - pixel);
    const bool clear =
        hit_height > clearance + least_rise(params.view) * float(max(aside.x, aside.y)) * (perspective ? hit_z : 1.0);
    const bool above = clear && is_elevated(hit_height, 1.0 / kLeastElevation, dot(offset, offset));
    if (above && deeper > params.bias) blocked += range_weight(hit_z - z);
  }
  ao[ao_index] = valid > 0.0 ? max(0.0, 1.0 - blocked / valid) : 1.0;  // a / a may be more than 1
}
