// A frame in view space, in double: what the CPU references see. Surfaces behind the first: docs/hidden.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "core/frame/reading.h"

namespace alcove {

/// Neighbours on a line of pixels whose depth differs by less than this many pixels' worth of slope are one surface.
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

/// The frame, which must outlive it, with planar depth and normals for every pixel, and what is known of the surfaces
/// behind the first one of a pixel.
class ReferenceScene {
 public:
  /// Keeps so many surfaces behind the first; for the separation see reference_layers(). Fails with ErrorKind::input
  /// on another frame.
  explicit ReferenceScene(const HostFrame& frame, int hidden = 0, double separation = -1);

  /// The most surfaces of a pixel, the first one among them.
  int surfaces() const { return surfaces_; }
  /// Whether a pixel that lists fewer surfaces has no more of them.
  bool lists_all() const { return lists_all_; }

  int width() const { return frame_.data.width; }
  int height() const { return frame_.data.height; }
  bool orthographic() const { return camera_.orthographic; }
  double fx() const { return camera_.fx; }
  double fy() const { return camera_.fy; }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width() && y < height(); }

  /// Planar depth; 0 on sky.
  double depth(int x, int y) const;
  /// The same of a surface, 0 the first one, nearer ones first; 0 where there is none.
  double depth(int x, int y, int surface) const;
  /// Whether it closes the solid of the surface before it.
  bool closes(int x, int y, int surface) const;
  Vector position(int x, int y, double z) const;
  /// The offset in position of an offset on the image, px, at that planar depth.
  Vector across(double x_px, double y_px, double z) const;
  Vector toward_eye(Vector position) const;
  /// Where a position is seen, px from the data window's upper left corner.
  std::pair<double, double> image_of(Vector position) const;
  /// The unit shading normal, turned round where it belongs to the other side of the surface, and bent to face the eye
  /// where it leans away.
  Vector normal(int x, int y, Vector eye) const;

 private:
  /// What is affine over the image of a plane: 1/z, orthographic z; below 0 where there is no surface.
  double affine_depth(int x, int y) const;
  /// The change of position along one axis, and the unit normal that faces the eye: see reconstruct.comp.
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

struct ReferenceLayers {
  // Planar depth, a plane for each surface that is kept, nearer first; 0: there is none; below 0, of the same size: it
  // closes the solid of the surface before it.
  std::vector<float> planes;
  bool lists_all = false;  // a pixel that lists fewer surfaces has no more of them
};

/// Keeps so many surfaces behind the first ones of `scene`, which knows no others yet, and pairs them. Surfaces are one
/// that are closer than the separation, scene units; below 0: than layers.comp says.
ReferenceLayers reference_layers(const ReferenceScene& scene, const HostFrame& frame, int hidden, double separation);

}  // namespace alcove
