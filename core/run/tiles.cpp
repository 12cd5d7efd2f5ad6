// Cuts frames by what their tiles take with their surroundings.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/tiles.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/base/system.h"
#include "kernels/profile.h"

namespace alcove {
namespace {

constexpr int kLeastRows = 16;     // px of a tile: most files compress so many rows together
constexpr int kLeastColumns = 64;  // px of a tile

std::uint64_t mebibytes_above(std::uint64_t bytes) { return (bytes + kMebibyte - 1) / kMebibyte; }

/// The bytes of a row of results that is put together from tiles, and of its encoded twin.
std::uint64_t row_bytes(const WindowLimits& limits, const Window& row) {
  return 2 * limits.memory.written * row.pixels();
}

int most_columns(const Window& row) { return std::max(1, row.width / kLeastColumns); }

/// So many tiles, whose widths differ by a pixel at most.
std::vector<Window> columns_of(const Window& row, int count) {
  std::vector<Window> tiles;
  for (int i = 0; i < count; i++) {
    const int left = int(std::int64_t(row.width) * i / count), right = int(std::int64_t(row.width) * (i + 1) / count);
    tiles.push_back({row.x + left, row.y, right - left, row.height});
  }
  return tiles;
}

/// Cuts a window into columns, or into halves that are cut in turn, whichever computes fewer pixels.
class Cutter {
  static constexpr std::uint64_t kNoWay = std::numeric_limits<std::uint64_t>::max();
  struct Cut {
    TileRows rows;
    std::uint64_t pixels = kNoWay;  // that are computed
  };

 public:
  Cutter(Surroundings& surroundings, const WindowLimits& limits) : surroundings_(surroundings), limits_(limits) {}

  /// No way where one of the smallest tiles is still too large.
  Cut cut(const Window& window) {
    Cut best = in_columns(window);
    if (window.height <= kLeastRows || (best.pixels != kNoWay && best.rows[0].size() == 1)) return best;
    const int upper = (window.height / kLeastRows + 1) / 2 * kLeastRows;
    Cut halves = cut({window.x, window.y, window.width, upper});
    if (halves.pixels >= best.pixels) return best;
    Cut lower = cut({window.x, window.y + upper, window.width, window.height - upper});
    if (lower.pixels >= best.pixels - halves.pixels) return best;
    halves.pixels += lower.pixels;
    std::ranges::move(lower.rows, std::back_inserter(halves.rows));
    return halves;
  }

 private:
  /// As few columns as are allowed, for each more makes a border; no way where even the narrowest are not.
  Cut in_columns(const Window& row) {
    const int most = most_columns(row);
    for (int count = 1;; count = std::min(most, count + (count + 1) / 2)) {
      Cut cut{{columns_of(row, count)}, 0};
      const auto is_allowed = [&](const Window& tile) {
        const Window computed = surroundings_.around(tile);
        cut.pixels += computed.pixels();
        return limits_.allow(computed, row_bytes(limits_, row));
      };
      if (std::ranges::all_of(cut.rows[0], is_allowed)) return cut;
      if (count == most) return {};
    }
  }

  Surroundings& surroundings_;
  const WindowLimits& limits_;
};

/// What has to be computed for that one of the smallest tiles that needs the most around it.
Window largest_least(const Window& whole, Surroundings& surroundings) {
  Window largest{};
  for (int y = 0; y < whole.height; y += kLeastRows)
    for (const auto& tile :
         columns_of({whole.x, whole.y + y, whole.width, std::min(kLeastRows, whole.height - y)}, most_columns(whole)))
      if (const Window window = surroundings.around(tile); window.pixels() > largest.pixels()) largest = window;
  return largest;
}

}  // namespace

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
  const std::uint64_t enough = memory.of(source.file_data).host + (source.region ? limits.kept : 0);
  refuse(fmt::format("{}: its pixels take {} MiB as they are read: use a smaller frame", source.depth_path(),
                     mebibytes_above(limits.kept)),
         enough);
}

bool WindowLimits::allow(const Window& computed, std::uint64_t beside) const {
  if (computed.pixels() > room.pixels || std::max(computed.width, computed.height) > longest_side) return false;
  const FrameMemory::Bytes bytes = memory.of(computed);
  return bytes.host + kept + beside <= room.bytes && bytes.device <= room.device_bytes &&
         bytes.buffer <= room.buffer_bytes;
}

std::string WindowLimits::why_not(const Window& computed) const {
  if (std::max(computed.width, computed.height) > longest_side)
    return fmt::format("lines of an exact search have at most {} pixels", longest_side);
  const FrameMemory::Bytes bytes = memory.of(computed);
  if (bytes.host + kept > room.bytes)
    return fmt::format("{} leaves {} MiB for it, and at once it takes {} MiB",
                       room.is_chosen ? "--memory" : "half of the free memory", (room.bytes - kept) / kMebibyte,
                       mebibytes_above(bytes.host));
  if (bytes.buffer > room.buffer_bytes)
    return fmt::format("the device takes buffers of {} MiB at most", room.buffer_bytes / kMebibyte);
  return "the device has too little memory for it at once";
}

void WindowLimits::refuse(const std::string& what, const Window& computed) const {
  const std::uint64_t bytes = memory.of(computed).host + kept;
  if (bytes > room.bytes) refuse(what, bytes);
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
  if (auto cut = Cutter(surroundings, limits).cut(whole); !cut.rows.empty()) return std::move(cut.rows);
  const std::string what = fmt::format(
      "{}: within --radius a tile of the frame depends on too many pixels to compute at once: use a smaller --radius",
      source.depth_path());
  const Window largest = largest_least(whole, surroundings);
  const Window row{whole.x, whole.y, whole.width, std::min(whole.height, kLeastRows)};
  const std::uint64_t of_tiles = limits.memory.of(largest).host + limits.kept + row_bytes(limits, row);
  if (of_tiles <= limits.room.bytes) limits.refuse(what, largest);
  // All of it at once may take less than such tiles.
  const std::uint64_t at_once = limits.memory.of(surroundings.around(whole)).host + (source.region ? limits.kept : 0);
  limits.refuse(what, std::min(of_tiles, at_once));
}

}  // namespace alcove
