// The loops over bytes and samples of EXR chunks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace alcove {

/// Reads a number as files store it: the lowest byte first, as on all machines that Alcove runs on.
template <class T>
T number_at(const void* bytes) {
  static_assert(std::endian::native == std::endian::little);
  T number;
  std::memcpy(&number, bytes, sizeof(T));
  return number;
}

// ZIP chunks are packed as in OpenEXR's document "File Layout": bytes at even places before bytes at odd places, each
// stored as its difference from the one before it, plus 128.

/// Turns differences into bytes. `before` is the byte before the first. Gives the last byte, or `before` if there is
/// none.
std::uint8_t sum_up(std::uint8_t* differences, std::size_t count, std::uint8_t before);
/// Gives the last byte as sum_up() does, but leaves the differences as they are.
std::uint8_t sum_of(const std::uint8_t* differences, std::size_t count, std::uint8_t before);
/// Writes 2 * count bytes: the first of `even`, the first of `odd`, the second of `even` ...
void interleave(const std::uint8_t* even, const std::uint8_t* odd, std::size_t count, std::uint8_t* to);
/// Reverses interleave() and sum_up(): reads 2 * count bytes, and writes as many differences. The first byte stays.
void split_to_differences(const std::uint8_t* from, std::size_t count, std::uint8_t* to);
/// Turns half floats, stored with the lower byte first, into floats. A NaN keeps its bits.
void widen(const std::uint8_t* halves, std::size_t count, float* to);
/// Turns floats into half floats, rounded to the nearest; values beyond their range become the largest, not infinity.
void narrow(const float* floats, std::size_t count, std::uint16_t* to);

}  // namespace alcove
