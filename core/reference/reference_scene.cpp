// Depth, normals and camera of a frame, in double.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference_scene.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/reference/reference_layers.h"

namespace alcove {

double length(Vector a) { return std::sqrt(dot(a, a)); }
Vector normalized(Vector a) { return (1 / length(a)) * a; }

ReferenceScene::ReferenceScene(const HostFrame& frame, int hidden, double separation)
    : frame_(frame), camera_(frame.camera) {
  if (frame.depth_kind != DepthKind::planar || frame.depth.size() != frame.data.pixels() ||
      frame.normal.size() != 3 * frame.data.pixels())
    fail(ErrorKind::input, "the reference takes planar depth and normals for every pixel of {}", to_string(frame.data));
  center_x_ = camera_.cx + frame.display.x - frame.data.x;
  center_y_ = camera_.cy + frame.display.y - frame.data.y;
  // A pixel cannot hide more than was found of it.
  hidden = std::min(hidden, int(frame.behind.size()));
  if (hidden == 0) return;
  ReferenceLayers layers = reference_layers(*this, frame, hidden, separation);
  surfaces_ = 1 + hidden;
  lists_all_ = layers.lists_all;
  hidden_ = std::move(layers.planes);
}

double ReferenceScene::depth(int x, int y, int surface) const {
  if (surface == 0) return depth(x, y);
  return std::abs(double(hidden_[std::size_t(surface - 1) * frame_.data.pixels() + index(x, y)]));
}

bool ReferenceScene::closes(int x, int y, int surface) const {
  return surface > 0 && hidden_[std::size_t(surface - 1) * frame_.data.pixels() + index(x, y)] < 0;
}

double ReferenceScene::depth(int x, int y) const {
  const double z = frame_.depth[index(x, y)];
  return std::isfinite(z) && z > 0 && z < frame_.sky ? z * frame_.depth_scale : 0;
}

Vector ReferenceScene::position(int x, int y, double z) const {
  const double u = (x + 0.5 - center_x_) / camera_.fx;
  const double v = -(y + 0.5 - center_y_) / camera_.fy;
  return orthographic() ? Vector{u, v, -z} : Vector{u * z, v * z, -z};
}

Vector ReferenceScene::across(double x_px, double y_px, double z) const {
  const double scale = orthographic() ? 1 : z;
  return {x_px / camera_.fx * scale, -y_px / camera_.fy * scale, 0};
}

Vector ReferenceScene::toward_eye(Vector position) const {
  return orthographic() ? Vector{0, 0, 1} : normalized(-1 * position);
}

std::pair<double, double> ReferenceScene::image_of(Vector position) const {
  const double z = orthographic() ? 1 : -position.z;
  return {center_x_ + camera_.fx * position.x / z, center_y_ - camera_.fy * position.y / z};
}

double ReferenceScene::affine_depth(int x, int y) const {
  const double z = inside(x, y) ? depth(x, y) : 0;
  return z == 0 ? -1 : orthographic() ? z : 1 / z;
}

Vector ReferenceScene::tangent_along(int x, int y, int dx, int dy) const {
  // As reconstruct.comp has it, with its constants.
  constexpr double kNearness = 0.1, kSameSurface = 4, kRounding = 1e-6, kOneSurface = 0.01, kNone = 1e30;
  const double here = affine_depth(x, y);
  const Vector at = position(x, y, depth(x, y));
  Vector tangent, other;
  double least = kNone, step = 0, other_step = kNone;
  for (const int side : {-1, 1}) {
    const int i = x + side * dx, j = y + side * dy;
    const double one = affine_depth(i, j), two = affine_depth(i + side * dx, j + side * dy);
    if (one <= 0) continue;
    const double change = side * (one - here);
    const double error = (two > 0 ? std::abs(2 * one - two - here) : std::abs(change)) + kNearness * std::abs(change);
    const Vector along = side * (position(i, j, depth(i, j)) - at);
    if (error < least) {
      other = tangent;
      other_step = least < kNone ? step : kNone;
      tangent = along;
      step = change;
      least = error;
    } else {
      other = along;
      other_step = change;
    }
  }
  const bool is_same = std::abs(step - other_step) <= kSameSurface * least + kRounding * here &&
                       std::max(std::abs(step), std::abs(other_step)) < kOneSurface * here;
  return is_same ? tangent + other : tangent;
}

Vector ReferenceScene::normal_from_depth(int x, int y, Vector eye) const {
  const Vector right = tangent_along(x, y, 1, 0), down = tangent_along(x, y, 0, 1), only = right + down;
  Vector n = cross(down, right);
  if (dot(n, n) == 0 && dot(only, only) > 0) n = eye - (dot(eye, only) / dot(only, only)) * only;
  if (!(dot(n, n) > 0)) return eye;
  return normalized(dot(n, eye) < 0 ? -1 * n : n);
}

Vector ReferenceScene::normal(int x, int y, Vector eye) const {
  const std::size_t plane = frame_.data.pixels();
  const std::size_t i = index(x, y);
  Vector n = {frame_.normal[i], frame_.normal[i + plane], frame_.normal[i + 2 * plane]};
  if (frame_.normal_space == NormalSpace::world) {
    const auto& m = *camera_.view_from_world;
    n = {m[0][0] * n.x + m[0][1] * n.y + m[0][2] * n.z, m[1][0] * n.x + m[1][1] * n.y + m[1][2] * n.z,
         m[2][0] * n.x + m[2][1] * n.y + m[2][2] * n.z};
  }
  n = length(n) > 0 ? normalized(n) : eye;
  // As reconstruct.comp does, with the thresholds of normal.glsl.
  constexpr double kOpposite = -0.5, kLeastFacing = 1e-3;
  if (dot(n, eye) < -kLeastFacing && dot(n, eye) + dot(n, normal_from_depth(x, y, eye)) < kOpposite) n = -1 * n;
  return dot(n, eye) < kLeastFacing ? normalized(n + (kLeastFacing - dot(n, eye)) * eye) : n;
}

}  // namespace alcove
