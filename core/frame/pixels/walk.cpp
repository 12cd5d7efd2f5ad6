// Takes lines out of the planes, counts along them, and adds up; finds borders and rectangles without surfaces.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/walk.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <thread>

#include "core/base/ranks.h"
#include "core/base/system.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"
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
  for (const auto count : {&Outlines::count, &Outlines::sharp, &Outlines::steps, &Outlines::blended})
    all.outlines.*count += more.outlines.*count;
  for (const auto count : {&Holes::surfaces, &Holes::between, &Holes::within_planes})
    all.holes.*count += more.holes.*count;
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

Unevenness unevenness_of(BendSample bends) {
  Unevenness found{.count = bends.sizes.size()};
  if (bends.sizes.empty()) return found;
  found.tenth = value_at_rank(bends.sizes, bends.sizes.size() / 10);
  found.alternating = double(bends.opposite) / double(bends.neighbours);
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
  findings.plateau = plateau_of(planes, source, rows);
  std::vector<PlacedRuns> placed;
  for (int i = 0; i < int(rows.empty.size()); i++)
    placed.push_back({source.place(false, i), std::move(rows.empty[std::size_t(i)])});
  findings.rectangle = empty_rectangle(planes.depth, planes.reading.data, planes.frame, placed,
                                       planes.reading.depth_kind == DepthKind::disparity);
  add(rows, std::move(columns));
  findings.unevenness = unevenness_of(std::move(rows.bends));
  findings.wrapping = wrapping_of(std::move(rows.drops));
  findings.normals = normal_outlines(std::move(rows.shifts));
}

// Parts without surfaces.

namespace {

bool is_same(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Rows or columns, counted from one of the borders: the upper, lower, left or right one.
struct BorderLines {
  std::span<const float> depth;
  const Window& window;
  const DepthMap& map;
  std::size_t side;  // 0 to 3: upper, lower, left, right

  int count() const { return side < 2 ? window.height : window.width; }
  int size() const { return side < 2 ? window.width : window.height; }
  float value(int line, int i) const {
    const int at = side % 2 == 0 ? line : count() - 1 - line, x = side < 2 ? i : at, y = side < 2 ? at : i;
    return depth[std::size_t(y) * std::size_t(window.width) + std::size_t(x)];
  }
  bool is_surface(int line, int i) const { return std::isfinite(planar_depth(map, {value(line, i), 0, 0}, 1)); }
  /// How many lines have no surface and one value.
  int empty() const {
    const auto is_empty = [&](int line) {
      for (int i = 0; i < size(); i++)
        if (!is_same(value(line, i), value(line, 0)) || (i == 0 && is_surface(line, 0))) return false;
      return true;
    };
    int line = 0;
    while (line < count() && is_empty(line)) line++;
    return line;
  }
  /// The part of a line's pixels from `first` to `end` that has surfaces.
  double covered(int line, int first, int end) const {
    if (line >= count() || first >= end) return 0;
    int surfaces = 0;
    for (int i = first; i < end; i++) surfaces += is_surface(line, i);
    return double(surfaces) / (end - first);
  }
};

}  // namespace

Borders borders_of(std::span<const float> depth, const Window& window, const DepthMap& map) {
  Borders borders;
  for (std::size_t side = 0; side < 4; side++) borders[side].empty = BorderLines{depth, window, map, side}.empty();
  for (std::size_t side = 0; side < 4; side++) {
    const BorderLines lines{depth, window, map, side};
    const std::size_t across = side < 2 ? 2 : 0;
    borders[side].covered =
        lines.covered(borders[side].empty, borders[across].empty, lines.size() - borders[across + 1].empty);
  }
  return borders;
}

namespace {

/// A run of the same columns in rows one after the other.
struct Stack {
  EmptyRun run;
  int first_row, last_row;
  int rows;

