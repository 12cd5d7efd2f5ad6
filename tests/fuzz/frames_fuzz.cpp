// Lists of frame numbers, and names with a place for one. The first byte chooses.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/run/plan.h"
#include "tests/fuzz/fuzz.h"

using namespace alcove;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // arguments end at a zero byte
  const std::string text(reinterpret_cast<const char*>(data) + 1, std::find(data + 1, data + size, 0) - (data + 1));
  if (data[0] == 'l') {
    fuzz::accepts([&] {
      std::vector<int> frames = parse_frames(text);
      fuzz::require(frames.size() <= 1000000, "a list is no longer than it may be");
      std::ranges::sort(frames);
      fuzz::require(std::ranges::adjacent_find(frames) == frames.end(), "no frame is there twice");
      if (frames.size() <= 1000)
        fuzz::require(frames.empty() || parse_frames(frames_text(frames)) == frames,
                      "the shortest list is the same list");
    });
  } else {
    frame_number_of(text);
    fuzz::accepts([&] {
      const auto pattern = frame_pattern(text);
      if (!pattern) return;
      for (const int frame : {-2147483647, -1, 0, 1001, 2147483647}) {
        const std::string path = pattern->path(frame);
        fuzz::require(path.starts_with(pattern->before) && path.ends_with(pattern->after),
                      "a path is its pattern with a number");
      }
    });
  }
  return 0;
}
