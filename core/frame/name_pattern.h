// Patterns of names: of channels and attributes in rules, of objects in Cryptomattes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace alcove {

/// Whether a whole name fits a pattern, in which * stands for any characters and ? for one. Case counts.
bool fits_pattern(std::string_view name, std::string_view pattern);

}  // namespace alcove
