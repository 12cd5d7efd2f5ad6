// The passes that make the G-buffer, on which every later pass relies, the margin around it, and mattes.
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
  // Surfaces behind that of `depth`, nearer first, a plane each: planar depth > 0, kSkyDepth for none, and the negated
  // depth if the surface closes the solid of the one before it. Sky has none. Null: no hidden surfaces in the frame.
  gpu::Buffer* hidden = nullptr;
  uint surfaces = 1;                    // of a pixel at most: 1 more than `hidden` has planes
  bool hides_no_more = false;           // a pixel with fewer has no unknown surfaces
  gpu::Buffer* layer_counts = nullptr;  // one LayerCounts; null as `hidden`
  gpu::Buffer* warped = nullptr;        // hidden surfaces by other views: see warp.comp; null: none
  gpu::Buffer* view_counts = nullptr;   // one ViewCounts; null as `warped`
  // As `depth` and `hidden`, with occluders alone: see occluders.comp; null: all are, see occluder_depth_of().
  gpu::Buffer* occluder_depth = nullptr;
  gpu::Buffer* occluder_hidden = nullptr;
  gpu::Buffer* needed = nullptr;   // one uint per tile: whether its estimates are needed; null: all are
  gpu::Buffer* counts = nullptr;   // one FrameCounts, for the host
  gpu::Buffer* missing = nullptr;  // the GroupCount of reconstruct
};

/// The depth of the first surfaces that may block, and the planes of the surfaces behind them; null: there are none.
const gpu::Buffer& occluder_depth_of(const GBuffer& gbuffer);
const gpu::Buffer* occluder_hidden_of(const GBuffer& gbuffer);

/// Makes the G-buffer from the raw planes. `prefix` stands before the names of its buffers if there is another
/// G-buffer.
GBuffer prepare(gpu::Recorder& gpu, const FrameInputs& frame, const std::string& prefix = "");

/// Adds missing normals, turns all towards the eye, and returns the same G-buffer.
GBuffer reconstruct(gpu::Recorder& gpu, const GBuffer& gbuffer);

/// Makes the G-buffer of the blocks of a grid, or returns the same one if each block is a pixel. `prefix`: as above.
GBuffer downsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const BlockGrid& grid, const std::string& prefix = "");

// The margin around the picture has the surfaces that other frames and views show there, for receivers at the border.

/// The margin of a part of a frame, or of the whole: an eighth of the frame's width on each side that is a side of the
/// frame, which other views usually cover. Thus it does not depend on the cut into parts.
Margin margin_of(const Window& part, const Window& frame);

/// The frame with its margin, or the same frame if it has none. Its planes do not change.
FrameInputs with_margin(const FrameInputs& frame);

/// The G-buffer with an empty margin, in front of the surfaces that others show there.
GBuffer widen(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& wide);
/// Fills the margin of `wide` with the nearest surfaces that others show there, the first plane of `found`, and with
/// their normals. The frame's normals are there already, so the margin does not change them at the border.
void widen(gpu::Recorder& gpu, const GBuffer& prepared, const GBuffer& wide, const FrameInputs& frame,
           const gpu::Buffer& found);

/// Cuts the margin off planes, or returns the same ones without a margin; null stays null.
gpu::Buffer* cut(gpu::Recorder& gpu, const FrameInputs& frame, gpu::Buffer* planes, const std::string& name);
Visibility cut(gpu::Recorder& gpu, const FrameInputs& frame, const Visibility& wide);
/// The same for a G-buffer whose first surface `prepared` has.
GBuffer cut(gpu::Recorder& gpu, const FrameInputs& frame, const GBuffer& wide, const GBuffer& prepared);

// Mattes: the pixels that want AO, and the surfaces that may block.

/// The part of each pixel that wants AO.
struct Matte {
  gpu::Buffer* plane = nullptr;  // coverage, 0 to 1, over the frame; null: all want it
  double outside = 1;            // the AO where it is 0
};

/// A matte, or that of RawPlane::occluders, as one plane of coverage over the frame; none if the frame has none.
Matte matte(gpu::Recorder& gpu, const FrameInputs& frame, RawPlane which = RawPlane::matte);

/// The G-buffer with the tiles whose estimates are needed; the same one without a matte. Filters look up to `reach` px
/// of the frame beyond the matte. `wide`: the frame with its margin, see with_margin().
GBuffer needed(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& wide, const Matte& matte, int reach);

/// The stand-in for the unknown surfaces behind one that does not block.
enum class Unknown {
  open,     // nothing
  blocked,  // the surface in front of them, which blocks the most
};

/// The G-buffer with its occluders, if the frame has surfaces that do not block; else the same one. Receivers stay as
/// they are.
GBuffer occluders(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                  Unknown unknown = Unknown::open);

}  // namespace alcove
