// Cuts frames by what their tiles take with their surroundings.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/chain/aov.h"
#include "core/chain/chain.h"
#include "core/chain/debug_view.h"
#include "kernels/bounds.h"
#include "kernels/classify.h"
#include "kernels/profile.h"

namespace alcove {
namespace {

constexpr int kLeastRows = 16;     // px of a tile: most files compress so many rows together
constexpr int kLeastColumns = 64;  // px of a tile
// Words per tile of 8 x 8: sectors, bounds of groups, runs of the filters, and how the frame before differs.
constexpr std::size_t kTileLists = 8;
constexpr std::size_t kCompletionSums = 2;  // words per tile
// Words per tile where pixels share estimates: twice the words of its rows, those of flat links, and its sites.
constexpr std::size_t kSiteLists = 3 * kTile + kTile * kTile;
constexpr std::size_t kConvergeLists = 7;  // there is one after each power of two directions
// A row of tiles is halved only while it is this many times as high as what it needs around it.
constexpr int kFewBorders = 4;

/// The most groups of `group` pixels that there are per pixel along a side of the frame, however it is cut into tiles
/// of at least so many pixels.
double groups_per_pixel(int side, int group, int least) {
  const int pixels = std::min(side, least);
  return double((pixels + 2 * group - 2) / group) / pixels;
}

/// The bytes per pixel of the buffers that core/chain/chain.cpp makes for a frame.
std::uint64_t chain_bytes(const FrameSource& source, const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& o = settings.output;
  const auto groups = [&](int group) {
    return groups_per_pixel(source.file_data.width, group, kLeastColumns) *
           groups_per_pixel(source.file_data.height, group, kLeastRows);
  };
  const std::size_t scales = 1 + e.further_radii.size();
  const std::size_t bent = needs_bent(e, o) ? 3 : 0;
  const std::size_t estimated = scales + bent + (scales > 1 ? 1 : 0);
  const bool reduced = e.resolution != Resolution::full;
  const bool converges = e.tolerance > 0;
  // Planes of the estimate's resolution: the estimate, and its depth and normals.
  std::size_t low = estimated + (reduced ? 2 : 0);
  low += e.denoise == Denoise::none || converges ? 0 : 2 * estimated;  // rows, columns
  low += searches_exactly(e) ? 4 : 0;                                  // vertices, marks, neighbours, whole arcs
  low += searches_exactly(e) && completes_anywhere(e) ? 2 : 0;         // what goes on, and behind what
  low += converges ? 2 : 0;                                            // blocked arcs, error
  const bool sums_completed = Wanted(o).completed && completes_anywhere(e);
  low += sums_completed ? 1 : 0;
  std::size_t planes = 2 + (reduced ? estimated : 0);  // depth, normals, the whole estimate
  planes += shapes(e) || !source[RawPlane::material_ao].empty() ? 1 + scales : 0;
  planes += bent ? 1 : 0;
  // thin, solid and perhaps completed: estimates, rows, columns
  planes += wants(o, &FrameOutputs::confidence) ? (completes_anywhere(e) ? 3 : 2) * 3 : 0;
  planes += (o.multi_bounce ? 3 : 0) + source[RawPlane::beauty].size() + debug_views_of(o).size();
  for (const auto& aov : aovs_of(o)) planes += channels_of(aov, scales).size();
  const bool has_bracket = wants(o, &FrameOutputs::confidence);
  const int shares = (spacing_of(e) > 1 ? 1 : 0) + (has_bracket && spacing_of(bracket_of(e)) > 1 ? 1 : 0);
  const double tiles =
      double(sizeof(TileBounds) +
             (kTileLists + (sums_completed ? kCompletionSums : 0) + std::size_t(shares) * kSiteLists) * sizeof(uint) +
             (converges ? kConvergeLists : 1) * sizeof(ListedTile)) *
      groups(kTile * int(e.resolution));
  return std::uint64_t(
      std::ceil(double(sizeof(float)) * (double(planes) + double(low) * groups(int(e.resolution))) + tiles));
}

class Cutter {
 public:
  Cutter(const Surroundings& surroundings, const WindowLimits& limits, const FrameSource& source)
      : surroundings_(surroundings), limits_(limits), source_(source) {}

  void cut(const Window& row) {
    const Window computed = surroundings_.around(row);
    if (limits_.allow(computed)) return rows_.push_back({row});
    const bool can_halve = row.height >= 2 * kLeastRows;
    const bool is_too_wide = computed.width > limits_.longest_side;
    if (can_halve && !is_too_wide && row.height > kFewBorders * (computed.height - row.height)) return halve(row);
    for (int columns = 2; row.width / columns >= kLeastColumns; columns *= 2)
      if (auto tiles = columns_of(row, columns); !tiles.empty()) return rows_.push_back(std::move(tiles));
    if (can_halve) return halve(row);
    fail(ErrorKind::device,
         "{}: within --radius a tile of the frame depends on {} pixels, too many to compute at once: use a smaller "
         "--radius, or {}",
         source_.depth_path(), to_string(computed), limits_.mended_by(computed));
  }

