// Checks a device: a small frame through presets, against stored values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/settings.h"
#include "core/gpu/recorder.h"

namespace alcove {

/// The presets that have stored values.
inline constexpr const char* kCheckedPresets[] = {"draft", "standard", "production", "reference"};

/// A stored value has four hexadecimal digits, of which this stands for 1.
inline constexpr double kStoredOne = 0xffff;

/// The largest RMS of the difference to the stored values.
inline constexpr double kMostDeviation = 1e-4;

/// The AO of the frame with these settings, which may lack a radius: the means of its blocks of 8 x 8 pixels, row by
/// row. Fails with ErrorKind::device.
std::vector<double> check_values(gpu::Recorder& gpu, const EstimatorSettings& settings);

/// The RMS of the differences from the stored values of one of kCheckedPresets.
double deviation(const std::string& preset, const std::vector<double>& values);

/// The result of `work`; nothing if it takes longer. Then `work` goes on, since a compiling driver cannot be stopped,
/// and the process must end by std::_Exit().
std::optional<std::vector<double>> values_within(std::chrono::milliseconds time,
                                                 std::function<std::vector<double>()> work);

}  // namespace alcove
