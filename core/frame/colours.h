// Tells a picture of colours, normals or positions from depth, where the depth channel is one of three.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/frame/gbuffer.h"

namespace alcove {

/// Looks at the two channels beside a depth channel that was found by a usual name and not by the user's. R is depth
/// where R, G and B are a grey picture, or G and B are empty. Fails with ErrorKind::input where they are a picture of
/// colours; adds a suspicious note where they are one in a layer that is called depth, and where the depth is the Z of
/// X, Y and Z. Reads a few rows where there are two such channels, and nothing else.
void doubt_depth_of_three(FrameSource& source, const ChannelSearch& search, const ChannelRef& depth);

}  // namespace alcove
