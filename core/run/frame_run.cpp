// Takes and gives back lanes; the steps of a frame, and the rows of tiles of a large one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_run.h"

#include <algorithm>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/system.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/outputs.h"
#include "core/frame/settle/settle.h"
#include "core/run/frame_tally.h"
#include "core/run/run_files.h"
#include "core/run/tiles.h"

namespace alcove {

Lanes::Lanes(const gpu::DeviceOptions& options, int count) : options_(options), count_(count) {
  devices_.push_back(std::make_unique<gpu::Device>(options));
}

int Lanes::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

int Lanes::validation_messages() const {
  int messages = 0;
  for (const auto& device : devices_) messages += device->validation_messages();
  return messages;
}

void Lanes::set_count(int count) {
  const std::lock_guard lock(mutex_);
  count_ = count;
  for (auto& place : free_) place.lane.reset();
}

Lanes::Place Lanes::take() {
  const std::lock_guard lock(mutex_);
  if (!free_.empty()) {
    Place place = std::move(free_.back());
    free_.pop_back();
    return place;
  }
  if (is_first_taken_ && device().info().type == gpu::DeviceType::cpu)
    devices_.push_back(std::make_unique<gpu::Device>(options_));
  is_first_taken_ = true;
  return {devices_.back().get(), nullptr};
}

void Lanes::give_back(Place place) {
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(place));
}

Lanes::Lease::Lease(Lanes& lanes) : lanes_(lanes), place_(lanes.take()) {
  try {
    if (!place_.lane) place_.lane = std::make_unique<Lane>(*place_.device);
  } catch (...) {
    lanes_.give_back(std::move(place_));
    throw;
  }
}

Lanes::Lease::~Lease() {
  if (!keeps_buffers_) place_.lane.reset();
  lanes_.give_back(std::move(place_));
}

namespace {

double milliseconds_of(std::span<const gpu::PassTime> passes) {
  double ms = 0;
  for (const auto& pass : passes) ms += pass.ms;
  return ms;
}

/// The run ends before this frame does.
struct Dropped {};

/// The settings of a frame that hands out its estimate alone: all of it, whatever is wanted of the frame itself.
Settings of_estimate(Settings settings) {
  InputSettings& input = settings.input;
  for (std::string* file :
       {&input.matte, &input.matte_channel, &input.matte_object, &input.material_ao, &input.material_ao_channel})
    file->clear();
  input.roi.reset();
  settings.output.composite.clear();
  settings.output.debug.clear();
  settings.estimator.noise = Noise::animated;
  return settings;
}

/// A window to compute, and the part of it whose results count.
struct FramePart {
  Window computed, part;
};
/// Rows of them, from the top.
using PartRows = std::vector<std::vector<FramePart>>;

/// One frame on a lane: for its files, or for the estimate that other frames use.
class FrameRun {
 public:
  FrameRun(Lane& lane, const RunContext& run, const MemoryBudget& budget, int frame, const PartWatch& watch,
           FrameReport& report)
      : FrameRun(lane, run, budget, frame, watch, report, run.plan.at(frame), run.planes, nullptr) {}

  void run() {
    const Stopwatch total;
    throw_if_stopped();
    FrameSource source = open();
    require_numbered_lines(source, settings_.estimator);
    const WindowLimits limits{memory_of_looks(source), budget_};
    require_room_for_preview(source, limits);
    take_others(source);
    const PartRows rows = cut(source, limits, [&](const WindowLimits& of_parts, const Window& computed) {
      refuse_pictures(source, of_parts, computed);
      refuse_by_notes(source);
    });
    if (why_in_parts_.empty())
      run_whole(source, rows[0][0].computed);
    else
      run_tiles(source, rows);
    if (report_.parts > 1) note_parts(source);
    report_.total_ms = total.ms();
  }

