// Takes lines out of the planes, counts along them, and adds up.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/walk.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <thread>

#include "core/base/ranks.h"
#include "core/base/system.h"
#include "core/frame/pixels/empty.h"
#include "core/frame/pixels/lines.h"
#include "core/frame/pixels/places.h"
#include "core/frame/pixels/statistics.h"
#include "kernels/geometry/geometry.h"

namespace alcove {
namespace {

// Of each direction: enough for shares to a percent, and of large pictures fewer, which have as many pixels.
constexpr int kMostLines = 96, kLeastLines = 48;
constexpr int kLinePixels = 100'000;
constexpr int kMostThreads = 8;      // more take longer to start than they save
constexpr int kLinesPerThread = 16;  // the same of fewer

/// The planes with all that is needed to take a line out of them.
class LineSource {
 public:
  explicit LineSource(const WalkedPlanes& planes)
      : planes_(planes),
        map_(depth_map_of(planes.reading)),
        view_(view_of(planes.reading, planes.reading.data)),
        pixels_(planes.reading.data.pixels()) {}

  int count(bool is_column) const {
    const int size = is_column ? view_.size.y : view_.size.x, all = is_column ? view_.size.x : view_.size.y;
    return std::min(all, std::clamp(kLinePixels / size, kLeastLines, kMostLines));
  }
  int place(bool is_column, int number) const {
    const int all = is_column ? view_.size.x : view_.size.y, count = this->count(is_column);
    return int((std::int64_t(2 * number + 1) * all) / (2 * count));
  }

  Line line(bool is_column, int place) const {
    const auto size = std::size_t(is_column ? view_.size.y : view_.size.x);
    Line line;
    line.raw.resize(size);
    line.inverse.resize(size);
    line.normals = planes_.normal;
    line.pixels = pixels_;
    line.first = is_column ? std::size_t(place) : std::size_t(place) * std::size_t(view_.size.x);
    line.stride = is_column ? std::size_t(view_.size.x) : 1;
    for (std::size_t i = 0; i < size; i++) take(line, i, is_column ? place : int(i), is_column ? int(i) : place);
    return line;
  }

 private:
  void take(Line& line, std::size_t i, int x, int y) const {
    const std::size_t at = index_of(view_, x, y);
    const double z = planar_depth_at(map_, planes_.depth, view_, x, y);
    line.raw[i] = map_.form == kDepthPosition ? float(z) : planes_.depth[at];
    line.inverse[i] = std::isinf(z) ? 0 : 1 / z;
  }

