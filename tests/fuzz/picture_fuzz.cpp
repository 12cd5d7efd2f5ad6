// DDS textures and NumPy's arrays: header and pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/image_io.h"

#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz.h"

using namespace alcove;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(data, size);
  const bool is_dds = std::string_view(reinterpret_cast<const char*>(data), size).starts_with("DDS");
  fuzz::accepts([&] {
    const auto picture = is_dds ? open_dds(input.path(), "--depth") : open_npy(input.path(), "--depth");
    const std::size_t count = picture->names.size();
    fuzz::require(size >= 10, "what is read has a header");
    fuzz::require(picture->data.pixels() > 0 && count > 0 && count <= 4,
                  "a picture has pixels and up to four channels");
    std::vector<std::vector<float>> planes(count, std::vector<float>(picture->data.pixels()));
    std::vector<PictureReader::Channel> channels;
    for (std::size_t i = 0; i < count; i++) channels.push_back({i, planes[i].data()});
    picture->read(0, picture->data.height, channels);
  });
  return 0;
}
