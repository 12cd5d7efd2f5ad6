// Marks by which camera files of other programs are known.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/foreign_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace alcove {
namespace {

struct ForeignCamera {
  std::array<std::string_view, 2> marks;  // texts that such a file has, both of them
  const char* what;
  const char* mend;
};

constexpr const char* kExport = "export the camera as a .chan file, or write a camera file in JSON";

constexpr ForeignCamera kForeignCameras[] = {
    {{"\"transform_matrix\"", ""},
     "a transforms.json of NeRF tools",
     "write a camera file with its fl_x and fl_y as \"fx\" and \"fy\" (fx = w / 2 / tan(camera_angle_x / 2)), cx, cy, "
     "the \"resolution\" [w, h], and as \"world_to_camera\" the inverse of the frame's transform_matrix"},
    {{"\"camera_angle_x\"", ""},
     "a transforms.json of NeRF tools",
     "write a camera file with \"fx\" = w / 2 / tan(camera_angle_x / 2)"},
    {{"\"intrinsic_matrix\"", ""},
     "camera parameters of Open3D",
     "write a camera file with fx, fy, cx and cy of its intrinsic_matrix, and as \"world_to_camera\" its extrinsic "
     "with the second and the third row negated"},
    {{"\"intrinsics\"", "\"poses\""}, "a scene of Meshroom (AliceVision)", kExport},
    {{"\"cameras\"", "\"shots\""}, "a reconstruction of OpenSfM", kExport},
    {{"\"asset\"", "\"cameras\""}, "a glTF scene", kExport},
    {{"# Camera list with one line", ""},
     "COLMAP's cameras.txt, which holds no places",
     "write a camera file with its parameters as fx, fy, cx and cy"},
    {{"# Image list with two lines", ""},
     "COLMAP's images.txt, which holds no lens",
     "write a camera file with a lens, and as \"world_to_camera\" the rotation and the translation with the second and "
     "the third row negated"},
    {{"Ogawa", "\xff"}, "an Alembic file", kExport},
    {{"Kaydara FBX Binary", ""}, "an FBX file", kExport},
    {{"FBXHeaderExtension", ""}, "an FBX file", kExport},
    {{"PXR-USDC", ""}, "a USD file", kExport},
    {{"#usda", ""}, "a USD file", kExport},
    {{"//Maya ASCII", ""}, "a Maya scene", kExport},
    {{"Camera", "inputs "}, "a Nuke script", kExport},
};

}  // namespace

std::string why_foreign_camera(const std::string& text) {
  if (text.find("\"fx\"") != text.npos) return "";
  const auto* found = std::ranges::find_if(kForeignCameras, [&](const ForeignCamera& camera) {
    return std::ranges::all_of(camera.marks, [&](std::string_view mark) { return text.find(mark) != text.npos; });
  });
  return found == std::end(kForeignCameras) ? "" : fmt::format("{}, no camera file: {}", found->what, found->mend);
}

}  // namespace alcove
