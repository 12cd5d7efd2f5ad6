// The walk over the pixels of a frame: rows and columns all over the picture, in parallel; and the numbers of each.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/frame/pixels/findings.h"
#include "core/frame/reading.h"

namespace alcove {

/// The planes that are walked over, as in the file, over a window, and how they are read.
struct WalkedPlanes {
  const Reading& reading;  // over that window
  Window frame;            // all pixels that the files hold
  std::span<const float> depth, normal;
  bool has_read_normals = false;  // the reading of the normals is settled, too
};

/// Samples rows and columns, and fills in their findings. The result does not depend on the number of threads.
void walk(const WalkedPlanes& planes, Findings& findings);

// Numbers of one row or column, as traces of the way in which the picture was made.

/// A row or a column.
struct Line {
  std::vector<float> raw;       // depth as in the file
  std::vector<double> inverse;  // 1/z; 0 where there is no surface
  // the normals of the picture, as in the file, and the line's pixels among them; empty: there are none
  std::span<const float> normals;
  std::size_t pixels = 0, first = 0, stride = 1;

  std::size_t size() const { return raw.size(); }
  bool is_surface(std::size_t i) const { return inverse[i] > 0; }
};

/// Counts, for each border between a pixel and the one before it, the sampled places where depth slowly changes, and
/// the places among them where it is the same on both sides.
struct BorderCounts {
  std::vector<std::uint32_t> places, equal;
};
void count_repeats(const Line& line, BorderCounts& counts);
Repeats repeats_of(const BorderCounts& counts, std::size_t lines);

/// A stretch of pixels along which depth changes in one direction, by steps of at least a tenth of its largest one.
struct Ramp {
  std::size_t first, last;  // pixels
  bool is_sharp = false;    // nearly all of the change is one step
};
/// The ramps across outlines: they change 1/z by much over a few pixels, and other surfaces lie before and behind. In
/// order; the line read backwards has the same ones.
std::vector<Ramp> ramps_in(std::span<const double> inverse, std::span<const float> raw);

void count_outlines(const Line& line, Outlines& outlines);

/// Marks what lies in each eighth of the line.
struct HoleCounts {
  std::array<std::size_t, 8> surfaces{}, holes{};
};
HoleCounts count_holes(const Line& line, Holes& holes);

/// Adds some of the line's second differences; counts neighbours, and neighbours with opposite signs.
struct BendSample {
  std::vector<double> sizes;
  std::size_t neighbours = 0, opposite = 0;
};
void sample_bends(const Line& line, BendSample& sample);

/// Adds the numbers by which depth drops from one smooth surface to another, where that is much of the range.
struct DropSample {
  double most = 0;  // the largest value of the frame
  std::vector<double> drops;
};
void sample_drops(const Line& line, DropSample& sample);
Wrapping wrapping_of(DropSample sample);

/// Adds the distances, in px, from outlines to the places where the normals change.
void sample_normal_shifts(const Line& line, std::vector<int>& shifts);

/// A stretch of a line without surfaces, all of one value.
struct EmptyRun {
  std::size_t first, end;
  float value;
};
std::vector<EmptyRun> empty_runs(const Line& line);

// Parts of a picture without surfaces.

/// The rows and columns along the borders of a whole frame that have no surface.
Borders borders_of(std::span<const float> depth, const Window& window, const DepthMap& map);

/// The stretches of a row, and its place.
struct PlacedRuns {
  int row;
  std::vector<EmptyRun> runs;
};

/// The largest rectangle without surfaces that has one value and does not reach from border to border. `rows` are some
/// rows of the window, which may be a part of the frame: a rectangle that reaches beyond the part does not count.
/// `is_sky_0`: 0 means infinitely far, as in the sky elsewhere.
std::optional<EmptyRectangle> empty_rectangle(std::span<const float> depth, const Window& window, const Window& frame,
                                              std::span<const PlacedRuns> rows, bool is_sky_0 = false);

}  // namespace alcove
