// The table of subcommands, and the texts that are made of it and of their rows: man pages, in the macros of man(7),
// and completions for bash, zsh and fish. Options and their words stand in the scripts; presets and devices are asked
// of the program when they are wanted.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <sstream>

#include "cli/options.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/gpu/device_info.h"
#include "core/options/options.h"

namespace alcove {

const std::vector<Subcommand>& subcommands() {
  static const std::vector<Subcommand> kTable{
      {"run", "compute ambient occlusion from a frame's depth and normals", run_command, describe_run},
      {"inspect", "describe a frame, its reading, and missing inputs", inspect_command, describe_inspect},
      {"wedge", "show a frame in many looks, with the command of each", wedge_command, describe_wedge},
      {"compare", "measure the error of a result against a reference", compare_command, describe_compare},
      {"bench", "measure device time against error", bench_command, describe_bench},
      {"presets", "list the presets, or print one", presets_command, describe_presets},
      {"devices", "list the Vulkan devices", devices_command, describe_devices},
      {"doctor", "print the facts for a bug report: devices, libraries, folders, memory", doctor_command,
       describe_doctor},
  };
  return kTable;
}

namespace {

/// A command's rows: its places, its help, and its options.
std::vector<OptionRow> rows_with_help(const Command& command) {
  std::vector<OptionRow> rows;
  const auto is_place = [](const OptionRow& row) { return !row.name.starts_with('-'); };
  std::ranges::copy_if(command.rows, std::back_inserter(rows), is_place);
  rows.push_back({.group = "Help", .name = "-h,--help", .sentence = "print the help and stop"});
  if (has_common_rows(command))
    rows.push_back({.group = "Help", .name = "--help-all", .sentence = "print all options and stop"});
  std::ranges::copy_if(command.rows, std::back_inserter(rows), std::not_fn(is_place));
  return rows;
}

// Man pages.

constexpr std::size_t kColumns = 79;

/// Text that roff takes for no command: hyphens are those of options, and lines begin with no dot.
std::string escaped(const std::string& text) {
  static const std::map<char, std::string> kEscapes{{'\\', "\\e"}, {'-', "\\-"}, {'~', "\\(ti"}, {'\'', "\\(aq"}};
  std::string out;
  for (const char c : text) out += kEscapes.contains(c) ? kEscapes.at(c) : std::string(1, c);
  return out.starts_with('.') ? "\\&" + out : out;
}

/// A paragraph in lines of roff: it is filled again where it is read.
std::string filled(const std::string& text) {
  std::string out, line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    word = escaped(word);
    if (!line.empty() && line.size() + 1 + word.size() > kColumns) {
      out += line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? out : out + line + "\n";
}

/// A description: paragraphs, and examples, whose lines are indented and stay as they are.
std::string described(const std::string& text) {
  std::string out, paragraph, examples;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line == "Example:" || line == "Examples:") continue;
    if (line.starts_with("  "))
      examples += escaped(line.substr(2)) + "\n";
    else
      paragraph += line + " ";
  }
  out += filled(paragraph);
  return examples.empty() ? out : out + ".SH EXAMPLES\n.EX\n" + examples + ".EE\n";
}

char upper(char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; }

std::string title(const std::string& name, const std::string& sentence) {
  std::string heading = name;
  std::ranges::transform(heading, heading.begin(), upper);
  return fmt::format(".TH {} 1 \"{}\" \"alcove {}\" \"User Commands\"\n.ad l\n.nh\n.SH NAME\n{} \\- {}\n",
                     escaped(heading), kReleaseDate, kVersion, escaped(name), escaped(sentence));
}

std::string heading_of(const OptionRow& row) {
  std::vector<std::string> names;
  for (const auto& name : split(row.name)) names.push_back("\\fB" + escaped(name) + "\\fR");
  std::string value;  // lines may break behind each word of a list
  for (const char c : escaped(row.value)) value += c == '|' ? std::string("|\\:") : std::string(1, c);
  return fmt::format("{}{}", fmt::join(names, ", "), value.empty() ? "" : " \\fI" + value + "\\fR");
}

/// What stands below a row's heading: its sentence, range and default.
std::string text_of(const OptionRow& row) {
  std::vector<std::string> facts;
  if (const std::string range = range_text(row); !range.empty()) facts.push_back(range);
  if (!row.default_text.empty()) facts.push_back("default: " + row.default_text);
  return upper(row.sentence[0]) + row.sentence.substr(1) +
         (facts.empty() ? "." : fmt::format(" ({}).", fmt::join(facts, "; ")));
}

std::string options_of(const Command& command) {
  std::string out = ".SH OPTIONS\n", group;
  for (const auto& row : rows_with_help(command)) {
    if (row.group != group && !row.group.empty()) out += ".SS " + escaped(row.group) + "\n";
    group = row.group;
    out += ".TP\n" + heading_of(row) + "\n" + filled(text_of(row));
  }
  return out;
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n.TP\n0\nAll was done.\n.TP\n1\nSome frames failed.\n.TP\n2\nUsage or settings.\n.TP\n3\nAn input "
    "is missing or cannot be read.\n.TP\n4\nAn output could not be written.\n.TP\n5\nThere is no device, or it was "
    "lost.\n"
    ".TP\n6\nA comparison failed.\n.TP\n128 and more\nThe number of the signal that ended the run, plus 128.\n";

constexpr const char* kEnvironment =
    ".SH ENVIRONMENT\n.TP\nALCOVE_PRESETS\nThe folder of presets.\n.TP\nALCOVE_PRESET_PATH\n"
    "Folders of further presets, with colons, which come first.\n.TP\nOCIO\nThe colour configuration of composites "
    "and previews.\n";

std::string see_also(const std::string& but) {
  std::vector<std::string> pages;
  if (!but.empty()) pages.emplace_back("\\fBalcove\\fR(1)");
  for (const auto& command : subcommands())
    if (command.name != but) pages.push_back("\\fBalcove\\-" + command.name + "\\fR(1)");
  return fmt::format(".SH SEE ALSO\n{}\n", fmt::join(pages, ",\n"));
}

std::string man_page() {
  std::string out = title("alcove", "ambient occlusion from rendered depth and normals");
  out +=
      ".SH SYNOPSIS\n\\fBalcove\\fR \\fICOMMAND\\fR [\\fIoptions\\fR]\n.br\n\\fBalcove\\fR \\fIFILE.exr\\fR "
      "[\\fIoptions\\fR]\n.SH DESCRIPTION\n";
  out += filled(
      "Computes ambient occlusion offline, from the depth and normals of a renderer or a game, and writes AO and "
      "composites as EXR files. An input without a command is run.");
  out += ".SH COMMANDS\n";
  for (const auto& [name, sentence, run, describe] : subcommands())
    out += fmt::format(".TP\n\\fB{}\\fR\n{}See \\fBalcove\\-{}\\fR(1).\n", name,
                       filled(upper(sentence[0]) + sentence.substr(1) + "."), name);
  out +=
      ".SH OPTIONS\n.TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nPrint the commands and stop.\n.TP\n\\fB\\-\\-version\\fR\n"
      "Print version, build and libraries and stop.\n";
  return out + kExitStatus + kEnvironment + see_also("");
}

std::string man_page_of(const std::string& name) {
  const auto entry = std::ranges::find(subcommands(), name, &Subcommand::name);
  if (entry == subcommands().end()) fail(ErrorKind::usage, "--generate man {}: there is no such command", name);
  const Command command = entry->describe();
  std::string out = title("alcove-" + name, entry->sentence) + ".SH SYNOPSIS\n\\fBalcove " + name + "\\fR";
  for (const auto& row : command.rows)
    if (!row.name.starts_with('-'))
      out += row.is_required ? " \\fI" + row.name + "\\fR" : " [\\fI" + row.name + "\\fR]";
  out += " [\\fIoptions\\fR]\n.SH DESCRIPTION\n" + described(command.description);
  return out + options_of(command) + see_also(name);
}

// Completions.

/// What may stand behind an option, or at a place.
struct Value {
  std::vector<std::string> words;  // as they are typed
  std::string listed;              // "preset-names" or "device-names": what the program lists
  bool is_file = false, is_folder = false;
};

bool contains(const std::string& text, const char* part) { return text.find(part) != text.npos; }

/// By what help shows behind the option: a word in small letters is typed so, one in capitals stands for something.
Value value_of(const OptionRow& row) {
  Value value;
  const bool is_place = !row.name.starts_with('-');
  if (row.long_name() == "--preset" || row.name == "NAME") value.listed = "preset-names";
  if (row.long_name() == "--device") value.listed = "device-names";
  value.is_folder = contains(row.value, "FOLDER");
  value.is_file = is_place || contains(row.value, "FILE") || contains(row.value, "PROGRAM");
  std::istringstream words(row.value);
  for (std::string word; std::getline(words, word, '|');) {
    const bool is_typed = std::ranges::all_of(word, [](char c) {
      return std::islower((unsigned char)c) || std::isdigit((unsigned char)c) || c == '-' || c == '.';
    });
    if (is_typed && word.size() > 1 && row.value.find('|') != row.value.npos) value.words.push_back(word);
  }
  return value;
}

std::vector<std::string> names_of_commands() {
  std::vector<std::string> names;
  for (const auto& command : subcommands()) names.push_back(command.name);
  return names;
}

/// A text within single quotes of a shell.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

// bash

/// How bash finds what an option takes, "" where the shell's own completion of files does.
std::string bash_words(const Value& value) {
  const std::string words = fmt::format("{}", fmt::join(value.words, " "));
  if (!value.listed.empty())
    return fmt::format("words=\"{}{}$(alcove --generate {} 2>/dev/null)\"", words, words.empty() ? "" : " ",
                       value.listed);
  if (!value.words.empty()) return fmt::format("words=\"{}\"", words);
  return value.is_file || value.is_folder ? "" : "none=1";
}

std::string bash_completion() {
  std::map<std::string, std::vector<std::string>> patterns;  // by what is done for them
  std::string options, places;
  for (const auto& entry : subcommands()) {
    const Command command = entry.describe();
    std::vector<std::string> names;
    for (const auto& row : rows_with_help(command)) {
      const std::string words = bash_words(value_of(row));
      if (!row.name.starts_with('-')) {
        if (!words.empty()) places += fmt::format("      {}) {} ;;\n", entry.name, words);
        continue;
      }
      for (const auto& name : split(row.name)) {
        names.push_back(name);
        if (!row.is_flag()) patterns[words].push_back(fmt::format("\"{} {}\"", entry.name, name));
      }
    }
    options += fmt::format("      {}) words=\"{}\" ;;\n", entry.name, fmt::join(names, " "));
  }
  std::string values;
  for (const auto& [words, which] : patterns)
    values += fmt::format("    {}) {} ;;\n", fmt::join(which, " | "), words.empty() ? ":" : words);
  const std::string commands = fmt::format("{}", fmt::join(names_of_commands(), " "));
  return fmt::format(
      R"SH(# bash completion for alcove. This file is made by `alcove --generate bash`.
_alcove() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" previous="${{COMP_WORDS[COMP_CWORD-1]}}" command="${{COMP_WORDS[1]}}"
  local words= none=
  COMPREPLY=()
  # --option=value comes as three words.
  if [ "$current" = = ]; then current=
  elif [ "$previous" = = ]; then previous="${{COMP_WORDS[COMP_CWORD-2]}}"; fi
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "{0} help --help --version" -- "$current"
      [ -z "$current" ] || compgen -f -- "$current")
    return
  fi
  if [ "$command" = help ]; then
    mapfile -t COMPREPLY < <(compgen -W "{0}" -- "$current")
    return
  fi
  case " {0} " in *" $command "*) ;; *) command=run ;; esac
  case "$command $previous" in
{1}    *) case "$current" in
      -*) case "$command" in
{2}      esac ;;
      *) case "$command" in
{3}      esac ;;
    esac ;;
  esac
  # Without words, the shell offers files, but not where a number stands.
  if [ -n "$words" ]; then mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  elif [ -n "$none" ]; then compopt +o default 2>/dev/null; fi
}}
complete -o default -F _alcove alcove
)SH",
      commands, values, options, places);
}

