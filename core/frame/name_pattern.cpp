// After the last star, a name is tried from each place on.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/name_pattern.h"

#include <cstddef>

namespace alcove {

bool fits_pattern(std::string_view name, std::string_view pattern) {
  std::size_t at = 0, star = pattern.npos, retry = 0, p = 0;
  while (at < name.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || (pattern[p] == name[at] && pattern[p] != '*'))) {
      p++;
      at++;
    } else if (p < pattern.size() && pattern[p] == '*') {
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
