// ONE table of the files of options: the rows of option tables that have a role. It gives the inputs of frames, their
// digests for --resume, the outputs, and the refusal to overwrite inputs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include "core/base/file.h"
#include "core/options/option_row.h"

namespace alcove {

/// The files that options name in a role, in the order of the rows.
template <class Options>
std::vector<NamedFile> files_of(const std::vector<RowOf<Options>>& rows, const Options& options, FileRole role) {
  std::vector<NamedFile> files;
  for (const auto& row : rows) std::ranges::copy(row.files(options, role), std::back_inserter(files));
  return files;
}

/// INPUT, and the rows of the table of options that name files.
const std::vector<SettingRow>& file_rows();

/// The files that settings name in a role.
std::vector<NamedFile> files_of(const Settings& settings, FileRole role);

}  // namespace alcove
