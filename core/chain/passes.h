// One short function a kernel: fill its parameters, take its output buffer, dispatch.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/debug_view.h"
#include "core/frame/camera.h"
#include "core/frame/depth.h"
#include "core/gpu/recorder.h"
#include "kernels/profile.h"

namespace alcove {

/// A frame's raw planes in upload buffers, and what they mean. Null: the frame has no such plane, or nobody asked for
/// it.
struct FrameInputs {
  View view{};
  ivec2 noise_origin{};  // px: the data window's corner, so that a crop has the noise of the whole
  int frame = 0;
  DepthMap depth_map;
  DepthPrecision depth_precision{};                               // of the planar depth that it gives
  NormalEncoding normal_encoding = NormalEncoding::signed_float;  // not automatic
  bool normal_unorm = false;                                      // the values are 0.5 + 0.5 n, of any encoding
  Matrix3 view_from_normal{};                                     // rotation from the normals' space, and flips
  gpu::Buffer* depth = nullptr;                                   // a plane; of positions x, y, z
  gpu::Buffer* normal = nullptr;                                  // planes x, y, z, or only the first two
  gpu::Buffer* beauty = nullptr;                                  // planes r, g, b, and a where has_alpha
  gpu::Buffer* indirect = nullptr;                                // planes r, g, b
  gpu::Buffer* diffuse_color = nullptr;                           // planes r, g, b
  gpu::Buffer* material_ao = nullptr;                             // a plane
  gpu::Buffer* albedo = nullptr;                                  // planes r, g, b; for multi-bounce
  double albedo_value = 0;                                        // where there are no planes of it
  Matrix3 aov_from_view{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // rotation to the space of the directions that are written
  bool has_alpha = false;
  bool is_sky = false;  // no pixel shows a surface, and none had to be repaired for that
  // of blocks against the frame before, whose estimate its buffers still hold: see classify.h; null: there is none
  const gpu::Buffer* changes = nullptr;
};

/// What every estimator relies on: see prepare.comp and reconstruct.comp.
struct GBuffer {
  View view{};
  gpu::Buffer* depth;
  gpu::Buffer* normal;
  gpu::Buffer* counts;   // one FrameCounts, for the host
  gpu::Buffer* missing;  // the GroupCount of reconstruct
};

/// The grid of blocks that the pixels of an estimate stand for: it begins at the display window's corner, so that a
/// crop has the blocks of the whole.
struct BlockGrid {
  int factor;      // px of a block in x and in y
  ivec2 origin;    // blocks from the display window's corner to the first one of the data window
  ivec2 overhang;  // px of that one outside of the data window
  ivec2 size;      // blocks
};
BlockGrid block_grid(const FrameInputs& frame, const EstimatorSettings& settings);

/// `depth_use`: Use::download where the host reads the depth. `prefix`: before the names of its buffers, where there is
/// another G-buffer already.
GBuffer prepare(gpu::Recorder& gpu, const FrameInputs& frame, gpu::Use depth_use = gpu::Use::device,
                const std::string& prefix = "");
/// What the chain leaves of a frame without surfaces: counts, TileCounts, a plane of 1, and one of each radius.
struct OpenSky {
  gpu::Buffer *counts, *tiles, *ao, *scales;
};
OpenSky open_sky(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings);
/// Puts normals where prepare found none.
void reconstruct(gpu::Recorder& gpu, const GBuffer& gbuffer);
/// The G-buffer of the settings' resolution: its pixels are the blocks of whole pixels of the display window.
GBuffer downsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                   const EstimatorSettings& settings);
/// All radii of the settings, from the smallest on; one of them must be set.
std::vector<double> radii_of(const EstimatorSettings& settings);
/// Whether slices are searched by profile and exact, and not by horizon.
bool searches_exactly(const EstimatorSettings& settings);
/// Whether the estimator finds open directions too.
bool has_bent_normals(const EstimatorSettings& settings);
/// Tiles of a G-buffer that an estimator has something to do for.
struct TileList {
  gpu::Buffer *tiles = nullptr, *counts = nullptr;  // ListedTile each; one TileCounts
  gpu::Buffer* sectors = nullptr;                   // of all tiles, from classify
  gpu::Buffer* lines = nullptr;                     // GroupCount of profile, from converge
};
/// What an estimator gives for every pixel of the G-buffer, or for those that the stride leaves.
struct Estimate {
  gpu::Buffer* ao;              // a plane of visibility a radius, from the smallest on
  gpu::Buffer* bent = nullptr;  // planes x, y, z, of the largest radius: see horizon.h; null: not asked for
  TileList listed{};            // of the largest radius
  gpu::Buffer *error = nullptr, *squares = nullptr;  // with a tolerance, of the largest radius: see converge.h
};
/// Whether tiles are proved to be open, or only sky is left out.
bool proves(const EstimatorSettings& settings);
/// Depth samples that the settings ask for at a pixel of a surface, on average.
double samples_per_pixel(const EstimatorSettings& settings);
/// What surfaces tiles show.
struct Bounds {
  // TileBounds a tile, GroupBounds a group of them; null: nothing is proved
  gpu::Buffer *tiles = nullptr, *groups = nullptr;
};
Bounds bounds(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings);
/// Puts the bounds of the groups.
void coarsen(gpu::Recorder& gpu, const GBuffer& gbuffer, const Bounds& bounds);
/// For settings.radius. What an estimate would be that is not made, it writes into a plane of `out`.
TileList classify(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const BlockGrid& grid,
                  const EstimatorSettings& settings, const Bounds& bounds, const Estimate& out, uint plane,
                  const std::string& prefix = "");
/// Of how many pixels in a row one has an estimate. Where the settings leave it open: 4 for the estimator that this was
/// measured with, gtao, at full resolution, with so few slices that the denoiser must share them among neighbours
/// anyway; else 1.
int stride_of(const EstimatorSettings& settings);
/// By the estimator of the settings, for each of their radii.
Estimate estimate(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                  const EstimatorSettings& settings, bool with_bent = false, const std::string& prefix = "");
/// These write one plane of `out`, for settings.radius, in its listed tiles.
void horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
             const Estimate& out, uint plane);
