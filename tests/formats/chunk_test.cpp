// Chunks of deep data and of ZIP lines: whatever their bytes say, nothing beyond them is read or written.
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/mman.h>
#include <unistd.h>

#include "core/formats/exr.h"
#include "core/formats/exr_deep.h"
#include "core/formats/exr_zip.h"
#include "tests/support/test.h"

namespace alcove::chunk_test {
namespace {

using namespace test;
using Bytes = std::vector<std::uint8_t>;

/// Bytes that end where nobody may read or write: whoever takes one more than there are ends the test, without a
/// sanitizer too.
class GuardedBytes {
 public:
  explicit GuardedBytes(std::size_t size) : size_(size) {
    const auto page = std::size_t(sysconf(_SC_PAGESIZE));
    const std::size_t usable = (size + page - 1) / page * page;
    mapped_ = usable + page;
    void* const at = mmap(nullptr, mapped_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
    start_ = static_cast<std::uint8_t*>(at);
    begin_ = start_ + (usable - size);
    if (mprotect(start_ + usable, page, PROT_NONE) != 0) throw std::bad_alloc();
  }
  explicit GuardedBytes(std::span<const std::uint8_t> bytes) : GuardedBytes(bytes.size()) {
    std::ranges::copy(bytes, begin_);
  }
  ~GuardedBytes() { munmap(start_, mapped_); }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;

  std::span<std::uint8_t> bytes() const { return {begin_, size_}; }

 private:
  std::size_t size_, mapped_ = 0;
  std::uint8_t *start_ = nullptr, *begin_ = nullptr;
};

TEST(DeepChunk, nothing_unpacks_to_more_than_it_can) {
  EXPECT_EQ(longest_unpacked(DeepCompression::none, 100), 100);
  EXPECT_LT(longest_unpacked(DeepCompression::rle, 100), 6500);
  EXPECT_LT(longest_unpacked(DeepCompression::zip, 100), 104000);
  std::vector<std::uint8_t> to(8), scratch;
  const std::vector<std::uint8_t> runs{0x7f, 0}, cut{0x85}, few{3, 128};
  EXPECT_FALSE(unpack_deep(DeepCompression::rle, runs, to, scratch)) << "128 bytes";
  EXPECT_FALSE(unpack_deep(DeepCompression::rle, cut, to, scratch)) << "123 bytes that are not there";
  EXPECT_FALSE(unpack_deep(DeepCompression::rle, few, to, scratch)) << "4 bytes";
  std::vector<std::uint32_t> counts;
  const std::vector<std::uint8_t> falling{2, 0, 0, 0, 1, 0, 0, 0}, negative{0, 0, 0, 0x80};
  EXPECT_FALSE(counts_of_table(falling, 2, counts));
  EXPECT_FALSE(counts_of_table(negative, 1, counts));
}

TEST(DeepChunk, counts_are_those_of_its_bytes_or_are_refused) {
  constexpr std::uint32_t kMost = std::numeric_limits<std::int32_t>::max();
  constexpr std::uint64_t kWraps = std::uint64_t(1) << 34;  // bytes of a sample: 2^30 of them are 2^64
  const struct {
    const char* of;
    std::vector<std::uint32_t> counts;
    std::uint64_t sample_bytes, bytes;
    std::vector<std::size_t> lines;  // empty: refused
  } cases[] = {
      {"two lines of two pixels", {1, 2, 0, 3}, 6, 36, {0, 18, 36}},
      {"no samples", {0, 0, 0, 0}, 6, 0, {0, 0, 0}},
      {"a sample too few", {1, 2, 0, 2}, 6, 36, {}},
      {"a sample too many", {1, 2, 0, 4}, 6, 36, {}},
      {"part of a sample", {1, 2, 0, 3}, 6, 37, {}},
      {"as many as wrap to nothing", {1 << 30, 0, 0, 0}, kWraps, 0, {}},
      {"as many as wrap to what is there", {(1 << 30) + 1, 0, 0, 0}, kWraps, kWraps, {}},
      {"the most of each pixel", {kMost, kMost, kMost, kMost}, 4, 4, {}},
  };
  for (const auto& c : cases) {
    std::vector<std::size_t> lines;
    const bool fits = lines_of_counts(c.counts, 2, c.sample_bytes, c.bytes, lines);
    EXPECT_EQ(fits, !c.lines.empty()) << c.of;
    if (fits) EXPECT_EQ(lines, c.lines) << c.of;
  }
}

/// 600 bytes that pack well, as a chunk holds them: in runs, or split, as differences, and deflated.
std::vector<std::uint8_t> packed_samples(DeepCompression compression) {
  std::vector<std::uint8_t> packed;
  if (compression == DeepCompression::rle) {
    for (int i = 0; i < 5; i++) packed.insert(packed.end(), {99, 128});
    for (int i = 0; i < 5; i++)
      packed.insert(packed.end(), {9, std::uint8_t(i), std::uint8_t(-10), 1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
    return packed;
  }
  std::vector<std::uint8_t> bytes(600);
  for (std::size_t i = 0; i < bytes.size(); i++) bytes[i] = std::uint8_t(i * i / 50);
  if (compression == DeepCompression::none) return bytes;
  ZipPacker packer;
  const auto chunk = packer.pack(bytes);
  return {chunk.begin(), chunk.end()};
}

TEST(DeepChunk, no_length_of_a_chunk_makes_a_reader_leave_its_bytes) {
  for (const auto compression : {DeepCompression::none, DeepCompression::rle, DeepCompression::zip}) {
    const auto packed = packed_samples(compression);
    for (std::size_t length = 0; length <= packed.size(); length++) {
      const GuardedBytes from{std::span(packed).first(length)};
      for (const std::size_t bytes :
           {std::size_t(0), std::size_t(1), std::size_t(599), std::size_t(600), std::size_t(601), length}) {
        GuardedBytes to(bytes);
        std::vector<std::uint8_t> scratch;
        const bool fits = unpack_deep(compression, from.bytes(), to.bytes(), scratch);
        EXPECT_EQ(fits, bytes == length || (bytes == 600 && length == packed.size()))
            << int(compression) << " " << length << " " << bytes;
      }
      std::vector<std::uint32_t> counts;
      counts_of_table(from.bytes(), 3, counts);
      EXPECT_EQ(counts.size(), length / 4);
    }
  }
}

TEST(ZipChunk, no_length_of_a_chunk_makes_a_reader_leave_its_bytes) {
  constexpr std::size_t kWidth = 37, kRows = 3, kRowBytes = kWidth * (2 + 4);
  Bytes bytes(kRowBytes * kRows);
  for (std::size_t i = 0; i < bytes.size(); i++) bytes[i] = std::uint8_t(i * i / 99);
  ZipPacker packer;
  const auto chunk = packer.pack(bytes);
  const Bytes packed(chunk.begin(), chunk.end());
  ASSERT_LT(packed.size(), bytes.size());
  const auto rows_of = [&](std::span<const std::uint8_t> from, std::size_t first, std::size_t count, bool as_floats) {
    const GuardedBytes halves(count * kWidth * (as_floats ? 4 : 2)), integers(count * kWidth * 4);
    const auto at = [](const GuardedBytes& to) { return reinterpret_cast<std::byte*>(to.bytes().data()); };
    const ZipChannel channels[]{{SampleType::half_float, 0, at(halves), as_floats},
                                {SampleType::integer, kWidth * 2, at(integers), as_floats}};
    return ZipUnpacker().unpack(from, {kWidth, kRowBytes, kRows, first, count}, channels);
  };
  for (const bool as_floats : {false, true})
    for (const auto& [first, count] : {std::pair<std::size_t, std::size_t>{0, 3}, {1, 1}, {2, 1}}) {
      for (std::size_t length = 0; length <= packed.size(); length++)
        EXPECT_EQ(rows_of(GuardedBytes(std::span(packed).first(length)).bytes(), first, count, as_floats),
                  length == packed.size())
            << length;
      // As it is, what nothing packs: one byte less is meant to be packed.
      for (std::size_t length = 0; length <= bytes.size(); length++)
        EXPECT_EQ(rows_of(GuardedBytes(std::span(bytes).first(length)).bytes(), first, count, as_floats),
                  length == bytes.size())
            << length;
    }
}

}  // namespace
}  // namespace alcove::chunk_test
