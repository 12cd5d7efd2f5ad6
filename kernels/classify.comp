// Sorts the tiles by what an estimator has to do for them: nothing for sky, nothing where nothing can block, and else
// the directions and steps at which something may block.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: bounds of the tiles and of groups of them.
// Out: a list of the tiles that are left, and the visibility of the others' receivers, which is 1, or what it was.
//
// The proof. Let a receiver P of a tile have the normal N, and let -N.P <= c for all of them. A surface point Q with
// depth z has N.Q = z m, where m is affine in the pixel. Q stands h = N.Q - N.P <= c + z m above P's tangent plane, so
// h / z <= c / z + m. Nothing blocks that rises by no more than `least` + z `rise` per pixel aside (clearance.glsl),
// that is, where (c - least) / z + m <= rise. With 1 / z below a plane of the other tile's bounds the left side is
// affine, and largest at a corner of that tile. Receivers whose normals differ from N by a vector of length d see at
// most d |Q - P| more. (Orthographic: -z stands for 1 / z, and nothing is divided.)
//
// What is farther than the radius from all receivers does not block either, where the estimator says so. The distance
// is that of the boxes in space that hold the surfaces of both tiles, hidden ones too.
//
// A hidden surface has the same m as the one that hides it, and is deeper: it rises less. So heights are bounded by the
// first surfaces alone.
//
// What is completed (pieces.glsl) does not change this: behind others only what stands above the tangent plane goes on,
// and at a pixel it lies deeper than what is seen there, so that c / z is less. It may lie nearer to the receiver than
// what hides it; but its end is within kFarEnd radii, and the tile of that end is listed for the same direction. Beyond
// the border goes on what stands above the tangent planes already, and what faces another way than the receivers, so
// that it may rise.
//
// Where nothing is hidden within kFarEnd radii of the receivers, nor closes a solid whose front is there, an estimator
// finds what it finds where nothing is hidden at all, to the bit (surfaces.glsl). Such tiles are listed without
// kTileLayered.
//
// With a tolerance a tile is left out, too, where nothing within the radius rises more than an angle: what is that low
// takes at most the squared sine of the angle from the visibility. The proof is the same with another height: |Q - P| /
// z is at least the distance on the image over the length of P's ray.
//
// A group of tiles is searched tile by tile only where its own bounds do not settle it. Where another frame's estimates
// still lie and nothing within reach is other than it was, they stay. Constants below 1 and pads leave room for
// rounding.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "classify.h"
#include "view.glsl"
#include "normal.glsl"
#include "clearance.glsl"
#include "lattice.glsl"
#include "tiles.glsl"
#include "proof.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kClassifySparseId) const uint kSparse = 0;
layout(constant_id = kClassifyModeId) const uint kMode = kClassifySkips;
const bool kSkips = (kMode & kClassifySkips) != 0u;
const bool kProves = (kMode & kClassifyProves) != 0u;
const bool kReuses = (kMode & kClassifyReuses) != 0u;
const bool kSelects = (kMode & kClassifySelects) != 0u;
const bool kCompletes = (kMode & kClassifyCompletes) != 0u;
const bool kLayered = (kMode & kClassifyLayered) != 0u;
const bool kTolerates = (kMode & kClassifyTolerates) != 0u;
layout(scalar, push_constant) uniform Push { ClassifyParams params; };
layout(scalar, binding = kClassifyBounds) readonly buffer Bounds { TileBounds bounds[]; };
layout(scalar, binding = kClassifyGroups) readonly buffer Groups { GroupBounds groups[]; };
layout(scalar, binding = kClassifyChanges) readonly buffer Changes { uint changes[]; };
layout(scalar, binding = kClassifyDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kClassifyNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kClassifyList) writeonly buffer List { ListedTile list[]; };
layout(scalar, binding = kClassifyCounts) buffer Counts { TileCounts counts; };
layout(scalar, binding = kClassifyAo) writeonly buffer Ao { float ao[]; };
layout(scalar, binding = kClassifyBent) writeonly buffer Bent { float bent[]; };
layout(scalar, binding = kClassifyCompleted) writeonly buffer Completed { float completed[]; };
layout(scalar, binding = kClassifyNeeded) readonly buffer Needed { uint wanted[]; };
layout(scalar, binding = kClassifyRows) readonly buffer Rows { uint rows[]; };
layout(scalar, binding = kClassifySectors) writeonly buffer Sectors { uint sectors_of_tile[]; };

