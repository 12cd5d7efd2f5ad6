// Patterns of names: of channels and attributes in rules, of objects in Cryptomattes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace alcove {

/// Whether a whole name fits a pattern, in which * stands for any characters and ? for one, and what stands behind a
/// backslash, one of these, for itself. Case counts.
bool fits_pattern(std::string_view name, std::string_view pattern);

/// Whether a pattern may stand for several names.
bool is_pattern(std::string_view text);

/// Whether the character at that place is a backslash that takes the next one as it is: * ? , a blank or a backslash.
bool is_escape(std::string_view text, std::size_t at);

/// The name that a text without patterns stands for.
std::string unescaped(std::string_view text);

}  // namespace alcove
