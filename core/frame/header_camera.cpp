// Turns matrices and numbers of headers into the one projection model.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/header_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "core/base/error.h"

namespace alcove {
namespace {

using Matrix4 = std::array<std::array<double, 4>, 4>;  // rows, for column vectors

constexpr double kRadian = std::numbers::pi / 180;
constexpr double kWidest = 180;     // degrees: no plane shows a field of view as wide
constexpr double kFarthest = 1e29;  // scene units: programs write 1e30 where there is no far plane

/// Attributes by their names without Nuke's prefixes.
struct Attributes {
  AttributeTexts texts;

  explicit Attributes(const AttributeTexts& all) {
    for (const auto& [name, text] : all) {
      std::string plain = name;
      for (const std::string prefix : {"nuke/", "exr/"})
        if (plain.starts_with(prefix)) plain.erase(0, prefix.size());
      texts.try_emplace(plain, text);
    }
  }

  /// Gives the finite numbers of an attribute; none unless there are exactly `count`.
  std::vector<double> numbers(const std::string& name, std::size_t count) const {
    const auto found = texts.find(name);
    if (found == texts.end() || found->second.size() > 2000) return {};
    std::vector<double> values;
    const char* at = found->second.c_str();
    for (char* end = nullptr; values.size() <= count; at = end) {
      const double value = std::strtod(at, &end);
      if (end == at) break;
      if (!std::isfinite(value)) return {};
      values.push_back(value);
    }
    while (*at == ' ') at++;
    return values.size() == count && !*at ? values : std::vector<double>{};
  }

  std::optional<double> number(const std::string& name) const {
    const auto values = numbers(name, 1);
    return values.empty() ? std::nullopt : std::optional(values[0]);
  }