  /// Estimates a frame for the one that this is, which counts its windows.
  EstimatedFrame estimate_of(int frame, PreparationCost& cost) {
    FrameReport report;
    const PartWatch unwatched = [](int, int, double) {};
    FrameRun other(lane_, run_, budget_, frame, unwatched, report, of_estimate(run_.plan.at(frame)), nullptr, &tally_);
    EstimatedFrame result = other.estimate(cost);
    result.report = std::move(report);
    return result;
  }

 private:
  /// `planes`: of the frame, from run to run; null: they are read. `taker`: counts an estimate's windows; null: the
  /// frame is computed for its files.
  FrameRun(Lane& lane, const RunContext& run, const MemoryBudget& budget, int frame, const PartWatch& watch,
           FrameReport& report, const Settings& settings, ReadPlanes* planes, FrameTally* taker)
      : lane_(lane),
        run_(run),
        budget_(budget),
        frame_(frame),
        watch_(watch),
        settings_(settings),
        planes_(planes),
        report_(report),
        tally_(report, taker) {}

  /// Computes the estimate of the whole frame, whose results are not filtered by a matte and not written.
  EstimatedFrame estimate(PreparationCost& cost) {
    FrameSource source = opened();
    require_place(source, frame_, "--accumulate");
    const Window whole = source.reading.data;
    others_ = run_.shot->views().of(gpu_, source, frame_, cost);
    EstimatedFrame result;
    result.frame = frame_;
    result.camera = source.reading.camera;
    result.view = view_of(source.reading, whole);
    Wanted wanted{settings_.output};
    wanted.only_own = wanted.visibility = true;
    std::vector<float> scales, moments;  // over the whole frame
    const WindowLimits limits{memory_with_others(run_.plan, source, settings_), budget_};
    for (const auto& row : cut(source, limits))
      for (const FramePart& part : row) {
        throw_if_stopped();
        FrameInputs inputs = read(source, part.computed, run_.plan.slot_of(frame_));
        inputs.turn = inputs.frame;
        if (part.part == whole) read_ = kept_planes(inputs);
        const FrameOutputs outputs = run_chain(gpu_, inputs, settings_.estimator, wanted);
        run_passes();
        tally_.add_outputs(outputs, part.computed, false);
        const OwnEstimate& own = outputs.own.value();
        result.depth_precision = own.gbuffer.depth_precision;
        const auto copy = [&]<class T>(const gpu::Buffer* planes, std::vector<T>& all) {
          if (planes) put_in(planes->as<const T>(), part.computed, part.part, whole, all);
        };
        copy(own.gbuffer.depth, result.depth);
        copy(own.gbuffer.normal, result.normal);
        copy(own.visibility.ao, result.values);
        copy(own.visibility.scales, scales);
        copy(own.visibility.moments, moments);
      }
    for (const auto* planes : {&scales, &moments})
      result.values.insert(result.values.end(), planes->begin(), planes->end());
    mark_moving(result, cost);
    cost.rows_read += source.rows_read;
    cost.passes.insert(cost.passes.end(), report_.passes.begin(), report_.passes.end());
    others_.seen.clear();
    result.others = std::move(others_);
    run_.shot->keep_planes(frame_, std::move(read_));
    return result;
  }

  /// Changes the sign of the depth of pixels that move by their vectors.
  void mark_moving(EstimatedFrame& estimated, PreparationCost& cost) {
    const auto moving = run_.shot->views().moving_by_vectors(gpu_, frame_, cost, 0);
    for (std::size_t i = 0; moving && i < moving->size(); i++) {
      if (!(*moving)[i]) continue;
      estimated.depth[i] = -estimated.depth[i];
      estimated.has_moving = true;
    }
  }

  /// Ends the frame here where the run is to stop.
  void throw_if_stopped() const {
    if (run_.stop && run_.stop()) throw Dropped{};
  }

  /// Reads the headers, and takes over the reading of the sequence.
  FrameSource opened() {
    FrameSource source = run_.look.open(settings_, frame_);
    if (run_.settled && settle_like_or_alone(source, *run_.settled, settings_.input, budget_.bytes))
      take_over_notes(source, *run_.settled);
    return source;
  }

