// Values are read into settings of their own first, by which the table tells what has no effect.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/said.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "core/chain/aov.h"

namespace alcove {
namespace {

const OptionRow& row_of(const std::vector<OptionRow>& table, const std::string& option) {
  const auto row = std::ranges::find(table, option, &OptionRow::long_name);
  if (row == table.end()) fail(ErrorKind::usage, "there is no option {}", option);
  return *row;
}

/// Reads a value, and names its preset in what is wrong with it.
void read_one(const std::vector<OptionRow>& table, const Said& one) {
  try {
    row_of(table, one.option).read(one.words);
  } catch (const Error& error) {
    if (one.is_typed()) throw;
    fail(error.kind(), "{} (--preset): {}", one.preset, error.what());
  }
}

RunOptions options_of(const RunOptions& initial, const std::vector<Said>& said) {
  RunOptions options = initial;
  const auto table = option_table(options);
  for (const auto& one : said) read_one(table, one);
  return options;
}

/// The options that only presets say.
Words only_in_presets(const std::vector<Said>& said) {
  Words options;
  for (const auto& one : said) {
    const bool is_typed =
        std::ranges::any_of(said, [&](const Said& other) { return other.is_typed() && other.option == one.option; });
    if (!is_typed) options.push_back(one.option);
  }
  return options;
}

/// The settings of a run that writes all that there is.
Settings with_all_outputs(Settings settings) {
  settings.output.composite = settings.output.preview = "all";
  settings.output.multi_bounce = true;
  // But for confidence, which would give what no estimate of the AO takes an effect.
  for (const auto& name : aov_names())
    if (name != "confidence") settings.output.aovs += "," + std::string(name);
  return settings;
}

bool is_objection(const std::string& text) { return !text.empty(); }

/// The presets that say something.
std::set<std::string> presets_in(const std::vector<Said>& said) {
  std::set<std::string> presets;
  for (const auto& one : said)
    if (!one.is_typed()) presets.insert(one.preset);
  return presets;
}

/// Why each of them has no effect in the settings that all of it makes, "" where it has one.
std::vector<std::string> objections_to(const RunOptions& initial, const std::vector<Said>& said, Reader reader) {
  RunOptions options = options_of(initial, said);
  const auto table = option_table(options);
  const Settings judged = reader == Reader::run ? options.settings : with_all_outputs(options.settings);
  std::vector<std::string> objections;
  for (const auto& one : said) objections.push_back(row_of(table, one.option).objection(judged));
  return objections;
}

/// The place of the first that has no effect, among what is typed or among the rest; none: all have one.
std::optional<std::size_t> without_effect(const std::vector<Said>& said, const std::vector<std::string>& objections,
                                          bool typed) {
  for (std::size_t i = 0; i < said.size(); i++)
    if (said[i].is_typed() == typed && !objections[i].empty()) return i;
  return std::nullopt;
}

/// Fails where two settings of a preset have an effect each, but none beside the other.
void refuse_contradictions(const RunOptions& initial, const std::vector<Said>& said, Reader reader) {
  const auto objections = objections_to(initial, said, reader);
  for (std::size_t i = 0; i < said.size(); i++)
    for (std::size_t j = 0; j < i; j++) {
      if (objections[i].empty() || objections[j].empty()) continue;
      const auto pair = objections_to(initial, {said[j], said[i]}, reader);
      const bool are_both_idle = !pair[0].empty() && !pair[1].empty();
      if (are_both_idle && objections_to(initial, {said[i]}, reader)[0].empty() &&
          objections_to(initial, {said[j]}, reader)[0].empty())
        fail(ErrorKind::usage, "{} (--preset): {}", said[i].preset, pair[0]);
    }
}

/// Leaves out of presets what has no effect, one after the other: what is left out may be what another one had no
/// effect beside, so that those get a second chance.
std::vector<Said> with_effects(const RunOptions& initial, const std::vector<Said>& said, Reader reader) {
  std::vector<bool> is_kept(said.size(), true);
  const auto kept = [&] {
    std::vector<Said> list;
    for (std::size_t i = 0; i < said.size(); i++)
      if (is_kept[i]) list.push_back(said[i]);
    return list;
  };
  const auto place_of = [&](std::size_t nth) {
    std::size_t place = 0;
    while (!is_kept[place] || nth-- > 0) place++;
    return place;
  };
  while (const auto idle = without_effect(kept(), objections_to(initial, kept(), reader), false))
    is_kept[place_of(*idle)] = false;
  for (std::size_t i = 0; i < said.size(); i++) {
    if (is_kept[i]) continue;
    const std::size_t before = std::ranges::count_if(objections_to(initial, kept(), reader), is_objection);
    is_kept[i] = true;
    is_kept[i] = std::size_t(std::ranges::count_if(objections_to(initial, kept(), reader), is_objection)) <= before;
  }
  return kept();
}

}  // namespace

void read_said(RunOptions& options, std::vector<Said> said, Reader reader) {
  for (const auto& preset : presets_in(said)) {
    std::vector<Said> own;
    std::ranges::copy_if(said, std::back_inserter(own), [&](const Said& one) { return one.preset == preset; });
    refuse_contradictions(options, own, reader);
  }
  said = with_effects(options, said, reader);
  const auto objections = objections_to(options, said, reader);
  if (const auto idle = without_effect(said, objections, true)) fail(ErrorKind::usage, "{}", objections[*idle]);
  options = options_of(options, said);
  options.settings.input.from_presets = only_in_presets(said);
}

void require_effects(const Settings& settings) {
  RunOptions defaults;
  RunOptions options;
  options.settings = settings;
  const auto table = option_table(options);
  const auto usual = option_table(defaults);
  for (std::size_t i = 0; i < table.size(); i++)
    if (table[i].words() != usual[i].words())
      if (const std::string objection = table[i].objection(settings); !objection.empty())
        fail(ErrorKind::usage, "{}", objection);
}

}  // namespace alcove
