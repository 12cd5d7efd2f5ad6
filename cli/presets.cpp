// Where presets lie and what they say; `alcove presets` lists them, or prints one.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/parsing.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/options/options.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_directory(path, error);
}

}  // namespace

std::string preset_folder() {
  std::vector<fs::path> places;
  if (const char* variable = std::getenv("ALCOVE_PRESETS"); variable && *variable)
    places.emplace_back(variable);
  else
    for (const char* place : {"presets", "../presets", "../share/alcove/presets"})
      places.push_back(fs::path(program_folder()) / place);
  std::error_code error;
  for (const auto& place : places)
    if (fs::is_directory(place, error)) return fs::weakly_canonical(place).string();
  fail(ErrorKind::usage, "no folder of presets at {}; the variable ALCOVE_PRESETS names one", places.front().string());
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  const fs::path folder = preset_folder();
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".toml")
      names.push_back(entry->path().lexically_relative(folder).replace_extension().string());
  std::ranges::sort(names);
  return names;
}

std::string preset_file(const std::string& name) {
  // A known name is never a file that happens to lie in the working directory.
  const auto names = preset_names();
  if (std::ranges::find(names, name) != names.end()) return preset_folder() + "/" + name + ".toml";
  if (is_file(name)) return name;
  if (const auto known = std::ranges::find(names, lower_case(name), lower_case); known != names.end())
    return preset_folder() + "/" + *known + ".toml";
  std::vector<std::string> own = names;
  std::erase_if(own, [](const auto& known) { return known.find('/') != known.npos; });
  fail(ErrorKind::usage,
       "there is no preset {}{}; there is {}, and alcove presets lists all; --preset takes one of them, or a TOML file",
       name, suggestion(name, names), list_of(own));
}

std::vector<std::string> presets_of(const std::vector<std::string>& words) {
  std::vector<std::string> presets;
  for (const auto& word : words) {
    const auto parts = is_file(word) ? std::vector{word} : split(word);
    presets.insert(presets.end(), parts.begin(), parts.end());
  }
  return presets;
}

std::vector<OptionValue> values_of_preset(const std::string& preset) {
  return preset_values(preset, read_text(preset_file(preset), "preset", "--preset"));
}

std::string preset_sentence(const std::string& text) {
  if (!text.starts_with('#')) return "";
  const std::string line = text.substr(1, text.find('\n') - 1);
  // A full stop within a number or a name ends no sentence.
  std::string sentence = line.substr(0, line.find(". "));
  sentence.erase(0, sentence.find_first_not_of(' '));
  sentence.erase(sentence.find_last_not_of(" .\r") + 1);
  return sentence;
}

// The command.

namespace {

/// A preset as it is listed.
struct Listed {
  std::string name, group, sentence;
};

/// A folder of presets, "" for those that lie in none, and what it is for.
struct Group {
  std::string name, heading;
};

/// Ours come first, then other folders of the user's, then the systems whose look may be wanted, then the programs.
std::vector<Group> groups_of(const std::vector<Listed>& presets) {
  std::vector<Group> groups{{"", "Quality, from fast to exact (alcove run --preset NAME)"}};
  const Group sources{"source",
                      "The look of the systems that Alcove grew out of, by their own parameters: to match a frame of "
                      "theirs, or to compare with them"};
  const Group inputs{"input",
                     "The programs that frames come from, found by themselves: to say which where that goes wrong, as "
                     "--source does"};
  for (const auto& preset : presets) {
    const bool is_known = preset.group == sources.name || preset.group == inputs.name ||
                          std::ranges::find(groups, preset.group, &Group::name) != groups.end();
    if (!is_known) groups.push_back({preset.group, preset.group});
  }
  groups.insert(groups.end(), {sources, inputs});
  return groups;
}

/// The order of what we make ourselves is that of the time they take; others come by their names.
int rank_of(const std::string& name) {
  const std::vector<std::string> ours{"draft", "standard", "production", "reference"};
  return int(std::ranges::find(ours, name) - ours.begin());
}

std::vector<Listed> listed_presets() {
  std::vector<Listed> presets;
  for (const auto& name : preset_names()) {
    const std::size_t slash = name.find('/');
    const std::string text = read_text(preset_file(name), "preset", "NAME");
    presets.push_back({name, slash == name.npos ? "" : name.substr(0, slash), preset_sentence(text)});
  }
  std::ranges::stable_sort(presets, {}, [](const Listed& preset) { return rank_of(preset.name); });
  return presets;
}

void print_list(const std::vector<Listed>& presets) {
  std::size_t width = 0;
  for (const auto& preset : presets) width = std::max(width, preset.name.size());
  bool is_first = true;
  for (const auto& group : groups_of(presets)) {
    if (std::ranges::find(presets, group.name, &Listed::group) == presets.end()) continue;
    fmt::print("{}{}:\n", is_first ? "" : "\n", printable(group.heading));
    is_first = false;
    for (const auto& preset : presets)
      if (preset.group == group.name)
        fmt::print("  {:<{}}{}{}\n", printable(preset.name), preset.sentence.empty() ? 0 : width,
                   preset.sentence.empty() ? "" : "  ", printable(preset.sentence));
  }
}

void print_json(const std::vector<Listed>& presets) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& preset : presets)
    list.push_back({{"name", preset.name},
                    {"group", preset.group},
                    {"sentence", preset.sentence},
                    {"file", preset_file(preset.name)}});
  fmt::print("{}\n", json_text(list, 1));
}

struct PresetsArguments {
  std::string name;
  bool json = false;
};

CommandOf<PresetsArguments> presets_syntax() {
  CommandOf<PresetsArguments> command{"alcove presets",
                                      "Lists the presets with what each is for, or prints the one of that name.\n"};
  OptionGroup(command.rows, "", Effect::none)
      .text("NAME", &PresetsArguments::name, "", "a preset to print, or a TOML file")
      .names(FileRole::input);
  OptionGroup(command.rows, "Options", Effect::none)
      .flag("--json", &PresetsArguments::json, "print the list as JSON: name, group, sentence, file");
  return command;
}

}  // namespace

Command describe_presets() { return presets_syntax().shown(); }

int presets_command(const std::vector<std::string>& arguments) {
  const auto parsed = presets_syntax().parse(arguments);
  if (!parsed) return 0;
  const auto& [name, json] = *parsed;
  if (!name.empty() && json) fail(ErrorKind::usage, "--json is of the list; {} is printed as it is", name);
  if (!name.empty())
    fmt::print("{}", read_text(preset_file(name), "preset", "NAME"));
  else if (json)
    print_json(listed_presets());
  else
    print_list(listed_presets());
  return 0;
}

}  // namespace alcove
