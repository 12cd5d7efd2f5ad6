// Reading and saying the values of options.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/row.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Arguments by place have names in capitals, and options begin with a dash.
bool is_key_name(const std::string& name) { return name.front() >= 'a' && name.front() <= 'z'; }

/// The name in messages: "--output" of "-o,--output", "--set filter-width" of a key.
std::string typed_name(const std::string& name) {
  return is_key_name(name) ? "--set " + name : name.substr(name.find_last_of(',') + 1);
}

template <class T>
void take_number(const std::string& name, const Range& range, const std::string& text, T& value) {
  const double number = number_in(range, name, text);
  if constexpr (std::is_integral_v<T>)
    if (std::trunc(number) != number) fail(ErrorKind::usage, "{}: {} is no whole number", name, said(text));
  value = T(number);
}

/// What a switch may be set to, in a preset or behind an equals sign.
bool read_switch(const std::string& name, const std::string& text) {
  const std::string word = lower_case(text);
  for (const char* on : {"true", "on", "yes", "1"})
    if (word == on) return true;
  for (const char* off : {"false", "off", "no", "0"})
    if (word == off) return false;
  fail(ErrorKind::usage, "{}: {} is neither true nor false", name, said(text));
}

Words words_of(const std::string& text) { return text.empty() ? Words{} : Words{text}; }

}  // namespace

std::string said(const std::string& text) { return text.empty() ? "\"\"" : text; }

double number_in(const Range& range, const std::string& name, const std::string& text) {
  const auto value = number_of(text);
  if (!value && text.find(',') != text.npos)
    fail(ErrorKind::usage, "{}: {} is no single number; decimals are written with a point", name, text);
  if (!value) fail(ErrorKind::usage, "{}: {} is not a number", name, said(text));
  if (!std::isfinite(*value)) fail(ErrorKind::usage, "{}: {} is not a finite number", name, text);
  if (!range.holds(*value)) fail(ErrorKind::usage, "{}: {} is out of range: {}", name, text, range.text);
  return *value;
}

Range above(double low) { return {low, kInfinity, true, true, fmt::format("above {}", low)}; }
Range at_least(double low) { return {low, kInfinity, false, true, fmt::format("{} or more", low)}; }
Range between(double low, double high) { return {low, high, false, false, fmt::format("{} to {}", low, high)}; }
Range below_and_at_least(double low, double high) {
  return {low, high, false, true, fmt::format("at least {} and below {}", low, high)};
}
Range strictly_between(double low, double high) {
  return {low, high, true, true, fmt::format("above {} and below {}", low, high)};
}
Range above_to(double low, double high) {
  return {low, high, true, false, fmt::format("above {} and at most {}", low, high)};
}

std::optional<int> whole_number_of(const std::string& text) {
  const auto value = number_of(text);
  const bool fits = value && std::trunc(*value) == *value && std::abs(*value) <= std::numeric_limits<int>::max();
  return fits ? std::optional(int(*value)) : std::nullopt;
}

std::string OptionRow::objection(const Settings& settings) const {
  if (!why_without_effect || words().empty()) return "";
  const std::string why = why_without_effect(settings);
  return why.empty() ? "" : fmt::format("{} has no effect: {}", long_name(), why);
}

bool OptionRow::is_only_key() const { return is_key_name(name); }

std::string OptionRow::long_name() const { return typed_name(name); }

std::string OptionRow::key() const { return is_only_key() ? name : name.substr(name.find("--") + 2); }

OptionRow& OptionGroup::add(const Shown& shown, std::function<Words()> words, std::function<void(const Words&)> read) {
  const Words present = words();
  rows_.push_back({.group = group_,
                   .name = shown.name,
                   .value = shown.value,
                   .unit = shown.unit,
                   .range = shown.range,
                   .sentence = shown.sentence,
                   .default_text = present.empty() ? "" : present.front(),
                   .effect = effect_,
                   .words = std::move(words),
                   .read = std::move(read),
                   .in_library = in_library_});
  return rows_.back();
}

OptionRow& OptionGroup::own(const Shown& shown, const std::function<std::string()>& say,
                            const std::function<bool(const std::string&)>& take, const std::string& complaint) {
  return add(
      shown, [say] { return words_of(say()); },
      [name = typed_name(shown.name), take, complaint](const Words& words) {
        const std::string& text = words.front();
        if (!take(text)) fail(ErrorKind::usage, "{}: {} {}", name, said(text), complaint);
      });
}

OptionRow& OptionGroup::text(const std::string& name, std::string& value, const char* what,
                             const std::string& sentence) {
  return add(
      {name, what, "", "", sentence}, [&value] { return words_of(value); },
      [&value](const Words& words) { value = words.front(); });
}

OptionRow& OptionGroup::flag(const std::string& name, bool& value, const std::string& sentence) {
  OptionRow& row = add(
      {name, "", "", "", sentence}, [&value] { return words_of(value ? "true" : ""); },
      [name = typed_name(name), &value](const Words& words) { value = read_switch(name, words.front()); });
  row.default_text.clear();
  return row;
}

OptionRow& OptionGroup::choice_row(const std::string& name, const Words& words, const std::string& sentence,
                                   const std::function<std::string()>& say,
                                   const std::function<void(const std::string&)>& take) {
  return add(
      {name, fmt::format("{}", fmt::join(words, "|")), "", "", sentence}, [say] { return words_of(say()); },
      [name = typed_name(name), words, take](const Words& given) {
        const std::string word = lower_case(given.front());
        if (std::ranges::find(words, word) == words.end())
          fail(ErrorKind::usage, "{}: {} is none of {}{}", name, said(given.front()), list_of(words),
               suggestion(word, words));
        take(word);
      });
}

OptionRow& OptionGroup::word(const std::string& name, std::string& value, const Words& words,
                             const std::string& sentence) {
  return choice_row(
      name, words, sentence, [&value] { return value; }, [&value](const std::string& word) { value = word; });
}

template <class T>
OptionRow& OptionGroup::number_row(const std::string& name, T& value, const char* unit, const Range& range,
                                   const std::string& sentence) {
  return add(
      {name, "NUMBER", unit, range.text, sentence}, [&value] { return Words{fmt::format("{}", value)}; },
      [name = typed_name(name), range, &value](const Words& words) { take_number(name, range, words.front(), value); });
}

OptionRow& OptionGroup::number(const std::string& name, double& value, const char* unit, const Range& range,
                               const std::string& sentence) {
  return number_row(name, value, unit, range, sentence);
}

OptionRow& OptionGroup::number(const std::string& name, int& value, const char* unit, const Range& range,
                               const std::string& sentence) {
  return number_row(name, value, unit, range, sentence);
}

OptionRow& OptionGroup::number(const std::string& name, std::uint32_t& value, const char* unit, const Range& range,
                               const std::string& sentence) {
  return number_row(name, value, unit, range, sentence);
}

OptionRow& OptionGroup::number(const std::string& name, std::optional<double>& value, const char* unit,
                               const Range& range, const std::string& sentence) {
  return add(
      {name, "NUMBER", unit, range.text, sentence},
      [&value] { return value ? Words{fmt::format("{}", *value)} : Words{}; },
      [name = typed_name(name), range, &value](const Words& words) { value = number_in(range, name, words.front()); });
}

}  // namespace alcove
