// What a frame's files hold, how `run` would understand them and why, and what is missing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/base/settings.h"
#include "core/frame/gbuffer.h"
#include "core/inspect/command.h"
#include "core/inspect/inspection.h"

namespace alcove {

/// Opens the files that the settings name and reads depth and normals. What `run` would refuse is part of the answer;
/// only a file whose header cannot be read fails, with ErrorKind::input.
Inspection inspect_frame(const InputSettings& settings, int frame);

/// Does the same for a frame of a sequence. `run` is what the proposed command names instead of the frame's files.
Inspection inspect_frame(const InputSettings& settings, int frame, const CommandNames& run);

/// The settings with some camera where neither they nor the header give one, so that all else can be looked at.
InputSettings with_some_camera(const InputSettings& settings);

/// Whether the settings or the frame give a camera.
struct CameraSearch {
  // what to give where nothing gives one, and why the frame's positions, if it has any, do not; "" where there is one
  std::string lacking;
  std::optional<FrameSource> found;  // the frame, where it had to be found to know
};
/// A file that cannot be opened has no camera.
CameraSearch look_for_camera(const InputSettings& settings, int frame);

}  // namespace alcove
