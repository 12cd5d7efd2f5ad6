// However an EXR stores its pixels - line order, compression, tiles, levels - the same planes are read.
// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <numeric>

#include "core/frame/gbuffer.h"
#include "tests/support/program.h"

namespace alcove {
namespace {

using namespace test;

/// Writes Z = 1, 2, 3 ... over a data window that does not begin at 0, in some layout; the planes that are read must be
/// these.
class Layouts : public testing::Test {
 protected:
  static constexpr int kX = -3, kY = 5, kColumns = 7, kRows = 40;
  Layouts() {
    settings.input = folder / "frame.exr";
    settings.fov = 60;
    std::iota(values.begin(), values.end(), 1.0f);
  }
  Imf::Header header() const {
    const Imath::Box2i window({kX, kY}, {kX + kColumns - 1, kY + kRows - 1});
    Imf::Header header(window, window);
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    return header;
  }
  Imf::FrameBuffer pixels() {
    Imf::FrameBuffer pixels;
    pixels.insert("Z", Imf::Slice::Make(Imf::FLOAT, values.data(), header().dataWindow(), sizeof(float),
                                        kColumns * sizeof(float)));
    return pixels;
  }
  void expect_pixels() const {
    FrameSource source = find_frame(settings, false, 0);
    EXPECT_EQ(source.data, (Window{kX, kY, kColumns, kRows}));
    std::vector<float> read(values.size());
    read_planes(source, {{&source[RawPlane::depth], read.data()}});
    EXPECT_EQ(read, values);
  }
  TemporaryFolder folder;
  InputSettings settings;
  std::vector<float> values = std::vector<float>(kColumns * kRows);
};

TEST_F(Layouts, any_line_order_and_compression_is_read) {
  for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y})
    for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                   Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
      Imf::Header header = this->header();
      header.lineOrder() = order;
      header.compression() = compression;
      {
        Imf::OutputFile file(settings.input.c_str(), header);
        file.setFrameBuffer(pixels());
        file.writePixels(kRows);
      }
      expect_pixels();
    }
}

TEST_F(Layouts, tiles_are_read_at_full_resolution) {
  for (const auto mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
    Imf::Header header = this->header();
    header.setTileDescription(Imf::TileDescription(4, 16, mode));
    {
      Imf::TiledOutputFile file(settings.input.c_str(), header);
      file.setFrameBuffer(pixels());
      file.writeTiles(0, file.numXTiles(0) - 1, 0, file.numYTiles(0) - 1, 0);
      std::vector<float> wrong(values.size(), -1);
      Imf::FrameBuffer other;
      other.insert("Z", Imf::Slice::Make(Imf::FLOAT, wrong.data(), header.dataWindow(), sizeof(float),
                                         kColumns * sizeof(float)));
      file.setFrameBuffer(other);
      for (int level = 1; level < file.numLevels(); level++)
        file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    }
    expect_pixels();
  }
}

}  // namespace
}  // namespace alcove
