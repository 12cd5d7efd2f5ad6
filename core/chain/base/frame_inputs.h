// The chain's input: a frame's raw planes in upload buffers, and their meaning in the terms of kernels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/frame/find/lights.h"
#include "core/frame/raw_plane.h"
#include "core/frame/reading.h"
#include "core/gpu/recorder.h"
#include "kernels/geometry/geometry.h"
#include "kernels/time/accumulate.h"

namespace alcove {

/// Structs shared with kernels have no padding and are compared by their bytes.
template <class T>
requires std::same_as<T, View> || std::same_as<T, vec3> || std::same_as<T, ivec2> || std::same_as<T, DepthTerms> ||
    std::same_as<T, PrepareParams>
bool operator==(const T& a, const T& b) { return std::memcmp(&a, &b, sizeof(T)) == 0; }

/// The terms by which kernels read a plane of depth behind the first surface.
struct LayerTerms {
  uint form;  // kDepth*
  BehindKind kind;
  DepthTerms depth;
  bool operator==(const LayerTerms&) const = default;
};

/// Pixels around a frame.
struct Margin {
  ivec2 before{};  // to the left and above
  ivec2 after{};   // to the right and below
  bool operator==(const Margin&) const = default;
};

/// The meaning and the identity of the planes of another frame, or of another view of the same instant.
struct OtherTerms {
  View view{};
  // its view space -> this frame's: x' = dot(row.xyz, x) + row.w, scene units
  std::array<std::array<float, 4>, 3> to_here{};
  vec3 depth_precision{};     // of planar depth: see DepthPrecision
  std::uint64_t content = 0;  // a hash of all three planes; 0: none
  bool operator==(const OtherTerms&) const = default;
};

/// Another view with its prepared depth and normals.
struct OtherView : OtherTerms {
  const gpu::Buffer* depth = nullptr;   // a plane: planar, kSkyDepth for sky
  const gpu::Buffer* normal = nullptr;  // a plane of packed normals, in its own view space
  // a plane of uints, not 0 at pixels that move or may move; null: none do
  const gpu::Buffer* moving = nullptr;
  /// Whether the planes have equal contents, in any buffers.
  bool operator==(const OtherView& other) const { return content != 0 && OtherTerms::operator==(other); }
};

/// Other frames, in upload buffers.
struct SeenGroup {
  const gpu::Buffer* planes = nullptr;  // of all of them, as words
  const gpu::Buffer* frames = nullptr;  // NeighbourFrame each
  uint count = 0;
  // Entries of the table. Kernels are compiled for this number, so it stays the same at cuts and beside missing frames:
  // entries beyond `count` repeat the first one and are ignored.
  uint listed = 0;
};

/// The estimates whose mean is the AO of a frame.
struct EstimateSet {
  // The frame's own estimate, over all of it, in upload buffers: planar depth as in a NeighbourFrame, normals as in a
  // GBuffer, and values: the visibility, then, if asked for, that of each radius and the mean open direction. Null: the
  // frame is not averaged.
  const gpu::Buffer* depth = nullptr;
  const gpu::Buffer* normal = nullptr;
  const gpu::Buffer* values = nullptr;
  View view{};                    // of all of it
  bool has_moving = false;        // some frame has pixels that move by motion vectors
  std::vector<SeenGroup> groups;  // of the others
  ivec2 corner{};                 // px from the frame's corner to that of the computed part
  bool is_further_part = false;   // a part of the same frame as the one before: movement is known
};

/// Everything that decides a frame's results beside its own planes and the settings. It is compared with that of the
/// frame before as one value, so a new member cannot be forgotten.
struct FrameRecipe {
  View view{};
  ivec2 noise_origin{};  // px: the data window's corner, so that a crop has the noise of the whole
  DepthMap depth_map;
  DepthPrecision depth_precision{};     // of the planar depth
  DepthPrecision hidden_precision{};    // of the least precise of it and of the depths behind
  PrepareParams prepare{};              // the meaning of depth and normals, as prepare.comp takes it
  uint normal_form = kNormalNone;       // of kernels/geometry/geometry.h
  std::vector<LayerTerms> behind;       // of each plane of RawPlane::behind
  bool behind_lists_all = false;        // see list_all()
  std::vector<OtherView> others;        // in any order: they show hidden surfaces
  int turn = 0;                         // of its sites, see site_rule_of()
  int supersampling = 1;                // px of the frame for each of its picture, in x and in y
  Margin margin{};                      // around the frame, filled from others: see margin_of()
  MatteReading matte;                   // how its planes are read
  MatteReading occluders;               // the same of RawPlane::occluders
  std::vector<AmbientReading> ambient;  // the reading of RawPlane::indirect
  double albedo_value = 0;              // for multi-bounce without planes of it
  Matrix3 aov_from_view{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // rotation to the space of the directions that are written
  std::vector<Light> lights;                                 // in view space
  Environment environment;                                   // its light, for relighting; in world space:
  Matrix3 world_from_view{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  bool operator==(const FrameRecipe&) const = default;
};

struct FrameInputs : FrameRecipe {
  /// The buffer of a plane, its components one behind the other; null: the frame has no such plane, or it is not
  /// needed.
  gpu::Buffer*& operator[](RawPlane plane) { return planes[plane]; }
  gpu::Buffer* operator[](RawPlane plane) const { return planes[plane]; }

  RawPlaneArray<gpu::Buffer*> planes;
  int frame = 0;          // for animated noise
  EstimateSet estimates;  // for the mean of frames; such a frame reuses nothing of the one before
  bool is_sky = false;    // no pixel shows a surface, and none was repaired
  // the blocks' differences from the frame before, whose estimate is still in the buffers: see classify.comp; null: the
  // buffers have none
  const gpu::Buffer* changes = nullptr;
};

/// Gives the kernels' terms for planes with this reading. The depth must be visible to the host.
FrameInputs inputs_of(const Reading& reading, const RawPlaneArray<gpu::Buffer*>& planes, int frame);

}  // namespace alcove
