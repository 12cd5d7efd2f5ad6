// The results of the chain: buffers that the host reads after the recorder has run, ONE table of the AOVs among them,
// and the wanted outputs of a run.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/chain/base/planes.h"
#include "core/chain/results/debug.h"
#include "core/frame/camera/camera.h"
#include "core/frame/find/lights.h"

namespace alcove {

/// A frame's own estimate for the mean of others: buffers that the host reads after the recorder has run.
struct OwnEstimate {
  GBuffer gbuffer;
  Visibility visibility;  // of all its pixels, before any shaping
};

/// Null: not asked for.
struct FrameOutputs {
  gpu::Buffer* counts = nullptr;        // one FrameCounts
  gpu::Buffer* layer_counts = nullptr;  // one LayerCounts, with known hidden surfaces
  gpu::Buffer* view_counts = nullptr;   // one ViewCounts, with hidden surfaces from others
  gpu::Buffer* tiles = nullptr;         // one TileCounts, with an estimate
  gpu::Buffer* sites = nullptr;         // one SiteCounts, of the largest radius, if pixels share estimates
  gpu::Buffer* squares = nullptr;       // with a tolerance, vec2 per tile: sum of its squares, and receivers
  // with wanted.completed, vec2 per tile: the visibility that completed surfaces block, and that all block
  gpu::Buffer* completion = nullptr;
  // with wanted.completed, a plane of the estimate's size: see Estimate. It stays on the device: call download() to
  // read it
  gpu::Buffer* completed = nullptr;
  gpu::Buffer* ao = nullptr;            // a plane: visibility in [0, 1]; of several radii the mean
  gpu::Buffer* scales = nullptr;        // a plane for each radius, from the smallest on
  gpu::Buffer* normal = nullptr;        // planes x, y, z; 0 for sky
  gpu::Buffer* bent_normal = nullptr;   // planes x, y, z; 0 for sky
  gpu::Buffer* transfer = nullptr;      // planes T_00, T_1-1 ... T_22; 0 for sky: see transfer.comp
  gpu::Buffer* relight = nullptr;       // planes r, g, b, of an environment; 0 for sky
  gpu::Buffer* relight_open = nullptr;  // the same without occlusion
  gpu::Buffer* depth = nullptr;         // a plane: planar, scene units; kSkyDepth for sky
  // for each surface that is kept behind the first, nearer first, a plane of planar depth, kSkyDepth for none; and a
  // plane of 1 where it closes the solid of the one before it, else 0
  gpu::Buffer* hidden = nullptr;
  gpu::Buffer* confidence = nullptr;  // a plane, in [0, 1]
  // a plane for each light, in [0, 1], 1 = lit; sky: 1. With confidence one more for each, of that in it
  gpu::Buffer* shadow = nullptr;
  gpu::Buffer* error = nullptr;               // a plane: with a tolerance, the estimated error of the visibility
  gpu::Buffer* specular_occlusion = nullptr;  // a plane, in [0, 1], 1 = open
  // a plane, of several radii their mean and one for each: the parts that the own surface blocks inside and outside, in
  // [0, 1], and their difference, 0.5 = flat
  gpu::Buffer* convexity = nullptr;
  gpu::Buffer* cavity = nullptr;
  gpu::Buffer* curvature = nullptr;
  gpu::Buffer* color_ao = nullptr;   // planes r, g, b: the visibility with multi-bounce
  gpu::Buffer* composite = nullptr;  // the beauty's planes
  gpu::Buffer* count = nullptr;      // a plane and more: the number of averaged estimates; null: not averaged
  bool is_quick = false;             // its visibility is of the quick search
  std::optional<OwnEstimate> own{};  // with wanted.only_own: then there is nothing else
  std::vector<DebugPlane> debug{};
};

/// The input of an AOV; each needs the ones before it, too.
enum class AovSource { geometry, visibility, open_directions, transfer };

/// A row of the table.
struct AovRow {
  const char* name;                    // as --aov takes it
  const char* channels;                // in the file, with commas; one for each plane, or all from the only plane
  gpu::Buffer* FrameOutputs::*planes;  // where the chain leaves them
  AovSource source;
  bool is_float = false;  // for any --type: half is too coarse
};

inline constexpr std::array kAovs{
    AovRow{"ao", "Y", &FrameOutputs::ao, AovSource::visibility},
    AovRow{"ao-scales", "scale1.Y", &FrameOutputs::scales, AovSource::visibility},
    AovRow{"normal", "normal.X,normal.Y,normal.Z", &FrameOutputs::normal, AovSource::geometry},
    AovRow{"bent-normal", "bent.X,bent.Y,bent.Z", &FrameOutputs::bent_normal, AovSource::open_directions},
    AovRow{
        "transfer",
        "transfer0.X,transfer0.Y,transfer0.Z,transfer1.X,transfer1.Y,transfer1.Z,transfer2.X,transfer2.Y,transfer2.Z",
        &FrameOutputs::transfer, AovSource::transfer},
    AovRow{"relight", "relight.R,relight.G,relight.B", &FrameOutputs::relight, AovSource::transfer},
    AovRow{"relight-open", "relight-open.R,relight-open.G,relight-open.B", &FrameOutputs::relight_open,
           AovSource::geometry},
    AovRow{"depth", "Z", &FrameOutputs::depth, AovSource::geometry, true},
    AovRow{"hidden", "hidden1.Z,hidden1.back", &FrameOutputs::hidden, AovSource::geometry, true},
    AovRow{"confidence", "confidence.Y", &FrameOutputs::confidence, AovSource::visibility},
    AovRow{"shadow", "", &FrameOutputs::shadow, AovSource::geometry},
    AovRow{"error", "error.Y", &FrameOutputs::error, AovSource::visibility},
    AovRow{"specular-occlusion", "specular.Y", &FrameOutputs::specular_occlusion, AovSource::open_directions},
    AovRow{"convexity", "convexity.Y", &FrameOutputs::convexity, AovSource::visibility},
    AovRow{"cavity", "cavity.Y", &FrameOutputs::cavity, AovSource::visibility},
    AovRow{"curvature", "curvature.Y", &FrameOutputs::curvature, AovSource::visibility},
};

/// An AOV that a run asks for: a row of kAovs, with the channels and planes that the other outputs' settings give it.
struct Aov {
  std::string name;
  std::vector<std::string> channels;
  gpu::Buffer* FrameOutputs::*planes;
  AovSource source;
  bool is_float;
};
std::vector<std::string> aov_names();

/// The AOVs that the settings ask for, each once, in their order. Fails with ErrorKind::usage on a name that is not in
/// the table, listing the names that are.
std::vector<Aov> aovs_of(const OutputSettings& settings);

/// The number of an AOV's planes: of ao-scales one for each radius, of hidden two for each surface that is kept.
std::size_t planes_of(const Aov& aov, const EstimatorSettings& settings);
/// The channels of an AOV that has so many planes: scale1.Y of the smallest radius, hidden1.Z of the nearest surface.
std::vector<std::string> channels_of(const Aov& aov, std::size_t planes);

/// Fails with ErrorKind::usage where two planes of the output would have the same channel.
void require_distinct_channels(const Settings& settings);

/// Whether it is made of the receiver's own surface: convexity, cavity or curvature.
bool is_of_curvature(const Aov& aov);

/// Whether an AOV that the settings ask for lies in these planes.
bool wants(const OutputSettings& settings, gpu::Buffer* FrameOutputs::*planes);

/// The wanted outputs of the chain: their names, parsed once. Settings convert to it implicitly.
struct Wanted {
  /// Fails with ErrorKind::usage on names that are in no table.
  Wanted(const OutputSettings& settings);
  Wanted() : Wanted(OutputSettings{}) {}

