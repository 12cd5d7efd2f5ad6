// What a frame's files hold, how `run` would understand them and why, and what is missing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/inspect/inspection.h"

namespace alcove {

/// Opens the files that the settings name and reads depth and normals. What `run` would refuse is part of the answer;
/// only a file whose header cannot be read fails, with ErrorKind::input.
Inspection inspect_frame(const InputSettings& settings, int frame);

}  // namespace alcove
