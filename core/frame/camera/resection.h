// Resection, as photogrammetry calls it: the camera from points with known places in space and in the picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/frame/camera/camera.h"

namespace alcove {

/// A point that a pixel shows.
struct SeenPoint {
  Vector3 position;     // scene units, in the world or in the camera's space
  double x, y;          // px from the display window's upper left corner
  double rounding = 0;  // px that it may be beside its place, since its numbers are rounded
};

struct Resection {
  // Without a rotation where the points are in the camera's own space: then left_handed says whether it looks along +z.
  Camera camera;
  double within = 0;       // share of the points that lie within kSeenWithin of their pixels
  double median = 0;       // px from point to pixel
  double focal_error = 0;  // standard deviation of fx, relative to it
};

/// The reason for which no camera is found.
struct NoResection {
  std::string why;
  double median = 0;  // px from point to pixel by the camera that fits best; 0 if that is not the reason
};

/// A camera is found where nearly all points lie so near to their pixels, px, beyond their rounding.
constexpr double kSeenWithin = 0.1;
/// The share of all points that is nearly all.
constexpr double kNearlyAll = 0.9;
/// The fewest points.
constexpr std::size_t kLeastPoints = 60;

/// Finds the camera that sees points where their pixels are: projection, principal point, rotation and place, of a
/// perspective or an orthographic view. Some of the points may lie anywhere, as at edges of averaged positions. Gives a
/// reason where it finds none: too few points, all in one plane, or too many beside their pixels.
///
/// The first guess is the direct linear transform (Abdel-Aziz and Karara, 1971; normalized as by Hartley, In Defense of
/// the Eight-Point Algorithm, 1997) of the sample of points that leaves the fewest others beside their pixels (Torr and
/// Zisserman, MLESAC, 2000); it is refined by least squares over all points that fit, with a camera without skew.
std::variant<Resection, NoResection> resection_of(std::span<const SeenPoint> points, const Window& display);

/// The points moved and scaled to be about 1 in size, and the way back.
struct Normalized {
  std::vector<SeenPoint> points;
  Vector3 middle{};
  double size = 1;
};

Normalized normalized(std::span<const SeenPoint> points);

/// Names the panorama by which points are seen where their pixels are; "" if none of these fits: the whole sphere and
/// half of it in longitude and latitude, cylinders, and fish eyes. It need not be upright. For points that no camera
/// sees.
std::string panorama_of(std::span<const SeenPoint> points, const Window& display);

}  // namespace alcove
