// Ambient occlusion by horizon search in slices through the view ray (GTAO), cosine weighted, at full resolution.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals. Out: visibility, 1 = open.
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, with these differences:
// - Slices are even in azimuth about the view ray, not on the screen, so that no Jacobian is owed off axis.
// - The reach is the exact image of the sphere of the radius in the slice, clipped to the image: what is outside is unknown.
// - A sample lies at a pixel's centre, up to half a pixel beside the slice. It is moved into the slice parallel to the receiver's
//   tangent plane, which keeps its height above it: a flat surface stays open at every tilt, whatever pixel a step snaps to.
// - What is blocked ends where the eye's ray through the first sample leaves the sphere of the radius: all that is behind a surface counts as
//   solid, but nothing beyond the radius blocks. A ceiling leaves the view below it open, as ray tracing does.
// - Falloff weighs each arc by the distance of the sample that first blocks it ("incremental arcs"), exact for height fields.
// - Result 1 - (sum of blocked arcs) / (sum of whole arcs): exactly 1 where nothing rises above the tangent plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "horizon.h"
#include "view.glsl"
#include "normal.glsl"
#include "arcs.glsl"
#include "noise.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kHorizonSlicesId) const uint kSlices = 3;
layout(constant_id = kHorizonStepsId) const uint kSteps = 6;
layout(constant_id = kHorizonFalloffId) const uint kFalloff = kFalloffNone;
layout(scalar, push_constant) uniform Push { HorizonParams params; };
layout(scalar, binding = kHorizonDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kHorizonNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kHorizonAo) writeonly buffer Ao { float ao[]; };

/// Slices whose plane the normal is nearly perpendicular to weigh less than this and are left out.
const float kLeastWeight = 1e-4;

/// Steps grow with the square of the distance, so that near occluders are not missed. More steps than this are enough to sample all of the reach densely
/// instead: the exponent is then the one with which the first step is a pixel long.
const uint kManySteps = 16;

/// Two samples on either side of the sphere of the radius whose squared distances are within this factor of its square are taken for one surface.
const float kSameSurface = 1.44;

/// The sine of an elevation above the tangent plane below which a sample is the surface itself, raised by rounding: it would block a millionth.
const float kLeastElevation = 1e-3;

/// One half of a slice: angles grow from the view ray V towards T; gamma is the normal's angle in it.
struct Side {
  vec3 along_t, along_v;  // in-slice coordinates of an offset, moved into the slice parallel to the tangent plane
  float gamma, cos_gamma, sin_gamma, weight;
  vec2 direction_px;  // pixels a step, the longer component +-1
  float reach;        // steps of direction_px within the radius and the image
};

/// Two unit vectors that with v (v.z > 0) form a right-handed basis, smooth over the image (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
void basis_of(vec3 v, out vec3 x, out vec3 y) {
  const float a = 1.0 / (1.0 + v.z), b = -v.x * v.y * a;
  x = vec3(1.0 - v.x * v.x * a, b, -v.x);
  y = vec3(b, 1.0 - v.y * v.y * a, -v.y);
}

/// How much a hit at this distance blocks.
float falloff_weight(float distance_to_hit) {
  const float x = clamp((distance_to_hit - params.falloff_start) / (params.radius - params.falloff_start), 0.0, 1.0);
  if (kFalloff == kFalloffLinear) return 1.0 - x;
  if (kFalloff == kFalloffQuadratic) return 1.0 - x * x;
  if (kFalloff == kFalloffSmooth) return 1.0 - x * x * (3.0 - 2.0 * x);
  return 1.0;
}

/// Steps of `direction` that stay on the image, from `pixel`.
float steps_to_border(ivec2 pixel, vec2 direction) {
  const vec2 room = mix(vec2(pixel), vec2(params.view.size - 1 - pixel), greaterThan(direction, vec2(0)));
  const vec2 steps = room / max(abs(direction), 1e-6);
  return min(steps.x, steps.y);
}

/// The cosine, in the slice, of where the eye's ray through a sample leaves the sphere of the radius; not above `cosine`.
float exit_cosine(Side side, vec3 position, vec3 delta, float cosine) {
  const vec3 away = params.view.orthographic != 0 ? vec3(0, 0, -1) : normalize(position + delta);
  const float along = dot(delta, away);
  const vec3 exit = delta + (sqrt(max(0.0, along * along - dot(delta, delta) + params.radius * params.radius)) - along) * away;
  const vec2 in_slice = vec2(dot(exit, side.along_t), dot(exit, side.along_v));
  return in_slice.x > 0.0 ? min(cosine, in_slice.y * inversesqrt(dot(in_slice, in_slice))) : -1.0;
}

/// The integral over the angles of a side between its view ray and this cosine, not beyond the tangent plane.
float arc_to(Side side, float cosine) {
  const float clamped = max(cosine, -side.sin_gamma);
  return arc(clamped > -side.sin_gamma ? min(arc_cosine(clamped), side.gamma + kHalfPi) : side.gamma + kHalfPi, clamped, side.cos_gamma, side.sin_gamma);
}