  /// The same, and what is known then.
  FrameSource open() {
    const Stopwatch reading;
    FrameSource source = opened();
    report_.read_ms += reading.ms();
    refuse_by_notes(source);
    if (const auto& lights = settings_.output.read_lights) lights_ = lights->in_view(source.reading.camera, frame_);
    return source;
  }

  /// Puts the notes on the whole sequence before those of this frame's own header.
  static void take_over_notes(FrameSource& source, const FrameSource& settled) {
    const Notes own = std::exchange(source.notes, settled.notes);
    add_new(source.notes, own);
    source.suspicious = settled.suspicious;
    // A damaged file harms its own frame alone; others that are damaged fail when they are read. An empty frame is
    // counted by itself.
    std::erase_if(source.suspicious, [](const Note& note) {
      return note.code == NoteCode::damaged_file || note.code == NoteCode::no_surfaces;
    });
  }

  /// The memory of the settings, or of the look that takes the most: one may have a buffer that another does without.
  FrameMemory memory_of_looks(const FrameSource& source) const {
    FrameMemory most = memory_with_others(run_.plan, source, settings_);
    for (const auto& look : run_.looks) {
      FrameMemory memory = most;
      memory.take(look);
      if (memory.of(source.reading.data).device > most.of(source.reading.data).device) most = memory;
    }
    return most;
  }

  /// Ends the frame before it is computed where what is known then counts as an error.
  void refuse_by_notes(const FrameSource& source) {
    report_.notes = tally_.notes_on(source, settings_.input);
    refuse_warnings(report_.notes, settings_, report_.input);
  }

  /// Cuts the frame into the windows that it is computed in: one, or tiles, all of them from planes that are read once.
  /// `before_tiles` may refuse a frame whose window has no room.
  PartRows cut(FrameSource& source, const WindowLimits& limits,
               const std::function<void(const WindowLimits&, const Window&)>& before_tiles = {}) {
    const Window& written = written_of(source);
    if (!planes_ && !source.region && limits.allow(source.reading.data))
      return {{FramePart{source.reading.data, written}}};
    const Stopwatch reading;
    const WindowLimits of_parts = limits.in_parts(source, settings_);
    read_for_parts(source, settings_, read_, of_parts.budget.bytes - of_parts.kept);
    Surroundings surroundings(source, settings_, read_[RawPlane::depth]);
    const Window computed = surroundings.around(written);
    if (of_parts.allow(computed)) {
      report_.read_ms += reading.ms();
      return {{FramePart{computed, written}}};
    }
    why_in_parts_ = of_parts.why_not(computed);
    if (before_tiles) before_tiles(of_parts, computed);
    PartRows rows;
    for (const auto& row : tiles_of(written, surroundings, of_parts, source)) {
      auto& parts = rows.emplace_back();
      for (const auto& tile : row) parts.push_back({surroundings.around(tile), tile});
    }
    report_.read_ms += reading.ms();
    return rows;
  }

  /// Whether the frame's own pass looks at surfaces of others: not where its estimate holds all that it takes of them.
  bool needs_others() const {
    const auto& wanted = settings_.output;
    return !run_.takes_means || shows(wanted, DebugSource::hidden) || wants(wanted, &FrameOutputs::hidden) ||
           wants(wanted, &FrameOutputs::confidence) || wants(wanted, &FrameOutputs::shadow);
  }

  /// Finds the surfaces and estimates of others, once for all parts of the frame.
  void take_others(const FrameSource& source) {
    if (!run_.shot) return;
    const Stopwatch reading;
    PreparationCost cost;
    if (run_.takes_means)
      estimates_ = run_.shot->estimates_of(frame_, [&](int other) { return estimate_of(other, cost); });
    if (needs_others()) others_ = run_.shot->views().of(gpu_, source, frame_, cost);
    tally_.add_others(cost);
    if (run_.takes_means) take_estimates();
    if (!others_.frames.empty() || !others_.missing.empty()) report_.frames_around = others_.frames;
    report_.read_ms += reading.ms();
    throw_if_stopped();
  }

