// Deep EXR files: the surfaces that their samples make, in every way to store them; and damaged and hostile ones.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr.h"
#include "tests/support/openexr.h"
#include "tests/support/program.h"
#include "tests/support/test.h"

namespace alcove::deep_test {
namespace {

using namespace test;

constexpr float kNone = kNoDeepSurface;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

using Samples = std::vector<DeepSample>;

DeepSurfaces surfaces_of(Samples samples, const DeepRules& rules = {}, DeepCounts* counts = nullptr) {
  DeepCounts own;
  return DeepPixel(rules).surfaces(samples, counts ? *counts : own);
}

DeepSample point(float z, float opacity) { return {z, z, opacity}; }

TEST(DeepSurfaces, are_the_opaque_points_nearer_first) {
  const auto found = surfaces_of({point(3, 1), point(1, 1), point(2, 0.4F)});
  EXPECT_THAT(found.front, ElementsAre(1, 3, kNone, kNone)) << "and none that is half clear";
  EXPECT_THAT(found.back, ElementsAre(kNone, kNone, kNone, kNone));
  EXPECT_THAT(surfaces_of({}).front, ElementsAre(kNone, kNone, kNone, kNone));
}

TEST(DeepSurfaces, opacities_of_points_that_lie_together_multiply) {
  const DeepRules rules{.opacity = 0.5, .separation = {0.1, 0, 0}};
  EXPECT_EQ(surfaces_of({point(1, 0.3F), point(1.05F, 0.3F)}, rules).front[0], 1) << ".51";
  EXPECT_EQ(surfaces_of({point(1, 0.29F), point(1.05F, 0.29F)}, rules).front[0], kNone) << ".496";
  EXPECT_EQ(surfaces_of({point(1, 0.3F), point(1.2F, 0.3F)}, rules).front[0], kNone) << "too far apart";
  EXPECT_THAT(surfaces_of({point(1, 1), point(1.05F, 1), point(1.11F, 1)}, rules).front,
              ElementsAre(1, 1.11F, kNone, kNone));
}

TEST(DeepSurfaces, a_volume_is_a_body_from_where_it_has_grown_dense_enough) {
  const DeepSurfaces opaque = surfaces_of({{2, 5, 1}});
  EXPECT_EQ(opaque.front[0], 2) << "an opaque one is opaque from its front on";
  EXPECT_EQ(opaque.back[0], 5);
  const DeepSurfaces thick = surfaces_of({{2, 4, 0.75F}});
  EXPECT_NEAR(thick.front[0], 3, 1e-5) << "half of it takes half of the light";
  EXPECT_EQ(thick.back[0], 4);
  EXPECT_EQ(surfaces_of({{2, 4, 0.4F}}).front[0], kNone) << "thin";
  EXPECT_NEAR(surfaces_of({{2, 4, 0.4F}, {2, 4, 0.4F}}).front[0], 3.357F, 1e-3) << "two at one place";
}

TEST(DeepSurfaces, volumes_and_points_do_not_join) {
  const DeepSurfaces found = surfaces_of({{2, 4, 0.4F}, point(3, 0.4F)});
  EXPECT_EQ(found.front[0], kNone);
  const DeepSurfaces both = surfaces_of({{2, 4, 1}, point(3, 1)});
  EXPECT_THAT(both.front, ElementsAre(2, 3, kNone, kNone));
  EXPECT_THAT(both.back, ElementsAre(4, kNone, kNone, kNone));
}

/// The samples as a tidy file has them: volumes are cut at every depth where another sample begins or ends, and those
/// that are equal then are one.
Samples tidied(const Samples& samples) {
  std::vector<float> cuts;
  for (const auto& s : samples) cuts.insert(cuts.end(), {s.front, s.back});
  std::ranges::sort(cuts);
  std::map<std::pair<float, float>, double> through;
  for (const auto& s : samples) {
    float front = s.front;
    for (const float cut : cuts) {
      if (!(cut > front && cut <= s.back)) continue;
      const double part = double(cut - front) / double(s.back - s.front);
      through.try_emplace({front, cut}, 1).first->second *= std::pow(1 - double(s.opacity), part);
      front = cut;
    }
    if (s.front == s.back) through.try_emplace({s.front, s.back}, 1).first->second *= 1 - double(s.opacity);
  }
  Samples tidy;
  for (const auto& [place, t] : through) tidy.push_back({place.first, place.second, float(1 - t)});
  return tidy;
}

TEST(DeepSurfaces, messy_samples_give_what_tidied_ones_do) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  int bodies = 0;
  for (int i = 0; i < 500; i++) {
    Samples messy;
    for (int k = 0; k < 1 + i % 7; k++) {
      const float front = 1 + std::floor(8 * unit(random)) / 4, length = k % 2 ? 0 : 0.25F + unit(random);
      messy.push_back({front, front + length, 0.9F * unit(random)});
    }
    const DeepSurfaces found = surfaces_of(messy), tidy = surfaces_of(tidied(messy));
    std::ranges::shuffle(messy, random);
    const DeepSurfaces shuffled = surfaces_of(messy);
    EXPECT_EQ(shuffled.front, found.front) << i;
    EXPECT_EQ(shuffled.back, found.back) << i;
    for (std::size_t k = 0; k < kMostDeepSurfaces; k++) {
      EXPECT_NEAR(tidy.front[k] / found.front[k], 1, 1e-4) << i << " " << k;
      EXPECT_NEAR(tidy.back[k] / found.back[k], 1, 1e-4) << i << " " << k;
      bodies += found.back[k] < kNone;
    }
  }
  EXPECT_GT(bodies, 100) << "or else nothing was shown";
}

TEST(DeepSurfaces, repairs_and_counts_what_cannot_be) {
  DeepCounts counts;
  const auto found = surfaces_of({point(1, 1.5F),
                                  point(2, -1),
                                  point(3, kNan),
                                  point(kNan, 1),
                                  point(-4, 1),
                                  point(0, 1),
                                  {5, kNan, 1},
                                  point(6, 1)},
                                 {}, &counts);
  EXPECT_THAT(found.front, ElementsAre(1, 5, 6, kNone));
  EXPECT_EQ(counts.repaired, 5) << "no surface lies at depth 0, which is none to repair";
  EXPECT_EQ(counts.samples, 8);
}

TEST(DeepSurfaces, counts_what_lies_behind_opaque_samples_and_what_is_too_much) {
  DeepCounts counts;
  surfaces_of({point(1, 1), point(2, 0.1F), point(3, 1), point(4, 1), point(5, 1), point(6, 1)}, {}, &counts);
  EXPECT_EQ(counts.covered, 5);
  EXPECT_EQ(counts.dropped, 1);
  surfaces_of({point(1, 0.5F), point(1.5F, 1)}, {}, &counts);
  EXPECT_EQ(counts.covered, 5) << "the second is what ends the first";
  EXPECT_EQ(counts.most, 6);
  EXPECT_EQ(counts.pixels, 2);
}

/// A file in a folder of its own.
class DeepFile : public testing::Test {
 protected:
  /// A part with samples everywhere, in a window that does not begin at 0, and pixels without any.
  static DeepFilePart some_part(std::uint32_t seed = 1) {
    DeepFilePart part;
    part.data = {-2, 3, 13, 9};
    part.channels = {"A", "B", "Z", "ZBack"};
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    for (std::size_t i = 0; i < part.data.pixels(); i++) {
      part.pixels.emplace_back();
      for (std::size_t k = 0; k < (i * 7) % 6; k++) {
        const float z = 1 + 4 * unit(random);
        part.pixels.back().push_back({unit(random), 7, z, k % 3 == 0 ? z + 0.5F : z});
      }
    }
    return part;
  }

