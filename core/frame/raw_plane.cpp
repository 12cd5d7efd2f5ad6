// What follows from the table of planes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/raw_plane.h"

namespace alcove {

std::vector<FileOption> plane_file_options() {
  std::vector<FileOption> options{{"INPUT", &InputSettings::input}};
  for (const auto& row : kRawPlanes)
    for (const FileOption& file : {row.file, row.other_file})
      if (file.path) options.push_back(file);
  return options;
}

std::vector<std::string> input_files(const InputSettings& input) {
  std::vector<std::string> files{input.camera};
  for (const auto& file : plane_file_options()) files.push_back(input.*file.path);
  return files;
}

}  // namespace alcove
