// A run before any of its frames is computed: its frames, how they are read, what is noted of all of them, the options
// that it lacks, and the text of --dry-run.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/settings.h"
#include "core/frame/find/frame_source.h"
#include "core/run/plan.h"

namespace alcove {

/// Options that a run cannot do without, and that nobody gave.
struct MissingOptions {
  bool input = false, output = false, camera = false, radius = false;
  bool turns_normals = false;             // a camera that is missing must have world_to_camera, or normals be left out
  bool lacks_matrix = false;              // the camera that is given has none, so that normals must be left out
  std::string no_camera;                  // why header and positions, which look as if they had a camera, give none
  std::optional<double> proposed_radius;  // where there is no radius, and the first frame can be read
  std::optional<Error> no_channels;       // why its channels are not found, where there is no camera
  std::optional<Error> unreadable;        // why the first frame cannot be looked at

  bool any() const { return input || output || camera || radius; }
  /// One sentence for each, with the options that give it.
  std::vector<std::string> sentences() const;
};

/// Looks at names, headers, and the pixels of one frame. The frames of the run are found once. A file that is opened
/// here stays open for the frame that is computed from it.
class FirstLook {
 public:
  explicit FirstLook(const Settings& settings) : settings_(settings) {}

  /// Finds the frames at the first call. Fails as FramePlan does.
  const FramePlan& plan();

  /// Opens the first frame only where no option gives a camera or a radius. Fails with ErrorKind::usage on names that
  /// make no sense.
  MissingOptions missing_options();

  /// Checks the settings, and puts the radii that a frame's depth tells (--radius auto, 5%) into those of the plan: the
  /// same for every chunk of a sequence. Gives the notes on all frames. Fails on settings that contradict each other,
  /// as notes_on_number() does, and with ErrorKind::input where no frame that is looked at shows a surface for the
  /// radius, or a warning counts as an error.
  Notes prepare();

  /// Settles one frame, and all others are read in the same way. It is the first one that shows what files and options
  /// leave open. None where no frame can be read, or only such as show nothing while others are refused: then each is
  /// settled by itself. Closes all files.
  std::optional<FrameSource> settle(std::uint64_t most_bytes);

  /// Gives a frame of the plan, which is opened unless a look has left it open. Fails as open_frame() does. After
  /// settle() any thread may ask.
  FrameSource open(const Settings& settings, int frame);

 private:
  FrameSource& opened(int frame);
  InputSettings input_of(int frame);
  bool has_camera(std::string& why_not);
  void look_at_first(MissingOptions& missing);
  std::vector<double> radii_of(int frame, const EstimatorSettings& estimator);
  std::vector<double> radii_of_first(std::optional<Error>& error, const EstimatorSettings& estimator);
  std::optional<double> proposed_radius(std::optional<Error>& error);
  void take_radii_of_depth(Notes& notes);

  const Settings settings_;
  std::optional<FramePlan> plan_;
  bool lacks_camera_ = false;    // frames are opened with one that stands in for it
  bool lacks_matrix_ = false;    // pixels have shown that normals need a world_to_camera, and there is none
  bool leaves_normals_ = false;  // frames are opened without normals, which the camera cannot turn
  std::map<int, FrameSource> opened_;
};

/// The note on the number that a single file's name has, where it decides which camera of a list the frame has. Fails
/// with ErrorKind::usage where there is such a list and the name has no clear number, and with ErrorKind::input where
/// the list has no such frame or cannot be read.
Notes notes_on_number(const FramePlan& plan);

/// The frames, files, size and memory of a run. Computes and writes nothing. Fails as the run would on settings, names,
/// and a single frame that cannot be read as it is. is_wedge: it writes none of the outputs, and needs a frame whole.
std::string plan_text(FirstLook& look, bool is_wedge = false);

}  // namespace alcove