  /// The planes of surfaces, and then of their ends, of rows of the file.
  std::vector<float> read(const std::vector<int>& parts = {0}, int first = 0, int rows = -1,
                          const DeepRules& rules = {}) {
    ExrFile file(path, "--deep");
    file.take_deep(parts, rules);
    const Window& data = file.parts()[std::size_t(parts[0])].data;
    if (rows < 0) rows = data.height;
    const std::size_t pixels = std::size_t(data.width) * std::size_t(rows);
    std::vector<float> planes(2 * kMostDeepSurfaces * pixels);
    std::vector<ExrRead> reads;
    for (std::size_t plane = 0; plane < 2 * kMostDeepSurfaces; plane++)
      reads.push_back({parts[0], deep_channel(plane % kMostDeepSurfaces, plane >= kMostDeepSurfaces),
                       planes.data() + plane * pixels});
    file.read(reads, first, rows);
    counts = file.deep_counts();
    return planes;
  }

  /// What the samples of a part make.
  static std::vector<float> expected(const std::vector<DeepFilePart>& parts) {
    const std::size_t pixels = parts[0].data.pixels();
    std::vector<float> planes(2 * kMostDeepSurfaces * pixels);
    for (std::size_t i = 0; i < pixels; i++) {
      Samples samples;
      for (const auto& part : parts)
        for (const auto& s : part.pixels[i]) samples.push_back({s[2], s[3], s[0]});
      const DeepSurfaces found = surfaces_of(samples);
      for (std::size_t k = 0; k < kMostDeepSurfaces; k++) {
        planes[k * pixels + i] = found.front[k];
        planes[(kMostDeepSurfaces + k) * pixels + i] = found.back[k];
      }
    }
    return planes;
  }

