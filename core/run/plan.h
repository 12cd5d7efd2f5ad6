// The frames of a run, the names of their files, and the frames of a shot that influence each other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/formats/sequence.h"
#include "core/options/options.h"

namespace alcove {

/// Frames of the shot to both sides of one, in order.
struct FramesAround {
  std::vector<int> there, missing;  // missing: an input of theirs is not on the disk
};

/// As many frames as the shot has.
constexpr int kWholeShot = std::numeric_limits<int>::max();
/// The number of frames to each side that settings ask for.
int around_of(const InputSettings& settings);
/// The option that makes frames use others of the shot; null: none does.
const char* shot_option(const InputSettings& settings);

/// A run's frames and the names of their files.
class FramePlan {
 public:
  /// Finds the frames and looks for their inputs. Opens nothing. A name is a pattern (core/formats/sequence.h), unless
  /// it is the name of an existing input. Fails with ErrorKind::usage if all frames would write one file, or would be
  /// computed from the same files. Fails with ErrorKind::input if inputs are missing, listing the frames of each,
  /// unless the settings skip such frames; and if no frame is left.
  explicit FramePlan(const Settings& settings);

  /// False for a single frame: the names of its files have no place for a number.
  bool is_sequence() const { return is_sequence_; }
  /// The frames to compute, in order.
  const std::vector<int>& frames() const { return frames_; }
  /// The frames of all chunks.
  const std::vector<int>& all() const { return all_; }
  /// Frames left out for want of an input; with the first chunk, the holes too.
  const std::vector<int>& missing() const { return missing_; }
  /// The numbers between the frames on the disk that have no file; none if the settings list the frames. A constant
  /// step of two or three leaves no holes.
  const std::vector<int>& holes() const { return holes_; }
  /// All frames on the disk by the first input with a pattern; none without a pattern.
  std::vector<int> on_disk() const;
  /// A few frames from the beginning to the end of the whole sequence, the same ones for every chunk. The first of
  /// these frames that shows enough decides all guesses, so all chunks make the same guesses.
  const std::vector<int>& evidence() const { return evidence_; }
  /// Up to `count` frames of the shot to each side. The shot is all frames on the disk and the holes between them, so
  /// neither --frames nor --chunk changes a result.
  FramesAround around(int frame, int count) const;
  /// The 2 `count` frames nearest to `frame`, without the frames that lack a file. Near an end of the shot, the frames
  /// are shifted inward.
  std::vector<int> nearest(int frame, int count) const;
  /// The 2 N + 1 frames averaged for `frame` by --accumulate N, shifted inward near the ends of the shot; else none.
  FramesAround accumulated(int frame) const;
  /// Whether `other` is one of the averaged frames.
  bool is_accumulated(int other, int frame) const;
  /// The size of a mean, and a frame's slot in it; slots in one mean are distinct.
  int turns() const { return 2 * settings_.input.accumulate + 1; }
  int slot_of(int frame) const;
  /// Frames around those to compute that have no file, if the settings skip them.
  std::vector<int> missing_around() const;
  /// All frames of the shot.
  const std::vector<int>& shot() const { return shot_; }
  /// The settings of all frames.
  const Settings& settings() const { return settings_; }
  /// The settings with the files of one frame.
  Settings at(int frame) const;
  /// Whether the frames of a sequence share one --preview, the contact sheet.
  bool has_contact_sheet() const;
  /// Gives all frames these radii, in scene units, instead of --radius auto or a percentage.
  void set_radii(const std::vector<double>& radii);
  /// Gives all frames the lights that their file lists.
  void set_lights(std::shared_ptr<const LightsFile> lights) { settings_.output.read_lights = std::move(lights); }

 private:
  struct Span {
    std::ptrdiff_t first, last;  // of the shot; last is beyond it
  };
  FramesAround within(const Span& span) const;
  Span nearest_places(int frame, int count) const;
  std::ptrdiff_t place_of(int frame) const;

  struct Pattern {
    const SettingRow* row;
    std::size_t word;  // of the row's value
    std::string text;
    FramePattern name;

    bool is_input() const { return row->role == FileRole::input; }
    std::string option() const { return row->long_name(); }
  };
  void find_patterns(FileRole role);
  const Pattern* first_input() const;
  std::vector<int> all_frames() const;
  void refuse_shared_files() const;
  void find_evidence();
  void find_inputs(const std::vector<int>& own);
  bool has_inputs(int frame) const;
  void find_shot();
  void refuse_missing_around() const;

  Settings settings_;
  std::vector<Pattern> patterns_;
  bool is_sequence_ = false;
  std::vector<int> all_, frames_, missing_, evidence_, holes_, shot_;
  std::set<int> absent_;  // of the shot
};

/// takes_frames: whether frames use surfaces or movement of other frames; takes_others: of other frames or views.
bool takes_frames(const InputSettings& settings);
bool takes_others(const InputSettings& settings);

/// The frames that show movement in `frame`.
std::vector<int> witnesses_of(const FramePlan& plan, int frame);
/// The largest number of such frames, with `count` frames to each side.
int most_witnesses(int count);

/// The frames that influence the hidden surfaces of a frame, in order: the frames around it, and their witnesses.
std::vector<int> seen_around(const FramePlan& plan, int frame);

/// All frames that influence a frame, in order: the frames around it, and the frames that show their movement.
std::vector<int> frames_seen_for(const FramePlan& plan, int frame);
/// The distance of the farthest of these frames, in frames of the shot.
int farthest_seen(int count);

/// The numbers of frames of the shot that are prepared and estimated, each once, for frames computed in this order.
struct SharedCounts {
  std::size_t prepared = 0, estimated = 0;
};
SharedCounts shared_counts(const FramePlan& plan, std::span<const int> frames);

/// The pattern of the sequence of a single file, by the number in its name, such as shot.####.exr. "" if the name has
/// no number, or only that of a version or a size. The number may be of a frame or of a shot.
std::string pattern_for(const std::string& path);

/// The number of a single file's frame by its name (core/formats/sequence.h); 0 where there is none.
int frame_number_of(const std::string& path);

/// Whether a frame with a warning fails.
bool fails_on_warnings(const Settings& settings);
/// Fails with ErrorKind::input, naming the file, if there is a warning, and if warnings count as errors.
void refuse_warnings(const Notes& notes, const Settings& settings, const std::string& file);

/// A part of a list. The lengths of all parts differ by one frame at most. 1 <= chunk <= chunks.
std::vector<int> chunk_of(const std::vector<int>& frames, int chunk, int chunks);

}  // namespace alcove
