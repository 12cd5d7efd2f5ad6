// Half floats as bits, by Imath.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <half.h>

#include <cstdint>

namespace alcove {

/// Gives the value of a half float's bits.
inline float from_half(std::uint16_t bits) { return imath_half_to_float(bits); }

/// Rounds to the nearest half float. Values beyond its range become infinite.
inline std::uint16_t to_half(float value) { return imath_float_to_half(value); }

}  // namespace alcove
