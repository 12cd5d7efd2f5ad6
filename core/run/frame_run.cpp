// The steps of a frame, and the rows of tiles of a large one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_run.h"

#include <algorithm>
#include <new>
#include <string_view>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/frame/settle.h"
#include "core/run/batch.h"
#include "core/run/digest.h"
#include "core/run/frame_tally.h"
#include "core/run/pictures.h"
#include "core/run/resume.h"

namespace alcove {
namespace {

/// The run ends before this frame does.
struct Dropped {};

class FrameRun {
 public:
  FrameRun(Lane& lane, const RunContext& run, const Room& room, int frame, FrameReport& report)
      : gpu_(lane.gpu),
        last_(lane.last),
        run_(run),
        room_(room),
        frame_(frame),
        settings_(run.plan.at(frame)),
        report_(report),
        tally_(report) {
    report.frame = frame;
    report.input = main_input(settings_.input);
    report.output = settings_.output.output;
  }

  void run() {
    const Stopwatch total;
    go_on();
    FrameSource source = open();
    require_numbered_lines(source, settings_.estimator);
    require_room_for_preview(source);
    const WindowLimits limits{pixel_memory(source, settings_), room_, longest_side(settings_.estimator)};
    if (limits.allow(source.data))
      run_whole(source);
    else
      run_tiles(source, limits);
    tally_.finish(source, settings_);
    report_.total_ms = total.ms();
  }

 private:
  /// Ends the frame here where the run is to stop.
  void go_on() const {
    if (run_.stop && run_.stop()) throw Dropped{};
  }

  /// Reads the headers, and finds the window that is to be computed: source.data.
  FrameSource open() {
    const Stopwatch reading;
    FrameSource source = open_frame(settings_, frame_);
    if (run_.settled) settle_like(source, *run_.settled);
    if (source.region) {
      if (!source.settled) settle_by_rows(source, settings_.input);
      source.data = Surroundings(source, settings_, *source.region).around(*source.region);
    }
    report_.read_ms += reading.ms();
    return source;
  }

  /// Reads and computes source.data. reuses: what is as in the frame before is not computed again.
  FrameOutputs compute(FrameSource& source, bool reuses) {
    tally_.begin(source.data);
    const Stopwatch reading;
    FrameInputs inputs = load_frame(gpu_, source, settings_, frame_);
    const bool is_same = reuses && last_.is_same(gpu_, inputs, settings_.estimator);
    if (!reuses) last_.forget();
    tally_.add_inputs(inputs);
    report_.read_ms += reading.ms();

    go_on();
    const FrameOutputs outputs =
        is_same ? last_.outputs() : run_chain(gpu_, inputs, settings_.estimator, settings_.output);
    if (!is_same) {
      gpu_.run();
      tally_.add_passes(gpu_.passes());
    }
    if (reuses) last_.keep(outputs);
    tally_.add_outputs(outputs, source.data, is_same);
    go_on();
    return outputs;
  }

  Provenance provenance() const {
    const bool has_own_camera = settings_.input.camera != run_.plan.at(run_.plan.frames().front()).input.camera;
    return {has_own_camera ? options_digest(settings_) : run_.provenance.options, run_.provenance.device,
            identity_of_inputs(settings_)};
  }

  void run_whole(FrameSource& source) {
    const bool reuses = run_.plan.frames().size() > 1 && !settings_.estimator.no_skip;
    const FrameOutputs outputs = compute(source, reuses);
    const Stopwatch writing;
    std::vector<std::vector<float>> regions;
    auto planes = result_planes(outputs, source.data, settings_.output);
    for (auto& plane : planes)
      if (source.region) plane = regions.emplace_back(cropped(plane, source.data, *source.region));
    const Provenance by = provenance();
    FrameWriter writer(source, settings_, by);
    writer.write(planes);
    write_pictures(source, outputs, run_.transform, settings_.output, by);
    writer.finish();
    report_.write_ms += writing.ms();
  }

  void run_tiles(FrameSource& source, const WindowLimits& limits) {
    refuse_pictures(source, limits);
    const Window whole = written_of(source);
    const Stopwatch reading;
    if (!source.settled) settle_by_rows(source, settings_.input);
    const Surroundings surroundings(source, settings_, whole);
    report_.read_ms += reading.ms();

    const auto rows = tiles_of(whole, surroundings, limits, source);
    FrameWriter writer(source, settings_, provenance());
    report_.parts = 0;
    for (const auto& row : rows) {
      const auto planes = compute_row(source, surroundings, row);
      const Stopwatch writing;
      writer.write(std::vector<std::span<const float>>(planes.begin(), planes.end()));
      report_.write_ms += writing.ms();
    }
    const Stopwatch writing;
    writer.finish();
    report_.write_ms += writing.ms();
  }

