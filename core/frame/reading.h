// The reading of a frame: the windows of its planes, the meaning of their values, and its camera; evidence for it in
// the pixels. One map leads from any kind of depth to planar depth, the same on the host and in prepare.comp.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/settings.h"
#include "core/frame/camera/camera.h"

namespace alcove {

/// Raw value -> planar depth in scene units, in the forms of kernels/geometry/geometry.h.
struct DepthMap {
  uint form = 0;
  bool along_ray = false;  // the form gives the distance to the eye
  double origin = 0, base = 0, slope = 1;
  double sky_below = 0, sky_above = std::numeric_limits<double>::infinity();  // raw depth at or beyond them is sky
  double sky_depth = 1e9;                                                     // scene units
  std::array<double, 3> axis{};                                               // of positions
  // of positions: from their origin to the eye, scene units
  double eye_distance = 0;
  bool operator==(const DepthMap&) const = default;
};

/// The largest error of a planar depth z: at[0] + at[1] z + at[2] z^2, scene units.
struct DepthPrecision {
  std::array<double, 3> at{};

  double at_depth(double z) const { return at[0] + z * (at[1] + z * at[2]); }
  bool operator==(const DepthPrecision&) const = default;
};

/// With d the value and n, f the planes:
/// planar z = d; ray: |position| = d; inverse z = 1/d; normalized z = n + d (f - n); log z = ((1 + C f)^d - 1) / C;
/// disparity d = a / z + b; device 1/z = 1/n - d (1/n - 1/f), of an orthographic camera z = n + d (f - n); position z =
/// -(view z). `reversed` puts 1 - d for d, a device range of -1 to 1 (d + 1) / 2. Device, normalized and log depth is a
/// surface only if it is strictly between 0 and 1; normalized depth may go on beyond its planes. Disparity is one only
/// if it is above b, and a is 1 where nothing tells it. Fails with ErrorKind::usage where the kind needs a plane, a
/// world matrix or a perspective that is not there.
DepthMap depth_map(DepthKind kind, const DepthRange& range, PositionSpace space, const Camera& camera, double scale,
                   double sky);

/// The numbers of disparity d = scale / z + shift; none: nothing tells.
struct Disparity {
  std::optional<double> scale, shift;
};
/// Gives scale and shift by near and far plane, if two of the four numbers are given: d is 1 at the near plane and 0 at
/// the far plane. Fails with ErrorKind::usage where the scale would not be above 0.
Disparity disparity_of(const DepthRange& range);

/// Whether values lie between a near and a far plane, and may be stored as integers.
inline bool is_between_planes(DepthKind kind) {
  return kind == DepthKind::device || kind == DepthKind::normalized || kind == DepthKind::log;
}
/// Whether the values are distances: planar, or along the ray.
inline bool is_distance(DepthKind kind) { return kind == DepthKind::planar || kind == DepthKind::ray; }

/// Whether every raw value plainly says that there is no surface: none is one, or has to be repaired to be none. Of
/// positions: x, y and z are 0.
bool is_all_sky(const DepthMap& map, std::span<const float> raw);

/// Planar depth of a raw value, or of a position; infinite for sky. `ray_length`: the length of the pixel's ray at unit
/// depth.
double planar_depth(const DepthMap& map, const std::array<double, 3>& raw, double ray_length);
/// The raw value of a planar depth; not of positions.
double raw_of(const DepthMap& map, double planar, double ray_length);

/// Half a step of floats, and of half floats, as a part of the raw value.
constexpr double kFloatPrecision = 0x1p-24, kHalfPrecision = 0x1p-11;

/// The step of device, normalized or log depth that was rounded to 16 or 24 bits; 0: it was not rounded. Only small
/// values show a step of 24 bits, and only there it matters: larger floats are as coarse themselves.
double step_of(std::span<const float> raw);

/// The precision of the planar depth from raw values that are known to this part of themselves, and rounded to
/// multiples of `step`. It is never less than 2^-16 of the depth, twice the loss by renderers' own arithmetic where
/// surfaces 1000 units across are seen from a few units away (measured: 8e-6).
DepthPrecision depth_precision(const DepthMap& map, double raw_precision, double step = 0);

// Evidence in the pixels, and the choices made by it.

/// The coarseness of stored values, of any sample type.
struct Grain {
  double median = 0;  // of the values' distances from 0; where there is a step, each of them counts once
  double step = 0;    // from one value to the next at the median; 0: as fine as floats are, or too few values to tell
  bool is_coarse = false;  // the step is more than a 2^14th of the median
  bool is_fixed = false;   // the step is the same for small and large values
  bool is_half = false;    // the steps are a half float's, or a scaled half float's
};
/// A way to read depth and how well the frame's flat surfaces agree with it.
struct DepthScore {
  DepthKind kind;
  // The share of the smooth blocks that are flat by this kind and by no other.
  double straight = 0;
};
/// The curve from places in the picture to depth values, as measured on planes at an angle. If L is affine over a
/// plane's picture and v = f(L) is the value, then v'' / v'^2 is a function of v alone, the same for all planes: 2 / (v
/// + c) for planar depth that counts from a plane at distance c.
struct Curve {
  std::size_t planes = 0;  // blocks of the picture that show one
  // v'^2 / v'' = slope v + offset: 1/2 and 0 of distances, 0 of logarithms, p / (1 + p) of distances to the power of p
  double slope = 0.5, offset = 0;
  double median = 0;     // value
  double spread = 0;     // of the planes' own numbers about that line, relative to the median value
  bool is_wide = false;  // the values are different enough to tell the slope
};
/// A choice that neither settings nor camera make.
struct Guess {
  std::string what, chosen, why, option;  // the option makes the choice
};

/// Facts that the pixels of a frame show.
struct Evidence {
  bool tells = true;                     // false: the pixels left a question open
  Grain grain;                           // of the depth's values
  std::vector<DepthScore> depth_scores;  // of depth that is no position
  Curve curve;                           // of the same
  // of the surfaces, scene units; none until the frame is settled, and where all is sky
  std::optional<double> median_depth;
  std::optional<NormalSpace> space_by_shift;  // of normals that give the shift of a coarse disparity
  std::vector<Guess> guesses;
};

// The whole reading.

/// Whether normals have two components of a vector: nothing in them tells whether the third is above or below 0, and
/// only in view space is it above, since all that is seen faces the camera.
inline bool lacks_sign(std::size_t components, NormalEncoding encoding) {
  return components == 2 && encoding != NormalEncoding::octahedral && encoding != NormalEncoding::spheremap;
}

/// The meaning of the values, as options and headers say or as the pixels settle it. It is the same for all frames of a
/// sequence.
struct Meaning {
  DepthKind depth_kind = DepthKind::planar;  // not automatic
  DepthRange depth_range;
  // The rounding of depth values: to multiples of a step (0: to none), and to a part of themselves, if that is more
  // than their sample type rounds. See Grain and step_of().
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

/// A plane of depth behind the first surface.
struct BehindPlane {
  BehindKind kind = BehindKind::surfaces;
  // of its values: automatic, as the frame's own depth is read; or planar or ray, times the scale
  DepthKind depth_kind = DepthKind::automatic;
  double scale = 1;      // scene units per unit; with planar and ray
  bool is_half = false;  // the values were rounded to half floats
  bool is_whole = true;  // with surfaces: a pixel without one has none; deep samples often end at the first opaque one
};

/// Whether planes together show all that is hidden: a pixel that has fewer surfaces than planes has no more of them.
bool list_all(std::span<const BehindPlane> planes);

/// The content of a matte's planes.
enum class MatteKind {
  coverage,  // the part of each pixel that is selected, 0 to 1
  objects,   // the object of each pixel
  ranked,    // of Cryptomatte: an object and its coverage, and again for each further rank
};
/// The reading of the planes of RawPlane::matte or RawPlane::occluders.
struct MatteReading {
  MatteKind kind = MatteKind::coverage;
  std::vector<std::uint32_t> objects = {};  // that are selected, by the bits of their floats
  double outside = 1;                       // the AO where nothing is selected, 0 to 1
  bool ignores = false;                     // of occluders: the selected ones are none; else all others are none
  bool operator==(const MatteReading&) const = default;
};

/// The reading of a light of the planes of RawPlane::indirect: see composite.comp.
struct AmbientReading {
  std::optional<double> weight = 1;  // how much of it AO dims; none: a shadow alone does
  int color = -1;                    // index into RawPlane::diffuse_color of its factor; below 0: none
  std::string shadow = {};           // the light of --lights whose shadow dims it; empty: none
  bool operator==(const AmbientReading&) const = default;
};
/// Whether AO dims the whole beauty, since none of these says what else.
bool dims_beauty(const std::vector<AmbientReading>& lights);

/// The meaning of one frame, with its windows and its camera.
struct Reading : Meaning {
  Window data;  // of the planes
  Window display;
  // px, in x and in y, per pixel of the picture that is written; results are filtered down to it
  int supersampling = 1;
  double pixel_aspect = 1;          // width / height of a pixel
  Camera camera;                    // for the display window
  double depth_scale = 1;           // scene units per unit of the depth values
  double sky = 1e9;                 // depth at or beyond it is sky, in the file's units
  bool depth_is_half = false;       // the depth values were rounded to half floats
  bool cuts_ramps = false;          // pixels of blurred outlines go to the surfaces on both sides: see cut_ramps()
  std::vector<BehindPlane> behind;  // of the planes of RawPlane::behind, one for each
  MatteReading matte, occluders;
  std::vector<AmbientReading> ambient;  // the lights that AO and shadows may dim
};

/// Gives the same reading for a part of the frame.
inline Reading over(Reading reading, const Window& window) {
  reading.data = window;
  return reading;
}
/// Gives the projection over a part of the frame.
inline View view_of(const Reading& reading, const Window& window) {
  return view_of(reading.camera, window, reading.display);
}

/// The part of the picture that is written for a part of the frame: see core/base/image.h.
inline Window picture_of(const Reading& reading, const Window& part) {
  return reduced(part, reading.display, reading.supersampling);
}

/// The largest finite half float.
constexpr double kLargestHalf = 65504;

/// The map to planar depth. Half floats end at 65504, which stands for all that is beyond: distances of that size are
/// sky. Fails as depth_map() does.
DepthMap depth_map_of(const Reading& reading);

/// Gives the map of a plane behind the first surface to planar depth, of a thickness to a length. If the frame's own
/// depth is neither planar nor along the ray, a thickness is a planar length in the file's units; so are planes behind
/// positions. Fails as depth_map() does.
DepthMap behind_map_of(const Reading& reading, const BehindPlane& plane);

/// The largest error of any depth, of the first surface and of surfaces behind it.
DepthPrecision hidden_precision_of(const Reading& reading);

/// Whether depth values are too coarse for the normals of depth to be exact.
inline bool has_coarse_depth(const Reading& reading) { return reading.depth_is_half || reading.depth_is_coarse; }

/// The largest error of the planar depth that the map gives.
DepthPrecision depth_precision_of(const Reading& reading);

/// Depth and normals of one frame, rows from the top, over the data window.
struct HostFrame : Reading {
  // of depth_kind, positions: planes x, y, z; sky: at or beyond `sky`, or 0, infinite, NaN
  std::vector<float> depth;
  // planes x, y, z (or two, see kernels/geometry/geometry.h) in normal_space; empty: reconstructed from depth
  std::vector<float> normal;
  // planes of depth behind the first surface, in any order, as Reading::behind says; empty: none is known
  std::vector<float> behind_depth;
  int frame = 0;
};

}  // namespace alcove
