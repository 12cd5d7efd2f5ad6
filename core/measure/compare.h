// Compares pictures and sequences of pictures: what `alcove compare` measures, and what it is written as.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/measure/metrics.h"

namespace alcove {

/// Every file may be of any format that open_image() reads, and a pattern of core/formats/sequence.h. A file that is no
/// pattern serves all frames.
struct CompareSettings {
  std::string result, reference;
  std::string reference_b;  // a second render of the reference with independent noise; empty: none
  std::string channels;     // see match_channels(); empty: those that both have
  // Pixels where the mask is above 0 are compared. Without a name, its only channel is taken, or its alpha.
  std::string mask, mask_channel;
  std::string depth, depth_channel;     // sky is not compared; edges and plain surfaces are found
  double sky = 1e9;                     // depth at or beyond it is sky, as are 0, infinity and NaN; > 0
  std::string motion, motion_channels;  // "X,Y"; empty: Vector.X, Vector.Y. See ErrorFrame for the convention
  std::string frames;                   // a list; empty: those of the result that are on the disk
  double peak = 1;                      // the largest value, for PSNR and SSIM; > 0
  bool hdr = false;                     // scene-linear values: HDR-FLIP
  bool pictures = false;                // keep pictures for the report
};

/// Data URLs of the report.
struct ComparePictures {
  std::string result, reference, error;
};

/// Pixels that are exactly 0 in one of the two and 1 in the other, where they make much of the error: sky, which
/// renderers' AO passes fill with 0, and others with 1.
struct SkyDifference {
  std::size_t count = 0;  // pixels
  bool zero_in_result = false;
  double rmse_without = 0;  // of the others
};

struct FrameComparison {
  int frame = 0;
  std::string result, reference;  // files
  std::vector<std::string> channels;
  int width = 0, height = 0;
  std::optional<Window> common;                     // what was compared, where the files have different windows
  std::size_t count = 0, excluded = 0, masked = 0;  // pixels; see Comparable
  PlaneErrors errors;
  double psnr = 0;             // infinite for equal pictures
  std::optional<double> ssim;  // nothing where no compared pixel is 5 pixels from all borders
  double flip = 0;
  std::array<BandErrors, 4> bands;
  std::optional<EdgeErrors> edges;  // with depth
  std::optional<double> grain;      // with depth; nothing where no pixel is plain
  std::optional<SkyDifference> sky_differs;
  std::optional<ComparePictures> pictures;
};

struct CompareReport {
  std::string result, reference;  // as given
  bool is_sequence = false;
  std::vector<FrameComparison> frames;  // one, if it is no sequence
  std::optional<double> flicker;        // where two frames follow each other
};

/// How many frames of a sequence keep their pictures: those with the largest rmse.
inline constexpr std::size_t kMostPicturedFrames = 12;

/// Reads and measures the frames. Fails with ErrorKind::usage on settings that contradict each other, and with
/// ErrorKind::input on missing and unreadable files, on pictures that share no pixel or no channel, on pictures of
/// different windows whose display windows differ too, and when no pixel is left to compare.
CompareReport compare_pictures(const CompareSettings& settings);

/// The frame with the largest rmse.
const FrameComparison& worst_frame(const CompareReport& report);

/// What the user should know although it broke no limit; sentences that end without a full stop.
std::vector<std::string> warnings_of(const CompareReport& report, const CompareSettings& settings);

/// Limits, each of which holds for every frame of a sequence.
struct CompareLimits {
  std::optional<double> max_rmse, max_p99, min_ssim, max_flip;
  std::optional<double> max_bias;   // of its size
  std::optional<double> max_grain;  // needs CompareSettings::depth
};

struct BrokenLimits {
  std::vector<std::string> sentences;  // one for each: what was measured, where, and what was allowed
  // ErrorKind::input where grain has a limit and a frame has no plain pixel: there was nothing to check
  ErrorKind kind = ErrorKind::comparison;
};

/// Checks each limit on the frame where its measure is worst.
BrokenLimits broken_limits(const CompareReport& report, const CompareLimits& limits);

/// See docs/compare-and-bench.md for the fields.
std::string compare_json(const CompareReport& report, const std::vector<std::string>& broken);

/// The page of core/measure/report.h.
std::string compare_page(const CompareReport& report);

}  // namespace alcove
