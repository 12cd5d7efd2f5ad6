// Parameters and bindings of profile.comp, and the lines that it shares with exact.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_PROFILE_H
#define ALCOVE_PROFILE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kProfileDepth = 0;  // in: one float per pixel, depth of the first surfaces that may block
// What comes out has a plane of the image's size for each slot.
ALCOVE_CONSTANT uint kProfileVertex = 1;  // out: one float per vertex, its planar depth
// out: one uint per vertex: its step in the high half, its run's thickness (pack_width()) and kVertex* in the low; 0
// for a line that shows no surface
ALCOVE_CONSTANT uint kProfileMark = 2;
// out: one uint per step: the columns of the vertices before (low half) and after it; kNoVertex: none
ALCOVE_CONSTANT uint kProfileNeighbor = 3;

ALCOVE_CONSTANT uint kProfileHidden = 4;  // in: planes of floats, see GBuffer::hidden; only with several surfaces
// out: one uint per step, the slot of its first surface, as many as there are slots if that may not block; only with
// several slots
ALCOVE_CONSTANT uint kProfileOwn = 5;

ALCOVE_CONSTANT uint kProfileEveryPixelId = 0;  // specialization: 1: every pixel is a vertex
ALCOVE_CONSTANT uint kProfileSurfacesId = 1;    // specialization: of a pixel, 1 to 1 + kMostHidden of layers.h
// specialization: as many as surfaces; or 1 for the first surface of each pixel
ALCOVE_CONSTANT uint kProfileSlotsId = 2;

ALCOVE_CONSTANT uint kProfileGroup = 32;  // lines of a workgroup
// px: a run has a vertex at every multiple along the line, so that a crop has those of the whole; a power of 2
ALCOVE_CONSTANT int kProfileRestart = 64;

ALCOVE_CONSTANT uint kVertexBegins = 1;  // its run, where one looks along the line
ALCOVE_CONSTANT uint kVertexEnds = 2;
ALCOVE_CONSTANT uint kVertexLast = 4;  // of the line
ALCOVE_CONSTANT uint kVertexFirst = 8;
ALCOVE_CONSTANT uint kVertexFlags = 15;
ALCOVE_CONSTANT uint kVertexThickness = 0xfff0;
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
  float least_at_border;  // scene units: a run that the image's border cuts is taken to be at least so thick
  uint slot;              // planes of what comes out before that of the first slot
};
ALCOVE_PARAMS(ProfileParams)

ALCOVE_END
#endif