/// With more groups of tiles within reach than these, the search costs more than it saves.
const int kMostGroups = 512;
const uint kGroupWords = uint(kMostGroups) / 32u;

/// Groups are far from this many pixels from the block on.
const int kFarGroup = 32;

// What the invocations of a row find about their block. Between two barriers a value is either read or changed, and it
// is changed by atomics whose results nobody looks at, or by one invocation: a row need not run in lock step.
// Sectors in which something within the radius may block, and those of them that the block itself and its neighbours
// take.
shared uint found[kGroupY], beside[kGroupY];
// Whether something within the radius rises more than the tolerance; without one, more than is harmless.
shared uint risen[kGroupY];
// Whether hidden surfaces may count.
shared uint layered[kGroupY];
// Tiles of the block that show a surface, as bits; where in the list the tiles are.
shared uint surfaces[kGroupY], place[kGroupY * kBlock * kBlock];
// Depths of the block, as bits: those of positive floats have the order of the floats.
shared uint nearest[kGroupY], farthest[kGroupY];
// Groups that their bounds do not settle, as bits.
shared uint unsettled[kGroupY * kGroupWords];
// The range of steps of each sector, found or not.
shared uint first[kGroupY * kSectorsOfTurn], last[kGroupY * kSectorsOfTurn];
const uint kAllTiles = (1u << (kBlock * kBlock)) - 1u;

uint changes_at(ivec2 corner, ivec2 blocks) { return changes[corner.y * (blocks.x + 1) + corner.x]; }

/// Whether everything that the estimates of a block of tiles are made from is as it was in the frame before.
bool is_as_before(View view, ivec2 tile, float near, float far) {
  const Rect rect =
      image_of_reach(view, box_of(view, tile, kBlock, near, far), reach_of_samples(view, params.radius, far));
  const ivec2 most = params.frame_size - 1;
  const int margin = params.margin + (kSparse != 0u ? kSiteReach * params.factor : 0);
  const ivec2 blocks = (params.frame_size + kChangeBlock - 1) / kChangeBlock;
  const ivec2 from = clamp(ivec2(rect.least) * params.factor - params.overhang - margin, ivec2(0), most) / kChangeBlock;
  const ivec2 to =
      clamp(ivec2(rect.most + 1.0) * params.factor - params.overhang + margin, ivec2(0), most) / kChangeBlock + 1;
  return changes_at(to, blocks) + changes_at(from, blocks) ==
         changes_at(ivec2(from.x, to.y), blocks) + changes_at(ivec2(to.x, from.y), blocks);
}

/// Group i of those within reach, row by row.
ivec2 group_at(Receivers r, int i) {
  // Divisions of whole numbers are slow; with numbers up to kMostGroups this one is exact.
  const int line = int((float(i) + 0.5) * (1.0 / float(r.extent.x)));
  return r.from + ivec2(i - line * r.extent.x, line);
}

GroupBounds bounds_of(View view, ivec2 group) { return groups[group.y * groups_of_tiles(view.size).x + group.x]; }

/// Whether a square of pixels may hold the end of a surface that the image's border cuts: a search looks up to a step
/// before the border.
bool is_at_border(View view, ivec2 first_pixel, int side) {
  return any(equal(first_pixel, ivec2(0))) || any(greaterThanEqual(first_pixel + side, view.size - 1));
}

/// Nothing in a group blocks by its bounds. Those at the border do not tell what goes on beyond it.
bool is_settled(View view, Receivers r, ivec2 group, GroupBounds b) {
  const float limit = harmless_height(r, distances_px(r, group * kGroupSide, kGroupSide).x, b.level);
  const float half_side = 0.5 * float(kGroupSide - 1);
  const vec2 centre = vec2(group * kGroupSide) + half_side;
  const float above =
      min(most_above(r, centre, half_side, vec2(0), b.level), most_above(r, centre, half_side, b.gradient, b.plane));
  const bool goes_on = kCompletes && is_at_border(view, group * kGroupSide, kGroupSide);
  return b.last > b.level ? true : above <= limit && !goes_on;
}

