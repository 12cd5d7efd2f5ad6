// The CPU reference of a suite's frame, computed once and kept in a file: to compute it takes longer than all else that
// a suite does.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/reference/reference.h"

namespace alcove {

/// Everything that a reference of a frame depends on besides the frame; a kept reference has it as the attribute
/// `alcove/reference`.
std::string text_of(const ReferenceSettings& settings);

/// The reference that the file holds, if it was made with these settings; empty if it was made with others. Fails with
/// ErrorKind::input, naming the file, where it holds no reference, or one of another data window.
std::vector<float> read_kept_reference(const std::string& path, const ReferenceSettings& settings, const Window& data);

}  // namespace alcove
