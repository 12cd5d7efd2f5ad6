// Scene-linear colour to display colour, through OpenColorIO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <memory>
#include <span>
#include <string>

namespace alcove {

/// The file that DisplayTransform reads: `config`, else that of the OCIO variable; "" for the built-in configuration.
inline std::string display_config_file(const std::string& config) {
  const char* variable = config.empty() ? std::getenv("OCIO") : nullptr;
  return variable ? variable : config;
}

/// A view of a display, by a configuration: the file `config`, else the file of the OCIO variable, else a small
/// built-in one (linear Rec.709 to sRGB). Empty names stand for the defaults. Fails with ErrorKind::input if the
/// configuration cannot be used, or lacks the display or view, listing its own.
class DisplayTransform {
 public:
  explicit DisplayTransform(const std::string& config, const std::string& display = "", const std::string& view = "");
  ~DisplayTransform();
  /// Converts interleaved r, g, b from the role scene_linear to display values, in place.
  void apply(std::span<float> rgb) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace alcove
