// A frame in view space, in double, for the CPU references. docs/hidden.md has the rules for surfaces behind the first.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "core/frame/reading.h"

namespace alcove {

/// Neighbours on a line of pixels are one surface if their depths differ by less than this many pixels' worth of slope.
constexpr double kRunSlope = 8;

/// A vector of view space: x right, y up, the camera looks along -z.
struct Vector {
  double x = 0, y = 0, z = 0;
};
inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(Vector a);
Vector normalized(Vector a);

/// A frame with planar depth and normals for every pixel, and the known surfaces behind the first one of a pixel. The
/// frame must outlive it.
class ReferenceScene {
 public:
  /// Keeps `hidden` surfaces behind the first; for the separation see reference_layers(). Fails with ErrorKind::input
  /// on another frame.
  explicit ReferenceScene(const HostFrame& frame, int hidden = 0, double separation = -1);

  /// The most surfaces of a pixel, the first one among them.
  int surfaces() const { return surfaces_; }
  /// Whether a pixel that lists fewer surfaces than that has no others.
  bool lists_all() const { return lists_all_; }

  int width() const { return frame_.data.width; }
  int height() const { return frame_.data.height; }
  bool orthographic() const { return camera_.orthographic; }
  double fx() const { return camera_.fx; }
  double fy() const { return camera_.fy; }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width() && y < height(); }

  /// The planar depth of the first surface; 0 on sky.
  double depth(int x, int y) const;
  /// The planar depth of a surface, 0 being the first one, nearer ones first; 0 if there is none.
  double depth(int x, int y, int surface) const;
  /// Whether a surface closes the solid of the surface before it.
  bool closes(int x, int y, int surface) const;
  Vector position(int x, int y, double z) const;
  /// The offset in position of an offset on the image, in px, at that planar depth.
  Vector across(double x_px, double y_px, double z) const;
  Vector toward_eye(Vector position) const;
  /// The place of a position on the image, px from the data window's upper left corner.
  std::pair<double, double> image_of(Vector position) const;
  /// The unit shading normal. It is turned round if it belongs to the other side of the surface, and bent to face the
  /// eye if it leans away.
  Vector normal(int x, int y, Vector eye) const;

 private:
  /// A depth that is affine over the image of a plane: 1/z, or z of an orthographic camera; below 0 without a surface.
  double affine_depth(int x, int y) const;
  /// The change of position along one axis, by the rules of reconstruct.comp.
  Vector tangent_along(int x, int y, int dx, int dy) const;
  Vector normal_from_depth(int x, int y, Vector eye) const;
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width()) + std::size_t(x); }

  const HostFrame& frame_;
  const Camera& camera_;
  double center_x_, center_y_;
  int surfaces_ = 1;
  bool lists_all_ = false;
  std::vector<float> hidden_;  // see ReferenceLayers
};

/// The known surfaces behind the first one of each pixel.
struct ReferenceLayers {
  // planar depth, a plane for each kept surface, nearer first. 0: none; below 0: the size is the depth, and the surface
  // closes the solid of the one before it.
  std::vector<float> planes;
  bool lists_all = false;  // a pixel that lists fewer surfaces has no others
};

/// Keeps `hidden` surfaces behind the first ones of `scene`, which has none yet, and pairs fronts with backs. Surfaces
/// closer together than the separation (scene units) are one; below 0: as in layers.comp.
ReferenceLayers reference_layers(const ReferenceScene& scene, const HostFrame& frame, int hidden, double separation);

}  // namespace alcove
