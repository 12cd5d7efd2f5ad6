// CLI11 finds the words that belong to each option, and the rows read them. Its complaints are put into our words.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <regex>
#include <string_view>

#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/options/options.h"
#include "core/run/plan.h"

namespace alcove {
namespace {

/// The hint behind a message: --help, or --help-all where --help lacks an option that the message names.
std::string see_help(const Command& command, const std::string& message) {
  static const std::regex option(R"((?:^|[\s(])(--?[a-zA-Z][\w-]*))");
  const auto is_hidden = [&](const std::smatch& name) {
    const auto row = std::ranges::find(command.rows, name.str(1), &OptionRow::long_name);
    return row == command.rows.end() || !row->is_common;
  };
  const bool names_hidden =
      std::any_of(std::sregex_iterator(message.begin(), message.end(), option), std::sregex_iterator(), is_hidden);
  return fmt::format("; see {} --help{}", command.name, names_hidden && has_common_rows(command) ? "-all" : "");
}

constexpr int kHelpColumn = 34;  // where the sentences begin

/// The row as an option that only collects its words.
CLI::Option* add_option(CLI::App& app, const OptionRow& row) {
  if (row.is_flag()) return app.add_flag(row.name)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  CLI::Option* option = app.add_option(row.name);
  if (row.repeats) option->take_all()->allow_extra_args(false);
  return option->required(row.is_required);
}

/// An app and, row by row, its options.
struct Parser {
  CLI::App app;
  std::vector<CLI::Option*> options;

