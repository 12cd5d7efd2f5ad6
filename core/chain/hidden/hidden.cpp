// Host side of the kernels that bring in what lies behind the first surface.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/hidden/hidden.h"

#include <algorithm>

#include "kernels/hidden/hidden.h"

namespace alcove {
namespace {

uint kind_of(BehindKind kind) {
  switch (kind) {
    case BehindKind::surfaces:
    case BehindKind::fronts: break;
    case BehindKind::backs: return kBehindBacks;
    case BehindKind::thickness: return kBehindThickness;
  }
  return kBehindSurfaces;
}

/// The planes that hold surfaces of unknown kind, a bit each.
uint open_planes(const FrameInputs& frame) {
  uint planes = 0;
  for (std::size_t i = 0; i < frame.behind.size(); i++)
    planes |= frame.behind[i].kind == BehindKind::surfaces ? 1u << i : 0u;
  return planes;
}

vec3 operator+(const vec3& a, const vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

Reprojection reprojection(const OtherView& from, const View& to, const vec3& precision, double separation) {
  const auto& rows = from.to_here;
  const auto row = [&](int i) { return vec3{rows[i][0], rows[i][1], rows[i][2]}; };
  return {from.view,
          to,
          row(0),
          row(1),
          row(2),
          {rows[0][3], rows[1][3], rows[2][3]},
          from.depth_precision + precision,
          float(separation)};
}

/// The view as seen from `from`, whose to_here leads to it: both spaces have the same unit.
OtherView turned_back(const OtherView& view, const OtherView& from) {
  OtherView back = view;
  for (int i = 0; i < 3; i++) {
    double offset = 0;
    for (int j = 0; j < 3; j++) {
      back.to_here[i][j] = from.to_here[j][i];
      offset -= double(from.to_here[j][i]) * double(from.to_here[j][3]);
    }
    back.to_here[i][3] = float(offset);
  }
  return back;
}

}  // namespace

gpu::Buffer& behind(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame) {
  gpu::Buffer& found = gpu.buffer("found behind", frame.behind.size() * plane_bytes(frame.view));
  for (uint plane = 0; plane < frame.behind.size(); plane++) {
    const LayerTerms& terms = frame.behind[plane];
    gpu.dispatch("behind", BehindParams{frame.view, terms.depth, plane},
                 {{"Raw", frame[RawPlane::behind]}, {"Depth", prepared.depth}, {"Found", found}}, extent_of(frame.view),
                 {terms.form, kind_of(terms.kind)});
  }
  return found;
}

gpu::Buffer& ends(gpu::Recorder& gpu, const GBuffer& layered) {
  gpu::Buffer& result = gpu.buffer("surface ends", 2 * plane_bytes(layered.view));
  for (const uint along_columns : {0u, 1u}) {
    const ivec2 size = layered.view.size;
    gpu.dispatch("ends", EndsParams{layered.view, along_columns},
                 {{"Depth", layered.depth}, {"Hidden", layered.hidden}, {"Result", result}},
                 {uint(along_columns ? size.x : size.y)}, {layered.surfaces - 1});
  }
  return result;
}

void pair(gpu::Recorder& gpu, const GBuffer& layered, const gpu::Buffer& open, const gpu::Buffer& ends) {
  gpu.dispatch("pair", PairParams{layered.view},
               {{"Depth", layered.depth}, {"Hidden", layered.hidden}, {"Open", open}, {"Ends", ends}},
               extent_of(layered.view), {layered.surfaces - 1});
}

Layering layering_of(const EstimatorSettings& settings) { return {settings.hidden, settings.separation.value_or(-1)}; }

/// Up to so many planes have a kernel for their number. More come from deep frames, whose numbers differ.
constexpr uint kFewPlanes = 4;

GBuffer layers(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame, const Layering& layering) {
  const gpu::Buffer* warped = prepared.warped;
  if ((frame.behind.empty() && !warped) || layering.kept == 0) return prepared;
  const gpu::Buffer* found = frame.behind.empty() ? nullptr : &behind(gpu, prepared, frame);
  GBuffer gbuffer = prepared;
  // A pixel cannot hide more than was found of it.
  const uint planes = found ? planes_in(*found, prepared.view) : 0;
  const uint warped_planes = warped ? planes_in(*warped, prepared.view) : 0;
  const uint kept = std::min(uint(layering.kept), planes + warped_planes);
  gbuffer.surfaces = 1 + kept;
  gbuffer.hidden = &gpu.buffer("hidden", kept * plane_bytes(prepared.view));
  gbuffer.hides_no_more = !warped && frame.behind_lists_all;
  gbuffer.layer_counts = &gpu.buffer("layer counts", sizeof(LayerCounts));
  gpu.clear(*gbuffer.layer_counts);
  const gpu::Buffer& open = gpu.buffer("open surfaces", plane_bytes(prepared.view));
  const LayersParams params{prepared.view, planes, open_planes(frame), to_vec3(frame.hidden_precision.at),
                            float(layering.separation)};
  gpu.dispatch("layers", params,
               {{"Found", gpu::Optional(found)},
                {"Depth", prepared.depth},
                {"Hidden", gbuffer.hidden},
                {"Counts", gbuffer.layer_counts},
                {"Warped", gpu::Optional(warped)},
                {"Open", open}},
               extent_of(prepared.view), {kept, planes <= kFewPlanes ? planes : 0, warped_planes});
  if (params.open_planes == 0) return gbuffer;
  const gpu::Buffer& ended = ends(gpu, gbuffer);
  pair(gpu, gbuffer, open, ended);
  return gbuffer;
}

gpu::Buffer& hidden_planes(gpu::Recorder& gpu, const GBuffer& gbuffer, const Layering& layering) {
  const auto kept = uint(layering.kept);
  gpu::Buffer& planes = gpu.buffer("hidden planes", 2 * kept * plane_bytes(gbuffer.view));
  gpu.dispatch("hidden_planes", HiddenPlanesParams{gbuffer.view, gbuffer.surfaces - 1, kept},
               {{"Hidden", gpu::Optional(gbuffer.hidden)}, {"Planes", planes}}, extent_of(gbuffer.view));
  return planes;
}

void still(gpu::Recorder& gpu, const OtherView& view, const OtherView& witness, const gpu::Buffer& flags) {
  const StillParams params{reprojection(turned_back(view, witness), witness.view, witness.depth_precision, -1)};
  gpu.dispatch("still", params,
               {{"Depth", view.depth}, {"Normal", view.normal}, {"WitnessDepth", witness.depth}, {"Flags", flags}},
               extent_of(view.view));
}

void surfels(gpu::Recorder& gpu, const OtherView& view, std::span<const OtherView> witnesses,
             const gpu::Buffer& moving) {
  const gpu::Buffer& flags = gpu.buffer("still flags", plane_bytes(view.view));
  gpu.clear(flags);
  for (const auto& witness : witnesses) still(gpu, view, witness, flags);
  gpu.dispatch("surfels", SurfelsParams{view.view, view.depth_precision},
               {{"Depth", view.depth}, {"Normal", view.normal}, {"Flags", flags}, {"Use", moving}},
               extent_of(view.view), {witnesses.empty() ? 0u : 1u});
}

GBuffer warp(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame, const Layering& layering) {
  GBuffer wide = widen(gpu, prepared, frame);
  // A margin needs the nearest ones even where nothing hidden is to be kept.
  const uint rounds = std::max(uint(layering.kept), wide.depth == prepared.depth ? 0u : 1u);
  if (frame.others.empty() || rounds == 0) return prepared;
  wide.warped = &gpu.buffer("found by others", rounds * plane_bytes(wide.view));
  wide.view_counts = &gpu.buffer("view counts", sizeof(ViewCounts));
  gpu.clear(*wide.warped);
  gpu.clear(*wide.view_counts);
  for (uint round = 0; round < rounds; round++) {
    for (const auto& other : frame.others) {
      const gpu::Buffer* use = other.moving;
      if (!use) {
        use = &gpu.buffer("surfels", plane_bytes(other.view));
        surfels(gpu, other, {}, *use);
      }
      const WarpParams params{reprojection(other, wide.view, wide.depth_precision, layering.separation), round};
      gpu.dispatch("warp", params,
                   {{"Depth", other.depth},
                    {"Normal", other.normal},
                    {"Use", use},
                    {"First", wide.depth},
                    {"Found", wide.warped},
                    {"Counts", wide.view_counts}},
                   extent_of(other.view));
    }
  }
  widen(gpu, prepared, wide, frame, *wide.warped);
  return wide;
}

}  // namespace alcove
