// Flat TOML, through toml++.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/flat_toml.h"

#include <toml++/toml.h>

#include <string_view>

#include "core/base/error.h"

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

void require_ascii_keys(const std::string& text) {
  const std::size_t first = text.starts_with("\xef\xbb\xbf") ? 3 : 0;  // a mark of the byte order
  std::string within;  // what ends the string or the comment that it is in
  char before = '\n';  // the last character that is no blank
  int line = 1;
  for (std::size_t i = first; i < text.size(); i++) {
    const char c = text[i];
    line += c == '\n';
    if (within.empty() && (unsigned char)c >= 0x80)
      fail(ErrorKind::usage, "line {}: letters beyond ASCII stand in quotes only", line);
    if (within.empty() && (c == '"' || c == '\'')) {
      // Within a word toml++ takes it for a letter of that, and what follows for more of them.
      if (std::string_view("\n=[,{.").find(before) == std::string_view::npos)
        fail(ErrorKind::usage, "line {}: a quote stands within a word", line);
      const bool is_long = text.compare(i, 3, std::string(3, c)) == 0;
      within = std::string(is_long ? 3 : 1, c);
      i += within.size() - 1;
    } else if (within.empty() && c == '#') {
      within.assign(1, '\n');
    } else if (!within.empty() && c == '\\' && within[0] == '"') {
      i++;
    } else if (!within.empty() && text.compare(i, within.size(), within) == 0) {
      i += within.size() - 1;
      // A long string may end with two quotes of its own.
      for (int k = 0; within.size() == 3 && k < 2 && i + 1 < text.size() && text[i + 1] == within[0]; k++) i++;
      within.clear();
    } else if (within.size() == 1 && c == '\n') {
      within.clear();
    }
    if (c != ' ' && c != '\t' && c != '\r') before = c;
  }
}

std::vector<FlatEntry> parse_flat_toml(const std::string& text) {
  require_ascii_keys(text);
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    fail(ErrorKind::usage, "line {}: {}", error.source().begin.line, error.description());
  }
  std::vector<FlatEntry> entries;
  for (const auto& [key, node] : root) {
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
