// --resume: whether a frame's outputs exist, are whole, and were made with the options of this run, by their digest.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/run/plan.h"

namespace alcove {

/// 16 hexadecimal digits, a hash of all settings that change the result by the table of options.
std::string options_digest(const Settings& settings);

/// Identities of the inputs of a plan's frames: inputs_of() of each, and of the frames around it that it uses. An
/// identity is a hash of the contents of the files. Of an EXR file or a large file, it is a hash of size, beginning and
/// end: the beginning of an EXR file holds the places of all its chunks. A file that cannot be read counts as empty.
/// Each file is read once. Any thread may ask.
class InputIdentities {
 public:
  explicit InputIdentities(const FramePlan& plan) : plan_(plan) {}
  std::string of(int frame) { return all_of(frame).text; }
  /// The latest time stamp of the files that are hashed in part.
  std::filesystem::file_time_type newest(int frame) { return all_of(frame).newest; }

 private:
  struct Identity {
    std::string text;
    std::filesystem::file_time_type newest = std::filesystem::file_time_type::min();
  };
  static Identity identity_of(const Settings& frame);
  Identity own(int frame);
  Identity all_of(int frame);

  const FramePlan& plan_;
  std::mutex mutex_;
  std::map<int, Identity> own_;  // of the files of each frame
};

/// Frames to compute.
struct FramesToCompute {
  std::vector<int> frames;
  Notes notes;  // why existing outputs are made again
};

/// The frames of the plan to compute: with --resume all but those with whole and current outputs. `digest`: of the
/// first frame.
FramesToCompute frames_to_compute(const FramePlan& plan, const std::string& digest, InputIdentities& identities);

}  // namespace alcove
