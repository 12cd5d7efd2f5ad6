// Analytic scenes with the surfaces behind the first one, as a renderer peels them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/scenes.h"

namespace alcove::test {

/// The frame of a rendering with as many peels as there are surfaces but the first, of all faces.
HostFrame peeled(const Scene& scene, const Shot& shot, int surfaces);

}  // namespace alcove::test
