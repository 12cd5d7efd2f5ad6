// Parameters and bindings of list_sites.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_LIST_SITES_H
#define ALCOVE_LIST_SITES_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kListSitesRows = 0;        // in: 8 words per tile, see lattice.glsl
ALCOVE_CONSTANT uint kListSitesTiles = 1;       // in: one uint per listed tile
ALCOVE_CONSTANT uint kListSitesTileCounts = 2;  // in: TileCounts
ALCOVE_CONSTANT uint kListSitesList =
    3;  // out: one uint per site of a listed tile, see pack_site; in no order of tiles
ALCOVE_CONSTANT uint kListSitesCounts = 4;  // in and out: SiteCounts, zeros

struct ListSitesParams {
  ivec2 size;    // px
  ivec2 origin;  // px from the display window's corner to the image's
};
ALCOVE_PARAMS(ListSitesParams)

ALCOVE_END
#endif