  /// What the frame's own estimate was made of and has found counts as the frame's.
  void take_estimates() {
    const EstimatedFrame& own = estimates_.own(frame_);
    if (others_.seen.empty()) others_ = own.others;
    tally_.add_estimate(own.report, others_);
    in_slots_ = lane_.estimates.filled(gpu_, run_.plan, estimates_, frame_, budget_.buffer_bytes);
    read_ = std::move(estimates_.read);
  }

  /// Reads a window. `number`: keys the noise.
  FrameInputs read(FrameSource& source, const Window& window, int number) {
    tally_.begin(window);
    watch_(++part_, parts_, 0);
    FrameInputs inputs = load_frame(gpu_, source, window, settings_, number, &read_);
    inputs.others = others_.seen;
    return inputs;
  }

  /// Reads a window for the frame's files.
  FrameInputs load(FrameSource& source, const Window& window) {
    const Stopwatch reading;
    FrameInputs inputs = read(source, window, frame_);
    inputs.lights = lights_;
    inputs.estimates = in_slots_;
    inputs.estimates.corner = {window.x - source.reading.data.x, window.y - source.reading.data.y};
    tally_.add_inputs(source, window, inputs, written_of(source));
    report_.read_ms += reading.ms();
    refuse_by_notes(source);
    throw_if_stopped();
    return inputs;
  }

  /// Runs what is recorded. Gives its device time, ms.
  double run_passes() {
    gpu_.run([&](double done) { watch_(part_, parts_, done); });
    tally_.add_passes(gpu_.passes());
    return milliseconds_of(gpu_.passes());
  }

  /// Reads and computes a window, of which `part` is kept. reuses: what is as in the frame before is not computed
  /// again.
  FrameOutputs compute(FrameSource& source, const Window& window, const Window& part, bool reuses) {
    FrameInputs inputs = load(source, window);
    const Stopwatch comparing;
    reuses = reuses && last_.is_worth_comparing(inputs);
    const bool is_same = reuses && last_.is_same(gpu_, inputs, settings_.estimator);
    if (!reuses) last_.forget();
    report_.read_ms += comparing.ms();
    const FrameOutputs outputs =
        is_same ? last_.outputs() : run_chain(gpu_, inputs, settings_.estimator, settings_.output);
    if (!is_same) {
      const double ms = run_passes();
      if (!inputs.changes) last_.took(ms);
      if (outputs.count) in_slots_.is_further_part = true;
    }
    if (reuses) last_.keep(outputs);
    tally_.add_outputs(outputs, window, is_same);
    tally_.add_composite(source, window, part, inputs, outputs, written_of(source));
    throw_if_stopped();
    return outputs;
  }

  /// By what is noted so far.
  Provenance provenance() const {
    return {run_.provenance.options,    run_.provenance.device, run_.identities.of(frame_),
            header_text(report_.notes), text_of(others_),       text_of(estimates_)};
  }

  /// Computes the visibility once, and the results of each look from it.
  void run_looks(FrameSource& source, const Window& computed) {
    FrameInputs inputs = load(source, computed);
    last_.forget();
    const FrameVisibility visible = frame_visibility(gpu_, inputs, settings_.estimator, settings_.output);
    run_passes();
    LookTime time{report_.compute_ms};  // with what other frames took
    for (std::size_t i = 0; i < run_.looks.size(); i++) {
      throw_if_stopped();
      const Settings& look = run_.looks[i];
      if (const auto& lights = look.output.read_lights) inputs.lights = lights->in_view(source.reading.camera, frame_);
      const FrameOutputs outputs = results_of(gpu_, inputs, visible, look.estimator, look.output);
      time.own_ms = run_passes();
      // What is noted is the same of each, but for the light that looks turn.
      if (i == 0) {
        FrameOutputs shared = outputs;
        if (run_.looks.size() > 1) shared.shadow = nullptr;
        tally_.add_outputs(shared, computed, false);
        finish_tally(source);
      }
      run_.take_look(i, source, computed, outputs, time);
    }
  }