  /// Whether it is read; else it must be refused.
  bool is_read() {
    try {
      read();
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return false;
    }
  }

  TemporaryFolder folder;
  std::string path = folder / "deep.exr";
  DeepCounts counts;
};

TEST_F(DeepFile, lines_and_tiles_of_every_compression_give_the_same_surfaces) {
  const DeepFilePart part = some_part();
  for (const bool is_tiled : {false, true})
    for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION}) {
      DeepFilePart stored = part;
      stored.is_tiled = is_tiled;
      stored.tile = 4;
      stored.compression = compression;
      write_deep(path, {stored});
      EXPECT_TRUE(read() == expected({part})) << is_tiled << " " << compression;
      EXPECT_GT(counts.volumes, 20);
    }
}

TEST_F(DeepFile, long_runs_of_equal_samples_come_back) {
  DeepFilePart part;
  part.data = {0, 0, 300, 3};
  part.channels = {"A", "B", "Z", "ZBack"};
  part.pixels.assign(part.data.pixels(), {{1, 0, 2, 2}, {1, 0, 4, 4}});
  for (const auto compression : {Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION}) {
    part.compression = compression;
    write_deep(path, {part});
    EXPECT_TRUE(read() == expected({part})) << compression;
  }
}

TEST_F(DeepFile, any_rows_are_those_of_the_whole) {
  for (const bool is_tiled : {false, true}) {
    DeepFilePart part = some_part();
    part.is_tiled = is_tiled;
    part.tile = 4;
    write_deep(path, {part});
    const auto whole = read();
    for (const int first : {0, 3, 4, 8})
      for (const int rows : {1, 2, 9 - first}) {
        if (first + rows > 9) continue;
        const auto some = read({0}, first, rows);
        const std::size_t length = std::size_t(rows) * 13;
        for (std::size_t plane = 0; plane < 2 * kMostDeepSurfaces; plane++)
          EXPECT_TRUE(std::equal(some.begin() + std::ptrdiff_t(plane * length),
                                 some.begin() + std::ptrdiff_t((plane + 1) * length),
                                 whole.begin() + std::ptrdiff_t(plane * 13 * 9 + std::size_t(first) * 13)))
              << is_tiled << " " << first << " " << rows << " " << plane;
      }
  }
}

