// Sorts the tiles by what an estimator has to do for them: nothing for sky, nor where all is as in the frame before.
// Elsewhere it may have to look at hidden surfaces, or not.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: depth, bounds of what is hidden, changes against the frame before, needed tiles.
// Out: a list of the tiles that are left, and the visibility of sky, which is 1.
//
// Each row of a workgroup takes a block of 2 x 2 tiles. The steps have their numbers at the code:
//  1. The invocations of a row find the tiles of their block that show a surface which anybody needs, and the nearest
//     and farthest depth.
//  2. The box in space that holds the receivers, and the part of the image within their reach, follow from these.
//  3. If another frame's estimates still lie there, and nothing within reach has changed, they stay.
//  4. If nothing is hidden so near to the receivers that it may block, nor closes a solid whose front is there, an
//     estimator finds what it finds where nothing is hidden at all, to the bit (surfaces.glsl). Such tiles are listed
//     without kTileLayered. Distances are those of the boxes in space that hold receivers and hidden surfaces.
//  5. The tiles that are left are counted and listed; the others get what estimators write for sky.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/blocks.glsl"
#include "kernels/base/moments.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kSparse = 0;             // 1: only sites have an estimate
layout(constant_id = 1) const uint kMode = kClassifySkips;  // bits of kClassify*
const bool kSkips = (kMode & kClassifySkips) != 0u;
const bool kReuses = (kMode & kClassifyReuses) != 0u;
const bool kSelects = (kMode & kClassifySelects) != 0u;
const bool kLayered = (kMode & kClassifyLayered) != 0u;
const uint kOrder = (kMode & kClassifyWithSecond) != 0u ? 2u : (kMode & kClassifyWithFirst) != 0u ? 1u : 0u;
const bool kTellsLayered = kSkips && kLayered;
layout(scalar, push_constant) uniform Push { ClassifyParams params; };
readonly buffer Bounds { vec2 bounds[]; };  // from bounds; only with kClassifyLayered and kClassifySkips
// one uint per corner of blocks, (columns + 1) x (rows + 1): how many blocks above and left of it have changed
readonly buffer Changes { uint changes[]; };
readonly buffer Depth { float depth[]; };  // one float per pixel, from prepare
writeonly buffer List { uint list[]; };    // one uint per tile, as many as are counted, in no order: see pack_tile
buffer Counts { TileCounts counts; };      // zeros before
// one float per pixel, 1 at receivers of tiles that are not listed; in the plane that the parameters name
writeonly buffer Ao { float ao[]; };
// as many planes as estimators write, for the same; only with kClassifyWith*
writeonly buffer Moments { float moments[]; };
// one float per pixel, 0 at receivers of tiles that are not listed; only with kClassifyWithCompleted
writeonly buffer Completed { float completed[]; };
// one uint per tile, from needed: not 0 where estimates are needed; only with kClassifySelects
readonly buffer Needed { uint wanted[]; };
readonly buffer Blocks { uint words[]; };  // one uint per block, see blocks.glsl; only if sparse
writeonly buffer Kinds { uint kinds[]; };  // one uint per tile: kTileOpen, kTileListed or kTileKept

/// Where a sphere reaches nearer to the eye than this part of its box's depth, all of the image counts. Down to
/// it, the difference of depth and reach is off by 200 * 2^-24 of itself at most, and so is what is divided by it: on
/// 65,535 pixels that is less than the pixel that image_of_reach() adds.
const float kLeastNear = 0.01;

// What the invocations of a row find about their block. Between two barriers a value is either read or changed, and it
// is changed by atomics whose results nobody looks at, or by one invocation: a row need not run in lock step.
// Whether hidden surfaces may count.
shared uint layered[kGroupY];
// Tiles of the block that show a surface, as bits; where in the list the tiles are.
shared uint surfaces[kGroupY], place[kGroupY * kTileBlock * kTileBlock];
// Depths of the block, as bits: those of positive floats have the order of the floats.
shared uint nearest[kGroupY], farthest[kGroupY];
const int kTilesOfBlock = kTileBlock * kTileBlock;
const uint kAllTiles = (1u << kTilesOfBlock) - 1u;

ivec2 tile_of_block(ivec2 first, int i) { return first + ivec2(i % kTileBlock, i / kTileBlock); }

struct Box {
  vec3 least, most;  // tangents times depth, and depth
};

/// The box that holds what is seen in a block of tiles between two depths.
Box box_of(View view, ivec2 block, float near, float far) {
  const int side = kTile * kTileBlock;
  const vec2 a = tangent_of(view, vec2(block * side) + 0.5);
  const vec2 b = tangent_of(view, vec2(min((block + 1) * side, view.size)) - 0.5);
  const vec2 least = min(a, b);
  const vec2 most = max(a, b);
  const vec2 scale = view.orthographic != 0 ? vec2(1) : vec2(near, far);
  return Box(vec3(min(least * scale.x, least * scale.y), near), vec3(max(most * scale.x, most * scale.y), far));
}

