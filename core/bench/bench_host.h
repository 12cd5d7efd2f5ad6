// Where the time of a single frame goes, from its files to its output, step by step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/settings.h"

namespace alcove {

/// A step of a frame: what it takes, and how many bytes go through it.
struct HostStep {
  std::string name;
  double ms;  // the median
  std::uint64_t bytes;
};

/// Times a frame so often, after one frame that does not count. The steps are, in this order:
/// - open: headers, in bytes of the files that hold them
/// - read: from the files' bytes to planes
/// - settle: what the pixels tell of depth and normals, in bytes of these
/// - hash: all planes, to find what the frame before had too
/// - upload: the planes, to memory that kernels see; nothing where they lie there already
/// - compute: what the device takes for the passes, in bytes that these read and write
/// - download: the results, to memory that the host sees; nothing where they lie there already
/// - convert: the results, in bytes of floats that become half floats
/// - write: the rest of writing, in bytes of the output file
/// settings.output is chosen here but for its AOVs and types. Fails as a run does.
std::vector<HostStep> time_host(Settings settings, int repeats);

}  // namespace alcove
