// Parameters of the kernels that choose sites and tiles, of the estimators that take samples, and of completion.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_ESTIMATE_H
#define ALCOVE_ESTIMATE_H
#include "kernels/hidden/hidden.h"
ALCOVE_BEGIN

struct SitesParams {
  View view;
  SiteGrid grid;
  uint lattice;  // of whose pixels surfaces are sites whatever is beside them: as the word of a block
  float reach;   // px at unit depth (orthographic: at any): from so far a site stands for others at most
};

struct ListSitesParams {
  ivec2 size;  // px
  SiteGrid grid;
  ivec2 origin;  // px from the corner of lattices to the image's
};

struct BoundsParams {
  ivec2 size;   // px, of the image
  uint hidden;  // planes of hidden surfaces
};

ALCOVE_CONSTANT uint kClassifySkips = 1;      // else every tile is listed, and hidden surfaces count everywhere
ALCOVE_CONSTANT uint kClassifyWithFirst = 2;  // moments
ALCOVE_CONSTANT uint kClassifyWithCompleted = 4;
// with kClassifySkips: reads the changes, and leaves tiles as they are within whose reach nothing has changed
ALCOVE_CONSTANT uint kClassifyReuses = 8;
ALCOVE_CONSTANT uint kClassifySelects = 16;  // with kClassifySkips: other tiles count as sky
ALCOVE_CONSTANT uint kClassifyLayered = 32;  // surfaces may be hidden: listed tiles say where these may count
ALCOVE_CONSTANT uint kClassifyWithSecond = 64;
ALCOVE_CONSTANT uint kClassifyWithCurvature = 128;

// px of the frame beyond the reach: their depths may decide a normal that was reconstructed, or which surface a pixel
// of a smaller image shows; of hidden surfaces also which ends with the one before it, and closes its solid
ALCOVE_CONSTANT int kChangeMargin = 8;
ALCOVE_CONSTANT int kHiddenChangeMargin = kChangeMargin + kEndsReach + kEndsBeyond;

ALCOVE_CONSTANT int kChangeBlock = 32;  // px of the frame a side of the blocks whose changes are known

struct ClassifyParams {
  View view;
  float radius;      // scene units: the farthest at which anything blocks
  float told;        // scene units: the farthest that may tell how far back that is solid
  float front;       // scene units: the farthest front of a surface that blocks within the radius
  uint plane;        // of the AO
  uint curvature;    // plane of the moments from which those of curvature follow
  ivec2 frame_size;  // px; the frame is the image, or `factor` times as large
  ivec2 overhang;    // px of the first pixel of the image that are outside of the frame
  int factor;
  int margin;     // px of the frame beyond the reach whose depths may decide what is within it
  SiteGrid grid;  // of sites; only if sparse
  // px of the image: from and up to where anybody needs estimates; with kClassifySkips tiles outside count as sky
  ivec2 needed_from, needed_to;
};

ALCOVE_CONSTANT uint kWithFirst = 4;         // a bit beside kFalloff*: moments of first order too
ALCOVE_CONSTANT uint kWithCompleted = 8;     // another one: what completed surfaces take, too
ALCOVE_CONSTANT uint kWithSecond = 16;       // moments of second order, beside those of first
ALCOVE_CONSTANT uint kWithCurvature = 32;    // what the own surface blocks inside and outside
ALCOVE_CONSTANT uint kThicknessWidth = 0;    // as deep as wide
ALCOVE_CONSTANT uint kThicknessLength = 1;   // as HorizonParams says
ALCOVE_CONSTANT uint kThicknessEndless = 2;  // solid as far as the sphere of the radius
ALCOVE_CONSTANT uint kCompletesBorder = 4;   // a bit beside them: surfaces go on beyond the image's border
ALCOVE_CONSTANT uint kCompletesHidden = 8;   // another one: they go on behind what is nearer, if not kThicknessEndless
ALCOVE_CONSTANT uint kInSectors = 16;        // another one: all that blocks is counted in sectors, no horizon is exact
ALCOVE_CONSTANT uint kTellsBacks = 32;       // another one: pixels tell how far back they are solid
ALCOVE_CONSTANT uint kHiddenSurface = 64;

