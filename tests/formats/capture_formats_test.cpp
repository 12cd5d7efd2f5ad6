// Pictures that are no EXR: textures of RenderDoc, and normals of 8 and 16 bits; and files made to do harm.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/frame_source.h"
#include "core/frame/settle/settle.h"
#include "tests/support/command_line.h"
#include "tests/support/picture_file.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace alcove::capture_formats_test {
namespace {

using namespace test;

class Dds : public testing::Test {
 protected:
  Image read(std::uint32_t format, const std::string& pixels, std::uint32_t width = 2, std::uint32_t height = 1) const {
    write_bytes(path, dds(width, height, format, pixels));
    return read_dds(path);
  }
  void expect_refused(const std::string& bytes, const char* word) const {
    write_bytes(path, bytes);
    expect_error(ErrorKind::input, {word, "texture.dds", "--depth"}, [&] { read_dds(path); });
  }
  TemporaryFolder folder;
  const std::string path = folder / "texture.dds";
};

TEST_F(Dds, of_every_format_is_read) {
  EXPECT_THAT(read(41, bytes_of<float>({0.25f, 3e7f})).pixels, ElementsAre(0.25f, 3e7f));
  EXPECT_THAT(read(40, bytes_of<float>({0.25f, 1})).names, ElementsAre("R"));
  EXPECT_THAT(read(56, bytes_of<std::uint16_t>({0, 65535})).pixels, ElementsAre(0, 1));
  EXPECT_THAT(read(54, bytes_of<std::uint16_t>({0x3c00, 0xb800})).pixels, ElementsAre(1, -0.5f));
  EXPECT_THAT(read(46, words({0xab000000, 0xcdffffff})).pixels, ElementsAre(0, 1))
      << "the upper 8 bits are the stencil";
  for (const std::uint32_t format : {19u, 20u, 21u})
    EXPECT_THAT(read(format, words({0x3e800000, 0xffffffab, 0x3f800000, 0})).pixels, ElementsAre(0.25f, 1))
        << "the second word is the stencil";
  const Image half =
      read(10, bytes_of<std::uint16_t>({0x3c00, 0x4000, 0x0001, 0x7bff, 0x7c00, 0xfc00, 0x8000, 0x3555}));
  EXPECT_THAT(half.names, ElementsAre("R", "G", "B", "A"));
  EXPECT_THAT(half.pixels, ElementsAre(1, INFINITY, 2, -INFINITY, std::ldexp(1.0f, -24), -0.0f, 65504,
                                       testing::FloatNear(1 / 3.0f, 1e-3f)));
  const Image packed = read(24, words({1023u | 0u << 10 | 341u << 20 | 3u << 30, 0}));
  EXPECT_THAT(packed.pixels, ElementsAre(1, 0, 0, 0, testing::FloatNear(1 / 3.0f, 1e-6f), 0, 1, 0));
  EXPECT_THAT(read(28, words({0xff008000, 0})).pixels,
              ElementsAre(0, 0, testing::FloatNear(128 / 255.0f, 1e-6f), 0, 0, 0, 1, 0));
}

TEST_F(Dds, of_the_older_header_is_read) {
  std::string bytes = dds(2, 1, 0, "");
  bytes.resize(128);
  const std::uint32_t letters = 114;  // D3DFMT_R32F
  std::memcpy(&bytes[84], &letters, 4);
  write_bytes(path, bytes + bytes_of<float>({4, 5}));
  EXPECT_THAT(read_dds(path).pixels, ElementsAre(4, 5));
}

TEST_F(Dds, that_makes_no_sense_is_refused) {
  const std::string good = dds(2, 1, 41, bytes_of<float>({1, 2}));
  expect_refused(good.substr(0, good.size() - 1), "ends too early");
  for (const std::size_t size : {4u, 100u, 130u}) expect_refused(good.substr(0, size), "ends too early");
  for (const std::uint32_t side : {0u, 0x80000000u, 0xffffffffu, 65537u}) {
    expect_refused(dds(side, 1, 41, ""), "header");
    expect_refused(dds(1, side, 41, ""), "header");
  }
  expect_refused(dds(65536, 65536, 2, ""), "ends too early");
  expect_refused(dds(2, 1, 98, bytes_of<float>({1, 2, 3, 4})), "format 98");
  std::string sizes = good;
  sizes[4] = 0;
  expect_refused(sizes, "header");
}

// In the place of EXRs.

class Formats : public CommandLine {
 protected:
  /// The normals in 0..1 as a picture of 8 or 16 bits.
  void write_normals(const std::string& path, OIIO::TypeDesc type) const {
    const FrameFile file = wall_frame();
    std::vector<float> pixels;
    for (std::size_t i = 0; i < file.data.pixels(); i++)
      for (const char* axis : {"X", "Y", "Z"})
        pixels.push_back(0.5f + 0.5f * file.planes.at(std::string("ViewLayer.Normal.") + axis)[i]);
    write_picture(path, OIIO::ImageSpec(file.data.width, file.data.height, 3, type), pixels);
  }
};

TEST_F(Formats, normals_of_8_and_16_bits_are_read) {
  ASSERT_EQ(run({"--type", "float"}).code, 0);
  const auto expected = read_exr_image(ao).pixels;
  for (const auto& [name, type, tolerance] :
       {std::tuple{"normal.png", OIIO::TypeUInt8, 0.01}, {"normal.tif", OIIO::TypeUInt16, 2e-3}}) {
    write_normals(folder / name, type);
    done({"--type", "float", "--normal", folder / name});
    EXPECT_LE(difference(read_exr_image(ao).pixels, expected).rmse, tolerance)
        << name << ": single samples fall in or out of the radius";
  }
}

TEST_F(Formats, textures_of_renderdoc_are_read) {
  ASSERT_EQ(run({"--type", "float"}).code, 0);
  const auto expected = read_exr_image(ao).pixels;
  const FrameFile file = wall_frame();
  const auto normal = [&](const char* axis) { return file.planes.at(std::string("ViewLayer.Normal.") + axis); };
  std::vector<float> device;
  std::vector<std::uint16_t> device16, halves;
  std::vector<std::uint32_t> device24, packed;
  const auto ten = [](float x) { return std::uint32_t(std::lround(1023 * (0.5f + 0.5f * x))); };
  // of -1, 0 and 1, and all normals here are these
  const auto half_of = [](float x) { return std::uint16_t(x == 0 ? 0 : x > 0 ? 0x3c00 : 0xbc00); };
  for (std::size_t i = 0; i < file.data.pixels(); i++) {
    const float d = 0.5f / file.planes.at("ViewLayer.Depth.Z")[i], x = normal("X")[i], y = normal("Y")[i],
                z = normal("Z")[i];
    device.push_back(d), device16.push_back(std::uint16_t(std::lround(65535 * d))),
        device24.push_back(0xab000000 | std::uint32_t(std::lround(0xffffff * d)));
    packed.push_back(ten(x) | ten(y) << 10 | ten(z) << 20);
    for (const float n : {x, y, z, 1.0f}) halves.push_back(half_of(n));
  }
  write_bytes(folder / "r10g10b10a2.dds", dds(64, 36, 24, words(packed)));
  write_bytes(folder / "rgba16f.dds", dds(64, 36, 10, bytes_of(halves)));
  const std::string depth = folder / "depth.0042.dds";
  for (const auto& [name, bytes, normals, tolerance] :
       {std::tuple{"R32F", dds(64, 36, 41, bytes_of(device)), "rgba16f.dds", 1e-3},
        {"D24", dds(64, 36, 45, words(device24)), "r10g10b10a2.dds", 0.011},
        {"R16", dds(64, 36, 56, bytes_of(device16)), "rgba16f.dds", 0.01}}) {
    write_bytes(depth, bytes);
    run_well(joined({"run", "--depth", depth, "--normal", folder / normals, "-o", ao, "--camera", camera},
                    typed("--radius 1 --type float --far inf --preset input/renderdoc --depth-kind device --near 0.5 "
                          "--reversed-z")));
    EXPECT_LE(difference(read_exr_image(ao).pixels, expected).rmse, tolerance) << name << " " << normals;
  }
}

TEST_F(Formats, depth_of_8_bits_is_refused) {
  std::vector<float> values(64 * 36);
  for (std::size_t i = 0; i < values.size(); i++) values[i] = float(i * 7 % 256) / 255;
  write_picture(folder / "depth.png", OIIO::ImageSpec(64, 36, 1, OIIO::TypeUInt8), values);
  expect_refused(3, {"--depth", folder / "depth.png"}, {"8 bits"});
}

TEST_F(Formats, pictures_give_any_rows_in_any_order_however_they_are_stored) {
  constexpr int kWide = 701, kHigh = 907;  // some megabytes: several blocks
  std::vector<float> interleaved(std::size_t(3 * kWide) * kHigh);
  for (std::size_t i = 0; i < interleaved.size(); i++) interleaved[i] = float(i * 7919 % 65536) / 65535;
  struct Stored {
    const char* name;
    int tile;
    bool separate;
    OIIO::TypeDesc type;
    double step;
  };
  for (const auto& stored : {Stored{"rows.tif", 0, false, OIIO::TypeFloat, 0},
                             {"tiles.tif", 64, false, OIIO::TypeFloat, 0},
                             {"planes.tif", 0, true, OIIO::TypeFloat, 0},
                             {"tiled-planes.tif", 32, true, OIIO::TypeUInt16, 1e-7},
                             {"rows.png", 0, false, OIIO::TypeUInt16, 1e-7},
                             {"rows.tga", 0, false, OIIO::TypeUInt8, 0.002}}) {
    const std::string path = folder / stored.name;
    OIIO::ImageSpec spec(kWide, kHigh, 3, stored.type);
    spec.tile_width = spec.tile_height = stored.tile;
    if (stored.separate) spec.attribute("planarconfig", "separate");
    write_picture(path, spec, interleaved);
    ExrFile file = open_image(path, "--normal", alcove::Formats::of_frames);
    ASSERT_EQ(file.parts().at(0).channels.size(), 3u) << path;
    for (const auto& [first, rows] : {std::pair(0, kHigh), {600, 307}, {63, 2}, {0, 1}, {906, 1}}) {
      std::vector<float> green(std::size_t(kWide * rows)), red(green.size());
      const ExrRead reads[] = {{0, file.parts()[0].channels[1].name, green.data()},
                               {0, file.parts()[0].channels[0].name, red.data()}};
      file.read(reads, first, rows);
      for (std::size_t i = 0; i < green.size(); i++) {
        const std::size_t at = 3 * (std::size_t(first) * kWide + i);
        ASSERT_NEAR(green[i], interleaved[at + 1], stored.step) << path << " rows from " << first << " pixel " << i;
        ASSERT_NEAR(red[i], interleaved[at], stored.step) << path << " rows from " << first << " pixel " << i;
      }
    }
  }
}

TEST_F(Formats, inspect_draws_a_contact_sheet) {
  const std::string sheet = folder / "sheet.png";
  run_well({"inspect", frame, "--camera", camera, "--preview", sheet});
  const auto in = OIIO::ImageInput::open(sheet);
  ASSERT_TRUE(in);
  EXPECT_EQ(in->spec().width, 3 * 64);
  EXPECT_EQ(in->spec().height, 36);
  std::vector<std::uint8_t> pixels(3 * 64 * 36 * 3);
  ASSERT_TRUE(in->read_image(0, 0, 0, 3, OIIO::TypeUInt8, pixels.data()));
  const auto at = [&](int panel, int x, int y) { return &pixels[std::size_t(3 * (y * 3 * 64 + panel * 64 + x))]; };
  EXPECT_GT(at(0, 32, 35)[0], at(0, 32, 5)[0]) << "the floor before the eye is nearer than the wall";
  EXPECT_GT(at(1, 32, 35)[1], 250) << "the floor's normal points up";
  EXPECT_GT(at(1, 32, 5)[2], 250) << "the wall's to the camera";
  EXPECT_GT(at(2, 32, 2)[0], at(2, 32, 26)[0]) << "the corner is darker than the wall far above it";
}

// Hostile headers.

/// An EXR header made of attributes, byte by byte.
struct RawExr {
  std::string bytes{"\x76\x2f\x31\x01\x02\x00\x00\x00", 8};
  void add(const std::string& name, const std::string& type, const std::string& value) {
    bytes += name + '\0' + type + '\0' + words({std::uint32_t(value.size())}) + value;
  }
};

std::string channel(const std::string& name) { return name + '\0' + words({2, 0, 1, 1}); }

RawExr raw_exr(const std::string& channels, const std::vector<std::uint32_t>& data_window) {
  RawExr exr;
  exr.add("channels", "chlist", channels + '\0');
  exr.add("compression", "compression", std::string(1, '\0'));
  exr.add("dataWindow", "box2i", words(data_window));
  exr.add("displayWindow", "box2i", words({0, 0, 63, 35}));
  exr.add("lineOrder", "lineOrder", std::string(1, '\0'));
  exr.add("pixelAspectRatio", "float", bytes_of<float>({1}));
  exr.add("screenWindowCenter", "v2f", bytes_of<float>({0, 0}));
  exr.add("screenWindowWidth", "float", bytes_of<float>({1}));
  return exr;
}

TEST_F(Formats, hostile_headers_are_errors) {
  InputSettings settings;
  settings.input = frame;
  settings.fov = 60;
  const auto expect_refused = [&](const std::string& what, const std::string& bytes, const std::string& word = "") {
    SCOPED_TRACE(what);
    write_bytes(frame, bytes);
    expect_error(ErrorKind::input, {"wall.0042.exr", word}, [&] {
      FrameSource source = find_frame(settings, false, 0);
      std::vector<float> depth(source.reading.data.pixels());
      read_planes(source, source.reading.data, {{&source.channels[RawPlane::depth], depth.data()}});
    });
  };
  const std::uint32_t most = 0x7fffffff, least = 0x80000000;
  const std::vector<std::vector<std::uint32_t>> windows{
      {0, 0, most, most},     {least, least, most, most}, {0, 0, 0x3ffffffe, 0x3ffffffe}, {10, 10, 5, 5},
      {0, 0, 131071, 131071}, {0, 0, 63, most},           {most, most, least, least},     {0, 0, 63, 35}};
  for (const auto& window : windows)
    expect_refused(testing::PrintToString(window), raw_exr(channel("Z"), window).bytes + '\0');
  for (const auto& finished : {run({}), run_program({"inspect", frame, "--camera", camera})})
    EXPECT_EQ(finished.code, 3) << finished;
  RawExr tiled = raw_exr(channel("Z"), {0, 0, 0x3ffffffe, 0x3ffffffe});
  tiled.add("tiles", "tiledesc", words({1, 1}) + '\0');
  tiled.bytes[5] = 0x02;  // the flag of tiles
  expect_refused("tiles", tiled.bytes + '\0');
  expect_refused(
      "an attribute without end",
      raw_exr(channel("Z"), {0, 0, 63, 35}).bytes + std::string("comments\0string\0", 16) + words({most}) + "short",
      "comments");
  expect_refused("no channels", raw_exr("", {0, 0, 63, 35}).bytes + '\0');
  std::string many;
  for (int i = 0; i < 100000; i++) many += channel(fmt::format("{:06}.depth.Z", i));
  expect_refused("many channels", raw_exr(many, {0, 0, 63, 35}).bytes + '\0' + std::string(36 * 8, '\0'));
  RawExr absurd = raw_exr(channel("Z") + channel(std::string(200, '.')), {0, 0, 63, 35});
  absurd.add("worldToCamera", "string", std::string(1000000, '9'));
  absurd.add("worldToNDC", "m44f", bytes_of<float>(std::vector<float>(16, NAN)));
  absurd.add("Software", "string", std::string(1000000, '*'));
  expect_refused("absurd values", absurd.bytes + '\0');
  RawExr endless = raw_exr(channel("Z"), {0, 0, 63, 35});
  endless.add("comments", "string", std::string(40 << 20, 'x'));
  expect_refused("longer than any program writes", endless.bytes + '\0', "longer than");
}

}  // namespace
}  // namespace alcove::capture_formats_test
