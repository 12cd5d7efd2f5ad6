// The views of stereo files: as parts, and as words of channels' names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/exr.h"

namespace alcove {

/// Whether two names are one: case does not count.
bool same_name(std::string_view a, std::string_view b);

/// Gives the views of a stereo file, the default first; any other file has none.
std::vector<std::string> views_of(const ExrFile& file);

/// The view that a file is read by: the wanted one if the file has it, else its default one; "" where it has no views.
std::string view_in(const ExrFile& file, const std::string& wanted);

/// The view of a channel. `multiView` lists views that stand before the last word of names ("depth.right.Z"), or are
/// the first word, as Nuke writes them ("right.depth.Z"); without such a word a channel is of the first of them. Else
/// the view is that of the part, "" where it has none.
std::string view_of(const ExrPart& part, const std::string& channel);

/// Gives a channel's name without its view; nothing if it is of another view. Channels of parts without views belong to
/// all.
std::optional<std::string> name_in_view(const ExrPart& part, const std::string& channel, const std::string& view);

/// The name of a part without its view: "depth.left" and "left.depth" of the view "left" are the layer "depth".
std::string layer_of(const ExrPart& part);

}  // namespace alcove
