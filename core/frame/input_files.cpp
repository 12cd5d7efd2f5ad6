// Lists the files that the settings of a frame name.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/input_files.h"

namespace alcove {

const std::string& main_input(const InputSettings& settings) {
  if (!settings.input.empty()) return settings.input;
  return settings.depth.empty() ? settings.position : settings.depth;
}

std::vector<std::string> input_files(const InputSettings& settings) {
  return {settings.input,  settings.depth,  settings.normal,      settings.position,
          settings.beauty, settings.camera, settings.material_ao, settings.albedo};
}

}  // namespace alcove
