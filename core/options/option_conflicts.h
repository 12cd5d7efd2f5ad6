// Why a setting has no effect beside others: sentences for rows of the table. Each is "" if the setting has its effect.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <string>

#include "core/base/settings.h"

namespace alcove {

/// The first reason that there is.
std::string first_of(std::initializer_list<std::string> reasons);

std::string unless_estimator(const Settings& settings, std::initializer_list<Estimator> estimators);
/// Estimators that search slices, and fade hits by their distance.
std::string unless_slices(const Settings& settings);
/// Estimators that know where an occluder ends.
std::string unless_ranges(const Settings& settings);
/// An exact search looks at all pixels.
std::string if_exact(const Settings& settings);
/// An estimate by its error takes as many directions as that needs, and no denoiser.
std::string if_by_error(const Settings& settings);
/// --aov confidence makes its own estimates by slices and steps, beside any estimator of the AO: it needs their
/// settings.
bool asks_for_confidence(const Settings& settings);
/// Shadows of lights use the settings of thickness, noise and denoiser, beside any estimator of the AO.
bool asks_for_shadows(const Settings& settings);
std::string unless_lights(const Settings& settings);
/// The AO's estimator, or that of shadows, knows where an occluder ends.
std::string unless_ranges_anywhere(const Settings& settings);
std::string unless_denoised(const Settings& settings, std::initializer_list<Denoise> kinds);
/// Some pixels take the estimates of others, be it at another density.
std::string unless_shared_estimates(const Settings& settings);

/// The setting is for depth of these kinds. A frame of unknown kind may have one of them.
std::string unless_depth(const Settings& settings, std::initializer_list<DepthKind> kinds);

std::string unless_aov(const Settings& settings, std::initializer_list<const char*> names);
std::string unless_composite(const Settings& settings);
/// "there is no OPTION" unless `is_given`: the setting belongs to that option.
std::string unless_given(bool is_given, const std::string& option);
/// Another option says the same.
std::string if_given(bool is_given, const std::string& option, const std::string& why);

}  // namespace alcove
