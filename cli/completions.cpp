// Completions for bash. Options and their words stand in the script; presets and devices are asked of the program when
// they are wanted.
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

}  // namespace alcove
