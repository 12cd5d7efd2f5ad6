// `alcove bench`: run time against error. A suite in TOML names frames with their truth, and candidates; every
// candidate is measured on every frame, interleaved.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/gpu/device_info.h"
#include "core/measure/metrics.h"
#include "core/reference/reference.h"

namespace alcove {

namespace gpu {
class Device;
}

struct SuiteFrame {
  std::string name;
  std::string input, camera;       // files, below the data folder
  double radius = 0;               // scene units, of the truth, > 0
  std::vector<std::string> truth;  // one ray-traced AO image, or two with independent noise
  std::string reference = {};      // a kept CPU reference, see read_kept_reference(); empty: it is computed

  /// All that are read for it.
  std::vector<std::string> files() const {
    std::vector<std::string> all{input, camera, reference};
    all.insert(all.end(), truth.begin(), truth.end());
    return all;
  }
};

struct SuiteCandidate {
  std::string name;
  std::vector<std::string> arguments;  // as for alcove run: "--preset=draft", "--set=slices=2" ...
};

struct Suite {
  std::string title;
  int repeats = 5;            // timed runs of every candidate on every frame, > 0
  int reference_slices = 16;  // slices of the CPU reference that splits the error; 0: there is none
  std::vector<SuiteFrame> frames;
  std::vector<SuiteCandidate> candidates;
};

/// Reads a suite:
///
///   title = "..."                     repeats = 5                  reference-slices = 16
///   [[frame]]      as core/base/frame_list.h has it, with camera, radius and truth; maybe cpu-reference, a file of
///                  read_kept_reference()
///   [[candidate]]  name = "draft"     preset = "draft"  power = 1.2             # any long option of alcove run
///   [[sweep]]      slices = [1, 2, 4] steps = [4, 8]    preset = "draft"        # a candidate for every combination
///
/// A candidate without a radius of its own takes the radius of each frame's truth, not its preset's. Paths are below
/// `data`, or below the suite's folder if `data` is empty. Fails with ErrorKind::input, naming file and key.
Suite read_suite(const std::string& path, const std::string& data);

/// The largest allowed error of a candidate on a frame.
struct Limit {
  std::string frame, candidate;
  std::string measure;  // rmse, mae, p99, bias (its size), grain, mottle or estimator-rmse
  double most = 0;
};

/// Fails with ErrorKind::input if the suite lacks a limit's frame or candidate, and with ErrorKind::usage if its
/// measure is not measured. `path` is for the message.
void require_known(const std::vector<Limit>& limits, const Suite& suite, const std::string& path);

/// Reads limits: a list of tables [[limit]] with frame, candidate and one or more measures. Fails with
/// ErrorKind::input, naming file and key.
std::vector<Limit> read_limits(const std::string& path);

/// A candidate with its settings worked out; a radius of its own, or the frame's.
struct BenchCandidate {
  std::string name, settings_text;
  EstimatorSettings estimator;
};

struct BenchPass {
  std::string name;
  double ms = 0, ms_min = 0;  // median and least over the repeats
  std::uint64_t bytes_read = 0, bytes_written = 0;
};

/// One candidate on one frame. Errors are over the surfaces, against the mean of the truths; with two truths rmse is
/// without their noise.
struct BenchRow {
  std::string frame, candidate;
  double ms = 0, ms_min = 0, ms_max = 0;  // device time of all passes: median, least, most
  std::vector<BenchPass> passes;
  double samples_per_pixel = 0;
  PlaneErrors errors;
  std::optional<double> grain;           // nothing where no pixel of the frame is plain
  std::optional<double> mottle;          // between the seeds 1 to 3; nothing where none is smooth and in half shadow
  std::optional<double> estimator_rmse;  // against the CPU reference at the same radius and falloff
  std::optional<double> geometry_rmse;   // of the CPU reference against the truth
  std::vector<float> ao;                 // the result, for pictures
};

struct BenchFrame {
  std::string name;
  int width = 0, height = 0;
  std::optional<double> yardstick_ms;
  std::vector<float> depth, truth;  // truth: the mean; 1 on sky
};

struct BenchReport {
  std::string title, device;
  int repeats = 0;
  std::vector<BenchFrame> frames;
  std::vector<BenchCandidate> candidates;
  std::vector<BenchRow> rows;  // frame by frame, candidates in order
};

struct BenchOptions {
  // a program to be run as PROGRAM FRAME CAMERA RADIUS RUNS that prints "median X ms"; empty: none
  std::string yardstick;
  std::function<void(const std::string&)> say = {};  // progress, a line each; may be empty
};

/// Times and measures. Fails as reading and computing do, and with ErrorKind::input when a truth is not the frame's
/// size.
BenchReport run_bench(gpu::Device& device, const Suite& suite, const std::vector<BenchCandidate>& candidates,
                      const BenchOptions& options);

/// {"title", "device", "repeats", "frames": [{"name", "width", "height", "yardstick_ms"}], "candidates": [{"name",
/// "settings", means over frames}], "rows": [...]}.
std::string bench_json(const BenchReport& report);
/// Writes one line per row, below a heading.
std::string bench_csv(const BenchReport& report);
/// The page of core/measure/report.h, with pictures.
std::string bench_page(const BenchReport& report);

/// A sentence for each value above its limit. Fails with ErrorKind::usage if a limited row was not measured, and with
/// ErrorKind::input if a frame with a limit has no plain pixel (grain) or no half shadow (mottle).
std::vector<std::string> broken_limits(const BenchReport& report, const std::vector<Limit>& limits);

/// Everything that a reference of a frame depends on besides the frame; a kept reference has it as the attribute
/// `alcove/reference`.
std::string text_of(const ReferenceSettings& settings);

/// The reference that the file holds, if it was made with these settings; empty if it was made with others. Fails with
/// ErrorKind::input, naming the file, where it holds no reference, or one of another data window.
std::vector<float> read_kept_reference(const std::string& path, const ReferenceSettings& settings, const Window& data);

}  // namespace alcove
