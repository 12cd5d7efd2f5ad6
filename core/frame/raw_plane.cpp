// What follows from the table of planes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/raw_plane.h"

namespace alcove {

std::vector<FileOption> plane_file_options() {
  std::vector<FileOption> options{{"INPUT", &InputSettings::input}};
  for (const auto& row : kRawPlanes)
    for (const FileOption& file : {row.file, row.other_file, row.third_file})
      if (file.path)
        options.push_back(file);
      else if (file.list)
        for (std::size_t i = 0; i < kMostBehind; i++) options.push_back({file.option, nullptr, file.list, i});
  return options;
}

}  // namespace alcove
