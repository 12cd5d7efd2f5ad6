// Values are read into settings of their own first, by which the table tells what has no effect.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/said.h"

#include <fmt/format.h>

#include <algorithm>

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
  settings.output.aovs = fmt::format("{}", fmt::join(aov_names(), ","));
  return settings;
}

/// Finds what has no effect in the settings that all of it makes, among what is typed or among the rest.
std::vector<Said>::const_iterator without_effect(const RunOptions& initial, const std::vector<Said>& said, bool typed,
                                                 Reader reader, std::string& objection) {
  RunOptions options = options_of(initial, said);
  const auto table = option_table(options);
  const Settings judged = reader == Reader::run ? options.settings : with_all_outputs(options.settings);
  return std::ranges::find_if(said, [&](const Said& one) {
    if (one.is_typed() != typed) return false;
    objection = row_of(table, one.option).objection(judged);
    return !objection.empty();
  });
}

}  // namespace

void read_said(RunOptions& options, std::vector<Said> said, Reader reader) {
  std::string objection;
  // One after the other, the first said first: what is left out may be what another one had no effect beside.
  for (auto found = without_effect(options, said, false, reader, objection); found != said.end();
       found = without_effect(options, said, false, reader, objection))
    said.erase(found);
  if (without_effect(options, said, true, reader, objection) != said.end()) fail(ErrorKind::usage, "{}", objection);
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
