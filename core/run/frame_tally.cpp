// Sums, and the sentences that tell of them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_tally.h"

#include <algorithm>
#include <numeric>

#include "core/base/estimator_facts.h"

namespace alcove {

void FrameTally::begin(const Window& computed) {
  report_.pixels_at_once = std::max<std::uint64_t>(report_.pixels_at_once, computed.pixels());
}

void FrameTally::add_passes(std::span<const gpu::PassTime> passes) {
  for (std::size_t i = 0; i < passes.size(); i++) {
    if (i >= report_.passes.size()) report_.passes.push_back({passes[i].name});
    report_.passes[i].ms += passes[i].ms;
    report_.passes[i].bytes_read += passes[i].bytes_read;
    report_.passes[i].bytes_written += passes[i].bytes_written;
    report_.compute_ms += passes[i].ms;
  }
}

void FrameTally::add_outputs(const FrameOutputs& outputs, const Window& computed, bool is_same) {
  const auto counts = outputs.counts->as<FrameCounts>()[0];
  counts_.sky += counts.sky;
  counts_.repaired_depth += counts.repaired_depth;
  counts_.repaired_normals += counts.repaired_normals;
  counts_.repaired_material += counts.repaired_material;
  counts_.repaired_beauty += counts.repaired_beauty;
  report_.pixels += computed.pixels();
  has_ao_ = outputs.ao;

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
  if (outputs.tiles) {
    const auto tiles = outputs.tiles->as<TileCounts>()[0];
    report_.tiles.sky += tiles.sky;
    report_.tiles.proved += tiles.open;
    report_.tiles.tolerated += tiles.tolerated;
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
  report_.sky_pixels = counts_.sky;
  report_.repaired_pixels =
      counts_.repaired_depth + counts_.repaired_normals + counts_.repaired_material + counts_.repaired_beauty;
  if (has_ao_) {
    const std::vector<double> radii = radii_of(settings.estimator);
    report_.notes = sample_.notes(radii.front(), radii.back(), source.file_data.width, source.file_data.height);
    report_.samples_per_pixel =
        samples_per_estimate(settings.estimator) * estimates_of(settings.estimator) / double(report_.pixels);
    // An estimator that completes nothing, and sky, are no reason to leave the share out: it is 0.
    if (!settings.output.stats.empty() && !report_.occlusion) report_.occlusion.emplace();
  }
  note_repairs();
  note_missing(source);
  for (const auto* known : {&source.suspicious, &source.notes})
    report_.notes.insert(report_.notes.begin(), known->begin(), known->end());
}

double FrameTally::estimates_of(const EstimatorSettings& settings) const {
  if (report_.estimates) return double(std::accumulate(report_.estimates->begin(), report_.estimates->end(), 0ull));
  const double factor = double(settings.resolution);
  return double(report_.pixels - report_.sky_pixels) / (factor * factor);
}

void FrameTally::note_repairs() {
  auto& notes = report_.notes;
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
}

void FrameTally::note_missing(const FrameSource& source) {
  if (source[RawPlane::normal].empty())
    report_.notes.push_back(
        "there is no normal channel; normals were reconstructed from depth (--normal, --normal-channels)");
  if (!source[RawPlane::beauty].empty() && source[RawPlane::indirect].empty())
    report_.notes.push_back(
        "the frame has no indirect diffuse part: the composite is the whole beauty times AO, which dims direct light "
        "too");
}

}  // namespace alcove
