// Deep EXR files: what says how samples are stored, and the surfaces that they make.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/formats/exr.h"
#include "tests/fuzz/fuzz.h"

using namespace alcove;

namespace {

/// Every surface has a depth, and lies behind those before it.
void look_at(const std::vector<float>& planes, std::size_t pixels) {
  for (std::size_t i = 0; i < pixels; i++) {
    float last = 0;
    for (std::size_t surface = 0; surface < kMostDeepSurfaces; surface++) {
      const float front = planes[surface * pixels + i], back = planes[(kMostDeepSurfaces + surface) * pixels + i];
      fuzz::require(front > 0 && front >= last && front <= kNoDeepSurface, "surfaces are in order");
      fuzz::require(back > front || (back == kNoDeepSurface && front == kNoDeepSurface),
                    "a body ends behind its front");
      last = front;
    }
  }
}

/// Of the first rows, as far as there are not too many pixels: a tile may have far more rows.
void read_samples(ExrFile& file, int part) {
  const Window data = file.parts()[std::size_t(part)].data;
  const std::size_t width = std::size_t(data.width),
                    rows = std::min(std::size_t(data.height), fuzz::kMostPixels / width);
  const std::size_t pixels = width * rows;
  if (pixels == 0) return;
  file.take_deep({part}, {.opacity = 0.5, .separation = {0, 1e-3, 0}});
  std::vector<float> planes(2 * kMostDeepSurfaces * pixels);
  std::vector<ExrRead> reads;
  for (std::size_t plane = 0; plane < 2 * kMostDeepSurfaces; plane++)
    reads.push_back(
        {part, deep_channel(plane % kMostDeepSurfaces, plane >= kMostDeepSurfaces), planes.data() + plane * pixels});
  file.read(reads, 0, int(rows));
  look_at(planes, pixels);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(data, size);
  fuzz::accepts([&] {
    ExrFile file(input.path(), "--deep");
    for (std::size_t part = 0; part < file.parts().size(); part++)
      if (file.parts()[part].deep) fuzz::accepts([&] { read_samples(file, int(part)); });
  });
  return 0;
}