/// The blocked part of a side's arc integral.
float blocked_arc(Side side, ivec2 pixel, vec3 position, float jitter) {
  const uint count = min(kSteps, uint(side.reach));
  const float open_cosine = -side.sin_gamma;  // of the tangent plane's own horizon, gamma + pi/2
  // What is blocked lies between the angles of these two cosines; nothing yet. The far end is where the eye's ray through the first sample leaves the
  // sphere: rays further aside leave it nearer to the eye.
  float near_cosine = open_cosine, far_cosine = 2.0, blocked = 0.0;
  vec3 first = vec3(0);
  float last_cosine = 0.0, last_squared_distance = 1e30;
  bool was_within = true;
  const float squared_radius = params.radius * params.radius;
  const float exponent = clamp(log2(max(side.reach, 1.0)) / log2(float(kSteps)), 1.0, 2.0);
  for (uint k = 0u; k < count; k++) {
    // Never two samples in one pixel: short reaches are searched pixel by pixel.
    const float x = (float(k) + jitter) / float(kSteps), spread = kSteps > kManySteps ? pow(x, exponent) : x * x;
    const float offset = count < kSteps ? float(k + 1u) : max(float(k + 1u), spread * side.reach);
    const ivec2 hit = pixel + ivec2(round(side.direction_px * offset));
    const vec3 delta = position_of(params.view, vec2(hit) + 0.5, depth[index_of(params.view, hit)]) - position;
    const float squared_distance = dot(delta, delta);
    const vec2 in_slice = vec2(dot(delta, side.along_t), dot(delta, side.along_v));
    const float cosine = in_slice.y * inversesqrt(dot(in_slice, in_slice));
    const float height = side.weight * (in_slice.y * side.cos_gamma + in_slice.x * side.sin_gamma);  // above the tangent plane
    const bool above = in_slice.x > 0.0 && height > 0.0 && height * height > kLeastElevation * kLeastElevation * squared_distance;
    const bool within = squared_distance < squared_radius;
    if (kFalloff == kFalloffNone) {
      // A surface that crosses the sphere between two samples blocks up to there; the point lies on the sphere, so it is its own exit.
      const bool crosses = above && within != was_within && max(squared_distance, last_squared_distance) < kSameSurface * squared_radius &&
                           min(squared_distance, last_squared_distance) * kSameSurface > squared_radius;
      const float part = (squared_radius - squared_distance) / (last_squared_distance - squared_distance);
      const float crossing = crosses ? mix(cosine, last_cosine, part) : -2.0;
      was_within = within;
      last_squared_distance = above ? squared_distance : 1e30;
      last_cosine = cosine;
      near_cosine = max(near_cosine, max(crossing, above && within ? cosine : -1.0));
      if (above && within && far_cosine > 1.0) {
        far_cosine = crosses ? crossing : cosine;
        first = delta;
      }
    } else if (above && within) {
      // Each arc counts with the weight of the sample that blocks it first.
      const float weight = falloff_weight(sqrt(squared_distance));
      if (far_cosine > 1.0) near_cosine = far_cosine = exit_cosine(side, position, delta, cosine);
      if (cosine > near_cosine) blocked += weight * max(arc_to(side, near_cosine) - arc_to(side, cosine), 0.0);
      near_cosine = max(near_cosine, cosine);
    }
  }
  if (kFalloff == kFalloffNone && far_cosine <= 1.0)
    blocked = max(arc_to(side, exit_cosine(side, position, first, far_cosine)) - arc_to(side, near_cosine), 0.0);
  return blocked;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel);
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[index] = 1.0;
    return;
  }

  const bool perspective = params.view.orthographic == 0;
  const vec2 tangent = tangent_of(params.view, vec2(pixel) + 0.5);
  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z), eye = toward_eye(params.view, position), n = unpack_normal(normal[index]);
  const vec2 noise = pixel_noise(pixel + params.noise_origin, params.noise_shift);
  vec3 basis_x, basis_y;
  basis_of(eye, basis_x, basis_y);

  // The sphere of the radius is seen under this angle; 1 and more: it holds the eye, and the image is the only limit.
  const float sin_reach = perspective ? params.radius * inversesqrt(dot(position, position)) : 0.0;
  const float cos_reach = sqrt(max(0.0, 1.0 - sin_reach * sin_reach));

  float blocked = 0.0, whole = 0.0;
  for (uint s = 0u; s < kSlices; s++) {
    const float azimuth = kPi * (float(s) + noise.x) / float(kSlices);
    const vec3 t = cos(azimuth) * basis_x + sin(azimuth) * basis_y, b = cross(t, eye);
    const float n_t = dot(n, t), n_v = dot(n, eye), n_b = dot(n, b);
    const float weight_squared = n_t * n_t + n_v * n_v, weight = sqrt(weight_squared);
    if (weight < kLeastWeight) continue;
    const float cos_gamma = n_v / weight, sin_gamma = n_t / weight, gamma = angle_of(cos_gamma, sin_gamma);
    whole += weight * (cos_gamma + gamma * sin_gamma);

    // The image of t at this pixel: the slice is a straight line on the image.
    const vec2 image_t = (perspective ? t.xy + tangent * t.z : t.xy) / params.view.tangent_per_pixel;
    const float pixels = max(abs(image_t.x), abs(image_t.y));
    const vec3 shift = b * (n_b / weight_squared);
    for (int sign = -1; sign <= 1; sign += 2) {
      Side side;
      side.along_t = float(sign) * (t + n_t * shift);
      side.along_v = eye + n_v * shift;
      side.gamma = float(sign) * gamma;
      side.cos_gamma = cos_gamma;
      side.sin_gamma = float(sign) * sin_gamma;
      side.weight = weight;
      side.direction_px = float(sign) / pixels * image_t;
      const float forward = perspective ? eye.z * cos_reach - float(sign) * t.z * sin_reach : 1.0;
      const float reach = perspective ? sin_reach * pixels / forward : params.radius * pixels;
      const float border = steps_to_border(pixel, side.direction_px);
      side.reach = sin_reach < 1.0 && forward > 0.0 ? min(reach, border) : border;
      blocked += weight * blocked_arc(side, pixel, position, fract(noise.y + kGolden * float(2u * s + uint(sign > 0))));
    }
  }
  ao[index] = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
}
