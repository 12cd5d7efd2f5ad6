// Ambient occlusion from every pixel along a slice, cosine weighted, with occluders of finite thickness: one slice of
// every pixel.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, the profiles of the lines of one direction. Out: visibility, 1 = open, after the last
// direction. What horizon.comp samples, this searches without gaps: a receiver walks from vertex to vertex of the
// profile of its line (profile.comp), whose strokes hold all pixels in between, until the sphere of the radius is left
// behind.
// - Slices are even on the image and shared by all pixels; each weighs 1 / (ray_length of the line's foot * cosine from
//   it), the Jacobian to azimuth about the view ray.
// - The receiver is moved onto its line's plane along its tangent plane, by half a pixel at most: a flat surface stays
//   flat.
// - Every stroke is cut to what the sphere holds of it, and blocks from its front to its back: as far along the eye's
//   ray as its run is wide ("width as thickness"). What goes on from the receiver is its own surface: it blocks all
//   below its horizon.
// - What is blocked is a union of intervals: exact for what joins the horizon; all others are counted in 24 sectors
//   (sectors.glsl).
// - Result 1 - (sum of blocked arcs) / (sum of whole arcs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "exact.h"
#include "view.glsl"
#include "normal.glsl"
#include "arcs.glsl"
#include "noise.glsl"
#include "bent.glsl"
#include "stride.glsl"
#include "tiles.glsl"
#include "clearance.glsl"
#include "slice.glsl"
#include "sectors.glsl"
#include "lines.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kExactListedId) const uint kListed = 0;
layout(scalar, push_constant) uniform Push { ExactParams params; };
layout(scalar, binding = kExactDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kExactNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kExactVertex) readonly buffer Vertex { float vertex[]; };
layout(scalar, binding = kExactMark) readonly buffer Mark { uint mark[]; };
layout(scalar, binding = kExactNeighbor) readonly buffer Neighbor { uint neighbor[]; };
layout(scalar, binding = kExactWhole) buffer Whole { float whole_arcs[]; };
layout(scalar, binding = kExactAo) buffer Ao { float ao[]; };
layout(scalar, binding = kExactList) readonly buffer List { ListedTile list[]; };
layout(scalar, binding = kExactCounts) readonly buffer Counts { TileCounts counts; };

const float kNone = 1e30;

/// The receiver in the plane of its line, as the profile has its vertices.
struct Point {
  vec2 place, eye;     // eye: unit, towards it
  vec2 normal;         // the normal's projection; its length is the slice's weight
  float eye_distance;  // orthographic: infinite
};

/// One side of a slice.
struct Search {
  vec2 across;  // unit, to that side of the eye's ray
  // unit normal of the eye's ray that touches the sphere of the radius, in (across, toward): what is further along it
  // is beyond the sphere
  vec2 leaving;
  vec2 normal;                     // the normal's projection, in (across, toward)
  float lowest;                    // slope_of() where blocking begins
  float least_height, least_rise;  // of what blocks: see clearance.glsl
  int from;                        // the receiver's step
  int step;                        // of columns, to that side
  uint begins, last;               // the flags of vertices to that side
};

Point point_of(View view, LinePlane plane, vec2 tangent, float z, vec3 normal) {
  const bool perspective = view.orthographic == 0;
  const vec3 along = vec3(plane.along, 0),
             away = perspective ? vec3(plane.foot, -1) / plane.ray_length : vec3(0, 0, -1), across = cross(along, away);
  const vec3 position = perspective ? z * vec3(tangent, -1) : vec3(tangent - plane.foot, -z);
  const vec2 in_plane = vec2(dot(normal, along), dot(normal, away));
  const float beside =
      dot(position, across) * dot(normal, across) / max(dot(in_plane, in_plane), kLeastWeight * kLeastWeight);
  Point point;
  point.normal = in_plane;
  point.place = vec2(dot(position, along), dot(position, away)) + beside * in_plane;
  point.eye_distance = perspective ? length(point.place) : kNone;
  point.eye = perspective ? -point.place / point.eye_distance : vec2(0, -1);
  return point;
}

/// slope_of() the back of an occluder, `thickness` further along the eye's ray through its front (across, toward), but
/// not beyond the sphere.
float back_of(vec2 front, float eye_distance, float thickness, float radius_sq) {
  const vec2 ray = eye_distance < kNone ? front - vec2(0, eye_distance) : vec2(0, -1),
             direction = ray * inversesqrt(dot(ray, ray));
  const float middle = dot(front, direction);
  const float leaves = sqrt(max(0.0, middle * middle - dot(front, front) + radius_sq)) - middle;
  const vec2 back = front + min(thickness, leaves) * direction;
  return slope_of(back);
}

