// Sentences of the core, which call an option --KEY or --set KEY=VALUE, in the library's words.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include "api/session.h"

namespace alcove {
namespace {

/// An option in a sentence.
struct Mention {
  std::size_t size;   // of the sentence's own spelling
  std::string words;  // the library's
};

bool is_parameter(const SettingRow& row) {
  return row.in_library || is_plane(row.key()) || row.key() == "camera" || row.key() == "preset";
}

/// The option that `text` begins with. Other words with dashes are the caller's own.
std::optional<Mention> mention_at(std::string_view text) {
  constexpr std::string_view kOption = "--", kSet = "--set ", kOfKeys = "abcdefghijklmnopqrstuvwxyz-";
  if (!text.starts_with(kOption)) return std::nullopt;
  std::string_view rest = text.substr((text.starts_with(kSet) ? kSet : kOption).size());
  const std::string_view key = rest.substr(0, rest.find_first_not_of(kOfKeys));
  const auto row = std::ranges::find(option_table(), key, &SettingRow::key);
  if (row == option_table().end()) return std::nullopt;
  rest.remove_prefix(key.size());
  const bool has_value = rest.starts_with('=');
  return Mention{text.size() - rest.size() + has_value,
                 fmt::format("'{}'{}{}", key, is_parameter(*row) ? "" : " (not in the library)", has_value ? " " : "")};
}

}  // namespace

std::string in_library_words(std::string_view sentence) {
  std::string text;
  while (!sentence.empty()) {
    const auto mention = mention_at(sentence);
    text += mention ? mention->words : std::string(1, sentence.front());
    sentence.remove_prefix(mention ? mention->size : 1);
  }
  return text;
}

}  // namespace alcove
