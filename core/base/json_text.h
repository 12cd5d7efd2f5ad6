// JSON as text, whatever bytes its strings hold.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace alcove {

/// The document in valid UTF-8, on one line or with `indent` spaces per level. Keys and strings may hold names of
/// files, which may be no UTF-8: as_utf8() escapes them.
std::string json_text(const nlohmann::ordered_json& json, int indent = -1);

}  // namespace alcove
