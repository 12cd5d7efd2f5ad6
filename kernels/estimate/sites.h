// Parameters of the kernels that core/chain/estimate/sites.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SITES_H
#define ALCOVE_SITES_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct LinksParams {
  View view;
  ivec2 origin;  // px from the display window's corner to the image's
};

ALCOVE_CONSTANT int kSitesTiles = 3;  // in a row, that one invocation decides

struct SitesParams {
  ivec2 size;    // px
  ivec2 origin;  // px from the display window's corner to the image's
  int spacing;   // of the lattice that sites are added from, 1 to 8
};

struct ListSitesParams {
  ivec2 size;    // px
  ivec2 origin;  // px from the display window's corner to the image's
};

ALCOVE_END
#endif