// zsh

/// A text within the brackets of _arguments.
std::string for_brackets(const std::string& text) {
  std::string out;
  for (const char c : text) out += (c == '[' || c == ']' || c == ':' || c == '\\' ? "\\" : "") + std::string(1, c);
  return out;
}

/// A call that offers the value; " " offers nothing, and zsh shows what is wanted. Without the space in front,
/// _arguments would put options before ours.
std::string zsh_action(const Value& value) {
  const char* const places = value.is_file ? "files" : value.is_folder ? "folders" : "";
  if (value.words.empty() && value.listed.empty() && !*places) return " ";
  return fmt::format(" _alcove_value \"{}\" \"{}\" \"{}\"", fmt::join(value.words, " "), value.listed, places);
}

std::string zsh_argument(const OptionRow& row) {
  const std::string what =
      fmt::format(":{}:{}", for_brackets(row.value.empty() ? row.name : row.value), zsh_action(value_of(row)));
  if (!row.name.starts_with('-')) return quoted((row.is_required ? ":" : "::") + what.substr(1));
  const auto names = split(row.name);
  const std::string text = fmt::format("[{}]{}", for_brackets(row.sentence), row.is_flag() ? "" : what);
  std::vector<std::string> specs;
  for (const auto& name : names) {
    const bool is_long = name.starts_with("--");
    const std::string takes = row.is_flag() ? "" : is_long ? "=" : "+";
    specs.push_back(quoted((row.repeats ? "*" : fmt::format("({})", fmt::join(names, " "))) + name + takes + text));
  }
  return fmt::format("{}", fmt::join(specs, " "));
}