/// The depth along all lines of one direction: see profile.comp.
struct Profile {
  int direction;  // which one of all that the settings ask for
  Lines lines;
  gpu::Buffer *vertex, *mark, *neighbor;
};
/// `groups`: how many of its groups there are, from converge; null: all.
Profile profile(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
                int direction, const gpu::Buffer* groups = nullptr);
/// Adds a direction to the plane, which the last one completes.
void exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const Profile& profile, const FrameInputs& frame,
           const EstimatorSettings& settings, const Estimate& out, uint plane);
/// As many directions as settings.tolerance takes. Returns the tiles that have surfaces.
TileList converge(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                  const EstimatorSettings& settings, Estimate& all, uint plane);
void bitmask(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
             const Estimate& out, uint plane);
void hbao(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
          const Estimate& out, uint plane);
void crytek(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
            const Estimate& out, uint plane);
/// In [0, 1], of the largest radius, whatever the estimator: see confidence.comp.
gpu::Buffer& confidence(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                        const EstimatorSettings& settings);
/// The mean of the planes.
gpu::Buffer& combine(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& scales);
/// Runs or groups of pixels that a filter has work in; see dilate.comp.
struct RunList {
  gpu::Buffer *runs = nullptr, *counts = nullptr;  // null: all
};
struct FilterRuns {
  RunList rows, columns, blocks;  // of denoise, and of upsample
};
/// For the filters, whose results this writes wherever they have nothing to do. `gbuffer` is that of the estimate.
/// Nothing is listed where that would not pay.
FilterRuns dilate(gpu::Recorder& gpu, const GBuffer& gbuffer, const TileList& tiles, const FrameInputs& frame,
                  const EstimatorSettings& settings);
/// Both directions of the settings' filter, on any number of planes. `gbuffer` is that of `ao`. `prefix`: before the
/// names of its buffers, where others are filtered too. `runs`: from dilate, of the same visibility; else all.
gpu::Buffer& denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame,
                     const EstimatorSettings& settings, const std::string& prefix = "", const FilterRuns& runs = {});
/// From the pixels of `low` to those of `gbuffer`, any number of planes; `runs` as for denoise.
gpu::Buffer& upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, const gpu::Buffer& ao,
                      const FrameInputs& frame, const EstimatorSettings& settings, const std::string& prefix = "",
                      const FilterRuns& runs = {});
/// Planes of mean open directions as unit vectors, packed as the normals are.
gpu::Buffer& bent_normal(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& bent);
/// Whether the settings ask for any shaping.
bool shapes(const EstimatorSettings& settings);
/// Any number of planes. What it repairs is counted with the first `ao` of a frame, whose prefix is empty.
gpu::Buffer& shape(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame,
                   const EstimatorSettings& settings, const std::string& prefix = "");
/// `bent`: the mean open direction a pixel, packed as the normals are.
gpu::Buffer& specular_occlusion(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& bent,
                                const gpu::Buffer& ao, const EstimatorSettings& settings);
/// Visibility for each of red, green and blue.
gpu::Buffer& multi_bounce(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame);
/// The beauty's planes, for the host. `ao`: one plane, or three where output.multi_bounce.
gpu::Buffer& composite(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame,
                       const OutputSettings& output);
/// Packed directions as planes x, y, z of that name, for the host.
gpu::Buffer& directions(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& packed, const std::string& name,
                        const FrameInputs& frame);

/// A number a pixel for a debug view; kSkyDepth for sky.
struct DebugPlane {
  const DebugView* view;
  ivec2 size;  // px
  gpu::Buffer* values;
};
/// The visibility on its way, at the resolution of the estimate; null where there is none.
struct DebugStages {
  GBuffer gbuffer{};
  const gpu::Buffer *raw_ao = nullptr, *denoised_ao = nullptr;
  const gpu::Buffer* sectors = nullptr;  // of the tiles
};
DebugPlane debug(gpu::Recorder& gpu, const DebugView& view, const GBuffer& gbuffer, const DebugStages& stages,
                 const FrameInputs& frame, const EstimatorSettings& settings);

}  // namespace alcove
