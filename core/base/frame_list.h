// A list of frames with a camera, a radius and limits each, in TOML, for `run`, `compare` and `bench`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/toml.h"

namespace alcove {

// The limits of a comparison: ONE table serves the options of `compare`, the keys of lists of frames, and the checks.

/// Limits of a frame.
struct CompareLimits {
  std::optional<double> max_rmse, max_p99, min_ssim, max_flip;
  std::optional<double> max_bias;   // of its size
  std::optional<double> max_grain;  // needs CompareSettings::depth
  // share of the pixels within the mask that are finite in one file only, 0 to 1; else none may be
  std::optional<double> max_excluded;
  bool operator==(const CompareLimits&) const = default;
};

struct LimitRow {
  const char* option;
  const char* measure;  // of the report; "" for the share of holes, which breaks a limit of 0 where none is given
  std::optional<double> CompareLimits::*value;
  double low, high;  // infinite: none
  const char* sentence;

  std::string key() const { return option + 2; }
};

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();
inline constexpr std::array kLimitTable = {
    LimitRow{"--max-rmse", "rmse", &CompareLimits::max_rmse, 0, kNoLimit, "the largest rmse"},
    LimitRow{"--max-p99", "p99", &CompareLimits::max_p99, 0, kNoLimit,
             "the largest 99th percentile of the error's size"},
    LimitRow{"--min-ssim", "ssim", &CompareLimits::min_ssim, -1, 1, "the least structural similarity"},
    LimitRow{"--max-flip", "flip", &CompareLimits::max_flip, 0, 1, "the largest mean FLIP"},
    LimitRow{"--max-bias", "bias", &CompareLimits::max_bias, 0, kNoLimit, "the largest size of the mean error"},
    LimitRow{"--max-grain", "grain", &CompareLimits::max_grain, 0, kNoLimit,
             "the largest grain, which needs --depth; a frame without plain surfaces ends with exit code 3"},
    LimitRow{"--max-excluded", "", &CompareLimits::max_excluded, 0, 1,
             "the largest share of pixels that are NaN or infinite in one file only; else any breaks all limits"}};

// The list.

struct ListedFrame {
  std::string name;                         // in a list for run and compare a valid file name
  std::string input, camera = {};           // files; camera: empty where the input tells it
  std::optional<double> radius = {};        // scene units, > 0
  std::vector<std::string> truth = {};      // ray-traced AO: none, one picture, or two with independent noise
  std::vector<std::string> reference = {};  // of `compare`: the same; empty: the truth
  std::string cpu_reference = {};           // of `bench`; see bench.h
  CompareLimits limits = {};                // of `compare`

  const std::vector<std::string>& compared_with() const { return reference.empty() ? truth : reference; }
};

/// The place of a frame's name in the file names of a command.
inline constexpr const char* kNamePlace = "{name}";

/// The sentence on a file name that has no such place.
std::string why_no_place(const std::string& list);

/// Whether a file is a list by its name.
bool is_frame_list(const std::string& path);

/// Gives the frames of a list or of a suite; paths are below the folder. docs/frames.schema.json has the keys. Fails
/// with ErrorKind::input, naming file, frame and key.
std::vector<ListedFrame> frames_in(const toml::table& root, const std::string& path, const std::string& folder);

/// The same of a file; paths are below its folder. `option` is for messages.
std::vector<ListedFrame> read_frame_list(const std::string& path, const char* option);

/// The text with the name in its place.
std::string with_name(std::string text, const std::string& name);

}  // namespace alcove
