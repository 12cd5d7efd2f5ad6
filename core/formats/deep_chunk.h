// The bytes of a chunk of deep data, unpacked: no file and no allocation that its sizes have not earned.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace alcove {

/// The compressions that deep data may have.
enum class DeepCompression { none, rle, zip };

/// How many times as long as its packed bytes a chunk may be at most; 1 where nothing packs it.
std::uint64_t longest_unpacked(DeepCompression compression, std::uint64_t packed_bytes);

/// Unpacks bytes to exactly as many as `to` has. `scratch` is as long as it needs to be. Returns false where they are
/// damaged.
bool unpack_deep(DeepCompression compression, std::span<const std::uint8_t> packed, std::span<std::uint8_t> to,
                 std::vector<std::uint8_t>& scratch);

/// The number of samples of each pixel, from the table of a chunk, which adds them up along each line. Returns false
/// where a number is below 0.
bool counts_of_table(std::span<const std::uint8_t> table, std::size_t width, std::vector<std::uint32_t>& counts);

/// Where the samples of each line begin, and where the last line's end, in bytes of a chunk's samples. A sample takes
/// `sample_bytes`. Returns false where the counts are not those of exactly `bytes`.
bool lines_of_counts(std::span<const std::uint32_t> counts, std::size_t width, std::uint64_t sample_bytes,
                     std::uint64_t bytes, std::vector<std::size_t>& lines);

}  // namespace alcove
