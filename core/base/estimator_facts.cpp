// Facts of settings, each worked out in one place.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/estimator_facts.h"

#include <algorithm>

namespace alcove {
namespace {

/// From so many slices on an estimate is meant to be better than what fewer pixels can tell.
constexpr int kManySlices = 5;

double samples_of_a_radius(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::crytek ? settings.samples : 2 * settings.slices * settings.steps;
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

int spacing_of(const EstimatorSettings& settings) {
  if (searches_exactly(settings)) return 1;
  if (settings.stride > 0) return settings.stride;
  if (settings.denoise != Denoise::bilateral || settings.resolution != Resolution::full) return 1;
  if (settings.density == Density::adaptive && searches_slices(settings)) return settings.slices < kManySlices ? 16 : 2;
  return settings.slices <= 2 && settings.estimator == Estimator::gtao ? 4 : 1;
}

bool is_adaptive(const EstimatorSettings& settings) {
  return settings.density == Density::adaptive && searches_slices(settings) && spacing_of(settings) > 1;
}

int denoise_radius_of(const EstimatorSettings& settings) {
  if (settings.denoise_radius > 0) return settings.denoise_radius;
  return spacing_of(settings) > 1 ? 8 : 4;
}

int denoise_reach_of(const EstimatorSettings& settings) {
  // What has an estimated error is not mixed with its neighbours.
  if (settings.denoise == Denoise::none || settings.tolerance > 0) return 0;
  if (settings.denoise == Denoise::box) return 2;
  const auto& kernel = settings.denoise_kernel;
  const int radius = kernel.empty() ? denoise_radius_of(settings) : int(kernel.size()) - 1;
  if (spacing_of(settings) == 1) return radius;
  return std::max(radius, is_adaptive(settings) ? 3 : 8);
}

double samples_per_estimate(const EstimatorSettings& settings) {
  return searches_exactly(settings) ? 0 : samples_of_a_radius(settings) * double(1 + settings.further_radii.size());
}

EstimatorSettings bracket_of(const EstimatorSettings& settings) {
  EstimatorSettings bracket = settings;
  bracket.estimator = Estimator::gtao;
  bracket.search = SliceSearch::steps;
  bracket.tolerance = 0;
  bracket.resolution = Resolution::full;
  return bracket;
}

bool shapes(const EstimatorSettings& settings) {
  return settings.intensity != 1 || settings.power != 1 || settings.fade_end;
}

}  // namespace alcove
