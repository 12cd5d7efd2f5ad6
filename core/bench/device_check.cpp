// A room with a ball, 64 x 64 pixels, and what presets make of it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/device_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <string_view>
#include <thread>

#include "core/chain/compute.h"

namespace alcove {
namespace {

constexpr int kSize = 64, kCell = 8, kCells = kSize / kCell;  // px, px, cells

/// For each of kCheckedPresets its values on lavapipe. device_check_test writes the file anew, see there.
constexpr std::string_view kStored[] = {
#include "core/bench/device_check_values.inc"
};

struct Hit {
  double depth;  // along a ray whose z is -1, which makes it planar
  std::array<double, 3> normal;
};

/// The nearest of three walls and a ball, in view space, on the ray (x, y, -1).
Hit hit_of(double x, double y) {
  Hit hit{4, {0, 0, 1}};
  if (y < 0 && -0.8 / y < hit.depth) hit = {-0.8 / y, {0, 1, 0}};
  if (x < 0 && -1.1 / x < hit.depth) hit = {-1.1 / x, {1, 0, 0}};
  constexpr double kX = 0.3, kY = -0.35, kZ = -3, kRadius = 0.45;
  const double a = x * x + y * y + 1, b = x * kX + y * kY - kZ;
  const double inside = b * b - a * (kX * kX + kY * kY + kZ * kZ - kRadius * kRadius);
  if (inside <= 0) return hit;
  const double t = (b - std::sqrt(inside)) / a;
  if (t < hit.depth) hit = {t, {(t * x - kX) / kRadius, (t * y - kY) / kRadius, (-t - kZ) / kRadius}};
  return hit;
}

HostFrame room() {
  constexpr std::size_t kPixels = kSize * kSize;
  HostFrame frame;
  frame.data = frame.display = {0, 0, kSize, kSize};
  frame.camera.width = frame.camera.height = kSize;
  frame.camera.fx = frame.camera.fy = kSize;
  frame.camera.cx = frame.camera.cy = kSize / 2.;
  frame.depth.resize(kPixels);
  frame.normal.resize(3 * kPixels);
  for (std::size_t i = 0; i < kPixels; i++) {
    const double x = double(i % kSize) + 0.5, y = double(i / kSize) + 0.5;
    const Hit hit = hit_of((x - frame.camera.cx) / kSize, (frame.camera.cy - y) / kSize);
    frame.depth[i] = float(hit.depth);
    for (std::size_t c = 0; c < 3; c++) frame.normal[i + c * kPixels] = float(hit.normal[c]);
  }
  return frame;
}

}  // namespace

std::vector<double> check_values(gpu::Recorder& gpu, const EstimatorSettings& settings) {
  EstimatorSettings with_radius = settings;
  with_radius.radius = 0.8;
  const std::vector<float> ao = compute_ao(gpu, room(), with_radius).ao;
  std::vector<double> means(kCells * kCells);
  for (std::size_t i = 0; i < ao.size(); i++)
    means[i / kSize / kCell * kCells + i % kSize / kCell] += double(ao[i]) / (kCell * kCell);
  return means;
}

double deviation(const std::string& preset, const std::vector<double>& values) {
  const auto known = std::ranges::find(kCheckedPresets, preset);
  const std::string stored(kStored[known - std::begin(kCheckedPresets)]);
  double squares = 0;
  for (std::size_t i = 0; i < values.size(); i++)
    squares += std::pow(values[i] - std::stoi(stored.substr(4 * i, 4), nullptr, 16) / kStoredOne, 2);
  return std::sqrt(squares / double(values.size()));  // of NaN NaN, which is no small deviation
}

std::optional<std::vector<double>> values_within(std::chrono::milliseconds time,
                                                 std::function<std::vector<double>()> work) {
  std::packaged_task<std::vector<double>()> task(std::move(work));
  std::future<std::vector<double>> values = task.get_future();
  std::thread(std::move(task)).detach();
  if (values.wait_for(time) != std::future_status::ready) return std::nullopt;
  return values.get();
}

}  // namespace alcove
