// Each condition as words and as a check of the settings.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/estimator_facts.h"
#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/frame/input_rules.h"

namespace alcove {
namespace {

template <class T>
std::string word_of(T value) {
  for (const auto& [word, meaning] : names_of<T>())
    if (meaning == value) return word;
  return "";
}

template <class T>
std::string words_of(const std::vector<T>& values) {
  std::vector<std::string> words;
  for (const T value : values) words.push_back(word_of(value));
  return linked(words, "or");
}

template <class T>
bool holds(const std::vector<T>& values, T value) {
  return std::ranges::find(values, value) != values.end();
}

/// Whether the run asks for an AOV. Names that there are not are refused where AOVs are made.
bool asks_for(const OutputSettings& output, const std::string& name) {
  return holds<std::string>(split(lower_case(output.aovs)), name);
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
  if (!input.position_channels.empty()) return "--position-channels";
  return is_by_source(input) ? "--source " + input.source : "--depth-kind";
}

/// Whether pixels share estimates at one density at least, so that the other one gives other pixels.
bool shares_estimates(EstimatorSettings settings) {
  return std::ranges::any_of(std::array{Density::uniform, Density::adaptive}, [&](Density density) {
    settings.density = density;
    return spacing_of(settings) > 1;
  });
}

}  // namespace

Condition to_estimators(std::initializer_list<Estimator> estimators) {
  const std::vector<Estimator> list(estimators);
  return {"to --estimator " + words_of(list), [list](const Settings& settings) {
            const Estimator estimator = settings.estimator.estimator;
            return holds(list, estimator) ? "" : "the estimator is " + word_of(estimator);
          }};
}

Condition to_steps() {
  return {"to --search steps", [](const Settings& settings) -> std::string {
            if (!searches_exactly(settings.estimator)) return "";
            return settings.estimator.tolerance > 0 ? "with --tolerance the search is exact"
                                                    : "the search is " + word_of(settings.estimator.search);
          }};
}

Condition without_tolerance() {
  return {"without --tolerance", [](const Settings& settings) {
            const auto& e = settings.estimator;
            const bool is_by_error = e.estimator == Estimator::gtao && e.tolerance > 0;
            return is_by_error ? fmt::format("the tolerance is {}", e.tolerance) : "";
          }};
}

Condition or_confidence(Condition condition) {
  condition.otherwise = "with --aov confidence";
  condition.instead = [instead = std::move(condition.instead)](const Settings& settings) {
    return asks_for(settings.output, "confidence") ? "" : instead(settings);
  };
  return condition;
}

Condition as_search(std::initializer_list<SliceSearch> searches, Condition condition) {
  const std::vector<SliceSearch> list(searches);
  condition.words = fmt::format("as {} {}", words_of(list), condition.words);
  condition.instead = [list, instead = std::move(condition.instead)](const Settings& settings) {
    return holds(list, settings.estimator.search) ? instead(settings) : "";
  };
  return condition;
}

Condition with_falloff() {
  return {"with a --falloff", [](const Settings& settings) {
            return settings.estimator.falloff == Falloff::none ? "the falloff is none" : "";
          }};
}

Condition with_denoise(std::initializer_list<Denoise> kinds) {
  const std::vector<Denoise> list(kinds);
  return {"with --denoise " + words_of(list), [list](const Settings& settings) {
            const Denoise denoise = settings.estimator.denoise;
            return holds(list, denoise) ? "" : "the denoiser is " + word_of(denoise);
          }};
}

Condition with_shared_estimates() {
  return {"with estimates that pixels share (--stride, --denoise bilateral)", [](const Settings& settings) {
            const bool brackets = asks_for(settings.output, "confidence");
            const auto estimator = brackets ? bracket_of(settings.estimator) : settings.estimator;
            return shares_estimates(estimator) ? "" : "every pixel has its own";
          }};
}

Condition to_depth(std::initializer_list<DepthKind> kinds) {
  const std::vector<DepthKind> list(kinds);
  return {fmt::format("to {} depth", words_of(list)), [list](const Settings& settings) {
            const DepthKind kind = said_kind(settings.input);
            // Where a frame has no depth its positions are read, whatever depth the program writes elsewhere.
            const bool may_be_position = is_by_source(settings.input) && holds(list, DepthKind::position);
            const bool may_apply = kind == DepthKind::automatic || holds(list, kind) || may_be_position;
            if (may_apply) return std::string();
            return fmt::format("the depth is said to be {} ({})", word_of(kind), who_says_kind(settings.input));
          }};
}

Condition where_depth_is_read() {
  return {"without --position and --position-channels", [](const Settings& settings) -> std::string {
            const InputSettings& input = settings.input;
            if (input.position.empty() && input.position_channels.empty()) return "";
            if (input.depth_kind == DepthKind::position) return "";
            return input.position.empty() ? "--position-channels is given" : "--position is given";
          }};
}

Condition with_option(const std::string& option, const std::function<bool(const Settings&)>& is_given) {
  return {"with " + option,
          [=](const Settings& settings) { return is_given(settings) ? "" : "there is no " + option; }};
}

Condition with_output(const std::string& words, const std::string& instead,
                      const std::function<bool(const OutputSettings&)>& wants) {
  return {words, [=](const Settings& settings) { return wants(settings.output) ? "" : instead; }, true};
}

Condition with_aovs(std::initializer_list<const char*> names) {
  const std::vector<std::string> list(names.begin(), names.end());
  const auto wants = [list](const OutputSettings& output) {
    return std::ranges::any_of(list, [&](const auto& name) { return asks_for(output, name); });
  };
  return with_output("with --aov " + linked(list, "or"), "OUTPUT has no " + linked(list, "or"), wants);
}

Condition with_composite() {
  return with_output("with a --composite", "there is none",
                     [](const OutputSettings& output) { return !output.composite.empty(); });
}

}  // namespace alcove
