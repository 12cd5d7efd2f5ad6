// The steps of a frame, and the rows of tiles of a large one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_run.h"

#include <algorithm>
#include <new>
#include <string_view>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/frame/scale_notes.h"
#include "core/frame/settle.h"
#include "core/run/batch.h"
#include "core/run/resume.h"

namespace alcove {
namespace {

/// The run ends before this frame does.
struct Dropped {};

class FrameRun {
 public:
  FrameRun(Lane& lane, const RunContext& run, int frame, FrameReport& report)
      : gpu_(lane.gpu), last_(lane.last), run_(run), frame_(frame), settings_(run.plan.at(frame)), report_(report) {
    report.frame = frame;
    report.input = main_input(settings_.input);
    report.output = settings_.output.output;
  }

  void run() {
    const Stopwatch total;
    go_on();
    FrameSource source = read();
    const auto pixel = pixel_memory(source, settings_);
    if (fits(source.data, pixel, run_.room))
      run_whole(source);
    else
      run_tiles(source, pixel);
    report_.pixels = report_.pixels ? report_.pixels : source.data.pixels();
    note_counts(source);
    for (const auto* said : {&source.suspicious, &source.notes})
      report_.notes.insert(report_.notes.begin(), said->begin(), said->end());
    report_.total_ms = total.ms();
  }

 private:
  void go_on() const {
    if (run_.stop && run_.stop()) throw Dropped{};
  }

