// The digest of options, by which --resume knows whether a file was made with the options of this run.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"

namespace alcove {

/// 16 hexadecimal digits that change with every setting that changes the result, as the table of options says, and with
/// what the camera file and the configuration of the display say. Fails as reading those files does.
std::string options_digest(const Settings& settings);

/// Whether the preview is the composite as a display shows it, and not the AO as data.
bool shows_composite(const OutputSettings& output);

}  // namespace alcove
