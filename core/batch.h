// Frames from files to files: read, compute, write; and what each of them took.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/gpu/recorder.h"
#include "core/settings.h"

namespace alcove {

/// What happened to one frame.
struct FrameReport {
  int frame = 0;
  std::string input, output;
  double read_ms = 0, compute_ms = 0, write_ms = 0, total_ms = 0;  // compute: the sum of the passes' device time
  std::vector<gpu::PassTime> passes;
  std::uint64_t pixels = 0, sky_pixels = 0, repaired_pixels = 0;
  double samples_per_pixel = 0;    // depth samples that the settings ask for, averaged over all pixels; sky asks for none
  std::vector<std::string> notes;  // what the user should know, a sentence each
};

struct RunReport {
  std::string device, options;  // options: the digest that the outputs carry
  std::vector<FrameReport> frames;
  int failed = 0;
  double wall_s = 0;
};

/// Fails with ErrorKind::usage on settings that contradict each other, ErrorKind::output on outputs that cannot be made.
/// Opens no input and no device.
void check_settings(const Settings& settings);

/// 16 hexadecimal digits that change with every setting that changes the result, and with what the camera file says. Fails as reading that file does.
std::string options_digest(const Settings& settings);

/// The number at the end of a file name before its ending: shot.0042.exr is frame 42; 0 where there is none.
int frame_number_of(const std::string& path);

/// Computes the frame that the settings name and writes its outputs. Checks the settings first.
RunReport run_frames(const Settings& settings);

/// `--stats`: see the README for the fields.
std::string stats_json(const RunReport& report);

}  // namespace alcove
