// The passes that make the G-buffer: what every later pass relies on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/chain/base/frame_inputs.h"

namespace alcove {

/// Blocks of whole pixels of the display window. They begin at its corner, so that a crop has the blocks of the whole;
/// of 1 x 1 pixel at full resolution.
struct BlockGrid {
  int factor = 1;      // px of a block in x and in y
  ivec2 origin{};      // blocks from the display window's corner to the first one of the data window
  ivec2 overhang{};    // px of that one outside of the data window
  ivec2 size{};        // blocks
  ivec2 frame_size{};  // px of the data window
};
BlockGrid block_grid(const FrameInputs& frame, int factor);

/// A part of an image, in its pixels: up to `to`, exclusive.
struct ImagePart {
  ivec2 from, to;
};
/// The part of an image of these blocks that shows the frame without its margin, and so many px around it.
ImagePart without_margin(const FrameInputs& frame, const BlockGrid& grid, int around);

/// Depth and normals, one value per block of the grid: see prepare.comp and reconstruct.comp.
struct GBuffer {
  View view{};
  BlockGrid grid;
  vec3 depth_precision{};  // of planar depth: see DepthPrecision
  gpu::Buffer* depth = nullptr;
  gpu::Buffer* normal = nullptr;
  // Surfaces behind that of `depth`, nearer first, a plane behind the other: planar depth > 0, kSkyDepth where there is
  // none, and below 0, of the same size, where the surface closes the solid of the one before it. Sky has none. Null:
  // there is nothing hidden in the frame.
  gpu::Buffer* hidden = nullptr;
  uint surfaces = 1;                    // of a pixel at most: 1 more than `hidden` has planes
  bool hides_no_more = false;           // a pixel with fewer hides no surface that is not told
  gpu::Buffer* layer_counts = nullptr;  // one LayerCounts; null as `hidden`
  gpu::Buffer* warped = nullptr;        // what other views show behind the first surface: see warp.comp; null: nothing
  gpu::Buffer* view_counts = nullptr;   // one ViewCounts; null as `warped`
  // As `depth` and `hidden`, without what is no occluder: see occluders.comp; null: all are, see occluder_depth_of().
  gpu::Buffer* occluder_depth = nullptr;
  gpu::Buffer* occluder_hidden = nullptr;
  gpu::Buffer* needed = nullptr;   // one uint per tile: whether its estimates are needed; null: all are
  gpu::Buffer* counts = nullptr;   // one FrameCounts, for the host
  gpu::Buffer* missing = nullptr;  // the GroupCount of reconstruct
};

/// The depth of the first surfaces that may block, and the planes of those behind them; null: there are none.
const gpu::Buffer& occluder_depth_of(const GBuffer& gbuffer);
const gpu::Buffer* occluder_hidden_of(const GBuffer& gbuffer);

/// How much of each pixel wants AO.
struct Matte {
  gpu::Buffer* plane = nullptr;  // coverage, 0 to 1, over the frame; null: all want it
  double outside = 1;            // the AO where it is 0
};

/// Makes the G-buffer from the raw planes. `prefix` stands before the names of its buffers where there is another
/// G-buffer already.
GBuffer prepare(gpu::Recorder& gpu, const FrameInputs& frame, const std::string& prefix = "");

/// Puts normals where prepare found none, has all face the eye, and returns the same G-buffer.
GBuffer reconstruct(gpu::Recorder& gpu, const GBuffer& gbuffer);

/// Makes the G-buffer of the blocks of a grid, or returns the same one where each block is a pixel. `prefix`: as above.
GBuffer downsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const BlockGrid& grid, const std::string& prefix = "");

}  // namespace alcove
