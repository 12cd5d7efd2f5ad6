// The steps of a frame by the functions that a run calls, one after the other.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/bench_host.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "core/base/system.h"
#include "core/bench/scratch_folder.h"
#include "core/chain/aov.h"
#include "core/formats/exr.h"
#include "core/run/frame_files.h"
#include "core/run/pipeline.h"

namespace alcove {
namespace {

constexpr int kFrame = 1;  // in names of outputs

std::uint64_t bytes_of_files(const FrameSource& source) {
  std::set<std::string> paths;
  for (const auto& file : source.files) paths.insert(file.path());
  std::uint64_t bytes = 0;
  std::error_code ignored;
  for (const auto& path : paths) bytes += std::filesystem::file_size(path, ignored);
  return bytes;
}

/// One frame after the other, each on the same lane.
class HostTimes {
 private:
  template <class Function>
  auto timed(const std::string& name, const Function& function) {
    const Stopwatch watch;
    auto result = function();
    add(name, watch.ms());
    return result;
  }

  /// Runs what the function records, by itself.
  template <class Function>
  bool submit(const Function& function) {
    function();
    gpu_.run();
    return true;
  }

 public:
  HostTimes(Lane& lane, const Settings& settings) : gpu_(lane.gpu), last_(lane.last), settings_(settings) {}

  void run() {
    FrameSource source = timed("open", [&] { return open_frame(settings_, kFrame); });
    const std::uint64_t files = bytes_of_files(source);
    through("open", files);
    const auto planes = timed("read", [&] { return read_frame(gpu_, source); });
    through("read", files);
    FrameInputs inputs = timed("settle", [&] { return settled_inputs(source, planes, settings_, kFrame); });
    through("settle", bytes_of(planes[RawPlane::depth]) + bytes_of(planes[RawPlane::normal]));
    timed("hash", [&] { return last_.is_same(gpu_, inputs, settings_.estimator); });
    // The estimate is computed anew, as that of a first frame.
    inputs.changes = nullptr;
    last_.forget();
    std::uint64_t raw = 0;
    for (const auto* plane : planes.entries) raw += bytes_of(plane);
    through("hash", raw);
    timed("upload", [&] { return submit([&] { upload(gpu_, inputs); }); });
    through("upload", raw);
    compute(source, inputs);
  }

  /// The medians of what was timed since the last call of forget().
  std::vector<HostStep> steps() {
    std::vector<HostStep> steps;
    for (const auto& name : order_) {
      auto& times = ms_.at(name);
      const auto middle = times.begin() + std::ptrdiff_t(times.size() / 2);
      std::ranges::nth_element(times, middle);
      steps.push_back({name, *middle, bytes_.at(name)});
    }
    return steps;
  }

  void forget() { ms_.clear(); }

 private:
  static std::uint64_t bytes_of(const gpu::Buffer* buffer) { return buffer ? buffer->bytes() : 0; }

  void add(const std::string& name, double ms) {
    if (std::ranges::find(order_, name) == order_.end()) order_.push_back(name);
    ms_[name].push_back(ms);
  }

  void through(const std::string& name, std::uint64_t bytes) { bytes_[name] = bytes; }

  void compute(FrameSource& source, const FrameInputs& inputs) {
    const FrameOutputs outputs = run_chain(gpu_, inputs, settings_.estimator, settings_.output);
    gpu_.run();
    double ms = 0;
    std::uint64_t passed = 0;
    for (const auto& pass : gpu_.passes()) {
      ms += pass.ms;
      passed += pass.bytes_read + pass.bytes_written;
    }
    add("compute", ms);
    through("compute", passed);
    timed("download", [&] {
      return submit([&] {
        for (const auto& aov : aovs_of(settings_.output)) gpu_.download(*(outputs.*aov.planes));
      });
    });
    const auto results = result_planes(outputs, source.data, settings_.output);
    std::uint64_t result_bytes = 0;
    for (const auto& plane : results) result_bytes += plane.size_bytes();
    through("download", result_bytes);
    write(source, results);
  }

  void write(FrameSource& source, const std::vector<std::span<const float>>& results) {
    const Stopwatch converting;
    std::uint64_t converted = 0;
    if (settings_.output.type == OutputType::half_float)
      for (const auto& plane : results) {
        (void)halves_of(plane);
        converted += plane.size_bytes();
      }
    const double convert_ms = converting.ms();
    add("convert", convert_ms);
    through("convert", converted);
    const Stopwatch writing;
    FrameWriter writer(source, settings_, {"bench", "bench"});
    writer.write(results);
    writer.finish();
    add("write", std::max(0.0, writing.ms() - convert_ms));
    std::error_code ignored;
    through("write", std::filesystem::file_size(settings_.output.output, ignored));
  }

  gpu::Recorder& gpu_;
  LastFrame& last_;
  const Settings& settings_;
  std::vector<std::string> order_;
  std::map<std::string, std::vector<double>> ms_;
  std::map<std::string, std::uint64_t> bytes_;
};

}  // namespace

std::vector<HostStep> time_host(Settings settings, int repeats) {
  const ScratchFolder folder;
  settings.output.output = folder.file(kFrame);
  const DeviceSettings& d = settings.device;
  set_exr_threads(core_count());  // as a run of one frame has
  Lanes lanes({d.device, d.require_gpu, d.validate, !d.no_pipeline_cache}, 1);
  std::vector<HostStep> steps;
  lanes.with([&](Lane& lane) {
    HostTimes times(lane, settings);
    times.run();
    times.forget();
    for (int i = 0; i < repeats; i++) times.run();
    steps = times.steps();
    return true;
  });
  return steps;
}

}  // namespace alcove
