// A frame in work behind the C interface: what was said of it, its planes, and what became of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "api/alcove/alcove.h"
#include "core/chain/aov.h"
#include "core/chain/chain.h"
#include "core/frame/raw_plane.h"
#include "core/frame/reading.h"
#include "core/gpu/recorder.h"
#include "core/options/said.h"

namespace alcove {

/// Everything as api/alcove/alcove.h says; what is wrong is an Error.
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
  using Planes = std::vector<Given>;  // none, or one; of behind up to eight
  Planes& planes_named(const std::string& name);
  const Given& depth() const;
  bool has_position() const { return !position_.empty(); }

  Settings settings() const;
  Reading reading_by(const Settings& settings, int frame) const;
  Camera camera_by(const Settings& settings, const Window& window, int frame) const;
  void read_normals(Reading& reading, const Settings& settings) const;
  void close_device();
  void open_device(const DeviceSettings& settings);
  void compute(const Settings& settings, Reading reading, int frame);
  void note_results(const FrameOutputs& outputs, const Settings& settings, int width, int height);

  std::vector<Said> said_;            // of the command line's kind, each option once
  std::vector<std::string> presets_;  // names
  std::optional<std::string> camera_json_;
  // fx, fy, cx, cy, and behind them world_to_camera where it was given; none where there is no camera of numbers
  std::vector<double> pinhole_;
  RawPlaneArray<Planes> planes_;
  Planes position_, ignored_;

  std::string device_choice_;  // by what the device was opened
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
  std::string notes_;  // sentences, one a line
  std::optional<double> radius_;
};

/// Whether the library takes an option: not those that name files, frames or reports, or say how files are written.
bool is_for_library(const OptionRow& row);

}  // namespace alcove
