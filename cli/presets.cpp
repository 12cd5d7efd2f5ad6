// Where presets lie and what they say; `alcove presets` lists them, or prints one.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/parsing.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/flat_toml.h"
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

namespace {

/// The user's own folders, which come before that of the program. One that is named and not there is an error: another
/// preset of the same name would be taken.
std::vector<std::string> own_folders() {
  std::vector<std::string> folders;
  std::error_code error;
  const char* path = std::getenv("ALCOVE_PRESET_PATH");
  std::istringstream list(path ? path : "");
  for (std::string folder; std::getline(list, folder, ':');) {
    if (folder.empty()) continue;
    if (!fs::is_directory(folder, error)) fail(ErrorKind::usage, "ALCOVE_PRESET_PATH: there is no folder {}", folder);
    folders.push_back(folder);
  }
  const char *config = std::getenv("XDG_CONFIG_HOME"), *home = std::getenv("HOME");
  const fs::path base = config && *config ? fs::path(config) : home ? fs::path(home) / ".config" : fs::path();
  if (!base.empty() && fs::is_directory(base / "alcove/presets", error)) folders.push_back(base / "alcove/presets");
  return folders;
}

std::vector<std::string> all_folders() {
  auto folders = own_folders();
  folders.push_back(preset_folder());
  return folders;
}

/// The names in a folder.
std::vector<std::string> names_below(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".toml")
      names.push_back(entry->path().lexically_relative(folder).replace_extension().string());
  return names;
}

/// The file of a known name, of the first folder that has it.
std::string file_of(const std::string& name) {
  for (const auto& folder : all_folders())
    if (const std::string file = folder + "/" + name + ".toml"; is_file(file)) return file;
  return "";
}

/// What a preset builds on: a known name, or a file, which is beside the preset or at a path of its own.
std::string base_of(const std::string& file, const FlatEntry& entry) {
  if (entry.values.size() != 1) fail(ErrorKind::usage, "preset takes one name, and the list has several");
  const std::string& name = entry.values.front();
  const std::string beside = (fs::path(file).parent_path() / name).string();
  const auto names = preset_names();
  return std::ranges::find(names, name) == names.end() && is_file(beside) ? beside : name;
}

/// A preset as it is named, its file, and the text of that.
struct ReadPreset {
  std::string name, file, text;
};

ReadPreset read_preset(const std::string& name) {
  const std::string file = preset_file(name);
  return {name, file, read_text(file, "preset", "--preset")};
}

/// The preset and those that it builds on, what is built on first.
std::vector<ReadPreset> chain_of(const std::string& preset) {
  constexpr std::size_t kMost = 8;
  std::vector<ReadPreset> chain;
  std::string name = preset;
  while (chain.size() < kMost) {
    const ReadPreset& last = chain.emplace_back(read_preset(name));
    const auto entries = parse_flat_toml(last.text);
    const auto base = std::ranges::find(entries, "preset", &FlatEntry::key);
    if (base == entries.end()) return {chain.rbegin(), chain.rend()};
    name = base_of(last.file, *base);
  }
  fail(ErrorKind::usage, "it builds on itself, or on more than {} others", kMost);
}

/// The same, with the preset in the sentence of an Error.
std::vector<ReadPreset> named_chain_of(const std::string& preset) {
  try {
    return chain_of(preset);
  } catch (const Error& error) {
    if (std::string(error.what()).find(preset) != std::string::npos) throw;
    fail(error.kind(), "{} (--preset): {}", preset, error.what());
  }
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
  std::set<std::string> names;
  for (const auto& folder : all_folders())
    for (auto& name : names_below(folder)) names.insert(std::move(name));
  return {names.begin(), names.end()};
}

std::string preset_file(const std::string& name) {
  // A known name is never a file that happens to lie in the working directory.
  const auto names = preset_names();
  if (std::ranges::find(names, name) != names.end()) return file_of(name);
  if (is_file(name)) return name;
  if (const auto known = std::ranges::find(names, lower_case(name), lower_case); known != names.end())
    return file_of(*known);
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
  std::vector<OptionValue> values;
  for (const auto& [name, file, text] : named_chain_of(preset))
    std::ranges::copy(preset_values(name, text, true), std::back_inserter(values));
  return values;
}

std::vector<std::string> files_of_preset(const std::string& preset) {
  std::vector<std::string> files;
  for (const auto& one : named_chain_of(preset)) files.push_back(one.file);
  return files;
}

std::string project_file(const std::string& input) {
  std::error_code error;
  // In /show/../a.exr, /show is no folder above it.
  for (fs::path at = fs::absolute(input, error).lexically_normal(); at != at.parent_path(); at = at.parent_path())
    if (const std::string file = (at.parent_path() / "alcove.toml").string(); is_file(file)) return file;
  fail(ErrorKind::usage, "--project: there is no alcove.toml beside {} or in a folder above it", visible(input));
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
