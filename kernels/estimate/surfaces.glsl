// The surfaces behind one another at the pixels of a side, and which of them go on from one sample to the next.
// SPDX-License-Identifier: BSD-3-Clause
//
// A surface goes on from any of the last sample's: a floor is the first one, then the third behind the front and the
// back of a column, then the first again. One that closes a solid is the exact back of the one before it, and by itself
// as thin as a sheet.
//
// The kernel has declared its buffers `occluder_depth` and `hidden`, and how many surfaces a pixel has at most,
// kSurfaces. To be included after pieces.glsl.

#include "kernels/hidden/hidden.h"

/// Arrays have as many elements; those from kSurfaces on are never used.
const int kMostSurfaces = int(kMostHidden) + 1;

/// Depths of surfaces that do not exist, now and at the last sample: neither goes on from the other.
const float kNoSurface = 1e30, kNoLastSurface = -1e30;

/// The surfaces at a sample, nearer first.
struct Surfaces {
  Sample at[kMostSurfaces];
  bool exists[kMostSurfaces];
  bool has_back[kMostSurfaces];  // it is known how far it is solid
  vec2 solid[kMostSurfaces];     // of those the slope_of() its front and of its back; (-1, 1): it does not block
};

/// The surfaces at a pixel of a side. Of hidden ones only those near the sphere count: others say nothing. plane: of
/// `hidden`, in pixels.
Surfaces surfaces_at(Receiver r, Side side, Reach reach, float offset, int plane) {
  const vec2 beside = round(side.direction_px * offset);
  const ivec2 hit = r.pixel + ivec2(beside);
  const int index = hit.y * reach.width + hit.x;
  Surfaces found;
  bool closes[kMostSurfaces];
  for (int i = 0; i < kSurfaces; i++) {
    const float z = i == 0 ? occluder_depth[index] : hidden[index + (i - 1) * plane];
    const Sample s = sample_of(r, side, reach, offset, beside, abs(z));
    const bool is_near = s.distance_sq < reach.front_sq;
    found.at[i] = s;
    found.exists[i] = i == 0 ? true : both(s.z < kSkyDepth, is_near);
    closes[i] = z < 0.0;
  }
  for (int i = 0; i < kSurfaces; i++) {
    const Sample s = found.at[i];
    const bool is_solid = i + 1 < kSurfaces ? closes[min(i + 1, kMostSurfaces - 1)] : false;
    const Sample back = found.at[min(i + 1, kSurfaces - 1)];
    found.has_back[i] = is_solid ? true : closes[i];
    const float thickness = is_solid ? length(back.place - s.place) : 0.0;
    found.solid[i] = s.above ? depths_of(r, s.place, thickness, reach.radius_sq) : vec2(-1, 1);
  }
  return found;
}

/// The depth of the i-th surface of a pixel of a side; of a hidden one only near the sphere, as in surfaces_at().
float depth_at(Receiver r, Side side, Reach reach, ivec2 pixel, int i, int plane) {
  const int index = pixel.y * reach.width + pixel.x;
  if (i == 0) return occluder_depth[index];
  const float z = abs(hidden[index + (i - 1) * plane]);
  const vec2 place = place_of(r, side, vec2(pixel - r.pixel), z, r.perspective ? z : 1.0);
  return dot(place, place) < reach.front_sq ? z : kNoSurface;
}

/// For each surface the one at the last sample from which it goes on, the nearest in depth of those that are one
/// surface with it by some surface of the pixel in the middle, see is_through(); -1: it begins.
int[kMostSurfaces] links_of(Receiver r, Reach reach, Surfaces found, float middle_z[kMostSurfaces],
                            float last_z[kMostSurfaces], float gap) {
  int from[kMostSurfaces];
  float left[kMostSurfaces];
  for (int j = 0; j < kSurfaces; j++) left[j] = last_z[j];
  for (int i = 0; i < kSurfaces; i++) {
    const float z = found.exists[i] ? found.at[i].z : kNoSurface;
    float least = kNoSurface;
    from[i] = -1;
    for (int j = 0; j < kSurfaces; j++) {
      bool through = false;
      for (int m = 0; m < kSurfaces; m++)
        through = is_through(r, reach, z, middle_z[m], last_z[j], gap) ? true : through;
      const float apart = abs(z - left[j]);
      const bool goes_on = both(through, apart < least);
      least = goes_on ? apart : least;
      from[i] = goes_on ? j : from[i];
    }
    for (int j = 0; j < kSurfaces; j++) left[j] = from[i] == j ? kNoLastSurface : left[j];
  }
  return from;
}

/// Whether any surface goes on from the j-th of the last sample.
bool is_taken(int from[kMostSurfaces], int j) {
  bool taken = false;
  for (int i = 0; i < kSurfaces; i++) taken = from[i] == j ? true : taken;
  return taken;
}

/// Whether a listed tile is this dispatch's: one takes the tiles where hidden surfaces may count, another one the rest.
bool is_mine(uint place) { return ((place & kTileLayered) != 0u) == (kSurfaces > 1); }
