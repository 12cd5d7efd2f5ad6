// Our own reader of ZIP and ZIPS gives the bits that OpenEXR's gives; what is damaged it refuses, or reads right.
// SPDX-License-Identifier: BSD-3-Clause
//
// ALCOVE_TEST_EXR: folders, with colons between them, whose EXR files are compared too.

#include <list>
#include <sstream>

#include "core/base/half.h"
#include "core/formats/exr.h"
#include "core/formats/sample_loops.h"
#include "tests/support/openexr.h"
#include "tests/support/program.h"
#include "tests/support/test.h"

namespace alcove::zip_test {
namespace {

using namespace test;
using Bytes = std::vector<std::uint8_t>;

std::mt19937 random_numbers(1);

Bytes random_bytes(std::size_t count) {
  Bytes bytes(count);
  for (auto& byte : bytes) byte = std::uint8_t(random_numbers());
  return bytes;
}

bool has_same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

// The loops.

TEST(SampleLoops, undo_each_other_at_any_length_and_place) {
  for (std::size_t place = 0; place < 17; place++)
    for (std::size_t count = 0; count < 100; count++) {
      const Bytes bytes = random_bytes(place + 2 * count);
      Bytes split(place + 2 * count), together(place + 2 * count);
      split_to_differences(bytes.data() + place, count, split.data() + place);
      for (std::size_t i = 1; i < count; i++)
        ASSERT_EQ(split[place + i], std::uint8_t(bytes[place + 2 * i] - bytes[place + 2 * i - 2] + 128)) << count;
      const auto before = std::uint8_t(random_numbers());
      std::uint8_t last = before;
      for (std::size_t i = place; i < split.size(); i++) last = std::uint8_t(last + split[i] - 128);
      ASSERT_EQ(sum_of(split.data() + place, 2 * count, before), last) << count;
      ASSERT_EQ(sum_up(split.data() + place, 2 * count, before), last) << count;
      std::ranges::transform(split, split.begin(), [&](std::uint8_t b) { return std::uint8_t(b - before + 128); });
      interleave(split.data() + place, split.data() + place + count, count, together.data() + place);
      ASSERT_TRUE(
          std::equal(bytes.begin() + std::ptrdiff_t(place), bytes.end(), together.begin() + std::ptrdiff_t(place)))
          << count;
    }
}

/// What the bits of a half float mean, from their definition.
float meaning_of(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const float magnitude = exponent == 31 ? std::bit_cast<float>(0x7f800000 | fraction << 13)  // infinite, or no number
                          : exponent > 0 ? std::ldexp(1024.0f + float(fraction), exponent - 25)
                                         : std::ldexp(float(fraction), -24);
  return std::copysign(magnitude, bits >> 15 ? -1.0f : 1.0f);
}

TEST(SampleLoops, every_half_becomes_the_float_that_it_means) {
  std::vector<std::uint16_t> halves(1 << 16);
  for (std::size_t i = 0; i < halves.size(); i++) halves[i] = std::uint16_t(i);
  for (int order = 0; order < 3; order++) {
    std::vector<float> expected;
    for (const std::uint16_t bits : halves) {
      expected.push_back(meaning_of(bits));
      ASSERT_EQ(std::bit_cast<std::uint32_t>(from_half(bits)), std::bit_cast<std::uint32_t>(expected.back())) << bits;
    }
    for (const std::size_t less : {0u, 3u}) {
      std::vector<float> floats(halves.size());
      widen(reinterpret_cast<const std::uint8_t*>(halves.data()), halves.size() - less, floats.data());
      for (std::size_t i = 0; i < halves.size() - less; i++)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(floats[i]), std::bit_cast<std::uint32_t>(expected[i])) << halves[i];
      for (std::size_t i = halves.size() - less; i < halves.size(); i++) ASSERT_EQ(floats[i], 0);
    }
    std::ranges::shuffle(halves, random_numbers);
  }
}

TEST(SampleLoops, floats_become_the_halves_that_openexr_makes_of_them_and_none_becomes_infinite) {
  std::vector<float> floats{INFINITY, -INFINITY, 65504, 65505, 65520, -65519, 1e30f, -1e30f, 1e-30f, -0.0f};
  for (std::uint32_t i = 0; i < 1 << 16; i++)  // every half, what lies halfway to the next, and beside both
    for (const int beside : {-1, 0, 1})
      for (const std::uint32_t halfway : {0u, 1u << 12}) {
        const auto bits = std::bit_cast<std::uint32_t>(from_half(std::uint16_t(i)));
        floats.push_back(std::bit_cast<float>(bits + halfway + std::uint32_t(beside)));
      }
  for (int i = 0; i < 1 << 16; i++) floats.push_back(std::bit_cast<float>(std::uint32_t(random_numbers())));
  for (const std::size_t less : {0u, 5u}) {
    std::vector<std::uint16_t> halves(floats.size());
    narrow(floats.data(), floats.size() - less, halves.data());
    for (std::size_t i = 0; i < floats.size() - less; i++) {
      const float within = std::abs(floats[i]) > HALF_MAX ? std::copysign(float(HALF_MAX), floats[i]) : floats[i];
      ASSERT_EQ(halves[i], half(within).bits()) << floats[i];
    }
  }
}

// Files.

/// What a plane is filled with: what is packed well, what nothing packs, and both.
enum class Content { smooth, noise, both };

struct ChannelToWrite {
  const char* name;
  Imf::PixelType type;
};
const std::vector<ChannelToWrite> kChannels{{"A", Imf::HALF},        {"Depth.Z", Imf::FLOAT}, {"Id", Imf::UINT},
                                            {"Normal.X", Imf::HALF}, {"Normal.Y", Imf::HALF}, {"Normal.Z", Imf::FLOAT},
                                            {"View.R", Imf::FLOAT}};

Bytes content_of(Content content, Imf::PixelType type, std::size_t width, std::size_t height) {
  const std::size_t sample = type == Imf::HALF ? 2 : 4;
  Bytes bytes = random_bytes(width * height * sample);
  for (std::size_t i = 0; i < width * height; i++) {
    const bool is_noise = content == Content::noise || (content == Content::both && (i / width / 16) % 2 == 1);
    if (is_noise) continue;
    const std::uint32_t value = type == Imf::HALF ? 0x3c00 + std::uint32_t(i % width) : 0x3f800000 + std::uint32_t(i);
    std::memcpy(&bytes[i * sample], &value, sample);
  }
  return bytes;
}

void write(const std::string& path, const Imath::Box2i& window, Imf::Compression compression, Content content,
           Imf::LineOrder order = Imf::INCREASING_Y, const std::vector<ChannelToWrite>& channels = kChannels) {
  const std::size_t width = std::size_t(window.max.x - window.min.x + 1);
  const std::size_t height = std::size_t(window.max.y - window.min.y + 1);
  Imf::Header header(window, window);
  header.compression() = compression;
  header.lineOrder() = order;
  Imf::FrameBuffer frame_buffer;
  std::list<Bytes> planes;
  for (const auto& [name, type] : channels) {
    header.channels().insert(name, Imf::Channel(type));
    const std::size_t sample = type == Imf::HALF ? 2 : 4;
    planes.push_back(content_of(content, type, width, height));
    frame_buffer.insert(name, Imf::Slice::Make(type, planes.back().data(), window, sample, sample * width));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(frame_buffer);
  file.writePixels(int(height));
}

using Names = std::vector<std::string>;

Names channels_of(const ExrPart& part) {
  Names names;
  for (const auto& channel : part.channels)
    if (!channel.subsampled) names.push_back(channel.name);
  return names;
}

/// Rows of channels as we read them.
NamedPlanes read_rows(ExrFile& file, int part, const Names& names, int first, int rows) {
  NamedPlanes planes;
  std::vector<ExrRead> reads;
  for (const auto& name : names) {
    auto& plane = planes[name];
    plane.assign(std::size_t(file.parts()[std::size_t(part)].data.width) * std::size_t(rows), -1);
    reads.push_back({part, name, plane.data()});
  }
  file.read(reads, first, rows);
  return planes;
}

/// These rows of the channels must have the bits of the whole planes.
void expect_rows(ExrFile& file, int part, const NamedPlanes& whole, const Names& names, int first, int rows) {
  const Window data = file.parts()[std::size_t(part)].data;
  const auto from = std::ptrdiff_t(first) * data.width, to = std::ptrdiff_t(first + rows) * data.width;
  for (const auto& [name, plane] : read_rows(file, part, names, first, rows)) {
    const auto& all = whole.at(name);
    EXPECT_TRUE(has_same_bits(plane, {all.begin() + from, all.begin() + to}))
        << file.path() << ", part " << part << ", " << name << ", rows " << first << " to " << first + rows << " of "
        << to_string(data);
  }
}

/// All channels together, each by itself, some, and some rows.
void expect_file(const std::string& path) {
  ExrFile file(path, "INPUT");
  for (int part = 0; part < int(file.parts().size()); part++) {
    if (file.parts()[std::size_t(part)].deep) continue;
    const auto whole = openexr_planes(path, part);
    ASSERT_TRUE(whole) << path;
    const int height = file.parts()[std::size_t(part)].data.height;
    const Names names = channels_of(file.parts()[std::size_t(part)]);
    expect_rows(file, part, *whole, names, 0, height);
    for (const auto& name : names) expect_rows(file, part, *whole, {name}, 0, height);
    Names some;
    for (std::size_t i = names.size(); i-- > 0;)
      if (i % 3 != 1) some.push_back(names[i]);
    for (const int first : {0, 1, 15, 16, 17, 33})
      for (const int rows : {1, 2, 16, 17, height - first})
        if (rows > 0 && first + rows <= height) expect_rows(file, part, *whole, some, first, rows);
  }
}

class Zip : public testing::Test {
 protected:
  ~Zip() override { set_exr_threads(0); }
  TemporaryFolder folder;
  const std::string path = folder / "a.exr";
};

constexpr auto kCompressions = {Imf::NO_COMPRESSION,  Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION,
                                Imf::B44_COMPRESSION, Imf::DWAA_COMPRESSION};

TEST_F(Zip, reads_the_bits_of_openexr_whatever_size_and_content_a_picture_has) {
  for (const auto& [x, y, width, height] : {std::array{0, 0, 1, 1},
                                            {0, 0, 1, 40},
                                            {-3, 5, 7, 16},
                                            {-3, -5, 16, 17},
                                            {100, 7, 33, 35},
                                            {0, -64, 200, 64},
                                            {0, 0, 64, 15}})
    for (const auto content : {Content::smooth, Content::noise, Content::both})
      for (const auto compression : kCompressions) {
        SCOPED_TRACE(fmt::format("{} x {}, content {}, compression {}", width, height, int(content), int(compression)));
        write(path, {{x, y}, {x + width - 1, y + height - 1}}, compression, content);
        expect_file(path);
      }
}

TEST_F(Zip, reads_the_same_bits_on_any_number_of_threads_and_in_any_order_of_lines) {
  for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y})
    for (const auto compression : kCompressions) {
      write(path, {{-3, 5}, {96, 104}}, compression, Content::both, order);
      for (const int threads : {0, 1, 2, 5}) {
        set_exr_threads(threads);
        expect_file(path);
      }
    }
}

