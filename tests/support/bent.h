// Bent normals of a frame, as the chain writes them and as the estimator leaves them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/frame/reading.h"
#include "tests/support/scenes.h"

namespace alcove::test {

/// Makes vectors of planes x, y, z.
std::vector<Vec3> vectors_in(std::span<const float> planes, double scale = 1, double offset = 0);

/// The same of the first band of nine planes, see transfer.comp.
std::vector<Vec3> first_band(std::span<const float> transfer);

/// The AOV: unit vectors in view space.
std::vector<Vec3> bent_normals(const HostFrame& frame, const EstimatorSettings& settings);

/// The mean open directions in view space, as the estimator leaves what is blocked.
std::vector<Vec3> raw_bent(const HostFrame& frame, const EstimatorSettings& settings);

}  // namespace alcove::test
