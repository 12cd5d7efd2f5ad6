// Projects a lat-long picture onto nine harmonics, and tells what they miss of it.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/picture.h"
#include "core/frame/find/lights.h"

namespace alcove {
namespace {

using Nine = std::array<double, 9>;

/// The real spherical harmonics of l <= 2, (0, 0), (1, -1), (1, 0) ... (2, 2).
Nine harmonics(double x, double y, double z) {
  const double linear = std::sqrt(3 / std::numbers::pi) / 2, mixed = std::sqrt(15 / std::numbers::pi) / 2;
  return {std::sqrt(1 / std::numbers::pi) / 2,
          linear * y,
          linear * z,
          linear * x,
          mixed * x * y,
          mixed * y * z,
          std::sqrt(5 / std::numbers::pi) / 4 * (3 * z * z - 1),
          mixed * x * z,
          mixed / 2 * (x * x - y * y)};
}

/// Calls `take` with the index, the harmonics and the solid angle of every pixel.
template <class Take>
void for_pixels(int width, int height, const Take& take) {
  std::vector<double> cosines, sines;
  for (int i = 0; i < width; i++) {
    const double longitude = (0.5 - (i + 0.5) / width) * 2 * std::numbers::pi;
    cosines.push_back(std::cos(longitude));
    sines.push_back(std::sin(longitude));
  }
  for (int j = 0; j < height; j++) {
    const double top = (0.5 - double(j) / height) * std::numbers::pi,
                 bottom = (0.5 - (j + 1.0) / height) * std::numbers::pi;
    const double z = std::sin((top + bottom) / 2), aside = std::cos((top + bottom) / 2);
    const double angle = (std::sin(top) - std::sin(bottom)) * 2 * std::numbers::pi / width;
    for (int i = 0; i < width; i++)
      take(std::size_t(j) * std::size_t(width) + std::size_t(i),
           harmonics(aside * cosines[std::size_t(i)], aside * sines[std::size_t(i)], z), angle);
  }
}

}  // namespace

Environment environment_of(std::span<const float> planes, int width, int height) {
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  Environment result;
  double whole = 0, missed = 0;
  for_pixels(width, height, [&](std::size_t i, const Nine& y, double angle) {
    for (std::size_t c = 0; c < 3; c++) {
      const double light = angle * double(planes[c * pixels + i]);
      whole += light;
      for (std::size_t k = 0; k < y.size(); k++) result.light[k][c] += light * y[k];
    }
  });
  for_pixels(width, height, [&](std::size_t i, const Nine& y, double angle) {
    for (std::size_t c = 0; c < 3; c++) {
      double held = 0;
      for (std::size_t k = 0; k < y.size(); k++) held += result.light[k][c] * y[k];
      missed += angle * std::abs(double(planes[c * pixels + i]) - held);
    }
  });
  result.missed = whole > 0 ? std::min(1.0, missed / (2 * whole)) : 0;
  return result;
}

Environment read_environment(const std::string& path, const char* option) {
  const std::string name = lower_case(path);
  if (!name.ends_with(".exr") && !name.ends_with(".hdr"))
    fail(ErrorKind::input, "{}: a sky is linear light in more than 8 bits: {} takes an .exr or a Radiance .hdr", path,
         option);
  Picture picture(path, option);
  const std::array colors{picture.find("R", option), picture.find("G", option), picture.find("B", option)};
  const Window& window = picture.channels()[colors[0]].data;
  if (window.width != 2 * window.height)
    fail(ErrorKind::input, "{}: it has {} x {} pixels, and a lat-long sky is twice as wide as high ({})", path,
         window.width, window.height, option);
  const std::vector<float> planes = picture.read(colors);
  const auto bad = std::ranges::find_if(planes, [](float x) { return !(x >= 0 && std::isfinite(x)); });
  if (bad != planes.end())
    fail(ErrorKind::input, "{}: a pixel is {}, and light is finite and not below 0 ({})", path, *bad, option);
  return environment_of(planes, window.width, window.height);
}

bool is_sky_picture(const std::string& path) {
  try {
    const Picture picture(path, "INPUT");
    std::string names;
    for (const PictureChannel& channel : picture.channels()) names += channel.name + ' ';
    const Window& window = picture.display();
    return window.width == 2 * window.height &&
           (names == "R G B " || names == "R G B A " || names == "B G R " || names == "A B G R ");
  } catch (const Error&) {
    return false;
  }
}

std::string environment_json(const std::string& path, const Environment& environment) {
  return nlohmann::json{{"file", path}, {"sky", environment.light}, {"missed", environment.missed}}.dump(2) + "\n";
}

std::string environment_text(const std::string& path, const Environment& environment) {
  constexpr const char* kNames[] = {"T00", "T1-1", "T10", "T11", "T2-2", "T2-1", "T20", "T21", "T22"};
  std::string text = fmt::format("{}: a sky as nine colours, for --aov transfer\n", printable(path));
  std::array<std::string, 3> sums;
  for (std::size_t k = 0; k < 9; k++) {
    auto color = environment.light[k];
    for (double& x : color) x = std::round(1e6 * x) / 1e6 + 0.0;  // no -0
    text += fmt::format("  {:4}  {:9.6f} {:9.6f} {:9.6f}\n", kNames[k], color[0], color[1], color[2]);
    for (std::size_t c = 0; c < 3; c++)
      sums[c] += fmt::format("{}{:.6f}*transfer{}.{}", k > 0 ? " + " : "", color[c], k / 3, "XYZ"[k % 3]);
  }
  text += fmt::format("  they miss {:.0f} % of the light{}\n", 100 * environment.missed,
                      environment.missed > kMostMissed ? ": a sun needs a light of its own" : "");
  text += "for Nuke, beside the Read of the AO file:\n\nExpression {\n";
  for (std::size_t c = 0; c < 3; c++) text += fmt::format(" expr{} \"max(0, {})\"\n", c, sums[c]);
  return text + " name Relight\n}\n";
}

}  // namespace alcove
