// Reads the rules.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/input_rules.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/base/toml.h"

namespace alcove {
namespace {

/// Gives the value of a word of an option; none if the option has no such word, or if the word leaves it open.
template <class T>
std::optional<T> known_meaning(const std::string& word) {
  for (const auto& [known, meaning] : kWordsOf<T>)
    if (meaning != T::automatic && word == known) return meaning;
  return std::nullopt;
}

/// The kind of a depth channel. Positions have channels of their own, and disparity is said by an option alone.
std::optional<DepthKind> depth_kind_of(const std::string& word) {
  const auto kind = known_meaning<DepthKind>(word);
  return kind == DepthKind::position || kind == DepthKind::disparity ? std::nullopt : kind;
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

/// The values of a key.
struct RuleValues {
  const std::string &name, &key;
  const std::vector<std::string>& all;

  std::string word() const { return all.empty() ? "" : all[0]; }
  template <class T>
  T known(const std::optional<T>& value) const {
    if (!value) fail(ErrorKind::usage, "presets/input/{}.toml: {} = {} means nothing", name, key, word());
    return *value;
  }
  double distance() const {
    const auto value = number_of(word());
    return known(value && *value > 0 ? value : std::nullopt);
  }
};

using SetRule = void (*)(InputRules& rules, const RuleValues& values);
constexpr std::pair<const char*, SetRule> kRules[] = {
    {"source", [](InputRules&, const RuleValues& v) { v.known(v.word() == v.name ? std::optional(0) : std::nullopt); }},
    {"detect", [](InputRules& rules, const RuleValues& v) { rules.detect = v.all; }},
    {"detect-last", [](InputRules& rules, const RuleValues& v) { rules.detect_last = v.all; }},
    {"depth-channel", [](InputRules& rules, const RuleValues& v) { rules.depth = candidates_of(v.all); }},
    {"normal-channels", [](InputRules& rules, const RuleValues& v) { rules.normal = candidates_of(v.all); }},
    {"position-channels", [](InputRules& rules, const RuleValues& v) { rules.position = candidates_of(v.all); }},
    {"depth-kind", [](InputRules& rules, const RuleValues& v) { rules.depth_kind = v.known(depth_kind_of(v.word())); }},
    {"near", [](InputRules& rules, const RuleValues& v) { rules.depth_range.near = v.distance(); }},
    {"far", [](InputRules& rules, const RuleValues& v) { rules.depth_range.far = v.distance(); }},
    {"reversed-z", [](InputRules& rules, const RuleValues& v) { rules.depth_range.reversed = v.word() == "true"; }},
    {"normal-space", [](InputRules& rules,
                        const RuleValues& v) { rules.normal_space = v.known(known_meaning<NormalSpace>(v.word())); }},
    {"normal-encoding",
     [](InputRules& rules, const RuleValues& v) {
       rules.normal_encoding = v.known(known_meaning<NormalEncoding>(v.word()));
     }},
    {"normal-averaged", [](InputRules& rules, const RuleValues& v) { rules.normal_averaged = v.word() == "true"; }},
};

}  // namespace

InputRules parse_input_rules(const std::string& name, const std::string& text) {
  InputRules rules;
  rules.name = name;
  for (const auto& [key, values] : parse_flat_toml(text)) {
    const auto* rule = std::ranges::find(kRules, key, [](const auto& each) { return std::string(each.first); });
    if (rule == std::end(kRules)) fail(ErrorKind::usage, "presets/input/{}.toml: there is no key {}", name, key);
    rule->second(rules, {name, key, values});
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
