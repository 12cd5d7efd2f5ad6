// The names of options, and how their values are read.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/option_row.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/text.h"

namespace alcove {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

/// Arguments by place have names in capitals, and options begin with a dash.
bool OptionRow::is_only_key() const { return name.front() >= 'a' && name.front() <= 'z'; }

std::string OptionRow::long_name() const {
  return is_only_key() ? "--set " + name : name.substr(name.find_last_of(',') + 1);
}

std::string OptionRow::key() const { return is_only_key() ? name : name.substr(name.find("--") + 2); }

Range above(double low) { return {low, kInfinity, true, true, fmt::format("above {}", low)}; }
Range at_least(double low) { return {low, kInfinity, false, true, fmt::format("{} or more", low)}; }
Range between(double low, double high) { return {low, high, false, false, fmt::format("{} to {}", low, high)}; }
Range strictly_between(double low, double high) {
  return {low, high, true, true, fmt::format("above {} and below {}", low, high)};
}
Range above_to(double low, double high) {
  return {low, high, true, false, fmt::format("above {} and at most {}", low, high)};
}

std::string visible(const std::string& text) { return text.empty() ? "\"\"" : text; }

std::optional<int> whole_number_of(const std::string& text) {
  const auto value = number_of(text);
  const bool fits = value && std::trunc(*value) == *value && std::abs(*value) <= std::numeric_limits<int>::max();
  return fits ? std::optional(int(*value)) : std::nullopt;
}

double number_in(const Range& range, const std::string& text) {
  const auto value = number_of(text);
  if (!value && text.find(',') != text.npos)
    fail(ErrorKind::usage, "{} is no single number; decimals are written with a point", text);
  if (!value) fail(ErrorKind::usage, "{} is not a number", visible(text));
  if (!std::isfinite(*value)) fail(ErrorKind::usage, "{} is not a finite number", text);
  if (!range.holds(*value)) fail(ErrorKind::usage, "{} is out of range: {}", text, range.text);
  return *value;
}

double whole_number_in(const Range& range, const std::string& text) {
  const double number = number_in(range, text);
  if (std::trunc(number) != number) fail(ErrorKind::usage, "{} is no whole number", visible(text));
  return number;
}

bool read_switch(const std::string& text) {
  const std::string word = lower_case(text);
  for (const char* on : {"true", "on", "yes", "1"})
    if (word == on) return true;
  for (const char* off : {"false", "off", "no", "0"})
    if (word == off) return false;
  fail(ErrorKind::usage, "{} is neither true nor false", visible(text));
}

std::string one_of(const Words& words, const std::string& text) {
  const std::string word = lower_case(text);
  if (std::ranges::find(words, word) == words.end())
    fail(ErrorKind::usage, "{} is none of {}{}", visible(text), list_of(words), suggestion(word, words));
  return word;
}

void read_named(const std::string& option, const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    fail(error.kind(), "{}: {}", option, error.what());
  }
}

}  // namespace alcove
