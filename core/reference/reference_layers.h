// What is known of the surfaces behind the first one of each pixel, from all planes of a frame: docs/hidden.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/reference/reference_scene.h"

namespace alcove {

struct ReferenceLayers {
  // Planar depth, a plane for each surface that is kept, nearer first; 0: there is none; below 0, of the same size: it
  // closes the solid of the surface before it.
  std::vector<float> planes;
  bool lists_all = false;  // a pixel that lists fewer surfaces has no more of them
};

/// Keeps so many surfaces behind the first ones of `scene`, which knows no others yet, and pairs them. Surfaces are one
/// that are closer than the separation, scene units; below 0: than layers.comp says.
ReferenceLayers reference_layers(const ReferenceScene& scene, const HostFrame& frame, int hidden, double separation);

}  // namespace alcove
