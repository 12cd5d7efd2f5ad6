// Parameters and bindings of sites.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SITES_H
#define ALCOVE_SITES_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kSitesRows = 0;    // in: 8 words per tile, see lattice.glsl
ALCOVE_CONSTANT uint kSitesResult = 1;  // out: the same, with more sites
ALCOVE_CONSTANT uint kSitesLinks = 2;   // in: links over which a path may lead, as `rows` or without a bend, from links

ALCOVE_CONSTANT int kSitesTiles = 3;  // in a row, that one invocation decides

struct SitesParams {
  ivec2 size;    // px
  ivec2 origin;  // px from the display window's corner to the image's
  int spacing;   // of the lattice that sites are added from, 1 to 8
};
ALCOVE_PARAMS(SitesParams)

ALCOVE_END
#endif
