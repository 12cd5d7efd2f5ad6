// Cameras as a file for --camera.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "core/frame/camera.h"

namespace alcove {

/// The text of a camera file that read_camera() reads back: of a frame by itself, or of a sequence with its `frames`,
/// by number.
std::string camera_file(const Camera& camera);
std::string camera_file(const std::map<int, Camera>& cameras);

}  // namespace alcove
