// TOML, through toml++.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/toml.h"

#include <algorithm>
#include <charconv>

#include "core/base/error.h"
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

}  // namespace alcove
