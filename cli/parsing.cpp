// CLI11 finds the words that belong to each option, and the rows read them. Its complaints are put into our words.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/parsing.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/options.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/flat_toml.h"
#include "core/base/text.h"
#include "core/options/options.h"

namespace alcove {
namespace {

constexpr int kHelpColumn = 34;  // where the sentences begin

/// Presets are read by a real TOML reader: CLI11's own stumbles over a '#', a comma or a space within quotes.
class PresetFormat : public CLI::ConfigTOML {
 public:
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> items;
    auto entries = parse_flat_toml(read_rest(input));
    if (input.bad()) fail(ErrorKind::input, "it cannot be read to its end");
    // The rules of presets/input are known to the program: such a preset is its --source and no more.
    if (std::ranges::any_of(entries, [](const auto& entry) { return entry.key == "detect"; }))
      std::erase_if(entries, [](const auto& entry) { return entry.key != "source"; });
    for (auto& entry : entries) {
      items.emplace_back();
      items.back().name = std::move(entry.key);
      items.back().inputs = std::move(entry.values);
    }
    return items;
  }
};

bool is_preset(const OptionRow& row) { return row.name == "--preset"; }

/// The row as an option that only collects its words.
CLI::Option* add_option(CLI::App& app, const OptionRow& row) {
  if (is_preset(row)) {
    app.config_formatter(std::make_shared<PresetFormat>());
    app.allow_config_extras(CLI::config_extras_mode::error);
    return app.set_config("--preset")->expected(1)->take_all()->transform([](const std::string& name) {
      return preset_file(name);
    });
  }
  if (row.is_flag()) return app.add_flag(row.name)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  CLI::Option* option = app.add_option(row.name);
  if (row.repeats) option->take_all()->allow_extra_args(false);
  if (!row.alone.empty()) option->expected(0, 1)->default_str(row.alone);
  return option->required(row.is_required);
}

/// An app and, row by row, its options.
struct Parser {
  CLI::App app;
  std::vector<CLI::Option*> options;

  explicit Parser(const Command& command) : app(command.description, command.name) {
    app.get_formatter()->column_width(kHelpColumn);
    for (const auto& row : command.rows) {
      CLI::Option* option = options.emplace_back(add_option(app, row));
      const std::string range = range_text(row);
      option->description(row.sentence + (range.empty() ? "" : " (" + range + ")"))->configurable(row.is_key);
      if (!row.group.empty()) option->group(row.group);
      if (!row.is_flag()) option->type_name(row.value);
      if (!row.default_text.empty()) option->default_str(row.default_text);
    }
  }
};

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

void read_rows(const Command& command, const Parser& parser) {
  for (std::size_t i = 0; i < command.rows.size(); i++) {
    if (parser.options[i]->count() == 0) continue;
    const Words words = parser.options[i]->reduced_results();
    try {
      command.rows[i].read(words);
    } catch (const Error& error) {
      fail(error.kind(), "{}; see {} --help", error.what(), command.name);
    }
  }
}

/// Returns false where --help was asked for and printed.
bool parse(const Command& command, Parser& parser, const std::vector<std::string>& arguments) {
  try {
    parser.app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    read_rows(command, parser);
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", parser.app.help());
    return false;
  } catch (const CLI::ParseError& error) {
    complain(parser.app, error);
  }
  return true;
}

/// Parses a preset by itself, so that what is wrong with it is said with its name.
void require_good_preset(const Command& command, const std::string& preset) {
  Parser parser(command);
  try {
    parse(command, parser, {"--preset", preset});
  } catch (const Error& error) {
    fail(error.kind(), "{} (--preset): {}", preset, error.what());
  }
}

}  // namespace

bool parse_arguments(const Command& command, const std::vector<std::string>& arguments) {
  Parser parser(command);
  try {
    return parse(command, parser, arguments);
  } catch (const Error&) {
    if (const auto* presets = parser.app.get_config_ptr())
      for (const auto& preset : presets->results()) require_good_preset(command, preset);
    throw;
  }
}

}  // namespace alcove
