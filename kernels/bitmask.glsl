// The search of a side of a slice by bitmask.comp and bitmask_layers.comp: samples, and the sectors they block.
// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel has declared its buffers, constants and parameters, and how many surfaces a pixel has at most, kSurfaces.
// It is one of two kernels since drivers take long over code that is left out by a specialization constant alone.

const uint kFalloff = kMode & ~(kWithBent | kWithCompleted);
const bool kBent = (kMode & kWithBent) != 0u;
/// Instead of 0, across the view ray.
const float kLeastAcross = 1e-7;

const bool kBeyondBorder = (kComplete & kCompletesBorder) != 0u;
// What endless occluders hide is blocked anyway: the host does not ask for it.
const bool kBehindOthers = (kComplete & kCompletesHidden) != 0u;
const bool kTellsCompleted = (kMode & kWithCompleted) != 0u;

#include "pieces.glsl"

/// A sample whose distance is that in space, not in the slice.
Sample surface_at(Receiver r, Side side, Reach reach, float offset, vec2 beside, float z) {
  const float scale = r.perspective ? z : 1.0;
  const vec2 place = place_of(r, side, beside, z, scale);
  const vec3 delta = offset_to(r, beside, z, scale);
  const float distance_sq = dot(delta, delta);
  const bool above = is_above(r, reach, place, distance_sq, offset, beside, z, scale);
  return Sample(offset, z, scale, place, slope_of(place), distance_sq, above,
                above ? distance_sq < reach.radius_sq : false);
}

#include "surfaces.glsl"

/// What a search has found to be blocked.
struct Found {
  uint bits;
  float blocked;    // sectors, each weighed by its falloff
  float completed;  // of them those that only completed surfaces block
  vec2 bent;        // with falloff: what is blocked of the bent normal
};

/// Blocks sectors that are `distance` from the receiver; those that are blocked already stay as they are.
float block(inout Found found, Side side, Reach reach, float shift, uint sectors, float distance) {
  const uint added = sectors & ~found.bits;
  const float weight = falloff_weight(kFalloff, distance, reach.falloff_start, reach.radius);
  found.bits |= added;
  found.blocked += float(bitCount(added)) * weight;
  if (kBent && kFalloff != kFalloffNone) found.bent += weight * bent_of_sectors(side, added, shift);
  return float(bitCount(added)) * weight;
}

/// The sectors between two slopes, the larger one first; none if it is not.
uint sectors_between(Side side, vec2 slopes, float shift) {
  const vec2 near = place_at(slopes.x), far = place_at(slopes.y);
  const float whole = whole_arc(side);
  const uint before = sectors_to(side, whole, near.y / max(near.x, kLeastAcross), shift);
  const uint behind = sectors_to(side, whole, far.y / max(far.x, kLeastAcross), shift);
  return slopes.x >= slopes.y ? behind & ~before : 0u;
}

/// Blocks what a completed surface covers.
void block_completed(inout Found found, Side side, Reach reach, float shift, Piece piece) {
  const uint sectors = sectors_between(side, slopes_of(piece), shift);
  found.completed += block(found, side, reach, shift, sectors, length(0.5 * (piece.near + piece.far)));
}

/// Blocks what goes on behind something nearer. behind_last: the sample after the last one.
void complete_behind(inout Found found, Receiver r, Side side, Reach reach, Draw draw, int count,
                     Interruptions interrupted, int behind_last) {
  for (uint left = interrupted.jumps; left != 0u; left &= left - 1u) {
    const Piece piece =
        piece_behind(r, side, reach, draw, count, interrupted, interrupted.first + findLSB(left), behind_last);
    block_completed(found, side, reach, draw.shift, piece);
  }
}

/// Blocks what the image's border cuts, and what goes on of it beyond the border.
void complete_beyond(inout Found found, Receiver r, Side side, Reach reach, Draw draw) {
  const Sample border = sample_at(r, side, reach, floor(side.reach));
  const Piece piece = piece_beyond(r, side, reach, border);
  block(found, side, reach, draw.shift, sectors_between(side, slopes_at_border(r, reach, border), draw.shift),
        sqrt(border.distance_sq));
  block_completed(found, side, reach, draw.shift, piece);
}

