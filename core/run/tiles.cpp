// Tiles by what they take with their surroundings.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/tiles.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/chain/aov.h"
#include "core/chain/chain.h"
#include "core/chain/debug_view.h"
#include "kernels/bounds.h"
#include "kernels/classify.h"

namespace alcove {
namespace {

// the process without frames: libraries, drivers, compiled kernels
constexpr std::uint64_t kProgramBytes = 192ull << 20;
constexpr std::uint64_t kLeastBytes = 16ull << 20;  // for frames, however little the user allows
constexpr int kLeastRows = 16, kLeastColumns = 64;  // px of a tile: rows that most files compress together
// words a tile: sectors, bounds of groups, runs of the filters, and how the frame before differs
constexpr std::size_t kTileLists = 8;
constexpr std::size_t kConvergeLists = 7;  // one after each power of two directions
// a row of tiles is halved only while it is this many times as high as what it needs around it
constexpr int kFewBorders = 4;

/// At most so many groups of `each` pixels a pixel along a side of the frame, however it is cut into tiles.
double groups_a_pixel(int side, int each, int least) {
  const int pixels = std::min(side, least);
  return double((pixels + 2 * each - 2) / each) / pixels;
}

/// What passes leave in buffers of a frame, in bytes a pixel: what core/chain/chain.cpp makes.
std::uint64_t chain_bytes(const FrameSource& source, const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& o = settings.output;
  const auto groups = [&](int each) {
    return groups_a_pixel(source.file_data.width, each, kLeastColumns) *
           groups_a_pixel(source.file_data.height, each, kLeastRows);
  };
  const std::size_t scales = 1 + e.further_radii.size(), bent = needs_bent(e, o) ? 3 : 0,
                    estimated = scales + bent + (scales > 1 ? 1 : 0);
  const bool reduced = e.resolution != Resolution::full, converges = e.tolerance > 0;
  // of the estimate's resolution: it, and its depth and normals
  std::size_t low = estimated + (reduced ? 2 : 0);
  low += e.denoise == Denoise::none || converges ? 0 : 2 * estimated;  // rows, columns
  low += searches_exactly(e) ? 4 : 0;                                  // vertices, marks, neighbours, whole arcs
  low += converges ? 2 : 0;                                            // blocked arcs, error
  std::size_t planes = 2 + (reduced ? estimated : 0);                  // depth, normals, the whole estimate
  planes += shapes(e) || !source[RawPlane::material_ao].empty() ? 1 + scales : 0;
  planes += bent ? 1 : 0;
  planes += wants(o, &FrameOutputs::confidence) ? 2 * 3 : 0;  // thin and solid: estimates, rows, columns
  planes += (o.multi_bounce ? 3 : 0) + source[RawPlane::beauty].size() + debug_views_of(o).size();
  for (const auto& aov : aovs_of(o)) planes += channels_of(aov, scales).size();
  const double tiles =
      double(sizeof(TileBounds) + kTileLists * sizeof(uint) + (converges ? kConvergeLists : 1) * sizeof(ListedTile)) *
      groups(kTile * int(e.resolution));
  return std::uint64_t(
      std::ceil(double(sizeof(float)) * (double(planes) + double(low) * groups(int(e.resolution))) + tiles));
}

/// The number behind a word in a file of the kernel's, in bytes.
std::uint64_t kernel_number(const char* path, const std::string& word, std::uint64_t unit) {
  std::ifstream file(path);
  for (std::string text; file >> text;)
    if (std::uint64_t number = 0; text == word && file >> number) return number * unit;
  return std::numeric_limits<std::uint64_t>::max();
}

std::uint64_t free_memory() {
  std::uint64_t limit = std::numeric_limits<std::uint64_t>::max();
  std::ifstream("/sys/fs/cgroup/memory.max") >> limit;  // "max" leaves it
  if (limit == 0) limit = std::numeric_limits<std::uint64_t>::max();
  return std::min(limit, kernel_number("/proc/meminfo", "MemAvailable:", 1024));
}

class Cutter {
 public:
  Cutter(const Surroundings& surroundings, const PixelMemory& pixel, const Room& room, const FrameSource& source)
      : surroundings_(surroundings), pixel_(pixel), room_(room), source_(source) {}

  void cut(const Window& row) {
    const Window computed = surroundings_.around(row);
    if (fits(computed, pixel_, room_)) return rows_.push_back({row});
    const bool can_halve = row.height >= 2 * kLeastRows;
    if (can_halve && row.height > kFewBorders * (computed.height - row.height)) return halve(row);
    for (int columns = 2; row.width / columns >= kLeastColumns; columns *= 2)
      if (auto tiles = columns_of(row, columns); !tiles.empty()) return rows_.push_back(std::move(tiles));
    if (can_halve) return halve(row);
    fail(ErrorKind::device,
         "{}: within --radius a tile of the frame depends on {} pixels, more than {} MiB, or buffers of {} MiB, hold: "
         "allow more --memory, use another "
         "--device or a smaller --radius",
         source_.depth_path(), to_string(computed), room_.bytes >> 20, room_.buffer_bytes >> 20);
  }

  std::vector<std::vector<Window>> take() { return std::move(rows_); }

 private:
  void halve(const Window& row) {
    const int upper = row.height / 2 / kLeastRows * kLeastRows;
    cut({row.x, row.y, row.width, upper});
    cut({row.x, row.y + upper, row.width, row.height - upper});
  }

  /// Tiles of one row; empty where one does not fit beside the whole rows that are read and written.
  std::vector<Window> columns_of(const Window& row, int columns) const {
    std::vector<Window> tiles;
    for (int i = 0; i < columns; i++) {
      const int left = int(std::int64_t(row.width) * i / columns),
                right = int(std::int64_t(row.width) * (i + 1) / columns);
      tiles.push_back({row.x + left, row.y, right - left, row.height});
      const Window computed = surroundings_.around(tiles.back());
      const std::uint64_t rows =
          pixel_.read_bytes * std::uint64_t(source_.file_data.width) * std::uint64_t(computed.height) +
          pixel_.written_bytes * row.pixels();
      if (rows >= room_.bytes || !fits(computed, pixel_, {room_.bytes - rows, room_.buffer_bytes})) return {};
    }
    return tiles;
  }

  const Surroundings& surroundings_;
  const PixelMemory& pixel_;
  const Room& room_;
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
  // What is written may be there once more: cropped to a region, or as half.
  memory.bytes = memory.read_bytes + chain_bytes(source, settings) + pictures * sizeof(float) + memory.written_bytes;
  return memory;
}

bool fits(const Window& computed, const PixelMemory& pixel, const Room& room) {
  return computed.pixels() * pixel.bytes <= room.bytes && computed.pixels() * pixel.widest <= room.buffer_bytes;
}

std::vector<std::vector<Window>> tiles_of(const Window& whole, const Surroundings& surroundings,
                                          const PixelMemory& pixel, const Room& room, const FrameSource& source) {
  Cutter cutter(surroundings, pixel, room, source);
  cutter.cut(whole);
  return cutter.take();
}

std::uint64_t memory_for_frames(const DeviceSettings& settings) {
  const std::uint64_t all = settings.memory ? settings.memory : free_memory() / 2;
  return std::max(kLeastBytes, all - std::min(all, kProgramBytes));
}

}  // namespace alcove
