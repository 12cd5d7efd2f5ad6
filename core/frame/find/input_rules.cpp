// Reads the rules.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/input_rules.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/flat_toml.h"
#include "core/base/option_words.h"
#include "core/base/text.h"

namespace alcove {
namespace {

/// Gives the value of a word of an option; none if the option has no such word, or if the word leaves it open.
template <class T>
std::optional<T> known_meaning(const std::string& word) {
  for (const auto& [known, meaning] : kWordsOf<T>)
    if (meaning != T::automatic && word == known) return meaning;
  return std::nullopt;
}

/// The kind of a depth channel. Positions have channels of their own.
std::optional<DepthKind> depth_kind_of(const std::string& word) {
  const auto kind = known_meaning<DepthKind>(word);
  return kind == DepthKind::position ? std::nullopt : kind;
}

std::vector<AovCandidate> candidates_of(const std::vector<std::string>& words) {
  std::vector<AovCandidate> candidates;
  for (const auto& word : words) {
    const std::size_t colon = word.rfind(':');
    const std::string before = word.substr(0, colon), after = colon == word.npos ? "" : word.substr(colon + 1);
    const auto kind = depth_kind_of(after);
    const auto space = known_meaning<NormalSpace>(after);
    candidates.push_back({lower_case(kind || space ? before : word), kind.value_or(DepthKind::automatic),
                          space.value_or(NormalSpace::automatic)});
  }
  return candidates;
}

}  // namespace

InputRules parse_input_rules(const std::string& name, const std::string& text) {
  InputRules rules;
  rules.name = name;
  for (const auto& [key, values] : parse_flat_toml(text)) {
    const std::string word = values.empty() ? "" : values[0];
    const auto known = [&, &key = key](const auto& value) {
      if (!value) fail(ErrorKind::usage, "presets/input/{}.toml: {} = {} means nothing", name, key, word);
      return *value;
    };
    const auto distance = [&] {
      const auto value = number_of(word);
      return known(value && *value > 0 ? value : std::nullopt);
    };
    if (key == "source")
      known(word == name ? std::optional(0) : std::nullopt);
    else if (key == "detect")
      rules.detect = values;
    else if (key == "detect-last")
      rules.detect_last = values;
    else if (key == "depth-channel")
      rules.depth = candidates_of(values);
    else if (key == "normal-channels")
      rules.normal = candidates_of(values);
    else if (key == "position-channels")
      rules.position = candidates_of(values);
    else if (key == "depth-kind")
      rules.depth_kind = known(depth_kind_of(word));
    else if (key == "near")
      rules.depth_range.near = distance();
    else if (key == "far")
      rules.depth_range.far = distance();
    else if (key == "reversed-z")
      rules.depth_range.reversed = word == "true";
    else if (key == "normal-space")
      rules.normal_space = known(known_meaning<NormalSpace>(word));
    else if (key == "normal-encoding")
      rules.normal_encoding = known(known_meaning<NormalEncoding>(word));
    else if (key == "normal-averaged")
      rules.normal_averaged = word == "true";
    else
      fail(ErrorKind::usage, "presets/input/{}.toml: there is no key {}", name, key);
  }
  return rules;
}

const std::vector<InputRules>& all_input_rules() {
  static const std::vector<InputRules> all = [] {
    std::vector<InputRules> rules;
    for (const auto& [name, text] : input_preset_texts()) rules.push_back(parse_input_rules(name, text));
    std::ranges::sort(rules, {}, &InputRules::name);
    return rules;
  }();
  return all;
}

std::vector<std::string> source_names() {
  std::vector<std::string> names{"auto"};
  for (const auto& rules : all_input_rules()) names.push_back(rules.name);
  return names;
}

const InputRules& input_rules(const std::string& name) {
  const auto found = std::ranges::find(all_input_rules(), name, &InputRules::name);
  if (found != all_input_rules().end()) return *found;
  const auto names = source_names();
  fail(ErrorKind::usage, "there is no source {}{}; --source takes {}", name, suggestion(name, names), list_of(names));
}

}  // namespace alcove
