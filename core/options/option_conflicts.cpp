// Why a setting has no effect: each looks at the settings that count, and says what of them is in the way.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/estimate/sites.h"
#include "core/chain/results/results.h"
#include "core/frame/find/input_rules.h"
#include "core/options/options.h"

namespace alcove {
namespace {

/// Such as "gtao or bitmask".
template <class T>
std::string words_of(std::initializer_list<T> values) {
  std::vector<std::string> words;
  for (const T value : values) words.push_back(word_of(value));
  return linked(words, "or");
}

/// "" where the value is one of them.
template <class T>
std::string unless_one_of(std::initializer_list<T> values, T value, const char* option) {
  if (std::ranges::find(values, value) != values.end()) return "";
  return fmt::format("it is for {} {}, and here that is {}", option, words_of(values), word_of(value));
}

/// Whether the run asks for an AOV. Names that there are not are refused where AOVs are made.
bool asks_for(const OutputSettings& output, const std::string& name) {
  const auto names = split(lower_case(output.aovs));
  return std::ranges::find(names, name) != names.end();
}

/// Whether the kind of depth is what the program writes that the settings name.
bool is_by_source(const InputSettings& input) {
  return input.depth_kind == DepthKind::automatic && input.source != "auto" && input.camera.empty();
}

/// What the settings say of the kind of depth; automatic where they leave it open, or to a camera file.
DepthKind said_kind(const InputSettings& input) {
  if (!input.position.empty() || !input.position_channels.empty()) return DepthKind::position;
  return is_by_source(input) ? input_rules(input.source).depth_kind : input.depth_kind;
}

/// The option that says it.
std::string who_says_kind(const InputSettings& input) {
  if (!input.position.empty()) return "--position";
  if (!input.position_channels.empty()) return "--set position-channels";
  return is_by_source(input) ? "--source " + input.source : "--depth-kind";
}

}  // namespace

std::string first_of(std::initializer_list<std::string> reasons) {
  const auto found = std::ranges::find_if_not(reasons, &std::string::empty);
  return found == reasons.end() ? "" : *found;
}

std::string unless_estimator(const Settings& settings, std::initializer_list<Estimator> estimators) {
  return unless_one_of(estimators, settings.estimator.estimator, "--estimator");
}

std::string unless_slices(const Settings& settings) {
  return unless_estimator(settings, {Estimator::gtao, Estimator::bitmask, Estimator::hbao});
}

std::string unless_ranges(const Settings& settings) {
  return unless_estimator(settings, {Estimator::gtao, Estimator::bitmask});
}

std::string if_exact(const Settings& settings) {
  const EstimatorSettings& estimator = settings.estimator;
  if (!searches_exactly(estimator)) return "";
  if (estimator.tolerance > 0) return "it is for --search steps, and with --tolerance the search is exact";
  return fmt::format("it is for --search steps, and here that is {}", word_of(estimator.search));
}

std::string if_by_error(const Settings& settings) {
  const EstimatorSettings& estimator = settings.estimator;
  if (estimator.estimator != Estimator::gtao || estimator.tolerance == 0) return "";
  return fmt::format("--tolerance {} decides how exact the estimate is", estimator.tolerance);
}

bool asks_for_confidence(const Settings& settings) { return asks_for(settings.output, "confidence"); }

bool asks_for_shadows(const Settings& settings) { return !settings.output.lights.empty(); }

std::string unless_ranges_anywhere(const Settings& settings) {
  return asks_for_shadows(settings) ? "" : unless_ranges(settings);
}

std::string unless_lights(const Settings& settings) { return unless_given(asks_for_shadows(settings), "--lights"); }

std::string unless_denoised(const Settings& settings, std::initializer_list<Denoise> kinds) {
  return unless_one_of(kinds, settings.estimator.denoise, "--denoise");
}

std::string unless_shared_estimates(const Settings& settings) {
  EstimatorSettings estimator = asks_for_confidence(settings) ? bracket_of(settings.estimator) : settings.estimator;
  for (const Density density : {Density::uniform, Density::adaptive}) {
    estimator.density = density;
    if (spacing_of(estimator) > 1) return "";
  }
  return "every pixel has its own estimate (--set stride=1 or no --denoise bilateral)";
}

std::string unless_depth(const Settings& settings, std::initializer_list<DepthKind> kinds) {
  const InputSettings& input = settings.input;
  const auto holds = [&](DepthKind kind) { return std::ranges::find(kinds, kind) != kinds.end(); };
  const DepthKind kind = said_kind(input);
  // Where a frame has no depth its positions are read, whatever depth the program writes elsewhere.
  if (kind == DepthKind::automatic || holds(kind) || (is_by_source(input) && holds(DepthKind::position))) return "";
  return fmt::format("it is for {} depth, and {} says {}", words_of(kinds), who_says_kind(input), word_of(kind));
}

std::string unless_aov(const Settings& settings, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (asks_for(settings.output, name)) return "";
  return fmt::format("it is for --aov {}", linked(std::vector<std::string>(names.begin(), names.end()), "or"));
}

std::string unless_composite(const Settings& settings) {
  return unless_given(!settings.output.composite.empty(), "--composite");
}

std::string unless_given(bool is_given, const std::string& option) {
  return is_given ? "" : fmt::format("there is no {}", option);
}

std::string if_given(bool is_given, const std::string& option, const std::string& why) {
  return is_given ? fmt::format("{} is given, and {}; give only one of them", option, why) : "";
}

}  // namespace alcove
