// Types and checks that mean the same in C++ and in GLSL, so that a kernel's parameters are written once.
// SPDX-License-Identifier: BSD-3-Clause
//
// A header beside a kernel declares its parameters, bindings and group size with these names; the kernel and its host
// function in core/chain/passes.cpp or core/chain/estimate.cpp both include it. Layout is scalar: every member is
// aligned to 4 bytes, in C++ as in GLSL.
#ifndef ALCOVE_SHARED_H
#define ALCOVE_SHARED_H

#ifdef __cplusplus

#include <cstdint>
#include <type_traits>

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
/// Push constants: at most the 128 bytes that every Vulkan device takes.
#define ALCOVE_PARAMS(T) static_assert(sizeof(T) <= 128 && alignof(T) == 4 && std::is_trivially_copyable_v<T>);

#else

#extension GL_EXT_scalar_block_layout : require
#define ALCOVE_BEGIN
#define ALCOVE_END
#define ALCOVE_CONSTANT const
#define ALCOVE_PARAMS(T)

#endif

ALCOVE_BEGIN

// pixels of a workgroup in x; 8 is lavapipe's subgroup size, so a row is one subgroup
ALCOVE_CONSTANT uint kGroupX = 8;
ALCOVE_CONSTANT uint kGroupY = 8;  // pixels of a workgroup in y
// what `prepare` writes for sky: its squared distance overflows to infinity, so no radius reaches it
ALCOVE_CONSTANT float kSkyDepth = 1e30;

/// The projection of one frame's data window: pixel <-> view space (x right, y up, the camera looks along -z).
struct View {
  ivec2 size;   // px, of the data window
  vec2 center;  // px from the data window's upper left corner: where the optical axis meets the image
  // perspective: tangent a pixel; orthographic: scene units a pixel. y is negative: pixels count downwards
  vec2 tangent_per_pixel;
  uint orthographic;  // 0 or 1
};

/// Workgroups of a dispatch whose number a kernel decides.
struct GroupCount {
  uint x, y, z;
};

ALCOVE_CONSTANT int kTile = 8;             // px a side of the tiles by which work is skipped
ALCOVE_CONSTANT int kTileGroup = 4;        // tiles a side of the groups by which they are searched
ALCOVE_CONSTANT uint kTilePlanes = 10;     // of TileBounds
ALCOVE_CONSTANT uint kSectorsOfTurn = 16;  // of directions on the image: see tiles.glsl

/// The surfaces seen in a tile, from the eye's side. They are told by their nearness: 1 / z, or -z orthographic, in
/// which planes are affine in the pixel.
struct TileBounds {
  vec2 gradient;  // nearness a pixel, from corner to corner of the tile
  // at the tile's centre, of planes that no surface is before: with its own gradient, those of its neighbours, see
  // tiles.glsl; level
  float plane[kTilePlanes];
  float farthest;         // least nearness; above the level plane where the tile is all sky
  uint mixed;             // 1: its surfaces leave the plane with its own gradient, so that another one may be lower
  uint normal;            // of its receivers, packed; kNoNormal: they have none in common
  float turned;           // length of the largest difference of a receiver's normal to it
  float lowest, highest;  // of -dot(normal, position) over the receivers
};

/// The same of a group of tiles, less tightly.
struct GroupBounds {
  vec2 gradient;       // nearness a pixel
  float plane, level;  // at the group's centre, of planes that no surface is before: with that gradient, and with none
  float farthest;      // as of a tile
};

/// A tile that is to be estimated.
struct ListedTile {
  uint place;  // column + (row << 16), in tiles
  // of each sector of directions on the image, the steps at which something may stand above, first + (last << 16); 0:
  // nothing blocks
  uint ranges[kSectorsOfTurn];
};

/// How many there are, and why the others are not.
struct TileCounts {
  GroupCount groups;  // that hold the listed ones
  uint listed;
  uint sky;
  uint open;       // proved to be
  uint tolerated;  // of them, those that are so only within the tolerance
  uint kept;       // as the frame before has them
};

/// Of runs of pixels that a filter is for.
struct RunCounts {
  GroupCount groups;
  uint listed;
};

/// What classify says of a tile: a bit for every sector of directions in which something may block, or
ALCOVE_CONSTANT uint kTileOpen = 0;        // its visibility is 1: nothing blocks, or it is sky
ALCOVE_CONSTANT uint kTileKept = 1 << 16;  // its visibility is as in the frame before, and so are its depth and normals

/// What the kernels count over a frame.
struct FrameCounts {
  uint sky;                // pixels
  uint repaired_depth;     // pixels whose depth was NaN or negative: treated as sky
  uint repaired_normals;   // pixels whose normal was not finite or zero: reconstructed from depth
  uint repaired_material;  // pixels whose material AO was NaN or infinite: 1 instead
  uint repaired_beauty;    // pixels of the composite where a colour or alpha was NaN or infinite: 0 instead
};

ALCOVE_END
#endif