std::string zsh_completion() {
  std::string names, cases;
  for (const auto& entry : subcommands()) {
    names += fmt::format("    {}\n", quoted(entry.name + ":" + entry.sentence));
    cases += fmt::format("    {})\n      _arguments -s -S", entry.name);
    for (const auto& row : rows_with_help(entry.describe())) cases += " \\\n        " + zsh_argument(row);
    cases += " ;;\n";
  }
  return fmt::format(R"SH(#compdef alcove
# zsh completion for alcove. This file is made by `alcove --generate zsh`.
# words, what the program lists, files or folders
_alcove_value() {{
  local offered=1
  [[ -n $1 ]] && compadd -- ${{=1}} && offered=0
  [[ -n $2 ]] && compadd -- ${{(f)"$(alcove --generate $2 2>/dev/null)"}} && offered=0
  case $3 in
    files) _files && offered=0 ;;
    folders) _files -/ && offered=0 ;;
  esac
  return offered
}}
_alcove() {{
  local -a commands=(
{0}    'help:print the help of a command'
  )
  if (( CURRENT == 2 )); then
    _describe command commands
    _files
    compadd -- --help --version
    return
  fi
  local command=$words[2]
  if [[ $command == help ]]; then
    _describe command commands
    return
  fi
  # A file as the first word is run.
  if (( ! ${{commands[(I)$command:*]}} )); then
    command=run
    words=(alcove run $words[2,-1])
    (( CURRENT++ ))
  fi
  shift words
  (( CURRENT-- ))
  case $command in
{1}  esac
}}
_alcove "$@"
)SH",
                     names, cases);
}

