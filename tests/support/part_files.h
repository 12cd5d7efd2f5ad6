// EXR files of any parts and channels, with values that tell their place, and what is found in them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/frame/find/frame_source.h"
#include "tests/support/openexr.h"
#include "tests/support/program.h"
#include "tests/support/test.h"

namespace alcove::test {

using Names = std::vector<std::string>;

constexpr int kWidth = 3, kHeight = 2, kPixels = kWidth * kHeight;

struct Part {
  std::string name;
  Names channels;
  int width = kWidth;
  std::string view = {};
  Names multi_view = {};
};

inline Names xyz(const std::string& layer) { return {layer + ".X", layer + ".Y", layer + ".Z"}; }
inline Names operator+(Names names, const Names& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

/// The channel's value in every pixel, told from all others by its place.
inline float value_of(std::size_t part, std::size_t channel) { return float(10 * part + channel + 1); }

inline Imf::Header header_of(const Part& part) {
  Imf::Header header(Imath::Box2i({0, 0}, {kWidth - 1, kHeight - 1}),
                     Imath::Box2i({0, 0}, {part.width - 1, kHeight - 1}));
  header.setType(Imf::SCANLINEIMAGE);
  if (!part.name.empty()) header.setName(part.name);
  if (!part.view.empty()) header.setView(part.view);
  if (!part.multi_view.empty()) Imf::addMultiView(header, part.multi_view);
  for (const auto& channel : part.channels) header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  return header;
}

/// A file of these parts; only one part may be without a name.
inline void write_parts(const std::string& path, const std::vector<Part>& parts) {
  std::vector<Imf::Header> headers;
  for (const auto& part : parts) headers.push_back(header_of(part));
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), int(headers.size()));
  for (std::size_t p = 0; p < parts.size(); p++) {
    std::vector<std::vector<float>> planes;
    Imf::FrameBuffer pixels;
    for (std::size_t c = 0; c < parts[p].channels.size(); c++) {
      planes.emplace_back(parts[p].width * kHeight, value_of(p, c));
      pixels.insert(parts[p].channels[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(planes.back().data()),
                                                     sizeof(float), sizeof(float) * std::size_t(parts[p].width)));
    }
    Imf::OutputPart out(file, int(p));
    out.setFrameBuffer(pixels);
    out.writePixels(kHeight);
  }
}

/// "part:channel" of each; the part is left out where it is the first.
inline Names names_of(const std::vector<ChannelRef>& channels) {
  Names names;
  for (const auto& c : channels) names.push_back(c.part == 0 ? c.channel : std::to_string(c.part) + ":" + c.channel);
  return names;
}

class GBuffer : public testing::Test {
 protected:
  GBuffer() {
    settings.input = folder / "frame.exr";
    settings.fov = 60;
    settings.normal_space = NormalSpace::view;
  }

  void write(const std::vector<Part>& parts) const { write_parts(settings.input, parts); }
  void write(const Names& channels) const { write_parts(settings.input, {{"", channels}}); }
  FrameSource find(bool with_beauty = false) const { return find_frame(settings, with_beauty, 0); }

  Names depth() const { return names_of(find().channels[RawPlane::depth]); }
  Names normal() const { return names_of(find().channels[RawPlane::normal]); }

  /// The search must fail with ErrorKind::input, in one line that holds these.
  void expect_error(const Names& words, bool with_beauty = false) const {
    test::expect_error(ErrorKind::input, words, [&] {
      const FrameSource source = find(with_beauty);
      ADD_FAILURE() << "found depth " << testing::PrintToString(names_of(source.channels[RawPlane::depth]))
                    << ", normal " << testing::PrintToString(names_of(source.channels[RawPlane::normal]));
    });
  }

  TemporaryFolder folder;
  InputSettings settings;
};

}  // namespace alcove::test
