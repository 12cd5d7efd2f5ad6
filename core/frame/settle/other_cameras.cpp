// Tries other cameras on the normals.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/normal_settlement.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace alcove {
namespace {

/// A principal point that far from the centre is no rounding. Part of the picture's width or height.
constexpr double kOffCentre = 0.02;

struct Hypothesis {
  std::string what;
  NormalPlanes planes;
};

/// The hypothesis that agrees best, where the frame can tell.
std::optional<OtherCamera> best_of(const std::vector<Hypothesis>& hypotheses, const NormalScore& as) {
  std::optional<OtherCamera> best;
  for (const auto& [what, planes] : hypotheses)
    if (const auto score = score_normals_as(as.space, as.flips, planes))
      if (!best || score->close > best->score.close) best = OtherCamera{what, *score};
  return best;
}

/// The same camera with the angles of its .chan file in another order.
std::vector<Hypothesis> other_rotations(const NormalPlanes& planes) {
  std::vector<Hypothesis> turned;
  for (const char* rotation : kChanRotations) {
    if (!planes.camera.chan_angles) break;
    turned.push_back({fmt::format("its angles fit in another order: give --chan-rotation {}", rotation), planes});
    turned.back().planes.camera.view_from_world = view_by_angles(*planes.camera.chan_angles, rotation);
  }
  return turned;
}

/// The same camera with its matrix replaced.
std::vector<Hypothesis> turned_worlds(const NormalPlanes& planes) {
  if (!planes.camera.view_from_world) return {};
  constexpr Matrix3 kOpenCv{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  constexpr Matrix3 kYUp{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
  const Matrix3 given = *planes.camera.view_from_world, inverse = transposed(given);
  std::vector<Hypothesis> turned;
  const auto add = [&](const std::string& what, const Matrix3& matrix) {
    turned.push_back({what, planes});
    turned.back().planes.camera.view_from_world = matrix;
  };
  add("its world_to_camera looks like camera_to_world: give the inverse", inverse);
  add("its world_to_camera looks like OpenCV's, with y down and z forward: negate its second and its third row",
      product(kOpenCv, given));
  add("its world_to_camera looks like OpenCV's camera_to_world, with y down and z forward: give the inverse, with its "
      "second and its third row negated",
      product(kOpenCv, inverse));
  for (const Matrix3& up : {kYUp, transposed(kYUp)})
    add("its world_to_camera seems to have another axis up than the normals (y, or z): give it for the world of the "
        "normals",
        product(given, up));
  std::ranges::move(other_rotations(planes), std::back_inserter(turned));
  return turned;
}

/// The same camera on a picture whose rows or columns run the other way.
std::vector<Hypothesis> turned_pictures(const NormalPlanes& planes) {
  NormalPlanes upside_down = planes, mirrored = planes;
  upside_down.view.center.y = float(planes.view.size.y) - planes.view.center.y;
  upside_down.view.tangent_per_pixel.y = -planes.view.tangent_per_pixel.y;
  mirrored.view.center.x = float(planes.view.size.x) - planes.view.center.x;
  mirrored.view.tangent_per_pixel.x = -planes.view.tangent_per_pixel.x;
  return {{"its rows seem to run from the bottom to the top: turn the picture upside down", upside_down},
          {"its columns seem to run from the right to the left: mirror the picture", mirrored}};
}

/// The rotation by which a turn, in radians about an axis, is undone.
Matrix3 turned_back(const Vector3& turn) {
  const double angle = length(turn);
  if (angle == 0) return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const Vector3 axis = scaled(turn, -1 / angle);
  const double s = std::sin(angle), c = std::cos(angle);
  Matrix3 rotation;
  for (std::size_t column = 0; column < 3; column++) {
    Vector3 unit{};
    unit[column] = 1;
    const Vector3 across = cross(axis, unit);
    for (std::size_t row = 0; row < 3; row++)
      rotation[row][column] = c * unit[row] + s * across[row] + (1 - c) * axis[row] * axis[column];
  }
  return rotation;
}

bool is_off(double centre, int size) { return std::abs(2 * centre - size) > 2 * kOffCentre * size; }

}  // namespace

bool is_off_centre(const Camera& camera) { return is_off(camera.cx, camera.width) || is_off(camera.cy, camera.height); }

std::optional<OtherCamera> best_turned_camera(const NormalPlanes& planes, const NormalScore& as) {
  std::vector<Hypothesis> hypotheses = turned_pictures(planes);
  if (as.space == NormalSpace::world) std::ranges::move(turned_worlds(planes), std::back_inserter(hypotheses));
  const auto best = best_of(hypotheses, as);
  return best && best->score.may_be_right() ? best : std::nullopt;
}

std::optional<OtherCamera> slightly_turned_camera(NormalPlanes planes, const NormalScore& as) {
  NormalScore turned = as;
  if (as.space == NormalSpace::view)
    planes.camera.view_from_world = view_from_normal(planes.camera, NormalSpace::view, {});
  // The turn is that of small ones: a second step leaves less than a hundredth of it.
  for (int step = 0; step < 2; step++) {
    planes.camera.view_from_world = product(turned_back(turned.turn), *planes.camera.view_from_world);
    const auto score = score_normals_as(NormalSpace::world, as.flips, planes);
    if (!score) return std::nullopt;
    turned = *score;
  }
  return OtherCamera{fmt::format("a camera that is turned by about {:.0f} degrees", as.turn_degrees()), turned};
}

std::optional<OtherCamera> best_other_rotation(const NormalPlanes& planes, const NormalScore& as) {
  if (as.space != NormalSpace::world) return std::nullopt;
  return best_of(other_rotations(planes), as);
}

std::optional<OtherCamera> best_other_point(const NormalPlanes& planes, const NormalScore& as) {
  const Camera& camera = planes.camera;
  const double x = camera.width - camera.cx, y = camera.height - camera.cy;
  const float by_x = float(x - camera.cx), by_y = float(y - camera.cy);
  const bool x_is_off = is_off(camera.cx, camera.width), y_is_off = is_off(camera.cy, camera.height);
  std::vector<Hypothesis> hypotheses;
  const auto add = [&](const std::string& what, float dx, float dy) {
    auto& center = hypotheses.emplace_back(Hypothesis{what, planes}).planes.view.center;
    center = {center.x + dx, center.y + dy};
  };
  const std::string mirrored = "its principal point looks mirrored: try ";
  if (x_is_off) add(fmt::format("{}\"cx\": {:.6g}", mirrored, x), by_x, 0);
  if (y_is_off) add(fmt::format("{}\"cy\": {:.6g}", mirrored, y), 0, by_y);
  if (x_is_off && y_is_off) add(fmt::format("{}\"cx\": {:.6g}, \"cy\": {:.6g}", mirrored, x, y), by_x, by_y);
  add(fmt::format("its principal point looks wrong: try \"cx\": {}, \"cy\": {}, the centre", 0.5 * camera.width,
                  0.5 * camera.height),
      0.5f * by_x, 0.5f * by_y);
  return best_of(hypotheses, as);
}

std::optional<NormalScore> square_pixels(NormalPlanes planes, const NormalScore& as) {
  auto& tangent = planes.view.tangent_per_pixel;
  tangent.y = std::copysign(tangent.x, tangent.y);
  return score_normals_as(as.space, as.flips, planes);
}

std::optional<OtherCamera> best_other_width(const NormalPlanes& planes, const NormalScore& as) {
  const Camera& camera = planes.camera;
  if (camera.orthographic) return std::nullopt;
  std::vector<Hypothesis> hypotheses;
  for (const double factor : {0.5, 0.7, 0.85, 1.2, 1.4, 2.0}) {
    const double degrees = 2 * std::atan(0.5 * camera.width / camera.fx / factor) * 180 / std::numbers::pi;
    hypotheses.push_back({fmt::format("a field of view of about {:.0f} degrees", degrees), planes});
    auto& tangent = hypotheses.back().planes.view.tangent_per_pixel;
    tangent = {float(tangent.x / factor), float(tangent.y / factor)};
  }
  return best_of(hypotheses, as);
}

}  // namespace alcove