  const WalkedPlanes& planes_;
  DepthMap map_;
  View view_;
  std::size_t pixels_;
};

/// What lines show that stand one after the other.
struct LineCounts {
  std::size_t pixels = 0, surfaces = 0;
  BorderCounts borders;
  Outlines outlines;
  Holes holes;
  std::array<HoleCounts, 8> cells;
  BendSample bends;
  DropSample drops;
  std::vector<int> shifts;
  std::vector<std::vector<EmptyRun>> empty;  // of rows
  std::map<float, std::size_t> largest;      // the largest values of lines, and how many pixels have them
};

void count(const Line& line, std::size_t eighth, LineCounts& counts) {
  counts.pixels += line.size();
  counts.surfaces += std::size_t(std::ranges::count_if(line.inverse, [](double u) { return u > 0; }));
  count_repeats(line, counts.borders);
  count_outlines(line, counts.outlines);
  const HoleCounts holes = count_holes(line, counts.holes);
  for (std::size_t i = 0; i < 8; i++) {
    counts.cells[eighth].surfaces[i] += holes.surfaces[i];
    counts.cells[eighth].holes[i] += holes.holes[i];
  }
  sample_bends(line, counts.bends);
  sample_drops(line, counts.drops);
  sample_normal_shifts(line, counts.shifts);
  counts.empty.push_back(empty_runs(line));
  float most = 0;
  std::size_t frequency = 0;
  for (std::size_t i = 0; i < line.size(); i++) {
    if (!line.is_surface(i) || line.raw[i] < most) continue;
    frequency = line.raw[i] > most ? 1 : frequency + 1;
    most = line.raw[i];
  }
  if (frequency) counts.largest[most] += frequency;
}

template <class T>
void append(std::vector<T>& all, std::vector<T>& more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

void add(LineCounts& all, LineCounts more) {
  all.pixels += more.pixels;
  all.surfaces += more.surfaces;
  for (auto [to, from] :
       {std::pair{&all.borders.places, &more.borders.places}, std::pair{&all.borders.equal, &more.borders.equal}}) {
    to->resize(std::max(to->size(), from->size()));
    for (std::size_t i = 0; i < from->size(); i++) (*to)[i] += (*from)[i];
  }
  all.outlines.count += more.outlines.count;
  all.outlines.sharp += more.outlines.sharp;
  all.outlines.steps += more.outlines.steps;
  all.outlines.blended += more.outlines.blended;
  all.holes.surfaces += more.holes.surfaces;
  all.holes.between += more.holes.between;
  all.holes.within_planes += more.holes.within_planes;
  for (std::size_t y = 0; y < 8; y++)
    for (std::size_t x = 0; x < 8; x++) {
      all.cells[y].surfaces[x] += more.cells[y].surfaces[x];
      all.cells[y].holes[x] += more.cells[y].holes[x];
    }
  append(all.bends.sizes, more.bends.sizes);
  all.bends.neighbours += more.bends.neighbours;
  all.bends.opposite += more.bends.opposite;
  all.drops.most = std::max(all.drops.most, more.drops.most);
  append(all.drops.drops, more.drops.drops);
  append(all.shifts, more.shifts);
  append(all.empty, more.empty);
  for (const auto& [value, frequency] : more.largest) all.largest[value] += frequency;
}

/// The counts of all lines of one direction. Each thread takes neighbouring ones, so that their order stays.
LineCounts counts_of(const LineSource& source, bool is_column) {
  const int lines = source.count(is_column);
  const int threads = std::clamp(lines / kLinesPerThread, 1, std::min(kMostThreads, core_count()));
  std::vector<LineCounts> parts(static_cast<std::size_t>(threads));
  const auto run = [&](int part) {
    for (int i = lines * part / threads; i < lines * (part + 1) / threads; i++)
      count(source.line(is_column, source.place(is_column, i)), std::size_t(8 * i / lines), parts[std::size_t(part)]);
  };
  {
    std::vector<std::jthread> others;
    for (int part = 1; part < threads; part++) others.emplace_back(run, part);
    run(0);
  }
  for (std::size_t part = 1; part < parts.size(); part++) add(parts[0], std::move(parts[part]));
  return std::move(parts[0]);
}

void count_cells(LineCounts& lines) {
  constexpr double kPierced = 0.005;  // of the surfaces
  std::size_t most = 0;
  for (const auto& row : lines.cells)
    for (std::size_t x = 0; x < 8; x++) most = std::max(most, row.surfaces[x] + row.holes[x]);
  for (const auto& row : lines.cells)
    for (std::size_t x = 0; x < 8; x++) {
      const std::size_t all = row.surfaces[x] + row.holes[x];
      if (2 * all < most) continue;
      lines.holes.cells++;
      lines.holes.pierced += double(row.holes[x]) > kPierced * double(all);
    }
}

Unevenness unevenness_of(BendSample rows, BendSample columns) {
  append(rows.sizes, columns.sizes);
  Unevenness found{.count = rows.sizes.size()};
  if (rows.sizes.empty()) return found;
  found.tenth = value_at_rank(rows.sizes, rows.sizes.size() / 10);
  found.alternating =
      double(rows.opposite + columns.opposite) / double(std::max<std::size_t>(1, rows.neighbours + columns.neighbours));
  return found;
}

NormalOutlines normal_outlines(std::vector<int> shifts) {
  NormalOutlines found{.count = shifts.size(), .aligned = std::size_t(std::ranges::count(shifts, 0))};
  for (int& shift : shifts) shift = std::abs(shift);
  if (!shifts.empty()) found.beside = median_of(std::move(shifts));
  return found;
}

/// The largest value, where many pixels have it, and the normals within.
std::optional<Plateau> plateau_of(const WalkedPlanes& planes, const LineSource& source, const LineCounts& rows) {
  constexpr double kLeast = 0.005;  // of the surfaces
  if (rows.largest.empty() || rows.surfaces == 0) return std::nullopt;
  const auto largest = rows.largest.rbegin();
  const auto value = largest->first;
  Plateau plateau{.value = value, .share = double(largest->second) / double(rows.surfaces)};
  if (plateau.share < kLeast) return std::nullopt;
  if (planes.normal.empty() || !planes.has_read_normals) return plateau;
  const Reading& reading = planes.reading;
  const double kFrontal = std::cos(4 * std::numbers::pi / 180);
  Vector3 sum{};
  std::size_t frontal = 0;
  const Matrix3 turn = view_from_normal(reading.camera, reading.normal_space, reading.flip_normal);
  for (int i = 1; i + 1 < source.count(false); i++) {
    const int y = source.place(false, i);
    const Line line = source.line(false, y);
    // A row of an endless floor has one depth, too; a plateau extends in both directions.
    const auto is_within = [&](std::size_t x) {
      const std::size_t at = std::size_t(y) * line.size() + x;
      return line.raw[x - 1] == value && line.raw[x] == value && line.raw[x + 1] == value &&
             planes.depth[at - line.size()] == value && planes.depth[at + line.size()] == value;
    };
    for (std::size_t x = 1; x + 1 < line.size(); x++) {
      if (!is_within(x)) continue;
      const Vector3 n = times(turn, decoded_normal(planes.normal, line.pixels, line.first + x, reading.normal_encoding,
                                                   reading.normal_unorm));
      if (!(length(n) > 0)) continue;
      plateau.places++;
      frontal += n[2] > kFrontal * length(n);
      for (std::size_t c = 0; c < 3; c++) sum[c] += n[c] / length(n);
    }
  }
  plateau.frontal = double(frontal) / double(std::max<std::size_t>(1, plateau.places));
  // Normals to all sides have no mean direction.
  const double cosine = length(sum) > 0 ? sum[2] / length(sum) : 0;
  if (plateau.places) plateau.tilt = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
  return plateau;
}

}  // namespace

void walk(const WalkedPlanes& planes, Findings& findings) {
  const LineSource source(planes);
  LineCounts rows = counts_of(source, false), columns = counts_of(source, true);
  findings.pixels = rows.pixels;
  findings.surfaces = rows.surfaces;
  findings.repeats = {repeats_of(rows.borders, rows.empty.size()), repeats_of(columns.borders, columns.empty.size())};
  findings.outlines = {rows.outlines, columns.outlines};
  count_cells(rows);
  count_cells(columns);
  findings.holes = {rows.holes, columns.holes};
  findings.unevenness = unevenness_of(std::move(rows.bends), std::move(columns.bends));
  rows.drops.most = std::max(rows.drops.most, columns.drops.most);
  append(rows.drops.drops, columns.drops.drops);
  findings.wrapping = wrapping_of(std::move(rows.drops));
  append(rows.shifts, columns.shifts);
  findings.normals = normal_outlines(std::move(rows.shifts));
  findings.plateau = plateau_of(planes, source, rows);
  std::vector<PlacedRuns> placed;
  for (int i = 0; i < int(rows.empty.size()); i++)
    placed.push_back({source.place(false, i), std::move(rows.empty[std::size_t(i)])});
  findings.rectangle = empty_rectangle(planes.depth, planes.reading.data, planes.frame, placed,
                                       planes.reading.depth_kind == DepthKind::disparity);
}

}  // namespace alcove
