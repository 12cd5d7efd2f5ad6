// Finds where surfaces of one frame are not in another one, although it would see them: they have moved meanwhile.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of a frame, and of others.
// Out: the cells of space within the radius of boxes, one for each tile of 8 x 8 pixels: around what of the frame any
// other sees through, around what of another it sees through itself, and around what moves by its motion vectors.
//
// A surface that stands still may be hidden in another frame, but that frame never sees through it: see still.comp.
// Here one pixel in error makes a whole surrounding lose its mean. So the other frame must see three pixels' widths
// farther, and the pixel must have neighbours that are of its surface: others, thinner than a pixel or seen at a
// grazing angle, come and go in pictures of what stands still. Half a width is enough where all of a patch tells so:
// shadows change most where something lifts off what it lies on. One pixel of each two by two is looked at.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "moved.h"
#include "reprojection.h"
#include "view.glsl"
#include "tiles.glsl"
#include "reprojection.glsl"
#include "cells.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kMovedFramesId) const int kFrames = 1;
layout(scalar, push_constant) uniform Push { MovedParams params; };
layout(scalar, binding = kMovedOwn) readonly buffer Own { float own[]; };
layout(scalar, binding = kMovedOthers) readonly buffer Others { float others[]; };
layout(scalar, binding = kMovedFrames) readonly buffer Frames { TakenFrame frames[]; };
layout(scalar, binding = kMovedNear) buffer Near { uint near[]; };

const float kFarther = 3.0;  // pixels' widths that what is seen through a surface is behind it
const float kLifted = 0.5;   // the same where all pixels of a patch about it, here and there, tell so
const int kPatch = 2;        // px from the patch's middle to its border
const float kAlike = 8.0;    // pixels' worth of slope that neighbours of one surface differ by at most

/// Where something moves, scene units, in the view space of the frame; low above high: nowhere.
struct Box {
  vec3 low, high;
};
const Box kNowhere = Box(vec3(kSkyDepth), vec3(-kSkyDepth));

/// Pixels of a tile that are looked at for what is seen through them: one of each two in every second row, moved by one
/// from one such row to the next, so that each square of two by two pixels has one.
const int kLooked = 16;
ivec2 looked_at(ivec2 tile, int k) { return tile * kTile + ivec2(k % 4 * 2 + (k / 4 & 1), k / 4 * 2); }

/// Cells along an axis that are marked at most: boxes of a tile are small but where a tile shows an edge.
const int kMostCells = 64;

/// How a depth is looked up: of the frame itself, or of another one.
float depth_at(bool of_own, uint first, int index) { return of_own ? own[index] : others[first + uint(index)]; }

/// Pixels of a square about one, row by row.
ivec2 of_square(ivec2 pixel, int half_side, int k) {
  const int side = 2 * half_side + 1;
  return pixel + ivec2(k % side, k / side) - half_side;
}

/// Whether a frame sees nothing but what is farther, in the square of pixels about a place. Corners are looked at
/// first, since on any slope one of them is nearer.
bool is_seen_through(bool by_own, uint first, View view, ivec2 place, int half_side, float beyond) {
  bool through = abs(depth_at(by_own, first, index_of(view, place))) > beyond;
  for (int k = 0; through && k < 4; k++) {
    const ivec2 corner = clamp(place + half_side * (ivec2(k & 1, k >> 1) * 2 - 1), ivec2(0), view.size - 1);
    through = abs(depth_at(by_own, first, index_of(view, corner))) > beyond;
  }
  for (int k = 0; through && k < (2 * half_side + 1) * (2 * half_side + 1); k++) {
    const ivec2 at = clamp(of_square(place, half_side, k), ivec2(0), view.size - 1);
    through = abs(depth_at(by_own, first, index_of(view, at))) > beyond;
  }
  return through;
}

/// Whether a pixel shows the surface that is at depth z beside it.
bool is_alike(bool of_own, uint first, View view, ivec2 pixel, float z) {
  const float there = abs(depth_at(of_own, first, index_of(view, clamp(pixel, ivec2(0), view.size - 1))));
  return inside(view, pixel) && abs(there - z) < kAlike * pixel_width(view, z);
}

/// Whether a pixel has neighbours of its surface along both axes, one each at least.
bool is_wide(bool of_own, uint first, View view, ivec2 pixel, float z) {
  bool alike[4];
  for (int k = 0; k < 4; k++) {
    const int step = (k & 1) * 2 - 1;
    alike[k] = is_alike(of_own, first, view, pixel + (k < 2 ? ivec2(step, 0) : ivec2(0, step)), z);
  }
  return (alike[0] || alike[1]) && (alike[2] || alike[3]);
}

/// Whether all of a square of pixels show one surface.
bool is_patch(bool of_own, uint first, View view, ivec2 pixel, float z) {
  bool alike = true;
  for (int k = 0; alike && k < (2 * kPatch + 1) * (2 * kPatch + 1); k++)
    alike = is_alike(of_own, first, view, of_square(pixel, kPatch, k), z);
  return alike;
}

