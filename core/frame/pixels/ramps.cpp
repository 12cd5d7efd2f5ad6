// Finds the pixels of ramps along rows and columns, and puts them onto planes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/ramps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/frame/pixels/walk.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

/// Parts of a ramp: its ends are as much wider on each side, as those of a Gaussian are beyond a tenth of its steepest
/// step, and within so much of its change a pixel belongs to the surface there. Measured on rendered scenes.
constexpr double kTail = 0.15, kSame = 0.15;
constexpr double kMiddle = 0.25;
constexpr int kReach = 8;       // px, of the pixels that a plane goes through
constexpr double kSpread = 4;   // px, by which their weight falls to exp(-1/2)
constexpr double kRidge = 0.3;  // px^2: pixels in a row tell no slope across it

/// A row or a column of the picture.
struct PictureLine {
  std::size_t first, stride;
  Line values;

  std::size_t place(std::size_t i) const { return first + i * stride; }
};

/// 1/z about the end of a ramp, of the surface there: affine in the picture, as that of planes is.
struct Plane {
  double value = 0, across = 0, down = 0;  // at the end, and by pixel
};

class RampCutter {
 public:
  RampCutter(const Reading& reading, std::span<float> raw)
      : map_(depth_map_of(reading)), view_(view_of(reading, reading.data)), raw_(raw), cut_(raw.begin(), raw.end()) {
    inverse_.reserve(raw.size());
    for (int y = 0; y < view_.size.y; y++)
      for (int x = 0; x < view_.size.x; x++) inverse_.push_back(inverse_of(raw_[index_of(view_, x, y)], x, y));
    for (std::size_t i = 0; i < weights_.size(); i++)
      weights_[i] = std::exp(-0.5 * double(i * i) / (kSpread * kSpread));
    is_ramp_.resize(raw.size());
    steepness_.resize(raw.size());
  }

  void cut() {
    for_each_ramp([&](const PictureLine& line, const Ramp& ramp, std::size_t) {
      for (std::size_t i = ramp.first + 1; i < ramp.last; i++) is_ramp_[line.place(i)] = true;
    });
    // The ends within other ramps are cut by then.
    for (const bool has_cut_ends : {false, true})
      for_each_ramp([&](const auto&... ramp) { cut_ramp(ramp..., has_cut_ends); });
    std::ranges::copy(cut_, raw_.begin());
  }

 private:
  double ray_at(int x, int y) const { return map_.along_ray ? ray_length(view_, x, y) : 1; }
  float inverse_of(float value, int x, int y) const {
    return float(1 / planar_depth(map_, {value, 0, 0}, ray_at(x, y)));
  }

  void for_each_ramp(const auto& take) const {
    const auto width = std::size_t(view_.size.x), height = std::size_t(view_.size.y);
    for (std::size_t y = 0; y < height; y++) take_line({y * width, 1, line_of(y * width, 1, width)}, take);
    for (std::size_t x = 0; x < width; x++) take_line({x, width, line_of(x, width, height)}, take);
  }

  Line line_of(std::size_t first, std::size_t stride, std::size_t count) const {
    Line line;
    line.raw.resize(count);
    line.inverse.resize(count);
    for (std::size_t i = 0; i < count; i++) {
      line.raw[i] = raw_[first + i * stride];
      line.inverse[i] = inverse_[first + i * stride];
    }
    return line;
  }

  /// Takes the widened ramps of a line.
  void take_line(const PictureLine& line, const auto& take) const {
    const auto ramps = ramps_in(line.values.inverse, line.values.raw);
    const auto rises = [&](const Ramp& ramp) { return line.values.raw[ramp.last] > line.values.raw[ramp.first]; };
    for (std::size_t i = 0; i < ramps.size(); i++) {
      // Not beyond the crest of a wire.
      const bool turns_before = i > 0 && rises(ramps[i - 1]) != rises(ramps[i]);
      const bool turns_behind = i + 1 < ramps.size() && rises(ramps[i + 1]) != rises(ramps[i]);
      const std::size_t least = turns_before ? ramps[i - 1].last : 1;
      const std::size_t most = turns_behind ? ramps[i + 1].first : line.values.size() - 2;
      if (const auto middle = middle_of(line, ramps[i]))
        take(line, widened(line.values.inverse, ramps[i], least, most), *middle);
    }
  }

  /// The first pixel of the surface at the ramp's end: by raw values, or by 1/z where these have their half at one end.
  /// None: at an end both have it. Before a rounded outline the surface itself turns away, and the step is the end.
  static std::optional<std::size_t> middle_of(const PictureLine& line, const Ramp& ramp) {
    const Line& values = line.values;
    const bool is_last_nearer = values.inverse[ramp.last] > values.inverse[ramp.first];
    for (const bool is_raw : {true, false}) {
      const auto value = [&](std::size_t i) { return is_raw ? double(values.raw[i]) : values.inverse[i]; };
      const double from = value(ramp.first), to = value(ramp.last);
      std::size_t i = ramp.first + 1;
      for (; i < ramp.last; i++) {
        const double before = std::abs(value(i) - from), behind = std::abs(value(i) - to);
        if (before > behind || (before == behind && is_last_nearer)) break;
      }
      const double where = (double(i - ramp.first) - 0.5) / double(ramp.last - ramp.first);
      if (std::abs(where - 0.5) <= kMiddle) return i;
    }
    return std::nullopt;
  }

