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
/// - worldToCamera and worldToNDC (Arnold, RenderMan, Karma, Mantra, pbrt), for row or column vectors, NDC from 0 or
///   from -1, y up or down, with lens shift, perspective or orthographic;
/// - rs/camera/transform, fov (Redshift);
/// - unreal/camera/curPos, curRot, FinalImage/fov, which includes the overscan;
/// - cameraTransform, cameraFov (V-Ray);
/// - screenWindowWidth and screenWindowCenter, where they are not left at 1 and 0, or pinholeFocalLength or
///   nominalFocalLength with sensorOverallDimensions (the standard attributes), and worldToCamera if there is one.
/// Prefixes that Nuke puts before others' attributes (nuke/, exr/) do not matter. Numbers that make no camera are
/// ignored.
std::optional<HeaderCamera> header_camera(const AttributeTexts& attributes, const Window& display, const Window& data,
                                          double pixel_aspect);

/// Places a camera whose projection came from elsewhere, such as --fov, by what the header says of its place:
/// worldToCamera, rs/camera/transform, unreal/camera/curPos and curRot, or cameraTransform. A worldToCamera without
/// worldToNDC looks along +z if it mirrors the world, as the standard's does, and else along -z. Without any of these
/// the camera stays as it is.
void place_by_header(Camera& camera, const AttributeTexts& attributes, const Window& display);

/// Fails with ErrorKind::input where the attributes say that the picture is no planar projection: envmap, V-Ray's
/// cameraProjection.
void require_no_panorama(const AttributeTexts& attributes, const std::string& path);

}  // namespace alcove
