// Finds out whether an earlier run has left a frame whole; the digest of options, by which it knows whether a file was
// made with those of this run.
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

/// 16 hexadecimal digits that change with every setting that changes the result, as the table of options says.
std::string options_digest(const Settings& settings);

/// The identities of all that the frames of a plan are made from: their inputs_of(), and those of the frames around
/// them that they take others from. An identity tells the contents of files from others, wherever they lie: a hash of
/// each or, of an EXR or a large file, of its size, beginning and end. The beginning of an EXR file holds the places of
/// all its chunks. Never fails: a file that cannot be read counts as empty. Each file is looked at once. Any thread may
/// ask.
class InputIdentities {
 public:
  explicit InputIdentities(const FramePlan& plan) : plan_(plan) {}
  std::string of(int frame) { return all_of(frame).text; }
  /// When the last of those files was written whose bytes are not all looked at.
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
  Notes notes;  // why outputs that are there are made again
};

/// The frames of the plan to compute: all but those whose outputs an earlier run has left whole, where the settings say
/// to resume it. `digest` is that of the first frame.
FramesToCompute frames_to_compute(const FramePlan& plan, const std::string& digest, InputIdentities& identities);

}  // namespace alcove