TEST_F(Zip, tiles_are_read_at_full_resolution) {
  const Imath::Box2i window({-3, 5}, {3, 44});
  std::vector<float> values(7 * 40), wrong(7 * 40, -1);
  std::iota(values.begin(), values.end(), 1.0f);
  for (const auto mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
    Imf::Header header(window, window);
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    header.setTileDescription(Imf::TileDescription(4, 16, mode));
    {
      Imf::TiledOutputFile file(path.c_str(), header);
      for (int level = 0; level < file.numLevels(); level++) {
        Imf::FrameBuffer pixels;
        pixels.insert("Z", Imf::Slice::Make(Imf::FLOAT, level == 0 ? values.data() : wrong.data(), window, 4, 4 * 7));
        file.setFrameBuffer(pixels);
        file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
      }
    }
    expect_file(path);
    EXPECT_EQ(read_exr_image(path).pixels, values);
  }
}

TEST_F(Zip, reads_channels_of_one_type) {
  for (const auto type : {Imf::HALF, Imf::FLOAT, Imf::UINT}) {
    write(path, {{0, 0}, {16, 18}}, Imf::ZIP_COMPRESSION, Content::both, Imf::INCREASING_Y,
          {{"B", type}, {"G", type}, {"R", type}});
    expect_file(path);
  }
}

