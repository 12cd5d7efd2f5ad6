// A frame behind the C interface: its options, its planes, and its results.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/alcove/alcove.h"
#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/chain/results/outputs.h"
#include "core/frame/raw_plane.h"
#include "core/frame/reading.h"
#include "core/gpu/recorder.h"
#include "core/options/options.h"

namespace alcove {

/// The sentence with 'key' for each option --key: the core writes for the command line. Options that the library does
/// not take are marked.
std::string in_library_words(std::string_view sentence);

/// A session behind the C functions, which api/alcove/alcove.h describes. Failures are an Error.
class Session {
 public:
  void set(const std::string& option, const char* value);
  void preset(const char* name);
  void plane(const std::string& name, const void* data, const alcove_layout* layout);
  void camera(const std::array<double, 4>& projection, const double* world_to_camera);
  void camera_json(const char* text);
  void run(int frame);
  std::size_t components(const std::string& aov) const;
  void get(const std::string& aov, void* data, const alcove_layout* layout) const;
  double number(const std::string& name) const;
  const std::string& device() const { return device_name_; }
  const std::string& notes() const { return notes_; }

 private:
  /// A plane of the caller's.
  struct Given {
    int width, height;
    bool is_half;
    std::vector<float> values;
  };
  using Planes = std::vector<Given>;  // at most one, and up to eight of `behind`
  const Planes& given(const std::string& name) const;
  const Given& depth() const;
  bool has_position() const { return !given("position").empty(); }

  Settings settings() const;
  Reading reading_by(const Settings& settings, int frame) const;
  Camera camera_by(const Settings& settings, const Window& window, int frame) const;
  void read_normals(Reading& reading, const Settings& settings) const;
  void close_device();
  void open_device(const DeviceSettings& settings);
  /// The planes of the frame; those behind each other are in `behind`.
  HostPlanes planes_over(const Window& data, std::vector<float>& behind) const;
  void compute(const Settings& settings, const Reading& reading, const HostPlanes& planes, int frame);
  void note_results(const FrameOutputs& outputs, const Settings& settings, int width, int height);

  std::vector<OptionValue> values_;                           // typed ones, each option once
  std::vector<std::pair<std::string, std::string>> presets_;  // names and texts
  std::optional<std::string> camera_json_;
  // fx, fy, cx, cy, and behind them world_to_camera if it was given; empty without a camera of numbers
  std::vector<double> pinhole_;
  std::map<std::string, Planes> planes_;  // by the caller's name

  std::string device_choice_;  // the options that opened the device
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<gpu::Recorder> gpu_;
  std::string device_name_;

  /// A result of the last run.
  struct Result {
    std::string name;
    std::size_t components;
    const gpu::Buffer* planes;
  };
  std::vector<Result> results_;
  int width_ = 0, height_ = 0;  // px
  FrameCounts counts_{};
  double compute_ms_ = 0;
  std::string notes_;  // sentences, one per line
  std::optional<double> radius_;
};

}  // namespace alcove
