// The table of detectors.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/findings.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/frame/reading.h"

namespace alcove {
namespace {

using Sentence = std::optional<std::string>;

double percent(double part, double all) { return all > 0 ? 100 * part / all : 0; }

/// Where the same file has another depth, it may be the better one.
std::string hint_at_others(const Findings& f) {
  if (f.other_depths.empty()) return "";
  return fmt::format("; the file also holds {}: --depth-channel {} takes it", list_of(f.other_depths),
                     f.other_depths[0]);
}

// Depth that does not show surfaces.

Sentence no_surfaces(const Findings& f) {
  if (f.pixels == 0 || f.surfaces > 0) return std::nullopt;
  return no_surfaces_text(f.depth_channel);
}

/// Holes all over the surfaces: gaps between things gather in few places.
bool are_pierced(const Holes& h) {
  constexpr double kMostGaps = 0.25, kMostWithin = 0.02;  // of the surfaces
  const auto surfaces = double(h.surfaces + h.between);
  const bool are_many = double(h.between) > kMostGaps * surfaces || double(h.within_planes) > kMostWithin * surfaces;
  return are_many && 2 * h.pierced > h.cells;
}
bool has_holes(const Findings& f) { return std::ranges::any_of(f.holes, are_pierced); }

Sentence holes_in_depth(const Findings& f) {
  if (!has_holes(f)) return std::nullopt;
  const Holes& h = are_pierced(f.holes[0]) ? f.holes[0] : f.holes[1];
  return fmt::format(
      "{:.0f} % of the pixels along {} are holes without a surface, scattered over surfaces of one depth: checkerboard "
      "rendering, one field of an interlaced picture, or missing values of a sensor; they count as sky, so that AO is "
      "too light: fill them first",
      percent(double(h.between), double(h.surfaces + h.between)), &h == &f.holes[0] ? "rows" : "columns");
}

/// How many times a picture was enlarged along an axis by repeating pixels; 1: it was not.
double enlargement(const Repeats& r) {
  constexpr double kLeastEqual = 0.05, kOrderly = 0.9;  // of the borders
  constexpr int kLeastBorders = 24;
  constexpr double kLeastLooked = 0.4;  // of all borders
  if (r.borders < kLeastBorders || r.borders < kLeastLooked * r.all || r.steps == 0 ||
      r.equal < kLeastEqual * r.borders)
    return 1;
  return r.equal + r.steps > kOrderly * r.borders ? double(r.equal + r.steps) / r.steps : 1;
}

Sentence enlarged_depth(const Findings& f) {
  const double across = enlargement(f.repeats[0]), down = enlargement(f.repeats[1]);
  if (std::max(across, down) == 1) return std::nullopt;
  return fmt::format(
      "depth was enlarged {:.2g} times across and {:.2g} times down by repeating pixels: neighbouring rows or columns "
      "are equal all over the picture, and AO shows the stairs; give the depth in its own, lower resolution, or render "
      "it at the full size",
      across, down);
}

std::string or_cut(const Findings& f) {
  return f.cut_pixels ? fmt::format("; {} pixels of ramps were cut already", f.cut_pixels)
                      : ", or --set ramps=cut gives such pixels to the surfaces on both sides";
}

/// Measured on six rendered scenes that were blurred by 1 to 3 px.
Sentence cut_ramps_text(const Findings& f) {
  if (f.cut_pixels == 0) return std::nullopt;
  return fmt::format(
      "{} pixels lay on ramps across outlines, and were given to the surfaces on both sides: their outlines are "
      "estimates, and AO of blurred scenes was off by .05 to .2 (RMS) after it, of foliage by .35",
      f.cut_pixels);
}

Sentence smoothed_depth(const Findings& f) {
  constexpr std::size_t kLeast = 60;  // outlines of one direction
  constexpr double kMostSharp = 0.1;  // of them
  const auto is_soft = [](const Outlines& o) {
    return o.count >= kLeast && double(o.sharp) < kMostSharp * double(o.count);
  };
  if (!std::ranges::any_of(f.outlines, is_soft)) return cut_ramps_text(f);
  const Outlines& o = is_soft(f.outlines[0]) ? f.outlines[0] : f.outlines[1];
  return fmt::format(
      "{:.0f} % of the outlines are ramps over several pixels: depth was blurred, interpolated or "
      "filtered, and AO shows seams there (off by .07 to .4 RMS in blurred scenes); render it without filtering, one "
      "sample at each pixel's centre{}{}",
      percent(double(o.count - o.sharp), double(o.count)), or_cut(f), hint_at_others(f));
}

Sentence antialiased_depth(const Findings& f) {
  constexpr double kMostBlended = 0.3;  // of the edges; thin things give some by themselves
  constexpr std::size_t kLeastEdges = 100;
  const std::size_t steps = f.outlines[0].steps + f.outlines[1].steps;
  const std::size_t blended = f.outlines[0].blended + f.outlines[1].blended;
  if (steps < kLeastEdges || double(blended) <= kMostBlended * double(steps)) return std::nullopt;
  return fmt::format(
      "{:.0f} % of the depth's edges have a pixel in between: the depth is anti-aliased, and AO shows "
      "seams there; render it without filtering{}{}",
      percent(double(blended), double(steps)), or_cut(f), hint_at_others(f));
}

Sentence noisy_depth(const Findings& f) {
  constexpr double kLeast = 3e-4;        // a tenth of the second differences of noise of 0.1 % is below this
  constexpr double kAlternating = 0.62;  // noise has 0.73, surfaces have few
  constexpr std::size_t kLeastCount = 500;
  const Unevenness& u = f.unevenness;
  if (u.count < kLeastCount || u.tenth < kLeast || u.alternating < kAlternating) return std::nullopt;
  // A tenth of the second differences of independent noise are below 0.31 of its standard deviation.
  return fmt::format(
      "depth is noisy by about {:.2g} % all over the picture, no surface is smooth, and AO shows the noise: render "
      "without noise, or denoise depth before",
      100 * u.tenth / 0.31);
}

Sentence jittered_depth(const Findings& f) {
  if (!f.jitter) return std::nullopt;
  return fmt::format(
      "flat surfaces are not flat: their depth is off by {:.2f} of its step from pixel to pixel, as if sampled at "
      "random places within the pixels, and AO shows grain; render depth at the pixels' centres, without a filter",
      *f.jitter);
}

/// The error of AO by steps that are such a part of the value above a disparity's shift. Measured on six rendered
/// scenes with 8 bits and half floats: a third of it to three times it.
std::string ao_of_steps(double step) {
  constexpr double kOfRadius = 0.1;  // the radius, as a part of the median depth
  constexpr double kAoOfSteps = 0.75;
  return fmt::format(", so that with --radius 10% it is off by about {:.1g} (RMS)", kAoOfSteps * step / kOfRadius);
}

Sentence half_depth(const Findings& f) {
  if (!(f.has_half_type || f.grain.is_coarse) || f.grain.median == 0) return std::nullopt;
  const double step = f.grain.is_coarse ? f.grain.step : std::exp2(std::floor(std::log2(f.grain.median)) - 10);
  const std::string error = f.above_shift > 0 ? ao_of_steps(step / f.above_shift) : "";
  return fmt::format(
      "{} {}: at its median {:.4g} it changes in steps of {:.2g}, which AO shows as bands{}; {}{}", f.depth_channel,
      f.has_half_type   ? "is stored as half float"
      : f.grain.is_half ? "holds the values of half floats"
                        : "was rounded",
      f.grain.median, step, error,
      f.has_half_type ? "write it as float" : "write it as float, without rounding it before", hint_at_others(f));
}

// Parts of the picture.

/// Bars above and below a picture, or on both its sides, that are as wide: a sky is on one side alone. Between them the
/// picture reaches both other borders; a thing before an empty background does not.
Sentence letterbox_bars(const Findings& f) {
  constexpr double kCovered = 0.5;
  if (!f.borders || has_holes(f)) return std::nullopt;
  for (const std::size_t side : {0U, 2U}) {
    const BorderRows &first = (*f.borders)[side], &last = (*f.borders)[side + 1];
    const std::size_t across = 2 - side;
    if (first.empty == 0 || last.empty == 0 || std::abs(first.empty - last.empty) > 1) continue;
    if (std::min(first.covered, last.covered) < kCovered) continue;
    if ((*f.borders)[across].empty > 0 || (*f.borders)[across + 1].empty > 0) continue;
    return fmt::format(
        "the first {} and the last {} {} are empty: they look like bars around the picture, and count "
        "as sky, so that AO next to them is too light; crop the data window of the file to the "
        "picture between them, and keep its display window",
        first.empty, last.empty, side == 2 ? "columns" : "rows");
  }
  return std::nullopt;
}

Sentence part_of_picture(const Findings& f) {
  constexpr double kCoveredRow = 0.5, kCoveredColumn = 0.2;  // above the columns' surfaces there may be sky
  constexpr int kLeast = 4;                                  // rows and columns
  if (!f.borders || has_holes(f)) return std::nullopt;
  for (const std::size_t row : {0U, 1U})
    for (const std::size_t column : {2U, 3U}) {
      const BorderRows &rows = (*f.borders)[row], &columns = (*f.borders)[column];
      if (rows.empty < kLeast || columns.empty < kLeast) continue;
      if (rows.covered < kCoveredRow || columns.covered < kCoveredColumn) continue;
      if ((*f.borders)[5 - column].empty > 0) continue;
      return fmt::format(
          "the {} {} rows and the {} {} columns are empty: the picture is only a part of the buffer, as "
          "with dynamic resolution; the rest counts as sky, and the camera is taken for that of the "
          "whole: crop the file to the picture",
          row == 0 ? "upper" : "lower", rows.empty, column == 2 ? "left" : "right", columns.empty);
    }
  return std::nullopt;
}

/// Columns from the top to the bottom, next to ones that are full, as of a column of tiles.
Sentence missing_columns(const Findings& f) {
  constexpr double kCovered = 0.95;
  constexpr int kTile = 8;  // px
  if (!f.borders || has_holes(f)) return std::nullopt;
  for (const std::size_t side : {2U, 3U}) {
    const BorderRows& columns = (*f.borders)[side];
    if (columns.empty == 0 || columns.empty % kTile != 0 || columns.covered < kCovered) continue;
    if ((*f.borders)[0].empty + (*f.borders)[1].empty + (*f.borders)[5 - side].empty > 0) continue;
    return fmt::format(
        "the {} {} columns are empty from the top to the bottom, and their neighbours are full: missing tiles count as "
        "sky, so that AO about them is too light: render them again",
        side == 2 ? "left" : "right", columns.empty);
  }
  return std::nullopt;
}

Sentence missing_tile(const Findings& f) {
  if (!f.rectangle) return missing_columns(f);
  const EmptyRectangle& r = *f.rectangle;
  return fmt::format(
      "the rectangle of {} x {} pixels at ({}, {}) is {} throughout{}: a missing tile counts as sky, so that AO about "
      "it is too light: render it again",
      r.right - r.left, r.bottom - r.top, r.left, r.top, r.value,
      r.is_unlike_sky ? ", unlike the sky elsewhere" : ", and stands on the grid of tiles");
}

// Meaning of the values.

/// Whether the curve of the values is known well enough to speak against the kind of depth.
bool tells(const Curve& c) {
  constexpr std::size_t kLeastPlanes = 20;
  constexpr double kMostSpread = 0.03;
  return c.planes >= kLeastPlanes && c.spread < kMostSpread && c.is_wide;
}

/// Half floats whose sky may be surfaces: those beyond the largest number became infinite.
Sentence overflown_depth(const Findings& f) {
  if (!f.overflow.is_reached || f.overflow.beyond == 0) return std::nullopt;
  return fmt::format(
      "{:.0f} % of {} is infinite or 65504, the largest half float, and surfaces reach up to it: farther surfaces "
      "count as sky; write depth as float, or in larger units",
      100 * f.overflow.beyond, f.depth_channel);
}

constexpr double kSameSlope = 0.04;  // of distances, 1/2

bool is_in_proportion(const Findings& f) { return is_distance(f.depth_kind) || f.depth_kind == DepthKind::normalized; }

Sentence depth_offset(const Findings& f) {
  constexpr double kSame = 0.05;  // of the median value
  const Curve& c = f.curve;
  if (!is_in_proportion(f) || !tells(c) || std::abs(c.slope - 0.5) > kSameSlope) return std::nullopt;
  if (f.begins_behind) return std::nullopt;
  const double offset = 2 * c.offset;
  if (std::abs(offset - f.said_offset) < kSame * (c.median + std::abs(offset))) return std::nullopt;
  const bool is_normalized = f.depth_kind == DepthKind::normalized, falls = offset < -c.median;
  const std::string seen = fmt::format(
      "surfaces are flat by 1 / (depth {} {:.4g}), not by 1 / {}", offset < 0 ? "-" : "+", std::abs(offset),
      f.said_offset == 0 ? "depth"
                         : fmt::format("(depth {} {:.4g})", f.said_offset < 0 ? "-" : "+", std::abs(f.said_offset)));
  const char* const unreversed = f.said_offset < 0 ? ", without --reversed-z" : "";
  if (std::abs(offset) < kSame * c.median)
    return fmt::format(
        "{}: the depth starts at 0 at the eye, so --near does not fit: give --depth-kind normalized "
        "--near 0{}",
        seen, unreversed);
  if (falls)
    return fmt::format(
        "{}: the depth falls with the distance: {} --near N --far F with F / (F - N) = {:.4g}, as {:.4g} and {:.4g} "
        "times the scene units per unit of depth",
        seen, f.said_offset < 0 ? "--near or --far does not fit; give" : "give --depth-kind normalized --reversed-z",
        -offset, -offset - 1, -offset);
  if (offset < 0)
    return fmt::format("{}: something was added to the depth, an offset of {:.4g}; subtract it", seen, -offset);
  return fmt::format(
      "{}: the depth counts from a near plane, not from the eye, with an offset of {:.4g}: {} --near N "
      "--far F with N / (F - N) = {:.4g}, as {:.4g} and {:.4g} times the scene units per unit of depth{}",
      seen, offset, is_normalized ? "--near does not fit; give" : "give --depth-kind normalized", offset, offset,
      offset + 1, unreversed);
}

Sentence depth_curve(const Findings& f) {
  constexpr double kLogarithm = 0.05;  // slope; 0 of logarithms
  const Curve& c = f.curve;
  if (!is_in_proportion(f) || !tells(c) || std::abs(c.slope - 0.5) <= 2 * kSameSlope) return std::nullopt;
  const double power = c.slope / (1 - c.slope);
  const bool is_power = c.slope > kLogarithm && c.slope < 1 && std::abs(c.offset) < 0.02 * c.median;
  const std::string what = std::abs(c.slope) < kLogarithm ? "the logarithm of a distance"
                           : is_power ? fmt::format("a distance to the power of {:.3g}, as by a gamma", power)
                                      : "a distance that went through a curve, such as a picture's gamma or sRGB";
  return fmt::format(
      "surfaces are flat by a curve, and by no offset: depth is {}, and not proportional to a distance; write it "
      "without the curve, as {}",
      what, word_of(DepthKind::planar));
}

Sentence clamped_depth(const Findings& f) {
  constexpr std::size_t kLeastPlaces = 50;
  constexpr double kLeastTilt = 4;        // degrees; bumps of a wall have a mean of 0
  constexpr double kLeastFrontal = 0.05;  // of its normals, even of one with bumps
  if (!f.plateau || f.plateau->places < kLeastPlaces || !is_in_proportion(f)) return std::nullopt;
  const Plateau& p = *f.plateau;
  if (p.tilt < kLeastTilt && p.frontal > kLeastFrontal) return std::nullopt;
  return fmt::format(
      "{:.0f} % of the surfaces have exactly the largest depth {:.6g}, and by their normals they are no wall: depth "
      "was clamped there; write it without a limit, or give --sky {:.6g} to make them sky",
      100 * p.share, p.value, p.value);
}

Sentence wrapped_depth(const Findings& f) {
  constexpr std::size_t kLeast = 20;
  constexpr double kMost = 0.7;   // of the drops
  constexpr double kFull = 2e-3;  // of the range, that the largest value may exceed it by
  const Wrapping& w = f.wrapping;
  if (w.whole < kLeast || double(w.whole) < kMost * double(w.drops)) return std::nullopt;
  if (w.most > (1 + kFull) * w.period) return std::nullopt;
  return fmt::format(
      "within smooth surfaces depth jumps from the end of its range, {:.6g}, to its beginning: integers of too few "
      "bits wrapped round, and far surfaces count as near; write depth as float, or in larger units",
      w.most);
}

// Normals.

Sentence displaced_normals(const Findings& f) {
  constexpr std::size_t kLeast = 20;
  constexpr double kAligned = 0.4;
  if (f.normals.count < kLeast || double(f.normals.aligned) > kAligned * double(f.normals.count)) return std::nullopt;
  if (f.normals.beside == 0) return std::nullopt;
  return fmt::format(
      "along {:.0f} % of the outlines the normals change beside the depth, by {:.2g} px in the median: they are of "
      "another frame, or were displaced; --normal none reconstructs them from depth",
      100 - percent(double(f.normals.aligned), double(f.normals.count)), f.normals.beside);
}

constexpr std::array kTable{
    Detector{NoteCode::no_surfaces, no_surfaces},
    Detector{NoteCode::holes_in_depth, holes_in_depth},
    Detector{NoteCode::enlarged_depth, enlarged_depth},
    Detector{NoteCode::smoothed_depth, smoothed_depth},
    Detector{NoteCode::antialiased_depth, antialiased_depth},
    Detector{NoteCode::noisy_depth, noisy_depth},
    Detector{NoteCode::jittered_depth, jittered_depth},
    Detector{NoteCode::half_depth, half_depth},
    Detector{NoteCode::letterbox_bars, letterbox_bars},
    Detector{NoteCode::part_of_picture, part_of_picture},
    Detector{NoteCode::missing_tile, missing_tile},
    Detector{NoteCode::depth_offset, depth_offset},
    Detector{NoteCode::depth_curve, depth_curve},
    Detector{NoteCode::clamped_depth, clamped_depth},
    Detector{NoteCode::overflown_depth, overflown_depth},
    Detector{NoteCode::wrapped_depth, wrapped_depth},
    Detector{NoteCode::displaced_normals, displaced_normals},
};

}  // namespace

std::string no_surfaces_text(const std::string& depth_channel) {
  return fmt::format(
      "no pixel of {} shows a surface, all is sky, so AO is 1 everywhere: the frame may not have been "
      "rendered, or --depth-kind or --sky is wrong",
      depth_channel);
}

double said_offset(const Reading& reading) {
  const DepthRange& range = reading.depth_range;
  if (reading.depth_kind != DepthKind::normalized || !range.near || !range.far || *range.far == *range.near) return 0;
  return (range.reversed ? -*range.far : *range.near) / (*range.far - *range.near);
}

bool speaks_against(const Curve& curve, const Reading& reading) {
  Findings f;
  f.depth_kind = reading.depth_kind;
  f.curve = curve;
  f.said_offset = said_offset(reading);
  return depth_offset(f) || depth_curve(f);
}

std::span<const Detector> detectors() { return kTable; }

Notes detected(const Findings& findings) {
  Notes notes;
  for (const Detector& detector : kTable)
    if (auto sentence = detector.sentence(findings)) notes.push_back({detector.code, std::move(*sentence)});
  return notes;
}

}  // namespace alcove
