// The composite of a beauty whose data window is not the depth's: AO where both have pixels, the beauty elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/formats/exr.h"
#include "core/frame/gbuffer.h"

namespace alcove {

/// The window of a frame's composite: the beauty's, or the part of a region that the beauty has.
Window composite_window(const FrameSource& source);

/// The composite over a part of its window, plane by plane: where `from` has pixels those of `planes`, elsewhere the
/// beauty's, which are read then. Fails as reading a frame does.
std::vector<std::vector<float>> composite_over(FrameSource& source, const Window& part, const Window& from,
                                               std::span<const std::span<const float>> planes);

/// The bytes that putting it together takes beside what is computed; 0 where its window is that of the AO.
std::uint64_t composite_bytes(const FrameSource& source);

/// Puts the rows of the composite's window into its file while those of another window are computed.
class CompositeRows {
 public:
  /// Both must stay. `computed` is the window of the rows that come.
  CompositeRows(FrameSource& source, const Window& computed, ExrWriter& file);

  /// The next computed rows, as wide as that window; the beauty's rows above them go first.
  void write(std::span<const std::span<const float>> planes);
  /// The beauty's rows below all computed ones.
  void finish();

 private:
  void write_until(int bottom, const Window& from, std::span<const std::span<const float>> planes);

  FrameSource& source_;
  ExrWriter& file_;
  const Window computed_, window_;
  int computed_row_, row_;  // the next ones
};

}  // namespace alcove
