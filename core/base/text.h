// Small help with names: case, lists, and the nearest of them to a misspelt one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace alcove {

std::string lower_case(std::string_view text);

/// The parts between commas, without the spaces around them. One, empty, for an empty text.
std::vector<std::string> split(const std::string& text);

/// "a, b, c"; at most `most` names, then "and N more". "nothing" for none.
std::string list_of(std::span<const std::string> names, std::size_t most = 24);

/// Insertions, deletions and replacements that turn one text into the other, case ignored.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Up to `most` of the candidates that resemble `name`, the nearest first; none where all are far off.
std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string> candidates,
                                       std::size_t most = 3);

/// The text with ? in the place of each control character, since names in files may hold what a terminal would obey.
std::string printable(std::string text);

/// " (did you mean a or b?)", or nothing: to be put behind a message.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

}  // namespace alcove
