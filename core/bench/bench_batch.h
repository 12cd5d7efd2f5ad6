// What a long run takes, against the two things that it cannot do without: the files, and the kernels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"

namespace alcove {

struct BatchTimes {
  int frames = 0, at_once = 0;
  double run_s = 0;  // of `alcove run` over them
  // reading the same channels and writing the same file, with nothing in between, on as many threads
  double files_s = 0;
  double compute_s = 0;  // the kernels alone, on frames that are there already, as many at once
};

/// Times so many frames, all of the settings' one input; settings.output is chosen here. Fails as a run does.
BatchTimes time_batch(Settings settings, int frames);

}  // namespace alcove
