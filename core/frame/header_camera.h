// Cameras that renderers write into the headers of their frames.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/base/image.h"
#include "core/frame/camera.h"

namespace alcove {

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

/// Why header_camera() found none in attributes that look as if they had one; "" where they do not.
std::string why_no_header_camera(const AttributeTexts& attributes, const std::string& depth_layer);

/// Places a camera whose projection came from elsewhere, such as --fov, by what the header says of its place:
/// worldToCamera, rs/camera/transform, curPos and curRot of unreal/, or cameraTransform. A worldToCamera without a
/// projection looks along +z if it mirrors the world, as the standard's does, and else along -z. Without any of these
/// the camera stays as it is.
void place_by_header(Camera& camera, const AttributeTexts& attributes, const Window& display, double pixel_aspect,
                     const std::string& depth_layer);

/// Fails with ErrorKind::input where the attributes say that the picture is no planar projection: envmap, V-Ray's
/// cameraProjection.
void require_no_panorama(const AttributeTexts& attributes, const std::string& path);

}  // namespace alcove
