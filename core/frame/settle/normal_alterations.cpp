// Undoes what pictures go through.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/normal_alterations.h"

#include <fmt/format.h>
#include <cmath>
#include <vector>

#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

/// Undoing the alteration must make vectors of this share of the normals.
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

/// Neighbours belong to one surface if their normals differ by less, as they stand in the file.
constexpr double kSameNormal = 0.1;

/// Every so many pixels, of those that lie within a surface: a pixel filter shortens normals at edges only.
std::vector<std::size_t> within_surfaces(std::span<const float> normal, std::size_t width) {
  const std::size_t pixels = normal.size() / 3;
  const auto is_near = [&](std::size_t i, std::size_t k) {
    double squared = 0;
    for (const std::size_t plane : {std::size_t(0), pixels, 2 * pixels})
      squared += std::pow(double(normal[plane + i]) - normal[plane + k], 2);
    return squared < kSameNormal * kSameNormal;
  };
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < pixels; i += kSparse)
    if (i >= width && i + width < pixels && is_near(i, i - 1) && is_near(i, i + 1) && is_near(i, i - width) &&
        is_near(i, i + width))
      some.push_back(i);
  return some;
}

/// These pixels of planes.
std::vector<float> values_at(std::span<const float> planes, std::size_t pixels, const std::vector<std::size_t>& at) {
  std::vector<float> values;
  for (std::size_t plane = 0; plane < planes.size(); plane += pixels)
    for (const std::size_t i : at) values.push_back(planes[plane + i]);
  return values;
}

}  // namespace

std::optional<std::string> alteration_of(const RawPart& raw, const DepthMap& map) {
  const std::size_t pixels = raw.normal.size() / 3;
  const auto at = within_surfaces(raw.normal, std::size_t(raw.window.width));
  if (at.empty()) return std::nullopt;
  const std::vector<float> some = values_at(raw.normal, pixels, at), depth = values_at(raw.depth, pixels, at);
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
  const NormalStatistics unchanged = with([](double v) { return v; });
  if (std::max(unchanged.unit_share, unchanged.unorm_unit_share) > kProven) return std::nullopt;
  if (auto found = curve(with(curved_of), "from sRGB to linear, as colours are")) return found;
  if (auto found = curve(with(linear_of), "from linear to sRGB, as colours are")) return found;
  for (const double exposure : {0.25, 0.5, 2.0, 4.0})
    if (with([&](double v) { return v / exposure; }).unorm_unit_share > kProven)
      return fmt::format("0.5 + 0.5 n times {}", exposure);
  return std::nullopt;
}

}  // namespace alcove
