// One projection model: pixel <-> view ray, from a camera JSON file, a .chan file, or numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/settings.h"
#include "core/frame/linear.h"
#include "kernels/base/shared.h"

namespace alcove {

/// Projection onto the display window: view space is right-handed, x right, y up, the camera looks along -z.
/// A point is seen at (cx + fx x / -z, cy - fy y / -z), or (cx + fx x, cy - fy y) when orthographic.
struct Camera {
  int width = 0, height = 0;         // px of the display window it was made for, > 0
  std::array<int, 2> scaled_from{};  // px of the resolution that its file is for, where that is another one
  double fx = 0, fy = 0;             // px (perspective) or px per scene unit (orthographic), > 0
  double cx = 0, cy = 0;             // px from the display window's upper left corner
  bool orthographic = false;
  // A rotation, which mirrors where the world is left-handed; none if the source does not tell.
  std::optional<Matrix3> view_from_world;
  std::array<double, 3> view_from_world_offset{};  // scene units: view = view_from_world * world + offset
  // The header attribute that gave view_from_world beside a projection by options; empty if one source gave both.
  std::string placement_from;
  // The source's own camera space looks along +z, and its view-space normals and positions are of that space.
  bool left_handed = false;
  std::optional<double> near, far;  // clip planes, scene units; far may be infinite
  bool reversed_z = false;
  // Where the source's projection matrix puts depth 0, if its z were the depth itself.
  std::optional<double> matrix_near;
  DepthKind depth_kind = DepthKind::automatic;  // what its source says of the frame's depth
  NormalSpace normal_space = NormalSpace::automatic;
  NormalEncoding normal_encoding = NormalEncoding::automatic;
  std::optional<Vector3> chan_angles;  // of a .chan file about x, y and z, radians, which --chan-rotation puts in order
};

/// The options that give a camera.
inline constexpr const char* kCameraOptions =
    "--camera FILE.json, or --fov DEGREES, or --focal MM with --aperture MM, or --ortho-width UNITS";

/// ErrorKind::usage: nothing gives a camera to the frame of this file; `why` says of what might have why it does not.
struct NoCamera : Error {
  explicit NoCamera(const std::string& file, const std::string& why = "");
  const std::string why;
};

/// A perspective camera whose optical axis is in the middle. A pixel that is `pixel_aspect` times as wide as high
/// covers that much more in x.
Camera centred(const Window& display, double fx, double pixel_aspect);

/// Reads a camera JSON file, whose keys docs/inputs.md lists; if the file lists `frames`, the one of that number, and
/// where it has `views`, the one of that name; "": what all views share. Fails with ErrorKind::input, naming file and
/// field, on anything missing or senseless.
Camera read_camera(const std::string& path, int frame, const std::string& view = "");

/// Gives the camera in the text of a camera file for a frame of this display window; `name` is for messages. Fails as
/// read_camera() does, and where it does not fit.
Camera camera_of(const std::string& text, const std::string& name, const Window& display, int frame);

/// Whether a camera file lists `frames`. Fails with ErrorKind::input where it cannot be read.
bool lists_frames(const std::string& path);

/// Fails with ErrorKind::input where a camera file lists `frames` and none of them has this number. What stands in the
/// entry is not looked at: its fields may be those of views.
void require_listed(const std::string& path, int frame);

/// Whether the settings give a camera, or at least try to.
bool names_a_camera(const InputSettings& settings);

/// Gives the camera of the settings for a frame of this display window and pixel aspect (width / height of a pixel): by
/// its file, by fov, by focal and aperture, or by ortho_width. Fails with NoCamera if there is none, and with
/// ErrorKind::input if it does not fit.
Camera camera_for(const InputSettings& settings, const Window& display, double pixel_aspect, int frame,
                  const std::string& view = "");

/// Gives the map from the normals' space, with their flips, to view space. World space needs camera.view_from_world.
Matrix3 view_from_normal(const Camera& camera, NormalSpace space, const NormalFlips& flips);

/// Rows of a map from one view space to another: x' = row.xyz * x + row.w, scene units.
using ViewMap = std::array<std::array<double, 4>, 3>;
/// Gives the map from one camera's view space to another's. Both need view_from_world.
ViewMap view_from_view(const Camera& to, const Camera& from);

/// Gives the projection as kernels take it, for pixels counted from the data window's upper left corner.
View view_of(const Camera& camera, const Window& data, const Window& display);

/// Where a point at a place of one view, px, and at a planar depth is in another one: px, and its planar depth there.
struct SeenAt {
  double x, y, depth;
};
SeenAt seen_from(const View& other, const ViewMap& other_from_view, const View& view, double x, double y, double depth);

/// The length of a pixel's ray at unit depth; 1 where it is orthographic.
double ray_length(const View& view, int x, int y);

// .chan files, which Nuke, Maya, Houdini and Blender write.

/// Whether a file is one by its name.
bool is_chan_file(const std::string& path);

/// Reads a .chan file: a line for each frame, of its number, the place x y z, the angles x y z in degrees and the
/// vertical field of view in degrees. `rotation`: the axes in the order in which
/// the angles turn the camera, such as zxy (Nuke's). The camera looks along -z, with y up; its projection is centred on
/// the display window. Fails with ErrorKind::input, naming file, frame and what is wrong.
Camera read_chan(const std::string& path, int frame, const std::string& rotation, const Window& display,
                 double pixel_aspect);

/// The rotation from the world to a camera's space, of angles about x, y and z in radians.
Matrix3 view_by_angles(const Vector3& angles, const std::string& rotation);

/// The orders in which a camera may be turned about the axes.
inline constexpr std::array kChanRotations{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};

}  // namespace alcove
