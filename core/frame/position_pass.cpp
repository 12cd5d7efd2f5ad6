// Finds a pass of positions, and picks points of it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/position_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace alcove {
namespace {

constexpr int kBands = 48, kColumns = 48;
constexpr int kLeastRows = 8;  // of a band

using Vec3 = std::array<double, 3>;

/// Rows of a pass.
struct Band {
  Window window;
  std::array<std::vector<float>, 3> planes;

  Vec3 at(int x, int y) const {
    const auto i = std::size_t(y - window.y) * std::size_t(window.width) + std::size_t(x - window.x);
    return {planes[0][i], planes[1][i], planes[2][i]};
  }
};

double squared(const Vec3& p) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2]; }

bool is_surface(const Vec3& p, double sky) { return squared(p) > 0 && squared(p) < sky * sky; }

/// How much the steps to two pixels on both sides differ, relative to them; infinite where one is none.
double bend(const Vec3& before, const Vec3& here, const Vec3& after) {
  Vec3 second{}, first{};
  for (std::size_t k = 0; k < 3; k++) {
    second[k] = before[k] + after[k] - 2 * here[k];
    first[k] = after[k] - before[k];
  }
  const double step = squared(first);
  return step > 0 ? std::sqrt(squared(second) / step) : std::numeric_limits<double>::infinity();
}

/// How little the surface about a pixel is a plane; infinite where it shows none.
double roughness(const Band& band, int x, int y, double sky) {
  const Vec3 here = band.at(x, y);
  const std::array<Vec3, 4> about{band.at(x - 1, y), band.at(x + 1, y), band.at(x, y - 1), band.at(x, y + 1)};
  const bool shows =
      is_surface(here, sky) && std::ranges::all_of(about, [&](const Vec3& p) { return is_surface(p, sky); });
  if (!shows) return std::numeric_limits<double>::infinity();
  return std::max(bend(about[0], here, about[1]), bend(about[2], here, about[3]));
}

/// How far a point may be from its pixel because its numbers are rounded, px: as far as the pixels about it are apart.
double rounding_at(const Band& band, int x, int y, double relative) {
  const Vec3 here = band.at(x, y), beside = band.at(x + 1, y), below = band.at(x, y + 1);
  Vec3 across{}, down{};
  for (std::size_t k = 0; k < 3; k++) across[k] = beside[k] - here[k], down[k] = below[k] - here[k];
  const double pixel = std::sqrt(std::min(squared(across), squared(down)));
  return relative * std::sqrt(squared(here)) / pixel;
}

}  // namespace

std::vector<ChannelRef> find_positions(const ChannelSearch& search, const std::vector<ChannelRef>& depth,
                                       const InputSettings& settings) {
  if (depth.size() == 3) return depth;
  return search.find(depth.front().file, kPositionNames, settings.position_channels, false);
}

std::vector<SeenPoint> points_of(ExrFile& file, const std::vector<ChannelRef>& positions, double sky) {
  const ExrPart& part = file.parts()[std::size_t(positions.front().part)];
  const Window& data = part.data;
  const auto is_half = [&](const ChannelRef& ref) {
    const auto found = std::ranges::find(part.channels, ref.channel, &ExrChannel::name);
    return found != part.channels.end() && found->type == SampleType::half_float;
  };
  const double relative = std::ranges::any_of(positions, is_half) ? 0x1p-11 : 0x1p-24;
  const int together = std::max(part.rows_together, 1);
  const int rows = (kLeastRows + together - 1) / together * together;
  const int step = std::max(rows, data.height / kBands / together * together);
  std::vector<SeenPoint> points;
  for (int top = 0; top < data.height; top += step) {
    Band band{{data.x, data.y + top, data.width, std::min(rows, data.height - top)}, {}};
    std::vector<ExrRead> reads;
    for (std::size_t k = 0; k < 3; k++) {
      band.planes[k].resize(band.window.pixels());
      reads.push_back({positions[k].part, positions[k].channel, band.planes[k].data()});
    }
    file.read(reads, top, band.window.height);
    for (int column = 0; column < kColumns; column++) {
      const int left = data.x + 1 + int(std::int64_t(data.width - 2) * column / kColumns);
      const int right = data.x + 1 + int(std::int64_t(data.width - 2) * (column + 1) / kColumns);
      double least = std::numeric_limits<double>::infinity();
      int x = 0, y = 0;
      for (int v = band.window.y + 1; v + 1 < band.window.y + band.window.height; v++)
        for (int u = left; u < right; u++)
          if (const double rough = roughness(band, u, v, sky); rough < least) least = rough, x = u, y = v;
      if (std::isinf(least)) continue;
      const Window& display = file.display();
      points.push_back({band.at(x, y), x + 0.5 - display.x, y + 0.5 - display.y, rounding_at(band, x, y, relative)});
    }
  }
  return points;
}

}  // namespace alcove
