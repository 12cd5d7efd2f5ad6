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

/// For whom options are read. `alcove inspect` writes no outputs: there, none of its options can lack one.
enum class Reader { run, inspect };

/// Reads into `options` what was said, presets in their order and then the command line; later wins. Of options that
/// contradict each other what is typed beats presets, and a later preset beats an earlier one. What does not apply is
/// left out of presets. Fails with ErrorKind::usage on a value that is none, on what does not apply but was typed, and
/// on contradictions of one preset or of the command line.
void read_said(RunOptions& options, std::vector<Said> said, Reader reader = Reader::run);

/// Why two options contradict each other by their present values, by the row of either; "" where they do not.
std::string quarrel(const OptionRow& a, const OptionRow& b);

/// Fails with ErrorKind::usage where settings ask for what does not apply, or contradict each other, by the table.
void require_applicable(const Settings& settings);

}  // namespace alcove
