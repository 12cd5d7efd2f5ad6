// From what presets and the command line say to the settings that count: what beats what, what is refused.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/options/options.h"

namespace alcove {

/// What was said of one option, and where.
struct Said {
  std::string option;  // its long name
  Words words;
  std::string preset = {};  // the preset that said it; "": the command line

  bool is_typed() const { return preset.empty(); }
};

/// For whom options are read. `alcove inspect` writes no outputs: there, no setting lacks one.
enum class Reader { run, inspect };

/// Reads into `options` what was said, presets in their order and then the command line; later wins. What has no effect
/// beside the rest is left out of presets, the earliest first. Fails with ErrorKind::usage on a value that is none, on
/// what is typed and has no effect, and on settings of one preset that take each other's effect.
void read_said(RunOptions& options, std::vector<Said> said, Reader reader = Reader::run);

/// Fails with ErrorKind::usage where a setting that is not the usual one has no effect.
void require_effects(const Settings& settings);

}  // namespace alcove
