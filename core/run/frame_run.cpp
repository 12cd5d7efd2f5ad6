// The steps of a frame, the rows of tiles of a large one, and the sums and sentences of its report.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_run.h"

#include <algorithm>
#include <new>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/outputs.h"
#include "core/frame/pixels/detectors.h"
#include "core/frame/settle/settle.h"
#include "core/run/memory.h"
#include "core/run/run_files.h"
#include "kernels/hidden/hidden.h"

namespace alcove {

void FrameTally::begin(const Window& computed) {
  report_.pixels_at_once = std::max<std::uint64_t>(report_.pixels_at_once, computed.pixels());
}

void FrameTally::add_inputs(const FrameSource& source, const Window& computed, const FrameInputs& inputs,
                            const Window& written) {
  const auto depth = inputs[RawPlane::depth]->as<float>();
  sample_.add(inputs.view, inputs.depth_map, inputs.depth_precision, depth, computed, written);
  if (inputs[RawPlane::behind])
    behind_.add(source.reading, depth, inputs[RawPlane::behind]->as<float>(), computed, written);
  if (const auto* beauty = inputs[RawPlane::beauty]; beauty && planes_in(*beauty, inputs.view) == 4) {
    has_alpha_ = true;
    has_coverage_ = has_coverage_ || std::ranges::any_of(beauty->as<float>().subspan(3 * computed.pixels()),
                                                         [](float alpha) { return alpha > 0; });
  }
}

void FrameTally::add_others(const PreparationCost& cost) {
  rows_of_others_ += cost.rows_read;
  for (const auto& pass : cost.passes) {
    const std::string name = "others " + pass.name;
    auto found = std::ranges::find(report_.passes, name, &gpu::PassTime::name);
    if (found == report_.passes.end()) found = report_.passes.insert(found, {name});
    add(pass, *found);
  }
  before_ = report_.passes.size();
}

void FrameTally::add_estimate(const FrameReport& estimate, const Neighbours& others) {
  report_.tiles = estimate.tiles;
  report_.estimates = estimate.estimates;
  is_quick_ = is_quick_ || estimate.search == word_of(SliceSearch::quick);
  report_.occlusion = estimate.occlusion;
  if (!others.seen.empty()) return;  // the frame itself counts them
  report_.hidden = estimate.hidden;
  report_.moved = estimate.moved;
  report_.unconfirmed = estimate.unconfirmed;
}

void FrameTally::add_passes(std::span<const gpu::PassTime> passes) {
  // Parts of a frame run the same passes, but that some leave out what the first one has found for all.
  std::size_t next = before_;
  for (const auto& pass : passes) {
    const auto begin = report_.passes.begin() + std::ptrdiff_t(next);
    auto found = std::find_if(begin, report_.passes.end(), [&](const auto& sum) { return sum.name == pass.name; });
    if (found == report_.passes.end()) found = report_.passes.insert(begin, {pass.name});
    add(pass, *found);
    next = std::size_t(found - report_.passes.begin()) + 1;
  }
}

void FrameTally::add(const gpu::PassTime& pass, gpu::PassTime& sum) {
  sum.ms += pass.ms;
  sum.bytes_read += pass.bytes_read;
  sum.bytes_written += pass.bytes_written;
  report_.compute_ms += pass.ms;
}

void FrameTally::add_outputs(const FrameOutputs& outputs, const Window& computed, bool is_same) {
  const auto counts = outputs.counts->as<FrameCounts>()[0];
  counts_.sky += counts.sky;
  counts_.repaired_depth += counts.repaired_depth;
  counts_.repaired_normals += counts.repaired_normals;
  counts_.turned_normals += counts.turned_normals;
  counts_.repaired_material += counts.repaired_material;
  counts_.repaired_beauty += counts.repaired_beauty;
  report_.pixels += computed.pixels();
  has_ao_ = outputs.ao;
  is_quick_ = is_quick_ || outputs.is_quick;

  if (outputs.layer_counts) {
    const auto layers = outputs.layer_counts->as<LayerCounts>()[0];
    auto& hidden = report_.hidden ? *report_.hidden : report_.hidden.emplace();
    hidden.surfaces += layers.surfaces;
    hidden.dropped += layers.dropped;
  }
  if (outputs.squares)
    for (const vec2& tile : outputs.squares->as<const vec2>()) {
      report_.error_squares += tile.x;
      report_.error_pixels += tile.y;
    }
  if (outputs.completion) {
    auto& occlusion = report_.occlusion ? *report_.occlusion : report_.occlusion.emplace();
    for (const vec2& tile : outputs.completion->as<const vec2>()) {
      occlusion.by_completed += tile.x;
      occlusion.whole += tile.y;
    }
  }
  if (outputs.count)
    for (const float count : outputs.count->as<const float>().first(computed.pixels()))
      report_.accumulated += double(count);
  if (outputs.view_counts) {
    const ViewCounts views = outputs.view_counts->as<ViewCounts>()[0];
    report_.moved += views.moved;
    report_.unconfirmed += views.unconfirmed;
  }
  if (outputs.tiles) {
    const auto tiles = outputs.tiles->as<TileCounts>()[0];
    report_.tiles.sky += tiles.sky;
    report_.tiles.kept += tiles.kept + (is_same ? tiles.listed : 0);
    report_.tiles.computed += is_same ? 0 : tiles.listed;
  }
  if (outputs.sites) {
    const SiteCounts& sites = outputs.sites->as<SiteCounts>()[0];
    auto& estimates = report_.estimates ? *report_.estimates : report_.estimates.emplace();
    for (std::size_t k = 0; k < kLattices && !is_same; k++) estimates[k] += sites.of_lattice[k];
    // A quick search does not count its sites by lattice.
    if (outputs.is_quick && !is_same) estimates.back() += sites.listed;
  }
}

/// The search along slices that made the estimate, which the settings may only ask for; empty: there is none.
static std::string search_of(const EstimatorSettings& settings, bool is_quick) {
  if (!searches_slices(settings)) return "";
  if (settings.tolerance > 0) return word_of(SliceSearch::exact);
  return word_of(settings.search == SliceSearch::quick && !is_quick ? SliceSearch::steps : settings.search);
}

void FrameTally::finish(const FrameSource& source, const Settings& settings) {
  if (report_.pixels == 0) report_.pixels = source.reading.data.pixels();
  report_.rows_read = source.rows_read + rows_of_others_;
  report_.sky_pixels = counts_.sky;
  report_.repaired_pixels =
      counts_.repaired_depth + counts_.repaired_normals + counts_.repaired_material + counts_.repaired_beauty;
  report_.notes = notes_on(source, settings.input);
  if (counts_.sky == source.reading.data.pixels())
    add_new(report_.notes,
            {{NoteCode::no_surfaces, no_surfaces_text(source.channels[RawPlane::depth].front().channel)}});
  add_new(report_.notes, behind_.notes(source));
  add_new(report_.notes, deep_notes(source));
  if (has_ao_) {
    report_.search = search_of(settings.estimator, is_quick_);
    const std::vector<double> radii = radii_of(settings.estimator);
    add_new(report_.notes,
            sample_.notes(radii.front(), radii.back(), source.reading.data.width, source.reading.data.height));
    report_.samples_per_pixel =
        samples_of(settings.estimator, estimates_of(settings.estimator)) / double(report_.pixels);
    // An estimator that completes nothing, and sky, are no reason to leave the share out: it is 0.
    if (!settings.output.stats.empty() && !report_.occlusion) report_.occlusion.emplace();
  }
  note_repairs(source);
}

double FrameTally::estimates_of(const EstimatorSettings& settings) const {
  if (report_.estimates) return double(std::accumulate(report_.estimates->begin(), report_.estimates->end(), 0ull));
  const double factor = double(settings.resolution);
  return double(report_.pixels - report_.sky_pixels) / (factor * factor);
}

/// Says that pixels may have no normal because the file has none there.
static std::string window_of_normals(const FrameSource& source) {
  if (source.channels[RawPlane::normal].empty()) return "";
  const Window& data = source.part_of(source.channels[RawPlane::normal][0]).data;
  if (common_part(data, source.reading.data) == source.reading.data) return "";
  return fmt::format(" (those of {} cover {} only, and the depth {})",
                     source.files[source.channels[RawPlane::normal][0].file].path(), to_string(data),
                     to_string(source.reading.data));
}

void FrameTally::note_repairs(const FrameSource& source) {
  auto& notes = report_.notes;
  if (counts_.repaired_depth)
    notes.push_back(
        {NoteCode::repaired_depth,
         fmt::format("{} pixels had a depth that is NaN or negative; they count as sky", counts_.repaired_depth),
         source.note_file(RawPlane::depth)});
  if (counts_.repaired_normals)
    notes.push_back({NoteCode::repaired_normals,
                     fmt::format("{} pixels had no usable normal{}, and got one from depth: give all surfaces normals "
                                 "(--normal), or if these pixels are sky, its depth (--sky)",
                                 counts_.repaired_normals, window_of_normals(source)),
                     source.note_file(RawPlane::normal)});
  if (counts_.turned_normals)
    notes.push_back({NoteCode::turned_normals,
                     fmt::format("the normals of {} pixels faced away from the eye, as on mirrored things and the "
                                 "backs of cards, and were turned round",
                                 counts_.turned_normals),
                     source.note_file(RawPlane::normal)});
  if (counts_.repaired_material)
    notes.push_back(
        {NoteCode::repaired_material_ao,
         fmt::format("{} pixels of the material AO were NaN or infinite; they count as 1", counts_.repaired_material),
         source.note_file(RawPlane::material_ao)});
  if (counts_.repaired_beauty)
    notes.push_back({NoteCode::repaired_beauty,
                     fmt::format("{} pixels of the beauty were NaN or infinite; they are 0 in the composite",
                                 counts_.repaired_beauty),
                     source.note_file(RawPlane::beauty)});
  if (has_alpha_ && !has_coverage_ && counts_.sky < report_.pixels)
    notes.push_back({NoteCode::transparent_beauty,
                     "the beauty's alpha is 0 in all pixels, so the composite is the unchanged beauty: give --beauty a "
                     "picture without alpha, or with the surfaces' alpha",
                     source.note_file(RawPlane::beauty)});
}

Notes FrameTally::notes_on(const FrameSource& source, const InputSettings& settings) {
  Notes notes = source.notes;
  add_new(notes, source.suspicious);
  if (source.channels[RawPlane::normal].empty() && wants_normals(settings))
    notes.push_back(
        {NoteCode::no_normals,
         "there is no normal channel; normals were reconstructed from depth (--normal, --normal-channels)"});
  if (!source.channels[RawPlane::beauty].empty() && dims_beauty(source.reading.ambient) && settings.ambient.empty())
    notes.push_back({NoteCode::no_indirect_light,
                     "the frame has no indirect diffuse part: the composite is the whole beauty times AO, which dims "
                     "direct light too; --set ambient names its ambient light, or beauty for all of it",
                     source.note_file(RawPlane::beauty)});
  return notes;
}

// The frame.

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
  FrameRun(Lane& lane, const RunContext& run, const MemoryBudget& budget, int frame, const PartWatch& watch,
           FrameReport& report)
      : gpu_(lane.gpu),
        last_(lane.last),
        slots_(lane.estimates),
        run_(run),
        budget_(budget),
        frame_(frame),
        watch_(watch),
        settings_(run.plan.at(frame)),
        report_(report),
        tally_(report) {}

