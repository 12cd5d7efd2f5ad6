// How a frame is read: where its planes lie, what their values mean, and which camera saw them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

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
  // How the depth values were rounded: to multiples of a step, 0: to none; and to this part of themselves, where that
  // is more than their sample type does. See core/frame/flatness.h, and step_of().
  double depth_step = 0, depth_rounding = 0;
  bool depth_is_coarse = false;                                // either is more than a 2^14th of the median value
  double found_sky = std::numeric_limits<double>::infinity();  // raw depth at or beyond it is sky, as the pixels show
  PositionSpace position_space = PositionSpace::view;          // not automatic; world needs camera.view_from_world
  NormalSpace normal_space = NormalSpace::view;                // not automatic; world needs camera.view_from_world
  NormalEncoding normal_encoding = NormalEncoding::signed_float;  // not automatic
  bool normal_unorm = false;                                      // the values are 0.5 + 0.5 n, of any encoding
  NormalFlips flip_normal;
  // of deep samples beside a flat depth, as BehindPlane has them
  DepthKind deep_kind = DepthKind::automatic;
  double deep_scale = 1;
  bool deep_is_whole = false;
};

/// One plane of depth behind the first surface.
struct BehindPlane {
  BehindKind kind = BehindKind::surfaces;
  // how its values are read: automatic: as the frame's own depth; or planar or ray depth, times the scale
  DepthKind depth_kind = DepthKind::automatic;
  double scale = 1;      // scene units per unit; with planar and ray
  bool is_half = false;  // the values were rounded to half floats
  bool is_whole = true;  // with surfaces: a pixel without one has none; deep samples often end at the first opaque one
};

/// Whether planes together show all that is hidden: a pixel that has fewer surfaces than planes has no more of them.
bool list_all(std::span<const BehindPlane> planes);

/// What the planes of a matte hold.
enum class MatteKind {
  coverage,  // how much of each pixel it takes, 0 to 1
  objects,   // the object of each pixel
  ranked,    // of Cryptomatte: an object and its coverage, and again for each further rank
};
/// How the planes of RawPlane::matte are read, or those of RawPlane::occluders.
struct MatteReading {
  MatteKind kind = MatteKind::coverage;
  std::vector<std::uint32_t> objects = {};  // those that are meant, by the bits of their floats
  double outside = 1;                       // the AO where it takes nothing, 0 to 1
  bool ignores = false;                     // of occluders: what it takes is none; else all others are none
};

/// How a light of the planes of RawPlane::indirect is read: see composite.comp.
struct AmbientReading {
  double weight = 1;
  int color = -1;  // of those in RawPlane::diffuse_color, which multiplies it; below 0: none
};

/// The meaning of one frame, with its windows and its camera.
struct Reading : Meaning {
  Window data;  // of the planes
  Window display;
  // px for each of the picture that is written, in x and in y: what is written is filtered to those
  int supersampling = 1;
  double pixel_aspect = 1;          // width / height of a pixel
  Camera camera;                    // for the display window
  double depth_scale = 1;           // scene units per unit of the depth values
  double sky = 1e9;                 // depth at or beyond it is sky, in the file's units
  bool depth_is_half = false;       // the depth values were rounded to half floats
  std::vector<BehindPlane> behind;  // of the planes of RawPlane::behind, one for each
  MatteReading matte, occluders;
  std::vector<AmbientReading> ambient;  // the lights that AO may dim; none: it dims the whole beauty
};

/// The part of the picture that is written for a part of the frame: see core/base/windows.h.
Window picture_of(const Reading& reading, const Window& part);

/// Takes over the meaning of another frame of the sequence. The clip planes stay this frame's own, as its own camera
/// has them.
void read_like(Reading& reading, const Meaning& settled);

/// The largest finite half float.
constexpr double kLargestHalf = 65504;

/// The map to planar depth. Half floats end at 65504, which stands for all that is beyond: distances of that size are
/// sky. Fails as depth_map() does.
DepthMap depth_map_of(const Reading& reading);

/// The map of a plane behind the first surface to planar depth, of a thickness to a length. Where the frame's own depth
/// is neither planar nor along the ray a thickness is a planar length in the file's units, and so is what lies behind
/// positions. Fails as depth_map() does.
DepthMap behind_map_of(const Reading& reading, const BehindPlane& plane);

/// How far any depth may be from its surface's, of the first surface and of those behind it.
DepthPrecision hidden_precision_of(const Reading& reading);

/// Whether depth values are too coarse for the normals of depth to be exact.
bool has_coarse_depth(const Reading& reading);

/// How far the planar depth that the map gives may be from the surface's.
DepthPrecision depth_precision_of(const Reading& reading);

}  // namespace alcove
