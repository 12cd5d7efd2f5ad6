// Finds the surroundings of a region by the nearest depth in it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/region.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/chain/aov.h"
#include "core/frame/evidence.h"
#include "core/frame/settle.h"
#include "kernels/profile.h"

namespace alcove {
namespace {

constexpr int kBlock = 64;  // px of a side of the blocks whose nearest depths are kept
// Windows begin at multiples of so many px, the grid of the coarsest resolution, so that its pixels are the same ones.
constexpr int kGrid = 4;

/// An angle close to a right one, in radians: beyond it the image of a sphere has no end.
constexpr double kWidestAngle = 1.57;
/// More pixels than any frame has.
constexpr double kEverywhere = 1e9;

Window grown(const Window& window, int margin_x, int margin_y, const Window& within) {
  const auto down = [](int x, int origin) { return origin + (x - origin) / kGrid * kGrid; };
  const int left = down(std::max(window.x - margin_x, within.x), within.x),
            top = down(std::max(window.y - margin_y, within.y), within.y);
  const int right = std::min(window.x + window.width + margin_x + kGrid, within.x + within.width);
  const int bottom = std::min(window.y + window.height + margin_y + kGrid, within.y + within.height);
  return {left, top, right - left, bottom - top};
}

/// How far filters reach, in px: the denoiser by pixels of the estimate, and upsampling by two of them.
int filter_reach(const EstimatorSettings& settings) {
  const int denoised = denoise_reach_of(settings) + (is_adaptive(settings) ? kSiteReach : 0);
  return int(settings.resolution) * (denoised + (settings.resolution == Resolution::full ? 0 : 2));
}

/// The same of all that a frame's outputs are made from.
int filter_reach(const Settings& settings) {
  const int own = filter_reach(settings.estimator);
  if (!wants(settings.output, &FrameOutputs::confidence)) return own;
  return std::max(own, filter_reach(bracket_of(settings.estimator)));
}

/// How far lines of an exact search reach beyond the sphere of the radius until they have the vertices of the whole
/// frame, in px; 0 for other searches.
int line_reach(const EstimatorSettings& settings) {
  return searches_exactly(settings) ? int(settings.resolution) * (kProfileRestart + 2) : 0;
}

/// The width, in radii, from which a run that begins within reach of a receiver is as good as endless. It is more than
/// the sphere's 2, since exact.comp rounds widths by up to 3 %. Where surfaces are completed, a run is half as thick as
/// wide, and it may begin so far beyond the reach as a surface goes on, which is 3 radii in complete.comp.
double widest_run(const EstimatorSettings& settings) { return completes(settings) ? 3 + 4.2 : 2.1; }

/// How many pixels the image of a sphere reaches from the image of its centre, on one axis. Centres are no nearer than
/// `nearest`, and no farther off axis than `tangent`.
double sphere_reach(double radius, double nearest, double tangent, double pixels_per_tangent, bool orthographic) {
  if (orthographic) return radius * pixels_per_tangent;
  if (radius >= nearest) return kEverywhere;
  const double edge = std::atan(tangent) + std::asin(radius / nearest);
  return edge < kWidestAngle ? (std::tan(edge) - tangent) * pixels_per_tangent : kEverywhere;
}

}  // namespace

Window region_of(const FrameSource& source, const Region& roi) {
  const Window& data = source.file_data;
  const Window region{source.display.x + roi.x, source.display.y + roi.y, roi.width, roi.height};
  const bool inside = region.x >= data.x && region.y >= data.y &&
                      std::int64_t(region.x) + region.width <= std::int64_t(data.x) + data.width &&
                      std::int64_t(region.y) + region.height <= std::int64_t(data.y) + data.height;
  if (!inside)
    fail(ErrorKind::usage, "{}: --roi is {}, and the data window is {}: give a region within it", source.depth_path(),
         to_string(region), to_string(data));
  return region;
}

Surroundings::Surroundings(FrameSource& source, const Settings& settings, const Window& whole)
    : file_data_(source.file_data),
      read_(searches_exactly(settings.estimator)
                ? file_data_
                : grown(whole, filter_reach(settings), filter_reach(settings), file_data_)),
      columns_((read_.width + kBlock - 1) / kBlock),
      nearest_(std::size_t(columns_) * std::size_t((read_.height + kBlock - 1) / kBlock), kSkyDepth),
      view_(view_of(source.camera, source.file_data, source.display)),
      orthographic_(source.camera.orthographic),
      radius_(settings.estimator.radius ? radii_of(settings.estimator).back() : 0),
      filters_(filter_reach(settings)),
      lines_(line_reach(settings.estimator)),
      widest_run_(widest_run(settings.estimator)) {
  const Window data = source.data;
  const DepthMap map = depth_map_of(source);
  for (int top = 0; top < read_.height; top += kBlock) {
    source.data = {read_.x, read_.y + top, read_.width, std::min(kBlock, read_.height - top)};
    std::vector<float> depth(source[RawPlane::depth].size() * source.data.pixels());
    read_planes(source, {{&source[RawPlane::depth], depth.data()}});
    const auto planar = planar_depths(depth, map, view_of(source.camera, source.data, source.display));
    for (std::size_t i = 0; i < planar.size(); i++) {
      float& nearest = nearest_[std::size_t(top / kBlock * columns_) + i % std::size_t(read_.width) / kBlock];
      nearest = std::min(nearest, planar[i]);
    }
  }
  source.data = data;
}

double Surroundings::nearest_in(const Window& window) const {
  float nearest = kSkyDepth;
  for (int y = (window.y - read_.y) / kBlock; y <= (window.y + window.height - 1 - read_.y) / kBlock; y++)
    for (int x = (window.x - read_.x) / kBlock; x <= (window.x + window.width - 1 - read_.x) / kBlock; x++)
      nearest = std::min(nearest, nearest_[std::size_t(y) * std::size_t(columns_) + std::size_t(x)]);
  return nearest;
}

Window Surroundings::within(double distance, const Window& window) const {
  const double nearest = nearest_in(window);
  const auto margin = [&](double low, double high, double center, double tangent_per_pixel) {
    const double tangent = std::max(std::abs(low - center), std::abs(high - center)) * std::abs(tangent_per_pixel);
    return int(std::ceil(std::min(
               sphere_reach(distance, nearest, tangent, 1 / std::abs(tangent_per_pixel), orthographic_), 1e6))) +
           2;
  };
  const int left = window.x - file_data_.x, top = window.y - file_data_.y;
  return grown(window, margin(left, left + window.width, view_.center.x, view_.tangent_per_pixel.x),
               margin(top, top + window.height, view_.center.y, view_.tangent_per_pixel.y), file_data_);
}

Window Surroundings::around(const Window& part) const {
  const Window occluders = within(radius_, grown(part, filters_, filters_, file_data_));
  return lines_ == 0 ? occluders : within(widest_run_ * radius_, grown(occluders, lines_, lines_, file_data_));
}

}  // namespace alcove
