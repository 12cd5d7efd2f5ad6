// Reports on the frames of a run: for people, for farms, and as JSON.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/note.h"
#include "core/gpu/device_info.h"
#include "kernels/base/shared.h"

namespace alcove {

/// kept: its outputs were whole already; dropped: the run ended before it.
enum class FrameState { done, failed, kept, dropped };
const char* name_of(FrameState state);

/// Blocked visibility, summed over the receivers of an estimate of the largest radius.
struct TakenVisibility {
  double by_completed = 0;  // by completed parts of surfaces
  double whole = 0;

  double completed_share() const { return whole > 0 ? by_completed / whole : 0; }
};

/// Numbers of surfaces behind the first ones.
struct HiddenCounts {
  std::uint64_t surfaces = 0;  // kept
  std::uint64_t dropped = 0;   // behind those
};

/// The report on one frame.
struct FrameReport {
  int frame = 0;
  FrameState state = FrameState::dropped;
  std::string input, output;
  double read_ms = 0;
  double compute_ms = 0;  // the sum of the passes' device time
  double write_ms = 0;
  double total_ms = 0;
  std::vector<gpu::PassTime> passes;
  std::uint64_t pixels = 0, sky_pixels = 0, repaired_pixels = 0;
  std::uint64_t rows_read = 0;  // decoded rows of the input, each as often as it was decoded
  // frames of the shot whose surfaces it uses; none without --around
  std::optional<std::vector<int>> frames_around;
  // pixels of other frames that are left out: those that move, and those that no other frame confirms
  std::uint64_t moved = 0, unconfirmed = 0;
  int parts = 1;  // of the frame; pixels that they share count in each
  /// Numbers of tiles of 8 x 8 pixels.
  struct Tiles {
    std::uint64_t sky = 0;       // nothing but sky
    std::uint64_t kept = 0;      // the same as in the frame before
    std::uint64_t computed = 0;  // estimated
  } tiles;
  // The sum of squared errors of an estimate with a tolerance, and the number of its pixels.
  double error_squares = 0, error_pixels = 0;
  std::optional<TakenVisibility> occlusion;  // of a frame with an estimate, where --stats asks for it
  std::optional<HiddenCounts> hidden;        // of a frame with known hidden surfaces
  // The number of pixels with an estimate of their own, by the widest lattice that a pixel lies on (spacing 16, 8, 4,
  // 2, 1). None if pixels share no estimates. Of several radii, for the largest.
  std::optional<std::array<std::uint64_t, kLattices>> estimates;
  std::string search;  // along slices, a word of --search; empty: the estimator has no such choice
  // Depth samples, averaged over all pixels: the actual samples if pixels share estimates, else the samples that the
  // settings ask for at surfaces.
  double samples_per_pixel = 0;
  double accumulated = 0;            // the number of averaged estimates, summed over its pixels
  std::uint64_t pixels_at_once = 0;  // the most that were computed at once
  Notes notes;                       // on the frame, and on the whole sequence
  std::optional<Error> error;        // why it failed
  bool device_lost = false;          // it failed since its device was lost
  bool out_of_memory = false;        // it failed since the device had no memory for it
};

/// The progress of a frame in flight.
struct FrameProgress {
  int frame = 0;
  std::string input;
  double seconds = 0;  // since its beginning; 0 once it has ended, while it waits for the reports of earlier ones
  int part = 0;        // that is being computed; 0: none yet
  int parts = 1;       // that the frame is computed in
  double done = 0;     // the share of the frame that is computed, 0 to 1
};

struct RunReport {
  bool is_sequence = false;
  std::string input;                 // of a sequence with the place for the frame number
  Notes notes;                       // on all frames and on how they are computed, as they become known
  std::vector<std::string> presets;  // files of settings, with the project's and those that presets build on
  std::string device, options;       // options: the digest that the outputs carry
  bool on_cpu_by_default = false;    // nobody asked for the CPU, and there is no GPU
  int at_once = 0;                   // the frames in flight, at the end of the run
  std::vector<FrameReport> frames;   // in order, without the dropped ones; kept for --stats only
  std::vector<int> missing;          // frames that were left out, since an input is missing
  int done = 0, failed = 0, kept = 0, dropped = 0;
  int warned = 0;  // of the frames that are done, those with a warning
  std::vector<int> failed_frames;
  std::optional<Error> stop;  // why the run ended early
  double wall_s = 0;
};

/// The text of `--stats`; docs/json.md lists its fields.
std::string stats_json(const RunReport& report);

/// The same fields of one frame, on one line.
std::string frame_json(const FrameReport& frame);

/// A list of objects with `code`, `level` and `text`, on one line.
std::string notes_json(const Notes& notes);

/// One sentence on the whole run, in fixed words, for searches in logs.
std::string summary_of(const RunReport& report);

}  // namespace alcove
