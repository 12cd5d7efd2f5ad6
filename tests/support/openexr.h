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
#include <exception>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <vector>

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

// What OpenEXR itself reads from a file: the truth for our own reader.

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

// Writes deep EXR files of any parts and samples.

/// A part and its samples: of each pixel, of each sample, a value of each channel. A flat part has one sample a pixel.
struct DeepFilePart {
  Window data{0, 0, 3, 2};
  std::vector<std::string> channels{"A", "Z"};
  std::vector<std::vector<std::vector<float>>> pixels = {};  // row by row
  std::string name = "deep", view = {};
  bool is_tiled = false, is_flat = false;
  int tile = 2;  // px a side
  Imf::LevelMode levels = Imf::ONE_LEVEL;
  std::map<std::string, Imf::PixelType> types = {};  // else float
  Imf::Compression compression = Imf::ZIPS_COMPRESSION;
  std::optional<Imf::DeepImageState> state = {};
};

class DeepFileWriter {
 public:
  DeepFileWriter(const std::string& path, const std::vector<DeepFilePart>& parts, const Window& display)
      : parts_(parts), file_(make(path, parts, display)) {
    for (std::size_t part = 0; part < parts.size(); part++)
      parts[part].is_flat ? write_flat(int(part)) : write_deep(int(part));
  }

 private:
  static Imf::PixelType type_of(const DeepFilePart& part, const std::string& channel) {
    const auto type = part.types.find(channel);
    return type == part.types.end() ? Imf::FLOAT : type->second;
  }

  static std::unique_ptr<Imf::MultiPartOutputFile> make(const std::string& path, const std::vector<DeepFilePart>& parts,
                                                        const Window& display) {
    std::vector<Imf::Header> headers;
    for (const auto& part : parts) {
      Imf::Header header(box_of(display), box_of(part.data));
      header.compression() = part.compression;
      header.setName(part.name);
      if (!part.view.empty()) header.setView(part.view);
      header.setType(part.is_flat ? Imf::SCANLINEIMAGE : part.is_tiled ? Imf::DEEPTILE : Imf::DEEPSCANLINE);
      if (part.is_tiled)
        header.setTileDescription(Imf::TileDescription(unsigned(part.tile), unsigned(part.tile), part.levels));
      for (const auto& channel : part.channels) header.channels().insert(channel, Imf::Channel(type_of(part, channel)));
      if (part.state) Imf::addDeepImageState(header, *part.state);
      headers.push_back(header);
    }
    return std::make_unique<Imf::MultiPartOutputFile>(path.c_str(), headers.data(), int(headers.size()));
  }

  void write_flat(int number) {
    const DeepFilePart& part = parts_[std::size_t(number)];
    std::vector<std::vector<float>> planes;
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < part.channels.size(); c++) {
      planes.emplace_back();
      for (const auto& pixel : part.pixels) planes.back().push_back(pixel[0][c]);
    }
    for (std::size_t c = 0; c < part.channels.size(); c++)
      buffer.insert(part.channels[c], Imf::Slice::Make(Imf::FLOAT, planes[c].data(), box_of(part.data)));
    Imf::OutputPart out(*file_, number);
    out.setFrameBuffer(buffer);
    out.writePixels(part.data.height);
  }

  void write_deep(int number) {
    const DeepFilePart& part = parts_[std::size_t(number)];
    const std::size_t width = std::size_t(part.data.width),
                      first = std::size_t(part.data.x) + std::size_t(part.data.y) * width;
    std::vector<std::uint32_t> counts;
    std::vector<std::vector<std::vector<float>>> values(part.channels.size());
    for (const auto& pixel : part.pixels) {
      counts.push_back(std::uint32_t(pixel.size()));
      for (std::size_t c = 0; c < part.channels.size(); c++) {
        values[c].emplace_back();
        for (const auto& sample : pixel) values[c].back().push_back(sample[c]);
      }
    }
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data() - std::ptrdiff_t(first)),
                                             sizeof(std::uint32_t), sizeof(std::uint32_t) * width));
    std::vector<std::vector<std::vector<half>>> halves(part.channels.size());
    std::vector<std::vector<void*>> at(part.channels.size());  // of each channel, the samples of each pixel
    for (std::size_t c = 0; c < part.channels.size(); c++) {
      const Imf::PixelType type = type_of(part, part.channels[c]);
      for (auto& pixel : values[c]) {
        halves[c].emplace_back(pixel.begin(), pixel.end());
        at[c].push_back(type == Imf::HALF ? static_cast<void*>(halves[c].back().data()) : pixel.data());
      }
      buffer.insert(part.channels[c],
                    Imf::DeepSlice(type, reinterpret_cast<char*>(at[c].data() - std::ptrdiff_t(first)), sizeof(void*),
                                   sizeof(void*) * width, type == Imf::HALF ? 2 : 4));
    }
    if (part.is_tiled) {
      Imf::DeepTiledOutputPart out(*file_, number);
      out.setFrameBuffer(buffer);
      for (int level = 0; level < out.numLevels(); level++)
        out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
    } else {
      Imf::DeepScanLineOutputPart out(*file_, number);
      out.setFrameBuffer(buffer);
      out.writePixels(part.data.height);
    }
  }

  const std::vector<DeepFilePart>& parts_;
  std::unique_ptr<Imf::MultiPartOutputFile> file_;
};

/// Writes a file of these parts. The display window is the first part's data window, unless it is said.
inline void write_deep(const std::string& path, const std::vector<DeepFilePart>& parts,
                       const std::optional<Window>& display = {}) {
  DeepFileWriter(path, parts, display.value_or(parts.front().data));
}

}  // namespace alcove::test