/// Whether a square of pixels is so far away that nothing in it blocks, and that nothing of it goes on as something
/// that does.
bool is_too_far(View view, Receivers r, ivec2 first_pixel, int side, float level, float last_surface) {
  if ((kMode & kClassifyRanged) == 0u) return false;
  return distance_sq(r.box, box_of(view, first_pixel / kTile, side / kTile, depth_of(view, level),
                                   depth_of(view, last_surface))) > r.reach_sq;
}

/// Whether surfaces that stand nowhere above the tangent planes in a tile may rise above them beyond the border.
bool may_rise_beyond(Receivers r, uint word, float turned) {
  const float differs = word == kNoNormal ? kFar : length(unpack_normal(word) - r.normal) + turned;
  return differs + r.differs > kSameSlope;
}

/// Adds a square of pixels, in which something stands above the tangent planes, to the sectors and steps at which
/// something may block.
void mark(View view, Receivers r, ivec2 first_pixel, int side, float level, float last_surface, bool is_near,
          bool rises) {
  const uint row = gl_LocalInvocationID.y;
  const ivec2 apart = distances_px(r, first_pixel, side);
  const vec2 offset = vec2(first_pixel - r.tile * kTile);
  const uint sectors = sectors_of_offsets(offset - float(kBlock * kTile), offset + float(side));
  // What stands above, but too far to block, may yet go on as something that does.
  const bool too_far = is_too_far(view, r, first_pixel, side, level, last_surface);
  if (!too_far) atomicOr(found[row], sectors);
  if (!too_far && rises) atomicOr(risen[row], 1u);
  if (is_near && rises) atomicOr(beside[row], sectors);
  for (uint left = sectors; left != 0u; left &= left - 1u) {
    const uint k = row * kSectorsOfTurn + uint(findLSB(left));
    atomicMin(first[k], uint(apart.x));
    atomicMax(last[k], uint(apart.y));
  }
}

/// Adds a tile to the sectors and steps at which something may block, if something in it may.
void search_tile(View view, Receivers r, ivec2 other, bool is_near) {
  const uint row = gl_LocalInvocationID.y;
  const ivec2 count = tiles_of(view.size), last_tile = count - 1;
  const int index = other.y * count.x + other.x;
  const float level = bounds[index].plane[kLevel], farthest = bounds[index].farthest;
  const ivec2 apart = distances_px(r, other * kTile, kTile);
  const float limit = harmless_height(r, apart.x, level);
  const vec2 centre = vec2(other * kTile) + kHalfTile;
  float above = farthest > level
                    ? -kFar
                    : min(most_above(r, centre, kHalfTile, vec2(0), level),
                          most_above(r, centre, kHalfTile, bounds[index].gradient, bounds[index].plane[0]));
  // An edge in it may be the end of a neighbour's surface.
  const int planes = above <= limit ? 0 : int(bounds[index].mixed) * 8;
  for (int k = 0; k < planes && above > limit; k++) {
    const ivec2 neighbor = clamp(other + neighbor_step(k), ivec2(0), last_tile);
    above = min(above, most_above(r, centre, kHalfTile, bounds[neighbor.y * count.x + neighbor.x].gradient,
                                  bounds[index].plane[k + 1]));
  }
  const bool goes_on = kCompletes && farthest <= level && is_at_border(view, other * kTile, kTile)
                           ? above > limit || may_rise_beyond(r, bounds[index].normal, bounds[index].turned)
                           : false;
  const bool rises = kTolerates ? goes_on || above > tolerated_height(view, r, apart.x, level) : true;
  for (bool once = goes_on || above > limit; once; once = false)
    mark(view, r, other * kTile, kTile, level, bounds[index].last, is_near, rises);
}

