// Reads TOML: tables, and flat lists of keys and values, as presets are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <toml++/toml.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace alcove {

/// Gives the tables of a text in UTF-8. A key's letters beyond ASCII, and its %, become %xx for each of their bytes.
/// Fails with ErrorKind::usage on text that is no TOML, naming line and reason.
toml::table parse_toml(const std::string& text);

/// The same of a file; `what` it should be, and the option that names it, are for messages. Fails with
/// ErrorKind::input.
toml::table read_toml(const std::string& path, const char* what, const char* option);

/// A key with its value, or with the values of its list, as typed on a command line.
struct FlatEntry {
  std::string key;
  std::vector<std::string> values;
};

/// Gives the entries in the order of the file's keys. Fails as parse_toml() does, and on tables.
std::vector<FlatEntry> parse_flat_toml(const std::string& text);

/// A table of a file; every complaint is ErrorKind::input, and names file, table and key.
struct TomlTable {
  std::string path, name;
  const toml::table& values;

  [[noreturn]] void refuse(std::string_view key, const char* why) const;
  std::string text(std::string_view key) const;  // not empty
  double number(std::string_view key) const;     // finite
  double positive(std::string_view key) const;
  int count(std::string_view key, int otherwise, int least) const;
  void require_keys(const std::set<std::string>& known) const;
};

/// Calls `use` for each table of a list of tables, if the file has the list.
template <class Use>
void for_each_table(const std::string& path, const toml::table& root, const char* key, Use use) {
  if (!root.contains(key)) return;
  const auto* list = root[key].as_array();
  if (!list) fail(ErrorKind::input, "{}: [[{}]] must be a list of tables", path, key);
  int number = 0;
  for (const auto& entry : *list) {
    const auto* values = entry.as_table();
    if (!values) fail(ErrorKind::input, "{}: [[{}]] must be a list of tables", path, key);
    use(TomlTable{path, fmt::format("[[{}]] {}", key, ++number), *values});
  }
}

/// Fails with ErrorKind::input on a list without entries, and on one with two entries of one name.
template <class List>
void require_unique_names(const std::string& path, const List& list, const char* what) {
  std::set<std::string> names;
  for (const auto& entry : list)
    if (!names.insert(entry.name).second) fail(ErrorKind::input, "{}: two {}s are called {}", path, what, entry.name);
  if (names.empty()) fail(ErrorKind::input, "{}: there is no [[{}]]", path, what);
}

}  // namespace alcove
