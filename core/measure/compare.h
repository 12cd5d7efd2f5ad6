// Compares pictures and sequences of pictures: the measures of `alcove compare`, its JSON and its page.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/frame_list.h"
#include "core/base/image.h"
#include "core/base/note.h"
#include "core/measure/metrics.h"

namespace alcove {

/// Files and options of a comparison. Every file may have any format that open_image() reads, and may be a pattern of
/// core/formats/sequence.h. A file without a pattern serves all frames. With a list of core/base/frame_list.h as
/// reference, the other files have a place for the frames' names.
struct CompareSettings {
  std::string name;  // of the frame, for people; empty: its number, else the file of the reference
  std::string result, reference;
  std::string reference_b;  // a second render of the reference with independent noise; empty: none
  std::string channels;     // see match_channels(); empty: those of both
  // a mask: pixels where it is above 0 are compared. Its channel; empty: its only channel, or its alpha
  std::string mask, mask_channel;
  std::string depth, depth_channel;     // sky is not compared; edges and plain surfaces are found
  double sky = 1e9;                     // depth at or beyond it is sky, as are 0, infinity and NaN; > 0
  std::string motion, motion_channels;  // "X,Y"; empty: Vector.X, Vector.Y. See ErrorFrame for the convention
  std::string frames;                   // a list; empty: the files of the result on the disk
  double peak = 1;                      // the largest value, for PSNR and SSIM; > 0
  bool hdr = false;                     // scene-linear values: HDR-FLIP
  CompareLimits limits;
  bool pictures = false;  // keep pictures for the report
  bool failures = false;  // keep the error's picture of every frame that breaks a limit
};

/// A value that is NaN or infinite in one file only.
struct HoleAt {
  int x = 0, y = 0;  // px, as the files count them
  std::string channel;
  bool in_result = false;  // else in the reference
};

/// Data URLs of the report.
struct ComparePictures {
  std::string result, reference;
};

/// Pixels that are exactly 0 in one of the two and 1 in the other, if they make much of the error. They are sky, which
/// renderers' AO passes fill with 0, and others with 1.
struct SkyDifference {
  std::size_t count = 0;  // pixels
  bool zero_in_result = false;
  double rmse_without = 0;  // of the other pixels
};

struct FrameComparison {
  int frame = 0;
  std::string name;               // for people
  CompareLimits limits;           // of this frame
  std::string result, reference;  // files
  std::vector<std::string> channels;
  std::vector<std::string> ao_channels;  // of the reference, if the name of its AO layer told them; else empty
  int width = 0, height = 0;
  std::optional<Window> common;  // the compared pixels, if the files have different windows
  std::size_t count = 0, excluded = 0, masked = 0, holes = 0;  // pixels; see Comparable
  std::optional<HoleAt> first_hole;
  PlaneErrors errors;
  double psnr = 0;             // infinite for equal pictures
  std::optional<double> ssim;  // none if no compared pixel is 5 pixels from all borders
  double flip = 0;
  std::array<BandErrors, 4> bands;
  std::optional<EdgeErrors> edges;  // with depth
  std::optional<double> grain;      // with depth; none if no pixel is plain
  std::optional<SkyDifference> sky_differs;
  std::optional<ComparePictures> pictures;
  std::string error_png;  // result - reference in colours; "" where nobody asks for it
  float error_scale = 0;  // the error that has full colour
};

/// A frame that could not be compared.
struct FailedFrame {
  std::string name;
  std::string error;  // a sentence
};

struct CompareReport {
  std::string result, reference;             // as given
  bool is_sequence = false;                  // frames of one shot
  bool is_list = false;                      // unlike frames, which have names
  std::vector<FrameComparison> frames = {};  // one, unless it failed
  std::vector<FailedFrame> failed = {};      // frames without a file, or with nothing to compare

  bool has_several() const { return is_sequence || is_list; }
  std::optional<double> flicker = {};  // none unless two frames follow each other
};

/// The most frames of a sequence that keep their pictures: those with the largest rmse.
inline constexpr std::size_t kMostPicturedFrames = 12;

/// Whether a frame has a limit.
bool has_limits(const CompareReport& report);

/// These limits, and more, which win.
CompareLimits with_limits(CompareLimits limits, const CompareLimits& more);

/// The settings with the files of each frame, whether they are there or not.
std::vector<CompareSettings> settings_of_frames(const CompareSettings& settings);

/// The name of a frame with these files.
std::string name_of(const CompareSettings& of_frame);

/// Reads and measures the frames. Frames fail by missing and unreadable files, by pictures that share no pixel or no
/// channel, by pictures of different data windows with different display windows, and if no pixel is left to compare.
/// Fails with ErrorKind::usage on settings that contradict each other, and with ErrorKind::input where RESULT has no
/// frames.
CompareReport compare_pictures(const CompareSettings& settings);

/// The frame with the largest rmse.
const FrameComparison& worst_frame(const CompareReport& report);

/// Says of the frame with the largest share of holes how many it has, and where its first one is; "" if it has no more
/// than that share.
std::string holes_beyond(const CompareReport& report, double most);

/// A limit and the value that comes nearest to it, or breaks it most.
struct CheckedLimit {
  const char* option;
  double limit;
  double value;        // NaN if it cannot be measured
  std::string frame;   // the name of the frame
  std::string broken;  // a sentence of the measure, its frame and the limit; "" if it holds
  // ErrorKind::input if grain has a limit and a frame has no plain pixel, so that nothing could be checked
  ErrorKind kind = ErrorKind::comparison;
};

/// Checks the limits of all frames. Holes break a limit of 0 where none is given, too.
std::vector<CheckedLimit> checked_limits(const CompareReport& report);

/// Whether a frame breaks one of its limits, or has holes.
bool is_broken(const FrameComparison& frame);

/// The errors of frames that could not be compared: each sentence once.
std::vector<std::string> errors_in(const CompareReport& report);

/// Whether a frame is among the causes of the exit code: without any limit no hole is.
bool fails(const FrameComparison& frame, const CompareReport& report);

/// The sentences of the limits that are broken.
std::vector<std::string> broken_limits(const std::vector<CheckedLimit>& limits);

/// Notes and warnings to the user beside broken limits.
Notes notes_on(const CompareReport& report, const CompareSettings& settings);

/// The JSON of a comparison; docs/compare-and-bench.md lists the fields.
std::string compare_json(const CompareReport& report, const std::vector<CheckedLimit>& limits);

/// The page of a comparison, as core/measure/report.h makes it.
std::string compare_page(const CompareReport& report, const std::vector<CheckedLimit>& limits);

/// The comparison as JUnit's XML: a test case for each frame, which fails with a sentence for each broken limit, and
/// has an error if it could not be compared. `file` is its own path, for the pictures beside it.
std::string compare_junit(const CompareReport& report, const std::string& file);

/// The picture of a failed frame's error, beside the XML of that path.
std::string failure_path(const std::string& junit, const std::string& frame);

}  // namespace alcove
