// The composite of a beauty whose data window is not the depth's: AO where both have pixels, the beauty elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/formats/exr.h"
#include "core/frame/gbuffer.h"

namespace alcove {

/// The window of a frame's composite: the beauty's, or the part of a region that the beauty has.
Window composite_window(const FrameSource& source);

/// The composite over a part of its window, so many planes: where `from` has pixels those of `planes`, elsewhere the
/// beauty's, which are read then, and 1 in a plane of AO behind them. Fails as reading a frame does.
std::vector<std::vector<float>> composite_over(FrameSource& source, std::size_t count, const Window& part,
                                               const Window& from, std::span<const std::span<const float>> planes);

/// The bytes that putting it together takes beside what is computed; 0 where its window is that of the AO.
std::uint64_t composite_bytes(const FrameSource& source);

/// Writes the next rows of a composite, plane by plane.
using WriteRows = std::function<void(std::span<const std::span<const float>>)>;

/// Puts the rows of the composite's window into its file while those of another window are computed.
class CompositeRows {
 public:
  /// The source must stay. `computed` is the window of the rows that come, of so many planes.
  CompositeRows(FrameSource& source, const Window& computed, std::size_t planes);

  /// The next computed rows, as wide as that window; the beauty's rows above them go first.
  void write(std::span<const std::span<const float>> planes, const WriteRows& write_rows);
  /// The beauty's rows below all computed ones.
  void finish(const WriteRows& write_rows);

 private:
  void write_until(int bottom, const Window& from, std::span<const std::span<const float>> planes,
                   const WriteRows& write_rows);

  FrameSource& source_;
  const Window computed_, window_;
  const std::size_t planes_;
  int computed_row_, row_;  // the next ones
};

}  // namespace alcove
