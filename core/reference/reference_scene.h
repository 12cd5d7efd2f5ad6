// A frame in view space, in double: what the CPU references see.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/frame/host_frame.h"

namespace alcove {

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

/// The frame, which must outlive it, with planar depth and normals for every pixel.
class ReferenceScene {
 public:
  /// Fails with ErrorKind::input on another frame.
  explicit ReferenceScene(const HostFrame& frame);

  int width() const { return frame_.data.width; }
  int height() const { return frame_.data.height; }
  bool orthographic() const { return camera_.orthographic; }
  double fx() const { return camera_.fx; }
  double fy() const { return camera_.fy; }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width() && y < height(); }

  /// Planar depth; 0 on sky.
  double depth(int x, int y) const;
  Vector position(int x, int y, double z) const;
  /// The offset in position of an offset on the image, px, at that planar depth.
  Vector across(double x_px, double y_px, double z) const;
  Vector toward_eye(Vector position) const;
  /// Where a position is seen, px from the data window's upper left corner.
  std::pair<double, double> image_of(Vector position) const;
  /// The unit shading normal, bent to face the eye where it leans away.
  Vector normal(int x, int y, Vector eye) const;

 private:
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width()) + std::size_t(x); }

  const HostFrame& frame_;
  const Camera& camera_;
  double center_x_, center_y_;
};

}  // namespace alcove