/// The blocked part of a side's arc integral.
float blocked_arc(View view, LinePlane plane, Side side, Search search, Point point, float radius, float thickness,
                  int at, float shift) {
  const float radius_sq = radius * radius;
  const bool measured = thickness == 0.0;
  float own = slope_of(side.ahead), thick = thickness;
  vec2 last = vec2(0);
  uint sectors = 0u;
  bool is_own = true, starts = true;
  for (bool goes = true; goes; at += search.step) {
    const uint marked = mark[at];
    const int to = int(marked >> 16);
    const float z = vertex[at], least = search.least_height + (view.orthographic != 0 ? 1.0 : z) * search.least_rise *
                                                                  float(abs(to - search.from));
    const vec2 offset = place_at(view, plane, to, z) - point.place;
    const vec2 place = vec2(dot(offset, search.across), dot(offset, point.eye));
    const bool begins = (marked & search.begins) != 0u;
    is_own = begins ? false : is_own;
    thick = begins && measured ? unpack_width(marked) : thick;
    // The stroke from the last vertex; to the first one from the next pixel on, as nothing is seen before it; the
    // vertex alone as a short one. Cut to the sphere.
    const float next_pixel = min(0.999, 1.0 / float(abs(to - search.from)));
    const vec2 from = begins ? 0.999 * place : starts ? next_pixel * place : last, stroke = place - from;
    const float a = dot(stroke, stroke), middle = dot(from, stroke), beside = from.x * stroke.y - from.y * stroke.x;
    const float inside_sq = a * radius_sq - beside * beside, inside = sqrt(max(inside_sq, 0.0)), scale = 1.0 / a;
    const float enters = max(0.0, (-middle - inside) * scale), leaves = min(1.0, (inside - middle) * scale);
    const vec2 near = from + enters * stroke, far = from + leaves * stroke;
    const float near_slope = slope_of(near), far_slope = slope_of(far), high = max(near_slope, far_slope);
    const bool within = inside_sq > 0.0 ? enters <= leaves : false,
               rises = min(near.x, far.x) > 0.0 ? high > search.lowest : false;
    const bool clear = rises ? max(dot(near, search.normal), dot(far, search.normal)) > least : false;
    const float top = within ? clear ? high : -1.0 : -1.0;
    // What it blocks: more of what the receiver's own surface does, or a set apart.
    const float bottom =
        is_own ? -1.0 : min(min(near_slope, far_slope), back_of(far, point.eye_distance, thick, radius_sq));
    const bool onto_own = bottom <= own;
    sectors |= onto_own || top < bottom ? 0u : sectors_below(top, shift) & ~sectors_below(bottom, shift);
    own = onto_own ? max(own, top) : own;
    goes = (marked & search.last) == 0u ? dot(place, search.leaving) < radius : false;
    last = place;
    starts = false;
  }
  return whole_arc(side) - arc_to(side, place_at(own)) + arc_of(side, sectors & ~sectors_below(own, shift));
}

void main() {
  const View view = params.view;
  const Lines lines = params.lines;
  const ivec2 extent = extent_of(view, lines);
  ivec2 at = params.first + params.stride * ivec2(gl_GlobalInvocationID.xy);  // along and across
  if (kListed != 0u) {
    const ListedPlace place = listed_place(gl_WorkGroupID.xy, gl_LocalInvocationIndex, 1);
    if (place.tile >= counts.listed) return;
    const ivec2 origin = lines.steep != 0 ? lines.origin.yx : lines.origin;
    const ivec2 listed = pixel_of_anchored_tile(unpack_tile(list[place.tile].place), place.pixel, origin);
    if (!inside(view, listed)) return;
    at = lines.steep != 0 ? listed.yx : listed;
  }
  if (at.x >= extent.x || at.y >= extent.y) return;
  const ivec2 pixel = lines.steep != 0 ? at.yx : at;
  const int index = index_of(view, pixel), ao_index = index + int(params.plane) * view.size.x * view.size.y;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[ao_index] = 1.0;
    return;
  }
  const int line = at.y - shift_at(lines, at.x), row = row_of(lines, line, extent.y) * extent.x;
  const LinePlane plane = plane_of(view, lines, line);
  const vec3 n = unpack_normal(normal[index]);
  const vec2 tangent = tangent_at(view, lines, at + lines.origin);
  const Point point = point_of(view, plane, tangent, z, n);
  const float clearance =
      least_height(params.depth_precision, z, (view.orthographic != 0 ? 0.0 : dot(n.xy, tangent)) - n.z);
  const float radius = params.radius, weight = length(point.normal),
              facing = max(dot(point.normal, point.eye), kLeastWeight);
  const uint neighbors = neighbor[row + at.x];
  float blocked = 0.0, whole = 0.0;
  if (weight >= kLeastWeight) {
    const vec2 across_eye = vec2(-point.eye.y, point.eye.x);
    const float sine = radius / point.eye_distance, cosine = sqrt(max(0.0, 1.0 - sine * sine));
    const float share = 1.0 / (plane.ray_length * -point.eye.y);
    const float lift = max(params.bias, kLeastElevation), level = sqrt(1.0 - lift * lift), thickness = params.thickness;
    for (int sign = -1; sign <= 1; sign += 2) {
      Side side;
      side.cos_gamma = facing / weight;
      side.sin_gamma = float(sign) * dot(point.normal, across_eye) / weight;
      side.gamma = angle_of(side.cos_gamma, side.sin_gamma);
      side.ahead = vec2(side.cos_gamma, -side.sin_gamma);
      Search search;
      search.across = float(sign) * across_eye;
      search.leaving = sine < 1.0 ? vec2(cosine, sine) : vec2(0);
      search.lowest = slope_of(
          vec2(level * side.cos_gamma + lift * side.sin_gamma, lift * side.cos_gamma - level * side.sin_gamma));
      search.normal = weight * vec2(side.sin_gamma, side.cos_gamma);
      search.least_height = clearance;
      search.least_rise = least_rise(view);
      search.from = at.x;
      search.step = sign;
      search.begins = sign > 0 ? kVertexBegins : kVertexEnds;
      search.last = sign > 0 ? kVertexLast : kVertexFirst;
      whole += share * weight * whole_arc(side);
      const uint column = sign > 0 ? neighbors >> 16 : neighbors & kNoVertex;
      if (column == kNoVertex) continue;
      const float shift = fract(0.5 + kGolden * float(2u * params.direction + uint(sign > 0)));
      blocked +=
          share * weight * blocked_arc(view, plane, side, search, point, radius, thickness, row + int(column), shift);
    }
  }
  if (params.is_first == 0) {
    whole += whole_arcs[index];
    blocked += ao[ao_index];
  }
  whole_arcs[index] = whole;
  if (params.is_last != 0) blocked = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
  ao[ao_index] = blocked;
}
