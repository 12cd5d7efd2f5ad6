// Host side of the kernels that look at surfaces from two views.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/hidden/warp.h"

#include <algorithm>

#include "core/chain/base/pass_common.h"
#include "core/chain/geometry/margin.h"
#include "kernels/hidden/warp.h"

namespace alcove {
namespace {

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
