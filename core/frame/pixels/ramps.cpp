// Finds the pixels of ramps along rows and columns, and puts them onto planes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/ramps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/frame/pixels/lines.h"
#include "core/frame/pixels/places.h"

namespace alcove {
namespace {

/// Parts of a ramp: its ends are as much wider on each side, as those of a Gaussian are beyond a tenth of its steepest
/// step, and within so much of its change a pixel belongs to the surface there. Measured on rendered scenes.
constexpr double kTail = 0.15, kSame = 0.15;
constexpr double kMiddle = 0.25;
constexpr int kReach = 12;      // px, of the pixels that a plane goes through
constexpr double kSpread = 4;   // px, by which their weight falls to exp(-1/2)
constexpr double kRidge = 0.3;  // px^2: pixels in a row tell no slope across it

/// A pixel of a ramp, and that ramp's ends, all as places in the plane. The first end is that on the pixel's side.
struct RampPixel {
  std::size_t at;
  std::array<std::size_t, 2> ends;
  float steepest;   // step of 1/z between two pixels
  float value = 0;  // that it gets
};

class RampCutter {
 public:
  RampCutter(const Reading& reading, std::span<float> raw)
      : map_(depth_map_of(reading)), view_(view_of(reading, reading.data)), raw_(raw), inverse_(raw.size()) {
    for (int y = 0; y < view_.size.y; y++)
      for (int x = 0; x < view_.size.x; x++)
        inverse_[index_of(view_, x, y)] = inverse_of(raw_[index_of(view_, x, y)], x, y);
  }

  void cut() {
    std::vector<RampPixel> pixels = all_pixels();
    is_ramp_.resize(raw_.size());
    for (const auto& pixel : pixels) is_ramp_[pixel.at] = true;
    for (auto& pixel : pixels) pixel.value = value_of(pixel);
    for (const auto& pixel : pixels) raw_[pixel.at] = pixel.value;
  }

 private:
  float inverse_of(float value, int x, int y) const {
    return float(1 / planar_depth(map_, {value, 0, 0}, map_.along_ray ? ray_length(view_, x, y) : 1));
  }

  /// The pixels of all ramps; of the ramps of a pixel, the steeper one counts.
  std::vector<RampPixel> all_pixels() const {
    const auto [width, height] = view_.size;
    std::vector<RampPixel> pixels;
    for (int y = 0; y < height; y++) take_line(std::size_t(y) * std::size_t(width), 1, std::size_t(width), pixels);
    for (int x = 0; x < width; x++) take_line(std::size_t(x), std::size_t(width), std::size_t(height), pixels);
    std::ranges::stable_sort(
        pixels, [](const auto& a, const auto& b) { return a.at != b.at ? a.at < b.at : a.steepest > b.steepest; });
    const auto are_one = [](const auto& a, const auto& b) { return a.at == b.at; };
    pixels.erase(std::unique(pixels.begin(), pixels.end(), are_one), pixels.end());
    return pixels;
  }

  void take_line(std::size_t first, std::size_t stride, std::size_t count, std::vector<RampPixel>& pixels) const {
    std::vector<double> u(count);
    for (std::size_t i = 0; i < count; i++) u[i] = inverse_[first + i * stride];
    const auto place = [&](std::size_t i) { return first + i * stride; };
    for (Ramp ramp : ramps_in(u)) {
      const std::size_t middle = middle_of(ramp, place);
      // Before a rounded outline the surface itself turns away, and the step is the ramp's end.
      const double where = (double(middle - ramp.first) - 0.5) / double(ramp.last - ramp.first);
      if (std::abs(where - 0.5) > kMiddle) continue;
      widen(u, ramp);
      for (std::size_t i = ramp.first + 1; i < ramp.last; i++) {
        const bool is_before = i < middle;
        pixels.push_back({place(i),
                          {place(is_before ? ramp.first : ramp.last), place(is_before ? ramp.last : ramp.first)},
                          float(ramp.largest)});
      }
    }
  }

