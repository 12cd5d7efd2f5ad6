// Facts of settings, each worked out in one place.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/estimator_facts.h"

#include <algorithm>

namespace alcove {
namespace {

/// Samples per pixel from which on a proof that tiles are open costs less than it saves: it costs as much as 6 of them,
/// and most frames are open in a tenth.
constexpr double kWorthProving = 48;

/// Of one radius, on average over the pixels of a surface.
double samples_of_a_radius(const EstimatorSettings& settings) {
  const double factor = double(settings.resolution);
  const double samples =
      settings.estimator == Estimator::crytek ? settings.samples : 2 * settings.slices * settings.steps;
  return samples / (factor * factor * stride_of(settings));
}

}  // namespace

std::vector<double> radii_of(const EstimatorSettings& settings) {
  std::vector<double> radii = settings.further_radii;
  radii.push_back(settings.radius.value());
  std::ranges::sort(radii);
  return radii;
}

bool searches_exactly(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::gtao && (settings.search != SliceSearch::steps || settings.tolerance > 0);
}

bool searches_slices(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::gtao || settings.estimator == Estimator::bitmask;
}

bool completes(const EstimatorSettings& settings) {
  return searches_slices(settings) && settings.complete == Completion::all &&
         settings.thickness != ThicknessKind::infinite;
}

bool completes_anywhere(const EstimatorSettings& settings) {
  return searches_slices(settings) && settings.complete != Completion::none;
}

int stride_of(const EstimatorSettings& settings) {
  if (searches_exactly(settings)) return 1;
  if (settings.stride > 0) return settings.stride;
  const bool is_shared =
      settings.denoise == Denoise::bilateral && settings.resolution == Resolution::full && settings.slices <= 2;
  return is_shared && settings.estimator == Estimator::gtao ? 4 : 1;
}

bool proves(const EstimatorSettings& settings) {
  return !settings.no_skip && !searches_exactly(settings) &&
         (settings.skip_tolerance > 0 || samples_of_a_radius(settings) >= kWorthProving);
}

double samples_per_pixel(const EstimatorSettings& settings) {
  return searches_exactly(settings) ? 0 : samples_of_a_radius(settings) * double(1 + settings.further_radii.size());
}

bool shapes(const EstimatorSettings& settings) {
  return settings.intensity != 1 || settings.power != 1 || settings.fade_end;
}

}  // namespace alcove
