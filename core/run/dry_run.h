// What a run would do, for people.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"

namespace alcove {

/// The frames, files, size and memory of a run. Computes and writes nothing. Fails as the run would on settings, names,
/// and a single frame that cannot be read as it is.
std::string plan_text(const Settings& settings);

}  // namespace alcove
