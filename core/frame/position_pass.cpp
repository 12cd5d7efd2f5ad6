// Finds a pass of positions, and picks points of it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/position_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <utility>

namespace alcove {
namespace {

constexpr int kColumns = 48;
constexpr int kRows = 8;  // of a place

/// A surface bends less from pixel to pixel, as part of the step; more where a filter has put two together.
constexpr double kMostBend = 0.1;

/// Rows of a pass.
struct Band {
  Window window;
  std::array<std::vector<float>, 3> planes;

  Vector3 at(int x, int y) const {
    const auto i = std::size_t(y - window.y) * std::size_t(window.width) + std::size_t(x - window.x);
    return {planes[0][i], planes[1][i], planes[2][i]};
  }
};

bool is_surface(const Vector3& p, double sky) { return dot(p, p) > 0 && dot(p, p) < sky * sky; }

/// How much the steps to two pixels on both sides differ, relative to them; infinite where one is none.
double bend(const Vector3& before, const Vector3& here, const Vector3& after) {
  const double step = length(difference(after, before));
  const Vector3 second = difference(difference(after, here), difference(here, before));
  return step > 0 ? length(second) / step : std::numeric_limits<double>::infinity();
}

/// How little the surface about a pixel is a plane; infinite where it shows none.
double roughness(const Band& band, int x, int y, double sky) {
  const Vector3 here = band.at(x, y);
  const std::array<Vector3, 4> about{band.at(x - 1, y), band.at(x + 1, y), band.at(x, y - 1), band.at(x, y + 1)};
  const bool shows =
      is_surface(here, sky) && std::ranges::all_of(about, [&](const Vector3& p) { return is_surface(p, sky); });
  if (!shows) return std::numeric_limits<double>::infinity();
  return std::max(bend(about[0], here, about[1]), bend(about[2], here, about[3]));
}

/// A pixel of a cell that shows a smooth surface; any of them, since the smoothest are all of walls. Else the
/// smoothest.
std::optional<std::pair<int, int>> place_in(const Band& band, const Window& cell, double sky, std::mt19937& random) {
  std::vector<std::pair<int, int>> smooth;
  std::optional<std::pair<int, int>> best;
  double least = std::numeric_limits<double>::infinity();
  const Window& whole = band.window;
  for (int y = std::max(cell.y, whole.y + 1); y < std::min(cell.y + cell.height, whole.y + whole.height - 1); y++)
    for (int x = std::max(cell.x, whole.x + 1); x < std::min(cell.x + cell.width, whole.x + whole.width - 1); x++) {
      const double rough = roughness(band, x, y, sky);
      if (rough < kMostBend) smooth.emplace_back(x, y);
      if (rough < least) least = rough, best = {x, y};
    }
  return smooth.empty() ? best : smooth[random() % smooth.size()];
}

/// How far a point may be from its pixel because its numbers are rounded, px.
double rounding_at(const Band& band, int x, int y, double relative) {
  const double across = length(difference(band.at(x + 1, y), band.at(x - 1, y)));
  const double down = length(difference(band.at(x, y + 1), band.at(x, y - 1)));
  return relative * length(band.at(x, y)) / (0.5 * std::min(across, down));
}

}  // namespace

std::vector<ChannelRef> find_positions(const ChannelSearch& search, const FrameSource& source,
                                       const InputSettings& settings) {
  const auto& depth = source[RawPlane::depth];
  if (depth.size() == 3) return depth;
  const std::size_t file = depth.front().file;
  auto found = search.find_by_rules(file, kPositionNames, settings.position_channels, source.rules->position).channels;
  if (found.empty()) found = search.find(file, kPositionNames, settings.position_channels, false);
  const auto fits = [&](const ChannelRef& ref) {
    return source.part_of(ref).data == source.part_of(found.front()).data;
  };
  return std::ranges::all_of(found, fits) ? found : std::vector<ChannelRef>{};
}

std::vector<SeenPoint> points_of(ExrFile& file, const std::vector<ChannelRef>& positions, double sky, int bands) {
  const ExrPart& part = file.parts()[std::size_t(positions.front().part)];
  const Window& data = part.data;
  const auto is_half = [&](const ChannelRef& ref) {
    const auto found = std::ranges::find(part.channels, ref.channel, &ExrChannel::name);
    return found != part.channels.end() && found->type == SampleType::half_float;
  };
  const double relative = std::ranges::any_of(positions, is_half) ? 0x1p-11 : 0x1p-24;
  const int together = std::max(part.rows_together, 1);
  const int rows = (kRows + together - 1) / together * together;
  const int step = std::max(rows, data.height / bands / together * together);
  const Window& display = file.display();
  std::mt19937 random(1);  // the same frame has the same points
  std::vector<SeenPoint> points;
  for (int top = 0; top < data.height; top += step) {
    Band band{{data.x, data.y + top, data.width, std::min(rows, data.height - top)}, {}};
    std::vector<ExrRead> reads;
    for (std::size_t k = 0; k < 3; k++) {
      band.planes[k].resize(band.window.pixels());
      reads.push_back({positions[k].part, positions[k].channel, band.planes[k].data()});
    }
    file.read(reads, top, band.window.height);
    for (int first = band.window.y; first < band.window.y + band.window.height; first += kRows)
      for (int column = 0; column < kColumns; column++) {
        const int left = int(std::int64_t(data.width) * column / kColumns);
        const int right = int(std::int64_t(data.width) * (column + 1) / kColumns);
        const Window cell{data.x + left, first, right - left, kRows};
        const auto place = place_in(band, cell, sky, random);
        if (!place) continue;
        const auto [x, y] = *place;
        points.push_back({band.at(x, y), x + 0.5 - display.x, y + 0.5 - display.y, rounding_at(band, x, y, relative)});
      }
  }
  return points;
}

}  // namespace alcove
