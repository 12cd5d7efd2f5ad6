// A small rendered frame made by hand: a floor that meets a wall, with every AOV that the program reads.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/formats/exr.h"
#include "tests/support/openexr.h"
#include "tests/support/test.h"

namespace alcove::test {

constexpr Window kWallWindow{0, 0, 64, 36};

/// An EXR file to be. Change the planes, then write it.
struct FrameFile {
  Window data = kWallWindow, display = kWallWindow;
  double pixel_aspect = 1;
  std::map<std::string, std::vector<float>> planes = {};
  std::set<std::string> halves = {};  // the planes to be written as half
  std::map<std::string, std::string> attributes = {};
  std::string compression = "zip";
  std::shared_ptr<const ExrAttributes> input_attributes = {};  // to carry over

  /// The file as a writer takes it: its planes are in the order of `planes`.
  ExrOutput output() const;
  std::vector<std::span<const float>> pixels() const;
  void write(const std::string& path) const;
  /// Gives a plane another name.
  void rename(const std::string& from, const std::string& to);
  /// Removes, or replaces every value of, the planes whose names hold a text.
  void erase(const std::string& text);
  void change(const std::string& text, const std::function<float(float)>& value_of);
};

/// Writes a file of one plane.
void write_plane(const std::string& path, const std::string& channel, const std::vector<float>& plane,
                 const Window& data = kWallWindow, const std::optional<Window>& display = {});

/// Depth and world-space normals as Blender names them. The floor is 1 below the eye, the wall 6 in front of it; the
/// world's z is up. On the wall, everything above the middle of the display window is farther than 1 from the floor.
FrameFile wall_frame(const Window& data = kWallWindow, const Window& display = kWallWindow, double pixel_aspect = 1);

/// The length of a pixel's ray, of unit depth, in kWallWindow.
inline double ray_length(std::size_t pixel) {
  return std::hypot(1, (double(pixel % 64) + 0.5 - 32) / 60, (double(pixel / 64) + 0.5 - 18) / 60);
}

/// Puts the normals into view space, whose y is the world's z and whose z is the world's -y.
void turn_normals_to_view(FrameFile& frame);

/// Adds Combined with alpha below 1 in places, DiffInd and DiffCol: uneven values, up to 2.
void add_beauty(FrameFile& frame);

/// A beauty over any window: R, G and B whose pixels have their value wherever they lie in it.
float beauty_at(int x, int y, int channel);
FrameFile beauty_over(const Window& data, const Window& display);

/// The camera file that fits the frame.
json wall_camera(const Window& display = kWallWindow, double pixel_aspect = 1);

// A frame whose normals' channels are named as colours are, which DWA quantizes.

inline void write_with_dwa(const std::string& path, Imf::Compression compression) {
  FrameFile file = wall_frame();
  for (const auto& [axis, color] : {std::pair("X", "R"), {"Y", "G"}, {"Z", "B"}})
    file.rename(std::string("ViewLayer.Normal.") + axis, std::string("ViewLayer.Normal.") + color);
  Imf::Header header(file.data.width, file.data.height);
  header.compression() = compression;
  write_openexr(path, header, file.planes);
}

}  // namespace alcove::test
