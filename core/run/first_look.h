// What is looked at before any frame of a run is computed: how its frames are read, what is noted of all of them, what
// the command line lacks, and what the run would do.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/settings.h"
#include "core/frame/gbuffer.h"
#include "core/run/plan.h"

namespace alcove {

/// Settles one frame of the plan, and all others are read in the same way. It is the first one that shows what files
/// and options leave open. None where no frame can be read, or only such as show nothing while others are refused: then
/// each is settled by itself.
std::optional<FrameSource> settle_first(const FramePlan& plan, std::uint64_t most_bytes);

/// The note on the number that a single file's name has, where it decides which camera of a list the frame has. Fails
/// with ErrorKind::usage where there is such a list and the name has no clear number, and with ErrorKind::input where
/// the list has no such frame or cannot be read.
Notes notes_on_number(const FramePlan& plan, const Settings& settings);

/// What the names of the files tell: numbers that are left out, frames that others do without, and notes_on_number().
/// Fails as that does, and with ErrorKind::input where a warning counts as an error.
Notes notes_on_names(const FramePlan& plan, const Settings& settings);

/// The settings with the radius that is proposed for the frames, where they ask for it; the note says so. It is the
/// same for every chunk of a sequence. Fails with ErrorKind::input where no frame that is looked at shows a surface.
Settings with_proposed_radius(const Settings& settings, Notes& notes);

/// What a run cannot do without, and has not been given.
struct Lacking {
  bool input = false, output = false, camera = false, radius = false;
  std::optional<double> proposed_radius;  // where there is no radius, and the first frame can be read
  std::optional<Error> unfound;           // why its channels are not found, where there is no camera
  std::optional<Error> unreadable;        // why the first frame cannot be looked at

  bool any() const { return input || output || camera || radius; }
};

/// Opens the first frame only where no option gives a camera or a radius. Fails with ErrorKind::usage on names that
/// make no sense.
Lacking lacking_in(const Settings& settings);

/// One sentence for each thing, with the options that give it.
std::vector<std::string> sentences_on(const Lacking& lacking);

/// The frames, files, size and memory of a run. Computes and writes nothing. Fails as the run would on settings, names,
/// and a single frame that cannot be read as it is.
std::string plan_text(const Settings& settings);

}  // namespace alcove
