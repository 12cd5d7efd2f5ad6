// A wedge: a frame, or a few, in many looks, each of which a command makes; as a page, and as one labelled picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/note.h"
#include "core/base/settings.h"

namespace alcove {

struct WedgeLook {
  std::string name;     // by what tells it from the others, each another one
  std::string command;  // the run that gives its bits
  Settings settings;    // of that run; all looks have the same frames and the same options of the group Input
};

/// What became of a look.
struct WedgeTime {
  std::string look;
  double ms = 0;               // device time of all its frames
  Notes notes;                 // on its frames
  std::optional<Error> error;  // why it failed, in one of its frames at least
};

/// Computes all looks and writes the page and the sheet; "" stands for none. Each frame is read once. `columns` are
/// those of the sheet, 0: any. A look that fails is left out. Fails with the first error where all looks fail, and with
/// ErrorKind::output.
std::vector<WedgeTime> make_wedge(std::span<const WedgeLook> looks, const std::string& page, const std::string& sheet,
                                  std::size_t columns);

}  // namespace alcove
