// EXR files: headers, attributes, the camera and the program they tell of, and the pixels of every channel.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr.h"

#include <cmath>

#include "core/frame/camera/camera.h"
#include "core/frame/find/input_rules.h"
#include "tests/fuzz/fuzz.h"

using namespace alcove;

namespace {

void read_pixels(ExrFile& file, std::size_t part) {
  const Window data = file.parts()[part].data;
  if (data.pixels() > fuzz::kMostPixels) return;
  std::vector<std::vector<float>> planes;
  std::vector<ExrRead> reads;
  for (const auto& channel : file.parts()[part].channels)
    if (!channel.subsampled) {
      planes.emplace_back(data.pixels());
      reads.push_back({int(part), channel.name, planes.back().data()});
    }
  fuzz::accepts([&] { file.read(reads); });
  fuzz::accepts([&] { file.read(reads, data.height - 1, 1); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(data, size);
  attribute_of_whole_exr(input.path(), "alcove/options");
  fuzz::accepts([&] {
    ExrFile file(input.path(), "INPUT");
    detect_rules(file);
    for (std::size_t part = 0; part < file.parts().size(); part++) {
      fuzz::require(file.parts()[part].data.width > 0 && file.parts()[part].data.height > 0,
                    "a data window has pixels");
      file.attributes(int(part));
      const auto texts = file.attribute_texts(int(part));
      fuzz::accepts([&] { require_no_panorama(texts, input.path()); });
      const std::string layer = "FinalImageMovieRenderQueue_WorldDepth_A";
      why_no_header_camera(texts, layer);
      if (const auto found =
              header_camera(texts, file.display(), file.parts()[part].data, file.pixel_aspect(), layer)) {
        fuzz::require(found->camera.fx > 0 && found->camera.fy > 0, "a camera has a field of view");
        for (const double x : {found->camera.cx, found->camera.cy})
          fuzz::require(std::isfinite(float(x)), "a camera has a centre");
      }
      read_pixels(file, part);
    }
  });
  return 0;
}
