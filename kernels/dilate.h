// Parameters and bindings of dilate.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_DILATE_H
#define ALCOVE_DILATE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kDilateTiles = 0;    // in: uint a tile, from classify
ALCOVE_CONSTANT uint kDilateColumns = 1;  // uint a run along columns, line by line: 1 if it is listed; out: along columns, in: along rows
ALCOVE_CONSTANT uint kDilateList = 2;     // out: uint a run that is listed, see pack_run, in no order
ALCOVE_CONSTANT uint kDilateCounts = 3;   // in, out: RunCounts, zeros
ALCOVE_CONSTANT uint kDilateResult = 4;   // out: float a pixel, the columns' result, where it is neither computed nor kept: 1; only along columns

ALCOVE_CONSTANT uint kDilateRadiusId = 0;  // specialization: the filter's, px
ALCOVE_CONSTANT uint kDilateStrideId = 1;  // specialization: of rows of a sparse estimate, as the denoiser has it; else 1
ALCOVE_CONSTANT uint kDilateAlongId = 2;   // specialization: one of these

ALCOVE_CONSTANT uint kDilateAlongColumns = 0;  // runs whose result may be other than 1 or than it was; before the rows
ALCOVE_CONSTANT uint kDilateAlongRows = 1;     // runs that those read

struct DilateParams {
  ivec2 size;  // px
  int runs, lines;     // runs in a line, and lines of tiles
  int runs_in_column;  // of what the columns are
};
ALCOVE_PARAMS(DilateParams)

ALCOVE_END
#endif