  void run_whole(FrameSource& source, const Window& computed) {
    if (run_.take_look) return run_looks(source, computed);
    const EstimatorSettings& estimator = settings_.estimator;
    const bool reuses =
        run_.plan.frames().size() > 1 && !estimator.no_skip && estimator.noise == Noise::fixed && !run_.takes_means;
    const FrameOutputs outputs = compute(source, computed, written_of(source), reuses);
    finish_tally(source);
    const Stopwatch writing;
    const Provenance by = provenance();
    make_folders(files_of(settings_, FileRole::output), settings_.output);
    FrameWriter writer(source, settings_, by);
    write_planes(writer, written_of(source), computed, result_planes(outputs, computed, settings_.output));
    TakePreview take_preview;
    if (run_.take_preview) take_preview = [this](const auto& shown) { run_.take_preview(frame_, shown); };
    write_pictures(source, computed, outputs, run_.transform, settings_.output, by, take_preview);
    writer.finish(by.notes);
    report_.write_ms += writing.ms();
  }

  /// Writes the planes of a window over `written`, a part of it or all; so many rows at once are cropped or made half.
  static void write_planes(FrameWriter& writer, const Window& written, const Window& computed,
                           const std::vector<std::span<const float>>& planes) {
    Window rows = written;
    for (; rows.y < written.y + written.height; rows.y += kRowsWritten) {
      rows.height = std::min(kRowsWritten, written.y + written.height - rows.y);
      std::vector<std::vector<float>> regions;
      std::vector<std::span<const float>> parts;
      const std::size_t first = std::size_t(rows.y - computed.y) * std::size_t(computed.width);
      for (const auto& plane : planes)
        parts.push_back(written == computed ? plane.subspan(first, rows.pixels())
                                            : regions.emplace_back(cropped(plane, computed, rows)));
      writer.write(parts);
    }
  }

  void finish_tally(const FrameSource& source) {
    tally_.finish(source, settings_);
    refuse_warnings(report_.notes, settings_, report_.input);
  }

