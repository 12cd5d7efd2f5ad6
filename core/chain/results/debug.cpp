// The table of debug views, and the pass that makes their numbers; core/run/frame_files.cpp draws the pictures.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/debug.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "core/base/error.h"
#include "core/base/text.h"
#include "kernels/results/results.h"

namespace alcove {
namespace {

constexpr std::array kViews{
    DebugView{"raw-depth", "raw depth: the channel as the file holds it", kDebugValue, DebugSource::raw_depth,
              DebugScale::percentile, 0, 0, false},
    DebugView{"linear-depth", "linear depth: distance along the optical axis, scene units", kDebugPlanarDepth,
              DebugSource::none, DebugScale::percentile, 0, 0, false},
    DebugView{"view-z", "view z: z in view space, scene units (logarithmic)", kDebugViewZ, DebugSource::none,
              DebugScale::percentile_logarithmic, 0, 0, false},
    DebugView{"view-normal-z", "view normal z: 1 faces along the optical axis", kDebugNormalZ, DebugSource::none,
              DebugScale::fixed, -1, 1, false},
    DebugView{"reconstruction", "reconstruction: degrees between the normals and those from depth; 30 and more are one",
              kDebugNormalAngle, DebugSource::normals_from_depth, DebugScale::fixed, 0, 30, false},
    DebugView{"raw-ao", "raw AO: as estimated, of the smallest radius, at its own resolution; 1 is open", kDebugValue,
              DebugSource::raw_ao, DebugScale::fixed, 0, 1, true},
    DebugView{"denoised-ao", "denoised AO: before upsampling and shaping; 1 is open", kDebugValue,
              DebugSource::denoised_ao, DebugScale::fixed, 0, 1, true},
    DebugView{"completed", "completed: visibility blocked by guessed parts of surfaces", kDebugValue,
              DebugSource::completed, DebugScale::fixed, 0, 1, true},
    DebugView{"density",
              "density: share of the pixels with an estimate of their own, in squares of 4 x 4 (logarithmic)",
              kDebugDensity, DebugSource::sites, DebugScale::fixed_logarithmic, 1.0f / 16, 1, false},
    DebugView{"tiles", "tiles: 1 is estimated, 0 as in the frame before or not needed", kDebugTile, DebugSource::tiles,
              DebugScale::fixed, 0, 1, false},
    DebugView{"hidden", "hidden: surfaces behind the first; half a surface more where one closes a solid", kDebugHidden,
              DebugSource::hidden, DebugScale::fixed, 0, 3.5f, false},
    DebugView{"count", "count: frames in the mean of the AO (logarithmic)", kDebugValue, DebugSource::count,
              DebugScale::fixed_logarithmic, 1, 33, false},
    DebugView{"edges", "edges: a neighbour's distance from the tangent plane, part of the depth (logarithmic)",
              kDebugEdge, DebugSource::none, DebugScale::fixed_logarithmic, 1e-4f, 1, false},
};

/// The normals that the frame would have without any of its own.
const gpu::Buffer* normals_from_depth(gpu::Recorder& gpu, FrameInputs frame) {
  frame[RawPlane::normal] = nullptr;
  return reconstruct(gpu, prepare(gpu, frame, "debug ")).normal;
}

}  // namespace

std::vector<std::string> debug_view_names() {
  std::vector<std::string> names;
  std::ranges::transform(kViews, std::back_inserter(names), &DebugView::name);
  return names;
}

std::vector<const DebugView*> debug_views_of(const OutputSettings& settings) {
  std::vector<const DebugView*> views;
  if (settings.debug.empty()) return views;
  for (const auto& name : split(settings.debug)) {
    const auto found = std::ranges::find(kViews, name, &DebugView::name);
    if (found == kViews.end())
      fail(ErrorKind::usage, "--set debug: there is no view \"{}\"{}; there is {}", name,
           suggestion(name, debug_view_names()), list_of(debug_view_names()));
    if (std::ranges::find(views, &*found) == views.end()) views.push_back(&*found);
  }
  return views;
}

bool shows(const OutputSettings& settings, DebugSource source) {
  const auto views = debug_views_of(settings);
  return std::ranges::find(views, source, &DebugView::source) != views.end();
}

std::string debug_path(const OutputSettings& settings, const DebugView& view) {
  const std::string& output = settings.output;
  return (output.ends_with(".exr") ? output.substr(0, output.size() - 4) : output) + "." + view.name + ".png";
}

DebugPlane debug(gpu::Recorder& gpu, const DebugView& view, const GBuffer& gbuffer, const DebugStages& stages,
                 const FrameInputs& frame) {
  using Source = DebugSource;
  const auto is_of = [&](std::initializer_list<Source> sources) {
    return std::ranges::find(sources, view.source) != sources.end();
  };
  const bool is_estimate =
      is_of({Source::raw_ao, Source::denoised_ao, Source::completed, Source::sites, Source::tiles});
  const GBuffer& shown = is_estimate ? stages.gbuffer : gbuffer;
  const Sites sites = is_of({Source::raw_ao, Source::completed, Source::sites}) ? stages.sites : Sites{};
  const uint hidden = view.source == Source::hidden ? gbuffer.surfaces - 1 : 0;
  const gpu::Buffer* values = gbuffer.normal;
  switch (view.source) {
    case Source::none:
    case Source::sites: break;
    case Source::raw_depth: values = frame[RawPlane::depth]; break;
    case Source::normals_from_depth: values = normals_from_depth(gpu, frame); break;
    case Source::raw_ao: values = stages.raw_ao; break;
    case Source::denoised_ao: values = stages.denoised_ao; break;
    case Source::completed: values = stages.completed; break;
    case Source::hidden: values = gbuffer.hidden ? gbuffer.hidden : values; break;
    case Source::count: values = stages.count ? stages.count : values; break;
    case Source::tiles: values = stages.kinds; break;
  }
  gpu::Buffer& result = gpu.buffer(std::string("debug ") + view.name, plane_bytes(shown.view));
  gpu.dispatch("debug",
               DebugParams{shown.view, sites.grid, view.kind, sites.words ? 1u : 0u, shown.grid.origin, hidden},
               {{"Depth", shown.depth},
                {"Normal", shown.normal},
                {"Values", values},
                {"Result", result},
                {"Blocks", gpu::Optional(sites.words)}},
               extent_of(shown.view));
  return {&view, shown.view.size, &result};
}

}  // namespace alcove