TEST_F(DeepFile, several_threads_give_the_same_bits) {
  DeepFilePart part = some_part();
  write_deep(path, {part});
  const auto one = read();
  set_exr_threads(3);
  const auto more = read();
  const DeepCounts of_more = counts;
  set_exr_threads(0);
  read();
  EXPECT_TRUE(more == one);
  EXPECT_EQ(of_more.samples, counts.samples);
}

TEST_F(DeepFile, rows_that_are_read_again_are_counted_once) {
  write_deep(path, {some_part()});
  read();
  ExrFile file(path, "--deep");
  file.take_deep({0}, {});
  std::vector<float> plane(13 * 9);
  const ExrRead read_first{0, deep_channel(0, false), plane.data()};
  file.read(std::span(&read_first, 1), 4, 1);
  file.read(std::span(&read_first, 1), 0, 9);
  file.read(std::span(&read_first, 1), 2, 3);
  EXPECT_EQ(file.deep_counts().pixels, 13 * 9);
  EXPECT_EQ(file.deep_counts().samples, counts.samples);
}

/// Bytes that reading may take are of the whole process.
class LittleMemory {
 public:
  explicit LittleMemory(std::uint64_t bytes) { set_exr_memory(bytes); }
  ~LittleMemory() { set_exr_memory(std::numeric_limits<std::uint64_t>::max()); }
  LittleMemory(const LittleMemory&) = delete;
  LittleMemory& operator=(const LittleMemory&) = delete;
};

TEST_F(DeepFile, what_a_dense_pixel_takes_is_counted_and_must_be_there) {
  constexpr std::uint64_t kSamples = 10'000;
  DeepFilePart part;
  part.pixels.assign(6, {});
  part.pixels[1].assign(kSamples, {0, 2});
  write_deep(path, {part});
  set_exr_threads(0);
  ExrFile file(path, "--deep");
  const std::uint64_t without = file.bytes_beside_pixels();
  file.take_deep({0}, {});
  // Three copies of the chunk, the samples of the line, and the surfaces that they may make.
  EXPECT_GE(file.bytes_beside_pixels() - without, kSamples * (3 * 8 + sizeof(DeepSample) + 2 * sizeof(float)));
  EXPECT_NO_THROW(read());
  const LittleMemory little(kSamples * 30);
  expect_error(ErrorKind::input, {"deep.exr", "--memory", "--deep"}, [&] { read(); });
}

TEST_F(DeepFile, samples_of_several_parts_count_together) {
  DeepFilePart one = some_part(1), other = some_part(2);
  one.name = "one";
  other.name = "other";
  write_deep(path, {one, other});
  EXPECT_TRUE(read({0, 1}) == expected({one, other}));
  EXPECT_TRUE(read({1}) == expected({other}));
}

TEST_F(DeepFile, level_0_of_several_is_read) {
  DeepFilePart part = some_part();
  part.data = {0, 0, 8, 8};
  part.pixels.assign(64, {{1, 0, 2, 2}});
  part.is_tiled = true;
  part.tile = 4;
  part.levels = Imf::MIPMAP_LEVELS;
  write_deep(path, {part});
  EXPECT_TRUE(read() == expected({part}));
}

TEST_F(DeepFile, depths_and_opacities_may_be_half) {
  DeepFilePart part;
  part.pixels.assign(6, {{1, 2.5F}, {0.25F, 3}});
  part.types = {{"Z", Imf::HALF}, {"A", Imf::HALF}};
  write_deep(path, {part});
  EXPECT_EQ(read()[0], 2.5F);
  EXPECT_EQ(read()[6], kNone);
}

TEST_F(DeepFile, opacity_is_that_of_colours_where_there_is_no_other_and_all_is_opaque_without_any) {
  DeepFilePart part;
  part.channels = {"AB", "AG", "AR", "Z"};
  part.pixels.assign(6, {{0.2F, 0.5F, 0.7F, 3}, {0.6F, 0.6F, 0.6F, 4}});
  write_deep(path, {part});
  EXPECT_EQ(read()[0], 4) << "the mean is .47";
  part.channels = {"B", "G", "R", "Z"};
  write_deep(path, {part});
  EXPECT_EQ(read()[0], 3);
}

