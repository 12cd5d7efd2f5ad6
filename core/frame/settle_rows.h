// Settles a frame by some of its rows, where not all of them are in memory.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/frame/frame_rows.h"
#include "core/frame/settle.h"

namespace alcove {

/// The most pixels that a frame is settled by.
constexpr std::size_t kEvidencePixels = std::size_t(1) << 24;

/// Settles a frame of any size, by planes that it reads itself: all of the frame, or as many rows from its middle as
/// hold `most_pixels`. Fails as settle() and require_rows() do.
void settle_by_rows(FrameSource& source, const InputSettings& settings, std::size_t most_pixels = kEvidencePixels);

/// Does the same by planes that are there, over source.data.
void settle_by_planes(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                      std::span<const float> normal, std::size_t most_pixels = kEvidencePixels);

/// Settles a frame by the rows of a part of it. Where they leave anything open that other rows may show, or are
/// refused, rows above and below are read too, up to the whole frame or to `most_pixels`: so a part is read as the
/// whole would be. Fails as settle() does.
void settle_by_part(FrameSource& source, const InputSettings& settings, FrameRows& rows, const Window& part,
                    std::size_t most_pixels = kEvidencePixels);

}  // namespace alcove
