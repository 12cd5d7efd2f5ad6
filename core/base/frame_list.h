// A list of frames with a camera and radius each, in TOML, for `run`, `compare` and `bench`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/compare_limits.h"
#include "core/base/toml.h"

namespace alcove {

struct ListedFrame {
  std::string name;                         // in a list for run and compare a valid file name
  std::string input, camera = {};           // files; camera: empty where the input tells it
  std::optional<double> radius = {};        // scene units, > 0
  std::vector<std::string> truth = {};      // ray-traced AO: none, one picture, or two with independent noise
  std::vector<std::string> reference = {};  // of `compare`: the same; empty: the truth
  std::string cpu_reference = {};           // of `bench`; see bench.h
  CompareLimits limits = {};                // of `compare`

  const std::vector<std::string>& compared_with() const { return reference.empty() ? truth : reference; }
};

/// The place of a frame's name in the file names of a command.
inline constexpr const char* kNamePlace = "{name}";

/// The sentence on a file name that has no such place.
std::string why_no_place(const std::string& list);

/// Whether a file is a list by its name.
bool is_frame_list(const std::string& path);

/// Gives the frames of a list or of a suite; paths are below the folder. docs/frames.schema.json has the keys. Fails
/// with ErrorKind::input, naming file, frame and key.
std::vector<ListedFrame> frames_in(const toml::table& root, const std::string& path, const std::string& folder);

/// The same of a file; paths are below its folder. `option` is for messages.
std::vector<ListedFrame> read_frame_list(const std::string& path, const char* option);

/// The text with the name in its place.
std::string with_name(std::string text, const std::string& name);

}  // namespace alcove
