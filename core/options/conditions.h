// Where options have an effect: what rows of the table say behind "applies", in one place.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <initializer_list>
#include <string>

#include "core/base/settings.h"

namespace alcove {

/// A condition for an option to have an effect.
struct Condition {
  std::string words;  // behind "applies": "to --estimator crytek", "with --denoise bilateral"
  // what is so instead, such as "the estimator is gtao"; "" where the option applies
  std::function<std::string(const Settings&)> instead;
  // It looks at what is written, which `alcove inspect` does not do.
  bool of_outputs = false;
  std::string otherwise = {};  // what else gives the option an effect: "with --aov confidence"; "": nothing does
};

/// The option is one of these estimators'.
Condition to_estimators(std::initializer_list<Estimator> estimators);
/// The option is of sampled searches: an exact one looks at all pixels.
Condition to_steps();
/// The option is not of estimates by their error, which take as many directions as that needs and no denoiser.
Condition without_tolerance();
/// The same, but --aov confidence makes estimates by slices and steps of its own, whatever estimates the AO.
Condition or_confidence(Condition condition);
/// The condition is that of these values of --search: its others apply anywhere.
Condition as_search(std::initializer_list<SliceSearch> searches, Condition condition);
Condition with_falloff();
Condition with_denoise(std::initializer_list<Denoise> kinds);
/// Some pixels take the estimates of others, be it at another density.
Condition with_shared_estimates();

/// The option is of depth of these kinds. Where nothing says the kind, the frame may turn out to have it.
Condition to_depth(std::initializer_list<DepthKind> kinds);
/// The option says something of depth, and positions are read where they are named.
Condition where_depth_is_read();

/// The option needs another one: `is_given` tells whether it is there.
Condition with_option(const std::string& option, const std::function<bool(const Settings&)>& is_given);
/// The option needs an output: `wants` tells whether it is asked for.
Condition with_output(const std::string& words, const std::string& instead,
                      const std::function<bool(const OutputSettings&)>& wants);
/// One of the AOVs is asked for.
Condition with_aovs(std::initializer_list<const char*> names);
Condition with_composite();

}  // namespace alcove
