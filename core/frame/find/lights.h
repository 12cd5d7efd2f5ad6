// The lights of a lights file (--lights), frame by frame.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/frame/camera/camera.h"
#include "core/frame/camera/linear.h"

namespace alcove {

/// The most lights of a file.
inline constexpr std::size_t kMostLights = 16;

/// A light in one frame.
struct Light {
  bool is_lamp = false;  // a lamp at a place; else a sun, which is infinitely far away
  bool in_world = true;  // else in view space
  Vector3 at{};          // scene units: of a lamp its place; of a sun the direction to it, 1 long
  double size = 0;  // of a lamp its radius, scene units; of a sun its angular diameter, degrees, below 180; 0: hard
  bool operator==(const Light&) const = default;
};

/// A lights file as it was read. A run reads it once.
struct LightsFile {
  struct Entry {
    std::string name;                // letters, digits, - and _; each once
    std::map<int, Light> of_frames;  // by the number of the frame; of a light that is the same in all frames one
    bool is_constant = true;
  };
  std::string path;
  std::vector<Entry> lights;  // 1 to kMostLights

  /// Fails with ErrorKind::input if a light that changes from frame to frame does not list one of these.
  void require_frames(const std::vector<int>& frames) const;
  /// The lights of a frame in view space. Fails as require_frames() does, and with ErrorKind::input if a light is in
  /// world space and the camera has no view_from_world.
  std::vector<Light> in_view(const Camera& camera, int frame) const;
  /// Whether a light has some size in any frame.
  bool is_soft(std::size_t light) const;
};

/// Reads a lights file; docs/inputs.md lists its fields. Fails with ErrorKind::input, and names file, light and field.
std::shared_ptr<const LightsFile> read_lights(const std::string& path);
/// The same of its text; `path` is for messages.
std::shared_ptr<const LightsFile> lights_of(const std::string& text, const std::string& path);

}  // namespace alcove
