// A wedge: one frame, or a few, in many looks, with the command of each look. It is a page, or one labelled picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/note.h"
#include "core/base/settings.h"

namespace alcove {

struct WedgeLook {
  std::string name;                 // unique among the looks
  std::string command;              // a run with the same bits
  Settings settings;                // of that run
  double ms = 0;                    // device time of all frames
  Notes notes = {};                 // on its frames
  std::optional<Error> error = {};  // the failure of one of its frames
};

/// Whether a look shows lights: it turns a sun, or its composite dims layers of lights.
bool shows_lights(const Settings& settings);

/// Computes looks of the same frames, and fills in their time, notes and errors. Each frame is read once, in one way
/// for all looks. Looks that differ only in their shaping share one estimate. Writes the page and the sheet; each is
/// left out if its path is "". If looks differ in radius and in something else, each row of the sheet has one look at
/// all radii. The pictures leave out a look that fails. If all looks fail, the error of the first one is thrown. Fails
/// with ErrorKind::output if a file cannot be written.
void make_wedge(std::vector<WedgeLook>& looks, const std::string& page, const std::string& sheet);

/// The text of --dry-run: frames, looks, memory and cost. Computes and writes nothing. Fails as make_wedge() does on
/// settings, on names, and on a single frame that cannot be read.
std::string wedge_text(const std::vector<WedgeLook>& looks);

}  // namespace alcove
