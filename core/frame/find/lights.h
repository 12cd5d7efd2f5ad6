// The lights of a lights file (--lights), frame by frame, and the light of a sky (--environment).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/camera/camera.h"
#include "core/frame/camera/linear.h"

namespace alcove {

/// The most lights of a file.
inline constexpr std::size_t kMostLights = 16;

/// A light in one frame.
struct Light {
  std::string name = {};
  bool is_lamp = false;  // a lamp at a place; else a sun, which is infinitely far away
  Vector3 at{};          // scene units: of a lamp its place; of a sun the direction to it, 1 long
  double size = 0;  // of a lamp its radius, scene units; of a sun its angular diameter, degrees, at most 30; 0: hard
  bool operator==(const Light&) const = default;
};

/// A lights file as it was read. A run reads it once.
struct LightsFile {
  struct Entry {
    std::string name;                // letters, digits, - and _; each once
    std::map<int, Light> of_frames;  // by the number of the frame; of a light that is the same in all frames one
    bool is_constant = true;
    bool in_world = true;  // else in view space
  };
  std::string path;
  bool is_y_up = false;       // the world; else its z is
  std::vector<Entry> lights;  // 1 to kMostLights
  // Degrees that the settings give to a sun. See docs/inputs.md.
  std::size_t sun = 0;  // of `lights`
  std::optional<double> azimuth = {}, elevation = {};

  /// Fails with ErrorKind::input if a light that changes from frame to frame does not list one of these.
  void require_frames(const std::vector<int>& frames) const;
  /// The lights of a frame in view space. Fails as require_frames() does, and with ErrorKind::input if a light is in
  /// world space and the camera has no view_from_world.
  std::vector<Light> in_view(const Camera& camera, int frame) const;
  /// The suns that are below the world's horizon in one of these frames, which are listed: see require_frames().
  std::vector<std::string> below_horizon(const std::vector<int>& frames) const;
  std::size_t up_of_world() const { return is_y_up ? 1 : 2; }  // the axis
  /// Whether a light has some size in any frame.
  bool is_soft(std::size_t light) const {
    return std::ranges::any_of(lights[light].of_frames, [](const auto& of_frame) { return of_frame.second.size > 0; });
  }
};

/// Whether the settings turn a sun.
inline bool turns_sun(const EstimatorSettings& settings) { return settings.sun_azimuth || settings.sun_elevation; }

/// Reads a lights file; docs/inputs.md lists its fields. Fails with ErrorKind::input, and names file, light and field;
/// and with ErrorKind::usage where the settings turn a sun that the file does not have.
std::shared_ptr<const LightsFile> read_lights(const std::string& path, const EstimatorSettings& settings = {});
/// The same of its text; `path` is for messages.
std::shared_ptr<const LightsFile> lights_of(const std::string& text, const std::string& path,
                                            const EstimatorSettings& settings = {});

// Distant surroundings as nine colours, for surfaces with nine coefficients of openness.

/// The light of a sky in the real spherical harmonics of l <= 2, in the order of the AOV `transfer`.
struct Environment {
  std::array<std::array<double, 3>, 9> light{};  // of red, green and blue
  /// The share of the light, 0 to 1, that comes from elsewhere than the nine colours say: half the integral of the
  /// difference over that of the light.
  double missed = 0;
  bool operator==(const Environment&) const = default;
};

/// Nine colours hold a sky whose `missed` is at most this: that of gradients is .03 to .1, with a sun .3 and more.
inline constexpr double kMostMissed = 0.15;

/// Reads a lat-long picture. Its upper edge is up, z, and its middle x, as in Blender: u = .5 - atan2(y, x) / 2 pi,
/// v = .5 - asin(z) / pi from the top. Fails with ErrorKind::input where it isn't twice as wide as high, holds NaN,
/// infinity or values below 0, has no R, G and B, or is no EXR and no Radiance HDR.
Environment read_environment(const std::string& path, const char* option);

/// The same of planes R, G and B, one behind the other.
Environment environment_of(std::span<const float> planes, int width, int height);

/// Whether a file is a lat-long picture of colours alone.
bool is_sky_picture(const std::string& path);

/// The colours, the share that they miss, and a Nuke node that uses them: lines for people; and as JSON.
std::string environment_text(const std::string& path, const Environment& environment);
std::string environment_json(const std::string& path, const Environment& environment);

}  // namespace alcove
