// Finds presets, by their names or as files.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "cli/options.h"
#include "core/base/error.h"
#include "core/base/system.h"
#include "core/base/text.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

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
  std::error_code error;
  if (fs::exists(name, error) && !fs::is_directory(name, error)) return name;
  fail(ErrorKind::usage, "there is no preset {}{}; there is {}; --preset takes one of them, or a TOML file", name,
       suggestion(name, names), list_of(names));
}

}  // namespace alcove
