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

Vector ReferenceScene::normal_by_depth(int x, int y, Vector eye) const {
  const Vector here = position(x, y, depth(x, y));
  const auto tangent = [&](int dx, int dy) {
    Vector nearer;
    for (const int side : {-1, 1}) {
      const int i = x + side * dx, j = y + side * dy;
      const double z = inside(i, j) ? depth(i, j) : 0;
      if (z == 0) continue;
      const Vector way = side * (position(i, j, z) - here);
      if (length(nearer) == 0 || length(way) < length(nearer)) nearer = way;
    }
    return nearer;
  };
  const Vector n = cross(tangent(0, 1), tangent(1, 0));
  return length(n) > 0 ? normalized(dot(n, eye) < 0 ? -1 * n : n) : eye;
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
  // As prepare.comp does, with the thresholds of normal.glsl.
  constexpr double kOpposite = -0.5, kLeastFacing = 1e-3;
  if (dot(n, eye) < 0 && dot(n, eye) + dot(n, normal_by_depth(x, y, eye)) < kOpposite) n = -1 * n;
  return dot(n, eye) < kLeastFacing ? normalized(n + (kLeastFacing - dot(n, eye)) * eye) : n;
}

}  // namespace alcove
