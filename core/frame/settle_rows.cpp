// Chooses the rows that a frame is settled by.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle_rows.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace alcove {
namespace {

/// All that settle() may change about a frame.
class Unsettled {
 public:
  explicit Unsettled(const FrameSource& source)
      : reading_(source),
        usual_depth_kind_(source.usual_depth_kind),
        guesses_(source.guesses),
        notes_(source.notes),
        suspicious_(source.suspicious) {}

  void restore(FrameSource& source) const {
    static_cast<Reading&>(source) = reading_;
    source.usual_depth_kind = usual_depth_kind_;
    source.guesses = guesses_;
    source.notes = notes_;
    source.suspicious = suspicious_;
    source.settled = false;
  }

 private:
  Reading reading_;
  DepthKind usual_depth_kind_;
  std::vector<Guess> guesses_;
  Notes notes_, suspicious_;
};

/// So many rows from the middle of a part, or all that the files hold: they are moved where they would leave the files.
Window rows_around(const FrameSource& source, const Window& part, int rows) {
  const Window& data = source.file_data;
  rows = std::min(rows, data.height);
  const int top = std::clamp(part.y + (part.height - rows) / 2, data.y, data.y + data.height - rows);
  return {data.x, top, data.width, rows};
}

int rows_of(const FrameSource& source, std::size_t pixels) {
  const Window& data = source.file_data;
  return int(std::clamp<std::size_t>(pixels / std::size_t(data.width), 1, std::size_t(data.height)));
}

/// Whether the rest of the frame could hardly change how it is read. What the range of all depths decides, some rows do
/// not show: depths of 0 to 1 may go on beyond it, and negative ones may become positive. Rows of little but sky do not
/// show how the others are rounded.
bool is_clear(const FrameSource& source, std::span<const float> depth) {
  if (!source.has_evidence || (has_step(source.depth_kind) && !shows_step(depth))) return false;
  if (source.depth_kind == DepthKind::position || !source.depth_kind_open) return true;
  const bool is_beyond_one =
      std::ranges::any_of(depth, [&](float d) { return std::isfinite(d) && d > 1 && d < source.sky; });
  return is_beyond_one && !source.depth_range.negative;
}

/// Settles the frame by a window of its rows. Tells whether that will do; where it will not, the frame is as it was.
/// `is_last`: there are no more rows, so that it must do.
bool settles_by(FrameSource& source, const InputSettings& settings, const FrameRows& rows, const Window& window,
                bool is_last) {
  const Unsettled before(source);
  const Window data = source.data;
  std::vector<float> depth(source[RawPlane::depth].size() * window.pixels()),
      normal(source[RawPlane::normal].size() * window.pixels());
  rows.copy(source[RawPlane::depth], window, depth.data());
  rows.copy(source[RawPlane::normal], window, normal.data());
  source.data = window;
  try {
    settle(source, settings, depth, normal);
  } catch (const Error&) {
    if (is_last) throw;
    source.settled = false;
  }
  const bool will_do = is_last || (source.settled && is_clear(source, depth));
  if (!will_do) before.restore(source);
  source.data = data;
  return will_do;
}

}  // namespace

void settle_by_rows(FrameSource& source, const InputSettings& settings, std::size_t most_pixels) {
  const Window data = source.data;
  require_rows(source);
  source.data = rows_around(source, source.file_data, rows_of(source, most_pixels));
  std::vector<float> depth(source[RawPlane::depth].size() * source.data.pixels()),
      normal(source[RawPlane::normal].size() * source.data.pixels());
  read_planes(source, {{&source[RawPlane::depth], depth.data()}, {&source[RawPlane::normal], normal.data()}});
  settle(source, settings, depth, normal);
  source.data = data;
}

void settle_by_planes(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                      std::span<const float> normal, std::size_t most_pixels) {
  const Window data = source.data;
  if (data.pixels() <= most_pixels) return settle(source, settings, depth, normal);
  const Window window = rows_around(source, data, rows_of(source, most_pixels));
  const std::vector<float> some_depth = cropped(depth, data, window), some_normal = cropped(normal, data, window);
  source.data = window;
  settle(source, settings, some_depth, some_normal);
  source.data = data;
}

void settle_by_part(FrameSource& source, const InputSettings& settings, FrameRows& rows, const Window& part,
                    std::size_t most_pixels) {
  const int most = rows_of(source, most_pixels);
  for (int wanted = std::min(part.height, most);; wanted = std::min(2 * wanted, most)) {
    const Window window = rows_around(source, part, wanted);
    rows.need(window.y, window.y + window.height);
    if (settles_by(source, settings, rows, window, wanted == most)) return;
  }
}

}  // namespace alcove
