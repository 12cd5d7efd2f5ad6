// Depth, normals and camera of a frame, in double.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

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
  // A pixel cannot hide more surfaces than there are planes.
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
  // The rules and constants of reconstruct.comp.
  constexpr double kNearness = 0.1, kSameSurface = 4, kRounding = 1e-6, kOneSurface = 0.01, kNone = 1e30;
  const double center = affine_depth(x, y);
  const Vector at = position(x, y, depth(x, y));
  Vector tangent, other;
  double least = kNone, step = 0, other_step = kNone;
  for (const int side : {-1, 1}) {
    const int i = x + side * dx, j = y + side * dy;
    const double next = affine_depth(i, j), second = affine_depth(i + side * dx, j + side * dy);
    if (next <= 0) continue;
    const double change = side * (next - center);
    const double error =
        (second > 0 ? std::abs(2 * next - second - center) : std::abs(change)) + kNearness * std::abs(change);
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
  const bool is_same = std::abs(step - other_step) <= kSameSurface * least + kRounding * center &&
                       std::max(std::abs(step), std::abs(other_step)) < kOneSurface * center;
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
  // The rules of reconstruct.comp, with the thresholds of normal.glsl.
  constexpr double kOpposite = -0.5, kLeastFacing = 1e-3;
  if (dot(n, eye) < -kLeastFacing && dot(n, eye) + dot(n, normal_from_depth(x, y, eye)) < kOpposite) n = -1 * n;
  return dot(n, eye) < kLeastFacing ? normalized(n + (kLeastFacing - dot(n, eye)) * eye) : n;
}

namespace {

/// Surfaces are one if their distance is at most so many times the error of a depth, and a pixel.
constexpr double kPrecisions = 4;
/// The farthest end of a surface that counts, in pixels.
constexpr int kReach = 64;
/// The largest thickness of a solid, as a multiple of its front's width.
constexpr double kMostThickness = 2;

class Layers {
 public:
  Layers(const ReferenceScene& scene, const HostFrame& frame, int hidden)
      : scene_(scene),
        frame_(frame),
        hidden_(hidden),
        pixels_(frame.data.pixels()),
        planes_(std::size_t(hidden) * pixels_),
        open_(planes_.size()) {}

  void merge(double separation) {
    std::vector<DepthMap> maps;
    for (const auto& plane : frame_.behind)
      maps.push_back(plane.depth_kind == DepthKind::automatic
                         ? depth_map_of(frame_)
                         : depth_map(plane.depth_kind, {}, {}, frame_.camera, plane.scale, frame_.sky));
    const DepthPrecision precision = hidden_precision_of(frame_);
    const auto separation_at = [&](double z) {
      if (separation >= 0) return separation;
      return kPrecisions * precision.at_depth(z) + pixel_size(z);
    };
    for_pixels([&](int x, int y) {
      double last = scene_.depth(x, y);
      int kept = 0;
      for (const auto& [z, kind] : found(x, y, maps)) {
        if (kept == hidden_) break;
        if (z <= last + separation_at(last)) continue;
        const std::size_t at = index(x, y, ++kept);
        planes_[at] = float(kind == Kind::closes ? -z : z);
        open_[at] = kind == Kind::unknown;
        last = z;
      }
    });
  }

  /// Finds which surfaces of unknown kind close a solid.
  void pair() {
    std::vector<bool> closes(planes_.size());
    for_pixels([&](int x, int y) {
      bool opens = true;  // the surface before closes none itself
      for (int k = 1; k <= hidden_ && depth(x, y, k) > 0; k++) {
        const std::size_t at = index(x, y, k);
        const bool closes_already = planes_[at] < 0;
        closes[at] = open_[at] && opens && ends_with(x, y, k - 1);
        opens = !closes_already && !closes[at];
      }
    });
    for (std::size_t i = 0; i < planes_.size(); i++)
      if (closes[i]) planes_[i] = -planes_[i];
  }

  std::vector<float> take() { return std::move(planes_); }

 private:
  enum class Kind { closes, front, unknown };
  struct End {
    int vote = 0;   // 1: with the surface behind it; -1: without it; 0: unknown
    int steps = 0;  // its distance in pixels, or the search's
  };

  void for_pixels(const std::function<void(int, int)>& take) const {
    for (int y = 0; y < scene_.height(); y++)
      for (int x = 0; x < scene_.width(); x++)
        if (scene_.depth(x, y) > 0) take(x, y);
  }
  double pixel_size(double z) const { return (scene_.orthographic() ? 1 : z) / scene_.fx(); }
  std::size_t index(int x, int y, int surface) const {
    return std::size_t(surface - 1) * pixels_ + std::size_t(y) * std::size_t(scene_.width()) + std::size_t(x);
  }
  double depth(int x, int y, int surface) const {
    return surface == 0 ? scene_.depth(x, y) : std::abs(planes_[index(x, y, surface)]);
  }

