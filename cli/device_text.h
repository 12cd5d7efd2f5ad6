// A device as `alcove devices` and `alcove doctor` show it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/gpu/device_info.h"

namespace alcove {

/// One line without its end.
std::string text_of(const gpu::DeviceInfo& device);

/// The fields of docs/json.md.
nlohmann::ordered_json json_of(const gpu::DeviceInfo& device);

}  // namespace alcove