TEST_F(Zip, leaves_subsampled_channels_to_openexr) {
  Imf::Header header({{0, 0}, {7, 31}}, {{0, 0}, {7, 31}});
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert("RY", Imf::Channel(Imf::FLOAT, 2, 2));
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  std::vector<float> small(4 * 16, 3), large(8 * 32);
  std::iota(large.begin(), large.end(), 1.0f);
  Imf::FrameBuffer frame_buffer;
  frame_buffer.insert("RY", Imf::Slice::Make(Imf::FLOAT, small.data(), header.dataWindow(), 4, 16, 2, 2));
  frame_buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, large.data(), header.dataWindow(), 4, 32));
  {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame_buffer);
    file.writePixels(32);
  }
  expect_file(path);
}

TEST_F(Zip, reads_the_bits_of_openexr_from_every_small_file_of_the_project) {
  int files = 0;
  for (const char* place : {"examples", "tests"})
    for (const auto& name : names_in(std::string(ALCOVE_SOURCE_DIR "/") + place)) {
      const std::string file = std::string(ALCOVE_SOURCE_DIR "/") + place + "/" + name;
      if (!name.ends_with(".exr") || name.find("seeds") != name.npos) continue;
      expect_file(file);
      files++;
    }
  EXPECT_GT(files, 0);
}