  /// The surfaces that the planes hold at a pixel, nearer first; of equally near ones, the better known first.
  std::vector<std::pair<double, Kind>> found(int x, int y, const std::vector<DepthMap>& maps) const {
    const double ray_length = scene_.orthographic() ? 1 : length(scene_.position(x, y, 1));
    std::vector<std::pair<double, Kind>> found;
    for (std::size_t plane = 0; plane < maps.size(); plane++) {
      const BehindKind kind = frame_.behind[plane].kind;
      const float raw = frame_.behind_depth[plane * pixels_ + index(x, y, 1)];
      double z = planar_depth(maps[plane], {raw, 0, 0}, ray_length);
      if (kind == BehindKind::thickness) z += scene_.depth(x, y);
      if (std::isfinite(z) && z > 0)
        found.emplace_back(z, kind == BehindKind::surfaces ? Kind::unknown
                              : kind == BehindKind::fronts ? Kind::front
                                                           : Kind::closes);
    }
    std::ranges::sort(found);
    return found;
  }

  bool same(double a, double b) const {
    return a > 0 && b > 0 && std::abs(a - b) < kRunSlope * pixel_size(std::min(a, b));
  }

  /// The index of the neighbour's surface that goes on from this one, if each is the other's nearest; -1: none.
  int link(int x, int y, int surface, int next_x, int next_y) const {
    const double z = depth(x, y, surface);
    int best = -1;
    for (int j = 0; j <= hidden_; j++) {
      const double other = depth(next_x, next_y, j);
      const double gap = std::abs(z - other);
      if (!same(z, other) || (best >= 0 && gap >= std::abs(z - depth(next_x, next_y, best)))) continue;
      bool mutual = true;
      for (int i = 0; i <= hidden_; i++)
        mutual = mutual && !(i != surface && same(depth(x, y, i), other) && std::abs(depth(x, y, i) - other) < gap);
      if (mutual) best = j;
    }
    return best;
  }

  /// Follows a surface to its end, and checks whether the surface behind it ends there too.
  End end_of(int x, int y, int surface, int step_x, int step_y) const {
    for (int step = 1; step <= kReach; step++) {
      const int next_x = x + step_x;
      const int next_y = y + step_y;
      if (!scene_.inside(next_x, next_y)) return {0, step};
      const int next = link(x, y, surface, next_x, next_y);
      if (next < 0) return {vote(x, y, surface, step_x, step_y), step};
      surface = next;
      x = next_x;
      y = next_y;
    }
    return {0, kReach};
  }

  /// The vote of the surface behind, at the last pixel of a surface.
  int vote(int x, int y, int surface, int step_x, int step_y) const {
    const int behind = surface + 1;
    if (behind > hidden_ || depth(x, y, behind) == 0) return 0;
    const int next_x = x + step_x;
    const int next_y = y + step_y;
    const int next = link(x, y, behind, next_x, next_y);
    const double last = depth(next_x, next_y, hidden_);
    // Behind a full list, the surface may go on unseen.
    if (next < 0) return last > 0 && last < depth(x, y, behind) ? 0 : 1;
    // The outline of the surface behind may lie a pixel farther out.
    const int after_x = next_x + step_x;
    const int after_y = next_y + step_y;
    return scene_.inside(after_x, after_y) && link(next_x, next_y, next, after_x, after_y) < 0 ? 1 : -1;
  }

  /// Whether a surface ends together with the one behind it at most of its ends along row and column, and the gap
  /// between them is no larger than a solid's.
  bool ends_with(int x, int y, int surface) const {
    int votes = 0;
    std::array<int, 2> width{-1, -1};
    for (const int way : {-1, 1}) {
      const End along_row = end_of(x, y, surface, way, 0);
      const End along_column = end_of(x, y, surface, 0, way);
      votes += along_row.vote + along_column.vote;
      width[0] += along_row.steps;
      width[1] += along_column.steps;
    }
    const double z = depth(x, y, surface);
    return votes > 0 && depth(x, y, surface + 1) - z <= kMostThickness * std::min(width[0], width[1]) * pixel_size(z);
  }

  const ReferenceScene& scene_;
  const HostFrame& frame_;
  int hidden_;
  std::size_t pixels_;
  std::vector<float> planes_;
  std::vector<bool> open_;  // one per value of `planes_`: it may close a solid
};

}  // namespace

ReferenceLayers reference_layers(const ReferenceScene& scene, const HostFrame& frame, int hidden, double separation) {
  Layers layers(scene, frame, hidden);
  layers.merge(separation);
  layers.pair();
  return {layers.take(), list_all(frame.behind)};
}

}  // namespace alcove
