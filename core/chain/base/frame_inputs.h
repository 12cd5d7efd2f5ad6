// What the chain starts from: a frame's raw planes in upload buffers, and their meaning in the terms of kernels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/frame/find/environment.h"
#include "core/frame/raw_plane.h"
#include "core/frame/reading.h"
#include "core/gpu/recorder.h"
#include "kernels/geometry/geometry.h"
#include "kernels/time/accumulate.h"

namespace alcove {

/// What kernels share with the host, and know no comparison of, is compared by its bytes: it has no padding.
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

/// The meaning of another frame's planes, or of another view's of the same instant, and which planes they are.
struct OtherTerms {
  View view{};
  // its view space -> this frame's: x' = dot(row.xyz, x) + row.w, scene units
  std::array<std::array<float, 4>, 3> to_here{};
  vec3 depth_precision{};     // of planar depth: see DepthPrecision
  std::uint64_t content = 0;  // a hash of all three planes; 0: nobody has made it
  bool operator==(const OtherTerms&) const = default;
};

/// Its prepared depth and normals.
struct OtherView : OtherTerms {
  const gpu::Buffer* depth = nullptr;   // a plane: planar, kSkyDepth for sky
  const gpu::Buffer* normal = nullptr;  // a plane of packed normals, in its own view space
  // a plane of uints, not 0 where it shows what moves or may move; null: nothing does
  const gpu::Buffer* moving = nullptr;
  /// Whether the planes hold the same, in whichever buffers they lie.
  bool operator==(const OtherView& other) const { return content != 0 && OtherTerms::operator==(other); }
};

/// Other frames, in upload buffers.
struct SeenGroup {
  const gpu::Buffer* planes = nullptr;  // of all of them, as words
  const gpu::Buffer* frames = nullptr;  // TakenFrame each
  uint count = 0;
  // Entries of the table. Kernels are made for their number, so that it is the same where fewer frames count, at cuts
  // and beside missing ones: those beyond `count` repeat the first one and count nowhere.
  uint listed = 0;
};

/// The estimates that a frame takes the mean of.
struct EstimateSet {
  // Its own, over all of it, in upload buffers: planar depth as of a TakenFrame, normals as of a GBuffer, and values:
  // the visibility, then that of each radius where it is asked for, then the mean open direction where that is. Null:
  // it is its own estimate.
  const gpu::Buffer* depth = nullptr;
  const gpu::Buffer* normal = nullptr;
  const gpu::Buffer* values = nullptr;
  View view{};                    // of all of it
  bool has_moving = false;        // some frame has pixels that move by motion vectors
  std::vector<SeenGroup> groups;  // of the others
  ivec2 corner{};                 // px from the whole frame's corner to that of the part that is computed
  bool is_further_part = false;   // of the frame of the part before, by the same recorder: what has moved is known
};

/// All that decides a frame's results beside its own planes and the settings. As one value it is compared with that of
/// the frame before, so nothing that is added here can be forgotten there.
struct FrameRecipe {
  View view{};
  ivec2 noise_origin{};  // px: the data window's corner, so that a crop has the noise of the whole
  DepthMap depth_map;
  DepthPrecision depth_precision{};     // of the planar depth that it gives
  DepthPrecision hidden_precision{};    // of the least precise of it and of what lies behind
  PrepareParams prepare{};              // the meaning of depth and normals, as prepare.comp takes it
  uint normal_form = kNormalNone;       // of kernels/geometry/geometry.h
  std::vector<LayerTerms> behind;       // of each plane of RawPlane::behind
  bool behind_lists_all = false;        // see list_all()
  std::vector<OtherView> others;        // in any order: what they see behind the first surface counts as hidden
  int turn = 0;                         // of its sites, see site_rule_of()
  int supersampling = 1;                // px of the frame for each of its picture, in x and in y
  Margin margin{};                      // where others show what lies around the frame: see margin_of()
  MatteReading matte;                   // how its planes are read
  MatteReading occluders;               // the same of RawPlane::occluders
  std::vector<AmbientReading> ambient;  // how those of RawPlane::indirect are read
  double albedo_value = 0;              // for multi-bounce where there are no planes of it
  Matrix3 aov_from_view{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // rotation to the space of the directions that are written
  Environment environment;                                   // its light, for relighting; in world space:
  Matrix3 world_from_view{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  bool operator==(const FrameRecipe&) const = default;
};

struct FrameInputs : FrameRecipe {
  /// The buffer of a plane, its components one behind the other; null: the frame has no such plane, or nobody asked for
  /// it.
  gpu::Buffer*& operator[](RawPlane plane) { return planes[plane]; }
  gpu::Buffer* operator[](RawPlane plane) const { return planes[plane]; }

  RawPlaneArray<gpu::Buffer*> planes;
  int frame = 0;          // by which animated noise goes on
  EstimateSet estimates;  // of which its AO is the mean: such a frame has nothing of the one before
  bool is_sky = false;    // no pixel shows a surface, and none had to be repaired for that
  // how the blocks differ from the frame before, whose estimate the buffers still hold: see classify.comp; null: the
  // buffers hold none
  const gpu::Buffer* changes = nullptr;
};

/// Gives the terms of kernels for planes that are read so. The host must still see the depth.
FrameInputs inputs_of(const Reading& reading, const RawPlaneArray<gpu::Buffer*>& planes, int frame);

}  // namespace alcove
