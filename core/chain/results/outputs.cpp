// The search in the table, what follows from what is found, and the results of sky.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/outputs.h"

#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/chain/base/planes.h"
#include "core/chain/estimate/estimate.h"
#include "core/frame/find/lights.h"

namespace alcove {
namespace {

bool is_of_visibility(const DebugView* view) {
  return view->source == DebugSource::raw_ao || view->source == DebugSource::denoised_ao ||
         view->source == DebugSource::completed || view->source == DebugSource::tiles ||
         view->source == DebugSource::count;
}

std::vector<std::string> shadow_channels(const OutputSettings& settings) {
  std::vector<std::string> channels;
  if (!settings.read_lights) return channels;
  for (const auto& light : settings.read_lights->lights) channels.push_back(fmt::format("shadow-{}.Y", light.name));
  if (std::ranges::count(split(settings.aovs), "confidence") > 0)
    for (const auto& light : settings.read_lights->lights)
      channels.push_back(fmt::format("shadow-{}.confidence", light.name));
  return channels;
}

}  // namespace

std::vector<std::string> aov_names() {
  std::vector<std::string> names;
  std::ranges::transform(kAovs, std::back_inserter(names), &AovRow::name);
  return names;
}

std::vector<Aov> aovs_of(const OutputSettings& settings) {
  std::vector<Aov> aovs;
  std::vector<std::string> names = split(settings.aovs);
  if (!settings.environment.empty()) names.emplace_back("relight");
  if (!settings.lights.empty()) names.emplace_back("shadow");
  for (const auto& name : names) {
    const auto row = std::ranges::find(kAovs, name, &AovRow::name);
    if (row == kAovs.end())
      fail(ErrorKind::usage, "--aov: there is no AOV \"{}\"{}; there is {}", name, suggestion(name, aov_names()),
           list_of(aov_names()));
    if (std::ranges::find(aovs, name, &Aov::name) != aovs.end()) continue;
    aovs.push_back({name, split(row->channels), row->planes, row->source, row->is_float});
    if (name == "shadow") aovs.back().channels = shadow_channels(settings);
    if (name == "ao" && !settings.ao_name.empty()) aovs.back().channels = {settings.ao_name};
    if (name != "ao" || settings.ao_channels == AoChannels::mono) continue;
    const std::string layer = settings.ao_name.empty() ? "" : settings.ao_name + ".";
    aovs.back().channels = {layer + "R", layer + "G", layer + "B"};
    if (settings.multi_bounce) aovs.back().planes = &FrameOutputs::color_ao;
  }
  return aovs;
}

std::size_t planes_of(const Aov& aov, const EstimatorSettings& settings) {
  if (aov.planes == &FrameOutputs::scales) return 1 + settings.further_radii.size();
  if (is_of_curvature(aov)) return planes_of_curvature(1 + settings.further_radii.size());
  return aov.planes == &FrameOutputs::hidden ? 2 * std::size_t(settings.hidden) : aov.channels.size();
}

std::vector<std::string> channels_of(const Aov& aov, std::size_t planes) {
  std::vector<std::string> channels;
  if (aov.planes == &FrameOutputs::hidden) {
    for (std::size_t i = 1; i <= planes / 2; i++)
      channels.insert(channels.end(), {fmt::format("hidden{}.Z", i), fmt::format("hidden{}.back", i)});
    return channels;
  }
  if (is_of_curvature(aov)) {
    channels = aov.channels;
    for (std::size_t i = 1; i < planes; i++) channels.push_back(fmt::format("{}{}.Y", aov.name, i));
    return channels;
  }
  if (aov.planes != &FrameOutputs::scales) return aov.channels;
  for (std::size_t i = 1; i <= planes; i++) channels.push_back(fmt::format("scale{}.Y", i));
  return channels;
}

void require_distinct_channels(const Settings& settings) {
  std::set<std::string> known;
  for (const auto& aov : aovs_of(settings.output))
    for (const auto& channel : channels_of(aov, planes_of(aov, settings.estimator)))
      if (!known.insert(channel).second)
        fail(ErrorKind::usage,
             "--aov: OUTPUT would have two channels {}: give the AO another --set ao-name, or the light another name",
             channel);
}

bool is_of_curvature(const Aov& aov) {
  return aov.planes == &FrameOutputs::convexity || aov.planes == &FrameOutputs::cavity ||
         aov.planes == &FrameOutputs::curvature;
}

bool wants(const OutputSettings& settings, gpu::Buffer* FrameOutputs::*planes) { return Wanted(settings).has(planes); }

Wanted::Wanted(const OutputSettings& settings)
    : aovs(aovs_of(settings)),
      debug_views(debug_views_of(settings)),
      multi_bounce(settings.multi_bounce),
      filter(settings.filter),
      look(settings.look) {
  const auto is_at_least = [](AovSource source) { return [source](const Aov& aov) { return aov.source >= source; }; };
  for (std::size_t i = 0; settings.read_lights && i < settings.read_lights->lights.size(); i++)
    lights.push_back({.at = {0, 0, 1}, .size = settings.read_lights->is_soft(i) ? 30.0 : 0.0});
  const auto shows_completed = [](const DebugView* view) { return view->source == DebugSource::completed; };
  completed = !settings.stats.empty() || std::ranges::any_of(debug_views, shows_completed);
  for (const AovSource source : {AovSource::open_directions, AovSource::transfer})
    order += std::ranges::any_of(aovs, is_at_least(source)) ? 1 : 0;
  previews_shadow = !settings.preview.empty() && settings.composite.empty() && settings.preview_style == "auto" &&
                    has(&FrameOutputs::shadow) && !has(&FrameOutputs::ao);
  visibility = std::ranges::any_of(aovs, is_at_least(AovSource::visibility)) || multi_bounce ||
               !settings.composite.empty() || (!settings.preview.empty() && !previews_shadow) ||
               std::ranges::any_of(debug_views, is_of_visibility);
}

bool Wanted::has(gpu::Buffer* FrameOutputs::*planes) const {
  return std::ranges::find(aovs, planes, &Aov::planes) != aovs.end();
}

bool Wanted::is_only_visibility() const {
  const auto is_ao = [](const Aov& aov) {
    return aov.planes == &FrameOutputs::ao || aov.planes == &FrameOutputs::scales;
  };
  return visibility && !only_own && std::ranges::all_of(aovs, is_ao) && !multi_bounce && debug_views.empty();
}

bool in_world(const Camera& camera, const OutputSettings& settings) {
  return settings.aov_space != NormalSpace::view && camera.view_from_world.has_value();
}

bool needs_ao(const OutputSettings& output) { return Wanted(output).visibility; }

bool needs_radius(const OutputSettings& output) { return needs_ao(output) || wants(output, &FrameOutputs::shadow); }

uint moment_order(const EstimatorSettings& settings, const Wanted& wanted) {
  return searches_slices(settings) ? wanted.order : 0;
}

bool is_open_sky(const FrameInputs& frame, const EstimatorSettings& settings, const Wanted& wanted) {
  return frame.is_sky && !settings.no_skip && wanted.is_only_visibility() && !frame[RawPlane::beauty] &&
         !frame[RawPlane::material_ao] && !frame[RawPlane::matte];
}

FrameOutputs open_sky(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings) {
  const ivec2 size = block_grid(frame, int(settings.resolution)).size;
  const std::size_t bytes = plane_bytes(frame.view);
  FrameOutputs out;
  out.counts = &gpu.buffer("open sky counts", sizeof(FrameCounts), gpu::Use::upload);
  out.tiles = &gpu.buffer("open sky tile counts", sizeof(TileCounts), gpu::Use::upload);
  out.ao = &gpu.buffer("open sky", bytes, gpu::Use::upload);
  out.scales = &gpu.buffer("open sky scales", radii_of(settings).size() * bytes, gpu::Use::upload);
  out.counts->as<FrameCounts>()[0] = {uint(pixels_of(frame.view)), 0, 0, 0, 0, 0};
  out.tiles->as<TileCounts>()[0] = {{}, 0, groups_of(size.x, uint(kTile)) * groups_of(size.y, uint(kTile)), 0, 0};
  for (const auto* planes : {out.ao, out.scales}) std::ranges::fill(planes->as<float>(), 1.0f);
  return out;
}

}  // namespace alcove
