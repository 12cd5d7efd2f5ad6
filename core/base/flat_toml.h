// Reads TOML files that are a flat list of keys and values, as presets are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace alcove {

/// A key with its value, or with the values of its list, as typed on a command line.
struct FlatEntry {
  std::string key;
  std::vector<std::string> values;
};

/// Gives the entries in the order of the file's keys. Fails with ErrorKind::usage on text that is no TOML and on
/// tables, naming line and reason.
std::vector<FlatEntry> parse_flat_toml(const std::string& text);

}  // namespace alcove
