// The passes that make the G-buffer, which every later pass relies on, and those that put a margin around it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/chain/base/frame_inputs.h"
#include "core/chain/base/planes.h"

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

/// Makes the G-buffer from the raw planes. `prefix` stands before the names of its buffers where there is another
/// G-buffer already.
GBuffer prepare(gpu::Recorder& gpu, const FrameInputs& frame, const std::string& prefix = "");

/// Puts normals where prepare found none, has all face the eye, and returns the same G-buffer.
GBuffer reconstruct(gpu::Recorder& gpu, const GBuffer& gbuffer);

/// Makes the G-buffer of the blocks of a grid, or returns the same one where each block is a pixel. `prefix`: as above.
GBuffer downsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const BlockGrid& grid, const std::string& prefix = "");

// The margin shows what lies around the picture, as other frames and other views see it: receivers at the border need
// it.

/// The margin of a part of a frame, or of the whole: on each side on which it ends with the frame an eighth of the
/// frame's width, for which other views of it usually have something to show. It does not depend on how a frame is cut.
Margin margin_of(const Window& part, const Window& frame);

/// The frame as it is with its margin; the same one where it has none. Its planes stay those of the frame.
FrameInputs with_margin(const FrameInputs& frame);

/// The G-buffer with an empty margin: all that others show there is behind it.
GBuffer widen(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& wide);
/// Fills the margin of `wide` with the nearest surfaces that others show there, the first plane of `found`, and gives
/// it normals. Those of the frame are there already: at its border the margin must not change them.
void widen(gpu::Recorder& gpu, const GBuffer& prepared, const GBuffer& wide, const FrameInputs& frame,
           const gpu::Buffer& found);

/// Cuts the margin off planes, or returns the same ones where there is none; null stays null.
gpu::Buffer* cut(gpu::Recorder& gpu, const FrameInputs& frame, gpu::Buffer* planes, const std::string& name);
Visibility cut(gpu::Recorder& gpu, const FrameInputs& frame, const Visibility& wide);
/// The same for a G-buffer whose first surface `prepared` has.
GBuffer cut(gpu::Recorder& gpu, const FrameInputs& frame, const GBuffer& wide, const GBuffer& prepared);

}  // namespace alcove
