// Files as wholes: written completely or not at all; EXR and PNG out and in again; every truncation of an EXR.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/file.h"

#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include "core/formats/exr.h"
#include "core/formats/image_io.h"
#include "core/formats/png.h"
#include "tests/support/exr_header.h"
#include "tests/support/openexr.h"
#include "tests/support/picture_file.h"
#include "tests/support/program.h"
#include "tests/support/test.h"
#include "tests/support/wall_frame.h"

namespace alcove::file_test {
namespace {

using namespace test;

class Files : public testing::Test {
 protected:
  TemporaryFolder folder;
  const std::string path = folder / "a.exr";
};

// Wholes.

TEST_F(Files, write_whole_writes_exactly_these_bytes) {
  for (const std::string& bytes :
       {std::string(), std::string("a"), std::string("\0\n\xff", 3), std::string(3 << 20, 'x')}) {
    write_whole(path, bytes);
    EXPECT_TRUE(read_bytes(path) == bytes) << bytes.size() << " bytes";
    EXPECT_TRUE(read_text(path, "test", "--test") == bytes) << bytes.size() << " bytes";
    EXPECT_THAT(names_in(folder.path()), ElementsAre("a.exr"));
  }
}

TEST_F(Files, write_whole_takes_every_name_that_the_file_system_takes) {
  for (const std::string& name : {std::string(255, 'n'), std::string(240, 'n') + ".exr", std::string("{} %s")}) {
    EXPECT_NO_THROW(write_whole(folder / name, std::string("whole"))) << name.size() << " characters";
    EXPECT_TRUE(fs::exists(folder / name));
  }
}

TEST_F(Files, a_failed_write_leaves_everything_as_it_was) {
  expect_error(ErrorKind::output, {"missing/a.exr"}, [&] { write_whole(folder / "missing/a.exr", std::string("x")); });
  fs::create_directory(folder / "folder");
  write_bytes(folder / "folder/inside", "kept");
  expect_error(ErrorKind::output, {"folder"}, [&] { write_whole(folder / "folder", std::string("x")); });
  EXPECT_THAT(names_in(folder.path()), ElementsAre("folder", "folder/inside"));
}

TEST_F(Files, a_pointer_in_place_of_a_file_is_no_file) {
  write_bytes(path, "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 12345\n");
  expect_error(ErrorKind::input, {path, "--test", "git lfs pull"}, [&] { read_text(path, "test", "--test"); });
  write_bytes(path, "../.git/annex/objects/4d/7a/SHA256E-s12345--4d7a.exr");
  expect_error(ErrorKind::input, {path, "--test", "git annex get"}, [&] { read_text(path, "test", "--test"); });
}

/// Who may not read everything; root again at the end.
struct Nobody {
  Nobody() {
    if (is_root) EXPECT_EQ(::setresuid(65534, 65534, 0), 0);
  }
  ~Nobody() {
    if (is_root) EXPECT_EQ(::setresuid(0, 0, 0), 0);
  }
  const bool is_root = ::geteuid() == 0;
};

TEST_F(Files, what_may_not_be_read_or_written_is_said_with_the_reason) {
  fs::permissions(folder.path(), fs::perms(0755));
  fs::create_directory(folder / "locked");
  write_bytes(folder / "locked/a.exr", "kept");
  write_bytes(path, "kept");
  fs::permissions(path, fs::perms::none);
  fs::permissions(folder / "locked", fs::perms::none);
  fs::create_directory(folder / "shown");
  fs::permissions(folder / "shown", fs::perms(0555));
  {
    const Nobody nobody;
    expect_error(ErrorKind::input, {path, "Permission denied", "--camera"},
                 [&] { require_readable(path, "camera", "--camera"); });
    expect_error(ErrorKind::input, {"locked/a.exr", "cannot be reached", "Permission denied", "--camera"},
                 [&] { require_readable(folder / "locked/a.exr", "camera", "--camera"); });
    expect_error(ErrorKind::output, {"shown/b.exr", "Permission denied", "--output"},
                 [&] { require_writable(folder / "shown/b.exr", "--output"); });
    expect_error(ErrorKind::output, {"locked/b/c.exr", "cannot be reached", "Permission denied", "--output"},
                 [&] { require_writable(folder / "locked/b/c.exr", "--output"); });
    expect_error(ErrorKind::output, {"shown/b.exr", "temporary file", "Permission denied"},
                 [&] { write_whole(folder / "shown/b.exr", std::string("x")); });
  }
  for (const char* name : {"locked", "shown", "a.exr"}) fs::permissions(folder / name, fs::perms::owner_all);
  EXPECT_EQ(read_bytes(folder / "locked/a.exr"), "kept");
  EXPECT_THAT(names_in(folder / "shown"), IsEmpty());
}

TEST_F(Files, names_of_one_file_are_told_from_those_of_two) {
  write_bytes(path, "x");
  fs::create_symlink(path, folder / "link.exr");
  fs::create_hard_link(path, folder / "hard.exr");
  fs::create_directory_symlink(folder.path(), folder / "linked");
  FileUses uses;
  uses.add_input({"INPUT", ""});
  uses.add_input({"INPUT", path});
  for (const char* name : {"a.exr", "./a.exr", "link.exr", "hard.exr", "none/../a.exr", "linked/a.exr"})
    expect_error(ErrorKind::usage, {folder / name, "--stats of frame 3 would overwrite an input: INPUT " + path}, [&] {
      uses.add_output({"--stats", folder / name}, " of frame 3");
    });
  // Files that are not there yet.
  uses.add_output({"--stats", folder / "new/b.exr"});
  uses.add_output({"--output", folder / "new/c.exr"});
  uses.add_output({"--output", folder / "new/c.exr"});
  expect_error(ErrorKind::usage, {"new/c.exr: --output and --output of frame 4 name the same file"}, [&] {
    uses.add_output({"--output", folder / "new/c.exr"}, " of frame 4");
  });
  for (const char* name : {"new/./b.exr", "linked/new/b.exr", "new/none/../b.exr"})
    expect_error(ErrorKind::usage, {folder / name, "--stats and --output name the same file"}, [&] {
      uses.add_output({"--output", folder / name});
    });
}

TEST_F(Files, nobody_can_tell_the_name_of_an_unfinished_file_beforehand) {
  std::set<std::string> drawn;  // behind the process's number, which anybody can see
  for (int i = 0; i < 64; i++) {
    const NewFile file(path);
    const auto names = names_in(folder.path());
    ASSERT_EQ(names.size(), 1u);
    drawn.insert(names[0].substr(names[0].find('-', 8)));
  }
  EXPECT_EQ(drawn.size(), 64u);
}

// EXR.

/// Values that conversions get wrong: denormals of both types, the largest, infinities, NaN, both zeros.
std::vector<float> difficult_values() {
  return {0.0f,      -0.0f,     1.0f,          -1.0f,     0x1p-24f,        0x1.8p-25f,        0x1p-25f,
          0x1p-149f, 65504.0f,  65519.0f,      -65504.0f, 1.0f + 0x1p-11f, 1.0f + 0x1.8p-10f, 3.4e38f,
          INFINITY,  -INFINITY, std::nanf(""), 0.333333f};
}

/// The finite half nearest to x, ties to even, from the definition of the format; NaN stays NaN.
float nearest_half(float x) {
  if (std::isnan(x) || x == 0) return x;
  if (std::abs(x) > 65504) return std::copysign(65504.0f, x);
  const int exponent = std::max(std::ilogb(x), -14);
  const double step = std::ldexp(1.0, exponent - 10), rounded = std::nearbyint(double(x) / step) * step;
  return std::copysign(float(rounded), x);
}

bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (std::isnan(a) && std::isnan(b));
}

TEST_F(Files, floats_come_back_bit_by_bit_and_halves_as_the_nearest_that_is_finite) {
  const auto values = difficult_values();
  const Window window{0, 0, int(values.size()), 1};
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    FrameFile file{window, window, 1, {{"F", values}, {"H", values}}, {"H"}};
    file.compression = compression;
    file.write(path);
    const Image image = read_exr_image(path);
    for (std::size_t i = 0; i < values.size(); i++) {
      EXPECT_TRUE(same(image.plane("F")[i], values[i]))
          << compression << " " << values[i] << " came back as " << image.plane("F")[i];
      EXPECT_TRUE(same(image.plane("H")[i], nearest_half(values[i])))
          << compression << " " << values[i] << " became " << image.plane("H")[i];
    }
  }
}

