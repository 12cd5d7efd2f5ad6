// The part of a light that each pixel sees.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals; surfaces that may block, and the nearest in every block; how far back each is solid.
// Out: visibility of the light, 1 = lit; or how far it is known, see kConfidence.
//
// The ray to the light is walked along its image, pixel by pixel. The steps have their numbers at the code:
//  1. A surface that faces away from the light has 0.
//  2. A pixel's surface is before the ray or behind it, as seen by the eye. It is moved into the slice of ray and eye
//     parallel to the receiver's tangent plane (slice.glsl), so that no plane shadows itself. The walk ends at the
//     image of the lamp, of the farthest place that may block, or at the border.
//  3. A surface that is before the ray in one pixel and behind it in the next blocks it. So does one that begins in a
//     pixel, if the ray goes from before it to behind it within the pixel: a wire may have no other.
//  4. Behind a surface with edges before the ray, the ray is blocked within the surface's solid: to the known back; or
//     as far as the pixel tells; or as far as the run of its pixels is wide (slice.glsl), or as the user says.
//  5. Farther behind a surface than any solid may be deep a run begins anew. So blocks of pixels that are all behind
//     the ray, or all that far before it, are passed over. From one of these to the other rule 3 is looked at.
//  6. Behind the border the surface of the last pixel goes on a little.
//  7. A light of some size is sampled in several directions, which differ between neighbours.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/noise.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"
#include "kernels/estimate/solids.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
// bits of kThickness*, kCompletesBorder and kTellsBacks, and kHiddenSurface times as many surfaces as a pixel may have
// behind the first
layout(constant_id = 0) const uint kSolid = kThicknessWidth | kCompletesBorder | kTellsBacks;
layout(constant_id = 1) const uint kDirections = 1;  // of the light
// 1: `result` holds the visibility where occluders are thin, and takes the confidence: 1 less its distance to the
// certain visibility. This run takes the thickest occluders. A ray that leaves the image counts by its length, see
// kHalfKnown.
layout(constant_id = 2) const uint kConfidence = 0;
layout(scalar, push_constant) uniform Push { ShadowParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
// one float per pixel, depth of the first surfaces that may block
readonly buffer Occluders { float occluder_depth[]; };
readonly buffer Nearest { vec4 nearest[]; };  // four floats per block, from nearest
readonly buffer Hidden { float hidden[]; };   // planes of hidden surfaces that may block, see GBuffer; with layers only
readonly buffer Backs { uint backs[]; };      // one uint per pixel, from backs; only with kTellsBacks
buffer Result { float result[]; };            // one float per pixel, in [0, 1]

const int kSurfaces = ALCOVE_SURFACES;
const uint kThickness = kSolid & 3u;
const bool kBeyondBorder = (kSolid & kCompletesBorder) != 0u;
const bool kHasBacks = (kSolid & kTellsBacks) != 0u;

/// A run is so many times as thick as it is wide, and so many pixels' widths more; less where it is known what lies
/// behind it, and behind the first surface, where many runs are backs that no front was found for.
const float kThicknessPerWidth = 0.8, kKnownThicknessPerWidth = 0.4, kHiddenThicknessPerWidth = 0.3, kMorePixels = 1.0;

/// Beyond the border nothing goes on farther than this: as tangent, and with parallel rays in radii. Farther away it is
/// more often wrong than right.
const float kTangentBeyond = 0.3, kSizesBeyond = 4.0;

/// So many pixels are looked at one by one before their block is, again: a ray leaves the plane that it starts on.
const int kStepsAlone = 4;

/// A light so near to the eye's ray, by its sine, is seen wherever the eye sees.
const float kLeastSine = 1e-4;

/// Radii after which a ray that leaves the image is as likely blocked beyond as not. It is a guess.
const float kHalfKnown = 4.0;

/// Scene units: where nothing bounds the reach.
const float kFarther = 1e20;

/// A ray to the light on the image.
struct Ray {
  vec3 position, direction;
  float far;           // scene units: where it ends
  vec2 step_px;        // pixels per step; the longer component is +-1
  float steps_across;  // steps per scene unit of the way, at a depth of 1
  float whole_steps;   // to its end, on the image or not; kEndless: any number
  int steps;           // of them, those on the image
  // A surface of depth z so many pixels beside the receiver is before the ray if z * facing - scale * dot(change,
  // beside) <= most; scale: z, or 1 orthographic.
  float facing, most;
  vec2 change;
};

/// 2. The ray in a direction that is cosine * eye + sine * t.
Ray ray_of(View view, Receiver r, vec3 position, vec3 direction, float cosine, float sine, vec3 t, float far) {
  const Slice slice = slice_along(view, r, t, 1.0);
  const float pixels = max(abs(slice.image_t.x), abs(slice.image_t.y));
  const float z = r.perspective ? r.z - far * direction.z : 1.0;
  Ray ray;
  ray.position = position;
  ray.direction = direction;
  ray.far = far;
  ray.step_px = slice.image_t / pixels;
  ray.steps_across = sine * pixels;
  ray.whole_steps = z > 0.0 ? far * ray.steps_across / z : kEndless;
  ray.steps = int(min(steps_to_border(view, r.pixel, ray.step_px), ray.whole_steps));
  ray.facing = sine * r.ray_length;
  ray.most = ray.facing * r.z;
  ray.change = sine * slice.toward - cosine * slice.across;
  return ray;
}

/// What is compared with ray.most.
float ahead(Receiver r, Ray ray, float change, float z) {
  return r.perspective ? z * (ray.facing - change) : z * ray.facing - change;
}
bool is_before(Receiver r, Ray ray, float change, float z) { return ahead(r, ray, change, z) <= ray.most; }

/// How much change there is within half a step. The more change, the more is before the ray.
float half_step(Ray ray) { return 0.5 * abs(dot(ray.change, ray.step_px)); }

/// By how much depth the ray is behind a surface; kSkyDepth: it does not come there.
float depth_behind(Receiver r, Ray ray, float change, float z) {
  const float facing = r.perspective ? ray.facing - change : ray.facing;
  const float there = (r.perspective ? ray.most : ray.most + change) / facing;
  return facing > 0.0 ? there - z : kSkyDepth;
}

/// 5. Whether the ray is farther behind a surface than any solid is deep. Hidden solids may be of any depth.
bool is_deep(Receiver r, Ray ray, float change, float z) {
  const bool is_endless = kThickness == kThicknessEndless || kSurfaces > 1;
  const float most = max(params.thickness, kMostBack * params.size);
  return is_endless ? false : ahead(r, ray, change, z + most) < ray.most;
}

/// On which side of the ray surfaces lie that cannot block it alone; kNoSide: they may.
const uint kNoSide = 0u, kBehindRay = 1u, kFarBefore = 2u;

/// The most of dot(slope, beside) at the pixels of these steps, which are up to half a pixel beside the ray.
float farthest_along(vec2 slope, Ray ray, int first, int last) {
  const float along = dot(slope, ray.step_px);
  return max(along * float(first), along * float(last)) + 0.5 * max(abs(slope.x), abs(slope.y));
}

/// The last step in a block of a step, and the side of all up to there.
struct Stretch {
  int last;
  uint side;
};
Stretch stretch_from(Receiver r, Ray ray, int first) {
  const ivec2 pixel = r.pixel + ivec2(round(ray.step_px * float(first)));
  const bvec2 forward = greaterThanEqual(ray.step_px, vec2(0));
  const ivec2 block = mix(max(pixel / kNearestStep - 1, 0), pixel / kNearestStep, forward);
  const ivec2 within = pixel - block * kNearestStep;
  // A pixel less, since both ends are rounded.
  const vec2 room = vec2(mix(within, kNearestBlock - 1 - within, forward) - 1) / max(abs(ray.step_px), 1e-3);
  const int last = min(first + max(int(min(room.x, room.y)), 0), ray.steps);
  const vec4 plane = nearest[block.y * ((params.view.size.x + kNearestStep - 1) / kNearestStep) + block.x];
  // What is behind the ray has scale * nearness + dot(change, beside) < limit. The plane is linear as the ray is.
  const float scale = r.perspective ? ray.most : ray.facing, limit = r.perspective ? ray.facing : -ray.most;
  const vec2 slope = ray.change + scale * plane.yz;
  const float start = scale * (plane.x + dot(plane.yz, vec2(r.pixel - block * kNearestStep)));
  const float change = greater(abs(dot(slope, ray.step_px)), abs(dot(ray.change, ray.step_px))) * float(last);
  const float rounding = 1e-5 * (abs(limit) + abs(start) + change);
  const bool is_behind = start + farthest_along(slope, ray, first, last) + half_step(ray) + rounding < limit;
  const float least = -farthest_along(-ray.change, ray, first, last) - half_step(ray) - rounding;
  return Stretch(last, is_behind ? kBehindRay : is_deep(r, ray, least, plane.w) ? kFarBefore : kNoSide);
}

/// A surface of the last pixel.
struct Last {
  float z;      // kSkyDepth: there is none
  bool before;  // the ray
  // Of its run before the ray: where it starts, from the receiver; how far behind it the ray is at least, along the
  // eye's ray; whether it begins at a rounded outline, of which its back is the mirror image.
  vec3 start;
  float least;
  bool is_round;
};

/// Whether two depths in neighbouring pixels are one surface's.
bool are_one(Receiver r, float z, float last_z) {
  const float pixel = params.view.tangent_per_pixel.x * (r.perspective ? lesser(z, last_z) : 1.0);
  return both(abs(z - last_z) < kRunSlope * pixel, z < kSkyDepth);
}

ivec2 pixel_of_step(Receiver r, Ray ray, int k) { return r.pixel + ivec2(round(ray.step_px * float(k))); }

Facet facet_at(View view, ivec2 pixel) {
  const int index = index_of(view, pixel);
  const float z = occluder_depth[index];
  return Facet(position_of(view, vec2(pixel) + 0.5, z), unpack_normal(normal[index]), z);
}

/// Whether two neighbouring pixels of any slope show one plane.
bool are_coplanar(Receiver r, Ray ray, int k) {
  const View view = params.view;
  const ivec2 pixel = pixel_of_step(r, ray, k), last = pixel_of_step(r, ray, k - 1);
  return are_coplanar(view, facet_at(view, last), facet_at(view, pixel), kPlaneDot, kPlaneOff);
}

/// 4. How thick a run is, in scene units along the eye's ray, that ends with a pixel's i-th surface of depth z.
float thickness_of(Receiver r, Last run, vec3 end, float z, int i, float next) {
  if (kThickness == kThicknessLength) return params.thickness;
  const float per_width = i > 0              ? kHiddenThicknessPerWidth
                          : next < kSkyDepth ? kKnownThicknessPerWidth
                                             : kThicknessPerWidth;
  const float pixel = params.view.tangent_per_pixel.x * (r.perspective ? z : 1.0);
  const float width = per_width * (length(end - run.start) + pixel) + kMorePixels * pixel;
  return run.is_round ? 0.0 : levelled(width, kWidestRun * params.size);
}

/// A pixel's surface by its number; below 0: it closes the solid of the one before it.
float surface_at(int index, int i) {
  return kSurfaces == 1 || i == 0 ? occluder_depth[index]
                                  : hidden[index + (i - 1) * params.view.size.x * params.view.size.y];
}

/// Whether a surface is clear of the receiver's tangent plane.
bool is_clear(Receiver r, Reach reach, vec2 beside, float z, int k) {
  const float scale = r.perspective ? z : 1.0, height = height_of(r, beside, z, scale);
  const vec3 place = offset_to(r, beside, z, scale);
  const bool is_high = both(height > r.least_height + scale * (reach.least_rise * float(k)),
                            is_elevated(height, reach.per_elevation, dot(place, place)));
  return both(z < kSkyDepth, is_high);
}
bool is_clear_before(Receiver r, Ray ray, Reach reach, vec2 beside, float z, int k) {
  return both(is_clear(r, reach, beside, z, k), is_before(r, ray, dot(ray.change, beside), z));
}

/// The surfaces of a step that is passed over.
void pass(Receiver r, Ray ray, Reach reach, int k, inout Last last[kSurfaces]) {
  const ivec2 pixel = pixel_of_step(r, ray, k);
  const vec2 beside = vec2(pixel - r.pixel);
  for (int i = 0; i < kSurfaces; i++) {
    const float z = abs(surface_at(index_of(params.view, pixel), i));
    last[i] = Last(k > 0    ? z
                   : i == 0 ? r.z
                            : kSkyDepth,
                   both(k > 0, is_clear_before(r, ray, reach, beside, z, k)),
                   offset_to(r, beside, z, r.perspective ? z : 1.0), kSkyDepth, false);
  }
}

/// The side of a step.
uint side_of(Receiver r, Ray ray, int k) {
  const ivec2 pixel = pixel_of_step(r, ray, k);
  const float change = dot(ray.change, vec2(pixel - r.pixel)), z = occluder_depth[index_of(params.view, pixel)];
  if (!is_before(r, ray, change + half_step(ray), z)) return kBehindRay;
  return is_deep(r, ray, change, z) ? kFarBefore : kNoSide;
}

/// The surface of the last pixel that is nearest to this depth.
Last nearest_to(Last last[kSurfaces], float z) {
  Last nearest_one = last[0];
  for (int j = 1; j < kSurfaces; j++)
    if (abs(last[j].z - z) < abs(nearest_one.z - z)) nearest_one = last[j];
  return nearest_one;
}

/// A surface of a pixel that a step looks at.
struct Looked {
  int i;       // which one of the pixel's
  float z;     // its depth
  float next;  // that of the one behind it, below 0 if it closes this one's solid
  vec3 place;  // from the receiver
  float change;
  bool before;   // clear of the tangent plane, and before the ray
  uint word;     // how far back its pixel tells that it is solid
  uint outline;  // the bit of `word` at which the outline towards the receiver is packed
};

/// 4. Takes a surface into its run, which goes on `from` the last pixel's or begins. Gives whether the ray is within
/// the solid behind it.
bool is_within_solid(Receiver r, Ray ray, Looked s, Last from, bool goes_on, float ray_length, out Last here) {
  const View view = params.view;
  const float behind = depth_behind(r, ray, s.change, s.z);
  const bool deep = is_deep(r, ray, s.change, s.z), begins = both(both(goes_on, from.before), !deep) ? false : true;
  const bool is_told = both(kHasBacks, both(s.i == 0, s.next >= kSkyDepth));
  const float mirrored = is_told ? unpack_mirrored(s.word >> s.outline) : -1.0;
  const bool is_round = begins ? mirrored >= 0.0 : from.is_round;
  const float least = begins ? behind * ray_length : lesser(behind * ray_length, from.least);
  here = Last(s.z, s.before, begins ? s.place : from.start, deep ? kSkyDepth : least, both(is_round, !deep));
  const float scale = r.perspective ? s.z : 1.0;
  const float told = both(is_round, mirrored >= 0.0) ? mirrored : unpack_depth(s.word);
  const bool is_within_told = both(is_told, behind <= told * view.tangent_per_pixel.x * scale);
  const bool is_within_run =
      kThickness == kThicknessEndless || here.least <= thickness_of(r, here, s.place, s.z, s.i, s.next);
  return s.next < 0.0 ? behind <= -s.next - s.z : is_within_told ? true : is_within_run;
}

/// Takes the surfaces of a step. Gives whether one of them blocks the ray.
bool take_step(Receiver r, Ray ray, Reach reach, int k, inout Last last[kSurfaces]) {
  const ivec2 pixel = pixel_of_step(r, ray, k);
  const vec2 beside = vec2(pixel - r.pixel), tangent = r.tangent + r.tangent_per_pixel * beside;
  const int index = index_of(params.view, pixel);
  const float change = dot(ray.change, beside), ray_length = r.perspective ? sqrt(1.0 + dot(tangent, tangent)) : 1.0;
  const uint word = kHasBacks ? backs[index] : 0u, outline = outline_of(ray.step_px);
  Last here[kSurfaces];
  float surface = surface_at(index, 0);
  bool blocked = false;
  for (int i = 0; i < kSurfaces; i++) {
    const float z = abs(surface), next = i + 1 < kSurfaces ? surface_at(index, i + 1) : kSkyDepth;
    const bool clear = is_clear(r, reach, beside, z, k), before = both(clear, is_before(r, ray, change, z));
    const Last from = nearest_to(last, z);
    bool goes_on = are_one(r, z, from.z);
    if (i == 0 && !goes_on && k > 1 && before != last[0].before) goes_on = are_coplanar(r, ray, k);
    // 3.
    const float within = half_step(ray);
    const bool crosses = is_before(r, ray, change - within, z) != is_before(r, ray, change + within, z);
    const bool crosses_alone = both(both(!goes_on, crosses), both(clear, surface > 0.0));
    const vec3 place = offset_to(r, beside, z, r.perspective ? z : 1.0);
    const Looked looked = Looked(i, z, next, place, change, before, word, outline);
    const bool is_within = is_within_solid(r, ray, looked, from, goes_on, ray_length, here[i]);
    blocked = both(goes_on, before != from.before) ? true : blocked;
    blocked = crosses_alone ? true : blocked;
    blocked = both(both(before, surface > 0.0), is_within) ? true : blocked;
    surface = next;
  }
  for (int i = 0; i < kSurfaces; i++) last[i] = here[i];
  return blocked;
}

/// 6. Whether the surface of the image's last pixel blocks the ray beyond the border.
bool is_blocked_beyond(View view, Receiver r, Ray ray) {
  const float border = floor(steps_to_border(view, r.pixel, ray.step_px));
  const ivec2 pixel = pixel_of_step(r, ray, int(border));
  const int index = index_of(view, pixel);
  const vec3 n = unpack_normal(normal[index]);
  const float z = occluder_depth[index], toward = dot(n, ray.direction);
  const float far = dot(n, position_of(view, vec2(pixel) + 0.5, lesser(z, kFarther)) - ray.position) / toward;
  const vec3 place = ray.position + far * ray.direction;
  const vec2 from = tangent_of(view, vec2(pixel) + 0.5), to = r.perspective ? place.xy / -place.z : place.xy;
  const vec2 way = (to - from) / view.tangent_per_pixel, whole_way = (to - r.tangent) / view.tangent_per_pixel;
  const ivec2 mirrored = clamp(pixel - ivec2(round(clamp(way, -1e6, 1e6))), ivec2(0), view.size - 1);
  const float there = depth_beyond(view, from, z, n, tangent_of(view, vec2(mirrored) + 0.5),
                                   occluder_depth[index_of(view, mirrored)], to, kLeastFacingToGoOn);
  const bool exists = both(there < kSkyDepth, both(place.z < 0.0, both(toward < 0.0, both(far > 0.0, far <= ray.far))));
  const bool is_beyond = max(abs(whole_way.x), abs(whole_way.y)) > border;
  const bool is_near = length(to - from) <= (r.perspective ? kTangentBeyond : kSizesBeyond * params.size);
  const bool is_risen = far * dot(r.normal, ray.direction) > kLeastRisen * params.size + r.least_height;
  return both(both(exists, is_beyond), both(is_near, is_risen));
}

/// How long a ray is up to the border, in scene units.
float length_to_border(View view, Receiver r, Ray ray) {
  const float steps = steps_to_border(view, r.pixel, ray.step_px);
  const float across = ray.steps_across + (r.perspective ? steps * ray.direction.z : 0.0);
  return steps * (r.perspective ? r.z : 1.0) / max(across, 1e-30);
}

/// 5. Passes over steps from k on that are on this side, in a loop of its own, which is short: blocks, then single
/// pixels. Gives whether it comes to one that is not.
bool pass_over(Receiver r, Ray ray, uint side, inout int k) {
  bool is_found = false;
  do {
    Stretch stretch;
    do {
      stretch = stretch_from(r, ray, k);
      k = stretch.side == side ? stretch.last + 1 : k;
    } while (stretch.side == side && k <= ray.steps);
    const int end = min(stretch.last, k + kStepsAlone - 1);
    if (k <= end) {
      do {
        is_found = side_of(r, ray, k) != side;
        k += is_found ? 0 : 1;
      } while (!is_found && k <= end);
    }
  } while (!is_found && k <= ray.steps);
  return is_found;
}

/// Takes steps from k on as long as the ray may be within the solid of a surface. Gives whether one blocks it. side:
/// of the last step.
bool take_steps(Receiver r, Ray ray, Reach reach, inout int k, out uint side) {
  Last last[kSurfaces];
  pass(r, ray, reach, k - 1, last);
  bool blocked, goes_on;
  do {
    blocked = take_step(r, ray, reach, k, last);
    goes_on = false;
    for (int i = 0; i < kSurfaces; i++) goes_on = both(last[i].before, last[i].least < kSkyDepth) ? true : goes_on;
  } while (++k <= ray.steps && goes_on && !blocked);
  side = last[0].before ? kFarBefore : kBehindRay;
  return blocked;
}

/// Whether anything that the image shows blocks the ray.
bool is_blocked(Receiver r, Ray ray, Reach reach) {
  bool blocked = false;
  int k = 1;
  uint side = kBehindRay;  // of the step before; the receiver itself blocks nothing
  if (ray.steps > 0) {
    do {
      if (pass_over(r, ray, side, k)) blocked = take_steps(r, ray, reach, k, side);
    } while (k <= ray.steps && !blocked);
  }
  return blocked;
}

/// How much of a light is seen, from its direction and its distance, or that of the farthest place that may block.
float seen_of(View view, Receiver r, vec3 position, vec3 direction, float far) {
  const float cosine = dot(direction, r.eye);
  const vec3 across = direction - cosine * r.eye;
  const float sine = length(across);
  if (sine < kLeastSine) return 1.0;
  const Ray ray = ray_of(view, r, position, direction, cosine, sine, across / sine, far);
  const Reach reach = reach_of(view, params.size, 0.0, params.size, params.thickness, params.bias);
  bool blocked = is_blocked(r, ray, reach);
  const bool leaves = both(!blocked, float(ray.steps + 1) < ray.whole_steps);
  if (kBeyondBorder && leaves) blocked = is_blocked_beyond(view, r, ray);
  if (blocked) return 0.0;
  if (kConfidence == 0u || !leaves) return 1.0;
  const float seen_length = length_to_border(view, r, ray);
  return seen_length / (seen_length + min(kHalfKnown * params.size, max(far - seen_length, 0.0)));
}

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
  return vec4(direction, is_lamp ? min(distance, params.reach) : params.reach);
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
    const vec2 place = vec2((float(k) + noise.x) / float(kDirections), fract(noise.y + kGolden * float(k)));  // 7.
    const vec4 light = towards(position, place);
    if (dot(light.xyz, r.normal) > 0.0) seen += seen_of(view, r, position, light.xyz, light.w);  // 1.
  }
  seen /= float(kDirections);
  result[at] = kConfidence == 0u ? seen : clamp(1.0 - (result[at] - seen), 0.0, 1.0);
}
