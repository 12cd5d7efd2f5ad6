// Holds the camera that was given, and the depth, against the positions that stand beside the depth.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.h"
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

/// How far the lens puts points from where the camera of the positions sees them, px, of most of them at most.
double beside(const Camera& lens, const Camera& seen, std::span<const SeenPoint> points) {
  std::vector<double> distances;
  for (const auto& point : points) {
    Vector3 view = point.position;
    if (seen.view_from_world) {
      view = times(*seen.view_from_world, point.position);
      for (std::size_t k = 0; k < 3; k++) view[k] += seen.view_from_world_offset[k];
    } else if (seen.left_handed) {
      view[2] = -view[2];
    }
    const auto place = [&](const Camera& camera) {
      const double over = camera.orthographic ? 1 : -1 / view[2];
      return std::array{camera.cx + camera.fx * view[0] * over, camera.cy - camera.fy * view[1] * over};
    };
    const auto a = place(lens), b = place(seen);
    distances.push_back(std::hypot(a[0] - b[0], a[1] - b[1]));
  }
  const auto last = distances.begin() + std::ptrdiff_t(kCounted * double(distances.size() - 1));
  std::ranges::nth_element(distances, last);
  return *last;
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
    return fmt::format("{} camera with fx {:.6g}, fy {:.6g}, cx {:.6g}, cy {:.6g} (--camera)",
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
  const auto middle = numbers.begin() + std::ptrdiff_t(numbers.size() / 2);
  std::ranges::nth_element(numbers, middle);
  const double median = *middle;
  for (double& number : numbers) number = std::abs(number / median - 1);
  std::ranges::nth_element(numbers, middle);
  return *middle;
}

}  // namespace

std::string settle_camera(FrameSource& source, const InputSettings& settings) {
  if (source.positions.empty() || source.camera_is_assumed || source.camera_from == kByPositions) return "";
  ExrFile& file = source.files[source.positions.front().file];
  const auto points = points_of(file, source.positions, settings.sky, kFewBands);
  const auto found = resection_of(points, source.display);
  const auto* by_positions = std::get_if<Resection>(&found);
  if (!by_positions) {
    if (const std::string panorama = panorama_of(points, source.display); !panorama.empty())
      refuse_panorama(file.path(), panorama + " by its positions");
    return "";
  }
  const Camera& seen = by_positions->camera;
  const double px = beside(source.camera, seen, points);
  if (px <= std::max(kLeastBeside, kLeastPart * source.display.width)) return "";
  const bool is_option = source.camera_from.empty();
  const std::string text =
      fmt::format("by {} the positions of {} lie up to {:.3g} px from the pixels that hold them; they show {}{}",
                  name_of_lens(source, settings), file.path(), px, text_of(seen, source.pixel_aspect),
                  is_option ? ", which is taken if the option is left out" : "");
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