  static Ramp widened(std::span<const double> u, Ramp ramp, std::size_t least, std::size_t most) {
    const double from = u[ramp.first], to = u[ramp.last], far = kSame * std::abs(to - from);
    const auto tail = std::size_t(std::lround(kTail * double(ramp.last - ramp.first)));
    for (std::size_t i = 0; i < tail && ramp.first > least && std::abs(u[ramp.first - 1] - from) <= far; i++)
      ramp.first--;
    for (std::size_t i = 0; i < tail && ramp.last < most && std::abs(u[ramp.last + 1] - to) <= far; i++) ramp.last++;
    return ramp;
  }

  void cut_ramp(const PictureLine& line, const Ramp& ramp, std::size_t middle, bool has_cut_ends) {
    const double change = std::abs(line.values.inverse[ramp.last] - line.values.inverse[ramp.first]);
    const auto steepness = float(change / double(ramp.last - ramp.first));
    for (const bool is_last : {false, true}) {
      const std::size_t end = line.place(is_last ? ramp.last : ramp.first);
      if (is_ramp_[end] != has_cut_ends) continue;
      std::optional<Plane> plane;
      for (std::size_t i = is_last ? middle : ramp.first + 1; i < (is_last ? ramp.last : middle); i++) {
        const std::size_t at = line.place(i);
        if (steepness_[at] >= steepness) continue;  // that of another line is steeper
        steepness_[at] = steepness;
        if (!plane) plane = plane_about(end, kSame * change);
        cut_[at] = value_of(*plane, at, end, change);
      }
    }
  }

  int x_of(std::size_t at) const { return int(at % std::size_t(view_.size.x)); }
  int y_of(std::size_t at) const { return int(at / std::size_t(view_.size.x)); }

  Plane plane_about(std::size_t end, double same) const {
    const int x = x_of(end), y = y_of(end);
    const double u = inverse_of(cut_[end], x, y);
    double all = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sv = 0, sxv = 0, syv = 0;
    for (int dy = std::max(-kReach, -y); dy <= std::min(kReach, view_.size.y - 1 - y); dy++)
      for (int dx = std::max(-kReach, -x); dx <= std::min(kReach, view_.size.x - 1 - x); dx++) {
        const std::size_t i = index_of(view_, x + dx, y + dy);
        if (is_ramp_[i] || std::abs(inverse_[i] - u) > same) continue;
        const double weight = weights_[std::size_t(std::abs(dx))] * weights_[std::size_t(std::abs(dy))];
        const double v = inverse_[i] - u;
        all += weight, sx += weight * dx, sy += weight * dy, sv += weight * v;
        sxx += weight * dx * dx, sxy += weight * dx * dy, syy += weight * dy * dy;
        sxv += weight * dx * v, syv += weight * dy * v;
      }
    if (!(all > 0)) return {u};
    const double mx = sx / all, my = sy / all, mv = sv / all;
    const double xx = sxx / all - mx * mx + kRidge, yy = syy / all - my * my + kRidge, xy = sxy / all - mx * my;
    const double xv = sxv / all - mx * mv, yv = syv / all - my * mv, whole = xx * yy - xy * xy;
    const double across = (xv * yy - yv * xy) / whole, down = (yv * xx - xv * xy) / whole;
    return {u + mv - across * mx - down * my, across, down};
  }

  /// The raw value on a plane; that of the ramp's end where there is none.
  float value_of(const Plane& plane, std::size_t at, std::size_t end, double change) const {
    const double u = plane.value + plane.across * (x_of(at) - x_of(end)) + plane.down * (y_of(at) - y_of(end));
    const float at_end = inverse_of(cut_[end], x_of(end), y_of(end));
    if (at_end == 0 || !(u > 0 && std::abs(u - at_end) < 0.5 * change)) return cut_[end];
    return float(raw_of(map_, 1 / u, ray_at(x_of(at), y_of(at))));
  }

  std::array<double, kReach + 1> weights_;
  const DepthMap map_;
  const View view_;
  const std::span<float> raw_;
  std::vector<float> cut_, inverse_;  // raw values as they are to be; 1/z, 0 of the sky
  std::vector<float> steepness_;      // of the ramp that gave the pixel its value, 1/z by pixel
  std::vector<bool> is_ramp_;
};

}  // namespace

void cut_ramps(const Reading& reading, std::span<float> depth) {
  if (!reading.cuts_ramps) return;
  if (reading.depth_kind == DepthKind::position)
    fail(ErrorKind::usage, "--set ramps=cut is for depth, and these are positions: name a depth (--depth-channel)");
  RampCutter(reading, depth).cut();
}

std::vector<float> with_ramps_cut(const Reading& reading, std::span<const float> depth) {
  if (!reading.cuts_ramps) return {};
  std::vector<float> cut(depth.begin(), depth.end());
  cut_ramps(reading, cut);
  return cut;
}

}  // namespace alcove
