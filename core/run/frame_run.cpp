// The steps of a frame, and the rows of tiles of a large one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_run.h"

#include <algorithm>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/base/windows.h"
#include "core/chain/aov.h"
#include "core/chain/debug_view.h"
#include "core/frame/settle.h"
#include "core/run/batch.h"
#include "core/run/digest.h"
#include "core/run/frame_tally.h"
#include "core/run/pictures.h"
#include "core/run/resume.h"
#include "core/run/shot_memory.h"

namespace alcove {
namespace {

double milliseconds_of(std::span<const gpu::PassTime> passes) {
  double ms = 0;
  for (const auto& pass : passes) ms += pass.ms;
  return ms;
}

/// The run ends before this frame does.
struct Dropped {};

class FrameRun {
 public:
  FrameRun(Lane& lane, const RunContext& run, const Room& room, int frame, const PartWatch& watch, FrameReport& report)
      : gpu_(lane.gpu),
        last_(lane.last),
        slots_(lane.estimates),
        run_(run),
        room_(room),
        frame_(frame),
        watch_(watch),
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
    const WindowLimits limits{memory_with_others(run_.plan, source, settings_), room_,
                              longest_side(settings_.estimator)};
    require_room_for_preview(source, limits);
    take_others(source);
    if (!source.region && limits.allow(source.data))
      run_whole(source);
    else
      run_parts(source, limits.in_parts(source));
    if (report_.parts > 1) note_parts(source);
    report_.total_ms = total.ms();
  }

 private:
  /// Ends the frame here where the run is to stop.
  void go_on() const {
    if (run_.stop && run_.stop()) throw Dropped{};
  }

  /// Reads the headers.
  FrameSource open() {
    const Stopwatch reading;
    FrameSource source = open_frame(settings_, frame_);
    if (run_.settled && settle_like(source, *run_.settled)) take_over_notes(source, *run_.settled);
    report_.read_ms += reading.ms();
    refuse_by_notes(source);
    return source;
  }

  /// What was noted of the whole sequence comes before what this frame's own header told.
  static void take_over_notes(FrameSource& source, const FrameSource& settled) {
    const Notes own = std::exchange(source.notes, settled.notes);
    add_new(source.notes, own);
    source.suspicious = settled.suspicious;
    // A damaged file harms its own frame alone; others that are damaged fail when they are read.
    std::erase_if(source.suspicious, [](const Note& note) { return note.code == NoteCode::damaged_file; });
  }

  /// Ends the frame before it is computed where what is known then counts as an error.
  void refuse_by_notes(const FrameSource& source) {
    report_.notes = tally_.notes_on(source);
    refuse_warnings(report_.notes, settings_, report_.input);
  }

  /// Computes what depends on a part of the frame, or the frame in tiles: all of them from planes that are read once.
  void run_parts(FrameSource& source, const WindowLimits& limits) {
    const Stopwatch reading;
    if (!read_ || !are_of(*read_, source)) read_ = read_whole(source);
    const auto& depth = (*read_)[RawPlane::depth];
    if (!source.settled)
      settle_by_planes(source, settings_.input, depth, (*read_)[RawPlane::normal], limits.room.bytes - limits.kept);
    Surroundings surroundings(source, settings_, depth);
    const Window computed = surroundings.around(written_of(source));
    report_.read_ms += reading.ms();
    if (!limits.allow(computed)) return run_tiles(source, limits, surroundings);
    source.data = computed;
    run_whole(source);
  }

  /// Whether the frame's own pass looks at what others see: not where all that it takes of them is in its estimate.
  bool needs_others() const {
    const auto& wanted = settings_.output;
    const auto views = debug_views_of(wanted);
    const bool shows_hidden = std::ranges::find(views, DebugSource::hidden, &DebugView::source) != views.end();
    return !run_.takes_means || shows_hidden || wants(wanted, &FrameOutputs::hidden) ||
           wants(wanted, &FrameOutputs::confidence);
  }

