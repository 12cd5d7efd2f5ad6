// The faults that a frame's pixels may show: a table of detectors, each a function of the walk's findings.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/base/note.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/reading.h"

namespace alcove {

/// A row of the table. docs/troubleshooting.md lists what each looks at, when it speaks, and what mends it.
struct Detector {
  NoteCode code;
  // The sentence of its note, where it speaks.
  std::optional<std::string> (*sentence)(const Findings&);
};

/// The sentence on a frame in which nothing is a surface.
std::string no_surfaces_text(const std::string& depth_channel);

/// The number that depth must be added to be in proportion to distances, as it is read.
double said_offset(const Reading& reading);
/// Whether the curve of the values speaks against the kind of depth that is read.
bool speaks_against(const Curve& curve, const Reading& reading);

/// The table. A code may have several rows.
std::span<const Detector> detectors();

/// The notes of all detectors on a frame.
Notes detected(const Findings& findings);

}  // namespace alcove