  /// Whether an AOV lies in these planes.
  bool has(gpu::Buffer* FrameOutputs::*planes) const;
  /// Whether the AO of single radii is asked for.
  bool needs_scales() const { return has(&FrameOutputs::scales) || order > 1; }
  /// Whether an AOV of the own surface's shape is asked for.
  bool needs_curvature() const { return std::ranges::any_of(aovs, &is_of_curvature); }
  /// Whether only AO from depth and normals alone is asked for.
  bool is_only_visibility() const;

  std::vector<Aov> aovs;
  std::vector<const DebugView*> debug_views;
  bool visibility = false;       // AO, or an output made from it
  uint order = 0;                // of the moments for other outputs, of an estimator that finds open directions
  bool completed = false;        // the visibility that completed surfaces block
  bool only_own = false;         // the estimate alone, for other frames
  bool previews_shadow = false;  // of the turned sun or the first light, where there is no AO to be seen
  bool multi_bounce = false;
  std::vector<Light> lights;  // suns in place of the AOV shadow's lights when a frame is rehearsed; soft as they
  PixelFilter filter;
  CompositeLook look;
};

/// Whether the directions that are given to the host are in world space.
bool in_world(const Camera& camera, const OutputSettings& settings);

/// Whether any output is AO or made from it.
bool needs_ao(const OutputSettings& output);
/// Whether any output depends on the radius: AO, and shadows, since it limits the thickness of surfaces.
bool needs_radius(const OutputSettings& output);

/// The order of the moments that any output is made from: 1 for bent normals, 2 for transfer; 0: none, or the estimator
/// finds no open directions.
uint moment_order(const EstimatorSettings& settings, const Wanted& wanted);

/// Whether the frame is nothing but sky, and nothing but its visibility is wanted: then no kernel need run.
bool is_open_sky(const FrameInputs& frame, const EstimatorSettings& settings, const Wanted& wanted);
/// The counts of such a frame, and a visibility of 1, as kernels would give them.
FrameOutputs open_sky(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings);

}  // namespace alcove
