// Reads the keys of presets as options.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/presets.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/flat_toml.h"
#include "core/base/text.h"

namespace alcove {
namespace {

/// The settings in the text of a preset. The rules of presets/input are known to the program: such a preset is its
/// --source and no more.
std::vector<FlatEntry> settings_in(const std::string& text) {
  auto entries = parse_flat_toml(text);
  if (std::ranges::find(entries, "detect", &FlatEntry::key) != entries.end())
    std::erase_if(entries, [](const auto& entry) { return entry.key != "source"; });
  return entries;
}

/// The row that an entry is for.
const OptionRow& row_of(const FlatEntry& entry, const std::vector<OptionRow>& table) {
  const OptionRow& row = row_of_key(table, entry.key);
  if (entry.values.empty()) fail(ErrorKind::usage, "{}: the list is empty", entry.key);
  if (entry.values.size() > 1 && !row.repeats)
    fail(ErrorKind::usage, "{} takes one value, and the list has {}", entry.key, entry.values.size());
  return row;
}

}  // namespace

std::vector<Said> said_by_text(const std::string& preset, const std::string& text,
                               const std::vector<OptionRow>& table) {
  std::vector<Said> said;
  try {
    for (const auto& entry : settings_in(text))
      said.push_back({row_of(entry, table).long_name(), entry.values, preset});
  } catch (const Error& error) {
    fail(error.kind(), "{} (--preset): {}", preset, error.what());
  }
  return said;
}

}  // namespace alcove
