// What a run would do, for people.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"

namespace alcove {

/// The frames, files, size and memory of a run. Opens the headers of the first frame, and no device.
std::string plan_text(const Settings& settings);

}  // namespace alcove
