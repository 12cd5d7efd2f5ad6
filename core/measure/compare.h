// Compares pictures and sequences of pictures: the measures of `alcove compare`, its JSON and its page.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/note.h"
#include "core/measure/metrics.h"

namespace alcove {

/// Files and options of a comparison. Every file may have any format that open_image() reads, and may be a pattern of
/// core/formats/sequence.h. A file without a pattern serves all frames.
struct CompareSettings {
  std::string result, reference;
  std::string reference_b;  // a second render of the reference with independent noise; empty: none
  std::string channels;     // see match_channels(); empty: those of both
  // a mask: pixels where it is above 0 are compared. Its channel; empty: its only channel, or its alpha
  std::string mask, mask_channel;
  std::string depth, depth_channel;     // sky is not compared; edges and plain surfaces are found
  double sky = 1e9;                     // depth at or beyond it is sky, as are 0, infinity and NaN; > 0
  std::string motion, motion_channels;  // "X,Y"; empty: Vector.X, Vector.Y. See ErrorFrame for the convention
  std::string frames;                   // a list; empty: those of the result that are on the disk
  double peak = 1;                      // the largest value, for PSNR and SSIM; > 0
  bool hdr = false;                     // scene-linear values: HDR-FLIP
  bool pictures = false;                // keep pictures for the report
};

/// A value that is NaN or infinite in one file only.
struct HoleAt {
  int x = 0, y = 0;  // px, as the files count them
  std::string channel;
  bool in_result = false;  // else in the reference
};

/// Data URLs of the report.
struct ComparePictures {
  std::string result, reference, error;
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
};

struct CompareReport {
  std::string result, reference;  // as given
  bool is_sequence = false;
  std::vector<FrameComparison> frames;  // a single one unless it is a sequence
  std::optional<double> flicker;        // none unless two frames follow each other
};

/// The most frames of a sequence that keep their pictures: those with the largest rmse.
inline constexpr std::size_t kMostPicturedFrames = 12;

/// The settings with the files of each frame. Fails as compare_pictures() does on frames that are missing.
std::vector<CompareSettings> settings_of_frames(const CompareSettings& settings);

/// Reads and measures the frames. Fails with ErrorKind::usage on settings that contradict each other. Fails with
/// ErrorKind::input on missing and unreadable files, on pictures that share no pixel or no channel, on pictures of
/// different data windows with different display windows, and if no pixel is left to compare.
CompareReport compare_pictures(const CompareSettings& settings);

/// The frame with the largest rmse.
const FrameComparison& worst_frame(const CompareReport& report);

/// Says of the frame with the largest share of holes how many it has, and where its first one is; "" if it has no more
/// than that share.
std::string holes_beyond(const CompareReport& report, double most);

/// Limits. Each holds for every frame of a sequence.
struct CompareLimits {
  std::optional<double> max_rmse, max_p99, min_ssim, max_flip;
  std::optional<double> max_bias;   // of its size
  std::optional<double> max_grain;  // needs CompareSettings::depth
  // share of the pixels within the mask that are finite in one file only, 0 to 1; else none may be
  std::optional<double> max_excluded;
  bool operator==(const CompareLimits&) const = default;
};

struct BrokenLimits {
  std::vector<std::string> sentences;  // one per limit: the measure, its frame, and the limit
  // ErrorKind::input if grain has a limit and a frame has no plain pixel, so that nothing could be checked
  ErrorKind kind = ErrorKind::comparison;
};

/// Checks each limit on the frame with the worst value of its measure. Holes are broken where no limit is given, too.
BrokenLimits broken_limits(const CompareReport& report, const CompareLimits& limits);

/// Notes and warnings to the user beside broken limits.
Notes notes_on(const CompareReport& report, const CompareSettings& settings, const CompareLimits& limits);

/// The JSON of a comparison; docs/compare-and-bench.md lists the fields.
std::string compare_json(const CompareReport& report, const std::vector<std::string>& broken);

/// The page of a comparison, as core/measure/report.h makes it.
std::string compare_page(const CompareReport& report);

}  // namespace alcove
