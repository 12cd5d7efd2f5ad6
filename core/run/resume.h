// Finds out whether an earlier run has left a frame whole.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/run/plan.h"

namespace alcove {

/// Tells the contents of a frame's input files from others, wherever they lie: a hash of the size, the beginning and
/// the end of each. The beginning of an EXR file holds the places of all its chunks. Never fails: a file that cannot be
/// read counts as empty.
std::string identity_of_inputs(const Settings& frame);

/// The identities of all that the frames of a plan are made from: their own files, and those of the frames around them
/// that they take others from. Each file is looked at once. Any thread may ask.
class InputIdentities {
 public:
  explicit InputIdentities(const FramePlan& plan) : plan_(plan) {}
  std::string of(int frame);

 private:
  std::string own(int frame);

  const FramePlan& plan_;
  std::mutex mutex_;
  std::map<int, std::string> known_;
};

/// Whether all outputs of a frame are there and whole, made with the options of this digest from inputs of this
/// identity, and no older than its own. `frame` names the files of one frame. Reads headers and the table of chunks;
/// never fails.
bool has_whole_outputs(const Settings& frame, const std::string& options_digest, const std::string& inputs);

/// The frames of the plan to compute: all but those whose outputs an earlier run has left whole, where the settings say
/// to resume it.
std::vector<int> frames_to_compute(const FramePlan& plan, const Settings& settings);

}  // namespace alcove
