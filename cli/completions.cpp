// Completions for bash, zsh and fish. Options and their words stand in the scripts; presets and devices are asked of
// the program when they are wanted.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>

#include "cli/commands.h"
#include "cli/generate.h"

namespace alcove {
namespace {

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

}  // namespace

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
      for (const auto& name : names_of_row(row)) {
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

namespace {

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
  const auto names = names_of_row(row);
  const std::string text = fmt::format("[{}]{}", for_brackets(row.sentence), row.is_flag() ? "" : what);
  std::vector<std::string> specs;
  for (const auto& name : names) {
    const bool is_long = name.starts_with("--");
    const std::string takes = row.is_flag() ? "" : is_long ? "=" : "+";
    specs.push_back(quoted((row.repeats ? "*" : fmt::format("({})", fmt::join(names, " "))) + name + takes + text));
  }
  return fmt::format("{}", fmt::join(specs, " "));
}

}  // namespace

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
        for (const auto& name : names_of_row(row))
          out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
        if (!row.is_flag()) out += value.is_file || value.is_folder ? " -r -F" : " -x";
      }
      if (!words.empty()) out += fmt::format(" -a {}", quoted(fmt::format("{}", fmt::join(words, " "))));
      out += fmt::format(" -d {}\n", quoted(row.sentence));
    }
  }
  return out;
}

}  // namespace alcove
