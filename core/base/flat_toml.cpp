// Flat TOML.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/flat_toml.h"

#include "core/base/error.h"
#include "core/base/toml.h"

namespace alcove {
namespace {

std::string typed(const std::string& key, const toml::node& node) {
  if (const auto text = node.value_exact<std::string>(); text && text->find('\0') == text->npos) return *text;
  if (const auto number = node.value_exact<std::int64_t>()) return fmt::format("{}", *number);
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  if (const auto flag = node.value_exact<bool>()) return *flag ? "true" : "false";
  fail(ErrorKind::usage, "line {}: {} must be a string without a zero byte, a number, true, false or a list of them",
       node.source().begin.line, key);
}

}  // namespace

std::vector<FlatEntry> parse_flat_toml(const std::string& text) {
  std::vector<FlatEntry> entries;
  for (const auto& [key, node] : parse_toml(text)) {
    FlatEntry entry{std::string(key.str()), {}};
    if (const auto* list = node.as_array())
      for (const auto& value : *list) entry.values.push_back(typed(entry.key, value));
    else
      entry.values.push_back(typed(entry.key, node));
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace alcove
