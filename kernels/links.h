// Parameters and bindings of links.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_LINKS_H
#define ALCOVE_LINKS_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kLinksDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kLinksNormal = 1;  // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kLinksRows = 2;    // out: 8 words per tile, see lattice.glsl
ALCOVE_CONSTANT uint kLinksFlat =
    3;  // out: the same, of which two bytes are written: linked without a bend; only if adaptive

ALCOVE_CONSTANT uint kLinksSpacingId = 0;  // specialization: of the lattice whose surfaces are sites, 1 to 16
// specialization: 1: says what is one surface; 0: that nothing is, for sites that do not depend on it
ALCOVE_CONSTANT uint kLinksAdaptiveId = 1;

struct LinksParams {
  View view;
  ivec2 origin;  // px from the display window's corner to the image's
};
ALCOVE_PARAMS(LinksParams)

ALCOVE_END
#endif