  std::optional<double> positive(const std::string& name, double below = 1e12) const {
    const auto value = number(name);
    return value && *value > 0 && *value < below ? value : std::nullopt;
  }
};

/// A rigid map: to = rotation * from + offset. The rotation may mirror.
struct Placement {
  Matrix3 rotation;
  Vector3 offset;
  bool row_vectors;  // as it was stored
};

enum class To { camera, world };

/// Reads a rigid 4 x 4 matrix in either layout. The place of the translation tells the layout; without a translation it
/// is the standard's, for row vectors. A uniform scale is the camera's own and is divided out.
std::optional<Placement> placement(const std::vector<double>& m, To to) {
  if (m.size() != 16) return std::nullopt;
  const auto ends = [&](std::size_t first, std::size_t step) {
    const double w = m[15];
    return w != 0 && std::abs(m[first] / w) < 1e-6 && std::abs(m[first + step] / w) < 1e-6 &&
           std::abs(m[first + 2 * step] / w) < 1e-6;
  };
  const bool row_vectors = ends(3, 4);
  if (!row_vectors && !ends(12, 1)) return std::nullopt;
  Placement p{};
  p.row_vectors = row_vectors;
  for (std::size_t row = 0; row < 3; row++) {
    for (std::size_t column = 0; column < 3; column++)
      p.rotation[row][column] = row_vectors ? m[4 * column + row] : m[4 * row + column];
    p.offset[row] = row_vectors ? m[12 + row] : m[4 * row + 3];
  }
  const double squared = dot(p.rotation[0], p.rotation[0]);
  constexpr double kTolerance = 1e-3;
  for (std::size_t a = 0; a < 3; a++)
    for (std::size_t b = 0; b < 3; b++)
      if (!(squared > 0) || !(std::abs(dot(p.rotation[a], p.rotation[b]) / squared - (a == b)) < kTolerance))
        return std::nullopt;
  for (std::size_t row = 0; row < 3; row++) {
    for (double& x : p.rotation[row]) x /= std::sqrt(squared);
    if (to == To::camera) p.offset[row] /= std::sqrt(squared);
  }
  return p;
}

Placement inverted(const Placement& p) {
  Placement inverse{transposed(p.rotation), {}, p.row_vectors};
  for (std::size_t row = 0; row < 3; row++) inverse.offset[row] = -dot(inverse.rotation[row], p.offset);
  return inverse;
}

/// Where a header says that its camera stands.
struct Pose {
  Placement view;  // camera space from the world
  bool looks_along_z;
  const char* from;  // the attribute
};

/// Puts the camera there, in a camera space that looks along -z.
void place(Camera& camera, Pose pose) {
  camera.left_handed = pose.looks_along_z;
  if (pose.looks_along_z) {
    for (double& x : pose.view.rotation[2]) x = -x;
    pose.view.offset[2] = -pose.view.offset[2];
  }
  camera.view_from_world = pose.view.rotation;
  camera.view_from_world_offset = pose.view.offset;
}

/// The matrix without its projection. The standard's camera space is left-handed and looks along +z, which mirrors a
/// right-handed world, as renderers' worlds are; programs whose camera space is right-handed look along -z.
std::optional<Pose> standard_pose(const Attributes& a) {
  const auto view = placement(a.numbers("worldToCamera", 16), To::camera);
  if (!view) return std::nullopt;
  return Pose{*view, determinant(view->rotation) < 0, "worldToCamera"};
}

std::optional<Pose> redshift_pose(const Attributes& a) {
  const auto world = placement(a.numbers("rs/camera/transform", 16), To::world);
  if (!world) return std::nullopt;
  return Pose{inverted(*world), true, "rs/camera/transform"};
}

std::optional<Pose> vray_pose(const Attributes& a) {
  const auto world = placement(a.numbers("cameraTransform", 16), To::world);
  if (!world) return std::nullopt;
  return Pose{inverted(*world), false, "cameraTransform"};
}

/// Angles of a left-handed world with z up, x forward and y right: yaw turns x to y, pitch raises, roll lowers the
/// right side.
std::optional<Pose> unreal_pose(const Attributes& a) {
  const auto x = a.number("unreal/camera/curPos/x");
  const auto y = a.number("unreal/camera/curPos/y");
  const auto z = a.number("unreal/camera/curPos/z");
  const auto yaw = a.number("unreal/camera/curRot/yaw");
  const auto pitch = a.number("unreal/camera/curRot/pitch");
  const auto roll = a.number("unreal/camera/curRot/roll");
  if (!x || !y || !z || !yaw || !pitch || !roll) return std::nullopt;
  const double cos_yaw = std::cos(*yaw * kRadian), sin_yaw = std::sin(*yaw * kRadian);
  const double cos_pitch = std::cos(*pitch * kRadian), sin_pitch = std::sin(*pitch * kRadian);
  const double cos_roll = std::cos(*roll * kRadian), sin_roll = std::sin(*roll * kRadian);
  const Vector3 forward{cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch};
  const Vector3 level{-sin_yaw, cos_yaw, 0};
  const Vector3 above{-sin_pitch * cos_yaw, -sin_pitch * sin_yaw, cos_pitch};
  Placement view{};
  for (std::size_t i = 0; i < 3; i++) {
    view.rotation[0][i] = cos_roll * level[i] - sin_roll * above[i];
    view.rotation[1][i] = sin_roll * level[i] + cos_roll * above[i];
    view.rotation[2][i] = -forward[i];
  }
  for (std::size_t row = 0; row < 3; row++) view.offset[row] = -dot(view.rotation[row], {*x, *y, *z});
  return Pose{view, false, "unreal/camera"};
}

double focal_px(double width, double fov_degrees) { return 0.5 * width / std::tan(0.5 * fov_degrees * kRadian); }

/// One row of the projection: image coordinate * w = along * x + shift * depth (perspective), or along * x + shift
/// (orthographic).
struct Axis {
  double along, shift;
};

/// Finds the projection from what worldToNDC does to points of camera space.
std::optional<Camera> projected(const Placement& view, const std::vector<double>& values, const Window& display) {
  if (values.size() != 16) return std::nullopt;
  Matrix4 ndc{};
  for (std::size_t row = 0; row < 4; row++)
    for (std::size_t column = 0; column < 4; column++)
      ndc[row][column] = view.row_vectors ? values[4 * column + row] : values[4 * row + column];
  const Placement world = inverted(view);
  Matrix4 p{};  // NDC from camera space
  for (std::size_t row = 0; row < 4; row++) {
    const Vector3 of_world{ndc[row][0], ndc[row][1], ndc[row][2]};
    for (std::size_t column = 0; column < 3; column++)
      p[row][column] = dot(of_world, transposed(world.rotation)[column]);
    p[row][3] = dot(of_world, world.offset) + ndc[row][3];
  }
  Camera camera;
  camera.width = display.width;
  camera.height = display.height;
  const double depth_scale = p[3][2];
  const double largest = std::max({std::abs(p[3][0]), std::abs(p[3][1]), std::abs(p[3][2])});
  camera.orthographic = largest < 1e-6 * std::abs(p[3][3]);
  const bool looks_along_z = camera.orthographic ? p[2][2] / p[3][3] > 0 : depth_scale > 0;
  const auto axis = [&](std::size_t row) {
    return camera.orthographic ? Axis{p[row][row] / p[3][3], p[row][3] / p[3][3]}
                               : Axis{p[row][row] / std::abs(depth_scale), p[row][2] / depth_scale};
  };
  const Axis x = axis(0), y = axis(1);
  if (!(x.along != 0) || !(y.along != 0) || !std::isfinite(x.along + x.shift + y.along + y.shift)) return std::nullopt;
  // The optical axis is near the middle of the picture: 0.5 where NDC begin at 0, 0 where they begin at -1.
  const bool from_zero = std::hypot(x.shift - 0.5, y.shift - 0.5) < std::hypot(x.shift, y.shift);
  const double scale = from_zero ? 1 : 0.5, origin = from_zero ? 0 : 1;
  camera.fx = std::abs(x.along) * scale * display.width;
  camera.fy = std::abs(y.along) * scale * display.height;
  camera.cx = (x.shift + origin) * scale * display.width;
  const double down = (y.shift + origin) * scale;  // from the side that y counts from
  camera.cy = (y.along < 0 ? down : 1 - down) * display.height;
  place(camera, {view, looks_along_z, ""});
  return camera;
}

std::optional<HeaderCamera> by_matrices(const Attributes& a, const Window& display) {
  const auto view = placement(a.numbers("worldToCamera", 16), To::camera);
  if (!view) return std::nullopt;
  auto camera = projected(*view, a.numbers("worldToNDC", 16), display);
  if (!camera) return std::nullopt;
  camera->near = a.positive("arnold/camera/near_clip");
  camera->far = a.positive("arnold/camera/far_clip", kFarthest);
  return HeaderCamera{*camera, "worldToCamera, worldToNDC"};
}

std::optional<HeaderCamera> by_redshift(const Attributes& a, const Window& display, double pixel_aspect) {
  const auto fov = a.positive("rs/camera/fov", kWidest);
  if (!fov) return std::nullopt;
  Camera camera = centred(display, focal_px(display.width, *fov), pixel_aspect);
  if (const auto pose = redshift_pose(a)) place(camera, *pose);
  camera.near = a.positive("rs/camera/nearPlane");
  camera.far = a.positive("rs/camera/farPlane");
  return HeaderCamera{camera, "rs/camera"};
}

std::optional<HeaderCamera> by_unreal(const Attributes& a, const Window& display, const Window& data,
                                      double pixel_aspect) {
  std::optional<double> fov = a.positive("unreal/camera/FinalImage/fov", kWidest);
  if (!fov) fov = a.positive("unreal/camera/fov", kWidest);
  if (!fov) return std::nullopt;
  Camera camera = centred(display, focal_px(std::max(data.width, display.width), *fov), pixel_aspect);
  if (const auto pose = unreal_pose(a)) place(camera, *pose);
  return HeaderCamera{camera, "unreal/camera"};
}

std::optional<HeaderCamera> by_vray(const Attributes& a, const Window& display, double pixel_aspect) {
  const auto fov = a.positive("cameraFov", kWidest);
  if (!fov) return std::nullopt;
  Camera camera = centred(display, focal_px(display.width, *fov), pixel_aspect);
  if (const auto pose = vray_pose(a)) place(camera, *pose);
  camera.near = a.positive("cameraNearClip");
  camera.far = a.positive("cameraFarClip", kFarthest);
  return HeaderCamera{camera, "cameraTransform, cameraFov"};
}

std::optional<HeaderCamera> by_standard(const Attributes& a, const Window& display, double pixel_aspect) {
  std::optional<HeaderCamera> found;
  const auto sensor = a.numbers("sensorOverallDimensions", 2);
  auto focal = a.positive("pinholeFocalLength");
  if (!focal) focal = a.positive("nominalFocalLength");
  const auto width = a.positive("screenWindowWidth");
  auto center = a.numbers("screenWindowCenter", 2);
  if (center.empty()) center = {0, 0};
  if (width && (*width != 1 || center[0] != 0 || center[1] != 0)) {
    found = {centred(display, display.width / *width, pixel_aspect), "screenWindowWidth, screenWindowCenter"};
    found->camera.cx -= center[0] * found->camera.fx;
    found->camera.cy += center[1] * found->camera.fy;
  } else if (focal && !sensor.empty() && sensor[0] > 0) {
    found = {centred(display, display.width * *focal / sensor[0], pixel_aspect),
             "focal length, sensorOverallDimensions"};
  }
  if (const auto pose = standard_pose(a); found && pose) place(found->camera, *pose);
  return found;
}

}  // namespace

std::optional<HeaderCamera> header_camera(const AttributeTexts& attributes, const Window& display, const Window& data,
                                          double pixel_aspect) {
  const Attributes a(attributes);
  auto found = by_matrices(a, display);
  if (!found) found = by_redshift(a, display, pixel_aspect);
  if (!found) found = by_unreal(a, display, data, pixel_aspect);
  if (!found) found = by_vray(a, display, pixel_aspect);
  if (!found) found = by_standard(a, display, pixel_aspect);
  // A comparison with NaN is false.
  const auto fine = [](double scale, double center) { return scale > 1e-6 && scale < 1e12 && std::abs(center) < 1e9; };
  return found && fine(found->camera.fx, found->camera.cx) && fine(found->camera.fy, found->camera.cy) ? found
                                                                                                       : std::nullopt;
}

void place_by_header(Camera& camera, const AttributeTexts& attributes, const Window& display) {
  const Attributes a(attributes);
  // With its projection, the matrix tells by itself which way the camera looks.
  if (const auto whole = by_matrices(a, display)) {
    camera.view_from_world = whole->camera.view_from_world;
    camera.view_from_world_offset = whole->camera.view_from_world_offset;
    camera.left_handed = whole->camera.left_handed;
    camera.placement_from = "worldToCamera";
    return;
  }
  for (const auto& pose_of : {redshift_pose, unreal_pose, vray_pose, standard_pose})
    if (const auto pose = pose_of(a)) {
      place(camera, *pose);
      camera.placement_from = pose->from;
      return;
    }
}

void require_no_panorama(const AttributeTexts& attributes, const std::string& path) {
  const Attributes a(attributes);
  // V-Ray's: 1 to 6 are spherical, cylindrical, box, fish eye and warped
  const auto projection = a.number("cameraProjection");
  if (a.texts.contains("envmap") || (projection && *projection >= 1 && *projection <= 6))
    fail(ErrorKind::input,
         "{}: a panorama ({}): its pixels have no plane of projection, which depth and AO here refer to; render it "
         "with a perspective camera",
         path, a.texts.contains("envmap") ? "envmap" : "cameraProjection");
}

}  // namespace alcove
