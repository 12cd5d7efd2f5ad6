// Writes deep EXR files of any parts and samples.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/openexr.h"

namespace alcove::test {

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
