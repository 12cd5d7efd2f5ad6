// What OpenEXR itself reads from a file: the truth for our own reader.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>

#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace alcove::test {

using NamedPlanes = std::map<std::string, std::vector<float>>;

/// The channels of a flat part that have a sample for every pixel, as floats; nothing where OpenEXR refuses them.
inline std::optional<NamedPlanes> openexr_planes(const std::string& path, int part) {
  try {
    Imf::MultiPartInputFile file(path.c_str(), 0);
    Imf::InputPart input(file, part);
    const Imath::Box2i window = input.header().dataWindow();
    const std::size_t width = std::size_t(window.max.x - window.min.x + 1);
    const std::size_t height = std::size_t(window.max.y - window.min.y + 1);
    NamedPlanes planes;
    Imf::FrameBuffer frame_buffer;
    const auto& channels = input.header().channels();
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      if (at.channel().xSampling != 1 || at.channel().ySampling != 1) continue;
      auto& plane = planes[at.name()];
      plane.resize(width * height);
      frame_buffer.insert(at.name(),
                          Imf::Slice::Make(Imf::FLOAT, plane.data(), window, sizeof(float), sizeof(float) * width));
    }
    input.setFrameBuffer(frame_buffer);
    input.readPixels(window.min.y, window.max.y);
    return planes;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// Whether a part is one of scan lines that ZIP or ZIPS has compressed. Fails as OpenEXR does.
inline bool is_of_zip_lines(const std::string& path, int part) {
  Imf::MultiPartInputFile file(path.c_str(), 0);
  const Imf::Header& header = file.header(part);
  const bool is_zip = header.compression() == Imf::ZIP_COMPRESSION || header.compression() == Imf::ZIPS_COMPRESSION;
  return is_zip && header.type() == Imf::SCANLINEIMAGE;
}

}  // namespace alcove::test
