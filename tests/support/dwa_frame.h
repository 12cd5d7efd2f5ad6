// A frame whose normals' channels are named as colours are, which DWA quantizes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/openexr.h"
#include "tests/support/wall_frame.h"

namespace alcove::test {

inline void write_with_dwa(const std::string& path, Imf::Compression compression) {
  FrameFile file = wall_frame();
  for (const auto& [axis, color] : {std::pair("X", "R"), {"Y", "G"}, {"Z", "B"}})
    file.rename(std::string("ViewLayer.Normal.") + axis, std::string("ViewLayer.Normal.") + color);
  Imf::Header header(file.data.width, file.data.height);
  header.compression() = compression;
  write_openexr(path, header, file.planes);
}

}  // namespace alcove::test
