// Turns matrices and numbers of headers into the one projection model.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>
#include <sstream>
#include <vector>

#include "core/base/error.h"
#include "core/base/text.h"

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
  double scale = 1;  // of the stored matrix, divided out
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
  const auto squared = squared_scale(p.rotation);
  if (!squared) return std::nullopt;
  p.scale = std::sqrt(*squared);
  for (std::size_t row = 0; row < 3; row++) {
    for (double& x : p.rotation[row]) x /= p.scale;
    if (to == To::camera) p.offset[row] /= p.scale;
  }
  return p;
}

Placement inverted(const Placement& p) {
  const Matrix3 back = transposed(p.rotation);
  return {back, scaled(times(back, p.offset), -1), p.row_vectors};
}

/// The place of a camera, as a header says it.
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

/// The place by an attribute that is the way from camera space to the world.
std::optional<Pose> pose_in_world(const Attributes& a, const char* name, bool looks_along_z) {
  const auto world = placement(a.numbers(name, 16), To::world);
  return world ? std::optional(Pose{inverted(*world), looks_along_z, name}) : std::nullopt;
}
std::optional<Pose> redshift_pose(const Attributes& a) { return pose_in_world(a, "rs/camera/transform", true); }
std::optional<Pose> vray_pose(const Attributes& a) { return pose_in_world(a, "cameraTransform", false); }