Receivers receivers_of(View view, ivec2 tile, Shared own) {
  const bool perspective = view.orthographic == 0, ranged = (kMode & kClassifyRanged) != 0u;
  const vec3 n = unpack_normal(own.normal);
  const float near = depth_of(view, own.nearest), far = depth_of(view, own.farthest);
  const vec2 widest = max(abs(tangent_of(view, vec2(0))), abs(tangent_of(view, vec2(view.size))));
  const float longest_ray = perspective ? sqrt(1.0 + dot(widest, widest)) : 1.0;
  const float reach = reach_of_samples(view, params.radius, far);
  Receivers r;
  r.tile = tile;
  r.box = box_of(view, tile, kBlock, near, far);
  r.reach = reach;
  r.reach_sq = kCompletes ? kFarEnd * kFarEnd * reach * reach : reach * reach;
  r.normal = n;
  r.rise = kClaimed * least_rise(view);
  r.tolerated = kToleranceClaimed * params.tolerated / longest_ray *
                min(abs(view.tangent_per_pixel.x), abs(view.tangent_per_pixel.y));

  // A unit of depth is at least so much height at every receiver: their normals differ.
  const float height = (perspective ? own.lowest / far : n.z) - own.turned * longest_ray;
  const float least = kClaimed * least_height(params.depth_precision, near, max(height, 0.0));
  r.least = least;
  r.differs = own.turned + (least <= kFeignedHeight * params.radius ? 0.0 : kFar);
  r.along = n.xy * view.tangent_per_pixel;
  r.nearness = perspective ? max(own.highest - least, 0.0) : n.z;
  r.affine = dot(n.xy, tangent_of(view, vec2(0.5))) + (perspective ? -n.z : own.highest - least);
  const float farthest_end = kCompletes ? kFarEnd * reach : reach;
  // |Q - P| is at most that, or, where nothing is too far to block, |Q| + |P|; over z in perspective.
  r.turned = own.turned * (perspective ? (ranged ? 0.0 : longest_ray) : farthest_end);
  r.turned_by_nearness = own.turned * (perspective ? (ranged ? farthest_end : longest_ray * far) : 0.0);

  const Rect rect = image_of_reach(view, r.box, reach);
  r.from = ivec2(rect.least / float(kGroupSide));
  r.extent = ivec2(rect.most / float(kGroupSide)) - r.from + 1;
  // Orthographic, nothing bounds how much higher above another normal's plane a far place may be.
  if (own.normal == kNoNormal || r.extent.x * r.extent.y > kMostGroups || (!perspective && !ranged && own.turned > 0.0))
    r.extent = ivec2(0);
  return r;
}

/// Searches a group tile by tile, with all invocations of the row. Steps grow with the distance, so it does not matter
/// where in a far group something stands if its sectors are among the `known` ones: such a group is marked as a whole.
/// All invocations of the row must pass the same sectors, since together they decide what becomes of the group.
void search_group(View view, Receivers r, ivec2 group, uint known) {
  const ivec2 last_tile = tiles_of(view.size) - 1;
  const vec2 offset = vec2((group * kTileGroup - r.tile) * kTile);
  const uint sectors =
      known != 0u ? sectors_of_offsets(offset - float(kBlock * kTile), offset + float(kGroupSide)) : kEverySector;
  const bool is_coarse = (sectors & ~known) == 0u;
  for (bool once = is_coarse && gl_LocalInvocationID.x == 0u; once; once = false)
    mark(view, r, group * kGroupSide, kGroupSide, bounds_of(view, group).level, bounds_of(view, group).last, false,
         true);
  for (int k = int(gl_LocalInvocationID.x); k < kTileGroup * kTileGroup && !is_coarse; k += int(kGroupX)) {
    const ivec2 other = group * kTileGroup + ivec2(k % kTileGroup, k / kTileGroup);
    if (all(lessThanEqual(other, last_tile))) search_tile(view, r, other, false);
  }
}