TEST_F(Files, windows_come_back_wherever_they_are) {
  for (const Window& data :
       {Window{0, 0, 1, 1}, Window{-5, -7, 4, 3}, Window{1000000, -1000000, 2, 5}, Window{3, 2, 1, 33}}) {
    const Window display{-2, 3, 17, 9};
    std::vector<float> values(data.pixels());
    for (std::size_t i = 0; i < values.size(); i++) values[i] = float(i);
    FrameFile{data, display, 0.75, {{"Y", values}}}.write(path);
    const ExrFile file(path, "INPUT");
    EXPECT_EQ(file.display(), display) << to_string(file.display());
    EXPECT_EQ(file.parts().at(0).data, data) << to_string(file.parts()[0].data);
    EXPECT_EQ(file.pixel_aspect(), 0.75);
    EXPECT_EQ(read_exr_image(path).pixels, values) << to_string(data);
  }
}

TEST_F(Files, channels_of_chosen_names_are_read_in_the_order_asked_for) {
  const std::vector<float> one{1, 2}, two{3, 4};
  FrameFile{{0, 0, 2, 1}, {0, 0, 2, 1}, 1, {{"b", one}, {"a.x", two}}, {"a.x"}}.write(path);
  EXPECT_EQ(read_exr_image(path, {"b", "a.x"}).pixels, (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(read_exr_image(path, {"a.x"}).pixels, two);
  expect_error(ErrorKind::input, {"a.exr", "missing"}, [&] { read_exr_image(path, {"missing"}); });
  expect_error(ErrorKind::input, {"missing"}, [&] { read_exr_image(path).plane("missing"); });
}

TEST_F(Files, attributes_of_every_type_are_carried_over_but_those_of_storage) {
  Imf::Header header(4, 2);
  header.insert("owner", Imf::StringAttribute("a studio"));
  header.insert("worldToCamera", Imf::M44fAttribute({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}));
  header.insert("cameraFov", Imf::FloatAttribute(54.5f));
  header.insert("aThreeVector", Imf::V3fAttribute({1, 2, 3}));
  header.insert("someNames", Imf::StringVectorAttribute(Imf::StringVector{"a", "b"}));
  header.insert("a name that is longer than thirty-one characters", Imf::StringAttribute("kept"));
  Imf::addTimeCode(header, Imf::TimeCode(1, 2, 3, 4));
  Imf::addFramesPerSecond(header, Imf::Rational(24000, 1001));
  Imf::addChromaticities(header, Imf::Chromaticities());
  header.screenWindowWidth() = 1.25f;
  header.screenWindowCenter() = {0.125f, -0.5f};
  const auto kept = [&] {
    ExrHeader all = read_header(path);
    for (const char* name : {"channels", "compression", "dataWindow", "displayWindow", "pixelAspectRatio", "lineOrder"})
      all.erase(name);
    return all;
  };
  for (const char* name : {"BlenderMultiChannel", "cryptomatte/123abcd/name", "cryptomatte/123abcd/manifest"})
    header.insert(name, Imf::StringAttribute("dropped"));
  header.insert("multiView", Imf::StringVectorAttribute(Imf::StringVector{"left", "right"}));
  header.insert("dwaCompressionLevel", Imf::FloatAttribute(45));
  header.lineOrder() = Imf::DECREASING_Y;
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  write_openexr(path, header);
  ExrHeader before = kept();
  FrameFile file{{0, 0, 4, 2}, {0, 0, 4, 2}, 1, {{"Y", std::vector<float>(8, 0.5f)}}, {"Y"}};
  file.input_attributes = ExrFile(path, "INPUT").attributes(0);
  file.attributes = {{"alcove/version", "1"}, {"owner", "another"}};
  file.write(path);
  for (const char* name : {"BlenderMultiChannel", "cryptomatte/123abcd/name", "cryptomatte/123abcd/manifest",
                           "multiView", "dwaCompressionLevel"})
    EXPECT_EQ(before.erase(name), 1) << name << " was in the input";
  before["alcove/version"] = {"string", "1"};
  before["owner"] = {"string", "another"};
  const ExrHeader after = kept();
  for (const auto& [name, attribute] : before) EXPECT_TRUE(after.contains(name) && after.at(name) == attribute) << name;
  for (const auto& [name, attribute] : after) EXPECT_TRUE(before.contains(name)) << name << " should be gone";
  EXPECT_EQ(read_header(path)["lineOrder"].bytes, std::string(1, 0)) << "increasing";
}

TEST_F(Files, our_attributes_replace_those_of_another_type) {
  Imf::Header header(1, 1);
  header.insert("alcove/version", Imf::FloatAttribute(3));
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  write_openexr(path, header);
  FrameFile file{{0, 0, 1, 1}, {0, 0, 1, 1}, 1, {{"Y", {0}}}, {"Y"}, {{"alcove/version", "1"}}};
  file.input_attributes = ExrFile(path, "INPUT").attributes(0);
  EXPECT_NO_THROW(file.write(path));
  EXPECT_EQ(text_in(read_header(path), "alcove/version"), "1");
}

/// A small EXR as bytes, and its pixels.
std::pair<std::string, std::vector<float>> small_exr(const std::string& path, const char* compression) {
  std::vector<float> one(35), two(35);
  for (std::size_t i = 0; i < one.size(); i++) {
    one[i] = float(i);
    two[i] = float(i % 7) / 8;
  }
  FrameFile file{{-2, 1, 7, 5}, {0, 0, 9, 9}, 1, {{"A", two}, {"Z", one}}, {"A"}};
  file.compression = compression;
  file.write(path);
  std::vector<float> both = two;
  both.insert(both.end(), one.begin(), one.end());
  return {read_bytes(path), both};
}

/// The pixels, or nothing where the file is refused.
std::vector<float> pixels_of(const std::string& path) {
  try {
    return read_exr_image(path).pixels;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    EXPECT_THAT(error.what(), AllOf(HasSubstr("a.exr"), Not(HasSubstr("\n"))));
    return {};
  }
}

TEST_F(Files, every_truncation_is_an_input_error_or_gives_the_right_pixels) {
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    const auto [whole, pixels] = small_exr(path, compression);
    EXPECT_EQ(read_exr_image(path).pixels, pixels);
    for (std::size_t length = 0; length < whole.size(); length++) {
      write_bytes(path, whole.substr(0, length));
      if (const auto read = pixels_of(path); !read.empty())
        EXPECT_EQ(read, pixels) << compression << " cut to " << length << " of " << whole.size() << " bytes";
    }
  }
}

// With ZIP: Damaged in zip_test.
TEST_F(Files, every_damaged_byte_is_an_input_error_or_gives_some_pixels) {
  const std::string whole = small_exr(path, "none").first;
  const std::size_t window = whole.find("dataWindow") + sizeof("dataWindow") + sizeof("box2i") + 4;
  for (std::size_t at = 0; at < whole.size(); at++) {
    if (at >= window && at < window + 16) continue;  // another window may be a whole, but huge image
    for (const char mask : {'\x01', '\xff'}) {
      std::string damaged = whole;
      damaged[at] = char(damaged[at] ^ mask);
      write_bytes(path, damaged);
      SCOPED_TRACE(at);
      pixels_of(path);
    }
  }
}

TEST_F(Files, an_exr_that_cannot_be_written_leaves_the_old_one) {
  write_bytes(path, "before");
  FrameFile file{{0, 0, 1, 1}, {0, 0, 1, 1}, 1, {{"", {0}}}};  // a channel must have a name
  expect_error(ErrorKind::output, {"a.exr"}, [&] { file.write(path); });
  file = {{0, 0, 0, 0}, {0, 0, 1, 1}};
  expect_error(ErrorKind::output, {"a.exr"}, [&] { file.write(path); });
  EXPECT_EQ(read_bytes(path), "before");
  EXPECT_THAT(names_in(folder.path()), ElementsAre("a.exr"));
}

// PNG.

TEST_F(Files, a_png_holds_the_nearest_of_256_values) {
  const std::string png = folder / "a.png";
  const std::vector<float> values{0,          1,          0.5f,         -1,       2,         1 / 255.0f,
                                  0.4f / 255, 0.6f / 255, 254.6f / 255, INFINITY, -INFINITY, 0.25f};
  const std::vector<int> expected{0, 255, 128, 0, 255, 1, 0, 1, 255, 255, 0, 64};
  for (const int channels : {1, 3}) {
    write_png(png, 4, 3 / channels, channels, values);
    const auto file = OIIO::ImageInput::open(png);
    ASSERT_TRUE(file) << OIIO::geterror();
    EXPECT_EQ(file->spec().width, 4);
    EXPECT_EQ(file->spec().height, 3 / channels);
    EXPECT_EQ(file->spec().nchannels, channels);
    EXPECT_EQ(file->spec().format, OIIO::TypeUInt8);
    std::vector<unsigned char> pixels(values.size());
    EXPECT_TRUE(file->read_image(0, 0, 0, channels, OIIO::TypeUInt8, pixels.data()));
    EXPECT_EQ(std::vector<int>(pixels.begin(), pixels.end()), expected) << channels << " channels";
  }
  EXPECT_THAT(names_in(folder.path()), ElementsAre("a.png"));
}

TEST_F(Files, a_png_of_any_depth_and_any_channels_is_read_as_it_is_stored) {
  constexpr int kWide = 5, kHigh = 4;
  for (const auto& type : {OIIO::TypeUInt8, OIIO::TypeUInt16})
    for (const int channels : {1, 2, 3, 4}) {
      const std::string png = folder / "a.png";
      OIIO::ImageSpec spec(kWide, kHigh, channels, type);
      spec["oiio:UnassociatedAlpha"] = 1;
      if (channels % 2 == 0) spec.alpha_channel = channels - 1;
      const int most = type == OIIO::TypeUInt8 ? 255 : 65535;
      std::vector<float> values(std::size_t(kWide * kHigh * channels));
      for (std::size_t i = 0; i < values.size(); i++) values[i] = float(i * 7919 % std::size_t(most + 1)) / float(most);
      const auto out = OIIO::ImageOutput::create(png);
      ASSERT_TRUE(out->open(png, spec) && out->write_image(OIIO::TypeFloat, values.data()) && out->close());
      const auto picture = open_png(png, "--normal");
      EXPECT_EQ(picture->names.size(), std::size_t(channels));
      EXPECT_EQ(picture->names[0], channels < 3 ? "Y" : "R");
      std::vector<float> row(kWide);
      const std::size_t last = std::size_t(channels) - 1;
      const PictureReader::Channel channel{last, row.data()};
      for (const int y : {2, 0, 3}) {
        picture->read(y, 1, {&channel, 1});
        for (std::size_t x = 0; x < kWide; x++)
          ASSERT_EQ(row[x], values[(std::size_t(y) * kWide + x) * std::size_t(channels) + last]) << channels;
      }
    }
}

TEST_F(Files, a_png_that_is_damaged_is_refused_at_every_length) {
  const std::string png = folder / "a.png";
  write_png(png, 7, 5, 3, std::vector<float>(7 * 5 * 3, 0.3f));
  const std::string bytes = read_bytes(png);
  const std::size_t pixels_end = bytes.find("IEND") - 4;
  for (std::size_t size = 8; size < pixels_end; size++) {
    write_bytes(png, bytes.substr(0, size));
    expect_error(ErrorKind::input, {"a.png", "--normal"}, [&] {
      const auto picture = open_png(png, "--normal");
      whole(*picture);
    });
  }
}

/// The bytes that hexadecimal digits say.
std::string bytes_of_digits(std::string_view digits) {
  std::string bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes += char(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16));
  return bytes;
}

