// A frame as the evidence of its pixels settles it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/frame/gbuffer.h"

namespace alcove::test {

/// Finds the frame that the settings name, reads its depth and normals, and settles what neither options nor headers
/// say. Fails as these steps do.
FrameSource settled(const InputSettings& settings);

}  // namespace alcove::test