/// Searches the near or the far ones of the unsettled groups among the first `count` within reach.
void search_groups(View view, Receivers r, int count, bool is_far, uint known) {
  const uint row = gl_LocalInvocationID.y;
  for (int word = 0; word * 32 < count; word++)
    for (uint bits = unsettled[row * kGroupWords + uint(word)]; bits != 0u; bits &= bits - 1u) {
      const ivec2 group = group_at(r, word * 32 + findLSB(bits));
      const bool is_next = (distances_px(r, group * kGroupSide, kGroupSide).x >= kFarGroup) == is_far;
      for (bool once = is_next; once; once = false) search_group(view, r, group, known);
    }
}

/// Finds the sectors and steps at which something may block a receiver of the block, with all invocations of its row.
/// All rows take part, as they wait for each other.
void find_sectors(View view, Receivers r) {
  const uint row = gl_LocalInvocationID.y, lane = gl_LocalInvocationID.x;
  const ivec2 last_tile = tiles_of(view.size) - 1;
  const int searched = r.extent.x * r.extent.y, around = kBlock + 2;
  if (lane == 0u) {
    found[row] = 0u;
    risen[row] = searched > 0 ? 0u : 1u;
    beside[row] = searched > 0 ? 0u : kEverySector;
  }
  for (uint k = lane; k < kSectorsOfTurn; k += kGroupX) {
    first[row * kSectorsOfTurn + k] = ~0u;
    last[row * kSectorsOfTurn + k] = 0u;
  }
  for (uint k = lane; k < kGroupWords; k += kGroupX) unsettled[row * kGroupWords + k] = 0u;
  barrier();
  // The block and its neighbours decide most.
  for (int i = int(lane); i < around * around && searched > 0; i += int(kGroupX)) {
    const int line = int((float(i) + 0.5) / float(around));
    search_tile(view, r, clamp(r.tile - 1 + ivec2(i - around * line, line), ivec2(0), last_tile), true);
  }
  barrier();
  const int left = beside[row] != kEverySector ? searched : 0;
  for (int i = int(lane); i < left; i += int(kGroupX)) {
    const ivec2 group = group_at(r, i);
    const GroupBounds b = bounds_of(view, group);
    const bool settled = is_settled(view, r, group, b);
    const bool too_far = is_too_far(view, r, group * kGroupSide, kGroupSide, b.level, b.last);
    for (bool once = !settled && too_far; once; once = false)
      mark(view, r, group * kGroupSide, kGroupSide, b.level, b.last, false, true);
    if (!settled && !too_far) atomicOr(unsettled[row * kGroupWords + uint(i) / 32u], 1u << (uint(i) & 31u));
  }
  barrier();
  search_groups(view, r, left, false, 0u);
  barrier();
  // Between two barriers, so that all invocations of a row know the same, whatever the first of them marks next.
  const uint known = risen[row] != 0u ? found[row] : 0u;
  barrier();
  search_groups(view, r, left, true, known);
  barrier();
}

/// Whether something is hidden so near to the receivers that an estimator looks at it.
bool is_hidden_near(View view, Receivers r, ivec2 first_tile, int tiles, float nearest, float farthest) {
  if (nearest <= -kFar) return false;
  return distance_sq(r.box, box_of(view, first_tile, tiles, depth_of(view, nearest), depth_of(view, farthest))) <=
         kFarEnd * kFarEnd * r.reach * r.reach;
}

/// Finds whether hidden surfaces may count for a block, with all invocations of its row.
void find_hidden(View view, Receivers r, bool has_receivers) {
  const ivec2 count = tiles_of(view.size);
  const Rect rect = image_of_reach(view, r.box, r.reach);
  const ivec2 from = ivec2(rect.least / float(kGroupSide));
  const ivec2 extent = has_receivers ? ivec2(rect.most / float(kGroupSide)) - from + 1 : ivec2(0);
  bool is_found = false;
  for (int i = int(gl_LocalInvocationID.x); i < extent.x * extent.y && !is_found; i += int(kGroupX)) {
    const ivec2 group = from + ivec2(i % extent.x, i / extent.x);
    const GroupBounds b = bounds_of(view, group);
    const bool is_near = is_hidden_near(view, r, group * kTileGroup, kTileGroup, b.hidden, b.last);
    for (int k = 0; k < kTileGroup * kTileGroup && is_near && !is_found; k++) {
      const ivec2 tile = group * kTileGroup + ivec2(k % kTileGroup, k / kTileGroup);
      const int index = min(tile.y, count.y - 1) * count.x + min(tile.x, count.x - 1);
      is_found = is_hidden_near(view, r, tile, 1, bounds[index].hidden, bounds[index].last);
    }
  }
  if (is_found) atomicOr(layered[gl_LocalInvocationID.y], 1u);
}

