// What two windows share.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/image.h"

namespace alcove {

/// The pixels that both have; a window without any where they have none.
Window common_part(const Window& a, const Window& b);

/// Copies the pixels that both windows have from one plane into the other.
void copy_common(const float* from, const Window& from_window, float* to, const Window& to_window);

}  // namespace alcove
