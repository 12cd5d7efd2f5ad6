// After the last star, a name is tried from each place on.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/name_pattern.h"

#include <cstddef>

namespace alcove {

bool is_escape(std::string_view text, std::size_t at) {
  return text[at] == '\\' && at + 1 < text.size() && std::string_view("*?, \\").find(text[at + 1]) != text.npos;
}

bool is_pattern(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); i++) {
    if (is_escape(text, i))
      i++;
    else if (text[i] == '*' || text[i] == '?')
      return true;
  }
  return false;
}

std::string unescaped(std::string_view text) {
  std::string name;
  for (std::size_t i = 0; i < text.size(); i++) name += is_escape(text, i) ? text[++i] : text[i];
  return name;
}

bool fits_pattern(std::string_view name, std::string_view pattern) {
  std::size_t at = 0, star = pattern.npos, retry = 0, p = 0;
  while (at < name.size()) {
    const bool escapes = p < pattern.size() && is_escape(pattern, p);
    const char wanted = p < pattern.size() ? pattern[p + std::size_t(escapes)] : 0;
    if (p < pattern.size() && ((!escapes && wanted == '?') || (wanted == name[at] && (escapes || wanted != '*')))) {
      p += 1 + std::size_t(escapes);
      at++;
    } else if (p < pattern.size() && !escapes && wanted == '*') {
      star = p++;
      retry = at;
    } else if (star != pattern.npos) {
      p = star + 1;
      at = ++retry;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == pattern.npos;
}

}  // namespace alcove