TEST_F(Zip, reads_the_bits_of_openexr_from_every_file_of_the_folders_that_are_named) {
  const char* const folders = std::getenv("ALCOVE_TEST_EXR");
  if (!folders) GTEST_SKIP() << "ALCOVE_TEST_EXR names none";
  std::istringstream list(folders);
  for (std::string place; std::getline(list, place, ':');)
    for (const auto& entry : fs::recursive_directory_iterator(place))
      if (entry.path().extension() == ".exr") expect_file(entry.path());
}

TEST_F(Zip, gives_a_channel_as_often_as_it_is_asked_for) {
  for (const auto compression : kCompressions) {
    write(path, {{0, 0}, {16, 35}}, compression, Content::smooth);
    ExrFile file(path, "INPUT");
    const auto once = read_rows(file, 0, {"Normal.X", "Depth.Z"}, 3, 20);
    std::vector<std::vector<float>> planes(4, std::vector<float>(17 * 20, -1));
    file.read(std::vector<ExrRead>{{0, "Normal.X", planes[0].data()},
                                   {0, "Depth.Z", planes[1].data()},
                                   {0, "Normal.X", planes[2].data()},
                                   {0, "Normal.X", planes[3].data()}},
              3, 20);
    for (const std::size_t i : {0, 2, 3}) EXPECT_EQ(planes[i], once.at("Normal.X")) << i << ", " << int(compression);
    EXPECT_EQ(planes[1], once.at("Depth.Z")) << int(compression);
  }
}

TEST_F(Zip, tells_the_first_damage_whatever_the_number_of_threads) {
  write(path, {{0, 0}, {99, 16 * 20 - 1}}, Imf::ZIP_COMPRESSION, Content::smooth);
  std::string damaged = read_bytes(path);
  std::uint64_t table[20] = {};
  std::uint64_t first = 0;
  // The offsets stand before the first chunk, which is where the first of them says.
  for (std::size_t at = 0; at + sizeof table < damaged.size(); at++) {
    std::memcpy(table, &damaged[at], sizeof table);
    first = at + sizeof table;
    if (table[0] == first) break;
  }
  ASSERT_EQ(table[0], first);
  // Two checksums: with a wrong line in its header, OpenEXR 3.1 would lose the place of the chunk before.
  for (const std::uint64_t end : {table[11], table[12]}) damaged[end - 1] ^= 1;
  write_bytes(path, damaged);
  for (int i = 0; i < 20; i++) {
    set_exr_threads(i % 4);
    ExrFile file(path, "INPUT");
    expect_error(ErrorKind::input, {"the rows from 160 on cannot be inflated"}, [&] {
      read_rows(file, 0, {"A", "Depth.Z"}, 0, 16 * 20);
    });
  }
}

