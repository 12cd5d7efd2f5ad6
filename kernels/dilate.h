// Parameters and bindings of dilate.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_DILATE_H
#define ALCOVE_DILATE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kDilateTiles = 0;  // in: one uint per tile, from classify
// one uint per run along columns, line by line: 1 if it is listed; out: along columns, in: along rows
ALCOVE_CONSTANT uint kDilateColumns = 1;
ALCOVE_CONSTANT uint kDilateList = 2;    // out: one uint per run or group that is listed, see pack_run
ALCOVE_CONSTANT uint kDilateCounts = 3;  // in and out: RunCounts, zeros
// out: one float per pixel of the filter's result, where it is neither computed nor kept: 1; not along rows
ALCOVE_CONSTANT uint kDilateResult = 4;

ALCOVE_CONSTANT uint kDilateRadiusId = 0;  // specialization: the denoiser's, px; 0: there is none
ALCOVE_CONSTANT uint kDilateModeId = 1;    // specialization: one of these

ALCOVE_CONSTANT uint kDilateAlongColumns = 0;  // runs whose result may be other than 1 or than it was; before the rows
ALCOVE_CONSTANT uint kDilateAlongRows = 1;     // runs that those read
ALCOVE_CONSTANT uint kDilateUpsample = 2;      // workgroups of upsample

struct DilateParams {
  ivec2 size;          // px that the tiles are of
  int runs, lines;     // runs in a line, and lines of tiles; groups in x and y
  int runs_in_column;  // of what the columns are
  ivec2 full_size;     // px of what is upsampled, `factor` times as large
  ivec2 overhang;      // of these px, as upsample has it
  int factor;
};
ALCOVE_PARAMS(DilateParams)

ALCOVE_END
#endif