ALCOVE_CONSTANT int kChainsGroup = 16;
ALCOVE_CONSTANT int kChainsRow = 65536;  // invocations of chains in a row, of which each computes a segment
ALCOVE_CONSTANT int kSegment = 32;       // px of a row or a column: see backs.glsl
// radii: nothing farther away along a row of pixels of one surface tells how far back it is solid
ALCOVE_CONSTANT float kLongestChain = 1.9f;
ALCOVE_CONSTANT float kMostBack = 4;  // radii: solids reach back as far as they are seen to, but no farther

struct BacksParams {
  View view;
  float radius;      // scene units
  uint has_normals;  // 0: they were reconstructed, and at outlines tell nothing of how a surface goes on
};

struct HorizonParams {
  View view;
  float radius;          // scene units
  float falloff_start;   // scene units, below the radius
  float front;           // scene units: the farthest front that may block; the solid behind it reaches into the radius
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
  float thickness;       // scene units, infinite allowed; 0: as deep as wide
  uint plane;            // of the output, which has one plane per radius
  uint curvature;        // plane of the moments from which those of curvature follow
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

// px between the blocks of which `nearest` tells the depth, and a side of them: they overlap, so that any line of half
// that length lies in one
ALCOVE_CONSTANT int kNearestStep = 16, kNearestBlock = 2 * kNearestStep;

struct NearestParams {
  ivec2 size;         // px, of the image
  uint orthographic;  // 0 or 1
};

struct ShadowParams {
  View view;
  vec3 light;            // unit vector to a sun, or scene units: the place of a lamp; in view space
  uint is_lamp;          // 0 or 1
  float spread;          // of a sun the tangent of half its angle; of a lamp its radius in scene units
  float reach;           // scene units from the receiver up to which anything blocks
  float size;            // scene units: the radius by which thickness levels off
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
  float thickness;       // scene units, infinite allowed; 0: as deep as wide
  uint plane;            // of the output, which has one plane per light
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

struct HbaoParams {
  View view;
  float radius;         // scene units
  float falloff_start;  // scene units, below the radius
  float bias;           // sine of the elevation above the tangent plane below which nothing blocks
  // 1: the horizon's elevation above the surface; 0: of horizon and surface above the plane across the view ray
  uint from_surface;
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

ALCOVE_CONSTANT uint kRangeNone = 0;   // every hit counts fully
ALCOVE_CONSTANT uint kRangeRatio = 1;  // smoothstep(0, 1, radius / dz): fully within the radius, less beyond
// 1 - smoothstep(0, radius, dz): less from the receiver on, nothing beyond the radius
ALCOVE_CONSTANT uint kRangeSmoothstep = 2;

struct CrytekParams {
  View view;
  float radius;          // scene units
  float bias;            // scene units: by how much a hit must be nearer to the eye than the sample
  uint uniform_volume;   // 1: samples even in volume; 0: clustered about the receiver
  uint range_check;      // one of kRange*
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

struct CompletionParams {
  View view;
  ivec2 origin;  // px from the display window's corner to the image's
  int spacing;   // of the widest lattice of sites: see tiles.glsl; 1: all pixels have an estimate
  uint plane;    // of the visibility
};

// px of depth around the picture. Frames of 960 x 540 err by .0883 without, .0842 with 64, .0838 with 96, .0835 with
// 160.
ALCOVE_CONSTANT int kDepthMargin = 96;

struct MarginParams {
  View view;
};

struct QuickParams {
  View view;
  SiteGrid grid;
  float radius;          // scene units
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

ALCOVE_END
#endif
