// Planes whose files have another data window than the depth.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/frame/gbuffer.h"

namespace alcove {

/// Fails with ErrorKind::input where channels, what they hold and the option that names them, share no pixel with the
/// depth, or have another data window than it and another display window too, since nothing then tells which pixels
/// belong together. Notes another data window; `without` says what holds where one of them has no pixels.
void require_common_window(FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                           const char* option, const char* without);

/// A channel and its destination.
struct ChannelRead {
  ChannelRef channel;
  float* to;
};

/// Reads rows of source.file_data, from `top` on. Every part of every file is decoded once. Channels have 0 where their
/// files have no pixels.
void read_rows(FrameSource& source, std::span<const ChannelRead> reads, int top, int rows);

/// Puts what changes nothing into the pixels of a plane over source.data that its files do not have: AO 1 of materials,
/// no object of a matte. Of all other planes that is the 0 that is there.
void fill_missing(const FrameSource& source, RawPlane plane, std::span<float> values);

}  // namespace alcove
