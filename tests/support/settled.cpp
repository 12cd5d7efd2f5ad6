// Finding, reading, settling.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/settled.h"

#include <vector>

#include "core/frame/settle.h"

namespace alcove::test {

FrameSource settled(const InputSettings& settings) {
  FrameSource source = find_frame(settings, false, 0);
  std::vector<float> depth(source[RawPlane::depth].size() * source.data.pixels()),
      normal(source[RawPlane::normal].size() * source.data.pixels());
  read_planes(source, {{&source[RawPlane::depth], depth.data()}, {&source[RawPlane::normal], normal.data()}});
  settle(source, settings, depth, normal);
  return source;
}

}  // namespace alcove::test
