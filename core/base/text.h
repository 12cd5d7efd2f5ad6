// Names as text: case, lists, escapes, and the names that are nearest to a misspelt one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace alcove {

std::string lower_case(std::string_view text);

/// Gives the parts between commas, without the spaces around them. An empty text has one part, which is empty.
std::vector<std::string> split(const std::string& text);

/// Gives "a, b, c": at most `most` names, then "and N more"; "nothing" for none.
std::string list_of(std::span<const std::string> names, std::size_t most = 24);

/// Gives "1 frame", "2 frames".
std::string counted(std::size_t count, std::string_view thing);

/// Gives "a", "a or b", "a, b or c", with the link between the last two.
std::string linked(std::span<const std::string> words, const char* link);

/// Counts the insertions, deletions and replacements that turn one text into the other. Case is ignored.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Gives up to `most` candidates that resemble `name`, the nearest first; none if all are far off.
std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string> candidates,
                                       std::size_t most = 3);

/// The text in valid UTF-8. Names of files may hold any bytes: each byte outside of a character becomes \xff, with its
/// hexadecimal digits.
std::string as_utf8(std::string_view text);

/// The text within HTML or XML: characters of their own as entities.
std::string markup_text(std::string_view text);

/// The text in valid UTF-8 for a terminal. Each control character becomes ?, since a terminal would obey it, and so
/// does each character that turns the direction of writing.
std::string printable(std::string_view text);

/// A word as a shell takes it, with quotes if it needs them.
std::string for_shell(const std::string& word);

/// An option with its value as typed: "--view left"; of a key, "--set stride=4".
std::string typed(std::string_view option, std::string_view value);

/// Reads a text that is a number and nothing else, with a decimal point in every locale. The number may be infinite or
/// NaN; numbers that are too large become infinite.
std::optional<double> number_of(std::string_view text);

/// Gives " (did you mean a or b?)" for the end of a message, or an empty text if no candidate is near.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

/// Reads JSON. Where the text is none, or its objects and lists lie within each other deeper than `deepest`, since
/// copying and quoting them recurses, gives null and says why, for the end of a message: "; line 3 is no JSON".
nlohmann::json json_of(const std::string& text, int deepest, std::string& why);

/// The document in valid UTF-8, on one line or with `indent` spaces per level. Keys and strings may hold names of
/// files, which may be no UTF-8: as_utf8() escapes them.
std::string json_text(const nlohmann::ordered_json& json, int indent = -1);

/// Writes the frames as the shortest list, in rising order: "1003, 1010-1012".
std::string frames_text(std::vector<int> frames);

/// The same, cut to the number of frames, the first and the last where the list has more than ten parts.
std::string short_frames_text(const std::vector<int>& frames);

}  // namespace alcove
