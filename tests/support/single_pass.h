// Single passes after the estimate, with any visibility in its place.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/scenes.h"

namespace alcove::test {

/// What the settings' denoiser makes of this visibility of the frame.
std::vector<float> denoised(const HostFrame& frame, const std::vector<float>& ao, const EstimatorSettings& settings);

/// What upsampling makes of a visibility that is given by block: its column and row at the settings' resolution.
std::vector<float> upsampled(const HostFrame& frame, const std::function<double(int, int)>& ao_of_block,
                             const EstimatorSettings& settings);

/// A floor, a wall, a ball on the floor, a slab in the air, and sky.
Rendering furnished_room(int width, int height);

/// The frame upside down or left to right.
HostFrame mirrored(const HostFrame& frame, bool left_right);
std::vector<float> mirrored(const std::vector<float>& plane, const HostFrame& frame, bool left_right);

/// The frame in units 2^-exponent times as large.
HostFrame scaled(HostFrame frame, int exponent);

/// Any bits for depth and normals: NaN, infinite, negative, tiny and huge ones too.
HostFrame random_bits(int width, int height, unsigned seed);

}  // namespace alcove::test