/// A position of another frame in the frame's view space.
vec3 position_here(TakenFrame other, vec3 position) {
  const vec3 back = position - other.offset;
  return other.row_x * back.x + other.row_y * back.y + other.row_z * back.z;
}

vec3 position_there(TakenFrame other, vec3 here) {
  return vec3(dot(other.row_x, here), dot(other.row_y, here), dot(other.row_z, here)) + other.offset;
}

void widen(inout Box box, vec3 position) {
  box.low = min(box.low, position);
  box.high = max(box.high, position);
}

Box both(Box a, Box b) { return Box(min(a.low, b.low), max(a.high, b.high)); }

/// What of a tile of one frame the other has not: from the frame itself to another one, or the other way round.
Box unseen_of(ivec2 tile, bool from_own, TakenFrame other) {
  View from = other.view, to = params.view;
  if (from_own) from = params.view;
  if (from_own) to = other.view;
  Box box = kNowhere;
  if (any(greaterThanEqual(tile, tiles_of(from.size)))) return box;
  [[dont_unroll]] for (int k = 0; k < kLooked; k++) {
    const ivec2 pixel = looked_at(tile, k);
    const float z = abs(depth_at(from_own, other.first, index_of(from, min(pixel, from.size - 1))));
    const vec3 here = position_of(from, vec2(pixel) + 0.5, min(z, 1e15));
    const vec3 there = from_own ? position_there(other, here) : position_here(other, here);
    const ivec2 place = pixel_of(to, there);
    const bool is_surface = inside(from, pixel) && z < kSkyDepth;
    const bool is_looked_at = -there.z > 0.0 && all(greaterThan(place, ivec2(0))) && all(lessThan(place, to.size - 1));
    const float width = pixel_width(to, -there.z);
    const float same = kPrecisions * error_at(other.depth_precision, -there.z) - there.z;
    const ivec2 at = clamp(place, ivec2(1), to.size - 2);
    bool moved = false, lifted = false;
    for (bool once = is_surface && is_looked_at &&
                     abs(depth_at(!from_own, other.first, index_of(to, at))) > same + kLifted * width;
         once; once = false) {
      moved = is_seen_through(!from_own, other.first, to, at, 1, same + kFarther * width);
      for (bool wide = moved; wide; wide = false) moved = is_wide(from_own, other.first, from, pixel, z);
      lifted = !moved && is_seen_through(!from_own, other.first, to, at, kPatch, same + kLifted * width);
      for (bool wide = lifted; wide; wide = false) moved = is_patch(from_own, other.first, from, pixel, z);
    }
    for (bool once = moved; once; once = false) widen(box, from_own ? here : there);
  }
  return box;
}

/// What of a tile moves by motion vectors: of the frame itself, or of another one. All pixels are looked at, since
/// vectors also tell of what is as thin as one.
Box moving_of(ivec2 tile, bool of_own, TakenFrame other) {
  View view = other.view;
  if (of_own) view = params.view;
  Box box = kNowhere;
  if (any(greaterThanEqual(tile, tiles_of(view.size)))) return box;
  float least = 0.0;
  [[dont_unroll]] for (int y = 0; y < kTile; y++) {
    const int row = index_of(view, ivec2(0, min(tile.y * kTile + y, view.size.y - 1)));
    [[unroll]] for (int x = 0; x < kTile; x++) {
      const int column = min(tile.x * kTile + x, view.size.x - 1);
      least = min(least, depth_at(of_own, other.first, row + column));
    }
  }
  for (int k = 0; least < 0.0 && k < kTile * kTile; k++) {
    const ivec2 pixel = min(pixel_of_tile(tile, uint(k)), view.size - 1);
    const float z = depth_at(of_own, other.first, index_of(view, pixel));
    const vec3 position = position_of(view, vec2(pixel) + 0.5, -z);
    for (bool once = z < 0.0; once; once = false) widen(box, of_own ? position : position_here(other, position));
  }
  return box;
}

/// Marks the cells within the radius of a box for some frames.
void mark(Box box, uint frames) {
  const ivec3 first = cell_of(box.low - params.radius, params.radius);
  const ivec3 last = min(cell_of(box.high + params.radius, params.radius), first + kMostCells);
  for (int z = first.z; z <= last.z; z++)
    for (int y = first.y; y <= last.y; y++)
      for (int x = first.x; x <= last.x; x++) {
        const vec3 low = vec3(x, y, z) * (kMovedCell * params.radius), high = low + kMovedCell * params.radius;
        const vec3 apart = max(max(low - box.high, box.low - high), vec3(0));
        if (dot(apart, apart) < params.radius * params.radius) atomicOr(near[place_of_cell(ivec3(x, y, z))], frames);
      }
}

void main() {
  const ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
  Box here = moving_of(tile, true, frames[0]);
  [[unroll]] for (int i = 0; i < kFrames; i++) {
    const Box of_own = unseen_of(tile, true, frames[i]);
    const Box there = both(unseen_of(tile, false, frames[i]), moving_of(tile, false, frames[i]));
    here = both(here, of_own);
    if (there.low.x <= there.high.x) mark(there, 1u << (params.place + uint(i)));
  }
  if (here.low.x <= here.high.x) mark(here, ~0u);
}
