// The findings of one walk over the pixels of a frame, as plain numbers, and the detectors that judge them: a table of
// the faults that pixels may show.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/frame/reading.h"

namespace alcove {

/// Borders between neighbouring rows, or columns, of a picture, across places where depth slowly changes.
struct Repeats {
  int all = 0;
  int borders = 0;  // with enough such places
  int equal = 0;    // of these: on both sides of nearly all places depth is exactly the same
  int steps = 0;    // depth changes at nearly all places
};

/// Outlines: places where the surface in front ends, along rows or columns.
struct Outlines {
  std::size_t count = 0;
  std::size_t sharp = 0;  // that nearly all of the change lies between two pixels
  // Outlines of one step, and such with one pixel between the surfaces: both together, and the latter.
  std::size_t steps = 0, blended = 0;
};

/// Pixels without a surface within surfaces.
struct Holes {
  std::size_t surfaces = 0;       // pixels with one
  std::size_t between = 0;        // without one, up to four in a row, between two surfaces of about one depth
  std::size_t within_planes = 0;  // of these: between two pieces of one plane
  int cells = 0, pierced = 0;     // of 8 x 8 in the picture: full of surfaces, and with holes among them
};

/// Second differences of 1/z from pixel to pixel, relative to it.
struct Unevenness {
  std::size_t count = 0;
  double tenth = 0;        // nine of ten are larger
  double alternating = 0;  // the share of neighbouring ones with opposite signs; noise has 0.73
};

/// A range that began again at 0.
struct Wrapping {
  std::size_t drops = 0;  // by nearly the largest value, between pixels of smooth surfaces
  std::size_t whole = 0;  // of these: by one number, if both sides are one surface
  double period = 0;      // that range, in the file's units
  double most = 0;        // the largest value
};

/// Distances in half floats against the largest of these.
struct Overflow {
  double beyond = 0;        // share of all pixels that are infinite or it
  bool is_reached = false;  // finite ones come near it
};

/// Normals beside outlines.
struct NormalOutlines {
  std::size_t count = 0;    // outlines between two planes of different normals
  std::size_t aligned = 0;  // the normals change where depth does
  double beside = 0;        // px, the median distance of their change from that of depth
};

/// A rectangle without surfaces, in pixels of the frame's data window.
struct EmptyRectangle {
  int left = 0, top = 0, right = 0, bottom = 0;  // right and bottom: one further
  double value = 0;                              // of all its pixels
  bool is_unlike_sky = false;                    // elsewhere pixels without a surface have another value
  bool is_on_grid = false;                       // its sides lie on the grid of tiles
};

/// The rows, or columns, along a border that have no surface.
struct BorderRows {
  int empty = 0;       // how many have none, and one value
  double covered = 0;  // the part of the next one, within the picture between the borders, that has surfaces
};
/// Those of the upper, lower, left and right border.
using Borders = std::array<BorderRows, 4>;

/// Depth with one value that many pixels have.
struct Plateau {
  double value = 0;
  double share = 0;        // of all surfaces
  std::size_t places = 0;  // within it, with normals
  double tilt = 0;         // degrees, of their mean normal from that of a wall from the front
  double frontal = 0;      // the share of normals within 4 degrees of it
};

/// The input of all detectors. Findings that were not looked for are empty.
struct Findings {
  std::string depth_channel{};
  DepthKind depth_kind = DepthKind::planar;
  bool has_half_type = false;               // of the depth's samples
  std::size_t cut_pixels = 0;               // of ramps, which were cut before the rest was looked at: see cut_ramps()
  std::vector<std::string> other_depths{};  // channels of the same file that are depth by their names

  Grain grain{};
  double above_shift = 0;  // of disparity: how far that median is above the shift
  Curve curve{};
  bool begins_behind = false;  // values count from a plane behind most surfaces, and are below 0 before it
  double said_offset = 0;      // in the file's units: by the options depth is in proportion to the value and this

  std::size_t pixels = 0, surfaces = 0;  // that were looked at
  std::array<Repeats, 2> repeats{};      // of columns, of rows
  std::array<Outlines, 2> outlines{};    // along rows, along columns
  std::array<Holes, 2> holes{};          // in rows, in columns
  Unevenness unevenness{};
  Wrapping wrapping{};
  Overflow overflow{};
  std::optional<double> jitter{};
  std::optional<Borders> borders{};  // none: of a part of a frame
  std::optional<EmptyRectangle> rectangle{};
  std::optional<Plateau> plateau{};
  NormalOutlines normals{};
};

// Detectors.

/// A row of the table. docs/troubleshooting.md lists what each looks at, when it speaks, and what mends it.
struct Detector {
  NoteCode code;
  // The sentence of its note, where it speaks.
  std::optional<std::string> (*sentence)(const Findings&);
};

/// The sentence on a frame in which nothing is a surface.
std::string no_surfaces_text(const std::string& depth_channel);

/// The number that depth must be added to be in proportion to distances, as it is read.
double said_offset(const Reading& reading);
/// Whether the curve of the values speaks against the kind of depth that is read.
bool speaks_against(const Curve& curve, const Reading& reading);

/// The table. A code may have several rows.
std::span<const Detector> detectors();

/// The notes of all detectors on a frame.
Notes detected(const Findings& findings);

}  // namespace alcove
