// Reads TOML.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <toml++/toml.h>

#include <string>

namespace alcove {

/// Gives the tables of a text in UTF-8. A key's letters beyond ASCII, and its %, become %xx for each of their bytes.
/// Fails with ErrorKind::usage on text that is no TOML, naming line and reason.
toml::table parse_toml(const std::string& text);

}  // namespace alcove
