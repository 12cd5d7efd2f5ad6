// Sums, and the sentences that tell of them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_tally.h"

#include <algorithm>
#include <numeric>

#include "core/base/estimator_facts.h"
#include "core/base/windows.h"
#include "core/frame/deep.h"
#include "kernels/hidden.h"
#include "kernels/warp.h"

namespace alcove {

void FrameTally::begin(const Window& computed) {
  report_.pixels_at_once = std::max<std::uint64_t>(report_.pixels_at_once, computed.pixels());
}

void FrameTally::add_inputs(const FrameSource& source, const FrameInputs& inputs, const Window& written) {
  const auto depth = inputs[RawPlane::depth]->as<float>();
  sample_.add(inputs.view, inputs.depth_map, inputs.depth_precision, depth, source.data, written);
  if (inputs[RawPlane::behind]) behind_.add(source, depth, inputs[RawPlane::behind]->as<float>(), source.data, written);
}

void FrameTally::add_others(const PreparedOthers& took) {
  rows_of_others_ += took.rows_read;
  for (const auto& pass : took.passes) {
    const std::string name = "others " + pass.name;
    auto found = std::ranges::find(report_.passes, name, &gpu::PassTime::name);
    if (found == report_.passes.end()) found = report_.passes.insert(found, {name});
    add(pass, *found);
  }
  before_ = report_.passes.size();
}

void FrameTally::add_estimate(const FrameReport& estimate, const Others& others) {
  report_.tiles = estimate.tiles;
  report_.estimates = estimate.estimates;
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
  }
}

void FrameTally::finish(const FrameSource& source, const Settings& settings) {
  if (report_.pixels == 0) report_.pixels = source.data.pixels();
  report_.rows_read = source.rows_read + rows_of_others_;
  report_.sky_pixels = counts_.sky;
  report_.repaired_pixels =
      counts_.repaired_depth + counts_.repaired_normals + counts_.repaired_material + counts_.repaired_beauty;
  report_.notes = notes_on(source);
  add_new(report_.notes, behind_.notes(source));
  add_new(report_.notes, deep_notes(source));
  if (has_ao_) {
    const std::vector<double> radii = radii_of(settings.estimator);
    add_new(report_.notes, sample_.notes(radii.front(), radii.back(), source.file_data.width, source.file_data.height));
    report_.samples_per_pixel =
        samples_per_estimate(settings.estimator) * estimates_of(settings.estimator) / double(report_.pixels);
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
  if (source[RawPlane::normal].empty()) return "";
  const Window& data = source.part_of(source[RawPlane::normal][0]).data;
  if (common_part(data, source.file_data) == source.file_data) return "";
  return fmt::format(": the normals of {} cover {} only, and the depth {}",
                     source.files[source[RawPlane::normal][0].file].path(), to_string(data),
                     to_string(source.file_data));
}

void FrameTally::note_repairs(const FrameSource& source) {
  auto& notes = report_.notes;
  if (counts_.repaired_depth)
    notes.push_back(
        {NoteCode::repaired_depth,
         fmt::format("{} pixels had a depth that is NaN or negative; they count as sky", counts_.repaired_depth)});
  if (counts_.repaired_normals)
    notes.push_back({NoteCode::repaired_normals,
                     fmt::format("{} pixels had no usable normal; it was reconstructed from depth{}",
                                 counts_.repaired_normals, window_of_normals(source)),
                     source.normal_file()});
  if (counts_.turned_normals)
    notes.push_back(
        {NoteCode::turned_normals,
         fmt::format("the normals of {} pixels faced away from the eye, as on mirrored things and the backs of cards; "
                     "they were turned round",
                     counts_.turned_normals),
         source.normal_file()});
  if (counts_.repaired_material)
    notes.push_back(
        {NoteCode::repaired_material_ao,
         fmt::format("{} pixels of the material AO were NaN or infinite; they count as 1", counts_.repaired_material)});
  if (counts_.repaired_beauty)
    notes.push_back({NoteCode::repaired_beauty,
                     fmt::format("{} pixels of the beauty were NaN or infinite; they are 0 in the composite",
                                 counts_.repaired_beauty)});
}

Notes FrameTally::notes_on(const FrameSource& source) {
  Notes notes = source.notes;
  add_new(notes, source.suspicious);
  if (source[RawPlane::normal].empty() && !source.normals_left_out)
    notes.push_back(
        {NoteCode::no_normals,
         "there is no normal channel; normals were reconstructed from depth (--normal, --normal-channels)"});
  if (!source[RawPlane::beauty].empty() && source[RawPlane::indirect].empty())
    notes.push_back({NoteCode::no_indirect_light,
                     "the frame has no indirect diffuse part: the composite is the whole beauty times AO, which dims "
                     "direct light too"});
  return notes;
}

}  // namespace alcove
