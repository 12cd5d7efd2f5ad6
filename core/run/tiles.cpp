// Cuts frames by what their tiles take with their surroundings.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/base/memory_limit.h"
#include "kernels/profile.h"

namespace alcove {
namespace {

constexpr int kLeastRows = 16;     // px of a tile: most files compress so many rows together
constexpr int kLeastColumns = 64;  // px of a tile
constexpr int kMostRows = 32;      // of tiles, unless they have to be lower

std::uint64_t mebibytes_above(std::uint64_t bytes) { return (bytes + kMebibyte - 1) / kMebibyte; }

/// The bytes of a row of results that is put together from tiles, and of its encoded twin.
std::uint64_t row_bytes(const WindowLimits& limits, const Window& row) {
  return 2 * limits.memory.written * row.pixels();
}

/// Chooses, of all ways to cut a window into rows and each row into columns, the one in which the fewest pixels are
/// computed: by the best way to cut what lies below a row, from the bottom up.
class Cutter {
  static constexpr std::uint64_t kNoWay = std::numeric_limits<std::uint64_t>::max();
  struct Cut {
    TileRows rows;
    std::uint64_t pixels = kNoWay;  // that are computed
  };

 public:
  Cutter(Surroundings& surroundings, const WindowLimits& limits) : surroundings_(surroundings), limits_(limits) {}

  /// Nothing where some of the window cannot be cut into tiles that are small enough. Where the borders cost much, it
  /// is worth the time to look at more places.
  std::optional<TileRows> cut(const Window& whole) {
    Cut best;
    for (int step = std::max(1, whole.height / kMostRows / kLeastRows) * kLeastRows; step >= kLeastRows;
         step = step / 2 / kLeastRows * kLeastRows) {
      if (Cut cut = cut_at(whole, step); cut.pixels < best.pixels) best = std::move(cut);
      if (best.pixels < kMuch * whole.pixels()) break;
    }
    if (best.rows.empty()) return {};
    return std::move(best.rows);
  }

 private:
  /// Rows from one of the places at which may be cut down to the bottom.
  struct Way {
    std::uint64_t pixels = kNoWay;  // that are computed
    std::size_t next = 0;           // the place where the second row begins
    std::vector<Window> first;      // the tiles of the first row
  };
  static constexpr std::uint64_t kMuch = 2;  // pixels computed for one of the results

  /// Cuts at multiples of `step` rows.
  Cut cut_at(const Window& whole, int step) {
    const auto places = std::size_t((whole.height + step - 1) / step);
    std::vector<Way> ways(places + 1);
    ways[places].pixels = 0;
    for (std::size_t from = places; from-- > 0;)
      for (std::size_t to = from + 1; to <= places; to++) {
        const int top = int(from) * step, bottom = std::min(int(to) * step, whole.height);
        Way way = best_row({whole.x, whole.y + top, whole.width, bottom - top});
        if (way.pixels == kNoWay) break;
        if (ways[to].pixels == kNoWay || way.pixels + ways[to].pixels >= ways[from].pixels) continue;
        ways[from] = {way.pixels + ways[to].pixels, to, std::move(way.first)};
      }
    Cut cut{{}, ways[0].pixels};
    for (std::size_t at = 0; at < places && cut.pixels != kNoWay; at = ways[at].next)
      cut.rows.push_back(std::move(ways[at].first));
    return cut;
  }

  /// One row. Of the numbers of columns that are allowed the least few are tried: more make more borders.
  Way best_row(const Window& row) {
    Way best;
    int tries = 0;
    for (const int columns : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64}) {
      if ((columns > 1 && row.width / columns < kLeastColumns) || tries > 2) break;
      Way way = cut_row(row, columns);
      tries += way.pixels != kNoWay || tries > 0 ? 1 : 0;
      if (way.pixels < best.pixels) best = std::move(way);
    }
    return best;
  }

  /// No way where one of the tiles is too large beside the rows that are written.
  Way cut_row(const Window& row, int columns) {
    Way way;
    std::uint64_t computed = 0;
    for (int i = 0; i < columns; i++) {
      const int left = int(std::int64_t(row.width) * i / columns);
      const int right = int(std::int64_t(row.width) * (i + 1) / columns);
      way.first.push_back({row.x + left, row.y, right - left, row.height});
      const Window window = surroundings_.around(way.first.back());
      if (!limits_.allow(window, row_bytes(limits_, row))) return {};
      computed += window.pixels();
    }
    way.pixels = computed;
    return way;
  }

