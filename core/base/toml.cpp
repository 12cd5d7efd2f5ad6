// TOML, through toml++.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/toml.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {
namespace {

/// The text with %xx for each % and each byte beyond ASCII. TOML allows such letters in strings and comments only, and
/// toml++ 3 does undefined things with others.
std::string in_ascii(std::string_view text) {
  std::string ascii;
  for (const unsigned char c : text)
    if (c < 0x80 && c != '%')
      ascii += char(c);
    else
      ascii += fmt::format("%{:02x}", c);
  return ascii;
}

std::string out_of_ascii(std::string_view ascii) {
  std::string text;
  for (std::size_t i = 0; i < ascii.size(); i++) {
    unsigned char byte = ascii[i];
    if (byte == '%' && i + 2 < ascii.size() &&
        std::from_chars(&ascii[i + 1], ascii.data() + i + 3, byte, 16).ec == std::errc())
      i += 2;
    text += char(byte);
  }
  return text;
}

int line_of(const std::string& text, std::size_t at) {
  return 1 + int(std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'));
}

void restore_letters(toml::node& node) {
  if (auto* text = node.as_string()) *text = out_of_ascii(text->get());
  if (auto* list = node.as_array())
    for (auto& entry : *list) restore_letters(entry);
  if (auto* table = node.as_table())
    for (auto&& [key, entry] : *table) restore_letters(entry);
}

std::string typed(const std::string& key, const toml::node& node) {
  if (const auto text = node.value_exact<std::string>(); text && text->find('\0') == text->npos) return *text;
  if (const auto number = node.value_exact<std::int64_t>()) return fmt::format("{}", *number);
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  if (const auto flag = node.value_exact<bool>()) return *flag ? "true" : "false";
  fail(ErrorKind::usage, "line {}: {} must be a string without a zero byte, a number, true, false or a list of them",
       node.source().begin.line, key);
}

}  // namespace

toml::table parse_toml(const std::string& text) {
  if (as_utf8(text) != text) fail(ErrorKind::usage, "the text is not UTF-8");
  // It would be taken for one of our own.
  for (const char* percent : {"\\u0025", "\\U00000025"})
    if (const std::size_t at = text.find(percent); at != text.npos)
      fail(ErrorKind::usage, "line {}: write % in place of {}", line_of(text, at), percent);
  try {
    toml::table root = toml::parse(in_ascii(text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text));
    restore_letters(root);
    return root;
  } catch (const toml::parse_error& error) {
    fail(ErrorKind::usage, "line {}: {}", error.source().begin.line, error.description());
  }
}

toml::table read_toml(const std::string& path, const char* what, const char* option) {
  const std::string text = read_text(path, what, option);
  try {
    return parse_toml(text);
  } catch (const Error& error) {
    fail(ErrorKind::input, "{}: {}", path, error.what());
  }
}

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

void TomlTable::refuse(std::string_view key, const char* why) const {
  fail(ErrorKind::input, "{}: \"{}\" of {} {}", path, key, name, why);
}

std::string TomlTable::text(std::string_view key) const {
  const auto value = values[key].value<std::string>();
  if (!value || value->empty()) refuse(key, "must be a string");
  return *value;
}

double TomlTable::number(std::string_view key) const {
  const auto value = values[key].value<double>();
  if (!value || !std::isfinite(*value)) refuse(key, "must be a finite number");
  return *value;
}

double TomlTable::positive(std::string_view key) const {
  const auto value = values[key].value<double>();
  if (!value || !(*value > 0) || !std::isfinite(*value)) refuse(key, "must be a number above 0");
  return *value;
}

int TomlTable::count(std::string_view key, int otherwise, int least) const {
  if (!values.contains(key)) return otherwise;
  const auto value = values[key].value<std::int64_t>();
  if (!value || *value < least || *value > 100000) refuse(key, "must be a whole number of a sensible size");
  return int(*value);
}

void TomlTable::require_keys(const std::set<std::string>& known) const {
  const std::vector<std::string> names(known.begin(), known.end());
  for (const auto& [key, value] : values)
    if (!known.contains(std::string(key.str())))
      fail(ErrorKind::input, "{}: {} has no \"{}\"{}", path, name, key.str(), suggestion(key.str(), names));
}

}  // namespace alcove