  /// The first pixel beyond half of the ramp's change.
  std::size_t middle_of(const Ramp& ramp, const auto& place) const {
    const float first = raw_[place(ramp.first)], half = 0.5f * (raw_[place(ramp.last)] - first);
    std::size_t i = ramp.first + 1;
    while (i < ramp.last && std::abs(raw_[place(i)] - first) < std::abs(half)) i++;
    return i;
  }

  static void widen(std::span<const double> u, Ramp& ramp) {
    const double change = std::abs(u[ramp.last] - u[ramp.first]), first = u[ramp.first], last = u[ramp.last];
    const auto tail = std::size_t(std::lround(kTail * double(ramp.last - ramp.first)));
    for (std::size_t i = 0; i < tail && ramp.first > 1; i++, ramp.first--)
      if (std::abs(u[ramp.first - 1] - first) > kSame * change) break;
    for (std::size_t i = 0; i < tail && ramp.last + 2 < u.size(); i++, ramp.last++)
      if (std::abs(u[ramp.last + 1] - last) > kSame * change) break;
  }

  /// The value of the plane through the surface about a pixel; that of the ramp's end where there is none.
  float value_of(const RampPixel& pixel) const {
    const float at_end = raw_[pixel.ends[0]], u = inverse_[pixel.ends[0]];
    const float change = std::abs(u - inverse_[pixel.ends[1]]);
    if (u == 0) return at_end;
    const int x = int(pixel.at % std::size_t(view_.size.x)), y = int(pixel.at / std::size_t(view_.size.x));
    double all = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sv = 0, sxv = 0, syv = 0;
    for (int dy = std::max(-kReach, -y); dy <= std::min(kReach, view_.size.y - 1 - y); dy++)
      for (int dx = std::max(-kReach, -x); dx <= std::min(kReach, view_.size.x - 1 - x); dx++) {
        const std::size_t i = index_of(view_, x + dx, y + dy);
        if (is_ramp_[i] || inverse_[i] == 0 || std::abs(inverse_[i] - u) > kSame * change) continue;
        const double weight = kWeights[std::size_t(std::abs(dx))] * kWeights[std::size_t(std::abs(dy))];
        const double v = raw_[i] - at_end;
        all += weight, sx += weight * dx, sy += weight * dy, sv += weight * v;
        sxx += weight * dx * dx, sxy += weight * dx * dy, syy += weight * dy * dy;
        sxv += weight * dx * v, syv += weight * dy * v;
      }
    if (!(all > 0)) return at_end;
    const double mx = sx / all, my = sy / all, mv = sv / all;
    const double xx = sxx / all - mx * mx + kRidge, yy = syy / all - my * my + kRidge, xy = sxy / all - mx * my;
    const double xv = sxv / all - mx * mv, yv = syv / all - my * mv, whole = xx * yy - xy * xy;
    const auto value = float(at_end + mv - ((xv * yy - yv * xy) * mx + (yv * xx - xv * xy) * my) / whole);
    return std::abs(inverse_of(value, x, y) - u) < 0.5 * change ? value : at_end;
  }

  static const std::array<double, kReach + 1> kWeights;

  const DepthMap map_;
  const View view_;
  const std::span<float> raw_;
  std::vector<float> inverse_;  // 1/z; 0 of the sky
  std::vector<bool> is_ramp_;
};

const std::array<double, kReach + 1> RampCutter::kWeights = [] {
  std::array<double, kReach + 1> weights;
  for (int i = 0; i <= kReach; i++) weights[std::size_t(i)] = std::exp(-0.5 * i * i / (kSpread * kSpread));
  return weights;
}();

}  // namespace

void cut_ramps(const Reading& reading, std::span<float> depth) {
  if (!reading.cuts_ramps) return;
  if (reading.depth_kind == DepthKind::position)
    fail(ErrorKind::usage, "--set ramps=cut is for depth, and these are positions: name a depth (--depth-channel)");
  RampCutter(reading, depth).cut();
}

}  // namespace alcove