  /// Finds what others see, once for all parts of the frame.
  void take_others(const FrameSource& source) {
    if (!run_.shot) return;
    const Stopwatch reading;
    PreparedOthers took;
    // Where the device has no memory for a part of an estimate, smaller ones are computed as of the frame itself.
    const auto begin = [this](const Window& computed) {
      go_on();
      tally_.begin(computed);
    };
    if (run_.takes_means) estimates_ = run_.shot->estimates_of({gpu_, room_, begin}, frame_, took);
    if (needs_others()) others_ = run_.shot->others_of(gpu_, source, frame_, took);
    tally_.add_others(took);
    if (run_.takes_means) take_estimates();
    if (!others_.frames.empty() || !others_.missing.empty()) report_.frames_around = others_.frames;
    report_.read_ms += reading.ms();
    go_on();
  }

  /// What the frame's own estimate was made of and has found counts as the frame's.
  void take_estimates() {
    const EstimatedFrame& own = estimates_.own(frame_);
    if (others_.seen.empty()) others_ = own.others;
    tally_.add_estimate(own.report, others_);
    in_slots_ = slots_.filled(gpu_, run_.plan, estimates_, frame_, room_.buffer_bytes);
    read_ = std::move(estimates_.read);
  }

  /// Reads and computes source.data. reuses: what is as in the frame before is not computed again.
  FrameOutputs compute(FrameSource& source, bool reuses) {
    tally_.begin(source.data);
    watch_(++part_, parts_, 0);
    const Stopwatch reading;
    FrameInputs inputs = load_frame(gpu_, source, settings_, frame_, read_ ? &*read_ : nullptr);
    inputs.others = others_.seen;
    inputs.estimates = in_slots_;
    inputs.estimates.corner = {source.data.x - source.file_data.x, source.data.y - source.file_data.y};
    reuses = reuses && last_.is_worth_comparing(inputs);
    const bool is_same = reuses && last_.is_same(gpu_, inputs, settings_.estimator);
    if (!reuses) last_.forget();
    tally_.add_inputs(source, inputs, written_of(source));
    report_.read_ms += reading.ms();
    refuse_by_notes(source);

    go_on();
    const FrameOutputs outputs =
        is_same ? last_.outputs() : run_chain(gpu_, inputs, settings_.estimator, settings_.output);
    if (!is_same) {
      gpu_.run([&](double done) { watch_(part_, parts_, done); });
      tally_.add_passes(gpu_.passes());
      if (!inputs.changes) last_.took(milliseconds_of(gpu_.passes()));
      if (outputs.count) in_slots_.is_further_part = true;
    }
    if (reuses) last_.keep(outputs);
    tally_.add_outputs(outputs, source.data, is_same);
    go_on();
    return outputs;
  }

  /// By what is noted so far.
  Provenance provenance() const {
    const bool has_own_camera = settings_.input.camera != run_.plan.at(run_.plan.frames().front()).input.camera;
    return {has_own_camera ? options_digest(settings_) : run_.provenance.options,
            run_.provenance.device,
            run_.identities.of(frame_),
            header_text(report_.notes),
            text_of(others_),
            text_of(estimates_)};
  }

  void run_whole(FrameSource& source) {
    const EstimatorSettings& estimator = settings_.estimator;
    const bool reuses =
        run_.plan.frames().size() > 1 && !estimator.no_skip && estimator.noise == Noise::fixed && !run_.takes_means;
    const FrameOutputs outputs = compute(source, reuses);
    finish_tally(source);
    const Stopwatch writing;
    std::vector<std::vector<float>> regions;
    auto planes = result_planes(outputs, source.data, settings_.output);
    for (auto& plane : planes)
      if (source.region) plane = regions.emplace_back(cropped(plane, source.data, *source.region));
    const Provenance by = provenance();
    make_folders(outputs_of(settings_.output), settings_.output);
    FrameWriter writer(source, settings_, by);
    writer.write(planes);
    write_pictures(source, outputs, run_.transform, settings_.output, by);
    writer.finish(by.notes);
    report_.write_ms += writing.ms();
  }

  void finish_tally(const FrameSource& source) {
    tally_.finish(source, settings_);
    refuse_warnings(report_.notes, settings_, report_.input);
  }

