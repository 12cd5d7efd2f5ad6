// One rule opens files, in every command: what a file is, its first bytes tell, whatever its name ends in.
// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/formats/exr.h"
#include "tests/support/command_line.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 36;

/// A DDS of the format R32_FLOAT.
std::string dds_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> header(32 + 5);
  std::memcpy(header.data(), "DDS ", 4);
  header[1] = 124;
  header[3] = kHeight;
  header[4] = kWidth;
  header[19] = 32;
  std::memcpy(&header[21], "DX10", 4);
  header[32] = 41;
  header[33] = 3;
  header[35] = 1;
  return {std::string(reinterpret_cast<const char*>(header.data()), 4 * header.size()) +
          std::string(reinterpret_cast<const char*>(values.data()), sizeof(float) * values.size())};
}

class OpenImage : public CommandLine {
 protected:
  std::vector<float> plane(const std::string& channel) const { return wall_frame().planes.at(channel); }

  /// A picture whose format OpenImageIO knows by the name's ending.
  void write_picture(const std::string& path, const std::vector<float>& pixels, int channels, OIIO::TypeDesc type) {
    const auto out = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(out && out->open(path, OIIO::ImageSpec(kWidth, kHeight, channels, type))) << path;
    ASSERT_TRUE(out->write_image(OIIO::TypeFloat, pixels.data()) && out->close()) << path;
  }

  /// The wall's frame with depth and normals in parts of their own.
  void write_parts(const std::string& path) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> parts{
        {"ViewLayer.Depth", {"ViewLayer.Depth.Z"}},
        {"ViewLayer.Normal", {"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"}}};
    const FrameFile file = wall_frame();
    std::vector<Imf::Header> headers;
    for (const auto& [name, channels] : parts) {
      headers.emplace_back(kWidth, kHeight);
      headers.back().setName(name);
      headers.back().setType(Imf::SCANLINEIMAGE);
      for (const auto& channel : channels) headers.back().channels().insert(channel, Imf::Channel(Imf::FLOAT));
    }
    Imf::MultiPartOutputFile out(path.c_str(), headers.data(), int(headers.size()));
    for (std::size_t part = 0; part < parts.size(); part++) {
      Imf::FrameBuffer pixels;
      for (const auto& channel : parts[part].second)
        pixels.insert(channel, Imf::Slice::Make(Imf::FLOAT, file.planes.at(channel).data(), {0, 0}, kWidth, kHeight));
      Imf::OutputPart one(out, int(part));
      one.setFrameBuffer(pixels);
      one.writePixels(kHeight);
    }
  }
};

TEST_F(OpenImage, compare_reads_dds) {
  const std::string texture = folder / "a.dds";
  write_bytes(texture, dds_of(plane("ViewLayer.Depth.Z")));
  const Finished finished =
      run_program({"compare", texture, frame, "--channel", "R=ViewLayer.Depth.Z", "--max-rmse", "0", "--json"});
  ASSERT_EQ(finished.code, 0) << finished;
  EXPECT_EQ(json::parse(finished.out)["max"], 0);
}

TEST_F(OpenImage, an_exr_keeps_its_parts_under_any_name) {
  for (const char* name : {"parts.exr", "parts.tif", "parts.png", "parts.tga", "parts"}) {
    write_parts(folder / name);
    const Finished finished = run_program({"inspect", folder / name, "--camera", camera, "--json"});
    ASSERT_EQ(finished.code, 0) << name << finished;
    const json found = json::parse(finished.out);
    EXPECT_EQ(found["files"][0]["parts"].size(), 2) << name;
    EXPECT_EQ(found["aovs"]["normal"]["part"], 1) << name;
  }
}

TEST_F(OpenImage, pictures_are_known_under_any_name) {
  std::vector<float> normals;
  for (std::size_t i = 0; i < kWidth * kHeight; i++)
    for (const char* axis : {"X", "Y", "Z"})
      normals.push_back(0.5f + 0.5f * plane(std::string("ViewLayer.Normal.") + axis)[i]);
  write_picture(folder / "normal.png", normals, 3, OIIO::TypeUInt8);
  ASSERT_EQ(run({"--normal", folder / "normal.png"}).code, 0);
  const auto expected = read_exr_image(ao).pixels;
  for (const char* name : {"normal.exr", "normal.dds", "normal.tif", "normal"}) {
    std::filesystem::copy_file(folder / "normal.png", folder / name);
    const Finished finished = run({"--normal", folder / name});
    ASSERT_EQ(finished.code, 0) << name << finished;
    EXPECT_EQ(read_exr_image(ao).pixels, expected) << name;
  }
}

TEST_F(OpenImage, a_run_says_what_a_file_is_that_it_does_not_read_and_what_it_reads) {
  write_picture(folder / "x.jpg", plane("ViewLayer.Depth.Z"), 1, OIIO::TypeUInt8);
  const std::vector<std::tuple<std::string, std::string, std::string>> files{
      {"x.jpg", read_bytes(folder / "x.jpg"), "JPEG"},
      {"x.exr", read_bytes(folder / "x.jpg"), "JPEG"},
      {"x.gif", "GIF89a and more", "GIF"},
      {"x.psd", "8BPS and more", "Photoshop"},
      {"text.exr", "no picture", "not a picture"},
      {"text.png", "no picture", "not a picture"},
      {"empty.exr", "", "empty"},
  };
  for (const auto& [name, bytes, word] : files) {
    write_bytes(folder / name, bytes);
    for (const std::string option : {"INPUT", "--normal"}) {
      const bool is_input = option == "INPUT";
      const Finished finished = is_input
                                    ? run_program({"run", folder / name, "-o", ao, "--camera", camera, "--radius", "1"})
                                    : run({option, folder / name});
      EXPECT_EQ(finished.code, 3) << finished;
      EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
      EXPECT_THAT(finished.err, AllOf(HasSubstr(name), HasSubstr(word), HasSubstr(option)));
      for (const char* format : {"OpenEXR", "DDS", "PNG", "TIFF", "TGA", "BMP", "Radiance HDR"})
        EXPECT_THAT(finished.err, HasSubstr(format));
    }
  }
}

TEST_F(OpenImage, compare_reads_what_a_run_does_not) {
  write_picture(folder / "x.jpg", std::vector<float>(kWidth * kHeight, 0.5f), 1, OIIO::TypeUInt8);
  const Finished finished = run_program({"compare", folder / "x.jpg", folder / "x.jpg", "--max-rmse", "0"});
  EXPECT_EQ(finished.code, 0) << finished;
}

}  // namespace
}  // namespace alcove
