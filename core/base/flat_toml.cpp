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
  const std::size_t first = text.starts_with("\xef\xbb\xbf") ? 3 : 0;  // a byte order mark
  std::string closing;     // the end of the string or comment at hand; empty outside of both
  char last = '\n';        // the last character that is not a blank
  bool has_value = false;  // an = stands before, in this line or since a comma or brace
  int line = 1;
  for (std::size_t i = first; i < text.size(); i++) {
    const char c = text[i];
    line += c == '\n';
    if (closing.empty() && (unsigned char)c >= 0x80)
      fail(ErrorKind::usage, "line {}: letters beyond ASCII stand in quotes only", line);
    // toml++ goes on within such a value, and takes what is in quotes for letters.
    if (closing.empty() && c == '=' && has_value) fail(ErrorKind::usage, "line {}: a second = stands in a value", line);
    if (closing.empty() && std::string_view("=,{").find(c) != std::string_view::npos) has_value = c == '=';
    if (closing.size() <= 1 && c == '\n') has_value = false;  // the end of a comment, too
    if (closing.empty() && (c == '"' || c == '\'')) {
      // toml++ takes a quote within a word for a letter, and the text behind it for more letters.
      if (std::string_view("\n=[,{.").find(last) == std::string_view::npos)
        fail(ErrorKind::usage, "line {}: a quote stands within a word", line);
      const bool is_long = text.compare(i, 3, std::string(3, c)) == 0;
      closing = std::string(is_long ? 3 : 1, c);
      i += closing.size() - 1;
    } else if (closing.empty() && c == '#') {
      closing.assign(1, '\n');
    } else if (!closing.empty() && c == '\\' && closing[0] == '"') {
      // toml++ asks of it whether it is a blank, by a table that not all letters are in.
      if (i + 1 < text.size() && (unsigned char)text[i + 1] >= 0x80)
        fail(ErrorKind::usage, "line {}: a backslash stands before a letter beyond ASCII", line);
      i++;
    } else if (!closing.empty() && text.compare(i, closing.size(), closing) == 0) {
      i += closing.size() - 1;
      // A long string may end with two quotes of its own.
      for (int k = 0; closing.size() == 3 && k < 2 && i + 1 < text.size() && text[i + 1] == closing[0]; k++) i++;
      closing.clear();
    } else if (closing.size() == 1 && c == '\n') {
      closing.clear();
    }
    if (c != ' ' && c != '\t' && c != '\r') last = c;
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