  void run_tiles(FrameSource& source, const WindowLimits& limits, Surroundings& surroundings) {
    const Window computed = surroundings.around(written_of(source));
    why_in_parts_ = limits.why_not(computed);
    refuse_pictures(limits, computed);
    refuse_by_notes(source);
    const Stopwatch cutting;
    const auto tiles = tiles_of(written_of(source), surroundings, limits, source);
    report_.read_ms += cutting.ms();
    make_folders(outputs_of(settings_.output), settings_.output);
    FrameWriter writer(source, settings_, provenance());
    report_.parts = 0;
    parts_ = 0;
    for (const auto& row : tiles) parts_ += int(row.size());
    for (const auto& row : tiles) {
      const auto planes = compute_row(source, surroundings, row);
      const Stopwatch writing;
      writer.write(std::vector<std::span<const float>>(planes.begin(), planes.end()));
      report_.write_ms += writing.ms();
    }
    finish_tally(source);
    const Stopwatch writing;
    writer.finish(header_text(report_.notes));
    report_.write_ms += writing.ms();
  }

  void note_parts(const FrameSource& source) {
    report_.notes.push_back(
        {NoteCode::in_parts,
         fmt::format("computed in {} parts, {:.2g} times its pixels in all, since {}", report_.parts,
                     double(report_.pixels) / double(written_of(source).pixels()), why_in_parts_)});
  }

  /// A preview shows the display window, which a header may make far larger than the pixels that the file holds.
  void require_room_for_preview(const FrameSource& source, const WindowLimits& limits) const {
    if (settings_.output.preview.empty()) return;
    constexpr std::uint64_t kBytes = 3 * (sizeof(float) + 1);  // per pixel: display values, and the bytes of a PNG
    const std::uint64_t side_by_side = settings_.output.preview_style == "split" ? 4 : 1;  // each, and both
    const std::uint64_t bytes = picture_of(source, source.display).pixels() * kBytes * side_by_side;
    if (bytes > room_.bytes)
      limits.refuse(fmt::format("{}: a preview shows the display window, {}: leave out --preview", report_.input,
                                to_string(source.display)),
                    bytes);
  }

  /// Pictures show a frame on a scale of its own, which no tile knows.
  void refuse_pictures(const WindowLimits& limits, const Window& computed) const {
    if (settings_.output.preview.empty() && settings_.output.debug.empty()) return;
    limits.refuse(fmt::format("{}: a frame this large is computed in tiles, and {} needs it whole: leave it out",
                              report_.input, settings_.output.preview.empty() ? "--set debug" : "--preview"),
                  computed);
  }

  /// The planes of the results over one row of tiles.
  std::vector<std::vector<float>> compute_row(FrameSource& source, Surroundings& surroundings,
                                              const std::vector<Window>& row) {
    const Window whole{row.front().x, row.front().y, row.back().x + row.back().width - row.front().x,
                       row.front().height};
    std::vector<std::vector<float>> planes;
    for (const auto& tile : row) {
      source.data = surroundings.around(tile);
      const FrameOutputs outputs = compute(source, false);
      const auto results = result_planes(outputs, source.data, settings_.output);
      planes.resize(results.size());
      for (std::size_t i = 0; i < results.size(); i++) put_in(results[i], source.data, tile, whole, planes[i]);
      report_.parts++;
    }
    return planes;
  }

  gpu::Recorder& gpu_;
  LastFrame& last_;
  EstimateSlots& slots_;
  const RunContext& run_;
  const Room& room_;
  int frame_;
  const PartWatch& watch_;
  int part_ = 0, parts_ = 1;
  std::string why_in_parts_;
  Settings settings_;
  Others others_;                   // that the frame takes
  TakenEstimates estimates_;        // the same
  std::optional<ReadPlanes> read_;  // of the whole frame, for its parts; null: parts come from the files
  EstimateSet in_slots_;            // these for all parts of the frame
  FrameReport& report_;
  FrameTally tally_;
};

}  // namespace

FrameReport run_frame(Lane& lane, const RunContext& run, const Room& room, int frame, const PartWatch& watch) {
  FrameReport report;
  lane.gpu.abandon();  // what a frame that failed has left
  try {
    FrameRun(lane, run, room, frame, watch, report).run();
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