  std::vector<std::vector<Window>> take() { return std::move(rows_); }

 private:
  void halve(const Window& row) {
    const int upper = row.height / 2 / kLeastRows * kLeastRows;
    cut({row.x, row.y, row.width, upper});
    cut({row.x, row.y + upper, row.width, row.height - upper});
  }

  /// The tiles of one row; none where one of them is too large beside the whole rows that are read and written.
  std::vector<Window> columns_of(const Window& row, int columns) const {
    std::vector<Window> tiles;
    for (int i = 0; i < columns; i++) {
      const int left = int(std::int64_t(row.width) * i / columns);
      const int right = int(std::int64_t(row.width) * (i + 1) / columns);
      tiles.push_back({row.x + left, row.y, right - left, row.height});
      const Window computed = surroundings_.around(tiles.back());
      const std::uint64_t rows =
          limits_.pixel.read_bytes * std::uint64_t(source_.file_data.width) * std::uint64_t(computed.height) +
          limits_.pixel.written_bytes * row.pixels();
      WindowLimits beside = limits_;
      beside.room.bytes -= std::min(beside.room.bytes, rows);
      if (!beside.allow(computed)) return {};
    }
    return tiles;
  }

  const Surroundings& surroundings_;
  const WindowLimits& limits_;
  const FrameSource& source_;
  std::vector<std::vector<Window>> rows_;
};

}  // namespace

PixelMemory pixel_memory(const FrameSource& source, const Settings& settings) {
  const std::size_t scales = 1 + settings.estimator.further_radii.size();
  std::size_t read = 0, widest = std::max<std::size_t>(scales, needs_bent(settings.estimator, settings.output) ? 3 : 1);
  for (const auto& channels : source.planes.entries) {
    read += channels.size();
    widest = std::max(widest, channels.size());
  }
  std::size_t written = source[RawPlane::beauty].size();
  for (const auto& aov : aovs_of(settings.output)) {
    written += channels_of(aov, scales).size();
    widest = std::max(widest, aov.channels.size());
  }
  const std::size_t pictures = settings.output.preview.empty() ? 0 : 6;  // planes as shown, once more interleaved
  PixelMemory memory;
  memory.read_bytes = read * sizeof(float);
  memory.written_bytes = written * sizeof(float);
  memory.widest = widest * sizeof(float);
  memory.device_bytes = memory.read_bytes + chain_bytes(source, settings);
  // What is written may be there once more: cropped to a region, or as half.
  memory.bytes = memory.device_bytes + pictures * sizeof(float) + memory.written_bytes;
  return memory;
}

int longest_side(const EstimatorSettings& settings) {
  if (!searches_exactly(settings)) return std::numeric_limits<int>::max();
  // kNoVertex stands for none.
  return int(kNoVertex) * int(settings.resolution);
}

void require_numbered_lines(const FrameSource& source, const EstimatorSettings& settings) {
  if (!searches_exactly(settings)) return;
  // Slopes times steps from the display window's corner are of the type int: see lines.glsl.
  const std::int64_t farthest = std::numeric_limits<int>::max() / kSlopeUnit - 1;
  const std::int64_t left = std::int64_t(source.file_data.x) - source.display.x;
  const std::int64_t top = std::int64_t(source.file_data.y) - source.display.y;
  const std::int64_t reach =
      std::max({-left, -top, left + source.file_data.width, top + source.file_data.height}) / int(settings.resolution);
  if (reach > farthest)
    fail(ErrorKind::input,
         "{}: its pixels reach {} px from the display window's corner, and an exact search takes at most {}: give "
         "--search steps",
         source.depth_path(), reach, farthest);
}

bool WindowLimits::allow(const Window& computed) const {
  const std::uint64_t pixels = computed.pixels();
  return pixels * pixel.bytes <= room.bytes && pixels * pixel.device_bytes <= room.device_bytes &&
         pixels * pixel.widest <= room.buffer_bytes && pixels <= room.pixels &&
         std::max(computed.width, computed.height) <= longest_side;
}

std::string WindowLimits::mended_by(const Window& computed) const {
  if (std::max(computed.width, computed.height) > longest_side)
    return fmt::format("--search steps, since lines of an exact search have at most {} pixels", longest_side);
  if (computed.pixels() * pixel.bytes > room.bytes)
    return fmt::format("allow more --memory than the {} MiB that there are for this frame", room.bytes >> 20);
  return "use another --device, with more memory or larger buffers";
}

std::vector<std::vector<Window>> tiles_of(const Window& whole, const Surroundings& surroundings,
                                          const WindowLimits& limits, const FrameSource& source) {
  Cutter cutter(surroundings, limits, source);
  cutter.cut(whole);
  return cutter.take();
}

}  // namespace alcove
