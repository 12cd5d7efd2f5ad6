// The estimators hbao and crytek again, slow, in double precision, on the CPU, and every estimator with its shaping:
// what presets are held to.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/frame/reading.h"

namespace alcove {

/// One visibility in [0, 1] per pixel, by the settings' estimator (gtao, hbao, crytek) with its radius, bias, falloff
/// and kernel, intensity and power: what it gives at full resolution with so many directions and samples that nothing
/// is left to smooth; slices, steps, resolution, denoiser and seed are not looked at. 1 on sky and where no pixel was
/// asked for (indices; empty: all). The radius must be set. The frame must have planar depth and normals. Fails with
/// ErrorKind::input otherwise, and with ErrorKind::usage on another estimator.
std::vector<float> reference_estimate(const HostFrame& frame, const EstimatorSettings& settings,
                                      const std::vector<std::size_t>& pixels = {});

}  // namespace alcove