  /// Headers, and what is to be computed: source.data.
  FrameSource read() {
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
  FrameOutputs compute(FrameSource& source, const OutputSettings& output, bool reuses) {
    const Stopwatch reading;
    FrameInputs inputs = load_frame(gpu_, source, settings_, frame_);
    sample_.add(inputs.view, inputs.depth_map, inputs.depth_precision, inputs[RawPlane::depth]->as<float>());
    const bool is_same = reuses && last_.is_same(gpu_, inputs, settings_.estimator);
    if (!reuses) last_.forget();
    report_.read_ms += reading.ms();
    go_on();
    FrameOutputs outputs = is_same ? last_.outputs() : run_chain(gpu_, inputs, settings_.estimator, output);
    if (!is_same) {
      gpu_.run();
      add_passes();
    }
    if (reuses) last_.keep(outputs);
    const auto counts = outputs.counts->as<FrameCounts>()[0];
    counts_.sky += counts.sky;
    counts_.repaired_depth += counts.repaired_depth;
    counts_.repaired_normals += counts.repaired_normals;
    counts_.repaired_material += counts.repaired_material;
    counts_.repaired_beauty += counts.repaired_beauty;
    report_.pixels += source.data.pixels();
    has_ao_ = outputs.ao;
    if (outputs.squares)
      for (const vec2& tile : outputs.squares->as<const vec2>())
        report_.error_squares += tile.x, report_.error_pixels += tile.y;
    if (outputs.tiles) {
      const auto tiles = outputs.tiles->as<TileCounts>()[0];
      report_.tiles.sky += tiles.sky;
      report_.tiles.proved += tiles.open;
      report_.tiles.tolerated += tiles.tolerated;
      report_.tiles.kept += tiles.kept + (is_same ? tiles.listed : 0);
      report_.tiles.computed += is_same ? 0 : tiles.listed;
    }
    go_on();
    return outputs;
  }

  void add_passes() {
    for (std::size_t i = 0; i < gpu_.passes().size(); i++) {
      const gpu::PassTime& pass = gpu_.passes()[i];
      if (i >= report_.passes.size()) report_.passes.push_back({pass.name});
      report_.passes[i].ms += pass.ms;
      report_.passes[i].bytes_read += pass.bytes_read;
      report_.passes[i].bytes_written += pass.bytes_written;
      report_.compute_ms += pass.ms;
    }
  }

  Provenance provenance() const {
    const bool has_own_camera = settings_.input.camera != run_.plan.at(run_.plan.frames().front()).input.camera;
    return {has_own_camera ? options_digest(settings_) : run_.provenance.options, run_.provenance.device,
            identity_of_inputs(settings_)};
  }

  void run_whole(FrameSource& source) {
    const FrameOutputs outputs =
        compute(source, settings_.output, run_.plan.frames().size() > 1 && !settings_.estimator.no_skip);
    const Stopwatch writing;
    std::vector<std::vector<float>> kept;
    auto planes = result_planes(outputs, source.data, settings_.output);
    for (auto& plane : planes)
      if (source.region) plane = kept.emplace_back(cropped(plane, source.data, *source.region));
    const Provenance by = provenance();
    FrameWriter writer(source, settings_, by);
    writer.write(planes);
    write_pictures(source, outputs, run_.transform, settings_.output, by);
    writer.finish();
    report_.write_ms += writing.ms();
  }

  void run_tiles(FrameSource& source, const PixelMemory& pixel) {
    if (!settings_.output.preview.empty() || !settings_.output.debug.empty())
      fail(ErrorKind::device,
           "{}: a frame this large is computed in tiles, and {} needs it whole: allow more --memory, or use another "
           "--device",
           report_.input, settings_.output.preview.empty() ? "--debug" : "--preview");
    const Window whole = written_of(source);
    const Stopwatch reading;
    if (!source.settled) settle_by_rows(source, settings_.input);
    const Surroundings surroundings(source, settings_, whole);
    report_.read_ms += reading.ms();
    const auto rows = tiles_of(whole, surroundings, pixel, run_.room, source);
    FrameWriter writer(source, settings_, provenance());
    report_.parts = 0;
    for (const auto& row : rows) {
      std::vector<std::vector<float>> planes;
      for (const auto& tile : row) {
        source.data = surroundings.around(tile);
        add_tile(result_planes(compute(source, settings_.output, false), source.data, settings_.output), source.data,
                 tile, row, planes);
        report_.parts++;
      }
      const Stopwatch writing;
      writer.write(std::vector<std::span<const float>>(planes.begin(), planes.end()));
      report_.write_ms += writing.ms();
    }
    const Stopwatch writing;
    writer.finish();
    report_.write_ms += writing.ms();
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

  void note_counts(const FrameSource& source) {
    auto& notes = report_.notes;
    const std::vector<double> radii = has_ao_ ? radii_of(settings_.estimator) : std::vector<double>{};
    if (has_ao_) notes = sample_.notes(radii.front(), radii.back(), source.file_data.width, source.file_data.height);
    report_.sky_pixels = counts_.sky;
    report_.repaired_pixels =
        counts_.repaired_depth + counts_.repaired_normals + counts_.repaired_material + counts_.repaired_beauty;
    if (has_ao_)
      report_.samples_per_pixel =
          samples_per_pixel(settings_.estimator) * double(report_.pixels - report_.sky_pixels) / double(report_.pixels);
    if (counts_.repaired_depth)
      notes.push_back(
          fmt::format("{} pixels had a depth that is NaN or negative; they count as sky", counts_.repaired_depth));
    if (counts_.repaired_normals)
      notes.push_back(
          fmt::format("{} pixels had no usable normal; it was reconstructed from depth", counts_.repaired_normals));
    if (counts_.repaired_material)
      notes.push_back(
          fmt::format("{} pixels of the material AO were NaN or infinite; they count as 1", counts_.repaired_material));
    if (counts_.repaired_beauty)
      notes.push_back(fmt::format("{} pixels of the beauty were NaN or infinite; they are 0 in the composite",
                                  counts_.repaired_beauty));
    if (source[RawPlane::normal].empty())
      notes.push_back(
          "there is no normal channel; normals were reconstructed from depth (--normal, --normal-channels)");
    if (!source[RawPlane::beauty].empty() && source[RawPlane::indirect].empty())
      notes.push_back(
          "the frame has no indirect diffuse part: the composite is the whole beauty times AO, which dims direct light "
          "too");
  }

  gpu::Recorder& gpu_;
  LastFrame& last_;
  const RunContext& run_;
  int frame_;
  Settings settings_;
  FrameReport& report_;
  FrameCounts counts_{};
  DepthSample sample_;
  bool has_ao_ = false;
};

}  // namespace

FrameReport run_frame(Lane& lane, const RunContext& run, int frame) {
  FrameReport report;
  lane.gpu.abandon();  // what a frame that failed has left
  try {
    FrameRun(lane, run, frame, report).run();
    report.state = FrameState::done;
  } catch (const Dropped&) {
    report.state = FrameState::dropped;
  } catch (const gpu::DeviceLost& error) {
    report.state = FrameState::failed;
    report.error = error;
    report.device_lost = true;
  } catch (const Error& error) {
    report.state = FrameState::failed;
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
