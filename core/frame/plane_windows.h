// Planes whose files have another data window than the depth, or are of a picture that is so many times smaller.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/frame/gbuffer.h"

namespace alcove {

/// How many pixels of the depth, in x and in y, are one of a beauty's: what the option says, or with auto as their
/// display windows have it, and 1 where they are of no such size. Fails with ErrorKind::input where the depth's window
/// cannot be divided so, or the beauty's is another.
int supersampling_of(const FrameSource& source, const ChannelRef& beauty, const InputSettings& settings);
/// The same without a beauty: 1 with auto.
int supersampling_of(const FrameSource& source, const InputSettings& settings);

/// Fails with ErrorKind::input where channels, what they hold and the option that names them, have another data window
/// than the depth and no pixel in common with it, or another display window, which alone shows which pixels belong
/// together. A renderer may have cut each plane to its own pixels that are not 0.
void require_same_picture(const FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                          const char* option);

/// Fails with ErrorKind::input where channels, what they hold and the option that names them, share no pixel with the
/// depth, or have another data window than it and a display window that is neither its own nor the picture's, since
/// nothing then tells which pixels belong together. Notes another data window; `without` says what holds where one of
/// them has no pixels.
void require_common_window(FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                           const char* option, const char* without);

/// A channel and its destination.
struct ChannelRead {
  ChannelRef channel;
  float* to;
};

/// Reads rows of source.file_data, from `top` on. Every part of every file is decoded once. Where their files have no
/// pixels, normals and what lies behind are NaN, which is none in any encoding, and all else is 0. Channels of the
/// smaller picture have their value in all pixels of a block.
void read_rows(FrameSource& source, std::span<const ChannelRead> reads, int top, int rows);

/// Puts what changes nothing into the pixels of a plane over source.data that its files do not have: AO 1 of materials,
/// no object of a matte. Of all other planes that is the 0 that is there.
void fill_missing(const FrameSource& source, RawPlane plane, std::span<float> values);

}  // namespace alcove
