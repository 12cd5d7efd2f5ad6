// What the sources share that read and write EXR files. No other file includes this.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImathBox.h>
#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <exception>
#include <string>

#include "core/formats/exr.h"

namespace alcove {

class ExrAttributes {
 public:
  Imf::Header header;
};

inline Window window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1};
}

inline Imath::Box2i box_of(const Window& window) {
  return {{window.x, window.y}, {window.x + window.width - 1, window.y + window.height - 1}};
}

inline SampleType sample_type_of(Imf::PixelType type) {
  return type == Imf::HALF    ? SampleType::half_float
         : type == Imf::FLOAT ? SampleType::single_float
                              : SampleType::integer;
}

/// Gives OpenEXR's description of an error on one line.
std::string one_line(const std::exception& error);

/// Whether an attribute says how the input is stored or what its channels are, which does not hold for another file.
bool describes_storage(const std::string& name);

}  // namespace alcove
