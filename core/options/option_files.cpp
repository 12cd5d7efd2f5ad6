// INPUT, and rows of the table of options.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/option_files.h"

#include "core/options/options.h"

namespace alcove {

const std::vector<SettingRow>& file_rows() {
  static const std::vector<SettingRow> kRows = [] {
    std::vector<SettingRow> rows;
    OptionGroup(rows, "", Effect::pixels, &Settings::input)
        .text("INPUT", &InputSettings::input, "",
              "an EXR file with depth and normals, or a pattern such as frame.%04d.exr")
        .names(FileRole::input);
    std::ranges::copy_if(option_table(), std::back_inserter(rows),
                         [](const SettingRow& row) { return row.role != FileRole::none; });
    return rows;
  }();
  return kRows;
}

std::vector<NamedFile> files_of(const Settings& settings, FileRole role) {
  return files_of(file_rows(), settings, role);
}

}  // namespace alcove
