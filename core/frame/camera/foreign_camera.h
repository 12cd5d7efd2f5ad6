// Knows the camera files of other programs, which --camera does not take.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace alcove {

/// Names the program of a foreign camera file, and the way to give its camera to Alcove. "" for any other text.
std::string why_foreign_camera(const std::string& text);

}  // namespace alcove
