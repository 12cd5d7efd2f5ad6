// A small rendered frame made by hand: a floor that meets a wall, with every AOV that the program reads.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace alcove::test {

constexpr Window kWallWindow{0, 0, 64, 36};

/// An EXR file to be. Change the planes, then write it.
struct FrameFile {
  Window data = kWallWindow, display = kWallWindow;
  double pixel_aspect = 1;
  std::map<std::string, std::vector<float>> planes;
  std::set<std::string> halves;  // the planes to be written as half
  std::map<std::string, std::string> attributes;

  void write(const std::string& path) const;
  /// Gives a plane another name.
  void rename(const std::string& from, const std::string& to);
};

/// Depth and world-space normals as Blender names them. The floor is 1 below the eye, the wall 6 in front of it; the
/// world's z is up. On the wall, everything above the middle of the display window is farther than 1 from the floor.
FrameFile wall_frame(const Window& data = kWallWindow, const Window& display = kWallWindow, double pixel_aspect = 1);

/// Puts the normals into view space, whose y is the world's z and whose z is the world's -y.
void turn_normals_to_view(FrameFile& frame);

/// Adds Combined with alpha below 1 in places, DiffInd and DiffCol: uneven values, up to 2.
void add_beauty(FrameFile& frame);

/// The camera file that fits the frame.
nlohmann::json wall_camera(const Window& display = kWallWindow, double pixel_aspect = 1);

}  // namespace alcove::test