TEST_F(Zip, refuses_a_chunk_of_more_or_fewer_rows_than_the_window_has) {
  write(path, {{0, 0}, {6, 36}}, Imf::ZIP_COMPRESSION, Content::smooth);
  const std::string whole = read_bytes(path);
  const std::size_t bottom = whole.find("dataWindow") + sizeof("dataWindow") + sizeof("box2i") + 4 + 12;
  for (const int row : {35, 36, 37}) {
    std::string damaged = whole;
    damaged[bottom] = char(row);
    write_bytes(path, damaged);
    ExrFile file(path, "INPUT");
    const auto read = [&] { read_rows(file, 0, {"A"}, 0, row + 1); };
    if (row == 36)
      EXPECT_NO_THROW(read());
    else
      EXPECT_THROW(read(), Error) << row;
  }
}

// Damaged files.

/// Whether we accept a damaged file. What we accept must be what OpenEXR reads from it too, or what it held before.
bool is_accepted(const std::string& path, const NamedPlanes& before) {
  try {
    ExrFile file(path, "INPUT");
    const ExrPart& part = file.parts()[0];
    if (part.data.pixels() > 1 << 16) return false;
    const Names names = channels_of(part);
    const NamedPlanes planes = read_rows(file, 0, names, 0, part.data.height);
    const auto truth = openexr_planes(path, 0).value_or(before);
    for (const auto& [name, plane] : planes)
      EXPECT_TRUE(truth.contains(name) && has_same_bits(plane, truth.at(name))) << name << " is wrong";
    return true;
  } catch (const Error&) {
    return false;
  }
}

class Damaged : public Zip, public testing::WithParamInterface<std::pair<Imf::Compression, Content>> {
 protected:
  void SetUp() override {
    write(path, {{-2, 3}, {4, 3 + 18}}, GetParam().first, GetParam().second);
    whole = read_bytes(path);
    before = openexr_planes(path, 0).value();
  }
  std::string whole;
  NamedPlanes before;
};

TEST_P(Damaged, a_file_that_is_cut_anywhere_is_refused) {
  EXPECT_TRUE(is_accepted(path, before)) << "or nothing is proved";
  for (std::size_t length = 0; length < whole.size(); length++) {
    write_bytes(path, whole.substr(0, length));
    EXPECT_FALSE(is_accepted(path, before)) << length << " of " << whole.size() << " bytes";
  }
}

TEST_P(Damaged, a_file_with_a_wrong_byte_is_refused_or_read_right) {
  int accepted = 0;
  for (std::size_t place = 0; place < whole.size(); place++)
    for (const int change : {0x01, 0x80, 0xff}) {
      std::string damaged = whole;
      damaged[place] = char(damaged[place] ^ change);
      write_bytes(path, damaged);
      SCOPED_TRACE(fmt::format("byte {} of {} xor {}", place, whole.size(), change));
      accepted += is_accepted(path, before);
    }
  EXPECT_GT(accepted, 0) << "a byte of an attribute harms no pixel";
}

INSTANTIATE_TEST_SUITE_P(Zip, Damaged,
                         testing::Values(std::pair(Imf::ZIP_COMPRESSION, Content::smooth),
                                         std::pair(Imf::ZIP_COMPRESSION, Content::both),
                                         std::pair(Imf::ZIP_COMPRESSION, Content::noise),
                                         std::pair(Imf::ZIPS_COMPRESSION, Content::both)));

}  // namespace
}  // namespace alcove::zip_test