float distance_sq(Box a, Box b) {
  const vec3 gap = max(max(a.least - b.most, b.least - a.most), 0.0);
  return dot(gap, gap);
}

/// From pixels' centres to the samples of receivers up to this depth: one lies up to half a pixel beside its slice, and
/// is moved into it.
float reach_of_samples(View view, float radius, float far) {
  const float pixel = max(abs(view.tangent_per_pixel.x), abs(view.tangent_per_pixel.y));
  return radius + 2.0 * pixel * (view.orthographic != 0 ? 1.0 : far + radius);
}

struct Rect {
  vec2 least, most;  // px
};

/// The part of the image in which a sphere about anything in a box is seen: all of it where one may hold the eye.
Rect image_of_reach(View view, Box box, float reach) {
  const bool perspective = view.orthographic == 0;
  const float near = box.least.z - reach, far = box.most.z + reach;
  if (perspective && !(near > kLeastNear * box.least.z)) return Rect(vec2(0), vec2(view.size - 1));
  const vec2 least = box.least.xy - reach, most = box.most.xy + reach;
  const vec2 a = perspective ? min(least / near, least / far) : least;
  const vec2 b = perspective ? max(most / near, most / far) : most;
  const vec2 p = view.center + a / view.tangent_per_pixel;
  const vec2 q = view.center + b / view.tangent_per_pixel;
  return Rect(clamp(min(p, q) - 1.0, vec2(0), vec2(view.size - 1)),
              clamp(max(p, q) + 1.0, vec2(0), vec2(view.size - 1)));
}

uint changes_at(ivec2 corner, ivec2 blocks) { return changes[corner.y * (blocks.x + 1) + corner.x]; }

/// Whether everything that the estimates of receivers are made from is as it was in the frame before. `rect`: what is
/// within their reach.
bool is_as_before(Rect rect) {
  const ivec2 most = params.frame_size - 1;
  const int margin = params.margin + (kSparse != 0u ? kSiteReach * params.factor : 0);
  const ivec2 blocks = (params.frame_size + kChangeBlock - 1) / kChangeBlock;
  const ivec2 from = clamp(ivec2(rect.least) * params.factor - params.overhang - margin, ivec2(0), most) / kChangeBlock;
  const ivec2 to =
      clamp(ivec2(rect.most + 1.0) * params.factor - params.overhang + margin, ivec2(0), most) / kChangeBlock + 1;
  return changes_at(to, blocks) + changes_at(from, blocks) ==
         changes_at(ivec2(from.x, to.y), blocks) + changes_at(ivec2(to.x, from.y), blocks);
}

/// Whether something is hidden so near to receivers that an estimator looks at it, as far as one invocation of a row
/// searches for all of them.
bool is_hidden_near(View view, Box box, float front, Rect rect) {
  const ivec2 from = ivec2(rect.least) / (kTile * kTileBlock);
  const ivec2 extent = ivec2(rect.most) / (kTile * kTileBlock) - from + 1;
  const int columns = blocks_of(view.size).x;
  bool is_found = false;
  for (int i = int(gl_LocalInvocationID.x); i < extent.x * extent.y && !is_found; i += int(kGroupX)) {
    const ivec2 block = from + ivec2(i % extent.x, i / extent.x);
    const vec2 depths = bounds[block.y * columns + block.x];
    const bool is_near = distance_sq(box, box_of(view, block, depths.x, depths.y)) <= front * front;
    is_found = depths.x <= depths.y && is_near;
  }
  return is_found;
}

/// Lists a tile.
void list_tile(uint at, ivec2 tile, bool is_layered) {
  list[at] = pack_tile(tile) | (is_layered ? kTileLayered : 0u);
  if (is_layered) atomicAdd(counts.layered, 1u);
  const uvec2 groups = dispatch_of_tiles(at + 1u, kSparse != 0u ? 1u : kTilePixels);
  atomicMax(counts.groups.x, groups.x);
  atomicMax(counts.groups.y, groups.y);
}

/// Writes what estimators write for sky, by all invocations of a row.
void write_open(View view, ivec2 tile) {
  if (gl_LocalInvocationID.x == 0u) atomicAdd(counts.sky, 1u);
  const int plane = view.size.x * view.size.y;
  for (uint i = gl_LocalInvocationID.x; i < kTilePixels; i += kGroupX) {
    const ivec2 pixel = pixel_of_tile(tile, i);
    if (!inside(view, pixel)) continue;
    if (kSparse != 0u && !is_site(params.grid, words[word_of_pixel(params.grid, pixel)], pixel)) continue;
    const int index = index_of(view, pixel);
    ao[index + int(params.plane) * plane] = 1.0;
    if ((kMode & kClassifyWithCompleted) != 0u) completed[index] = 0.0;
    for (int k = 0; k < moments_in(kOrder); k++) moments[index + k * plane] = stored_moment(0.0);
    for (int k = 0; k < 2 && (kMode & kClassifyWithCurvature) != 0u; k++)
      moments[index + (int(params.curvature) + k) * plane] = 1.0;
  }
}