  Surroundings& surroundings_;
  const WindowLimits& limits_;
};

}  // namespace

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

std::uint64_t WindowLimits::with_larger_codecs(std::uint64_t bytes) const {
  const std::uint64_t without = bytes - std::min(bytes, memory.codec_bytes(room.bytes));
  // What codecs take grows step by step, and by less than what they may take, so that this ends.
  for (std::uint64_t more; (more = without + memory.codec_bytes(bytes)) > bytes;) bytes = more;
  return bytes;
}

WindowLimits WindowLimits::in_parts(const FrameSource& source) const {
  WindowLimits limits = *this;
  limits.kept = raw_bytes_of(source);
  if (limits.kept < room.bytes) return limits;
  // That is enough to compute all of the frame at once; what its tiles take, only its depth tells.
  const std::uint64_t enough = memory.on_host(source.file_data) + (source.region ? limits.kept : 0);
  refuse(fmt::format("{}: its pixels take {} MiB as they are read: use a smaller frame", source.depth_path(),
                     mebibytes_above(limits.kept)),
         enough);
}

bool WindowLimits::allow(const Window& computed, std::uint64_t beside) const {
  return memory.on_host(computed) + kept + beside <= room.bytes && memory.on_device(computed) <= room.device_bytes &&
         memory.in_buffer(computed) <= room.buffer_bytes && computed.pixels() <= room.pixels &&
         std::max(computed.width, computed.height) <= longest_side;
}

std::string WindowLimits::why_not(const Window& computed) const {
  if (std::max(computed.width, computed.height) > longest_side)
    return fmt::format("lines of an exact search have at most {} pixels", longest_side);
  if (memory.on_host(computed) + kept > room.bytes)
    return fmt::format("{} leaves {} MiB for it, and at once it takes {} MiB",
                       room.is_chosen ? "--memory" : "half of the free memory", (room.bytes - kept) / kMebibyte,
                       mebibytes_above(memory.on_host(computed)));
  if (memory.in_buffer(computed) > room.buffer_bytes)
    return fmt::format("the device takes buffers of {} MiB at most", room.buffer_bytes / kMebibyte);
  return "the device has too little memory for it at once";
}

void WindowLimits::refuse(const std::string& what, const Window& computed) const {
  if (memory.on_host(computed) + kept > room.bytes) refuse(what, memory.on_host(computed) + kept);
  if (std::max(computed.width, computed.height) > longest_side)
    fail(ErrorKind::device, "{}, or give --search steps, since lines of an exact search have at most {} pixels", what,
         longest_side);
  fail(ErrorKind::device, "{}, or use another --device, with more memory or larger buffers", what);
}

void WindowLimits::refuse(const std::string& what, std::uint64_t least) const {
  least = with_larger_codecs(least);
  fail(room.is_chosen ? ErrorKind::usage : ErrorKind::device,
       "{}, or let the run take at least --memory {}M, of which {} MiB are for the program itself", what,
       mebibytes_above(room.program_bytes + least), mebibytes_above(room.program_bytes));
}

TileRows tiles_of(const Window& whole, Surroundings& surroundings, const WindowLimits& limits,
                  const FrameSource& source) {
  if (auto rows = Cutter(surroundings, limits).cut(whole)) return *std::move(rows);
  const std::string what = fmt::format(
      "{}: within --radius a tile of the frame depends on too many pixels to compute at once: use a smaller --radius",
      source.depth_path());
  WindowLimits larger = limits;
  const auto allows = [&](std::uint64_t bytes) {
    larger.room.bytes = bytes;
    return Cutter(surroundings, larger).cut(whole).has_value();
  };
  // More memory than all of the window takes at once is of no use.
  std::uint64_t little = limits.room.bytes;
  std::uint64_t enough = limits.memory.on_host(surroundings.around(whole)) + limits.kept + row_bytes(limits, whole);
  if (!allows(enough))
    limits.refuse(what, surroundings.around({whole.x, whole.y, std::min(whole.width, kLeastColumns), 1}));
  while (enough - little > kMebibyte) {
    const std::uint64_t middle = little + (enough - little) / 2;
    (allows(middle) ? enough : little) = middle;
  }
  limits.refuse(what, enough);
}

}  // namespace alcove
