// The suite of `alcove bench`: frames with their truth, and candidates, from a TOML file.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace alcove {

struct SuiteFrame {
  std::string name;
  std::string input, camera;       // files, below the data folder
  double radius = 0;               // scene units, of the truth, > 0
  std::vector<std::string> truth;  // one ray-traced AO image, or two with independent noise
  std::string reference = {};      // a kept CPU reference, see bench.h; empty: it is computed

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
///   [[frame]]      as core/base/frame_list.h has it, with camera, radius and truth; maybe cpu-reference: see bench.h
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

}  // namespace alcove
