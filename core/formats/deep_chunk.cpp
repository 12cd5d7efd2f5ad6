// The document "File Layout" of OpenEXR says how bytes are packed: split into halves, made differences, and deflated or
// put together as runs.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/deep_chunk.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "core/formats/sample_loops.h"

namespace alcove {
namespace {

constexpr std::uint64_t kDeflateRatio = 1032;  // of the longest match by the shortest code
constexpr std::uint64_t kRunRatio = 64;        // 128 bytes by two
constexpr std::uint64_t kShortest = 64;        // bytes that any chunk may have

bool inflate_all(std::span<const std::uint8_t> packed, std::span<std::uint8_t> to) {
  uLongf length = uLongf(to.size());
  return uncompress(to.data(), &length, packed.data(), uLong(packed.size())) == Z_OK && length == to.size();
}

/// A count below 0 stands before as many bytes as they are; another one before a byte that comes once more often.
bool expand_runs(std::span<const std::uint8_t> packed, std::span<std::uint8_t> to) {
  std::size_t from = 0, at = 0;
  while (from < packed.size()) {
    const int count = std::int8_t(packed[from++]);
    const std::size_t length = count < 0 ? std::size_t(-count) : std::size_t(count) + 1;
    if (length > to.size() - at || (count < 0 ? length : 1) > packed.size() - from) return false;
    if (count < 0)
      std::copy_n(packed.begin() + std::ptrdiff_t(from), length, to.begin() + std::ptrdiff_t(at));
    else
      std::fill_n(to.begin() + std::ptrdiff_t(at), length, packed[from]);
    from += count < 0 ? length : 1;
    at += length;
  }
  return at == to.size();
}

/// Sums differences up, and puts the second half's bytes between those of the first.
void put_together(std::span<std::uint8_t> split, std::span<std::uint8_t> to) {
  const std::size_t half = (split.size() + 1) / 2;
  sum_up(split.data() + 1, split.size() - 1, split[0]);
  interleave(split.data(), split.data() + half, split.size() / 2, to.data());
  if (split.size() % 2) to.back() = split[half - 1];
}

}  // namespace

std::uint64_t longest_unpacked(DeepCompression compression, std::uint64_t packed_bytes) {
  switch (compression) {
    case DeepCompression::none: return packed_bytes;
    case DeepCompression::rle: return kShortest + kRunRatio * packed_bytes;
    case DeepCompression::zip: break;
  }
  return kShortest + kDeflateRatio * packed_bytes;
}

bool unpack_deep(DeepCompression compression, std::span<const std::uint8_t> packed, std::span<std::uint8_t> to,
                 std::vector<std::uint8_t>& scratch) {
  // What packing would make longer is stored as it is.
  if (packed.size() == to.size()) {
    std::ranges::copy(packed, to.begin());
    return true;
  }
  if (compression == DeepCompression::none || to.empty()) return false;
  if (scratch.size() < to.size()) scratch.resize(to.size());
  const std::span split(scratch.data(), to.size());
  if (!(compression == DeepCompression::zip ? inflate_all(packed, split) : expand_runs(packed, split))) return false;
  put_together(split, to);
  return true;
}

bool counts_of_table(std::span<const std::uint8_t> table, std::size_t width, std::vector<std::uint32_t>& counts) {
  counts.resize(table.size() / sizeof(std::uint32_t));
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < counts.size(); i++) {
    const auto until = number_at<std::uint32_t>(table.data() + i * sizeof(std::uint32_t));
    if (i % width == 0) sum = 0;
    if (until < sum || until > std::uint32_t(std::numeric_limits<std::int32_t>::max())) return false;
    counts[i] = until - sum;
    sum = until;
  }
  return true;
}

bool lines_of_counts(std::span<const std::uint32_t> counts, std::size_t width, std::uint64_t sample_bytes,
                     std::uint64_t bytes, std::vector<std::size_t>& lines) {
  // Samples are counted down from what there is room for: a sum of bytes that a file has chosen could wrap.
  std::uint64_t left = bytes / sample_bytes;
  lines.clear();
  for (std::size_t i = 0; i < counts.size(); i++) {
    if (i % width == 0) lines.push_back(bytes - left * sample_bytes);
    if (counts[i] > left) return false;
    left -= counts[i];
  }
  lines.push_back(bytes);
  return left == 0 && bytes % sample_bytes == 0;
}

}  // namespace alcove