  /// Help shows all rows, or only those that are common and the arguments by place.
  Parser(const Command& command, bool shows_all) : app(command.description, command.name) {
    app.allow_windows_style_options(false);  // /show/a.exr is a file on Windows too
    app.get_formatter()->column_width(kHelpColumn);
    app.get_formatter()->label("REQUIRED", "");
    app.set_help_flag("-h,--help", "print this help and stop");
    app.set_help_all_flag("--help-all", has_common_rows(command) && !shows_all ? "print all options and stop" : "")
        ->group(has_common_rows(command) && !shows_all ? "Options" : "");
    for (const auto& row : command.rows) {
      CLI::Option* option = options.emplace_back(add_option(app, row));
      const std::string range = range_text(row);
      option->description(row.sentence + (range.empty() ? "" : " (" + range + ")"));
      if (!row.group.empty()) option->group(row.group);
      if (!shows_all && !row.is_common && row.name.starts_with('-')) option->group("");
      // Releases of CLI11 show defaults each in a way of their own.
      if (!row.is_flag()) option->option_text(row.value + (row.default_text.empty() ? "" : "=" + row.default_text));
    }
  }
};

/// The options that a misspelt one may mean. One letter is the first of a common option's name.
std::string suggested_options(const Command& command, const std::string& typed) {
  Words names{"--help", "--help-all"}, first;
  for (const auto& row : command.rows) {
    if (!row.name.starts_with('-')) continue;
    names.push_back(row.long_name());
    const bool is_shown = row.is_common || !has_common_rows(command);
    if (is_shown && names.back().starts_with("-" + typed)) first.push_back(names.back());
  }
  const bool is_letter = typed.size() == 2 && !first.empty();
  return is_letter ? fmt::format(" (did you mean {}?)", fmt::join(first, " or ")) : suggestion(typed, names);
}

/// What a value of the row is: "FILE", or "NUMBER (scene units, above 0)".
std::string value_text(const OptionRow& row) {
  const std::string range = range_text(row);
  return row.value + (range.empty() ? "" : " (" + range + ")");
}

/// The row that CLI11 complains of: its messages begin with a name and a colon.
const OptionRow* row_of(const Command& command, const std::string& complaint) {
  const std::string name = complaint.substr(0, complaint.find(':'));
  const auto row = std::ranges::find(command.rows, name, &OptionRow::long_name);
  return row == command.rows.end() ? nullptr : &*row;
}

/// Fails on a word that no option takes.
[[noreturn]] void refuse_extra(const Command& command, const std::string& extra) {
  if (extra.starts_with('-')) {
    const std::string option = extra.substr(0, extra.find('='));
    fail(ErrorKind::usage, "there is no option {}{}", option, suggested_options(command, option));
  }
  Words places;
  for (const auto& row : command.rows)
    if (!row.name.starts_with('-')) places.push_back(row.name);
  if (places.empty()) fail(ErrorKind::usage, "{}: {} takes options only", extra, command.name);
  static const std::regex range(R"(\[?\d+-\d+(?:[x:]\d+)?\]?)");
  if (std::regex_match(extra, range) && std::ranges::count(command.rows, "--frames", &OptionRow::long_name) > 0)
    fail(ErrorKind::usage, "{}: a range of frames belongs to --frames", extra);
  const std::string pattern = names_input(extra) ? pattern_for(extra) : "";
  fail(ErrorKind::usage, "{}: {} takes one {}{}", extra, command.name, fmt::join(places, " and one "),
       pattern.empty() ? "" : "; a sequence is one name with a pattern: write " + pattern);
}

/// CLI11's complaint as one sentence in the words of the table.
[[noreturn]] void complain(const Command& command, const CLI::App& app, const CLI::ParseError& error) {
  std::string text = error.what();
  std::ranges::replace(text, '\n', ' ');
  auto rest = app.remaining();
  std::erase(rest, "--");
  if (dynamic_cast<const CLI::ExtrasError*>(&error) && !rest.empty()) {
    if (const CLI::Option* set = app.get_option_no_throw("--set"))
      for (const std::string& word : set->results())
        if (word.find('=') == word.npos)
          fail(ErrorKind::usage, "--set {0} {1}: did you mean --set {0}={1}?", word, rest.front());
    refuse_extra(command, rest.front());
  }
  const OptionRow* row = row_of(command, text);
  if (row && dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
    const bool is_repeated = text.find("At Most") != text.npos;
    if (is_repeated) fail(ErrorKind::usage, "{} is given more than once", row->long_name());
    fail(ErrorKind::usage, "{} needs a value: {}", row->long_name(), value_text(*row));
  }
  if (dynamic_cast<const CLI::RequiredError*>(&error)) {
    const std::string name = text.substr(0, text.find(' '));
    const auto missing = std::ranges::find(command.rows, name, &OptionRow::name);
    if (missing != command.rows.end()) fail(ErrorKind::usage, "{} is missing: {}", name, missing->sentence);
  }
  fail(ErrorKind::usage, "{}", text);
}

void print_help(const Command& command, bool shows_all) {
  const Parser parser(command, shows_all || !has_common_rows(command));
  fmt::print("{}", parser.app.help());
}

}  // namespace

bool has_common_rows(const Command& command) { return std::ranges::any_of(command.rows, &OptionRow::is_common); }

std::optional<std::vector<TypedOption>> typed_options(const Command& command,
                                                      const std::vector<std::string>& arguments) {
  Parser parser(command, true);
  try {
    parser.app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForAllHelp&) {
    print_help(command, true);
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    print_help(command, false);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    with_help(command, [&] { complain(command, parser.app, error); });
  }
  std::vector<TypedOption> typed;
  for (std::size_t i = 0; i < command.rows.size(); i++)
    if (parser.options[i]->count() > 0) typed.push_back({command.rows[i].name, parser.options[i]->reduced_results()});
  return typed;
}

void with_help(const Command& command, const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage || std::string_view(error.what()).find("--help") != std::string_view::npos)
      throw;
    fail(ErrorKind::usage, "{}{}", error.what(), see_help(command, error.what()));
  }
}

// Words that are inputs: by the file, by the ending, by the pattern.

namespace {

/// The endings of what a frame may be read from.
constexpr std::array<std::string_view, 13> kEndings = {".exr", ".sxr", ".mxr", ".dds", ".npy", ".tif", ".tiff",
                                                       ".png", ".tga", ".bmp", ".hdr", ".pic", ".rgbe"};

bool is_pattern(const std::string& word) {
  try {
    return frame_pattern(word).has_value();
  } catch (const Error&) {
    return true;  // of two tokens, which the command that takes it complains of
  }
}

}  // namespace

bool names_input(const std::string& word) {
  if (word.empty() || word.starts_with('-')) return false;
  std::error_code error;
  const std::filesystem::path path(word);
  if (std::filesystem::is_regular_file(path, error)) return true;
  const std::string ending = lower_case(path.extension().string());
  return std::ranges::find(kEndings, ending) != kEndings.end() || is_pattern(word);
}

void remove_earlier(const std::vector<std::string>& reports) {
  std::error_code none;
  for (const auto& path : reports)
    if (!path.empty()) std::filesystem::remove(path, none);
}

}  // namespace alcove
