// Finds where surfaces of one frame are not in another one, although it would see them: they have moved meanwhile.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of a frame, and of others; and which pixels may be seen past.
// Out: the cells of space within the radius of boxes, one for each tile of 8 x 8 pixels: around what of the frame any
// other sees through, around what of another it sees through itself, and around what moves by its motion vectors.
//
// A surface that stands still may be hidden in another frame, but that frame never sees through it: see still.comp.
// Here one pixel in error makes a whole surrounding lose its mean. So the other frame must see three pixels' widths
// farther, and the pixel must have neighbours that are of its surface: others, thinner than a pixel or seen at a
// grazing angle, come and go in pictures of what stands still. Half a width is enough where all of a patch tells so:
// shadows change most where something lifts off what it lies on. Only suspects are looked at: see suspects.comp.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/time/accumulate.h"
#include "kernels/base/reprojection.h"
#include "kernels/base/view.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/reprojection.glsl"
#include "kernels/time/sight.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kVectors = 0;  // 1: some frame has depths below 0
layout(scalar, push_constant) uniform Push { MovedParams params; };
readonly buffer Own { float own[]; };        // one float per pixel of the frame: depth as of a NeighbourFrame
readonly buffer Others { float others[]; };  // planes of other frames, as words
readonly buffer Frames { NeighbourFrame frames[]; };
// kMovedCells words, zeros at first: for the cells of space that share it a bit for each other frame, by its place,
// from which to this one something moves within the radius of what is in the cell
buffer Near { uint near[]; };
readonly buffer Suspects { uint suspects[]; };  // words, from suspects

const float kFarther = 3.0;  // pixels' widths that what is seen through a surface is behind it
const int kPatch = 2;        // px from the patch's middle to its border
const float kAlike = 8.0;    // pixels' worth of slope that neighbours of one surface differ by at most

/// The box in which something moves, scene units, in the view space of the frame; low above high: nowhere.
struct Box {
  vec3 low, high;
};
const Box kNowhere = Box(vec3(kSkyDepth), vec3(-kSkyDepth));

/// Cells along an axis that are marked at most for one box: boxes of a tile are small but where a tile shows an edge.
const int kMostCells = 64;

/// The depth at a pixel of the frame itself, or of another one.
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

Box both(Box a, Box b) { return Box(min(a.low, b.low), max(a.high, b.high)); }

/// The box of what moves at a position that a view shows, the frame's own or another one's: from the front that is seen
/// to a radius farther from the eye. What lies about its hidden part loses its mean, too: taken as a sheet, a ball that
/// lands lost its shadow on the floor.
Box box_at(bool of_own, View view, NeighbourFrame other, vec3 position) {
  const vec3 back = position - params.radius * toward_eye(view, position);
  const vec3 a = of_own ? position : position_here(other, position), b = of_own ? back : position_here(other, back);
  return Box(min(a, b), max(a, b));
}

/// Whether no more cells than that lie within the radius of a box.
bool is_small(Box box) {
  const ivec3 first = cell_of(box.low - params.radius, params.radius),
              last = cell_of(box.high + params.radius, params.radius);
  return all(lessThanEqual(last - first, ivec3(kMostCells)));
}

/// Marks the cells within the radius of a small box for some frames. One of a single pixel is small, unless cells are
/// finer than floats.
void mark(Box box, uint frames) {
  const ivec3 first = cell_of(box.low - params.radius, params.radius);
  const ivec3 last = min(cell_of(box.high + params.radius, params.radius), first + kMostCells);
  for (int z = first.z; z <= last.z; z++)
    for (int y = first.y; y <= last.y; y++)
      for (int x = first.x; x <= last.x; x++) {
        const vec3 low = vec3(x, y, z) * (kMovedCell * params.radius), high = low + kMovedCell * params.radius;
        const vec3 apart = max(max(low - box.high, box.low - high), vec3(0));
        const uint place = place_of_cell(ivec3(x, y, z));
        // Tiles beside each other mark the same cells, and lavapipe takes long for an atomic. Bits are never taken
        // away: whoever misses what is marked meanwhile marks it again.
        const bool is_new = (near[place] & frames) != frames;
        if (is_new && dot(apart, apart) < params.radius * params.radius) atomicOr(near[place], frames);
      }
}

