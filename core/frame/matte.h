// Where AO is wanted, and what makes it: finds the planes of --matte, occluders and ignore, and what they mean.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/frame/gbuffer.h"

namespace alcove {

/// Finds the matte where the settings ask for one, in --matte or else in INPUT. Without objects it is a plane of
/// coverage. With objects it is what they cover in a Cryptomatte: names, in which * and ? stand for others, are looked
/// up in its manifest, and are taken as they are where there is none. With matte-channel of another channel objects
/// are its numbers. Fails with ErrorKind::input, naming the file and what it has, where nothing is found, and where
/// the matte has another window than the depth.
void find_matte(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

/// Finds what tells occluders from the rest, where the settings ask for it: a file of coverage; or objects, in
/// the file of objects or else in INPUT, as above, where numbers need no object-channel if it has a usual name. Fails
/// alike.
void find_occluders(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

}  // namespace alcove
