// How a frame is read: where its planes lie, what their values mean, and which camera saw them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/image.h"
#include "core/base/settings.h"
#include "core/frame/camera.h"
#include "core/frame/depth.h"

namespace alcove {

/// What the values mean, as options and headers say or as the pixels settle it. It is the same for all frames of a
/// sequence.
struct Meaning {
  DepthKind depth_kind = DepthKind::planar;  // not automatic
  DepthRange depth_range;
  double depth_step = 0;                                          // see step_of()
  PositionSpace position_space = PositionSpace::view;             // not automatic; world needs camera.view_from_world
  NormalSpace normal_space = NormalSpace::view;                   // not automatic; world needs camera.view_from_world
  NormalEncoding normal_encoding = NormalEncoding::signed_float;  // not automatic
  bool normal_unorm = false;                                      // the values are 0.5 + 0.5 n, of any encoding
  NormalFlips flip_normal;
};

/// The meaning of one frame, with its windows and its camera.
struct Reading : Meaning {
  Window data;  // of the planes
  Window display;
  double pixel_aspect = 1;     // width / height of a pixel
  Camera camera;               // for the display window
  double depth_scale = 1;      // scene units per unit of the depth values
  double sky = 1e9;            // depth at or beyond it is sky, in the file's units
  bool depth_is_half = false;  // the depth values were rounded to half floats
};

/// Takes over the meaning of another frame of the sequence. The clip planes stay this frame's own, as its own camera
/// has them.
void read_like(Reading& reading, const Meaning& settled);

/// The map to planar depth. Half floats end at 65504, which stands for all that is beyond: distances of that size are
/// sky. Fails as depth_map() does.
DepthMap depth_map_of(const Reading& reading);

/// How far the planar depth that the map gives may be from the surface's.
DepthPrecision depth_precision_of(const Reading& reading);

}  // namespace alcove