TEST_F(DeepFile, says_how_it_is_stored) {
  DeepFilePart tidy = some_part(), untold = some_part();
  tidy.state = Imf::DIS_TIDY;
  tidy.is_tiled = true;
  untold.name = "untold";
  untold.compression = Imf::RLE_COMPRESSION;
  write_deep(path, {tidy, untold});
  const ExrFile file(path, "--deep");
  EXPECT_EQ(file.parts()[0].deep->state, "tidy");
  EXPECT_TRUE(file.parts()[0].deep->is_tiled);
  EXPECT_EQ(file.parts()[1].deep->state, "messy");
  EXPECT_EQ(file.parts()[1].deep->compression, "rle");
}

TEST_F(DeepFile, flat_parts_beside_deep_ones_are_read_as_ever) {
  DeepFilePart flat;
  flat.is_flat = true;
  flat.name = "flat";
  flat.pixels.assign(6, {{0.5F, 9}});
  DeepFilePart deep;
  deep.pixels.assign(6, {{1, 2}});
  write_deep(path, {deep, flat});
  EXPECT_EQ(read_exr_image(path).plane("Z")[0], 9);
  EXPECT_EQ(read({0})[0], 2);
}

TEST_F(DeepFile, every_truncation_is_refused_or_changes_nothing) {
  for (const bool is_tiled : {false, true}) {
    DeepFilePart part = some_part();
    part.is_tiled = is_tiled;
    part.tile = 4;
    write_deep(path, {part});
    const std::string bytes = read_bytes(path);
    const auto whole = read();
    for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 400) {
      write_bytes(path, bytes.substr(0, length));
      if (is_read()) EXPECT_TRUE(read() == whole) << length;
    }
  }
}

TEST_F(DeepFile, no_flipped_byte_does_harm) {
  DeepFilePart part = some_part();
  write_deep(path, {part});
  const std::string bytes = read_bytes(path);
  for (std::size_t at = 8; at < bytes.size(); at += 3)
    for (const char flip : {char(0x01), char(0x80), char(0xff)}) {
      std::string damaged = bytes;
      damaged[at] = char(damaged[at] ^ flip);
      write_bytes(path, damaged);
      is_read();
    }
}

TEST_F(DeepFile, sizes_that_the_file_cannot_hold_are_refused_before_anything_is_made_of_them) {
  DeepFilePart part = some_part();
  part.compression = Imf::ZIPS_COMPRESSION;
  write_deep(path, {part});
  const std::string bytes = read_bytes(path);
  // The table of offsets stands before the first chunk, of which its first entry tells the place. Behind the chunk's y
  // are three sizes.
  std::size_t chunk = 0;
  for (std::size_t at = 8; at + 8 < bytes.size() && chunk == 0; at++) {
    std::uint64_t offset = 0;
    for (std::size_t i = 0; i < 8; i++) offset |= std::uint64_t(std::uint8_t(bytes[at + i])) << (8 * i);
    if (offset == at + 8 * 9) chunk = std::size_t(offset);
  }
  ASSERT_GT(chunk, 0);
  EXPECT_EQ(attribute_of_whole_exr(path, "name"), "deep");
  for (const std::uint64_t size : {std::uint64_t(1) << 28, std::uint64_t(1) << 31, std::uint64_t(1) << 40,
                                   std::uint64_t(1) << 62, ~std::uint64_t(0), std::uint64_t(100000)})
    for (std::size_t which = 0; which < 3; which++) {
      std::string changed = bytes;
      for (std::size_t i = 0; i < 8; i++) changed[chunk + 4 + 8 * which + i] = char(size >> (8 * i));
      write_bytes(path, changed);
      EXPECT_FALSE(is_read()) << which << " " << size;
      if (which != 2) EXPECT_FALSE(attribute_of_whole_exr(path, "name")) << "it ends before " << size;
    }
}

}  // namespace
}  // namespace alcove::deep_test