TEST_F(Files, an_interlaced_png_with_a_palette_is_read) {
  // Red, blue; blue, red: 1 bit per pixel, by Adam7's passes, written with Python's zlib.
  const std::string_view digits =
      "89504e470d0a1a0a0000000d49484452000000020000000201030000013f7faff100000006504c5445ff00000000ff6c"
      "a1fd8e0000000e49444154789c63606068606800000206010149a78c5f0000000049454e44ae426082";
  write_bytes(folder / "a.png", bytes_of_digits(digits));
  const auto picture = open_png(folder / "a.png", "--normal");
  EXPECT_THAT(whole(*picture).pixels, ElementsAre(1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 1, 0));
}

TEST_F(Files, an_empty_png_with_a_palette_is_not_too_small_for_its_pixels) {
  // 3200 x 300 clear black pixels of 1 bit, written with Python's zlib.
  const std::string_view digits =
      "89504e470d0a1a0a0000000d4948445200000c800000012c01030000003b43bb6e00000006504c5445000000000000a567b9cf0000"
      "000174524e530040e6d8660000008b4944415478daedc13101000000c2a0f54f6d094fa00000000000000000000000000000000000"
      "0000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000"
      "00000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000e063d5fb0001d8"
      "0e323d0000000049454e44ae426082";
  write_bytes(folder / "a.png", bytes_of_digits(digits));
  const Image image = whole(*open_png(folder / "a.png", "--normal"));
  EXPECT_EQ(image.data, (Window{0, 0, 3200, 300}));
  EXPECT_THAT(image.pixels, Each(0));
}

TEST_F(Files, a_png_that_cannot_be_written_is_an_output_error) {
  const std::vector<float> value(1);
  expect_error(ErrorKind::output, {"missing/a.png"}, [&] { write_png(folder / "missing/a.png", 1, 1, 1, value); });
  expect_error(ErrorKind::output, {"a.png", "width is zero"}, [&] { write_png(folder / "a.png", 0, 3, 1, {}); });
  expect_error(ErrorKind::output, {"a.png", "height is zero"}, [&] { write_png(folder / "a.png", 3, 0, 1, {}); });
  constexpr int kTooWide = 2'000'000;  // libpng's own limit is a million
  const std::vector<float> row(kTooWide);
  expect_error(ErrorKind::output, {"a.png", "width exceeds"},
               [&] { write_png(folder / "a.png", kTooWide, 1, 1, row); });
  EXPECT_THAT(names_in(folder.path()), IsEmpty());
}

}  // namespace
}  // namespace alcove::file_test
