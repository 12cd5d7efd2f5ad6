// The region, and its surroundings by the nearest depth in it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/region.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/evidence.h"
#include "core/passes.h"
#include "core/settle.h"

namespace alcove {
namespace {

constexpr int kGrid = 4;  // px: windows begin on the grid of the coarsest resolution, so that its pixels are the same ones

Window grown(const Window& window, int margin_x, int margin_y, const Window& within) {
  const auto down = [](int x, int origin) { return origin + (x - origin) / kGrid * kGrid; };
  const int left = down(std::max(window.x - margin_x, within.x), within.x), top = down(std::max(window.y - margin_y, within.y), within.y);
  const int right = std::min(window.x + window.width + margin_x + kGrid, within.x + within.width);
  const int bottom = std::min(window.y + window.height + margin_y + kGrid, within.y + within.height);
  return {left, top, right - left, bottom - top};
}

/// How far a filter reaches: the denoiser over pixels of the estimate, and upsampling by two of them.
int filter_reach(const EstimatorSettings& settings) {
  const int denoised = settings.denoise == Denoise::none ? 0 : std::max({4, settings.denoise_radius, int(settings.denoise_kernel.size())});
  return int(settings.resolution) * (denoised + (settings.resolution == Resolution::full ? 0 : 2));
}

/// Pixels on one axis that the image of a sphere of this radius reaches from its centre's, where centres are no nearer than `nearest` and no farther
/// off axis than `tangent`.
double sphere_reach(double radius, double nearest, double tangent, double pixels_per_tangent, bool orthographic) {
  if (orthographic) return radius * pixels_per_tangent;
  if (radius >= nearest) return 1e9;
  const double centre = std::atan(tangent), edge = centre + std::asin(radius / nearest);
  return edge < 1.57 ? (std::tan(edge) - tangent) * pixels_per_tangent : 1e9;
}

}  // namespace

void restrict_to_region(FrameSource& source, const Settings& settings) {
  const Region& roi = *settings.input.roi;
  const Window all = source.file_data, region{source.display.x + roi.x, source.display.y + roi.y, roi.width, roi.height};
  const bool inside = region.x >= all.x && region.y >= all.y && std::int64_t(region.x) + region.width <= std::int64_t(all.x) + all.width &&
                      std::int64_t(region.y) + region.height <= std::int64_t(all.y) + all.height;
  if (!inside)
    fail(ErrorKind::usage, "{}: --roi is {}, and the data window is {}: give a region within it", source.files[source.depth[0].file].path(),
         to_string(region), to_string(all));
  require_host_room(source.files[source.depth[0].file].path(), all);
  std::vector<float> depth(source.depth.size() * all.pixels()), normal(source.normal.size() * all.pixels());
  read_planes(source, {{&source.depth, depth.data()}, {&source.normal, normal.data()}});
  settle(source, settings.input, depth, normal);

  const View view = view_of(source.camera, all, source.display);
  const auto planar = planar_depths(depth, depth_map_of(source, settings.input), view);
  const int filters = filter_reach(settings.estimator);
  const Window filtered = grown(region, filters, filters, all);
  const auto receivers = cropped(planar, all, filtered);
  const double nearest = *std::ranges::min_element(receivers), radius = settings.estimator.radius ? radii_of(settings.estimator).back() : 0;
  const auto margin = [&](double low, double high, double center, double tangent_per_pixel) {
    const double tangent = std::max(std::abs(low - center), std::abs(high - center)) * std::abs(tangent_per_pixel);
    return int(std::ceil(std::min(sphere_reach(radius, nearest, tangent, 1 / std::abs(tangent_per_pixel), source.camera.orthographic), 1e6))) + 2;
  };
  const int margin_x = margin(filtered.x - all.x, filtered.x - all.x + filtered.width, view.center.x, view.tangent_per_pixel.x);
  const int margin_y = margin(filtered.y - all.y, filtered.y - all.y + filtered.height, view.center.y, view.tangent_per_pixel.y);
  source.data = grown(filtered, margin_x, margin_y, all);
  source.region = region;
}

}  // namespace alcove
