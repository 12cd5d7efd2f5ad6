// The pass of positions of a frame's file: its points tell the camera, or check it and the depth.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/frame/camera/resection.h"
#include "core/frame/find/frame_source.h"

namespace alcove {

/// Finds the three channels of a frame's positions: its depth, if that is positions; else the channels in its file that
/// the option, the rules or their usual names tell. Gives none if there are none, or if their windows differ. They may
/// have another window than the depth.
std::vector<ChannelRef> find_positions(const ChannelSearch& search, const FrameSource& source,
                                       const InputSettings& settings);

/// The bands of rows that are read of positions: to solve a camera, and to check one.
inline constexpr int kManyBands = 48, kFewBands = 4;

/// Gives up to 48 points of source.channels.positions in each band of rows, well spread over the picture: a pixel with
/// smooth surroundings of each place, so that neither edges nor filters matter. Sky has no points: 0, not finite,
/// beyond `sky`, or the same in all pixels about. Reads every part of the file's rows once, and no more of them than it
/// needs.
std::vector<SeenPoint> points_of(FrameSource& source, double sky, int bands);

/// Explains why points are no positions of the scene: cut, stretched, or seen through a lens that bends lines; ""
/// without an explanation. Refuses panoramas.
std::string fault_of_positions(std::span<const SeenPoint> points, const ExrFile& file,
                               const std::variant<Resection, NoResection>& found);

/// Points of a few bands, if the camera or the depth can be held against them; none if not.
std::vector<SeenPoint> points_to_check(FrameSource& source, double sky);

/// Compares the camera with these points of the positions. Notes a lens or a place that they refute by pixels, and
/// gives the note's text; "" if they do not. Refuses panoramas.
std::string settle_camera(FrameSource& source, const InputSettings& settings, std::span<const SeenPoint> points);

/// Gives the kind by which the depth is that of the positions beside it: planar, ray or inverse. Gives none if there
/// are no positions, or if more than one kind fits.
std::optional<DepthKind> kind_by_positions(const FrameSource& source, const InputSettings& settings, const RawPart& raw,
                                           std::span<const SeenPoint> points);

/// Notes depth, as it is read, that is not that of the positions beside it: in another unit, from another plane, or
/// neither. Says nothing where the camera does not see the positions where they are.
void check_by_positions(FrameSource& source, const InputSettings& settings, const RawPart& raw,
                        std::span<const SeenPoint> points);

}  // namespace alcove