/// Searches a side where one surface is known at a pixel.
void search_runs(inout Found found, Receiver r, Side side, Reach reach, Draw draw, int count) {
  const float jitter = draw.jitter, shift = draw.shift;
  const float whole = whole_arc(side), endless = 1e30;
  Sample last = receiver_sample(r);
  float last_cot = side.plane_cot;
  bool own = true, last_blocks = true;
  vec2 start = vec2(0);
  Interruptions interrupted = Interruptions(0, 0u, 0u);
  for (int k = 0; k < count; k++) {
    const float offset = step_offset(k, int(kSteps), count, side.reach, jitter);
    const vec2 beside = round(side.direction_px * offset);
    const ivec2 hit = r.pixel + ivec2(beside);
    const Sample s = surface_at(r, side, reach, offset, beside, occluder_depth[hit.y * reach.width + hit.x]);
    const vec2 place = s.place;
    const float cot = place.y / place.x;
    const bool connected = same_surface(r, reach, s.z, last.z, offset - last.offset);
    if (kBehindOthers) take_down(interrupted, k, s, last, connected, connected, reach);
    // What rises from below the tangent plane is treated as the receiver's own surface.
    start = connected && s.above ? start : place;
    own = s.above ? (connected ? own : false) : true;
    if (s.within) {
      const float width = own ? endless : length(place - start) + reach.pixel_size * s.scale;
      const vec2 back_place = back_of(r, place, reach.thickness > 0.0 ? reach.thickness : width, reach.radius);
      const float back = back_place.y / back_place.x;
      const bool joined = connected ? last_blocks : false;
      const uint before = sectors_to(side, whole, joined ? max(cot, last_cot) : cot, shift);
      const uint behind = sectors_to(side, whole, min(back, joined ? min(cot, last_cot) : cot), shift);
      block(found, side, reach, shift, behind & ~before, sqrt(s.distance_sq));
    }
    last_blocks = s.within;
    last_cot = cot;
    last = s;
    for (bool once = kBehindOthers && int(kSteps) > kWordBits && (k + 1 & kWordBits - 1) == 0; once; once = false) {
      complete_behind(found, r, side, reach, draw, count, interrupted, k + 1);
      interrupted = Interruptions(k + 1, 0u, 0u);
    }
  }
  if (kBehindOthers) complete_behind(found, r, side, reach, draw, count, interrupted, count);
}

/// A surface of the last sample, and what is known of its run.
struct Slot {
  float z;  // kNoLastSurface: there is none
  vec2 start;
  bool own;  // the receiver's surface
  bool blocks;
  vec2 cots;  // cotangents of what the sample blocks if its back is known, else its own twice
};

float cot_of(float slope) { return slope / max(1.0 - abs(slope), kLeastAcross); }