/// Angles of a left-handed world with z up, x forward and y right: yaw turns x to y, pitch raises, roll lowers the
/// right side. `prefix` stands before the numbers' names.
std::optional<Pose> unreal_pose_at(const Attributes& a, const std::string& prefix) {
  const auto x = a.number(prefix + "/curPos/x");
  const auto y = a.number(prefix + "/curPos/y");
  const auto z = a.number(prefix + "/curPos/z");
  const auto yaw = a.number(prefix + "/curRot/yaw");
  const auto pitch = a.number(prefix + "/curRot/pitch");
  const auto roll = a.number(prefix + "/curRot/roll");
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

constexpr const char* kUnrealMain = "unreal/camera";  // the camera of a job that has no more than one

/// The lens of one pass and one camera: unreal/camera/PASS/fov, unreal/camera/PASS_CAMERA/fov, unreal/CAMERA/PASS/fov.
struct UnrealLens {
  std::string path;                // without /fov
  double fov;                      // degrees
  std::vector<std::string> parts;  // of the path behind unreal/, in lower case

  /// Whether a part is this camera's name, or ends in it behind a pass; of "": any camera's.
  bool is_of_camera(const std::string& name) const {
    if (name.empty()) return parts.front() != "camera" || parts.back().find('_') != std::string::npos;
    return std::ranges::any_of(parts, [&](const auto& part) { return part == name || part.ends_with("_" + name); });
  }
  /// The camera's name, for one of any camera.
  std::string camera_name() const {
    return parts.front() != "camera" ? parts.front() : parts.back().substr(parts.back().find('_') + 1);
  }
  /// Whether a part, without its camera, begins the name of a layer.
  bool is_of_pass(const std::string& layer, const std::string& camera) const {
    return std::ranges::any_of(parts, [&](std::string part) {
      if (!camera.empty() && part.ends_with("_" + camera)) part.resize(part.size() - camera.size() - 1);
      return !part.empty() && layer.starts_with(part);
    });
  }
};

UnrealLens unreal_lens(const std::string& path, double fov) {
  UnrealLens lens{path, fov, {}};
  std::istringstream parts(lower_case(path.substr(path.find('/') + 1)));
  for (std::string part; std::getline(parts, part, '/');) lens.parts.push_back(part);
  return lens;
}

bool differ(const std::vector<UnrealLens>& lenses) {
  const auto [least, most] = std::ranges::minmax(lenses, {}, &UnrealLens::fov);
  return most.fov - least.fov > 1e-3;
}

/// The lenses of a header, and of them those that may be the depth's: of its camera, by the end of its layer's name,
/// and of its pass, by the name's beginning. They are one lens unless they differ.
struct UnrealLenses {
  std::vector<UnrealLens> all, of_depth;
};

UnrealLenses unreal_lenses(const Attributes& a, const std::string& depth_layer) {
  UnrealLenses lenses;
  for (const auto& [name, text] : a.texts)
    if (name.starts_with("unreal/") && name.ends_with("/fov") && name != "unreal/camera/fov")
      if (const auto fov = a.positive(name, kWidest))
        lenses.all.push_back(unreal_lens(name.substr(0, name.size() - 4), *fov));
  if (const auto fov = a.positive("unreal/camera/fov", kWidest); fov && lenses.all.empty())
    lenses.all.push_back(unreal_lens(kUnrealMain, *fov));
  const auto those = [](const std::vector<UnrealLens>& from, const auto& is_meant) {
    std::vector<UnrealLens> found;
    std::ranges::copy_if(from, std::back_inserter(found), is_meant);
    return found;
  };
  const std::string layer = lower_case(depth_layer), mark = "worlddepth_";
  const std::size_t at = layer.rfind(mark);
  const std::string camera = at == layer.npos ? "" : layer.substr(at + mark.size());
  lenses.of_depth = lenses.all;
  if (!camera.empty()) {
    lenses.of_depth = those(lenses.all, [&](const auto& lens) { return lens.is_of_camera(camera); });
    if (lenses.of_depth.empty())
      lenses.of_depth = those(lenses.all, [](const auto& lens) { return !lens.is_of_camera(""); });
  }
  if (auto of_pass = those(lenses.of_depth, [&](const auto& lens) { return lens.is_of_pass(layer, camera); });
      !of_pass.empty())
    lenses.of_depth = std::move(of_pass);
  return lenses;
}

/// The place beside the depth's lens, or that of the only camera: several cannot all stand there.
std::optional<Pose> unreal_pose(const Attributes& a, const std::string& depth_layer) {
  const auto [all, of_depth] = unreal_lenses(a, depth_layer);
  if (!of_depth.empty())
    if (const auto pose = unreal_pose_at(a, of_depth.front().path)) return pose;
  std::set<std::string> cameras;
  for (const auto& lens : all)
    if (lens.is_of_camera("")) cameras.insert(lens.camera_name());
  return cameras.size() > 1 ? std::nullopt : unreal_pose_at(a, kUnrealMain);
}

double focal_px(double width, double fov_degrees) { return 0.5 * width / std::tan(0.5 * fov_degrees * kRadian); }

/// A row of the projection: image coordinate * w = along * x + shift * depth (perspective), or along * x + shift
/// (orthographic).
struct Axis {
  double along, shift;
};

/// Finds the projection from the images of points of camera space under worldToNDC.
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

/// Whether a matrix that should project only moves, turns and scales, as Karma's worldToNDC does, which is its
/// worldToCamera. A projection that keeps shapes would be orthographic, of another scale, and of a picture as wide as
/// high.
bool is_no_projection(const Placement& view, const std::vector<double>& values, const Window& display,
                      double pixel_aspect) {
  constexpr double kSame = 1e-3, kSameShape = 0.01;
  const auto moved = placement(values, To::camera);
  if (!moved) return false;
  return std::abs(moved->scale / view.scale - 1) < kSame ||
         !(std::abs(display.width * pixel_aspect / display.height - 1) < kSameShape);
}

std::optional<HeaderCamera> by_matrices(const Attributes& a, const Window& display, double pixel_aspect) {
  const auto view = placement(a.numbers("worldToCamera", 16), To::camera);
  if (!view) return std::nullopt;
  for (const std::string name : {"worldToNDC", "worldToScreen"}) {
    const auto values = a.numbers(name, 16);
    if (is_no_projection(*view, values, display, pixel_aspect)) continue;
    auto camera = projected(*view, values, display);
    if (!camera) continue;
    camera->near = a.positive("arnold/camera/near_clip");
    camera->far = a.positive("arnold/camera/far_clip", kFarthest);
    return HeaderCamera{*camera, "worldToCamera, " + name};
  }
  return std::nullopt;
}

/// Arnold's plain numbers, which stand beside its matrices. The field of view is the horizontal one.
std::optional<HeaderCamera> by_arnold(const Attributes& a, const Window& display, double pixel_aspect) {
  const auto fov = a.positive("CameraFov", kWidest);
  const auto focal = a.positive("CameraFocalLength"), aperture = a.positive("CameraFilmApertureHorizontal");
  if (!fov && !(focal && aperture)) return std::nullopt;
  const double focal_length = fov ? focal_px(display.width, *fov) : display.width * *focal / *aperture;
  Camera camera = centred(display, focal_length, pixel_aspect);
  if (const auto pose = standard_pose(a)) place(camera, *pose);
  return HeaderCamera{camera, fov ? "CameraFov" : "CameraFocalLength, CameraFilmApertureHorizontal"};
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
                                      double pixel_aspect, const std::string& depth_layer) {
  const auto lenses = unreal_lenses(a, depth_layer).of_depth;
  if (lenses.empty() || differ(lenses)) return std::nullopt;
  const double width = std::max(data.width, display.width);
  Camera camera = centred(display, focal_px(width, lenses.front().fov), pixel_aspect);
  if (const auto pose = unreal_pose(a, depth_layer)) place(camera, *pose);
  return HeaderCamera{camera, lenses.front().path};
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
                                          double pixel_aspect, const std::string& depth_layer) {
  const Attributes a(attributes);
  auto found = by_matrices(a, display, pixel_aspect);
  if (!found) found = by_arnold(a, display, pixel_aspect);
  if (!found) found = by_redshift(a, display, pixel_aspect);
  if (!found) found = by_unreal(a, display, data, pixel_aspect, depth_layer);
  if (!found) found = by_vray(a, display, pixel_aspect);
  if (!found) found = by_standard(a, display, pixel_aspect);
  // A comparison with NaN is false.
  const auto fine = [](double scale, double center) { return scale > 1e-6 && scale < 1e12 && std::abs(center) < 1e9; };
  return found && fine(found->camera.fx, found->camera.cx) && fine(found->camera.fy, found->camera.cy) ? found
                                                                                                       : std::nullopt;
}

std::string why_no_header_camera(const AttributeTexts& attributes, const std::string& depth_layer) {
  const Attributes a(attributes);
  if (const auto [lenses, of_depth] = unreal_lenses(a, depth_layer); !lenses.empty()) {
    std::vector<std::string> named;
    for (const auto& lens : lenses) named.push_back(fmt::format("{}/fov of {:.5g} degrees", lens.path, lens.fov));
    return fmt::format("its header has the lenses {}, and does not say which belongs to the depth {}", list_of(named),
                       depth_layer);
  }
  if (placement(a.numbers("worldToCamera", 16), To::camera) && placement(a.numbers("worldToNDC", 16), To::camera))
    return "the worldToNDC of its header is no projection: like worldToCamera it gives the camera's place, and no lens";
  return "";
}

void place_by_header(Camera& camera, const AttributeTexts& attributes, const Window& display, double pixel_aspect,
                     const std::string& depth_layer) {
  const Attributes a(attributes);
  // With its projection, the matrix tells by itself which way the camera looks.
  if (const auto whole = by_matrices(a, display, pixel_aspect)) {
    camera.view_from_world = whole->camera.view_from_world;
    camera.view_from_world_offset = whole->camera.view_from_world_offset;
    camera.left_handed = whole->camera.left_handed;
    camera.placement_from = "worldToCamera";
    return;
  }
  for (const auto& pose : {redshift_pose(a), unreal_pose(a, depth_layer), vray_pose(a), standard_pose(a)})
    if (pose) {
      place(camera, *pose);
      camera.placement_from = pose->from;
      return;
    }
}

void refuse_panorama(const std::string& path, const std::string& by) {
  fail(ErrorKind::input, "{}: a panorama ({}) has no plane of projection: render it with a perspective camera", path,
       by);
}

void require_no_panorama(const AttributeTexts& attributes, const std::string& path) {
  const Attributes a(attributes);
  // V-Ray's: 1 to 6 are spherical, cylindrical, box, fish eye and warped
  const auto projection = a.number("cameraProjection");
  if (a.texts.contains("envmap")) refuse_panorama(path, "envmap");
  if (projection && *projection >= 1 && *projection <= 6) refuse_panorama(path, "cameraProjection");
}

}  // namespace alcove
