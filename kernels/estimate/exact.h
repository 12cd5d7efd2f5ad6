// Parameters of the kernels that core/chain/estimate/exact.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_EXACT_H
#define ALCOVE_EXACT_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kProfileGroup = 32;  // lines of a workgroup
// px: a run has a vertex at every multiple along the line, so that a crop has those of the whole; a power of 2
ALCOVE_CONSTANT int kProfileRestart = 64;

ALCOVE_CONSTANT uint kVertexBegins = 1;  // its run, where one looks along the line
ALCOVE_CONSTANT uint kVertexEnds = 2;
ALCOVE_CONSTANT uint kVertexLast = 4;  // of the line
ALCOVE_CONSTANT uint kVertexFirst = 8;
// The receiver's own run ends before this vertex, though others go on, where one looks along the line; and against it.
ALCOVE_CONSTANT uint kVertexApart = 16;
ALCOVE_CONSTANT uint kVertexApartAgainst = 32;
// A hidden face closes the run's solid here, where one looks along the line; and against it.
ALCOVE_CONSTANT uint kVertexCloses = 64;
ALCOVE_CONSTANT uint kVertexClosesAgainst = 128;
ALCOVE_CONSTANT uint kVertexHidden = 256;  // it is not of the first surface of its pixel
ALCOVE_CONSTANT uint kNoVertex = 0xffff;

ALCOVE_CONSTANT int kSlopeBits = 14;  // so that products with 100,000 pixels are no larger than an int
ALCOVE_CONSTANT int kSlopeUnit = 1 << kSlopeBits;

/// The lines of one direction over the image.
struct Lines {
  uint steep;    // 1: a step is a pixel in y; 0: in x
  int slope;     // pixels across a step, in 1/kSlopeUnit, -kSlopeUnit to kSlopeUnit
  ivec2 origin;  // px, along and across: what to add to those of the image, so that a crop has the lines of the whole
  int wrap;      // lines to add to a number so that it is not negative: a multiple of the pixels across
};

struct ProfileParams {
  View view;
  Lines lines;
  int first;        // number of the first line: the pixel across at step 0 were it not for the origin
  uint count;       // lines
  float tolerance;  // px: how far in depth a pixel may be from the profile, in its own widths
  // A run's thickness is its width times the first and so many widths of its pixels.
  float depth_per_width, more_pixels;
  // scene units: the most that counts of that, and what thickness levels off at; twice of a run that begins flat
  float widest;
  // scene units: a run that the image's border cuts is taken to be at least so thick, and twice that where it is flat
  float least_at_border;
  float radius;  // scene units: of the sphere beyond which nothing blocks
  uint solids;   // 1: by the rules of solids.glsl; 0: depth alone tells surfaces apart
  uint slot;     // planes of what comes out before that of the first slot
};

ALCOVE_CONSTANT uint kCompleteGroup = 32;  // lines of a workgroup

struct CompleteParams {
  View view;
  Lines lines;   // as the profile's
  int first;     // as the profile's
  uint count;    // lines
  float radius;  // scene units: of the sphere beyond which nothing blocks
  uint slot;     // planes of the profile before the one that is completed
};

ALCOVE_CONSTANT uint kExactBorder = 1;  // surfaces go on beyond the image's border
ALCOVE_CONSTANT uint kExactBehind = 2;  // and as complete has found behind what is nearer
ALCOVE_CONSTANT uint kExactApart = 4;   // what they block so is told apart

struct ExactParams {
  View view;
  Lines lines;  // as the profile's
  // px: from one pixel that takes this slice to the next, along and across: 1, or 2 where those of a block of 2 x 2
  // take others
  int stride;
  ivec2 first;             // px, along and across: the first pixel that takes it
  uint direction;          // which one it is
  uint is_first, is_last;  // 0 or 1: of those that a pixel takes
  float radius;            // scene units
  float thickness;       // scene units, of what is not connected to the receiver; infinite allowed; 0: as deep as wide
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // of planar depth: see clearance.glsl
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
};

/// The estimated error of a tile.
struct JudgedTile {
  float squares;    // sum of the squared errors of its receivers, as one comparison estimates them
  float receivers;  // pixels that are not sky
  uint directions;  // that it had then; 0: none yet
};

struct ConvergeParams {
  View view;
  ivec2 origin;     // px: from the display window's corner to the image's; tiles count from the former
  uint directions;  // so far; 0: all tiles begin, and there is no list to read
  uint plane;       // of the visibility
};

// Comparisons that decide: after 4, 8, 16 and 32 directions. A tile that goes on at one of them can make its neighbours
// do so at the next.
ALCOVE_CONSTANT int kRefineRounds = 4;
// px from a pixel to those whose visibility decides how many directions it takes: its tile and one more a round
ALCOVE_CONSTANT int kRefineReach = kTile - 1 + kRefineRounds * kTile;

struct RefineParams {
  View view;
  ivec2 origin;     // px: from the display window's corner to the image's; tiles count from the former
  float tolerance;  // RMS error of a tile's visibility
  uint directions;  // so far; 0: all tiles with surfaces are listed, and there is no list to read
  uint decides;     // 0: all tiles of the list stay, since there is no estimate to compare with
  uint ends;        // 1: no tile gets more
  uint is_first;    // 1: this is the first of the radii
  float share;      // of a radius in the mean of all
};

ALCOVE_END
#endif
