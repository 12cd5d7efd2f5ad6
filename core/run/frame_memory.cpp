// Adds up the buffers that core/chain/chain.cpp makes for a frame, and what reading and writing takes beside them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_memory.h"

#include <algorithm>

#include "core/base/estimator_facts.h"
#include "core/chain/aov.h"
#include "core/chain/chain.h"
#include "core/chain/debug_view.h"
#include "core/chain/margin.h"
#include "core/formats/exr_copy.h"
#include "core/run/composite_window.h"
#include "kernels/bounds.h"
#include "kernels/classify.h"
#include "kernels/profile.h"
#include "kernels/refine.h"

namespace alcove {
namespace {

constexpr std::size_t kEndPlanes = 2;  // along rows and columns
// Words per tile of 8 x 8: sectors, bounds of groups, runs of the filters, and how the frame before differs.
constexpr std::size_t kTileLists = 8;
constexpr std::size_t kCompletionSums = 2;  // words per tile
// Words per tile where pixels share estimates: twice the words of its rows, those of flat links, and its sites.
constexpr std::size_t kSiteLists = 3 * kTile + kTile * kTile;
constexpr std::size_t kRefineLists = 7;  // there is one after each power of two directions
// The lists of the smallest window: words and counts.
constexpr std::uint64_t kListBytes = 16 << 10;

/// The most groups of `group` pixels that a window touches, wherever it lies.
std::uint64_t groups_in(const Window& window, int group) {
  const auto along = [&](int side) {
    return (std::uint64_t(side) + 2 * std::uint64_t(group) - 2) / std::uint64_t(group);
  };
  return along(window.width) * along(window.height);
}

/// Whether an AOV has buffers of its own, beside those of the estimate and of the frame.
bool has_own_planes(const Aov& aov) {
  return aov.planes != &FrameOutputs::ao && aov.planes != &FrameOutputs::scales && aov.planes != &FrameOutputs::depth &&
         aov.planes != &FrameOutputs::error;
}

/// Whether frames take anything from other frames or views.
bool looks_at_others(const InputSettings& input) { return input.around > 0 || input.around_all || input.other_views; }

/// Whether pixels have surfaces behind the first: of files, or of other frames and views.
bool is_layered(const FrameSource& source, const Settings& settings) {
  return settings.estimator.hidden > 0 && (!source.behind.empty() || looks_at_others(settings.input));
}

/// Whether others show what lies around the frame: surfaces that files show behind the first end with it.
bool has_margin(const FrameSource& source, const Settings& settings) {
  return source.behind.empty() && looks_at_others(settings.input);
}

/// The profiles of a line in an exact search: one of each surface of a pixel, and one more for what goes on unseen.
std::size_t profiles_of(const FrameSource& source, const Settings& settings) {
  return is_layered(source, settings) ? 1 + std::size_t(settings.estimator.hidden) + 1 : 1;
}

/// Planes of what others show behind the first surface, or in a margin alone.
std::size_t found_by_others(const FrameSource& source, const Settings& settings) {
  if (!looks_at_others(settings.input)) return 0;
  return std::max(std::size_t(settings.estimator.hidden), std::size_t(has_margin(source, settings)));
}

/// Planes of the estimate's resolution: the estimate, what filters and searches make beside it, and its depth and
/// normals.
std::size_t estimate_planes(const FrameSource& source, const Settings& settings, std::size_t estimated) {
  const auto& e = settings.estimator;
  std::size_t planes = estimated + (e.resolution == Resolution::full ? 0 : 2);
  planes += e.denoise == Denoise::none || e.tolerance > 0 ? 0 : 2 * estimated;  // rows, columns
  // what is hidden, of the estimate's pixels
  planes += e.resolution == Resolution::full || !is_layered(source, settings) ? 0 : std::size_t(e.hidden);
  const std::size_t profiles = profiles_of(source, settings);
  planes += searches_exactly(e) ? 3 * profiles + 1 : 0;                       // vertices, marks, neighbours; whole arcs
  planes += searches_exactly(e) && profiles > 1 ? 1 : 0;                      // slots
  planes += searches_exactly(e) && completes_anywhere(e) ? profiles + 1 : 0;  // what goes on, and behind what
  planes += e.tolerance > 0 ? 2 : 0;                                          // blocked arcs, error
  return planes + (Wanted(settings.output).completed && completes_anywhere(e) ? 1 : 0);
}

/// Planes of what lies behind the first surface: all that was found, what is kept and of what kind it is, and of files
/// also where it ends, of which pairing is made.
std::size_t hidden_planes(const FrameSource& source, const Settings& settings) {
  const std::size_t found = source.behind.size() + found_by_others(source, settings);
  if (!is_layered(source, settings)) return found;
  return found + std::size_t(settings.estimator.hidden) + 1 + (source.behind.empty() ? 0 : kEndPlanes);
}

/// Planes of a frame with a margin, and of all that is cut to the frame again.
std::size_t margin_planes(const FrameSource& source, const Settings& settings, std::size_t estimated) {
  if (!has_margin(source, settings)) return 0;
  const auto& o = settings.output;
  constexpr std::size_t kWide = 2, kCutNormal = 1;  // depth and normals with the margin
  const std::size_t cut_aovs = std::size_t(wants(o, &FrameOutputs::confidence)) + wants(o, &FrameOutputs::error);
  return kWide + kCutNormal + estimated + cut_aovs + std::size_t(settings.estimator.hidden);
}

/// Planes of what tells occluders from the rest: their matte, their depth and what is hidden behind it, at full
/// resolution and at that of the estimate, and once more for the confidence.
std::size_t occluder_planes(const FrameSource& source, const Settings& settings) {
  if (source[RawPlane::occluders].empty()) return 0;
  const std::size_t planes = 1 + (source[RawPlane::behind].empty() ? 0 : std::size_t(settings.estimator.hidden));
  const bool is_low = settings.estimator.resolution != Resolution::full;
  // The blocks of a low resolution have at most a quarter of the pixels, and normals that nobody reads.
  return 1 + planes * (wants(settings.output, &FrameOutputs::confidence) ? 2 : 1) + (is_low ? planes + 1 : 0);
}

/// Planes that are filtered to those of the picture.
std::size_t reduced_planes(const FrameSource& source, const Settings& settings) {
  if (source.supersampling == 1) return 0;
  std::size_t planes = 1 + (settings.output.multi_bounce ? 3 : 0);
  for (const auto& aov : aovs_of(settings.output)) planes += planes_of(aov, settings.estimator);
  return planes;
}

/// Planes of the frame's resolution, beside those that are read.
std::size_t frame_planes(const FrameSource& source, const Settings& settings, std::size_t estimated) {
  const auto& e = settings.estimator;
  const auto& o = settings.output;
  const std::size_t scales = 1 + e.further_radii.size();
  std::size_t planes = 2 + (e.resolution == Resolution::full ? 0 : estimated);  // depth, normals, the whole estimate
  const bool has_matte = !source[RawPlane::matte].empty();
  planes += shapes(e) || has_matte || !source[RawPlane::material_ao].empty() ? 1 + scales : 0;
  planes += has_matte ? 1 : 0;
  planes += occluder_planes(source, settings) + reduced_planes(source, settings);
  planes += needs_bent(e, o) ? 1 : 0;
  // thin, solid and perhaps completed: estimates, rows, columns
  planes += wants(o, &FrameOutputs::confidence) ? (completes_anywhere(e) ? 3 : 2) * 3 : 0;
  // the lists of its tiles, where those of the estimate are larger
  planes += wants(o, &FrameOutputs::confidence) && e.resolution != Resolution::full ? 2 : 0;
  planes += (o.multi_bounce ? 3 : 0) + source[RawPlane::beauty].size() + debug_views_of(o).size();
  for (const auto& aov : aovs_of(o)) planes += has_own_planes(aov) ? channels_of(aov, planes_of(aov, e)).size() : 0;
  planes += hidden_planes(source, settings) + margin_planes(source, settings, estimated);
  return planes;
}

/// What copying the beauty's file into the composite takes: rows of its channels, and two codecs.
std::uint64_t copied_bytes(const FrameSource& source, const OutputSettings& settings) {
  if (source[RawPlane::beauty].empty() || settings.composite_layers != "all") return 0;
  const ExrPart& part = source.part_of(source[RawPlane::beauty][0]);
  const std::uint64_t row = sizeof(float) * part.channels.size() * std::uint64_t(part.data.width);
  return kRowsOfOriginal * row + 2 * exr_codec_bytes(kRowsOfOutput * row);
}

/// The bytes of the lists of a tile of 8 x 8 pixels.
std::uint64_t tile_bytes(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& o = settings.output;
  const bool has_bracket = wants(o, &FrameOutputs::confidence);
  const int shares = (spacing_of(e) > 1 ? 1 : 0) + (has_bracket && spacing_of(bracket_of(e)) > 1 ? 1 : 0);
  const bool sums_completed = Wanted(o).completed && completes_anywhere(e);
  return sizeof(TileBounds) +
         (kTileLists + (sums_completed ? kCompletionSums : 0) + std::size_t(shares) * kSiteLists) * sizeof(uint) +
         (e.tolerance > 0 ? sizeof(JudgedTile) + sizeof(vec2) : 0) +
         (e.tolerance > 0 ? kRefineLists : 1) * sizeof(ListedTile);
}

}  // namespace

Window FrameMemory::with_margin(const Window& window) const {
  return {window.x, window.y, window.width + 2 * margin, window.height + 2 * margin};
}

std::uint64_t FrameMemory::on_device(const Window& window) const {
  const Window computed = with_margin(window);
  return computed.pixels() * planes + groups_in(computed, factor) * estimate +
         groups_in(computed, factor * kTile) * tile + kListBytes + fixed_on_device;
}

std::uint64_t FrameMemory::on_host(const Window& computed) const {
  return on_device(computed) + computed.pixels() * beside + fixed_bytes;
}

std::uint64_t FrameMemory::codec_bytes(std::uint64_t room) const {
  std::uint64_t bytes = 0;
  for (const std::uint64_t group : codec_groups) bytes += exr_codec_bytes(group, room / kCodecPart);
  return bytes;
}

FrameMemory memory_of(const FrameSource& source, const Settings& settings) {
  const std::size_t scales = 1 + settings.estimator.further_radii.size();
  const std::size_t bent = needs_bent(settings.estimator, settings.output) ? 3 : 0;
  const std::size_t estimated = scales + bent + (scales > 1 ? 1 : 0);
  std::size_t read = 0, widest = std::max<std::size_t>(scales, bent ? bent : 1);
  for (const auto& channels : source.planes.entries) {
    read += channels.size();
    widest = std::max(widest, channels.size());
  }
  if (searches_exactly(settings.estimator)) widest = std::max(widest, profiles_of(source, settings));
  if (is_layered(source, settings)) widest = std::max(widest, std::size_t(settings.estimator.hidden));
  if (is_layered(source, settings) && !source.behind.empty()) widest = std::max(widest, kEndPlanes);
  const bool appends_ao = !source[RawPlane::beauty].empty() && !settings.output.append_ao.empty();
  std::size_t written = source[RawPlane::beauty].size() + (appends_ao ? 1 : 0);
  for (const auto& aov : aovs_of(settings.output)) {
    const std::size_t channels = channels_of(aov, planes_of(aov, settings.estimator)).size();
    written += channels;
    widest = std::max(widest, channels);
  }
  // planes as shown, once more interleaved; two pictures, and both beside each other
  const std::size_t of_preview = settings.output.preview_style == "split" ? 18 : 6;
  // a number, its colour, that in bytes, and encoded
  const std::size_t of_view = settings.output.debug.empty() ? 0 : 6;
  const std::size_t pictures = std::max(of_view, settings.output.preview.empty() ? 0 : of_preview);
  FrameMemory memory;
  memory.planes = sizeof(float) * (read + frame_planes(source, settings, estimated));
  memory.estimate = sizeof(float) * estimate_planes(source, settings, estimated);
  memory.tile = tile_bytes(settings);
  memory.factor = int(settings.estimator.resolution);
  memory.margin = has_margin(source, settings) ? margin_of(source.file_data, source.file_data).before.x : 0;
  memory.written = sizeof(float) * written;
  // What is written may be there once more: cropped to a region, or as half.
  memory.beside = memory.written + sizeof(float) * pictures;
  memory.widest = sizeof(float) * widest;
  memory.codec_groups = {kRowsOfOutput * memory.written * std::uint64_t(source.file_data.width)};
  memory.fixed_bytes =
      exr_codec_bytes(memory.codec_groups[0]) + copied_bytes(source, settings.output) + composite_bytes(source);
  for (const auto& file : source.files) {
    memory.fixed_bytes += file.bytes_beside_pixels();
    if (file.codec_group() > 0) memory.codec_groups.push_back(file.codec_group());
  }
  return memory;
}

std::uint64_t raw_bytes_of(const FrameSource& source) {
  std::uint64_t channels = 0;
  for (const auto& plane : source.planes.entries) channels += plane.size();
  return sizeof(float) * channels * source.file_data.pixels();
}

}  // namespace alcove
