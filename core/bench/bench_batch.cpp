// The run, and its parts by themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/bench_batch.h"

#include <atomic>
#include <thread>

#include "core/bench/scratch_folder.h"
#include "core/run/batch.h"
#include "core/run/frame_files.h"
#include "core/run/pipeline.h"

namespace alcove {
namespace {

/// Returns the seconds that so many threads take to call the function with 0 to count - 1.
template <class Function>
double seconds_of(int threads, int count, const Function& function) {
  const Stopwatch watch;
  std::atomic<int> next = 0;
  std::vector<std::jthread> workers;
  for (int i = 0; i < threads; i++)
    workers.emplace_back([&] {
      for (int frame = next++; frame < count; frame = next++) function(frame);
    });
  workers.clear();
  return watch.ms() / 1000;
}

}  // namespace

BatchTimes time_batch(Settings settings, int frames) {
  const ScratchFolder folder;
  settings.output.output = folder.pattern();
  settings.frames.frames = fmt::format("1-{}", frames);
  settings.estimator.noise = Noise::animated;  // else all of these frames would be the first one
  const RunReport report = run_frames(settings);
  if (report.stop) throw *report.stop;
  BatchTimes times{frames, report.at_once, report.wall_s};

  times.files_s = seconds_of(report.at_once, frames, [&](int frame) {
    FrameSource source = open_frame(settings, frame);
    std::vector<float> depth(source[RawPlane::depth].size() * source.data.pixels());
    std::vector<float> normal(source[RawPlane::normal].size() * source.data.pixels());
    read_planes(source, {{&source[RawPlane::depth], depth.data()}, {&source[RawPlane::normal], normal.data()}});
    Settings of_frame = settings;
    of_frame.output.output = folder.file(frame);
    FrameWriter writer(source, of_frame, {report.options, report.device});
    writer.write(std::vector{std::span<const float>(depth).first(source.data.pixels())});
    writer.finish();
  });

  const DeviceSettings& d = settings.device;
  Lanes lanes({d.device, d.require_gpu, d.validate, !d.no_pipeline_cache}, report.at_once);
  const int frames_of_a_lane = (frames + report.at_once - 1) / report.at_once;
  std::atomic<double> device_ms = 0;
  seconds_of(report.at_once, report.at_once, [&](int) {
    lanes.with([&](Lane& lane) {
      gpu::Recorder& gpu = lane.gpu;
      FrameSource source = open_frame(settings, 1);
      const FrameInputs inputs = load_frame(gpu, source, settings, 1);
      const Stopwatch computing;
      for (int i = 0; i < frames_of_a_lane; i++) {
        run_chain(gpu, inputs, settings.estimator, settings.output);
        gpu.run();
      }
      for (double most = device_ms, ms = computing.ms(); ms > most && !device_ms.compare_exchange_weak(most, ms);)
        continue;
      return true;
    });
  });
  times.compute_s = device_ms / 1000;
  return times;
}

}  // namespace alcove
