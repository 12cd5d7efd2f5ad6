// Files and parts: where the planes of a frame are stored, and which storage is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/openexr.h"
#include "tests/support/part_files.h"

namespace alcove::parts_test {
namespace {

using namespace test;

TEST_F(GBuffer, planes_of_several_parts_are_read_each_from_its_own) {
  write(std::vector<Part>{{"rgba", {"B", "G", "R"}}, {"depth", {"Z"}}, {"N", {"X", "Y", "Z"}}});
  FrameSource source = find(true);
  std::vector<float> z(kPixels), n(3 * kPixels), rgb(3 * kPixels);
  read_planes(source, source.reading.data,
              {{&source.channels[RawPlane::depth], z.data()},
               {&source.channels[RawPlane::normal], n.data()},
               {&source.channels[RawPlane::beauty], rgb.data()}});
  EXPECT_THAT(z, Each(value_of(1, 0)));
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
    EXPECT_THAT(names_of(source.channels[RawPlane::depth]), ElementsAre(channels[0]));
    EXPECT_THAT(names_of(source.channels[RawPlane::normal]), ElementsAre("R", "G", "B"));
    EXPECT_THAT(names_of(source.channels[RawPlane::beauty]), ElementsAre("R", "G", "B", "A"));
    std::vector<float> n(3 * kPixels);
    read_planes(source, source.reading.data, {{&source.channels[RawPlane::normal], n.data()}});
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
    read_planes(source, source.reading.data, {{&source.channels[RawPlane::normal], n.data()}});
    for (std::size_t i = 0; i < n.size(); i++)
      EXPECT_TRUE(int(i % kWidth) < width ? n[i] == value_of(1, i / kPixels) : std::isnan(n[i])) << i;
  }
  write(std::vector<Part>{{"depth", {"Z"}}, {"rgba", {"R", "G", "B"}, kWidth + 1}});
  EXPECT_THAT(texts_of(find(true).notes), Contains(HasSubstr("the beauty is 4x2")));
  EXPECT_THAT(find(false).notes, IsEmpty()) << "nobody asked for the beauty";
}

TEST_F(GBuffer, a_subsampled_channel_is_refused) {
  Imf::Header header(4, 2);
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT, 2, 2));
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  write_openexr(settings.input, header);
  expect_error({"frame.exr", "Z", "subsampled"});
}

TEST_F(GBuffer, deep_data_gives_its_first_surface) {
  DeepFilePart deep;
  deep.pixels.assign(6, {{1, 2}});
  write_deep(settings.input, {deep});
  EXPECT_THAT(depth(), ElementsAre("deep1.Z"));
}

}  // namespace
}  // namespace alcove::parts_test
