// Resection, as photogrammetry calls it: the camera from points with known places in space and in the picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/// Adds the two equations that a point gives for the rows of a projection, which are linear in these.
void add_linear(const SeenPoint& seen, Square<12>& sums);

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

// Why no camera sees points where their pixels are.

/// Explains that components of the points were cut off at 0 or another value, as in formats without sign; "" if they
/// were not.
std::string why_cut(std::span<const SeenPoint> points, const Window& display);

/// Explains that each axis was stretched by itself, as when a bounding box is mapped to 0 .. 1; "" if it was not.
/// `camera`: a camera that fits the points all the same, or null. Its pixels have the aspect of its own numbers, and
/// `pixel_aspect` is the file's.
std::string why_stretched(std::span<const SeenPoint> points, const Window& display, const Resection* camera,
                          double pixel_aspect);

/// Explains that the lens bends lines: each point lies in the right direction from the picture's middle, but at another
/// distance. "" if it does not.
std::string why_bent(std::span<const SeenPoint> points, const Window& display);

}  // namespace alcove
