// Finding, reading, settling.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/settled.h"

#include "core/frame/settle.h"

namespace alcove::test {

FrameSource settled(const InputSettings& settings) {
  FrameSource source = find_frame(settings, false, 0);
  const RawFrame raw = read_raw_frame(source);
  settle(source, settings, raw.depth, raw.normal);
  return source;
}

}  // namespace alcove::test
