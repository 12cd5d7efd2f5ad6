// Cameras of .chan files, which Nuke, Maya, Houdini and Blender write.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "core/frame/camera.h"

namespace alcove {

/// Whether a file is one by its name.
bool is_chan_file(const std::string& path);

/// Reads a .chan file: a line for each frame, of its number, the place x y z, the angles x y z in degrees and the
/// vertical field of view in degrees. `rotation`: the axes in the order in which
/// the angles turn the camera, such as zxy (Nuke's). The camera looks along -z, with y up; its projection is centred on
/// the display window. Fails with ErrorKind::input, naming file, frame and what is wrong.
Camera read_chan(const std::string& path, int frame, const std::string& rotation, const Window& display,
                 double pixel_aspect);

/// The rotation from the world to a camera's space, of angles about x, y and z in radians.
Matrix3 view_by_angles(const Vector3& angles, const std::string& rotation);

/// The orders in which a camera may be turned about the axes.
inline constexpr std::array kChanRotations{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};

/// Fails with ErrorKind::input where the file has no line of this frame.
void require_in_chan(const std::string& path, int frame);

}  // namespace alcove
