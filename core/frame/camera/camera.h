// The camera of a frame, pixel <-> view ray, from a camera JSON file, a .chan file, a header, or numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/settings.h"
#include "core/frame/camera/linear.h"
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
  // The distance at which the source's projection matrix has depth 0, if its z is the depth itself.
  std::optional<double> matrix_near;
  // The same at depth -1, where OpenGL's begins, and 1; none where the matrix is reversed or orthographic.
  std::optional<double> matrix_near_opengl, matrix_far;
  DepthKind depth_kind = DepthKind::automatic;  // of the frame, as its source says; automatic: it does not
  NormalSpace normal_space = NormalSpace::automatic;
  NormalEncoding normal_encoding = NormalEncoding::automatic;
  std::optional<Vector3> chan_angles;  // of a .chan file about x, y and z, radians, which --chan-rotation puts in order
};

/// The options that give a camera: any; or one that turns the normals of a world.
inline constexpr const char* kCameraOptions =
    "--camera FILE.json, or --fov DEGREES (--vertical-fov), or --focal-px PIXELS, or --focal MM with --aperture MM, or "
    "--ortho-width UNITS";
inline constexpr const char* kWorldCameraOptions =
    "--camera FILE.json with world_to_camera, for normals in world space; or --fov DEGREES (--vertical-fov), "
    "or --focal-px PIXELS, or --focal MM with --aperture MM, or --ortho-width UNITS, each with --normal none";

/// ErrorKind::usage: nothing gives a camera to the frame of this file. `why` says why the header or the positions do
/// not.
struct NoCamera : Error {
  explicit NoCamera(const std::string& file, const std::string& why = "");
  const std::string why;
};

/// A perspective camera whose optical axis is in the middle. A pixel that is `pixel_aspect` times as wide as high
/// covers that much more in x.
Camera centred(const Window& display, double fx, double pixel_aspect);

/// Reads a camera JSON file; docs/inputs.md lists its keys. Takes the entry of `frame` if the file lists `frames`, and
/// that of `view` if it has `views`; "" takes the fields that all views share. Fails with ErrorKind::input on missing
/// or senseless fields, and names file and field.
Camera read_camera(const std::string& path, int frame, const std::string& view = "");

/// Gives the camera in the text of a camera file for a frame of this display window; `name` is for messages. Fails as
/// read_camera() does, and where it does not fit.
Camera camera_of(const std::string& text, const std::string& name, const Window& display, int frame);

/// Whether a camera file lists `frames`. Fails with ErrorKind::input where it cannot be read.
bool lists_frames(const std::string& path);

/// Fails with ErrorKind::input if a camera file lists `frames` and none of them has this number. Does not check the
/// entry, since its fields may be per view.
void require_listed(const std::string& path, int frame);

/// Whether the settings give a camera, or at least try to.
inline bool names_a_camera(const InputSettings& settings) {
  return !settings.camera.empty() || settings.fov || settings.vertical_fov || settings.focal_px || settings.focal ||
         settings.ortho_width;
}

/// Gives the camera of the settings for a frame of this display window and pixel aspect (width / height of a pixel): by
/// its file, by fov or vertical_fov, by focal and aperture, or by ortho_width. Fails with NoCamera if there is none,
/// and with ErrorKind::input if it does not fit.
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

/// A place in a view, px, and the planar depth there.
struct SeenAt {
  double x, y, depth;
};
/// Gives the place, in another view, of a point that one view shows at (x, y) and a planar depth.
SeenAt seen_from(const View& other, const ViewMap& other_from_view, const View& view, double x, double y, double depth);

/// The length of a pixel's ray at unit depth; 1 where it is orthographic.
double ray_length(const View& view, int x, int y);

// .chan files, which Nuke, Maya, Houdini and Blender write.

/// Whether a file is one by its name.
bool is_chan_file(const std::string& path);

/// Reads a .chan file: a line for each frame, of its number, the place x y z, the angles x y z in degrees and the
/// vertical field of view in degrees. `rotation`: the axes in the order in which
/// the angles turn the camera, such as zxy (Nuke's). The camera looks along -z, with y up; its projection is centred on
/// the display window. Fails with ErrorKind::input, and names file, frame and fault.
Camera read_chan(const std::string& path, int frame, const std::string& rotation, const Window& display,
                 double pixel_aspect);

/// The rotation from the world to a camera's space, of angles about x, y and z in radians.
Matrix3 view_by_angles(const Vector3& angles, const std::string& rotation);

/// The orders in which a camera may be turned about the axes.
inline constexpr std::array kChanRotations{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};

// Cameras that renderers write into the headers of their frames.

struct HeaderCamera {
  Camera camera;     // for the display window
  std::string from;  // the attributes that gave it
};

/// Attributes by name, as ExrFile::attribute_texts() gives them.
using AttributeTexts = std::map<std::string, std::string>;

/// Gives the camera of the attributes; none if they lack a field of view. They are tried in this order:
/// - worldToCamera and worldToNDC (Arnold, RenderMan, Mantra, pbrt) or worldToScreen (Arnold of 3ds Max), for row or
///   column vectors, NDC from 0 or from -1, y up or down, with lens shift, perspective or orthographic; a worldToNDC
///   that does no more than worldToCamera (Karma) is none;
/// - CameraFov, or CameraFocalLength and CameraFilmApertureHorizontal (Arnold), and worldToCamera if there is one;
/// - rs/camera/transform, fov (Redshift);
/// - unreal/.../fov, which includes the overscan, of the depth's pass and camera, and its curPos and curRot;
/// - cameraTransform, cameraFov (V-Ray);
/// - screenWindowWidth and screenWindowCenter, where they are not left at 1 and 0, or pinholeFocalLength or
///   nominalFocalLength with sensorOverallDimensions (the standard attributes), and worldToCamera if there is one.
/// Prefixes that Nuke puts before others' attributes (nuke/, exr/) do not matter. Numbers that make no camera are
/// ignored. `depth_layer` is the layer of the depth's channel, whose name tells its pass and camera in Unreal's files.
std::optional<HeaderCamera> header_camera(const AttributeTexts& attributes, const Window& display, const Window& data,
                                          double pixel_aspect, const std::string& depth_layer);

/// Says why header_camera() finds none in attributes that look as if they had one; "" if they do not look so.
std::string why_no_header_camera(const AttributeTexts& attributes, const std::string& depth_layer);

/// Places a camera with a projection from elsewhere, such as --fov, by the header's
/// worldToCamera, rs/camera/transform, curPos and curRot of unreal/, or cameraTransform. A worldToCamera without a
/// projection looks along +z if it mirrors the world, as the standard's does, and else along -z. Without any of these
/// the camera stays as it is.
void place_by_header(Camera& camera, const AttributeTexts& attributes, const Window& display, double pixel_aspect,
                     const std::string& depth_layer);

/// Fails with ErrorKind::input where the attributes say that the picture is no planar projection: envmap, V-Ray's
/// cameraProjection.
void require_no_panorama(const AttributeTexts& attributes, const std::string& path);

/// Fails with ErrorKind::input: the file holds a panorama, as `by` says.
[[noreturn]] void refuse_panorama(const std::string& path, const std::string& by);

}  // namespace alcove
