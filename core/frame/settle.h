// Decides by the pixels what settings and camera leave open about a frame: kind and sign of depth, space and encoding
// of normals.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/base/settings.h"
#include "core/frame/gbuffer.h"

namespace alcove {

/// Settles what is open in `source`, from the planes of depth and normals as they were read, and adds to its guesses
/// and notes. What the settings or the camera file say is never overruled. Fails with ErrorKind::input where the pixels
/// speak for two ways or against all, naming the options that decide; under settings.strict, wherever there is a guess.
/// Near or far that are missing are ErrorKind::usage.
void settle(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
            std::span<const float> normal);

/// The most pixels that a frame is settled by.
constexpr std::size_t kEvidencePixels = std::size_t(1) << 24;

/// Settles a frame by planes that are there, over source.data. Where so many bytes, or kEvidencePixels, are too few for
/// what is made of them, rows from the middle decide. Fails as settle() does.
void settle_by_planes(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                      std::span<const float> normal,
                      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Does the same by planes that it reads itself: of all rows, or of those from the middle that so many bytes have room
/// for. Fails with ErrorKind::device too where a single row holds more than kEvidencePixels.
void settle_by_rows(FrameSource& source, const InputSettings& settings,
                    std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Settles a frame as another one of its sequence is settled. False: it has other planes, so it must be settled by
/// itself.
bool settle_like(FrameSource& source, const FrameSource& settled);

/// Whether depth of this kind may be stored as integers: see step_of().
bool has_step(DepthKind kind);

}  // namespace alcove
