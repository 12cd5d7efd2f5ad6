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

/// Fails with ErrorKind::usage, naming the line, if letters beyond ASCII stand outside of quotes and comments, or a
/// quote stands within a word. TOML has neither, and toml++ 3 does undefined things with some of them.
void require_ascii_keys(const std::string& text);

/// Gives the entries in the order of the file's keys. Fails with ErrorKind::usage on text that is no TOML and on
/// tables, naming line and reason.
std::vector<FlatEntry> parse_flat_toml(const std::string& text);

}  // namespace alcove
