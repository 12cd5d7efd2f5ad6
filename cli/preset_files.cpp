// Finds presets, by their names or as files.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "cli/options.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/options/presets.h"

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

std::vector<Said> said_by_preset(const std::string& preset, const std::vector<OptionRow>& table) {
  return said_by_text(preset, read_text(preset_file(preset), "preset", "--preset"), table);
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

}  // namespace alcove
