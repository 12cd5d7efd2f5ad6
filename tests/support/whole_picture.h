// All pixels of a picture that is no EXR.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/formats/image_io.h"

namespace alcove::test {

inline Image whole(PictureReader& picture) {
  Image image(picture.data, picture.display, picture.names);
  std::vector<PictureReader::Channel> channels;
  for (std::size_t i = 0; i < image.names.size(); i++) channels.push_back({i, image.plane(i).data()});
  picture.read(0, image.data.height, channels);
  return image;
}

}  // namespace alcove::test
