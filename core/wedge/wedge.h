// A wedge: a frame, or a few, in many looks, each of which a command makes; as a page, and as one labelled picture.
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
  std::string name;                 // each look has another one
  std::string command;              // the run that gives its bits
  Settings settings;                // of that run
  double ms = 0;                    // of device time, for all frames
  Notes notes = {};                 // on its frames
  std::optional<Error> error = {};  // why one of its frames failed
};

/// Whether a look shows lights: it turns a sun, or its composite dims their layers.
bool shows_lights(const Settings& settings);

/// Computes looks of the same frames, which are read alike, and once; all but time, notes and errors is given. Looks
/// that differ only in their shaping have one estimate. Writes a page and a sheet; "" stands for none. A row of the
/// sheet has all radii, where there are several and anything else differs too. A look that fails is left out. Fails
/// with the first error where all looks fail, and with ErrorKind::output.
void make_wedge(std::vector<WedgeLook>& looks, const std::string& page, const std::string& sheet);

/// What make_wedge() would do, as --dry-run prints it. Computes and writes nothing. Fails as that would on settings,
/// names, and a single frame that cannot be read as it is.
std::string wedge_text(const std::vector<WedgeLook>& looks);

}  // namespace alcove
