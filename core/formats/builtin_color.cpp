// The built-in display transform of color.h, for systems without OpenColorIO.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/color.h"

namespace alcove {
namespace {

/// The curve of sRGB (IEC 61966-2-1).
float srgb_of(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

void require_builtin(const char* option, const std::string& name, const std::string& builtin) {
  if (name.empty() || lower_case(name) == lower_case(builtin)) return;
  fail(ErrorKind::input, "{}: this system's Alcove has no OpenColorIO, and only {}", typed(option, name), builtin);
}

}  // namespace

struct DisplayTransform::Impl {};

DisplayTransform::DisplayTransform(const std::string& config, const std::string& display, const std::string& view) {
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
