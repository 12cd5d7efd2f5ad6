// Puts the report's JSON and pictures into the page that the build has made of report/.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/report.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/formats/png.h"

namespace alcove {
namespace {

constexpr std::string_view kJsonMark = "{{report.json}}";

std::string base64(std::span<const char> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; k++)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; k++) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace

std::string url_of_png(std::span<const char> png) { return "data:image/png;base64," + base64(png); }

std::string report_page(const std::string& json) {
  const std::string_view page = report_template();
  const std::size_t mark = page.find(kJsonMark);
  std::string text(page.substr(0, mark));
  // In JSON a '<' can only stand inside a string. Escaped, neither "</script>" nor "<!--" can end or change the block
  // it is in.
  for (const char c : json) c == '<' ? text += "\\u003c" : text += c;
  text += page.substr(mark + kJsonMark.size());
  return text;
}

std::string picture_url(int width, int height, int channels, std::span<const float> values) {
  return url_of_png(encode_png("picture", width, height, channels, values));
}

std::string error_png(int width, int height, std::span<const float> result, std::span<const float> reference,
                      float full) {
  std::vector<float> rgb;
  rgb.reserve(3 * result.size());
  for (std::size_t i = 0; i < result.size(); i++) {
    const float error = (result[i] - reference[i]) / full;
    const float size = std::min(1.0f, std::abs(error));
    if (!std::isfinite(error)) rgb.insert(rgb.end(), {0.5f, 0.5f, 0.5f});
    // a blue of (0.13, 0.4, 0.67) at full size
    else if (error < 0)
      rgb.insert(rgb.end(), {1 - 0.87f * size, 1 - 0.6f * size, 1 - 0.33f * size});
    // a red of (0.7, 0.09, 0.17) at full size
    else
      rgb.insert(rgb.end(), {1 - 0.3f * size, 1 - 0.91f * size, 1 - 0.83f * size});
  }
  const auto bytes = encode_png("picture", width, height, 3, rgb);
  return {bytes.begin(), bytes.end()};
}

}  // namespace alcove
