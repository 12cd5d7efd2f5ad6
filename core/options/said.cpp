// Values are read into settings of their own first, by which the conditions of the table are checked.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/said.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.h"

namespace alcove {
namespace {

const OptionRow& row_of(const std::vector<OptionRow>& table, const std::string& option) {
  const auto row = std::ranges::find(table, option, &OptionRow::long_name);
  if (row == table.end()) fail(ErrorKind::usage, "there is no option {}", option);
  return *row;
}

/// What a row has against another option, whatever their values; null: nothing.
const Contradiction* rival(const OptionRow& row, const OptionRow& other) {
  const auto names = [&](const Contradiction& one) {
    return std::ranges::find(one.options, other.long_name()) != one.options.end();
  };
  const auto found = std::ranges::find_if(row.contradictions, names);
  return found == row.contradictions.end() ? nullptr : &*found;
}

[[noreturn]] void refuse_pair(const std::string& a, const std::string& b, const std::string& why,
                              const std::string& preset) {
  const std::string place = preset.empty() ? "" : preset + " (--preset): ";
  fail(ErrorKind::usage, "{}{} and {} contradict each other: {}; give only one of them", place, a, b, why);
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

/// The same of what is said of two options. Fails where that is no value.
std::string quarrel(const RunOptions& initial, const Said& a, const Said& b) {
  RunOptions trial = initial;
  const auto table = option_table(trial);
  read_one(table, a);
  read_one(table, b);
  return quarrel(row_of(table, a.option), row_of(table, b.option));
}

/// Leaves of options that contradict each other the one that was said last.
std::vector<Said> without_contradictions(const RunOptions& initial, const std::vector<Said>& said) {
  RunOptions unused = initial;
  const auto table = option_table(unused);
  std::vector<Said> kept;
  for (const auto& one : said) {
    const auto contradicts = [&](const Said& earlier) {
      const OptionRow &row = row_of(table, one.option), &other = row_of(table, earlier.option);
      if (!rival(row, other) && !rival(other, row)) return false;
      const std::string why = quarrel(initial, earlier, one);
      if (!why.empty() && earlier.preset == one.preset) refuse_pair(earlier.option, one.option, why, one.preset);
      return !why.empty();
    };
    std::erase_if(kept, contradicts);
    kept.push_back(one);
  }
  return kept;
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

/// Finds what does not apply to the settings that all of it makes, among what is typed or among the rest.
std::vector<Said>::const_iterator inapplicable(const RunOptions& initial, const std::vector<Said>& said, bool typed,
                                               Reader reader, std::string& objection) {
  RunOptions options = options_of(initial, said);
  const auto table = option_table(options);
  return std::ranges::find_if(said, [&](const Said& one) {
    if (one.is_typed() != typed) return false;
    objection = row_of(table, one.option).objection(options.settings, reader == Reader::run);
    return !objection.empty();
  });
}

}  // namespace

std::string quarrel(const OptionRow& a, const OptionRow& b) {
  for (const auto& [row, other] : {std::pair(&a, &b), std::pair(&b, &a)})
    if (const Contradiction* found = rival(*row, *other); found && row->asks(*found) && other->asks())
      return found->why;
  return "";
}

void read_said(RunOptions& options, std::vector<Said> said, Reader reader) {
  said = without_contradictions(options, said);
  std::string objection;
  // One after the other: what is left out may be what another one did not apply to.
  for (auto found = inapplicable(options, said, false, reader, objection); found != said.end();
       found = inapplicable(options, said, false, reader, objection))
    said.erase(found);
  if (inapplicable(options, said, true, reader, objection) != said.end()) fail(ErrorKind::usage, "{}", objection);
  options = options_of(options, said);
  options.settings.input.from_presets = only_in_presets(said);
}

void require_applicable(const Settings& settings) {
  RunOptions defaults;
  RunOptions options;
  options.settings = settings;
  const auto table = option_table(options);
  const auto usual = option_table(defaults);
  std::vector<const OptionRow*> set;
  for (std::size_t i = 0; i < table.size(); i++) {
    const OptionRow& row = table[i];
    if (!row.asks() || row.words() == usual[i].words()) continue;
    for (const auto* other : set)
      if (const std::string why = quarrel(*other, row); !why.empty())
        refuse_pair(other->long_name(), row.long_name(), why, "");
    if (const std::string objection = row.objection(settings); !objection.empty())
      fail(ErrorKind::usage, "{}", objection);
    set.push_back(&row);
  }
}

}  // namespace alcove
