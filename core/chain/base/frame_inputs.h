// What the chain starts from: a frame's raw planes in upload buffers, and their meaning in the terms of kernels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/chain/base/other_views.h"
#include "core/chain/base/seen_estimates.h"
#include "core/frame/raw_plane.h"
#include "core/frame/reading.h"
#include "core/gpu/recorder.h"
#include "kernels/geometry/geometry.h"

namespace alcove {

/// How kernels read a plane of depth behind the first surface.
struct LayerTerms {
  uint form;  // kDepth*
  BehindKind kind;
  DepthTerms depth;
};

/// Pixels around a frame.
struct Margin {
  ivec2 before{};  // to the left and above
  ivec2 after{};   // to the right and below
};

struct FrameInputs {
  /// The buffer of a plane, its components one behind the other; null: the frame has no such plane, or nobody asked for
  /// it.
  gpu::Buffer*& operator[](RawPlane plane) { return planes[plane]; }
  gpu::Buffer* operator[](RawPlane plane) const { return planes[plane]; }

  RawPlaneArray<gpu::Buffer*> planes;
  View view{};
  ivec2 noise_origin{};  // px: the data window's corner, so that a crop has the noise of the whole
  int frame = 0;
  DepthMap depth_map;
  DepthPrecision depth_precision{};     // of the planar depth that it gives
  DepthPrecision hidden_precision{};    // of the least precise of it and of what lies behind
  PrepareParams prepare{};              // the meaning of depth and normals, as prepare.comp takes it
  uint normal_form = kNormalNone;       // of kernels/geometry/geometry.h
  std::vector<LayerTerms> behind;       // of each plane of RawPlane::behind
  bool behind_lists_all = false;        // see list_all()
  std::vector<OtherView> others;        // in any order: what they see behind the first surface counts as hidden
  EstimateSet estimates;                // of which its AO is the mean
  int turn = 0;                         // of its sites, see site_rule_of()
  int supersampling = 1;                // px of the frame for each of its picture, in x and in y
  Margin margin{};                      // where others show what lies around the frame; see margin.h
  MatteReading matte;                   // how its planes are read
  MatteReading occluders;               // the same of RawPlane::occluders
  std::vector<AmbientReading> ambient;  // how those of RawPlane::indirect are read
  double albedo_value = 0;              // for multi-bounce where there are no planes of it
  Matrix3 aov_from_view{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // rotation to the space of the directions that are written
  bool is_sky = false;  // no pixel shows a surface, and none had to be repaired for that
  // how the blocks differ from the frame before, whose estimate the buffers still hold: see classify.comp; null: the
  // buffers hold none
  const gpu::Buffer* changes = nullptr;
};

/// Gives the terms of kernels for planes that are read so. The host must still see the depth.
FrameInputs inputs_of(const Reading& reading, const RawPlaneArray<gpu::Buffer*>& planes, int frame);

/// Records the upload of every plane, those of others too.
void upload(gpu::Recorder& gpu, const FrameInputs& frame);

}  // namespace alcove
