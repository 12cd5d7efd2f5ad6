// Finds, before any work, which frames a run computes, and from which files to which.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/formats/sequence.h"
#include "core/frame/input_files.h"
#include "core/frame/raw_plane.h"

namespace alcove {

/// A file that the settings name, for every frame or with a place for the frame number.
struct NamedPath {
  const char* option;
  std::function<std::string&(Settings&)> of;
  bool is_output;
};

/// All files that settings can name for each frame, in the order in which people are told of them.
std::span<const NamedPath> named_paths();

/// A run's frames and the names of their files.
class FramePlan {
 public:
  /// Finds the frames and looks for their inputs; opens nothing. A name is a pattern (core/formats/sequence.h) unless
  /// it is an input that is there, or an output of a single frame.
  /// Fails with ErrorKind::usage where two frames would write one file, or one overwrites another's input; with
  /// ErrorKind::input where inputs are missing, listing the frames of each, unless the settings say to skip them, and
  /// where no frame is left.
  explicit FramePlan(const Settings& settings);

  /// False for one frame, whose files' names have no place for its number.
  bool is_sequence() const { return is_sequence_; }
  /// The frames to compute, in order.
  const std::vector<int>& frames() const { return frames_; }
  /// The frames that are left out, since an input is missing.
  const std::vector<int>& missing() const { return missing_; }
  /// The first frames that there are of the whole sequence, whatever the chunk. Guesses are made by them, so that all
  /// chunks make the same guesses.
  const std::vector<int>& evidence() const { return evidence_; }
  /// The settings with the files of one frame.
  Settings at(int frame) const;

 private:
  struct Pattern {
    NamedPath path;
    FramePattern name;
  };
  void find_patterns();
  std::vector<int> all_frames() const;
  void refuse_shared_files(const std::vector<int>& all) const;
  void find_inputs(const std::vector<int>& chunk);
  bool has_inputs(int frame) const;

  Settings settings_;
  std::vector<Pattern> patterns_;
  bool is_sequence_ = false;
  std::vector<int> frames_, missing_, evidence_;
};

/// The number at the end of a file name before its ending: shot.0042.exr is frame 42; 0 where there is none.
int frame_number_of(const std::string& path);

/// All files that a frame writes.
struct OutputFile {
  const char* option;
  std::string path;
};
std::vector<OutputFile> outputs_of(const OutputSettings& output);

/// What a run writes once, whatever its frames.
std::vector<OutputFile> reports_of(const OutputSettings& output);

/// The parts of a list, as long as each other to within one frame. 1 <= chunk <= chunks.
std::vector<int> chunk_of(const std::vector<int>& frames, int chunk, int chunks);

}  // namespace alcove