/// The same where several are: a sample of each goes on from the surface that it is linked to.
void search_layers(inout Found found, Receiver r, Side side, Reach reach, Draw draw, int count) {
  const float whole = whole_arc(side), endless = 1e30;
  const int plane = params.view.size.x * params.view.size.y;
  Sample last = receiver_sample(r);
  Slot slots[kMostSurfaces];
  for (int j = 0; j < kSurfaces; j++)
    slots[j] = Slot(j == 0 ? r.z : kNoLastSurface, vec2(0), true, true, vec2(side.plane_cot));
  Interruptions interrupted = Interruptions(0, 0u, 0u);
  for (int k = 0; k < count; k++) {
    const float offset = step_offset(k, int(kSteps), count, side.reach, draw.jitter), gap = offset - last.offset;
    const Surfaces here = surfaces_at(r, side, reach, offset, plane);
    float last_z[kMostSurfaces];
    for (int j = 0; j < kSurfaces; j++) last_z[j] = slots[j].z;
    const int from[kMostSurfaces] = links_of(r, reach, here, last_z, gap);
    if (kBehindOthers) {
      const bool goes_on = here.at[0].z > last.z ? from[0] >= 0 : is_taken(from, 0);
      take_down(interrupted, k, here.at[0], last, same_surface(r, reach, here.at[0].z, last.z, gap), goes_on, reach);
    }
    Slot now[kMostSurfaces];
    for (int i = 0; i < kSurfaces; i++) {
      const Sample s = here.at[i];
      Slot slot = slots[0];
      for (int j = 1; j < kSurfaces; j++) {
        slot.start = from[i] == j ? slots[j].start : slot.start;
        slot.own = from[i] == j ? slots[j].own : slot.own;
        slot.blocks = from[i] == j ? slots[j].blocks : slot.blocks;
        slot.cots = from[i] == j ? slots[j].cots : slot.cots;
      }
      const bool connected = from[i] >= 0;
      slot.start = both(connected, s.above) ? slot.start : s.place;
      slot.own = s.above ? both(connected, slot.own) : true;
      const bool is_known = both(here.has_back[i], !slot.own);
      const float width = slot.own ? endless : length(s.place - slot.start) + reach.pixel_size * s.scale;
      const vec2 back_place = back_of(r, s.place, reach.thickness > 0.0 ? reach.thickness : width, reach.radius);
      const vec2 cots = is_known ? vec2(cot_of(here.solid[i].x), cot_of(here.solid[i].y)) : vec2(s.place.y / s.place.x);
      const float back = is_known ? cots.y : back_place.y / back_place.x;
      const bool blocks = both(here.exists[i], is_known ? here.solid[i].x >= here.solid[i].y : s.within);
      const bool joined = both(connected, slot.blocks);
      for (bool once = blocks; once; once = false) {
        const uint before = sectors_to(side, whole, joined ? max(cots.x, slot.cots.x) : cots.x, draw.shift);
        const uint behind = sectors_to(side, whole, min(back, joined ? min(cots.y, slot.cots.y) : cots.y), draw.shift);
        block(found, side, reach, draw.shift, behind & ~before, sqrt(s.distance_sq));
      }
      now[i] = Slot(here.exists[i] ? s.z : kNoLastSurface, slot.start, slot.own, blocks, cots);
    }
    slots = now;
    last = here.at[0];
    for (bool once = kBehindOthers && int(kSteps) > kWordBits && (k + 1 & kWordBits - 1) == 0; once; once = false) {
      complete_behind(found, r, side, reach, draw, count, interrupted, k + 1);
      interrupted = Interruptions(k + 1, 0u, 0u);
    }
  }
  if (kBehindOthers) complete_behind(found, r, side, reach, draw, count, interrupted, count);
}

/// The blocked part of a side's arc integral and, with bent normals, of bent_to(); and what of the arc completed
/// surfaces block.
vec4 search(Receiver r, Side side, Reach reach, Draw draw) {
  const float shift = draw.shift;
  const int count = min(int(kSteps), int(side.reach));
  const float whole = whole_arc(side);
  Found found = Found(0u, 0.0, 0.0, vec2(0));
  if (kSurfaces > 1)
    search_layers(found, r, side, reach, draw, count);
  else
    search_runs(found, r, side, reach, draw, count);
  for (bool once = kBeyondBorder && side.is_cut && side.reach >= 1.0; once; once = false)
    complete_beyond(found, r, side, reach, draw);
  if (kBent && kFalloff == kFalloffNone) found.bent = bent_of_sectors(side, found.bits, shift);
  const float sector = whole / float(kSectors);
  return vec4(found.blocked * sector, found.bent, found.completed * sector);
}

/// Random numbers of a side, from those of its pixel. The boundaries of the mask move by one number per slice. The
/// fraction of a sum of whole multiples of two independent numbers is even in [0, 1) and independent of either one; 7
/// and 13 are primes, so that it repeats with neither.
Draw draw_of(vec2 noise, uint slice, uint side) {
  return Draw(fract(noise.y + kGolden * float(2u * slice + side)),
              fract(noise.x * 7.0 + noise.y * 13.0 + kGolden * float(slice)));
}

#include "slices.glsl"

#include "receivers.glsl"