/// Lists a tile, by all invocations of a row, which each put down the ranges of their own sectors.
void list_tile(uint at, ivec2 tile, bool is_whole) {
  const uint row = gl_LocalInvocationID.y;
  for (uint k = gl_LocalInvocationID.x; k < kSectorsOfTurn; k += kGroupX) {
    const bool is_found = (found[row] >> k & 1u) != 0u;
    list[at].ranges[k] = is_whole   ? kWholeRange
                         : is_found ? pack_range(first[row * kSectorsOfTurn + k], last[row * kSectorsOfTurn + k])
                                    : 0u;
  }
  if (gl_LocalInvocationID.x != 0u) return;
  list[at].place = pack_tile(tile) | (layered[row] != 0u ? kTileLayered : 0u);
  if (layered[row] != 0u) atomicAdd(counts.layered, 1u);
  const uvec2 groups = dispatch_of_tiles(at + 1u, kSparse != 0u ? 1u : kTilePixels);
  atomicMax(counts.groups.x, groups.x);
  atomicMax(counts.groups.y, groups.y);
}

/// Writes what estimators write where nothing blocks, by all invocations of a row.
void write_open(View view, ivec2 tile, bool is_sky, bool is_tolerated) {
  if (gl_LocalInvocationID.x == 0u) {
    atomicAdd(counts.sky, is_sky ? 1u : 0u);
    atomicAdd(counts.open, is_sky ? 0u : 1u);
    atomicAdd(counts.tolerated, !is_sky && is_tolerated ? 1u : 0u);
  }
  const int plane = view.size.x * view.size.y;
  for (uint i = gl_LocalInvocationID.x; i < kTilePixels; i += kGroupX) {
    const ivec2 pixel = pixel_of_tile(tile, i);
    if (!inside(view, pixel)) continue;
    if (kSparse != 0u && !is_site(rows[word_of_pixel(pixel, tiles_of(view.size))], pixel.x)) continue;
    const int index = index_of(view, pixel);
    ao[index + int(params.plane) * plane] = 1.0;
    if ((kMode & kClassifyWithCompleted) != 0u) completed[index] = 0.0;
    if ((kMode & kClassifyWithBent) != 0u) {
      const vec3 stored =
          depth[index] >= kSkyDepth ? stored_bent(vec3(0)) : stored_bent(open_bent(unpack_normal(normal[index])));
      for (int c = 0; c < 3; c++) bent[index + c * plane] = stored[c];
    }
  }
}

/// What the receivers of a block of tiles have in common.
Shared shared_by(ivec2 tile, ivec2 count) {
  Shared block = Shared(-kFar, kFar, kNoNormal, 0.0, kFar, -kFar);
  bool agree = true;
  for (int i = 0; i < kBlock * kBlock; i++) {
    const ivec2 part = tile_of_block(tile, i);
    const int index = min(part.y, count.y - 1) * count.x + min(part.x, count.x - 1);
    const float level = bounds[index].plane[kLevel], farthest = bounds[index].farthest;
    if (any(greaterThanEqual(part, count)) || farthest > level) continue;
    block.nearest = max(block.nearest, level);
    block.farthest = min(block.farthest, farthest);
    if (block.normal == kNoNormal) block.normal = bounds[index].normal;
    agree = agree && bounds[index].normal != kNoNormal && bounds[index].normal == block.normal;
    block.turned = max(block.turned, bounds[index].turned);
    block.lowest = min(block.lowest, bounds[index].lowest);
    block.highest = max(block.highest, bounds[index].highest);
  }
  if (!agree) block.normal = kNoNormal;
  return block;
}

