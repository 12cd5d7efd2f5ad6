// Samples to surfaces, by the rules of OpenEXR's document "Interpreting OpenEXR Deep Pixels".
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/deep_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace alcove {
namespace {

constexpr std::size_t kFewSamples = 32;  // so few are sorted fastest by insertion
constexpr float kOpaque = 0.999F;        // counts as opaque, since half floats round
constexpr double kRounding = 1e-6;       // of a body's opacity, whether or not it is cut in pieces
constexpr double kFewest = 1e-12;        // the least transmittance that differs from none

bool is_volume(const DeepSample& sample) { return sample.back > sample.front; }

/// A total order, so that results do not depend on the order of storage.
bool is_before(const DeepSample& a, const DeepSample& b) {
  return std::tie(a.front, a.back, a.opacity) < std::tie(b.front, b.back, b.opacity);
}

void sort(std::span<DeepSample> samples) {
  if (samples.size() > kFewSamples) {
    std::ranges::sort(samples, is_before);
    return;
  }
  for (std::size_t i = 1; i < samples.size(); i++) {
    const DeepSample sample = samples[i];
    std::size_t at = i;
    for (; at > 0 && is_before(sample, samples[at - 1]); at--) samples[at] = samples[at - 1];
    samples[at] = sample;
  }
}

/// The optical density of a sample: opacities multiply, densities add.
double density_of(const DeepSample& sample) { return -std::log(std::max(kFewest, 1.0 - double(sample.opacity))); }

}  // namespace

void DeepCounts::add(const DeepCounts& other) {
  pixels += other.pixels;
  samples += other.samples;
  most = std::max(most, other.most);
  volumes += other.volumes;
  covered += other.covered;
  repaired += other.repaired;
  dropped += other.dropped;
}

double DeepPixel::reach(double z) const {
  return z + rules_.separation[0] + z * (rules_.separation[1] + z * rules_.separation[2]);
}

/// Gives the samples that may be surfaces: those at the eye, at no depth, or beyond all skies are left out.
std::span<DeepSample> DeepPixel::repair(std::span<DeepSample> samples, DeepCounts& counts) {
  std::size_t kept = 0;
  for (DeepSample sample : samples) {
    if (!(sample.opacity >= 0 && sample.opacity <= 1 && sample.front >= 0)) {
      counts.repaired++;
      sample.opacity = sample.opacity > 1 ? 1.0F : sample.opacity >= 0 ? sample.opacity : 0.0F;
    }
    if (!(sample.front > 0 && sample.front < kNoDeepSurface)) continue;
    sample.back = sample.back > sample.front ? std::min(sample.back, kNoDeepSurface) : sample.front;
    samples[kept++] = sample;
  }
  return samples.first(kept);
}

void DeepPixel::count_covered(std::span<const DeepSample> samples, DeepCounts& counts) const {
  double opaque = std::numeric_limits<double>::infinity();
  for (const auto& sample : samples) {
    if (sample.front > opaque) counts.covered++;
    if (sample.opacity >= kOpaque) opaque = std::min(opaque, reach(sample.front));
    if (is_volume(sample)) counts.volumes++;
  }
}

void DeepPixel::add_points(std::span<const DeepSample> samples) {
  for (std::size_t i = 0; i < samples.size();) {
    if (is_volume(samples[i])) {
      i++;
      continue;
    }
    const float front = samples[i].front;
    const double end = reach(front);
    double through = 1;
    for (; i < samples.size() && samples[i].front <= end; i++)
      if (!is_volume(samples[i])) through *= 1.0 - double(samples[i].opacity);
    if (1.0 - through >= rules_.opacity) found_.push_back({front, kNoDeepSurface});
  }
}

void DeepPixel::add_volumes(std::span<const DeepSample> samples) {
  volumes_.clear();
  float end = 0;
  for (const auto& sample : samples) {
    if (!is_volume(sample)) continue;
    if (!volumes_.empty() && sample.front > reach(end)) {
      add_body(volumes_, end);
      volumes_.clear();
      end = 0;
    }
    volumes_.push_back(sample);
    end = std::max(end, sample.back);
  }
  if (!volumes_.empty()) add_body(volumes_, end);
}

void DeepPixel::add_body(std::span<const DeepSample> volumes, float end) {
  const double threshold = -std::log(std::max(kFewest, 1.0 - rules_.opacity)) * (1 - kRounding);
  by_end_.assign(volumes.begin(), volumes.end());
  std::ranges::sort(by_end_, {}, &DeepSample::back);
  double density = 0, slope = 0, z = volumes[0].front;
  std::size_t open = 0, closed = 0;
  // Between two ends of volumes the density grows evenly.
  while (closed < by_end_.size()) {
    const bool opens = open < volumes.size() && volumes[open].front <= by_end_[closed].back;
    const DeepSample& sample = opens ? volumes[open] : by_end_[closed];
    const double next = opens ? sample.front : sample.back;
    const double reached = density + slope * (next - z);
    if (slope > 0 && reached >= threshold) {
      const double front = std::min(next, z + std::max(0.0, threshold - density) / slope);
      found_.push_back({float(front), float(front) < end ? end : kNoDeepSurface});
      return;
    }
    density = reached;
    z = next;
    (opens ? open : closed)++;
    // An opaque volume is opaque from its front on.
    if (opens && (sample.opacity >= 1 || threshold <= 0)) {
      found_.push_back({float(z), float(z) < end ? end : kNoDeepSurface});
      return;
    }
    const double change = density_of(sample) / (double(sample.back) - double(sample.front));
    slope = opens ? slope + change : std::max(0.0, slope - change);
  }
}

DeepSurfaces DeepPixel::surfaces(std::span<DeepSample> samples, DeepCounts& counts) {
  counts.pixels++;
  counts.samples += samples.size();
  counts.most = std::max(counts.most, std::uint64_t(samples.size()));
  samples = repair(samples, counts);
  sort(samples);
  const auto volumes = counts.volumes;
  count_covered(samples, counts);
  found_.clear();
  add_points(samples);
  if (counts.volumes > volumes) {
    add_volumes(samples);
    std::ranges::sort(found_, [](const Surface& a, const Surface& b) {
      return std::tie(a.front, a.back) < std::tie(b.front, b.back);
    });
  }
  DeepSurfaces surfaces;
  surfaces.front.fill(kNoDeepSurface);
  surfaces.back.fill(kNoDeepSurface);
  for (std::size_t i = 0; i < std::min(found_.size(), kMostDeepSurfaces); i++) {
    surfaces.front[i] = found_[i].front;
    surfaces.back[i] = found_[i].back;
  }
  if (found_.size() > kMostDeepSurfaces) counts.dropped += found_.size() - kMostDeepSurfaces;
  return surfaces;
}

}  // namespace alcove
