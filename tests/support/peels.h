// Analytic scenes with the surfaces behind the first one, as a renderer peels them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/scenes.h"

namespace alcove::test {

/// The frame of a rendering with as many peels as there are surfaces but the first, of all faces.
HostFrame peeled(const Scene& scene, const Shot& shot, int surfaces);

/// How much farther than a surface its ray goes on from there, as a part of the surface's depth.
constexpr double kBehindSurface = 1e-6;

/// Gives the rendering's frame two planes for each of so many surfaces behind the first: one of `fronts`, and one of
/// backs, which are seen where a ray leaves a solid of the scene. What lies farther behind the first surface than
/// `within` is left out.
void add_solid_peels(Rendering& rendering, const Scene& scene, int count, const std::vector<int>& solids = {},
                     double within = kNowhere, BehindKind fronts = BehindKind::fronts);

}  // namespace alcove::test
