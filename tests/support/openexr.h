// OpenEXR itself, for files that Alcove does not write.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepImageStateAttribute.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRationalAttribute.h>
#include <ImfStandardAttributes.h>
#include <ImfStringVectorAttribute.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputFile.h>
#include <ImfTiledOutputPart.h>
#include <ImfTimeCodeAttribute.h>
#include <ImfVecAttribute.h>
#include <half.h>

#include <list>

#include "core/base/image.h"
#include "tests/support/test.h"

namespace alcove::test {

inline Imath::Box2i box_of(const Window& w) { return {{w.x, w.y}, {w.x + w.width - 1, w.y + w.height - 1}}; }

/// Writes a header with its channels and these, which are floats where the header does not say half; a channel without
/// values is of zeros.
inline void write_openexr(const std::string& path, Imf::Header header,
                          const std::map<std::string, std::vector<float>>& planes = {}) {
  const Imath::Box2i box = header.dataWindow();
  Imf::FrameBuffer buffer;
  std::list<std::vector<half>> halves;
  for (const auto& [name, plane] : planes) {
    if (!header.channels().findChannel(name)) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    const Imf::PixelType type = header.channels()[name].type;
    if (type == Imf::HALF) halves.emplace_back(plane.begin(), plane.end());
    buffer.insert(name, type == Imf::HALF ? Imf::Slice::Make(type, halves.back().data(), box)
                                          : Imf::Slice::Make(type, plane.data(), box));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(box.max.y - box.min.y + 1);
}

}  // namespace alcove::test
