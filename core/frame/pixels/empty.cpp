// Rows and columns without surfaces, and rectangles of them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/empty.h"

#include <algorithm>
#include <cmath>

namespace alcove {
namespace {

bool is_same(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// A row or a column, counted from one of the borders.
class BorderLines {
 public:
  BorderLines(std::span<const float> depth, const Window& window, const DepthMap& map, bool are_columns, bool are_last)
      : depth_(depth),
        map_(map),
        width_(std::size_t(window.width)),
        count_(are_columns ? window.width : window.height),
        size_(are_columns ? window.height : window.width),
        are_columns_(are_columns),
        are_last_(are_last) {}

  int size() const { return size_; }
  bool is_surface(int line, int i) const { return std::isfinite(planar_depth(map_, {value(line, i), 0, 0}, 1)); }
  /// How many lines have no surface and one value.
  int empty() const {
    int line = 0;
    while (line < count_ && is_empty(line)) line++;
    return line;
  }
  /// The part of a line's pixels from `first` to `end` that has surfaces.
  double covered(int line, int first, int end) const {
    if (line >= count_ || first >= end) return 0;
    int surfaces = 0;
    for (int i = first; i < end; i++) surfaces += is_surface(line, i);
    return double(surfaces) / (end - first);
  }

 private:
  float value(int line, int i) const {
    const int at = are_last_ ? count_ - 1 - line : line;
    return depth_[are_columns_ ? std::size_t(i) * width_ + std::size_t(at) : std::size_t(at) * width_ + std::size_t(i)];
  }
  bool is_empty(int line) const {
    for (int i = 0; i < size_; i++)
      if (!is_same(value(line, i), value(line, 0)) || (i == 0 && is_surface(line, 0))) return false;
    return true;
  }

  std::span<const float> depth_;
  const DepthMap& map_;
  std::size_t width_;
  int count_, size_;
  bool are_columns_, are_last_;
};

}  // namespace

Borders borders_of(std::span<const float> depth, const Window& window, const DepthMap& map) {
  Borders borders;
  std::vector<BorderLines> lines;
  for (const bool are_columns : {false, true})
    for (const bool are_last : {false, true}) lines.emplace_back(depth, window, map, are_columns, are_last);
  for (std::size_t side = 0; side < 4; side++) borders[side].empty = lines[side].empty();
  for (std::size_t side = 0; side < 4; side++) {
    const std::size_t across = side < 2 ? 2 : 0;
    borders[side].covered =
        lines[side].covered(borders[side].empty, borders[across].empty, lines[side].size() - borders[across + 1].empty);
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