  /// A preview shows the display window, which a header may make far larger than the pixels that the file holds.
  void require_room_for_preview(const FrameSource& source) const {
    if (settings_.output.preview.empty()) return;
    constexpr std::uint64_t kBytes = 3 * (sizeof(float) + 1);  // per pixel: display values, and the bytes of a PNG
    if (source.display.pixels() * kBytes > room_.bytes)
      fail(
          ErrorKind::device,
          "{}: a preview shows the display window, {}, which takes {} MiB: leave out --preview, or allow more --memory "
          "than the {} MiB that there are for this frame",
          report_.input, to_string(source.display), source.display.pixels() * kBytes >> 20, room_.bytes >> 20);
  }

  /// Pictures show a frame on a scale of its own, which no tile knows.
  void refuse_pictures(const FrameSource& source, const WindowLimits& limits) const {
    if (settings_.output.preview.empty() && settings_.output.debug.empty()) return;
    fail(ErrorKind::device, "{}: a frame this large is computed in tiles, and {} needs it whole: leave it out, or {}",
         report_.input, settings_.output.preview.empty() ? "--debug" : "--preview", limits.mended_by(source.data));
  }

  /// The planes of the results over one row of tiles.
  std::vector<std::vector<float>> compute_row(FrameSource& source, const Surroundings& surroundings,
                                              const std::vector<Window>& row) {
    std::vector<std::vector<float>> planes;
    for (const auto& tile : row) {
      source.data = surroundings.around(tile);
      const FrameOutputs outputs = compute(source, false);
      add_tile(result_planes(outputs, source.data, settings_.output), source.data, tile, row, planes);
      report_.parts++;
    }
    return planes;
  }

  /// Puts a tile of every result into the row that it is a part of.
  static void add_tile(const std::vector<std::span<const float>>& results, const Window& computed, const Window& tile,
                       const std::vector<Window>& row, std::vector<std::vector<float>>& planes) {
    const std::size_t width = std::size_t(row.back().x + row.back().width - row.front().x);
    planes.resize(results.size());
    for (std::size_t i = 0; i < results.size(); i++) {
      planes[i].resize(width * std::size_t(tile.height));
      for (int y = 0; y < tile.height; y++)
        std::ranges::copy(
            results[i].subspan(
                std::size_t(tile.y + y - computed.y) * std::size_t(computed.width) + std::size_t(tile.x - computed.x),
                std::size_t(tile.width)),
            planes[i].begin() + std::ptrdiff_t(std::size_t(y) * width + std::size_t(tile.x - row.front().x)));
    }
  }

  gpu::Recorder& gpu_;
  LastFrame& last_;
  const RunContext& run_;
  const Room& room_;
  int frame_;
  Settings settings_;
  FrameReport& report_;
  FrameTally tally_;
};

}  // namespace

FrameReport run_frame(Lane& lane, const RunContext& run, const Room& room, int frame) {
  FrameReport report;
  lane.gpu.abandon();  // what a frame that failed has left
  try {
    FrameRun(lane, run, room, frame, report).run();
    report.state = FrameState::done;
  } catch (const Dropped&) {
    report.state = FrameState::dropped;
  } catch (const gpu::DeviceLost& error) {
    report.state = FrameState::failed;
    report.error = error;
    report.device_lost = true;
  } catch (const Error& error) {
    report.state = FrameState::failed;
    report.out_of_memory = dynamic_cast<const gpu::OutOfMemory*>(&error) != nullptr;
    // Devices and numbers know of no file.
    const bool may_be_without = error.kind() == ErrorKind::device || error.kind() == ErrorKind::usage;
    const bool is_named =
        !may_be_without || std::string_view(error.what()).find(report.input) != std::string_view::npos;
    report.error = is_named ? error : Error(error.kind(), fmt::format("{}: {}", report.input, error.what()));
  } catch (const std::bad_alloc&) {
    report.state = FrameState::failed;
    report.error = Error(ErrorKind::device,
                         fmt::format("{}: no memory is left for it: let a run take less by --memory", report.input));
  } catch (const std::exception& error) {
    report.state = FrameState::failed;
    report.error = Error(ErrorKind::some_frames_failed, fmt::format("{}: {}", report.input, error.what()));
  }
  return report;
}

}  // namespace alcove
