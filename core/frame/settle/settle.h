// Settles a frame: the pixels decide the questions that settings and camera leave open (kind and sign of depth, space
// and encoding of normals), and show faults.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/reading.h"

namespace alcove {

/// Settles the open questions of `source` by its depth and normals, and adds to its notes. Never overrules the settings
/// or the camera file. Fails with ErrorKind::input if the pixels speak for two readings or against all, and names the
/// options that decide; under settings.strict, on every guess. Fails with ErrorKind::usage if near or far are missing.
void settle(FrameSource& source, const InputSettings& settings, const RawPart& raw);
/// Does the same, with the evidence in `seen` instead of the source; if it fails, `seen` has the evidence so far.
void settle(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen);

/// The most pixels for settling a frame.
constexpr std::size_t kEvidencePixels = std::size_t(1) << 24;

/// Settles a frame by planes of all its pixels. If they are more than kEvidencePixels, or their results take more than
/// `most_bytes`, rows from the middle decide. Fails as settle() does.
void settle_by_planes(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                      std::span<const float> normal,
                      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Reads the planes itself: all rows, or as many from the middle as fit into `most_bytes`. Fails with ErrorKind::device
/// too, if a single row holds more than kEvidencePixels.
void settle_by_rows(FrameSource& source, const InputSettings& settings,
                    std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Settles a frame as another one of its sequence is settled. Returns false if it has other planes: then it must be
/// settled by itself.
bool settle_like(FrameSource& source, const FrameSource& settled);

/// Does the same for a frame of disparity with an unknown shift. If its own normals prove another shift, it is settled
/// by itself, with a note. It reads as settle_by_rows() does. Returns whether it is settled like the other frame.
bool settle_like_or_alone(FrameSource& source, const FrameSource& settled, const InputSettings& settings,
                          std::uint64_t most_bytes);

/// Whether the normals are vectors in x, y and z, so that they have lengths.
bool has_lengths(const FrameSource& source);

/// The word of --normal-encoding for normals of a frame that is settled.
const char* encoding_name(NormalEncoding encoding, bool unorm);

/// Settles encoding and space of the normals of a frame whose depth is settled. Refuses
/// normals that depth and camera refute.
void settle_normals(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen);

/// Notes a principal point beside the centre that the pixels neither confirm nor refute.
void note_centre(FrameSource& source);

}  // namespace alcove
