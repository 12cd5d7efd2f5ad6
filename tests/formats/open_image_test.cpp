// One rule opens files, in every command: what a file is, its first bytes tell, whatever its name ends in.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "tests/support/openexr.h"
#include "tests/support/picture_file.h"
#include "tests/support/test.h"

namespace alcove::open_image_test {
namespace {

using namespace test;

class OpenImage : public CommandLine {
 protected:
  static std::vector<float> plane(const std::string& channel) { return wall_frame().planes.at(channel); }

  /// Gives a part of its own with channels of the wall's frame.
  static DeepFilePart part_of(const std::string& name, const std::vector<std::string>& channels) {
    DeepFilePart part{.data = kWallWindow, .channels = channels, .name = name, .is_flat = true};
    for (std::size_t i = 0; i < kWallWindow.pixels(); i++) {
      part.pixels.push_back({{}});
      for (const auto& channel : channels) part.pixels[i][0].push_back(plane(channel)[i]);
    }
    return part;
  }

  void write_normals(const std::string& path) const {
    std::vector<float> normals;
    const FrameFile file = wall_frame();
    for (std::size_t i = 0; i < kWallWindow.pixels(); i++)
      for (const char* axis : {"X", "Y", "Z"})
        normals.push_back(0.5f + 0.5f * file.planes.at(std::string("ViewLayer.Normal.") + axis)[i]);
    write_picture(path, OIIO::ImageSpec(64, 36, 3, OIIO::TypeUInt8), normals);
  }

  static std::vector<float> red_of(const std::string& path, const char* option = "--normal") {
    ExrFile file = open_image(path, option, Formats::of_frames);
    std::vector<float> red(kWallWindow.pixels());
    const ExrRead read{0, file.parts().at(0).channels.at(0).name, red.data()};
    file.read({&read, 1});
    return red;
  }
};

TEST_F(OpenImage, compare_reads_dds) {
  const std::string texture = folder / "a.dds";
  write_bytes(texture, dds(64, 36, 41, bytes_of(plane("ViewLayer.Depth.Z"))));
  const Finished finished =
      run_well({"compare", texture, frame, "--channel", "R=ViewLayer.Depth.Z", "--max-rmse", "0", "--json"});
  EXPECT_EQ(json::parse(finished.out)["max"], 0);
}

TEST_F(OpenImage, an_exr_keeps_its_parts_under_any_name) {
  write_deep(frame, {part_of("ViewLayer.Depth", {"ViewLayer.Depth.Z"}),
                     part_of("ViewLayer.Normal", {"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"})});
  for (const char* name : {"parts.exr", "parts.tif", "parts.png", "parts.tga", "parts"}) {
    fs::copy_file(frame, folder / name);
    const Finished finished = run_well({"inspect", folder / name, "--camera", camera, "--json"});
    const json found = json::parse(finished.out);
    EXPECT_EQ(found["files"][0]["parts"].size(), 2) << name;
    EXPECT_EQ(found["aovs"]["normal"]["part"], 1) << name;
  }
}

TEST_F(OpenImage, pictures_are_known_under_any_name) {
  write_normals(folder / "normal.png");
  const auto expected = red_of(folder / "normal.png");
  for (const char* name : {"normal.exr", "normal.dds", "normal.tif", "normal"}) {
    fs::copy_file(folder / "normal.png", folder / name);
    EXPECT_EQ(red_of(folder / name), expected) << name;
  }
  EXPECT_EQ(run({"--normal", folder / "normal.exr"}).code, 0);
}

TEST_F(OpenImage, it_is_said_what_a_file_is_that_a_run_does_not_read_and_what_it_reads) {
  write_picture(folder / "x.jpg", OIIO::ImageSpec(64, 36, 1, OIIO::TypeUInt8), plane("ViewLayer.Depth.Z"));
  const std::vector<std::string> formats{"OpenEXR", "DDS", "PNG", "NumPy", "TIFF", "TGA", "BMP", "Radiance HDR"};
  for (const auto& [name, bytes, word] :
       std::vector<std::tuple<std::string, std::string, std::string>>{{"x.jpg", read_bytes(folder / "x.jpg"), "JPEG"},
                                                                      {"x.exr", read_bytes(folder / "x.jpg"), "JPEG"},
                                                                      {"x.gif", "GIF89a and more", "GIF"},
                                                                      {"x.npz", "PK\3\4 and more", ".npz"},
                                                                      {"x.psd", "8BPS and more", "Photoshop"},
                                                                      {"text.exr", "no picture", "not a picture"},
                                                                      {"text.png", "no picture", "not a picture"},
                                                                      {"empty.exr", "", "empty"}}) {
    write_bytes(folder / name, bytes);
    for (const char* option : {"INPUT", "--normal"}) {
      const std::string path = folder / name, said = error_of(ErrorKind::input, [&] { red_of(path, option); });
      for (const auto& part : {name, word, std::string(option)}) EXPECT_THAT(said, HasSubstr(part));
      for (const auto& format : formats) EXPECT_THAT(said, HasSubstr(format)) << name;
    }
  }
  for (const auto& finished : {run_program({"run", folder / "x.jpg", "-o", ao, "--camera", camera, "--radius", "1"}),
                               run({"--normal", folder / "x.jpg"})}) {
    EXPECT_EQ(finished.code, 3) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    EXPECT_THAT(finished.err, AllOf(HasSubstr("JPEG"), HasSubstr("Radiance HDR")));
  }
  EXPECT_EQ(run_program({"compare", folder / "x.jpg", folder / "x.jpg", "--max-rmse", "0"}).code, 0)
      << "compare reads it";
}

TEST_F(OpenImage, a_picture_that_is_cut_short_is_named) {
  std::uint32_t random = 1;
  std::vector<float> noise(3 * 64 * 36);
  for (float& value : noise) value = float((random = random * 1664525u + 1013904223u) >> 24) / 255;
  for (const std::string name : {"normal.png", "normal.tif", "normal.tga", "normal.bmp", "normal.hdr"}) {
    const std::string path = folder / name;
    write_picture(path, OIIO::ImageSpec(64, 36, 3, name == "normal.hdr" ? OIIO::TypeFloat : OIIO::TypeUInt8), noise);
    const std::string whole = read_bytes(path);
    write_bytes(path, whole.substr(0, whole.size() / 2));
    expect_error(ErrorKind::input, {path, "damaged or incomplete", "--normal"}, [&] { red_of(path); });
  }
  EXPECT_EQ(run({"--normal", folder / "normal.png", "--normal-space", "view"}).code, 3);
  EXPECT_FALSE(fs::exists(ao));
}

}  // namespace
}  // namespace alcove::open_image_test
