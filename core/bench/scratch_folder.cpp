// Finds the system's place for files that are kept for a while.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/scratch_folder.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/system.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

/// The folder where files are kept for a while: std::filesystem::temp_directory_path() would not say which place it
/// cannot use.
fs::path folder_of_scratch() {
  const char* variable = std::getenv("TMPDIR");
  return variable && *variable ? variable : P_tmpdir;
}

}  // namespace

// make_unique_folder() draws the six letters.
ScratchFolder::ScratchFolder() : path_((folder_of_scratch() / ("alcove-bench-" + std::string(6, 'X'))).string()) {
  if (const auto why = make_unique_folder(path_))
    fail(ErrorKind::output, "{}: no folder for the frames can be made: {}; the variable TMPDIR names another place",
         path_, why.message());
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string ScratchFolder::file(int frame) const { return fmt::format("{}/ao.{:04}.exr", path_, frame); }

}  // namespace alcove