/// The tiles of a block whose estimates anybody needs, as bits.
uint needed_tiles(ivec2 tile, ivec2 count) {
  uint needed = 0u;
  for (int i = 0; i < kBlock * kBlock; i++) {
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
  const ivec2 tile = kBlock * ivec2(gl_WorkGroupID.x * kGroupY + gl_LocalInvocationID.y, gl_WorkGroupID.y);
  const uint row = gl_LocalInvocationID.y;
  if (gl_LocalInvocationID.x == 0u) {
    surfaces[row] = kSkips ? 0u : kAllTiles;
    nearest[row] = floatBitsToUint(kSkyDepth);
    farthest[row] = 0u;
    beside[row] = kEverySector;  // unless a search finds less
    layered[row] = kLayered && !kProves ? 1u : 0u;
  }
  barrier();
  // Each invocation looks down its own column of the tiles, until it has seen a surface in each of them or, where
  // depths must be known, to the end.
  float near = kSkyDepth;
  float far = 0.0;
  uint seen = kSkips ? 0u : kAllTiles;
  for (int i = 0; i < kTile * kBlock * kBlock && (kReuses || seen != kAllTiles); i++) {
    const int part = i % (kBlock * kBlock);
    const ivec2 at = tile_of_block(tile, part) * kTile + ivec2(gl_LocalInvocationID.x, i / (kBlock * kBlock));
    const float z = depth[index_of(view, min(at, view.size - 1))];
    if (z >= kSkyDepth) continue;
    seen |= 1u << uint(part);
    near = min(near, z);
    far = max(far, z);
  }
  if (kSkips) seen &= needed_tiles(tile, count);
  atomicOr(surfaces[row], seen);
  if (kReuses) {
    atomicMin(nearest[row], floatBitsToUint(near));
    atomicMax(farthest[row], floatBitsToUint(far));
  }
  barrier();
  const bool is_kept = kReuses && surfaces[row] != 0u
                           ? is_as_before(view, tile, uintBitsToFloat(nearest[row]), uintBitsToFloat(farthest[row]))
                           : false;
  Shared own = Shared(1.0, 1.0, kNoNormal, 0.0, 0.0, 0.0);
  const bool is_asked = tile.x < count.x && !is_kept && surfaces[row] != 0u;
  if (kProves && is_asked) own = shared_by(tile, count);
  const Receivers receivers = receivers_of(view, tile, own);
  if (kProves && kLayered) find_hidden(view, receivers, is_asked && own.farthest <= own.nearest);
  if (kProves) find_sectors(view, receivers);
  if (tile == ivec2(0) && gl_LocalInvocationID.x == 0u) counts.groups.z = 1u;
  const bool is_whole = beside[row] == kEverySector;
  const uint sectors = is_whole ? kEverySector : risen[row] != 0u ? found[row] : 0u;
  const uint first_place = row * uint(kBlock * kBlock);
  for (int i = int(gl_LocalInvocationID.x); i < kBlock * kBlock; i += int(kGroupX)) {
    const ivec2 part = tile_of_block(tile, i);
    if (any(greaterThanEqual(part, count))) continue;
    const bool is_sky = (surfaces[row] >> uint(i) & 1u) == 0u, keeps = is_kept && !is_sky;
    const uint word = is_sky ? kTileOpen : is_kept ? kTileKept : sectors;
    sectors_of_tile[part.y * count.x + part.x] = word;
    if (keeps) atomicAdd(counts.kept, 1u);
    if (!keeps && word != kTileOpen) place[first_place + uint(i)] = atomicAdd(counts.listed, 1u);
  }
  barrier();
  for (int i = 0; i < kBlock * kBlock; i++) {
    const ivec2 part = tile_of_block(tile, i);
    const bool is_inside = all(lessThan(part, count));
    const bool is_sky = (surfaces[row] >> uint(i) & 1u) == 0u;
    const bool is_open = is_sky || !is_kept && sectors == 0u;
    if (is_inside && is_open) write_open(view, part, is_sky, kTolerates && found[row] != 0u);
    if (is_inside && !is_open && !is_kept) list_tile(place[first_place + uint(i)], part, is_whole);
  }
}
