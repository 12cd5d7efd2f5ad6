// The check of settings before any file or device is opened.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"

namespace alcove {

/// Fails with ErrorKind::usage on settings that contradict each other. It opens no input and no device.
void check_settings(const Settings& settings);

}  // namespace alcove
