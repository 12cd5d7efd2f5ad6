// Files and parts: where the planes of a frame are stored, and which storage is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfOutputFile.h>

#include "tests/support/part_files.h"

namespace alcove {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

// Files and parts.

TEST_F(GBuffer, part_names_are_layers) {
  write(std::vector<Part>{
      {"rgba", {"A", "B", "G", "R"}}, {"depth", {"Z"}}, {"N", {"X", "Y", "Z"}}, {"albedo", {"B", "G", "R"}}});
  const FrameSource source = find(true);
  EXPECT_THAT(names_of(source[RawPlane::depth]), ElementsAre("1:Z"));
  EXPECT_THAT(names_of(source[RawPlane::normal]), ElementsAre("2:X", "2:Y", "2:Z"));
  EXPECT_THAT(names_of(source[RawPlane::beauty]), ElementsAre("R", "G", "B", "A"));
}

TEST_F(GBuffer, parts_may_repeat_their_name_in_the_channels) {
  write(std::vector<Part>{
      {"ViewLayer.Combined", {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"}},
      {"ViewLayer.Depth", {"ViewLayer.Depth.Z"}},
      {"ViewLayer.Normal", {"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"}}});
  EXPECT_THAT(depth(), ElementsAre("1:ViewLayer.Depth.Z"));
  EXPECT_THAT(normal(), ElementsAre("2:ViewLayer.Normal.X", "2:ViewLayer.Normal.Y", "2:ViewLayer.Normal.Z"));
  EXPECT_THAT(names_of(find(true)[RawPlane::beauty]),
              ElementsAre("ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"));
  settings.layer = "ViewLayer";
  EXPECT_THAT(depth(), ElementsAre("1:ViewLayer.Depth.Z"));
}

TEST_F(GBuffer, the_name_of_the_only_part_is_no_layer) {
  for (const char* name : {"rgba", "rgba.main", "Layer"}) {
    write(std::vector<Part>{{name, {"R", "G", "B", "Z", "N.X", "N.Y", "N.Z"}}});
    EXPECT_THAT(names_of(find(true)[RawPlane::depth]), ElementsAre("Z")) << name;
    EXPECT_THAT(normal(), ElementsAre("N.X", "N.Y", "N.Z")) << name;
  }
}

TEST_F(GBuffer, a_part_with_any_name_may_hold_everything) {
  write(std::vector<Part>{{"main", {"R", "G", "B", "Z", "N.X", "N.Y", "N.Z"}}, {"extra", {"R", "G", "B"}}});
  EXPECT_THAT(depth(), ElementsAre("Z"));
  EXPECT_THAT(normal(), ElementsAre("N.X", "N.Y", "N.Z"));
}

TEST_F(GBuffer, planes_of_several_parts_are_read_each_from_its_own) {
  write(std::vector<Part>{{"rgba", {"B", "G", "R"}}, {"depth", {"Z"}}, {"N", {"X", "Y", "Z"}}});
  FrameSource source = find(true);
  std::vector<float> z(kPixels), n(3 * kPixels), rgb(3 * kPixels);
  read_planes(source, {{&source[RawPlane::depth], z.data()},
                       {&source[RawPlane::normal], n.data()},
                       {&source[RawPlane::beauty], rgb.data()}});
  EXPECT_THAT(z, testing::Each(value_of(1, 0)));
  for (std::size_t i = 0; i < n.size(); i++) {
    EXPECT_EQ(n[i], value_of(2, i / kPixels)) << i;
    EXPECT_EQ(rgb[i], value_of(0, 2 - i / kPixels)) << i << ": R is the file's third channel";
  }
}

TEST_F(GBuffer, every_aov_may_have_a_file_of_its_own) {
  settings.depth = folder / "d.exr";
  settings.normal = folder / "n.exr";
  settings.beauty = folder / "b.exr";
  settings.input = "";
  for (const Names& channels : {Names{"R", "G", "B"}, {"Y"}, {"Z"}, {"ViewLayer.Depth.Z"}}) {
    write_parts(settings.depth, {{"", channels}});
    write_parts(settings.normal, {{"", {"R", "G", "B"}}});
    write_parts(settings.beauty, {{"", {"R", "G", "B", "A"}}});
    FrameSource source = find(true);
    EXPECT_THAT(names_of(source[RawPlane::depth]), ElementsAre(channels[0]));
    EXPECT_THAT(names_of(source[RawPlane::normal]), ElementsAre("R", "G", "B"));
    EXPECT_THAT(names_of(source[RawPlane::beauty]), ElementsAre("R", "G", "B", "A"));
    std::vector<float> n(3 * kPixels);
    read_planes(source, {{&source[RawPlane::normal], n.data()}});
    EXPECT_EQ(n, (std::vector<float>{1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3}));
  }
  write_parts(settings.normal, {{"", {"X", "Y", "Z"}}});
  EXPECT_THAT(normal(), ElementsAre("X", "Y", "Z"));
  write_parts(settings.normal, {{"", {"R", "G"}}});
  EXPECT_THAT(normal(), ElementsAre("R", "G"));
  write_parts(settings.normal, {{"", {"R"}}});
  expect_error({"n.exr", "no normal channel", "--normal-channels"});
}

TEST_F(GBuffer, depth_alone_is_enough) {
  settings.depth = settings.input;
  settings.input = "";
  write_parts(settings.depth, {{"", {"R", "G", "B"}}});
  EXPECT_THAT(depth(), ElementsAre("R"));
  EXPECT_THAT(normal(), IsEmpty()) << "the R, G, B of a depth file are no normal";
}

TEST_F(GBuffer, normals_and_a_beauty_need_not_cover_the_same_pixels) {
  for (const int width : {kWidth - 1, kWidth + 1}) {
    write(std::vector<Part>{{"depth", {"Z"}}, {"N", {"X", "Y", "Z"}, width}});
    FrameSource source = find();
    EXPECT_THAT(source.notes, IsEmpty()) << "only surfaces without normals are worth a note";
    std::vector<float> n(3 * kPixels);
    read_planes(source, {{&source[RawPlane::normal], n.data()}});
    for (std::size_t i = 0; i < n.size(); i++)
      EXPECT_TRUE(int(i % kWidth) < width ? n[i] == value_of(1, i / kPixels) : std::isnan(n[i])) << i;
  }
  write(std::vector<Part>{{"depth", {"Z"}}, {"rgba", {"R", "G", "B"}, kWidth + 1}});
  EXPECT_THAT(texts_of(find(true).notes), testing::Contains(testing::HasSubstr("the beauty is 4x2")));
  EXPECT_THAT(find(false).notes, IsEmpty()) << "nobody asked for the beauty";
}

// Storage.

TEST_F(GBuffer, a_subsampled_channel_is_refused) {
  Imf::Header header(4, 2);
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT, 2, 2));
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  {
    Imf::OutputFile file(settings.input.c_str(), header);
    file.setFrameBuffer(Imf::FrameBuffer());
    file.writePixels(2);
  }
  expect_error({"frame.exr", "Z", "subsampled"});
}

TEST_F(GBuffer, deep_data_gives_its_first_surface) {
  Imf::Header header(2, 1);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  {
    Imf::DeepScanLineOutputFile file(settings.input.c_str(), header);
    unsigned int counts[] = {0, 0};
    float* samples[] = {nullptr, nullptr};
    Imf::DeepFrameBuffer pixels;
    pixels.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts), sizeof(unsigned int), 0));
    pixels.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples), sizeof(float*), 0, sizeof(float)));
    file.setFrameBuffer(pixels);
    file.writePixels(1);
  }
  const FrameSource source = find_frame(settings, false, 0);
  ASSERT_EQ(source[RawPlane::depth].size(), 1);
  EXPECT_EQ(source[RawPlane::depth][0].channel, "deep1.Z");
}

}  // namespace
}  // namespace alcove
