// The loops over bytes and samples of EXR chunks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace alcove {

/// A number as files store it: the lower byte first, as on all machines that Alcove runs on.
template <class T>
T number_at(const void* bytes) {
  static_assert(std::endian::native == std::endian::little);
  T number;
  std::memcpy(&number, bytes, sizeof(T));
  return number;
}

// The document "File Layout" of OpenEXR says how bytes of ZIP chunks are packed: those at even places stand before
// those at odd ones, and each is stored as its difference from the one before it, plus 128.

/// Makes bytes of differences. `before` is the byte before the first. Gives the last byte, and `before` where there is
/// none.
std::uint8_t sum_up(std::uint8_t* differences, std::size_t count, std::uint8_t before);
/// Gives the same byte, and leaves the differences as they are.
std::uint8_t sum_of(const std::uint8_t* differences, std::size_t count, std::uint8_t before);
/// Writes 2 * count bytes: the first of `even`, the first of `odd`, the second of `even` ...
void interleave(const std::uint8_t* even, const std::uint8_t* odd, std::size_t count, std::uint8_t* to);
/// The way back: reads 2 * count bytes, and writes as many differences. The first byte stays.
void split_to_differences(const std::uint8_t* from, std::size_t count, std::uint8_t* to);
/// Makes floats of half floats, of which each has the lower byte first. A NaN keeps its bits.
void widen(const std::uint8_t* halves, std::size_t count, float* to);
/// Makes half floats of floats, rounded to the nearest; what is beyond their range becomes the largest, not infinity.
void narrow(const float* floats, std::size_t count, std::uint16_t* to);

}  // namespace alcove
