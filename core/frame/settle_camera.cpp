// Holds the camera that was given against the positions that stand beside the depth.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.h"
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

}  // namespace alcove
