// One projection model: pixel <-> view ray, from a camera JSON file or from numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/base/image.h"
#include "core/base/settings.h"
#include "kernels/shared.h"

namespace alcove {

/// Rows of a rotation (or any linear map): to = M * from.
using Matrix3 = std::array<std::array<double, 3>, 3>;

/// Projection onto the display window: view space is right-handed, x right, y up, the camera looks along -z.
/// A point is seen at (cx + fx x / -z, cy - fy y / -z), or (cx + fx x, cy - fy y) when orthographic.
struct Camera {
  int width = 0, height = 0;  // px of the display window it was made for, > 0
  double fx = 0, fy = 0;      // px (perspective) or px a scene unit (orthographic), > 0
  double cx = 0, cy = 0;      // px from the display window's upper left corner
  bool orthographic = false;
  // rotation only; none where the source does not tell. It mirrors where the world is left-handed
  std::optional<Matrix3> view_from_world;
  std::array<double, 3> view_from_world_offset{};  // scene units: view = view_from_world * world + offset
  // the source's own camera space looks along +z: so do its view-space normals and positions
  bool left_handed = false;
  std::optional<double> near, far;  // clip planes, scene units; far may be infinite
  bool reversed_z = false;
  // where the source's projection matrix puts depth 0, were its z the depth itself
  std::optional<double> matrix_near;
  DepthKind depth_kind = DepthKind::automatic;  // what its source says of the frame's depth
  NormalSpace normal_space = NormalSpace::automatic;
  NormalEncoding normal_encoding = NormalEncoding::automatic;
};

/// Reads a camera JSON file (keys: DESIGN of the command line in README.md); where it lists `frames`, the one of that
/// number. Fails with ErrorKind::input, naming file and field, on anything missing or senseless.
Camera read_camera(const std::string& path, int frame);

/// The camera that the settings give for a frame of this display window and pixel aspect (width / height of a pixel):
/// the file, or fov, or focal and aperture, or ortho_width. Fails with ErrorKind::usage when there is none,
/// ErrorKind::input when it does not fit.
Camera camera_for(const InputSettings& settings, const Window& display, double pixel_aspect, int frame);

/// From the normals' space, with their flips, to view space. World space needs camera.view_from_world.
Matrix3 view_from_normal(const Camera& camera, NormalSpace space, const NormalFlips& flips);

/// The projection as kernels take it, for pixels counted from the data window's upper left corner.
View view_of(const Camera& camera, const Window& data, const Window& display);

}  // namespace alcove