  void run() {
    const Stopwatch total;
    throw_if_stopped();
    FrameSource source = open();
    require_numbered_lines(source, settings_.estimator);
    const WindowLimits limits{memory_of_looks(source), budget_, longest_side(settings_.estimator)};
    require_room_for_preview(source, limits);
    take_others(source);
    if (!run_.planes && !source.region && limits.allow(source.reading.data))
      run_whole(source, source.reading.data);
    else
      run_parts(source, limits.in_parts(source, settings_));
    if (report_.parts > 1) note_parts(source);
    report_.total_ms = total.ms();
  }

 private:
  /// Ends the frame here where the run is to stop.
  void throw_if_stopped() const {
    if (run_.stop && run_.stop()) throw Dropped{};
  }

  /// Reads the headers.
  FrameSource open() {
    const Stopwatch reading;
    FrameSource source = run_.look.open(settings_, frame_);
    if (run_.settled && settle_like_or_alone(source, *run_.settled, settings_.input, budget_.bytes))
      take_over_notes(source, *run_.settled);
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

  /// Computes what depends on a part of the frame, or the frame in tiles: all of them from planes that are read once.
  void run_parts(FrameSource& source, const WindowLimits& limits) {
    const Stopwatch reading;
    read_for_parts(source, settings_, read_, limits.budget.bytes - limits.kept);
    Surroundings surroundings(source, settings_, read_[RawPlane::depth]);
    const Window computed = surroundings.around(written_of(source));
    report_.read_ms += reading.ms();
    if (!limits.allow(computed)) return run_tiles(source, limits, surroundings);
    run_whole(source, computed);
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
    // Where the device has no memory for a part of an estimate, smaller ones are computed as of the frame itself.
    const auto begin = [this](const Window& computed) {
      throw_if_stopped();
      tally_.begin(computed);
    };
    if (run_.takes_means) estimates_ = run_.shot->estimates_of({gpu_, budget_, begin}, frame_, cost);
    if (needs_others()) others_ = run_.shot->neighbours_of(gpu_, source, frame_, cost);
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
    in_slots_ = slots_.filled(gpu_, run_.plan, estimates_, frame_, budget_.buffer_bytes);
    read_ = std::move(estimates_.read);
  }

  /// Reads a window.
  FrameInputs load(FrameSource& source, const Window& window) {
    tally_.begin(window);
    watch_(++part_, parts_, 0);
    const Stopwatch reading;
    FrameInputs inputs = load_frame(gpu_, source, window, settings_, frame_, &read_);
    inputs.others = others_.seen;
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

  /// Reads and computes a window. reuses: what is as in the frame before is not computed again.
  FrameOutputs compute(FrameSource& source, const Window& window, bool reuses) {
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
    const Seen seen = see(gpu_, inputs, settings_.estimator, settings_.output);
    run_passes();
    LookTime time{report_.compute_ms};  // with what other frames took
    for (std::size_t i = 0; i < run_.looks.size(); i++) {
      throw_if_stopped();
      const Settings& look = run_.looks[i];
      if (const auto& lights = look.output.read_lights) inputs.lights = lights->in_view(source.reading.camera, frame_);
      const FrameOutputs outputs = results_of(gpu_, inputs, seen, look.estimator, look.output);
      time.own_ms = run_passes();
      // What is noted is the same of each.
      if (i == 0) {
        tally_.add_outputs(outputs, computed, false);
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
    const FrameOutputs outputs = compute(source, computed, reuses);
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

  void run_tiles(FrameSource& source, const WindowLimits& limits, Surroundings& surroundings) {
    const Window computed = surroundings.around(written_of(source));
    why_in_parts_ = limits.why_not(computed);
    refuse_pictures(source, limits, computed);
    refuse_by_notes(source);
    const Stopwatch cutting;
    const auto tiles = tiles_of(written_of(source), surroundings, limits, source);
    report_.read_ms += cutting.ms();
    make_folders(files_of(settings_, FileRole::output), settings_.output);
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
    const std::uint64_t bytes = picture_of(source.reading, source.reading.display).pixels() * kBytes * side_by_side;
    if (bytes > budget_.bytes)
      limits.refuse(fmt::format("{}: {} shows the display window, {}: {}", report_.input,
                                run_.take_look ? "a wedge" : "a preview", to_string(source.reading.display),
                                run_.take_look ? "use a smaller frame" : "leave out --preview"),
                    MemoryNeeds{bytes, bytes});
  }

  /// Pictures show a frame on a scale of its own, which no tile knows.
  void refuse_pictures(const FrameSource& source, WindowLimits limits, const Window& computed) const {
    if (!run_.take_look && settings_.output.preview.empty() && settings_.output.debug.empty()) return;
    const char* const whose = run_.take_look                     ? "a wedge needs it whole: choose a region with --roi"
                              : settings_.output.preview.empty() ? "--set debug needs it whole: leave it out"
                                                                 : "--preview needs it whole: leave it out";
    if (!source.region && !run_.planes) limits.kept = 0;  // all of it is read into its buffers
    limits.refuse(fmt::format("{}: a frame this large is computed in tiles, and {}", report_.input, whose), computed);
  }

  /// The planes of the results over one row of tiles.
  std::vector<std::vector<float>> compute_row(FrameSource& source, Surroundings& surroundings,
                                              const std::vector<Window>& row) {
    const Window whole{row.front().x, row.front().y, row.back().x + row.back().width - row.front().x,
                       row.front().height};
    std::vector<std::vector<float>> planes;
    for (const auto& tile : row) {
      const Window computed = surroundings.around(tile);
      const FrameOutputs outputs = compute(source, computed, false);
      const auto results = result_planes(outputs, computed, settings_.output);
      planes.resize(results.size());
      for (std::size_t i = 0; i < results.size(); i++) put_in(results[i], computed, tile, whole, planes[i]);
      report_.parts++;
    }
    return planes;
  }

  gpu::Recorder& gpu_;
  LastFrame& last_;
  EstimateSlots& slots_;
  const RunContext& run_;
  const MemoryBudget& budget_;
  int frame_;
  const PartWatch& watch_;
  int part_ = 0, parts_ = 1;
  std::string why_in_parts_;
  Settings settings_;
  Neighbours others_;             // that the frame takes
  NeighbourEstimates estimates_;  // the same
  ReadPlanes own_planes_;
  // of the whole frame, for its parts; without planes these come from the files
  ReadPlanes& read_ = run_.planes ? *run_.planes : own_planes_;
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
    report.state = FrameState::failed;
    report.error = Error(ErrorKind::device,
                         fmt::format("{}: no memory is left for it: let a run take less by --memory", report.input));
  } catch (const std::exception& error) {
    report.state = FrameState::failed;
    report.error = Error(ErrorKind::some_frames_failed, fmt::format("{}: {}", report.input, error.what()));
  }
  return report;
}

}  // namespace

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
