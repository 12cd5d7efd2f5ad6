// The built-in display transform of color.h, for systems without OpenColorIO.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdlib>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/color.h"

namespace alcove {
namespace {

/// The curve of sRGB (IEC 61966-2-1), with its straight part where the two parts meet smoothly.
float srgb_of(float linear) {
  constexpr float kGamma = 2.4f, kOffset = 0.055f;
  constexpr float kEnd = kOffset / (kGamma - 1);                         // of the straight part, as a display value
  const float end = std::pow((kEnd + kOffset) / (1 + kOffset), kGamma);  // the same, as a linear value
  return linear <= end ? linear * (kEnd / end) : (1 + kOffset) * std::pow(linear, 1 / kGamma) - kOffset;
}

void require_builtin(const char* option, const std::string& name, const std::string& builtin) {
  if (name.empty() || lower_case(name) == lower_case(builtin)) return;
  fail(ErrorKind::input, "{}: this system's Alcove has no OpenColorIO, and only {}", typed(option, name), builtin);
}

}  // namespace

std::string display_config_file(const std::string& config) {
  const char* variable = config.empty() ? std::getenv("OCIO") : nullptr;
  return variable ? variable : config;
}

struct DisplayTransform::Impl {};

DisplayTransform::DisplayTransform(const std::string& config, const std::string& display, const std::string& view)
    : description_("sRGB / Standard") {
  if (const std::string file = display_config_file(config); !file.empty())
    fail(ErrorKind::input, "{}: this system's Alcove has no OpenColorIO: {} for the built-in view, sRGB", file,
         config.empty() ? "unset the variable OCIO" : "leave out --set ocio");
  require_builtin("--set display", display, "sRGB");
  require_builtin("--set view-transform", view, "Standard");
}

DisplayTransform::~DisplayTransform() = default;

void DisplayTransform::apply(std::span<float> rgb) const {
  for (float& value : rgb) value = srgb_of(value);
}

}  // namespace alcove
