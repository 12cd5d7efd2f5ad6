// Holds the camera that was given, and the depth, against the positions that stand beside the depth.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/base/ranks.h"
#include "core/frame/flatness.h"
#include "core/frame/linear_fit.h"
#include "core/frame/panorama.h"
#include "core/frame/position_pass.h"
#include "core/frame/settlement.h"

namespace alcove {
namespace {

/// Of the points, those that are counted are the nearest to their pixels: the rest may be of edges.
constexpr double kCounted = 0.9;
/// px, and part of the picture's width: a lens that is off by less is one that was rounded.
constexpr double kLeastBeside = 1, kLeastPart = 1e-3;
/// px. Where half of the points are farther off by the camera that fits best, they are of no camera; filtered ones are
/// nearer.
constexpr double kNoCamera = 2;

/// How far a lens puts points from the pixels that hold them, px, of most of them at most and beyond their rounding.
/// The camera that stands where they are seen from places them.
double beside(const Camera& lens, const Camera& standing, std::span<const SeenPoint> points) {
  std::vector<double> distances;
  for (const auto& point : points) {
    Vector3 view = point.position;
    if (standing.view_from_world) {
      view = times(*standing.view_from_world, point.position);
      for (std::size_t k = 0; k < 3; k++) view[k] += standing.view_from_world_offset[k];
    } else if (standing.left_handed) {
      view[2] = -view[2];
    }
    const double over = lens.orthographic ? 1 : -1 / view[2];
    const double x = lens.cx + lens.fx * view[0] * over, y = lens.cy - lens.fy * view[1] * over;
    distances.push_back(std::hypot(x - point.x, y - point.y) - point.rounding);
  }
  return value_at_rank(distances, std::size_t(kCounted * double(distances.size() - 1)));
}

bool is_centred(const Camera& camera, double pixel_aspect) {
  constexpr double kSame = 2e-3;
  return std::abs(camera.cx - 0.5 * camera.width) < kSame * camera.width &&
         std::abs(camera.cy - 0.5 * camera.height) < kSame * camera.height &&
         std::abs(camera.fy / camera.fx / pixel_aspect - 1) < kSame;
}

/// The options that give this lens, or its numbers where no option does.
std::string text_of(const Camera& camera, double pixel_aspect) {
  const double width = camera.width / camera.fx;
  if (!is_centred(camera, pixel_aspect))
    return fmt::format("{} camera with fx {:.6g}, fy {:.6g}, cx {:.2f}, cy {:.2f} (--camera)",
                       camera.orthographic ? "an orthographic" : "a", camera.fx, camera.fy, camera.cx, camera.cy);
  if (camera.orthographic) return fmt::format("an orthographic camera (--ortho-width {:.6g})", width);
  const double degrees = 2 * std::atan(0.5 * width) * 180 / std::numbers::pi;
  return fmt::format("a field of view of {:.5g} degrees (--fov {:.5g})", degrees, degrees);
}

/// What gave the lens, as messages call it.
std::string name_of_lens(const FrameSource& source, const InputSettings& settings) {
  if (!source.camera_from.empty()) return source.camera_from;
  if (!settings.camera.empty()) return "the camera of " + settings.camera;
  if (settings.fov) return fmt::format("--fov {:g}", *settings.fov);
  return settings.focal ? "--focal with --aperture" : "--ortho-width";
}

/// How far a point is along the view, scene units.
double planar_of(const SeenPoint& point, const Camera& camera) {
  if (!camera.view_from_world) return std::abs(point.position[2]);
  return -(dot((*camera.view_from_world)[2], point.position) + camera.view_from_world_offset[2]);
}

/// How little numbers differ from their median, relative to it: the median of that.
double spread(std::vector<double> numbers) {
  const double median = median_of(numbers);
  for (double& number : numbers) number = std::abs(number / median - 1);
  return median_of(std::move(numbers));
}

}  // namespace

std::string settle_camera(FrameSource& source, const InputSettings& settings) {
  if (source.positions.empty() || source.camera_is_assumed || source.camera_from == kByPositions) return "";
  ExrFile& file = source.files[source.positions.front().file];
  const auto points = points_of(file, source.positions, settings.sky, kFewBands);
  const double limit = std::max(kLeastBeside, kLeastPart * source.display.width);
  if (points.empty() || beside(source.camera, source.camera, points) <= limit) return "";
  const auto found = resection_of(points, source.display);
  const auto* seen = std::get_if<Resection>(&found);
  const std::string& held = file.path();
  std::string text;
  if (!seen) {
    if (const std::string panorama = panorama_of(points, source.display); !panorama.empty())
      refuse_panorama(file.path(), panorama + " by its positions");
    const auto& none = std::get<NoResection>(found);
    if (none.median <= kNoCamera || !source.camera_from.empty()) return "";
    text = fmt::format(
        "no camera fits the positions of {}: by the best of all half of them lie {:.3g} px and more from the pixels "
        "that "
        "hold them, so they are of a panorama, or no positions (--position-channels); {} is taken",
        held, none.median, name_of_lens(source, settings));
  } else {
    const double px = beside(source.camera, seen->camera, points);
    if (px <= limit) return "";
    text = fmt::format("by {} most positions of {} lie up to {:.3g} px from the pixels that hold them; they show {}{}",
                       name_of_lens(source, settings), held, px, text_of(seen->camera, source.pixel_aspect),
                       source.camera_from.empty() ? ": give that, or leave the option out" : "");
  }
  source.notes.push_back({NoteCode::field_of_view, text});
  return text;
}

std::optional<DepthKind> kind_by_positions(FrameSource& source, const InputSettings& settings,
                                           std::span<const float> depth) {
  constexpr double kSame = 0.005;  // of depth that is that of the positions, in whatever unit
  constexpr double kOther = 4;     // times as far is another kind
  if (source.positions.empty() || source[RawPlane::depth].size() != 1) return std::nullopt;
  ExrFile& file = source.files[source.positions.front().file];
  const View view = view_of(source.camera, source.data, source.display);
  std::vector<double> planar, ray, inverse;
  for (const auto& point : points_of(file, source.positions, settings.sky, kFewBands)) {
    const int x = int(point.x) + source.display.x - source.data.x, y = int(point.y) + source.display.y - source.data.y;
    if (x < 0 || y < 0 || x >= source.data.width || y >= source.data.height) continue;
    const double value = std::abs(depth[std::size_t(y) * std::size_t(source.data.width) + std::size_t(x)]);
    const double z = planar_of(point, source.camera);
    if (!(value > 0 && value < settings.sky && z > 0)) continue;
    planar.push_back(value / z);
    ray.push_back(value / (z * ray_length(view, x, y)));
    inverse.push_back(value * z);
  }
  if (planar.size() < kLeastPoints) return std::nullopt;
  const std::array spreads{std::pair{spread(planar), DepthKind::planar}, std::pair{spread(ray), DepthKind::ray},
                           std::pair{spread(inverse), DepthKind::inverse}};
  const auto best = std::ranges::min_element(spreads);
  const auto fits_too = [&](const auto& other) {
    return other.second != best->second && other.first < kOther * std::max(best->first, 1e-5);
  };
  if (best->first > kSame || std::ranges::any_of(spreads, fits_too)) return std::nullopt;
  return best->second;
}

}  // namespace alcove
