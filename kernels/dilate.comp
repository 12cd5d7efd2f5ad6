// Runs of pixels that a separable filter has work in: those within its reach of an estimate that is not proved to be 1.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: tiles by what classify found. Out: lists of runs for `denoise`, and what it would write everywhere else, where that is not there already.
// Of nothing but 1 a filter makes 1. Where nothing within its reach is other than in the frame before, what it made then still lies in its place.
// A run is 8 lines wide and as long as an invocation of `denoise` looks along one. Columns are filtered last, so theirs decide what rows must make.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "dilate.h"
#include "denoise.h"
#include "stride.glsl"
#include "tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kDilateRadiusId) const int kRadius = 4;
layout(constant_id = kDilateStrideId) const int kStride = 1;
layout(constant_id = kDilateAlongId) const uint kAlong = kDilateAlongColumns;
layout(scalar, push_constant) uniform Push { DilateParams params; };
layout(scalar, binding = kDilateTiles) readonly buffer Tiles { uint tiles[]; };
layout(scalar, binding = kDilateColumns) buffer Columns { uint columns[]; };
layout(scalar, binding = kDilateList) writeonly buffer List { uint list[]; };
layout(scalar, binding = kDilateCounts) buffer Counts { RunCounts counts; };
layout(scalar, binding = kDilateResult) writeonly buffer Result { float result[]; };

/// Of a workgroup: how many runs it lists, and where.
shared uint listed_here, begin;

/// Whether a run along columns has work; writes what it makes where it has none.
bool lists_columns(int lines, int run) {
  const ivec2 count = tiles_of(params.size), first = ivec2(lines * kTile, run * kDenoiseRun), end = min(first + ivec2(kTile, kDenoiseRun), params.size);
  const ivec2 from = max(first - kRadius, ivec2(0)) / kTile, to = min((end - 1 + kRadius) / kTile, count - 1);
  bool estimated = false, changed = false;
  for (int y = from.y; y <= to.y; y++)
    for (int x = from.x; x <= to.x; x++) {
      const uint tile = tiles[y * count.x + x];
      estimated = estimated || tile != kTileOpen;
      changed = changed || tile != kTileKept;
    }
  for (int y = first.y; y < end.y && !estimated; y++)
    for (int x = first.x; x < end.x; x++) result[y * params.size.x + x] = 1.0;
  return estimated && changed;
}

/// Whether a run along rows is read by one along columns that has work.
bool lists_rows(int lines, int run) {
  const int first = max(run * kDenoiseRun - kStride + 1, 0) / kTile, last = min((run + 1) * kDenoiseRun - 1, params.size.x - 1) / kTile;
  const int above = max(lines * kTile - kRadius, 0) / kDenoiseRun, below = min((lines + 1) * kTile - 1 + kRadius, params.size.y - 1) / kDenoiseRun;
  bool is_read = false;
  for (int x = first; x <= last; x++)
    for (int y = above; y <= below; y++) is_read = is_read || columns[x * params.runs_in_column + y] != 0u;
  return is_read;
}

void main() {
  const int run = int(gl_GlobalInvocationID.x), lines = int(gl_GlobalInvocationID.y);
  const bool along_columns = kAlong == kDilateAlongColumns, inside = run < params.runs && lines < params.lines, first = gl_LocalInvocationIndex == 0u;
  bool listed = false;
  if (inside) listed = along_columns ? lists_columns(lines, run) : lists_rows(lines, run);
  if (inside && along_columns) columns[lines * params.runs + run] = listed ? 1u : 0u;
  // Neighbours stay together in the list, as they read the same pixels.
  if (first) listed_here = 0u;
  barrier();
  uint at = 0u;
  if (listed) at = atomicAdd(listed_here, 1u);
  barrier();
  if (first) {
    begin = atomicAdd(counts.listed, listed_here);
    const uvec2 groups = dispatch_of((begin + listed_here + kGroupY - 1u) / kGroupY);
    atomicMax(counts.groups.x, groups.x), atomicMax(counts.groups.y, groups.y);
    counts.groups.z = 1u;
  }
  barrier();
  if (listed) list[begin + at] = pack_run(lines, run);
}
