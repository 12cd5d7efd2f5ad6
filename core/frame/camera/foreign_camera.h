// Knows the camera files of other programs, which --camera does not take.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace alcove {

/// Says what a camera file of another program is, and how its camera is given to Alcove. "" for any other text.
std::string why_foreign_camera(const std::string& text);

}  // namespace alcove
