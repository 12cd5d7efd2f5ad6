// What a frame's files hold, how `run` would understand them and why, and what is missing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/settings.h"

namespace alcove {

/// The same twice: for people, and as JSON with the fields that README.md lists.
struct Inspection {
  std::string text, json;
  std::optional<Error> unreadable;  // the headers are whole, and the pixels are not: the rest is what the headers tell
};

/// Opens the files that the settings name and reads depth and normals. What `run` would refuse is part of the answer;
/// only a file whose header cannot be read fails, with ErrorKind::input.
Inspection inspect_frame(const InputSettings& settings, int frame);

}  // namespace alcove
