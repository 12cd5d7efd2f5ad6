// Counts, and the notes that follow from them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_tally.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/results/outputs.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/samples.h"
#include "kernels/hidden/hidden.h"

namespace alcove {

namespace {

constexpr std::size_t kSampled = 4096;  // pixels of a beauty and its composite
constexpr float kNoise = 0.5F;          // of the beauty; noise of a layer takes less
constexpr double kMostNegative = 0.01;  // share of the sampled pixels; fewer are noise
constexpr double kFarLamp = 20;         // times the farthest depth; lamps that light what is seen are nearer

}  // namespace

void FrameTally::begin(const Window& computed) {
  report_.pixels_at_once = std::max<std::uint64_t>(report_.pixels_at_once, computed.pixels());
  if (taker_) taker_->begin(computed);
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

namespace {

/// The counts that a pass has left in a buffer; zeros without one.
template <class T>
T counts_in(const gpu::Buffer* buffer) {
  return buffer ? buffer->as<T>()[0] : T{};
}

/// The sums of pairs over tiles.
std::pair<double, double> sums_in(const gpu::Buffer& pairs) {
  std::pair<double, double> sums{0, 0};
  for (const vec2& pair : pairs.as<const vec2>()) {
    sums.first += pair.x;
    sums.second += pair.y;
  }
  return sums;
}

}  // namespace

void FrameTally::add_outputs(const FrameOutputs& outputs, const Window& computed, bool is_same) {
  report_.pixels += computed.pixels();
  has_ao_ = outputs.ao;
  is_quick_ = is_quick_ || outputs.is_quick;
  add_surfaces(outputs);
  add_errors(outputs, computed);
  add_lights(outputs, computed);
  add_work(outputs, is_same);
}

void FrameTally::add_surfaces(const FrameOutputs& outputs) {
  const auto counts = counts_in<FrameCounts>(outputs.counts);
  counts_.sky += counts.sky;
  counts_.repaired_depth += counts.repaired_depth;
  counts_.repaired_normals += counts.repaired_normals;
  counts_.turned_normals += counts.turned_normals;
  counts_.repaired_material += counts.repaired_material;
  counts_.repaired_beauty += counts.repaired_beauty;
  const auto views = counts_in<ViewCounts>(outputs.view_counts);
  report_.moved += views.moved;
  report_.unconfirmed += views.unconfirmed;
  if (!outputs.layer_counts) return;
  const auto layers = counts_in<LayerCounts>(outputs.layer_counts);
  if (!report_.hidden) report_.hidden.emplace();
  report_.hidden->surfaces += layers.surfaces;
  report_.hidden->dropped += layers.dropped;
}

/// Adds errors, the share of completed surfaces, and the number of averaged frames.
void FrameTally::add_errors(const FrameOutputs& outputs, const Window& computed) {
  if (outputs.squares) {
    const auto [squares, pixels] = sums_in(*outputs.squares);
    report_.error_squares += squares;
    report_.error_pixels += pixels;
  }
  if (outputs.completion) {
    const auto [by_completed, whole] = sums_in(*outputs.completion);
    if (!report_.occlusion) report_.occlusion.emplace();
    report_.occlusion->by_completed += by_completed;
    report_.occlusion->whole += whole;
  }
  if (outputs.count)
    for (const float count : outputs.count->as<const float>().first(computed.pixels()))
      report_.accumulated += double(count);
}

/// Adds the pixels that each light reaches. Planes of confidence behind them are counted too, and not asked for.
void FrameTally::add_lights(const FrameOutputs& outputs, const Window& computed) {
  if (!outputs.shadow) return;
  const auto seen = outputs.shadow->as<const float>();
  lit_.resize(seen.size() / computed.pixels());
  for (std::size_t i = 0; i < lit_.size(); i++)
    lit_[i] += std::uint64_t(std::ranges::count_if(seen.subspan(i * computed.pixels(), computed.pixels()),
                                                   [](float part) { return part > 0; }));
}

/// Adds tiles and estimates; is_same: none was computed.
void FrameTally::add_work(const FrameOutputs& outputs, bool is_same) {
  const auto tiles = counts_in<TileCounts>(outputs.tiles);
  report_.tiles.sky += tiles.sky;
  report_.tiles.kept += tiles.kept + (is_same ? tiles.listed : 0);
  report_.tiles.computed += is_same ? 0 : tiles.listed;
  if (!outputs.sites) return;
  if (!report_.estimates) report_.estimates.emplace();
  if (is_same) return;
  const auto sites = counts_in<SiteCounts>(outputs.sites);
  for (std::size_t k = 0; k < kLattices; k++) (*report_.estimates)[k] += sites.of_lattice[k];
  // A quick search does not count its sites by lattice.
  if (outputs.is_quick) report_.estimates->back() += sites.listed;
}

void FrameTally::add_composite(const FrameSource& source, const Window& computed, const Window& part,
                               const FrameInputs& inputs, const FrameOutputs& outputs, const Window& written) {
  if (!outputs.composite || source.reading.supersampling > 1) return;  // the picture has other pixels then
  const auto beauty = inputs[RawPlane::beauty]->as<const float>(), composite = outputs.composite->as<const float>();
  const auto depth = inputs[RawPlane::depth]->as<const float>();
  for_each_sampled(inputs.view, depth, computed, written, kSampled, [&](const SampledPixel& pixel) {
    const int x = computed.x + int(pixel.at) % computed.width, y = computed.y + int(pixel.at) / computed.width;
    if (x < part.x || y < part.y || x >= part.x + part.width || y >= part.y + part.height) return;
    bool is_negative = false;
    for (std::size_t i = pixel.at; i < 3 * computed.pixels(); i += computed.pixels())
      is_negative = is_negative || (beauty[i] > 0 && composite[i] < -kNoise * beauty[i]);
    composed_++;
    negative_ += is_negative;
  });
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
  note_negative_composite(source);
  if (!settings.output.read_lights) return;
  note_dark_lights(source, *settings.output.read_lights);
  note_far_lamps(source, *settings.output.read_lights);
}

void FrameTally::note_negative_composite(const FrameSource& source) {
  const double share = double(negative_) / double(std::max<std::size_t>(1, composed_));
  if (share > kMostNegative)
    report_.notes.push_back(
        {NoteCode::negative_composite,
         fmt::format(
             "on {:.0f} % of the pixels the composite is far below 0, and the beauty is not: AO or shadows dim a layer "
             "that is not part of its light, such as a colour (--set ambient, --set shadow-layers)",
             100 * share),
         source.note_file(RawPlane::beauty)});
}

void FrameTally::note_far_lamps(const FrameSource& source, const LightsFile& lights) {
  const double farthest = sample_.farthest();
  if (farthest == 0 || source.region) return;  // of a region, the frame's farthest surface is not known
  for (const Light& light : lights.in_view(source.reading.camera, report_.frame))
    if (light.is_lamp && length(light.at) > kFarLamp * farthest)
      report_.notes.push_back(
          {NoteCode::far_lamp,
           fmt::format("the lamp \"{}\" is {:.0f} times as far away as the farthest surface: is its "
                       "\"position\" in the scene's units? (--lights)",
                       light.name, length(light.at) / farthest),
           lights.path});
}

void FrameTally::note_dark_lights(const FrameSource& source, const LightsFile& lights) {
  // Shadows of a supersampled frame are reduced already, and its sky is not.
  if (source.reading.supersampling > 1 || counts_.sky >= report_.pixels) return;
  for (std::size_t i = 0; i < std::min(lit_.size(), lights.lights.size()); i++)
    if (lit_[i] <= counts_.sky)
      report_.notes.push_back(
          {NoteCode::dark_light,
           fmt::format("the light \"{}\" reaches no surface of the frame (--lights)", lights.lights[i].name),
           lights.path});
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
  const auto note = [&](std::uint64_t count, NoteCode code, RawPlane plane, const std::string& text) {
    if (count > 0) report_.notes.push_back({code, text, source.note_file(plane)});
  };
  note(counts_.repaired_depth, NoteCode::repaired_depth, RawPlane::depth,
       counted(counts_.repaired_depth, "pixel") + " had a depth that is NaN or negative, which counts as sky");
  note(counts_.repaired_normals, NoteCode::repaired_normals, RawPlane::normal,
       fmt::format("{} had no usable normal{}, and got one from depth: give all surfaces normals (--normal), or if "
                   "this is sky, its depth (--sky)",
                   counted(counts_.repaired_normals, "pixel"), window_of_normals(source)));
  note(counts_.turned_normals, NoteCode::turned_normals, RawPlane::normal,
       counted(counts_.turned_normals, "pixel") +
           " had a normal that faced away from the eye, as on mirrored things "
           "and the backs of cards, and was turned round");
  note(counts_.repaired_material, NoteCode::repaired_material_ao, RawPlane::material_ao,
       counted(counts_.repaired_material, "pixel") + " had a material AO that is NaN or infinite, which counts as 1");
  note(
      counts_.repaired_beauty, NoteCode::repaired_beauty, RawPlane::beauty,
      counted(counts_.repaired_beauty, "pixel") + " had a beauty that is NaN or infinite, which is 0 in the composite");
  note(has_alpha_ && !has_coverage_ && counts_.sky < report_.pixels, NoteCode::transparent_beauty, RawPlane::beauty,
       "the beauty's alpha is 0 in all pixels, so the composite is the unchanged beauty: give --beauty a picture "
       "without alpha, or with the surfaces' alpha");
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

}  // namespace alcove
