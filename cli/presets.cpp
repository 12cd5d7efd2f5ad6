// Where presets lie and what they say; `alcove presets` lists them, or prints one.
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/base/toml.h"
#include "core/formats/sequence.h"
#include "core/options/options.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_directory(path, error);
}

/// What stands between two folders in a variable.
constexpr char kBetweenFolders = fs::path::preferred_separator == '/' ? ':' : ';';

/// The user's own folders, which come before that of the program. One that is not there is passed over, as in PATH.
std::vector<std::string> own_folders() {
  std::vector<std::string> folders;
  std::error_code error;
  const char* path = std::getenv("ALCOVE_PRESET_PATH");
  std::istringstream list(path ? path : "");
  for (std::string folder; std::getline(list, folder, kBetweenFolders);)
    if (!folder.empty() && fs::is_directory(folder, error)) folders.push_back(folder);
  const fs::path own = fs::path(config_home()) / "alcove/presets";
  if (!config_home().empty() && fs::is_directory(own, error)) folders.push_back(own.string());
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
      names.push_back(entry->path().lexically_relative(folder).replace_extension().generic_string());
  return names;
}

/// The files of a known name, in the order of the folders.
std::vector<std::string> files_of_name(const std::string& name) {
  std::vector<std::string> files;
  for (const auto& folder : all_folders())
    if (const std::string file = folder + "/" + name + ".toml"; is_file(file)) files.push_back(file);
  return files;
}

[[noreturn]] void fail_unknown(const std::string& name, const std::vector<std::string>& names) {
  std::vector<std::string> own = names;
  std::erase_if(own, [](const auto& known) { return known.find('/') != known.npos; });
  fail(ErrorKind::usage,
       "there is no preset {}{}; there is {}, and alcove presets lists all; --preset takes one of them, or a TOML file",
       name, suggestion(name, names), list_of(own));
}

/// The file that a preset builds on. A name leads past the preset itself: `draft` of a show builds on that of the
/// program. Another word is a file beside the preset, or at a whole path.
std::string base_file(const std::string& file, std::string name) {
  if (files_of_name(name).empty()) {
    const std::string beside = path_from(fs::path(file).parent_path().string(), name);
    if (is_file(beside)) return beside;
    const auto names = preset_names();
    const auto known = std::ranges::find(names, lower_case(name), lower_case);
    if (known == names.end() && name.ends_with(".toml"))
      fail(ErrorKind::usage, "there is no file {}, on which it builds", visible(beside));
    if (known == names.end()) fail_unknown(name, names);
    name = *known;
  }
  const auto files = files_of_name(name);
  std::error_code error;
  const auto itself =
      std::ranges::find_if(files, [&](const auto& other) { return fs::equivalent(other, file, error); });
  if (itself == files.end()) return files.front();
  if (itself + 1 == files.end())
    fail(ErrorKind::usage, "it builds on itself: no folder after its own has a preset {}", name);
  return *(itself + 1);
}

/// A preset as it is named, and its file with the values in it.
struct ReadPreset {
  std::string name, file;
  std::vector<OptionValue> values;
};

/// Files that a preset names lie beside it, as those of a list of frames do.
void find_beside(const fs::path& preset, OptionValue& value) {
  for (auto& word : value.words) {
    if (!value.row->names_file(word)) continue;
    refuse_token_of_folder(*value.row, word, preset.parent_path().string());
    word = path_from(preset.parent_path().string(), word);
  }
}

/// Reads a preset, and tells what it builds on; "" for nothing.
std::string read_preset(ReadPreset& preset) {
  const std::string text = read_text(preset.file, "preset", "--preset");
  preset.values = preset_values(preset.name, text, true);
  for (auto& value : preset.values) find_beside(preset.file, value);
  try {
    const auto entries = parse_flat_toml(text);
    const auto base = std::ranges::find(entries, "preset", &FlatEntry::key);
    if (base == entries.end()) return "";
    if (base->values.size() != 1) fail(ErrorKind::usage, "preset takes one name, and the list has several");
    return base_file(preset.file, base->values.front());
  } catch (const Error& error) {
    fail(error.kind(), "{} (--preset): {}", preset.name, error.what());
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
  if (std::ranges::find(names, name) != names.end()) return files_of_name(name).front();
  if (is_file(name)) return name;
  if (const auto known = std::ranges::find(names, lower_case(name), lower_case); known != names.end())
    return files_of_name(*known).front();
  fail_unknown(name, names);
}

std::vector<std::string> presets_of(const std::vector<std::string>& words) {
  std::vector<std::string> presets;
  for (const auto& word : words) {
    const auto parts = is_file(word) ? std::vector{word} : split(word);
    presets.insert(presets.end(), parts.begin(), parts.end());
  }
  return presets;
}

PresetChain read_chain(const std::string& name) {
  constexpr std::size_t kMost = 8;
  std::vector<ReadPreset> presets{{name, preset_file(name), {}}};
  for (std::string base; !(base = read_preset(presets.back())).empty();) {
    if (presets.size() == kMost)
      fail(ErrorKind::usage, "{} (--preset): it builds on itself, or on more than {} others", name, kMost);
    presets.push_back({base, base, {}});
  }
  PresetChain chain;
  std::ranges::reverse(presets);
  for (const auto& preset : presets) {
    chain.files.push_back(preset.file);
    std::ranges::copy(preset.values, std::back_inserter(chain.values));
  }
  return chain;
}

void refuse_token_of_folder(const SettingRow& row, const std::string& word, const std::string& folder) {
  if (fs::path(word).is_absolute() || is_file(path_from(folder, word))) return;
  if (const auto pattern = frame_pattern((fs::path(folder) / "_").string()))
    fail(
        ErrorKind::usage,
        "{} {}: a part of the folder {} is the place of a frame's number: rename the folder, or give the whole path of "
        "a file",
        row.long_name(), word, folder);
}

std::string project_file(const std::string& input) {
  std::error_code error;
  fs::path at = is_on_share(input) ? fs::path(input) : fs::absolute(input, error);
  // In /show/../a.exr, /show is no folder above it.
  if (!is_on_share(at.string())) at = at.lexically_normal();
  for (; at != at.parent_path(); at = at.parent_path())
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
  const Group sources{
      "source", "The look of the systems behind Alcove, by their own parameters: to match their frames, or to compare"};
  const Group inputs{"input", "The programs of frames, found automatically; name one if that fails, as --source does"};
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
  if (!name.empty() && json) fail(ErrorKind::usage, "--json lists presets; {} is printed as it is", name);
  if (!name.empty())
    fmt::print("{}", read_text(preset_file(name), "preset", "NAME"));
  else if (json)
    print_json(listed_presets());
  else
    print_list(listed_presets());
  return 0;
}

}  // namespace alcove
