// By what a run with --resume knows that a file was made with the options of today.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"

namespace alcove {

/// 16 hexadecimal digits that change with every setting that changes the result, and with what the camera file says.
/// Fails as reading that file does.
std::string options_digest(const Settings& settings);

}  // namespace alcove
