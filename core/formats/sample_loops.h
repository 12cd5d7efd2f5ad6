// The loops over bytes and samples of EXR chunks: in plain C++, and with the processor's vector instructions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace alcove {

/// The document "File Layout" of OpenEXR says how bytes of ZIP chunks are packed: those at even places stand before
/// those at odd ones, and each is stored as its difference from the one before it, plus 128.
struct SampleLoops {
  /// Makes bytes of differences. `before` is the byte before the first. Gives the last byte, and `before` where there
  /// is none.
  std::uint8_t (*sum_up)(std::uint8_t* differences, std::size_t count, std::uint8_t before);
  /// Gives the same byte, and leaves the differences as they are.
  std::uint8_t (*sum_of)(const std::uint8_t* differences, std::size_t count, std::uint8_t before);
  /// Writes 2 * count bytes: the first of `even`, the first of `odd`, the second of `even` ...
  void (*interleave)(const std::uint8_t* even, const std::uint8_t* odd, std::size_t count, std::uint8_t* to);
  /// The other way: reads 2 * count bytes, and writes them apart.
  void (*split)(const std::uint8_t* from, std::size_t count, std::uint8_t* even, std::uint8_t* odd);
  /// Makes differences of bytes; the first byte stays.
  void (*subtract)(std::uint8_t* bytes, std::size_t count);
  /// Makes floats of half floats, of which each has the lower byte first. A NaN keeps its bits.
  void (*widen)(const std::uint8_t* halves, std::size_t count, float* to);
  /// Makes half floats of floats, rounded to the nearest; what is beyond their range becomes the largest, not infinity.
  void (*narrow)(const float* floats, std::size_t count, std::uint16_t* to);
};

/// What every processor runs.
const SampleLoops& plain_sample_loops();
/// The fastest that this processor runs; they give the same bits.
const SampleLoops& fast_sample_loops();

}  // namespace alcove
