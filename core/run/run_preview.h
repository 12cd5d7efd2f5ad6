// A run before any of its frames is computed: frames, their reading, notes on all of them, missing options, and the
// text of --dry-run.
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

/// Options that a run needs and lacks.
struct MissingOptions {
  bool input = false, output = false, camera = false, radius = false;
  bool turns_normals = false;             // the missing camera needs world_to_camera, unless normals are left out
  bool lacks_matrix = false;              // the given camera has none, so normals must be left out
  std::string no_camera;                  // why a header or positions that seem to have a camera give none
  std::optional<double> proposed_radius;  // without a radius, if the first frame can be read
  std::optional<Error> no_channels;       // why its channels are not found, without a camera
  std::optional<Error> unreadable;        // why the first frame cannot be read

  bool any() const { return input || output || camera || radius; }
  /// One sentence for each, with the options that give it.
  std::vector<std::string> sentences() const;
};

/// Reads names, headers, and the pixels of one frame. A file that is opened here stays open for its frame.
class RunPreview {
 public:
  explicit RunPreview(const Settings& settings) : settings_(settings) {}

  /// Finds the frames at the first call. Fails as FramePlan does.
  const FramePlan& plan();

  /// Opens the first frame only where no option gives a camera or a radius. Fails with ErrorKind::usage on names that
  /// make no sense.
  MissingOptions missing_options();

  /// Checks the settings, and reads the lights of all frames. Finds radii by a frame's depth (--radius auto, 5%), the
  /// same ones for every chunk. Gives the notes on all frames. Fails on contradicting settings, and as
  /// notes_on_number() does. Fails with ErrorKind::input if lights lack a frame, if no examined frame shows a surface
  /// for the radius, or if a warning counts as an error.
  Notes prepare();

  /// Settles the reading that all frames share. It is the reading of the first frame whose pixels decide everything
  /// that files and options leave open. Gives none if no frame can be read, or if some frames cannot be read and the
  /// others show nothing. In this case each frame is settled by itself. Closes all files.
  std::optional<FrameSource> settle(std::uint64_t most_bytes);

  /// Opens a frame of the plan, unless it is open already. Fails as open_frame() does. After settle() any thread may
  /// call it.
  FrameSource open(const Settings& settings, int frame);

 private:
  /// A camera, and normals reconstructed from depth, for a look at a frame that lacks its own.
  struct StandIns {
    bool camera = false, normals = false;

    bool any() const { return camera || normals; }
  };
  struct DepthRadii {
    std::vector<double> radii;   // of the first frame that shows a surface
    std::optional<Error> error;  // of the first frame that could not be looked at
    bool lacks_matrix = false;   // normals of some frame need a world_to_camera, and there is none
  };

  FrameSource& opened(int frame);
  FrameSource with(const StandIns& stand_ins, int frame);
  bool has_camera(std::string& why_not);
  void look_at_first(MissingOptions& missing);
  std::vector<double> radii_of(int frame, const EstimatorSettings& estimator, const StandIns& stand_ins);
  DepthRadii radii_of_first(const EstimatorSettings& estimator, const StandIns& stand_ins);
  void propose_radius(MissingOptions& missing);
  void take_lights(Notes& notes);
  void take_radii_of_depth(Notes& notes);

  Settings settings_;
  std::optional<FramePlan> plan_;
  std::map<int, FrameSource> opened_;
};

/// The note on the number in a single file's name, if this number chooses the frame's camera from a list. Fails with
/// ErrorKind::usage if the name has no clear number, and with ErrorKind::input if the list has no such frame or cannot
/// be read.
Notes notes_on_number(const FramePlan& plan);

/// The text of --dry-run: frames, files, size and memory. Fails as the run would on settings, names, and a single frame
/// that cannot be read. is_wedge: for a run without outputs that needs whole frames.
std::string plan_text(RunPreview& look, bool is_wedge = false);

}  // namespace alcove