  void run_tiles(FrameSource& source, const PartRows& rows) {
    make_folders(files_of(settings_, FileRole::output), settings_.output);
    FrameWriter writer(source, settings_, provenance());
    report_.parts = 0;
    parts_ = 0;
    for (const auto& row : rows) parts_ += int(row.size());
    for (const auto& row : rows) {
      const auto planes = compute_row(source, row);
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
    const std::uint64_t bytes = picture_of(source.reading, source.reading.display).pixels() * kBytes * side_by_side;
    if (bytes > budget_.bytes)
      limits.refuse(fmt::format("{}: {} shows the display window, {}: {}", report_.input,
                                run_.take_look ? "a wedge" : "a preview", to_string(source.reading.display),
                                run_.take_look ? "use a smaller frame" : "leave out --preview"),
                    MemoryNeeds{bytes, bytes});
  }

  void refuse_pictures(const FrameSource& source, WindowLimits limits, const Window& computed) const {
    const std::string reason = why_whole(settings_, bool(run_.take_look));
    if (reason.empty()) return;
    if (!source.region && !planes_) limits.kept = 0;  // all of it is read into its buffers
    limits.refuse(fmt::format("{}: a frame this large is computed in tiles, and {}", report_.input, reason), computed);
  }

  /// The planes of the results over one row of tiles.
  std::vector<std::vector<float>> compute_row(FrameSource& source, const std::vector<FramePart>& row) {
    const Window &first = row.front().part, &last = row.back().part;
    const Window whole{first.x, first.y, last.x + last.width - first.x, first.height};
    std::vector<std::vector<float>> planes;
    for (const auto& [computed, tile] : row) {
      const FrameOutputs outputs = compute(source, computed, tile, false);
      const auto results = result_planes(outputs, computed, settings_.output);
      planes.resize(results.size());
      for (std::size_t i = 0; i < results.size(); i++) put_in(results[i], computed, tile, whole, planes[i]);
      report_.parts++;
    }
    return planes;
  }

  Lane& lane_;
  gpu::Recorder& gpu_ = lane_.gpu;
  LastFrame& last_ = lane_.last;
  const RunContext& run_;
  const MemoryBudget& budget_;
  int frame_;
  const PartWatch& watch_;
  int part_ = 0, parts_ = 1;
  std::string why_in_parts_;
  Settings settings_;
  Neighbours others_;             // that the frame takes
  NeighbourEstimates estimates_;  // the same
  ReadPlanes* const planes_;      // see RunContext
  ReadPlanes own_planes_;
  // of the whole frame, for its parts; without planes these come from the files
  ReadPlanes& read_ = planes_ ? *planes_ : own_planes_;
  EstimateSet in_slots_;  // these for all parts of the frame
  FrameReport& report_;
  FrameTally tally_;
  std::vector<Light> lights_;  // in view space
};

}  // namespace

FrameReport report_of(const FramePlan& plan, int frame) {
  const Settings settings = plan.at(frame);
  FrameReport report;
  report.frame = frame;
  report.input = main_input(settings.input);
  report.output = settings.output.output;
  return report;
}

namespace {

/// Puts into a report why its frame failed, and whether the device is why.
void put_failure(FrameReport& report, const Error& error) {
  report.state = FrameState::failed;
  report.error = error;
  report.out_of_memory = dynamic_cast<const gpu::OutOfMemory*>(&error) != nullptr;
  report.device_lost = dynamic_cast<const gpu::DeviceLost*>(&error) != nullptr;
}

FrameReport run_on(Lane& lane, const RunContext& run, const MemoryBudget& budget, int frame, const PartWatch& watch) {
  FrameReport report;
  lane.gpu.abandon();  // commands that a frame that failed has left
  try {
    report = report_of(run.plan, frame);
    FrameRun(lane, run, budget, frame, watch, report).run();
    report.state = FrameState::done;
  } catch (const Dropped&) {
    report.state = FrameState::dropped;
  } catch (const Error& error) {
    put_failure(report, error);
    // Devices and numbers know of no file. A lost device is lost for all frames.
    const bool may_be_without = error.kind() == ErrorKind::device || error.kind() == ErrorKind::usage;
    const bool is_named = !may_be_without || report.device_lost ||
                          std::string_view(error.what()).find(report.input) != std::string_view::npos;
    if (!is_named) report.error = Error(error.kind(), fmt::format("{}: {}", report.input, error.what()));
  } catch (const std::bad_alloc&) {
    put_failure(report,
                Error(ErrorKind::device,
                      fmt::format("{}: no memory is left for it: let a run take less by --memory", report.input)));
  } catch (const std::exception& error) {
    put_failure(report, Error(ErrorKind::some_frames_failed, fmt::format("{}: {}", report.input, error.what())));
  }
  return report;
}

}  // namespace

EstimatedFrame estimate_frame(Lane& lane, const RunContext& run, const MemoryBudget& budget, int frame,
                              PreparationCost& cost) {
  FrameReport report;
  return FrameRun(
             lane, run, budget, frame, [](int, int, double) {}, report)
      .estimate_of(frame, cost);
}

FrameReport run_frame(Lanes& lanes, const RunContext& run, const MemoryBudget& budget, int frame,
                      const PartWatch& watch) {
  try {
    Lanes::Lease lease(lanes);
    FrameReport report = run_on(lease.lane(), run, budget, frame, watch);
    if (!report.out_of_memory) lease.keep_buffers();
    return report;
  } catch (const Error& error) {  // of making the lane, which is no fault of the frame
    FrameReport report = report_of(run.plan, frame);
    put_failure(report, error);
    if (!report.out_of_memory && !report.device_lost) throw;
    return report;
  }
}

}  // namespace alcove
