// Types that mean the same in C++ and in GLSL, so that a kernel's parameters are written once.
// SPDX-License-Identifier: BSD-3-Clause
//
// The headers of the folders beside it declare with these names the parameters of kernels. A kernel and its host
// function, in the folder of the same name in core/chain, both include one. Layout is scalar: every member is aligned
// to 4 bytes, in C++ as in GLSL.
#ifndef ALCOVE_SHARED_H
#define ALCOVE_SHARED_H

#ifdef __cplusplus

#include <cstdint>

namespace alcove {
using uint = std::uint32_t;
struct vec2 {
  float x, y;
};
struct vec3 {
  float x, y, z;
};
struct ivec2 {
  int x, y;
};
}  // namespace alcove

#define ALCOVE_BEGIN namespace alcove {
#define ALCOVE_END }
#define ALCOVE_CONSTANT inline constexpr
/// A constant with all its digits: double in C++, float in GLSL.
#define ALCOVE_NUMBER inline constexpr double

#else

#extension GL_EXT_scalar_block_layout : require
// The compiler numbers bindings: the host finds a buffer by the name of its block. See core/gpu/recorder.h.
layout(scalar) buffer;
// Branches and loops on lavapipe (Mesa 22 to 25): it runs both sides of an `if` with lanes switched off, and tests only
// at the end of a loop's body whether any lane goes on. A loop with its test first, such as `for`, runs its body once
// more than it has rounds. So loops with long bodies test last. Load uniform values outside of conditions and loops:
// there lavapipe loads them once, else for one lane after the other.
#define ALCOVE_BEGIN
#define ALCOVE_END
#define ALCOVE_CONSTANT const
#define ALCOVE_NUMBER const float

/// min() and max() in two instructions of lavapipe; GLSL's own test both for NaN, which takes a third. If a is NaN, the
/// result is b, as with GLSL's; if b is NaN, the result is NaN.
float lesser(float a, float b) { return a < b ? a : b; }
float greater(float a, float b) { return a > b ? a : b; }

// By the bits, since drivers without SignedZeroInfNanPreserve may take isnan and isinf for false.
bool is_finite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }
bool is_nan(float x) { return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u; }

#endif

ALCOVE_BEGIN

// Pixels of a workgroup in x and y. No kernel may assume that several invocations run in lock step: a subgroup has 8
// invocations on lavapipe with vectors of 256 bits, 4 with vectors of 128 bits, and other numbers on GPUs. Invocations
// write shared values with atomics, and read them after a barrier.
ALCOVE_CONSTANT uint kGroupX = 8;
ALCOVE_CONSTANT uint kGroupY = 8;
// Workgroups in a row of a dispatch over a list: as many as every device takes, since drivers distribute whole rows and
// only the last row has empty workgroups.
ALCOVE_CONSTANT uint kListedRow = 0xffff;
// What `prepare` writes for sky. Its squared distance overflows to infinity, so no radius reaches it.
ALCOVE_CONSTANT float kSkyDepth = 1e30;
// In the exact search the least thickness, in radii, of a run that the image's border cuts, since its width is unknown;
// and the most of its continuation beyond the border. Endless runs would be as near to ray tracing in one picture, but
// would flicker in a moving one.
ALCOVE_CONSTANT float kCutThickness = 0.5;

// An end of a surface goes on behind something if it is no farther from the receiver than this, in radii: a farther one
// seldom comes back within reach.
ALCOVE_CONSTANT float kFarEnd = 1.2;
// The most radii that count of a run's thickness by its width; also where the thickness levels off. A wall is not as
// thick as it is long.
ALCOVE_CONSTANT float kWidestRun = 2;

// The noise of noise.glsl grows from pixel to pixel by these fractions of a turn, times 2^32.
ALCOVE_CONSTANT uint kNoiseXByX = 850015508u, kNoiseXByY = 2573490380u;  // 0.1979097, 0.5991874
ALCOVE_CONSTANT uint kNoiseYByX = 518391397u, kNoiseYByY = 584904276u;   // 0.1206974, 0.1361836

// The R2 sequence (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018) goes on by 1/g and
// 1/g^2, where g^3 = g + 1.
ALCOVE_NUMBER kR2X = 0.75487766624669276;
ALCOVE_NUMBER kR2Y = 0.56984029099805327;
// The roots of 2 and 3, less 1: together with the former and 1 they are linearly independent over the rationals.
ALCOVE_NUMBER kRootX = 0.41421356237309505;
ALCOVE_NUMBER kRootY = 0.73205080756887729;

/// The projection of one frame's data window: pixel <-> view space (x right, y up, the camera looks along -z).
struct View {
  ivec2 size;   // px, of the data window
  vec2 center;  // px from the data window's upper left corner: where the optical axis meets the image
  // perspective: tangent per pixel; orthographic: scene units per pixel. y is negative: pixels count downwards
  vec2 tangent_per_pixel;
  uint orthographic;  // 0 or 1
};

/// Workgroups of a dispatch whose number a kernel decides.
struct GroupCount {
  uint x, y, z;
};

ALCOVE_CONSTANT int kTile = 8;       // px a side of the tiles by which work is skipped
ALCOVE_CONSTANT int kTileBlock = 2;  // tiles a side of the blocks that are judged together

/// Of a listed tile: hidden surfaces may count. Without it nothing is hidden so near that an estimator looks at it.
ALCOVE_CONSTANT uint kTileLayered = 0x80000000u;

/// The numbers of tiles: of those that are listed, and of the others by their reason.
struct TileCounts {
  GroupCount groups;  // that hold the listed ones
  uint listed;
  uint sky;      // or not needed
  uint kept;     // as the frame before has them
  uint layered;  // of the listed ones, those with kTileLayered
};

// px a side of the blocks in which sites are chosen: pixels with an estimate of their own
ALCOVE_CONSTANT int kBlock = 4;

/// The blocks of an image. They are counted from the display window's corner, so that a crop has those of the whole.
struct SiteGrid {
  ivec2 overhang;  // px of the first block to the left of the image and above it
  ivec2 blocks;    // in x and y
};

// How far from a pixel others decide whether it is a site, in px: they are of its block.
ALCOVE_CONSTANT int kSiteReach = 3;
ALCOVE_CONSTANT uint kLattices = 5;  // of one pixel of 16, 8, 4, 2 and 1: see tiles.glsl

/// The number of listed sites: pixels that are to be estimated.
struct SiteCounts {
  GroupCount groups;  // that hold them
  uint listed;
  uint of_lattice[kLattices];  // of them, those on a lattice and on no wider one; from the widest on
};

// What classify says of a tile.
ALCOVE_CONSTANT uint kTileOpen = 0;    // its visibility is 1: it is sky, or not needed
ALCOVE_CONSTANT uint kTileListed = 1;  // it is to be estimated
ALCOVE_CONSTANT uint kTileKept = 2;    // its visibility is as in the frame before, and so are its depth and normals

/// Counts of the kernels over a frame.
struct FrameCounts {
  uint sky;                // pixels
  uint repaired_depth;     // pixels whose depth was NaN or negative: treated as sky
  uint repaired_normals;   // pixels whose normal was not finite or zero: reconstructed from depth
  uint turned_normals;     // pixels whose normal was the opposite of the surface's: turned round
  uint repaired_material;  // pixels whose material AO was NaN or infinite: 1 instead
  uint repaired_beauty;    // pixels of the composite where a colour or alpha was NaN or infinite: 0 instead
};

ALCOVE_END
#endif
