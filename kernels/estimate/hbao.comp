// Ambient occlusion by horizons in even directions of the image (HBAO): the part of the hemisphere below them, every
// direction counting the same.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals.
// Out: visibility, 1 = open.
//
// Bavoil and Sainz, "Image-Space Horizon-Based Ambient Occlusion", 2008. Elevations are above the plane across the view
// ray. The steps have their numbers at the code:
//  1. Directions are even on the image. Off axis they are not even about the view ray; each is weighted by the ratio of
//     the two.
//  2. The tangent plane has the elevation t in a direction. A bias raises it.
//  3. A sample is moved into its slice parallel to the tangent plane, so a flat surface stays open at every tilt.
//  4. The horizon h begins at t. Each sample that stands above it raises it, and adds W * (sin h - sin h before): W is
//     the attenuation by the sample's distance. Without attenuation the sum is sin h - sin t.
//  5. The occlusion is the mean of these sums over the directions: 1/(2 pi) times the integral of the paper.
// This is uniform, not cosine-weighted AO: beside a wall whose rim stands at 45 degrees it is 0.75, and GTAO's is
// 0.854. Without attenuation whatever is within reach on the image blocks, at any distance: beside an endless wall the
// result is 1 - acos(d / R) / pi.
//
// `from_surface` gives the simpler form of many engines: the sine of the horizon's elevation above the surface itself,
// which is the cosine of its angle to the normal. The two are equal where the surface faces the eye.
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
layout(constant_id = 0) const uint kSlices = 3;              // lines through a pixel, each searched to both sides
layout(constant_id = 1) const uint kSteps = 6;               // steps to each side
layout(constant_id = 2) const uint kFalloff = kFalloffNone;  // one of kFalloff* of slice.glsl, the attenuation W
layout(constant_id = 3) const uint kSparse = 0;              // 1: only the sites of the list are estimated
layout(scalar, push_constant) uniform Push { HbaoParams params; };
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

/// One direction on the image and the half-plane of view space that is seen along it.
struct Direction {
  vec3 along_t, along_v;  // in-slice coordinates of an offset, moved into the slice parallel to the tangent plane
  vec2 normal;            // the normal in the slice, along T and V; its length is the part of it that lies in the slice
  vec2 direction_px;      // pixels per step, the longer component +-1
  float reach;            // steps of direction_px within the radius and the image
  float least_height;     // of a sample: see clearance.glsl
};

/// The occlusion in one direction: sin h - sin t, attenuated.
float occlusion(Direction side, ivec2 pixel, vec3 position, float jitter) {
  const int steps = int(kSteps), count = min(steps, int(side.reach));
  const float weight = length(side.normal);
  // 2. The sine that samples must exceed: that of the tangent, raised by the bias, or that of the bias alone.
  const vec2 across = vec2(side.normal.y, -side.normal.x) / weight;  // the tangent, as its own cosine and sine
  float horizon = params.from_surface != 0 ? params.bias
                                           : across.y * sqrt(1.0 - params.bias * params.bias) + across.x * params.bias;
  float sum = 0.0;
  for (int k = 0; k < count; k++) {
    const float x = (float(k) + jitter) / float(steps);
    // Dense near the receiver, and never two samples in one pixel.
    const float step_px = count < steps ? float(k + 1) : max(float(k + 1), x * x * side.reach);
    const ivec2 hit = pixel + ivec2(round(side.direction_px * step_px));
    const float z = occluder_depth[index_of(params.view, hit)];
    if (z >= kSkyDepth) continue;
    // 3.
    const vec3 delta = position_of(params.view, vec2(hit) + 0.5, z) - position;
    const vec2 in_slice = vec2(dot(delta, side.along_t), dot(delta, side.along_v));
    const float unit = inversesqrt(dot(in_slice, in_slice));
    const float squared_distance = dot(delta, delta);
    const float height = dot(in_slice, side.normal);
    const bool clear =
        height > side.least_height + least_rise(params.view) * step_px * (params.view.orthographic == 0 ? z : 1.0);
    const bool above = clear && is_elevated(height, 1.0 / kLeastElevation, squared_distance);
    const float elevation = unit * (params.from_surface != 0 ? height : in_slice.y);
    if (!above || in_slice.x <= 0.0 || elevation <= horizon) continue;
    // 4.
    sum +=
        falloff_weight(kFalloff, sqrt(squared_distance), params.falloff_start, params.radius) * (elevation - horizon);
    horizon = elevation;
  }
  return sum;
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
  const vec2 tangent = tangent_of(params.view, vec2(pixel) + 0.5);
  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z);
  const vec3 eye = toward_eye(params.view, position);
  const vec3 n = unpack_normal(normal[index]);
  const vec2 noise = pixel_noise(pixel + params.noise_origin, params.noise_shift);
  // The sphere of the radius is seen under this angle; 1 and more: it holds the eye, and the image is the only limit.
  const float sin_reach = perspective ? params.radius * inversesqrt(dot(position, position)) : 0.0;

  const float clearance = least_height(params.depth_precision, z, (perspective ? dot(n.xy, tangent) : 0.0) - n.z);

  float blocked = 0.0, whole = 0.0;
  for (uint s = 0u; s < kSlices; s++) {
    // 1. An even direction of the image, and the tangent of the view ray that is seen along it.
    const float angle = kPi * (float(s) + noise.x) / float(kSlices);
    const vec3 direction = vec3(direction_of(angle), 0);
    // directions about the view ray for one of the image
    const float toward = dot(direction, eye), share = 1.0 / (1.0 - toward * toward);
    const vec3 t = (direction - toward * eye) * sqrt(share), b = cross(t, eye);
    const float n_t = dot(n, t);
    const float n_v = dot(n, eye);
    const float weight_squared = n_t * n_t + n_v * n_v;
    whole += 2.0 * share;
    if (weight_squared < kLeastWeight * kLeastWeight) continue;

    const vec2 image_t = (perspective ? t.xy + tangent * t.z : t.xy) / params.view.tangent_per_pixel;
    const float pixels = max(abs(image_t.x), abs(image_t.y));
    const vec3 shift = b * (dot(n, b) / weight_squared);
    for (int sign = -1; sign <= 1; sign += 2) {
      Direction side;
      side.along_t = float(sign) * (t + n_t * shift);
      side.along_v = eye + n_v * shift;
      side.normal = vec2(float(sign) * n_t, n_v);
      side.direction_px = float(sign) / pixels * image_t;
      side.least_height = clearance;
      side.reach = min(steps_to_border(params.view, pixel, side.direction_px),
                       steps_in_sphere(params.view, pixels, eye.z, float(sign) * t.z, sin_reach, params.radius));
      blocked += share * occlusion(side, pixel, position, fract(noise.y + kGolden * float(2u * s + uint(sign > 0))));
    }
  }
  ao[ao_index] = clamp(1.0 - blocked / whole, 0.0, 1.0);  // 5.
}
