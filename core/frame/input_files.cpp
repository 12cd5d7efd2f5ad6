// Lists the files that the settings of a frame name.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/input_files.h"

#include "core/frame/raw_plane.h"

namespace alcove {

const std::string& main_input(const InputSettings& settings) {
  if (!settings.input.empty()) return settings.input;
  return settings.depth.empty() ? settings.position : settings.depth;
}

std::vector<std::string> input_files(const InputSettings& settings) {
  std::vector<std::string> files{settings.camera};
  for (const auto& file : plane_file_options()) files.push_back(settings.*file.path);
  return files;
}

}  // namespace alcove
