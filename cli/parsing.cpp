// Checks of CLI11's kind, and its complaints in our words.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/parsing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* option : app.get_options())
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// CLI11's complaint as one sentence with the nearest names.
[[noreturn]] void complain(const CLI::App& app, const CLI::ParseError& error) {
  std::string text = error.what();
  std::ranges::replace(text, '\n', ' ');
  const auto names = option_names(app);
  const auto rest = app.remaining();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) && !rest.empty() && rest.front().starts_with('-')) {
    const std::string option = rest.front().substr(0, rest.front().find('='));
    fail(ErrorKind::usage, "there is no option {}{}; see {} --help", option, suggestion(option, names), app.get_name());
  }
  if (dynamic_cast<const CLI::ConfigError*>(&error)) {
    if (const std::size_t colon = text.find(": "); colon != text.npos)
      fail(ErrorKind::usage, "{} is an option of the command line only", text.substr(0, colon));
    const std::string key = text.substr(text.find_last_of(' ') + 1);
    fail(ErrorKind::usage, "{} is no option{}", key, suggestion("--" + key, names));
  }
  fail(ErrorKind::usage, "{}; see {} --help", text, app.get_name());
}

}  // namespace

Range above(double low) { return {low, kInfinity, true, true, fmt::format("above {}", low)}; }
Range between(double low, double high) { return {low, high, false, false, fmt::format("{} to {}", low, high)}; }
Range below_and_at_least(double low, double high) {
  return {low, high, false, true, fmt::format("{} to below {}", low, high)};
}
Range strictly_between(double low, double high) {
  return {low, high, true, true, fmt::format("above {} to below {}", low, high)};
}
Range above_to(double low, double high) { return {low, high, true, false, fmt::format("above {} to {}", low, high)}; }

CLI::Validator check_of(const Range& range) {
  return CLI::Validator(
      [range](std::string& text) -> std::string {
        double value = 0;
        if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value))
          return fmt::format("{} is not a finite number", text);
        return range.holds(value) ? std::string() : fmt::format("{} is not {}", text, range.text);
      },
      "", range.text);
}

CLI::Validator check_of(const std::vector<std::string>& words) {
  return CLI::Validator(
      [words](std::string& text) {
        if (std::ranges::find(words, text) != words.end()) return std::string();
        return fmt::format("{} is none of {}{}", text, list_of(words), suggestion(text, words));
      },
      "", "");
}

std::uint64_t read_size(const char* option, const std::string& text) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789."), text.size());
  std::string unit = CLI::detail::to_lower(text.substr(end));
  if (unit.ends_with("b")) unit.pop_back();
  if (unit.ends_with("i")) unit.pop_back();
  const std::size_t power = unit.empty() ? 0 : std::string("kmgt").find(unit) + 1;
  double number = 0;
  if (unit.size() > 1 || (!unit.empty() && power == 0) || !CLI::detail::lexical_cast(text.substr(0, end), number) ||
      !(number > 0) || number > 1e15)
    throw CLI::ValidationError(option, text + " is no size such as 512M or 4G");
  return std::uint64_t(number * double(1ull << (10 * power)));
}

bool parse_arguments(CLI::App& app, const std::vector<std::string>& arguments) {
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
    return false;
  } catch (const CLI::ParseError& error) {
    complain(app, error);
  }
  return true;
}

}  // namespace alcove
