// Lists where a filter has work: within its reach of a tile that is not open.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: tiles by what classify found.
// Out: lists for `denoise` or `interpolate`, and for `upsample`, and what they would write everywhere else, where that
// is not there already.
//
// From nothing but 1 a filter makes 1. Where nothing within its reach differs from the frame before, what it made then
// still lies in its place.
//
// Denoising is listed by runs, 8 lines wide and as long as an invocation looks along one. Columns are filtered last, so
// theirs decide what rows must make. Upsampling is listed by workgroups: squares of 8 x 8 between the centres of
// blocks.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/filters/filters.h"
#include "kernels/base/tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kRadius = 4;                   // the denoiser's, px; 0: there is none
layout(constant_id = 1) const uint kMode = kDilateAlongColumns;  // one of kDilate*
layout(scalar, push_constant) uniform Push { DilateParams params; };
readonly buffer Tiles { uint tiles[]; };  // one uint per tile, from classify
// one uint per run along columns, line by line: 1 if it is listed; written along columns, read along rows
buffer Columns { uint columns[]; };
writeonly buffer List { uint list[]; };  // one uint per run or group that is listed, see pack_run
buffer Counts { RunCounts counts; };     // zeros before
// one float per pixel of the filter's result, where it is neither computed nor kept: 1; not along rows
writeonly buffer Result { float result[]; };

/// The number of runs that the workgroup lists, and their first place in the list.
shared uint listed_here, begin;

struct Within {
  bool estimated, changed;  // some tile may differ from 1, or from what it was
};

/// The pixels within reach of a rectangle of them.
Within reach_of(ivec2 first, ivec2 end) {
  const ivec2 count = tiles_of(params.size);
  const ivec2 from = max(first - kRadius, ivec2(0)) / kTile;
  const ivec2 to = min((end - 1 + kRadius) / kTile, count - 1);
  Within within = Within(false, false);
  for (int y = from.y; y <= to.y; y++)
    for (int x = from.x; x <= to.x; x++) {
      const uint tile = tiles[y * count.x + x];
      within.estimated = within.estimated || tile != kTileOpen;
      within.changed = within.changed || tile != kTileKept;
    }
  return within;
}

/// Whether a rectangle has work; writes what the filter makes where it has none, of these pixels of the result.
bool lists(Within within, ivec2 first, ivec2 end, int width) {
  for (int y = first.y; y < end.y && !within.estimated; y++)
    for (int x = first.x; x < end.x; x++) result[y * width + x] = 1.0;
  return within.estimated && within.changed;
}

bool lists_columns(int lines, int run) {
  const ivec2 first = ivec2(lines * kTile, run * kDenoiseRun);
  const ivec2 end = min(first + ivec2(kTile, kDenoiseRun), params.size);
  return lists(reach_of(first, end), first, end, params.size.x);
}

bool lists_upsampling(ivec2 group) {
  const ivec2 block = group * ivec2(kGroupX, kGroupY) - 1;
  const ivec2 full = params.factor * block + params.factor / 2 - params.overhang;
  const Within within = reach_of(max(block, ivec2(0)), min(block + ivec2(kGroupX, kGroupY) + 1, params.size));
  return lists(within, max(full, ivec2(0)), min(full + params.factor * ivec2(kGroupX, kGroupY), params.full_size),
               params.full_size.x);
}

/// Whether a run along rows is read by one along columns that has work.
bool lists_rows(int lines, int run) {
  const int first = run * kDenoiseRun / kTile;
  const int last = min((run + 1) * kDenoiseRun - 1, params.size.x - 1) / kTile;
  const int above = max(lines * kTile - kRadius, 0) / kDenoiseRun;
  const int below = min((lines + 1) * kTile - 1 + kRadius, params.size.y - 1) / kDenoiseRun;
  bool is_read = false;
  for (int x = first; x <= last; x++)
    for (int y = above; y <= below; y++) is_read = is_read || columns[x * params.runs_in_column + y] != 0u;
  return is_read;
}

void main() {
  const int run = int(gl_GlobalInvocationID.x), lines = int(gl_GlobalInvocationID.y);
  const bool inside = run < params.runs && lines < params.lines;
  const bool first = gl_LocalInvocationIndex == 0u;
  bool listed = false;
  if (inside && kMode == kDilateAlongColumns) listed = lists_columns(lines, run);
  if (inside && kMode == kDilateAlongRows) listed = lists_rows(lines, run);
  if (inside && kMode == kDilateUpsample) listed = lists_upsampling(ivec2(run, lines));
  if (inside && kMode == kDilateAlongColumns) columns[lines * params.runs + run] = listed ? 1u : 0u;
  // Neighbours stay together in the list, as they read the same pixels.
  if (first) listed_here = 0u;
  barrier();
  uint at = 0u;
  if (listed) at = atomicAdd(listed_here, 1u);
  barrier();
  if (first) {
    begin = atomicAdd(counts.listed, listed_here);
    const uint per_group = kMode == kDilateUpsample ? 1u : kGroupY;
    const uvec2 groups = dispatch_of((begin + listed_here + per_group - 1u) / per_group);
    atomicMax(counts.groups.x, groups.x);
    atomicMax(counts.groups.y, groups.y);
    atomicMax(counts.groups.z, 1u);
  }
  barrier();
  if (listed) list[begin + at] = pack_run(lines, run);
}
