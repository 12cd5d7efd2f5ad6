// Writes pictures of the formats that OpenImageIO knows by a name's ending.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenImageIO/imageio.h>

#include "tests/support/test.h"

namespace alcove::test {

inline void write_picture(const std::string& path, const OIIO::ImageSpec& spec, const std::vector<float>& pixels) {
  const auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out && out->open(path, spec)) << path;
  ASSERT_TRUE(out->write_image(OIIO::TypeFloat, pixels.data()) && out->close()) << path << out->geterror();
}

}  // namespace alcove::test
