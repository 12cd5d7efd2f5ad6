// TOML files that are a flat list of keys and values: presets.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace alcove {

/// A key and its value, or its list's values, as they would be typed on a command line.
struct FlatEntry {
  std::string key;
  std::vector<std::string> values;
};

/// The entries in the order of the file's keys. Fails with ErrorKind::usage, with line and reason, on text that is no
/// TOML and on tables.
std::vector<FlatEntry> parse_flat_toml(const std::string& text);

}  // namespace alcove