  double area() const { return double(run.end - run.first) * (last_row - first_row + 1); }
};

/// All stacks of at least three rows.
std::vector<Stack> stacks_of(std::span<const PlacedRuns> rows) {
  constexpr int kLeastRows = 3;
  std::vector<Stack> open, found;
  const auto keep = [&](const Stack& stack) {
    if (stack.rows >= kLeastRows) found.push_back(stack);
  };
  for (const auto& [row, runs] : rows) {
    std::vector<Stack> next;
    for (const EmptyRun& run : runs) {
      const auto above = std::ranges::find_if(open, [&](const Stack& s) {
        return s.run.first == run.first && s.run.end == run.end && is_same(s.run.value, run.value);
      });
      if (above == open.end()) {
        next.push_back({run, row, row, 1});
      } else {
        next.push_back({run, above->first_row, row, above->rows + 1});
        open.erase(above);
      }
    }
    std::ranges::for_each(open, keep);
    open = std::move(next);
  }
  std::ranges::for_each(open, keep);
  return found;
}

/// Sides that are no border of the picture, where a tile's side is always.
int free_sides(int first, int end, int size) { return (first > 0) + (end < size); }

/// The chance that two opposite sides stand on a grid of tiles as these do; 1 where they stand on none. A grid begins
/// at one of the borders.
double grid_chance(int first, int end, int size) {
  double chance = 1;
  for (const int tile : {16, 32, 64, 128}) {
    const auto stand = [&](int origin) {
      return (first == 0 || (first - origin) % tile == 0) && (end == size || (end - origin) % tile == 0);
    };
    if (stand(0) || stand(size)) chance = (size % tile == 0 ? 1 : 2) * std::pow(tile, -free_sides(first, end, size));
  }
  return chance;
}

/// Whether sides stand where those of tiles do, and one of so many rectangles hardly does so by chance.
bool is_on_grid(const EmptyRectangle& r, const Window& frame, std::size_t rectangles) {
  constexpr int kLeastSides = 3;
  constexpr double kMostChance = 0.005;
  const double across = grid_chance(r.left, r.right, frame.width), down = grid_chance(r.top, r.bottom, frame.height);
  const int sides = free_sides(r.left, r.right, frame.width) + free_sides(r.top, r.bottom, frame.height);
  return sides >= kLeastSides && std::max(across, down) < 1 && double(rectangles) * across * down < kMostChance;
}

bool has_other_values(std::span<const PlacedRuns> rows, float value) {
  constexpr double kLeast = 0.01;  // of the empty pixels
  std::size_t others = 0, all = 0;
  for (const auto& row : rows)
    for (const auto& run : row.runs) {
      all += run.end - run.first;
      if (!is_same(run.value, value)) others += run.end - run.first;
    }
  return double(others) > kLeast * double(all);
}

}  // namespace

std::optional<EmptyRectangle> empty_rectangle(std::span<const float> depth, const Window& window, const Window& frame,
                                              std::span<const PlacedRuns> rows, bool is_sky_0) {
  if (depth.size() != window.pixels()) return std::nullopt;
  std::optional<EmptyRectangle> best;
  double area = 0;
  const int above = window.y - frame.y, below = frame.height - window.height - above;
  const std::vector<Stack> stacks = stacks_of(rows);
  for (const Stack& stack : stacks) {
    const bool is_whole_row = stack.run.first == 0 && stack.run.end == std::size_t(window.width);
    if (is_whole_row || stack.area() <= area) continue;
    const auto is_row = [&](int row) {
      const auto* const at = &depth[std::size_t(row) * std::size_t(window.width)];
      return std::all_of(at + stack.run.first, at + stack.run.end,
                         [&](float v) { return is_same(v, stack.run.value); });
    };
    EmptyRectangle r{int(stack.run.first), stack.first_row, int(stack.run.end), stack.last_row + 1, stack.run.value};
    while (r.top > 0 && is_row(r.top - 1)) r.top--;
    while (r.bottom < window.height && is_row(r.bottom)) r.bottom++;
    if ((r.top == 0 && above > 0) || (r.bottom == window.height && below > 0)) continue;
    r.top += above;
    r.bottom += above;
    const bool is_nothing = (stack.run.value == 0 && !is_sky_0) || std::isnan(stack.run.value);
    r.is_unlike_sky = is_nothing && has_other_values(rows, stack.run.value);
    r.is_on_grid = is_on_grid(r, frame, stacks.size());
    if (!r.is_unlike_sky && !r.is_on_grid) continue;
    best = r;
    area = stack.area();
  }
  return best;
}

}  // namespace alcove