/// Adds what moves to a box. What would make it too large, such as the far one of two things that a tile shows, begins
/// another one, and the first one is marked at once.
void add(inout Box box, Box more, uint frames) {
  const Box wider = both(box, more);
  const bool fits = is_small(wider);
  if (!fits) mark(box, frames);
  box = fits ? wider : more;
}

/// Words of suspects of all squares of a tile.
struct Found {
  uint words[kSquares * kSquares];
};

Found suspects_of(ivec2 tile) {
  Found found;
  [[unroll]] for (int k = 0; k < kSquares * kSquares; k++) {
    const ivec2 square = tile * kSquares + ivec2(k % kSquares, k / kSquares);
    found.words[k] = suspects[square.y * params.squares.x + square.x];
  }
  return found;
}

/// The squares of a tile that have this bit.
uint squares_with(Found found, int bit) {
  uint squares = 0u;
  [[unroll]] for (int k = 0; k < kSquares * kSquares; k++) squares |= (found.words[k] >> bit & 1u) << k;
  return squares;
}

/// The part of a tile of one frame that the other has not: from the frame itself to another one, or the other way
/// round, where it is looked at in these squares. Gives the last box, which is still to be marked for these frames.
Box unseen_of(ivec2 tile, uint squares, bool from_own, NeighbourFrame other, uint frames) {
  View from = other.view, to = params.view;
  if (from_own) from = params.view;
  if (from_own) to = other.view;
  Box box = kNowhere;
  for (uint left = squares; left != 0u; left &= left - 1u) {
    const int k = findLSB(left);
    const ivec2 pixel = looked_at(tile * kSquares + ivec2(k % kSquares, k / kSquares));
    const float z = abs(depth_at(from_own, other.first, index_of(from, pixel)));
    const vec3 here = position_of(from, vec2(pixel) + 0.5, z);
    const vec3 there = from_own ? position_there(other, here) : position_here(other, here);
    const Sight sight = sight_of(to, there, other.depth_precision);
    bool moved = is_seen_through(!from_own, other.first, to, sight.at, 1, sight.same + kFarther * sight.width);
    if (moved) moved = is_wide(from_own, other.first, from, pixel, z);
    bool lifted =
        !moved && is_seen_through(!from_own, other.first, to, sight.at, kPatch, sight.same + kLifted * sight.width);
    if (lifted) moved = is_patch(from_own, other.first, from, pixel, z);
    if (moved) add(box, box_at(from_own, from, other, here), frames);
  }
  return box;
}

/// The part of a tile that moves by motion vectors: of the frame itself, or of another one. All pixels are looked at,
/// since vectors also tell of what is as thin as one. Adds it to a box.
void add_moving(inout Box box, ivec2 tile, bool of_own, NeighbourFrame other, uint frames) {
  View view = other.view;
  if (of_own) view = params.view;
  if (any(greaterThanEqual(tile, tiles_of(view.size)))) return;
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
    if (z < 0.0) add(box, box_at(of_own, view, other, position), frames);
  }
}

void main() {
  // Each row of workgroups is for one frame, and its terms are loaded outside of conditions: so lavapipe loads them
  // once for all invocations.
  const int rows = params.rows * int(kGroupY), i = int(gl_WorkGroupID.y) / params.rows;
  const NeighbourFrame other = frames[i];
  const ivec2 tile = ivec2(gl_GlobalInvocationID.xy) - ivec2(0, i * rows);
  if (any(greaterThanEqual(tile * kSquares, params.squares))) return;
  const Found found = suspects_of(tile);
  const uint of_other = 1u << (params.place + uint(i)), of_all = ~0u;
  Box here = unseen_of(tile, squares_with(found, i), true, other, of_all);
  Box there = unseen_of(tile, squares_with(found, i + int(kMostNeighbours)), false, other, of_other);
  if (kVectors != 0 && i == 0) add_moving(here, tile, true, other, of_all);
  if (kVectors != 0) add_moving(there, tile, false, other, of_other);
  if (there.low.x <= there.high.x) mark(there, of_other);
  if (here.low.x <= here.high.x) mark(here, of_all);
}