// fish

std::string fish_completion() {
  std::string out = fmt::format(R"SH(# fish completion for alcove. This file is made by `alcove --generate fish`.
function __alcove_command
    set -l words (commandline -opc)
    test (count $words) -ge 2; or return 1
    # A file as the first word is run.
    contains -- $words[2] {0} help; or set words[2] run
    test $words[2] = $argv[1]
end
complete -c alcove -n __fish_is_first_arg -l version -d 'Print version, build and libraries'
complete -c alcove -n __fish_is_first_arg -a help -d 'Print the help of a command'
complete -c alcove -n '__alcove_command help' -f -a '{0}'
)SH",
                                fmt::join(names_of_commands(), " "));
  for (const auto& entry : subcommands()) {
    out += fmt::format("complete -c alcove -n __fish_is_first_arg -a {} -d {}\n", entry.name, quoted(entry.sentence));
    for (const auto& row : rows_with_help(entry.describe())) {
      out += fmt::format("complete -c alcove -n '__alcove_command {}'", entry.name);
      const Value value = value_of(row);
      std::vector<std::string> words = value.words;
      if (!value.listed.empty()) words.push_back(fmt::format("(alcove --generate {} 2>/dev/null)", value.listed));
      if (row.name.starts_with('-')) {
        for (const auto& name : split(row.name))
          out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
        if (!row.is_flag()) out += value.is_file || value.is_folder ? " -r -F" : " -x";
      }
      if (!words.empty()) out += fmt::format(" -a {}", quoted(fmt::format("{}", fmt::join(words, " "))));
      out += fmt::format(" -d {}\n", quoted(row.sentence));
    }
  }
  return out;
}

// Which text is asked for.

std::string text_of(const std::string& what) {
  if (what == "man") return man_page();
  if (what == "bash") return bash_completion();
  if (what == "zsh") return zsh_completion();
  if (what == "fish") return fish_completion();
  std::vector<std::string> names;
  if (what == "preset-names")
    names = preset_names();
  else if (what == "device-names")
    for (const auto& device : gpu::list_devices()) names.push_back(std::to_string(device.index));
  else
    fail(ErrorKind::usage, "--generate {}: there are man, bash, zsh, fish, preset-names and device-names", what);
  return fmt::format("{}\n", fmt::join(names, "\n"));
}

}  // namespace

int generate(const std::vector<std::string>& arguments) {
  const bool is_page = arguments.size() == 2 && arguments[0] == "man";
  if (arguments.size() != 1 && !is_page)
    fail(ErrorKind::usage, "--generate takes man [COMMAND], bash, zsh or fish, not {} words", arguments.size());
  fmt::print("{}", is_page ? man_page_of(arguments[1]) : text_of(arguments[0]));
  return 0;
}

}  // namespace alcove
