// The usual alterations of pictures, each undone.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/altered_normals.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/frame/evidence.h"
#include "core/frame/sampling.h"

namespace alcove {
namespace {

/// Of so many normals undoing the alteration must make vectors.
constexpr double kProven = 0.9;

// The curve of sRGB, which goes on below 0 with the other sign.
double linear_of(double v) {
  const double a = std::abs(v);
  return std::copysign(a <= 0.04045 ? a / 12.92 : std::pow((a + 0.055) / 1.055, 2.4), v);
}
double curved_of(double v) {
  const double a = std::abs(v);
  return std::copysign(a <= 0.0031308 ? a * 12.92 : 1.055 * std::pow(a, 1 / 2.4) - 0.055, v);
}

/// Every so many pixels of planes.
std::vector<float> sparse(std::span<const float> planes, std::size_t pixels) {
  std::vector<float> some;
  for (std::size_t plane = 0; plane < planes.size(); plane += pixels)
    for (std::size_t i = 0; i < pixels; i += kSparse) some.push_back(planes[plane + i]);
  return some;
}

}  // namespace

std::optional<std::string> alteration_of(std::span<const float> normal, std::span<const float> raw,
                                         const DepthMap& map) {
  const std::size_t pixels = normal.size() / 3;
  const std::vector<float> some = sparse(normal, pixels), depth = sparse(raw, pixels);
  const auto with = [&](const auto& undo) {
    std::vector<float> undone(some.size());
    for (std::size_t i = 0; i < some.size(); i++) undone[i] = float(undo(some[i]));
    return normal_statistics(undone, depth, map);
  };
  const auto curve = [&](const NormalStatistics& s, const char* way) -> std::optional<std::string> {
    if (s.unorm_unit_share > kProven) return fmt::format("0.5 + 0.5 n that was converted {}", way);
    if (s.unit_share > kProven) return fmt::format("vectors that were converted {}", way);
    return std::nullopt;
  };
  if (auto found = curve(with(curved_of), "from sRGB to linear, as colours are")) return found;
  if (auto found = curve(with(linear_of), "from linear to sRGB, as colours are")) return found;
  for (const double exposure : {0.25, 0.5, 2.0, 4.0})
    if (with([&](double v) { return v / exposure; }).unorm_unit_share > kProven)
      return fmt::format("0.5 + 0.5 n times {}", exposure);
  return std::nullopt;
}

}  // namespace alcove
