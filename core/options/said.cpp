// Values are read into settings of their own first, by which the table tells what has no effect.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/said.h"

#include <fmt/format.h>

#include <algorithm>
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

/// Why each has no effect in the settings that those make of which `counts` says so; "" where it has one, or does not
/// count.
std::vector<std::string> objections_to(const RunOptions& initial, const std::vector<Said>& said,
                                       const std::vector<bool>& counts, Reader reader) {
  std::vector<Said> counted;
  for (std::size_t i = 0; i < said.size(); i++)
    if (counts[i]) counted.push_back(said[i]);
  RunOptions options = options_of(initial, counted);
  const auto table = option_table(options);
  const Settings judged = reader == Reader::run ? options.settings : with_all_outputs(options.settings);
  std::vector<std::string> objections(said.size());
  for (std::size_t i = 0; i < said.size(); i++)
    if (counts[i]) objections[i] = row_of(table, said[i].option).objection(judged);
  return objections;
}

/// Fails where two settings of a preset have an effect each, but none beside the other.
void refuse_contradictions(const RunOptions& initial, const std::vector<Said>& said, const std::string& preset,
                           Reader reader) {
  std::vector<bool> own;
  for (const auto& one : said) own.push_back(one.preset == preset);
  const auto objections = objections_to(initial, said, own, reader);
  const auto with_only = [&](std::size_t i, std::size_t j) {
    std::vector<bool> counts(said.size());
    counts[i] = counts[j] = true;
    return objections_to(initial, said, counts, reader);
  };
  for (std::size_t j = 0; j < said.size(); j++)
    for (std::size_t i = 0; i < j; i++) {
      if (objections[i].empty() || objections[j].empty()) continue;
      const auto beside = with_only(i, j);
      const bool have_none = !beside[i].empty() && !beside[j].empty();
      if (have_none && with_only(i, i)[i].empty() && with_only(j, j)[j].empty())
        fail(ErrorKind::usage, "{} (--preset): {}", preset, beside[i]);
    }
}

/// Leaves out of presets what has no effect, one after the other: what is left out may be what another one had no
/// effect beside, so that those get a second chance.
std::vector<bool> with_effects(const RunOptions& initial, const std::vector<Said>& said, Reader reader) {
  std::vector<bool> counts(said.size(), true);
  while (true) {
    const auto objections = objections_to(initial, said, counts, reader);
    std::size_t idle = 0;
    while (idle < said.size() && (said[idle].is_typed() || objections[idle].empty())) idle++;
    if (idle == said.size()) break;
    counts[idle] = false;
  }
  const auto objection_count = [&] {
    const auto objections = objections_to(initial, said, counts, reader);
    return said.size() - std::size_t(std::ranges::count(objections, ""));
  };
  for (std::size_t i = 0; i < said.size(); i++) {
    if (counts[i]) continue;
    const std::size_t before = objection_count();
    counts[i] = true;
    counts[i] = objection_count() <= before;
  }
  return counts;
}
}  // namespace

void read_said(RunOptions& options, std::vector<Said> said, Reader reader) {
  std::set<std::string> presets;
  for (const auto& one : said)
    if (!one.is_typed()) presets.insert(one.preset);
  for (const auto& preset : presets) refuse_contradictions(options, said, preset, reader);
  const std::vector<bool> counts = with_effects(options, said, reader);
  const auto objections = objections_to(options, said, counts, reader);
  for (std::size_t i = 0; i < said.size(); i++)
    if (said[i].is_typed() && !objections[i].empty()) fail(ErrorKind::usage, "{}", objections[i]);
  std::size_t place = 0;
  std::erase_if(said, [&](const Said&) { return !counts[place++]; });
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