/// The tiles of a block whose estimates anybody needs, as bits.
uint needed_tiles(ivec2 tile, ivec2 count) {
  uint needed = 0u;
  for (int i = 0; i < kTilesOfBlock; i++) {
    const ivec2 part = tile_of_block(tile, i), first = part * kTile;
    bool is_needed = all(lessThan(first, params.needed_to)) && all(greaterThan(first + kTile, params.needed_from));
    if (kSelects && all(lessThan(part, count))) is_needed = is_needed && wanted[part.y * count.x + part.x] != 0u;
    needed |= is_needed ? 1u << uint(i) : 0u;
  }
  return needed;
}

void main() {
  const View view = params.view;
  const ivec2 count = tiles_of(view.size);
  const ivec2 block = ivec2(gl_WorkGroupID.x * kGroupY + gl_LocalInvocationID.y, gl_WorkGroupID.y);
  const ivec2 tile = kTileBlock * block;
  const uint row = gl_LocalInvocationID.y;
  if (gl_LocalInvocationID.x == 0u) {
    surfaces[row] = kSkips ? 0u : kAllTiles;
    nearest[row] = floatBitsToUint(kSkyDepth);
    farthest[row] = 0u;
    layered[row] = kLayered && !kSkips ? 1u : 0u;
  }
  barrier();
  // 1. Each invocation looks down its own column of the tiles, until it has seen a surface in each of them or, where
  // depths must be known, to the end.
  const bool asks_depths = kReuses || kTellsLayered;
  float near = kSkyDepth;
  float far = 0.0;
  uint seen = kSkips ? 0u : kAllTiles;
  for (int i = 0; i < kTile * kTilesOfBlock && (asks_depths || seen != kAllTiles); i++) {
    const int part = i % kTilesOfBlock;
    const ivec2 at = tile_of_block(tile, part) * kTile + ivec2(gl_LocalInvocationID.x, i / kTilesOfBlock);
    const float z = depth[index_of(view, min(at, view.size - 1))];
    if (z >= kSkyDepth) continue;
    seen |= 1u << uint(part);
    near = min(near, z);
    far = max(far, z);
  }
  if (kSkips) seen &= needed_tiles(tile, count);
  atomicOr(surfaces[row], seen);
  if (asks_depths) {
    atomicMin(nearest[row], floatBitsToUint(near));
    atomicMax(farthest[row], floatBitsToUint(far));
  }
  barrier();
  bool is_kept = false;
  if (asks_depths && tile.x < count.x && surfaces[row] != 0u) {
    const float farthest_here = uintBitsToFloat(farthest[row]);
    // 2.
    const Box box = box_of(view, block, uintBitsToFloat(nearest[row]), farthest_here);
    const float reach = reach_of_samples(view, params.radius, farthest_here);
    const Rect rect = image_of_reach(view, box, reach);
    const float front = reach_of_samples(view, params.front, farthest_here);
    // 3.
    const float told = reach_of_samples(view, params.told, farthest_here);
    if (kReuses) is_kept = is_as_before(image_of_reach(view, box, told));
    // 4.
    if (kTellsLayered && !is_kept && is_hidden_near(view, box, front, rect)) atomicOr(layered[row], 1u);
  }
  // 5.
  if (tile == ivec2(0) && gl_LocalInvocationID.x == 0u) counts.groups.z = 1u;
  const uint first_place = row * uint(kTilesOfBlock);
  for (int i = int(gl_LocalInvocationID.x); i < kTilesOfBlock; i += int(kGroupX)) {
    const ivec2 part = tile_of_block(tile, i);
    if (any(greaterThanEqual(part, count))) continue;
    const bool is_sky = (surfaces[row] >> uint(i) & 1u) == 0u;
    const uint kind = is_sky ? kTileOpen : is_kept ? kTileKept : kTileListed;
    kinds[part.y * count.x + part.x] = kind;
    if (kind == kTileKept) atomicAdd(counts.kept, 1u);
    if (kind == kTileListed) place[first_place + uint(i)] = atomicAdd(counts.listed, 1u);
  }
  barrier();
  for (int i = 0; i < kTilesOfBlock; i++) {
    const ivec2 part = tile_of_block(tile, i);
    if (any(greaterThanEqual(part, count))) continue;
    const bool is_sky = (surfaces[row] >> uint(i) & 1u) == 0u;
    if (is_sky) write_open(view, part);
    if (!is_sky && !is_kept && gl_LocalInvocationID.x == 0u)
      list_tile(place[first_place + uint(i)], part, layered[row] != 0u);
  }
}
