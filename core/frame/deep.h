// What the samples of deep files are for a frame: its depth, or surfaces behind it; and how their depth is read.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "core/frame/gbuffer.h"

namespace alcove {

/// The deep parts that --layer and --view choose, whose samples count together: of a part's name, or else all of the
/// view; empty where the file has none.
std::vector<int> deep_parts_of(const ExrFile& file, const std::string& layer, const std::string& view);

/// Whether all parts of a file are deep.
bool is_all_deep(const ExrFile& file);

/// The frame's depth where deep samples are it: the file at `depth_file` holds nothing else, or there is --deep and
/// that file has no flat depth. Else nothing.
std::vector<ChannelRef> find_deep_depth(FrameSource& source, ChannelSearch& search, std::size_t depth_file,
                                        const InputSettings& settings);

/// Adds the planes behind the first surface that samples give, once the depth is found. Fails with ErrorKind::input
/// where the file of --deep is flat, or has another window than the depth.
void find_deep(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

/// Which samples of these parts are surfaces, for a frame whose camera is known.
DeepRules deep_rules(const FrameSource& source, const ExrFile& file, const std::vector<int>& parts,
                     const InputSettings& settings);

/// Opens the samples, once the camera is found, for it says how far apart two surfaces are in a pixel. Fails as
/// ExrFile::take_deep() does.
void take_deep(FrameSource& source, const InputSettings& settings);

/// Settles whether samples beside a flat depth are planar or along the ray, and their scale: their first surfaces are
/// those of the depth, which is as read, over source.data. Fails with ErrorKind::input where they are not. Tells too
/// whether they list what is hidden.
void settle_deep(FrameSource& source, std::span<const float> depth);

/// Reads the planes of samples as the frame's meaning says.
void read_deep_like_meaning(FrameSource& source);

/// Whether a plane of RawPlane::behind comes from samples.
bool is_deep_plane(const FrameSource& source, std::size_t plane);

/// What was repaired in the samples that were read.
Notes deep_notes(const FrameSource& source);

}  // namespace alcove
