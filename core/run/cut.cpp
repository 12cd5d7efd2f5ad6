// Counts on a grid of pixels where frames agree and where they contradict each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/cut.h"

#include <cmath>

namespace alcove {
namespace {

constexpr int kGridColumns = 32, kGridRows = 18;  // of the grid
constexpr double kSameWidths = 3;                 // pixels' widths by which depths of one surface differ at most
constexpr double kSamePrecisions = 4;             // the same, of what depths may be off: see reprojection.glsl

struct Agreement {
  int same = 0, past = 0;  // of the grid's pixels
};

double depth_error_at(const EstimatedFrame& frame, double z) {
  const vec3& error = frame.depth_precision;
  return error.x + z * (error.y + z * double(error.z));
}

double depth_at(const EstimatedFrame& frame, int x, int y) {
  return std::abs(double(frame.depth[std::size_t(y) * std::size_t(frame.view.size.x) + std::size_t(x)]));
}

/// Where `to` sees what is at a pixel of `from`: it sees the same in one of three by three pixels, or past it in all.
void look(const EstimatedFrame& from, const EstimatedFrame& to, const ViewMap& map, int x, int y, Agreement& seen) {
  const double z = depth_at(from, x, y);
  if (z >= double(kSkyDepth)) return;
  const View &a = from.view, &b = to.view;
  const double scale = a.orthographic != 0 ? 1 : z;
  const std::array<double, 3> here{(x + 0.5 - double(a.center.x)) * double(a.tangent_per_pixel.x) * scale,
                                   (y + 0.5 - double(a.center.y)) * double(a.tangent_per_pixel.y) * scale, -z};
  std::array<double, 3> there{};
  for (std::size_t i = 0; i < 3; i++)
    there[i] = map[i][0] * here[0] + map[i][1] * here[1] + map[i][2] * here[2] + map[i][3];
  const double distance = -there[2], width = double(b.tangent_per_pixel.x) * (b.orthographic != 0 ? 1 : distance);
  if (distance <= 0) return;
  const double right = there[0] / (b.orthographic != 0 ? 1 : distance) / double(b.tangent_per_pixel.x);
  const double down = there[1] / (b.orthographic != 0 ? 1 : distance) / double(b.tangent_per_pixel.y);
  const double column = std::floor(right + double(b.center.x)), row = std::floor(down + double(b.center.y));
  if (!(column >= 1 && row >= 1 && column < b.size.x - 1 && row < b.size.y - 1)) return;
  const double margin =
      kSameWidths * width + kSamePrecisions * (depth_error_at(from, z) + depth_error_at(to, distance));
  bool same = false, past = true;
  for (int j = int(row) - 1; j <= int(row) + 1; j++)
    for (int i = int(column) - 1; i <= int(column) + 1; i++) {
      const double farther = depth_at(to, i, j) - distance;
      same = same || std::abs(farther) <= margin;
      past = past && farther > margin;
    }
  seen.same += same;
  seen.past += past;
}

/// What `to` sees of `from`.
void look(const EstimatedFrame& from, const EstimatedFrame& to, Agreement& seen) {
  const ViewMap map = view_from_view(to.camera, from.camera);
  for (int j = 0; j < kGridRows; j++)
    for (int i = 0; i < kGridColumns; i++)
      look(from, to, map, (2 * i + 1) * from.view.size.x / (2 * kGridColumns),
           (2 * j + 1) * from.view.size.y / (2 * kGridRows), seen);
}

}  // namespace

bool is_cut_between(const EstimatedFrame& a, const EstimatedFrame& b) {
  Agreement seen;
  look(a, b, seen);
  look(b, a, seen);
  return seen.past > seen.same;
}

}  // namespace alcove
