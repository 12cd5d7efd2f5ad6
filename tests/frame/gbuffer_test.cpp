// Finding the AOVs: renderers' names, parts, layers, files of their own, what is ambiguous and what must not be
// mistaken.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/gbuffer.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/program.h"

namespace alcove {
namespace {

using namespace test;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Names = std::vector<std::string>;

constexpr int kWidth = 3, kHeight = 2, kPixels = kWidth * kHeight;

struct Part {
  std::string name;
  Names channels;
  int width = kWidth;
  std::string view = {};
  Names multi_view = {};
};

/// The channel's value in every pixel, told from all others by its place.
float value_of(std::size_t part, std::size_t channel) { return float(10 * part + channel + 1); }

Imf::Header header_of(const Part& part) {
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
void write_parts(const std::string& path, const std::vector<Part>& parts) {
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
Names names_of(const std::vector<ChannelRef>& channels) {
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

  Names depth() const { return names_of(find()[RawPlane::depth]); }
  Names normal() const { return names_of(find()[RawPlane::normal]); }

  /// The search must fail with ErrorKind::input, in one line that holds these.
  void expect_error(const Names& words, bool with_beauty = false) const {
    try {
      const FrameSource source = find(with_beauty);
      ADD_FAILURE() << "found depth " << testing::PrintToString(names_of(source[RawPlane::depth])) << ", normal "
                    << testing::PrintToString(names_of(source[RawPlane::normal]))
                    << "; expected an error that tells of " << testing::PrintToString(words);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
      EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
      for (const auto& word : words) EXPECT_THAT(error.what(), HasSubstr(word));
    }
  }

  TemporaryFolder folder;
  InputSettings settings;
};

// Names.

TEST_F(GBuffer, depth_is_found_under_renderers_names) {
  for (const Names& channels : {Names{"ViewLayer.Depth.Z"},
                                {"View Layer.Depth.Z"},
                                {"Z"},
                                {"z"},
                                {"depth.Z"},
                                {"depth"},
                                {"Depth.R"},
                                {"DEPTH.Z"},
                                {"zDepth.Z"},
                                {"zdepth.R"},
                                {"VRayZDepth.R"},
                                {"Z.R"},
                                {"Pz"},
                                {"Z-Depth.R"},
                                {"beauty.depth.Z"},
                                {"__depth.r"},
                                {"CGeometry_ZDepth.R"},
                                {"FinalImageMovieRenderQueue_WorldDepth.R"}})
    try {
      write(channels);
      EXPECT_EQ(depth(), channels);
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
}

TEST_F(GBuffer, depth_is_found_among_three_channels_of_a_grey_layer) {
  write(Names{"VRayZDepth.R", "VRayZDepth.G", "VRayZDepth.B", "VRayZDepth.A"});
  EXPECT_THAT(depth(), ElementsAre("VRayZDepth.R"));
}

TEST_F(GBuffer, normals_are_found_under_renderers_names) {
  for (const Names& channels :
       {Names{"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"},
        {"N.X", "N.Y", "N.Z"},
        {"n.x", "n.y", "n.z"},
        {"N.R", "N.G", "N.B"},
        {"Nn.x", "Nn.y", "Nn.z"},
        {"normals.X", "normals.Y", "normals.Z"},
        {"NORMAL.x", "NORMAL.y", "NORMAL.z"},
        {"Ns.X", "Ns.Y", "Ns.Z"},
        {"normal.R", "normal.G", "normal.B"},
        {"NX", "NY", "NZ"},
        {"__Nworld.x", "__Nworld.y", "__Nworld.z"},
        {"CGeometry_NormalsShading.R", "CGeometry_NormalsShading.G", "CGeometry_NormalsShading.B"}}) {
    Names all = channels;
    all.push_back("Z");
    write(all);
    EXPECT_EQ(normal(), channels) << testing::PrintToString(channels);
  }
}

TEST_F(GBuffer, a_frame_as_blender_writes_it) {
  Names all;
  for (const char* layer : {"Combined", "DiffCol", "DiffDir", "DiffInd", "Image", "Denoising Albedo"})
    for (const char* c : {".R", ".G", ".B", ".A"}) all.push_back(std::string("ViewLayer.") + layer + c);
  for (const char* layer : {"Normal", "Position", "Vector", "Denoising Normal"})
    for (const char* c : {".X", ".Y", ".Z"}) all.push_back(std::string("ViewLayer.") + layer + c);
  for (const char* name : {"Depth.Z", "Denoising Depth.Z", "Mist.Z", "IndexOB.X", "UV.U", "UV.V", "UV.A",
                           "CryptoObject00.r", "CryptoObject00.g", "CryptoObject00.b"})
    all.push_back(std::string("ViewLayer.") + name);
  write(all);
  const FrameSource source = find(true);
  EXPECT_THAT(names_of(source[RawPlane::depth]), ElementsAre("ViewLayer.Depth.Z"));
  EXPECT_THAT(names_of(source[RawPlane::normal]),
              ElementsAre("ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"));
  EXPECT_THAT(names_of(source[RawPlane::beauty]), ElementsAre("ViewLayer.Combined.R", "ViewLayer.Combined.G",
                                                              "ViewLayer.Combined.B", "ViewLayer.Combined.A"));
  EXPECT_THAT(names_of(source[RawPlane::indirect]),
              ElementsAre("ViewLayer.DiffInd.R", "ViewLayer.DiffInd.G", "ViewLayer.DiffInd.B"));
  EXPECT_THAT(names_of(source[RawPlane::diffuse_color]),
              ElementsAre("ViewLayer.DiffCol.R", "ViewLayer.DiffCol.G", "ViewLayer.DiffCol.B"));
}

TEST_F(GBuffer, blender_5_calls_the_parts_by_full_words) {
  Names all{"ViewLayer.Depth.Z"};
  for (const char* layer : {"Combined", "Diffuse Color", "Diffuse Direct", "Diffuse Indirect"})
    for (const char* c : {".R", ".G", ".B"}) all.push_back(std::string("ViewLayer.") + layer + c);
  write(all);
  const FrameSource source = find(true);
  EXPECT_THAT(
      names_of(source[RawPlane::indirect]),
      ElementsAre("ViewLayer.Diffuse Indirect.R", "ViewLayer.Diffuse Indirect.G", "ViewLayer.Diffuse Indirect.B"));
  EXPECT_THAT(names_of(source[RawPlane::diffuse_color]),
              ElementsAre("ViewLayer.Diffuse Color.R", "ViewLayer.Diffuse Color.G", "ViewLayer.Diffuse Color.B"));
}

TEST_F(GBuffer, indirect_light_without_the_colour_that_it_needs_is_no_part) {
  write(Names{"Z", "R", "G", "B", "DiffInd.R", "DiffInd.G", "DiffInd.B"});
  EXPECT_THAT(find(true)[RawPlane::indirect], IsEmpty());
}

TEST_F(GBuffer, beauty_is_read_only_when_asked_for) {
  write(Names{"Z", "R", "G", "B", "A"});
  EXPECT_THAT(find(false)[RawPlane::beauty], IsEmpty());
  EXPECT_THAT(names_of(find(true)[RawPlane::beauty]), ElementsAre("R", "G", "B", "A"));
}

// What must not be mistaken.

TEST_F(GBuffer, a_picture_is_neither_depth_nor_normals) {
  for (const Names& channels : {Names{"R", "G", "B", "A"},
                                {"R", "G", "B"},
                                {"Y"},
                                {"beauty.R", "beauty.G", "beauty.B"},
                                {"X", "Y"},
                                {"Vector.X", "Vector.Y", "Vector.Z"}}) {
    write(channels);
    expect_error({"frame.exr", "no depth channel", "--depth-channel", channels[0]});
  }
  write(Names{"Z", "R", "G", "B", "A"});
  EXPECT_THAT(normal(), IsEmpty());
  write(Names{"Z", "P.X", "P.Y", "P.Z", "Vector.X", "Vector.Y", "Vector.Z"});
  EXPECT_THAT(normal(), IsEmpty());
}

TEST_F(GBuffer, positions_stand_in_for_a_depth_that_is_missing) {
  for (const Names& channels :
       {Names{"P.X", "P.Y", "P.Z"}, {"ViewLayer.Position.X", "ViewLayer.Position.Y", "ViewLayer.Position.Z"}}) {
    write(channels);
    EXPECT_EQ(depth(), channels);
    EXPECT_EQ(find().depth_kind, DepthKind::position);
    settings.depth_kind = DepthKind::planar;
    expect_error({"frame.exr", "no depth channel", "--depth-channel", channels[0]});
    settings.depth_kind = DepthKind::automatic;
  }
  write(Names{"Z", "P.X", "P.Y", "P.Z"});
  EXPECT_THAT(depth(), ElementsAre("Z"));
  settings.depth_kind = DepthKind::position;
  EXPECT_THAT(depth(), ElementsAre("P.X", "P.Y", "P.Z"));
}

TEST_F(GBuffer, a_part_a_view_is_chosen_by_its_name) {
  write_parts(settings.input, {{"left", {"Z"}, kWidth, "left"}, {"right", {"Z"}, kWidth, "right"}});
  EXPECT_THAT(depth(), ElementsAre("Z"));
  EXPECT_THAT(find().notes, ElementsAre(AllOf(HasSubstr("left, right"), HasSubstr("--view"))));
  settings.view = "right";
  EXPECT_THAT(depth(), ElementsAre("1:Z"));
  EXPECT_THAT(find().notes, IsEmpty());
  settings.view = "middle";
  expect_error({"frame.exr", "middle", "--view", "left, right"});
}

TEST_F(GBuffer, parts_may_name_their_view_behind_their_layer) {
  write_parts(settings.input, {{"depth.left", {"Z"}, kWidth, "left"},
                               {"N.left", {"X", "Y", "Z"}, kWidth, "left"},
                               {"depth.right", {"Z"}, kWidth, "right"},
                               {"N.right", {"X", "Y", "Z"}, kWidth, "right"}});
  EXPECT_THAT(depth(), ElementsAre("Z"));
  EXPECT_THAT(normal(), ElementsAre("1:X", "1:Y", "1:Z"));
  settings.view = "right";
  EXPECT_THAT(depth(), ElementsAre("2:Z"));
  EXPECT_THAT(normal(), ElementsAre("3:X", "3:Y", "3:Z"));
}

TEST_F(GBuffer, channels_that_name_their_view_are_chosen_by_it) {
  Part stereo{"", {"Z", "N.X", "N.Y", "N.Z", "right.Z", "N.right.X", "N.right.Y", "N.right.Z"}};
  stereo.multi_view = {"left", "right"};
  write(std::vector<Part>{stereo});
  EXPECT_THAT(depth(), ElementsAre("Z"));
  EXPECT_THAT(normal(), ElementsAre("N.X", "N.Y", "N.Z"));
  settings.view = "Right";
  EXPECT_THAT(depth(), ElementsAre("right.Z"));
  EXPECT_THAT(normal(), ElementsAre("N.right.X", "N.right.Y", "N.right.Z"));
}

TEST_F(GBuffer, layers_whose_names_only_contain_the_word_are_others) {
  for (const char* name :
       {"ViewLayer.Denoising Depth.Z", "DepthOfField.Z", "Mist.Z", "notdepth.Z", "depth_mask.R", "volume_Z"}) {
    write(Names{name});
    expect_error({"no depth channel", name});
  }
  for (const char* layer : {"ViewLayer.Denoising Normal", "AbNormal", "NormalMap", "UN"}) {
    write(Names{"Z", std::string(layer) + ".X", std::string(layer) + ".Y", std::string(layer) + ".Z"});
    EXPECT_THAT(normal(), IsEmpty()) << layer;
  }
}

TEST_F(GBuffer, half_a_normal_is_none) {
  write(Names{"Z", "N.X", "N.Y"});
  EXPECT_THAT(normal(), IsEmpty());
  write(Names{"Z", "N.X", "N.Y", "Normal.Z"});
  EXPECT_THAT(normal(), IsEmpty()) << "components of two layers are no normal";
}

TEST_F(GBuffer, half_a_normal_is_a_whole_one_in_encodings_of_two_coordinates) {
  for (const Names& names : {Names{"Z", "N.X", "N.Y"}, {"Z", "normal.R", "normal.G"}}) {
    write(names);
    for (const auto encoding : {NormalEncoding::octahedral, NormalEncoding::spheremap}) {
      settings.normal_encoding = encoding;
      EXPECT_THAT(normal(), ElementsAre(names[1], names[2]));
    }
    settings.normal_encoding = NormalEncoding::automatic;
    EXPECT_THAT(normal(), IsEmpty());
  }
}

TEST_F(GBuffer, two_places_are_ambiguous_and_layer_decides) {
  write(Names{"Left.Depth.Z", "Left.Normal.X", "Left.Normal.Y", "Left.Normal.Z", "Right.Depth.Z", "Right.Normal.X",
              "Right.Normal.Y", "Right.Normal.Z"});
  expect_error({"Left.Depth.Z", "Right.Depth.Z", "--layer", "--depth-channel"});
  settings.depth_channel = "Left.Depth.Z";
  expect_error({"Left.Normal.X", "Right.Normal.X", "--layer", "--normal-channels"});
  settings.depth_channel = "";
  for (const char* layer : {"Right", "right"}) {
    settings.layer = layer;
    EXPECT_THAT(depth(), ElementsAre("Right.Depth.Z"));
    EXPECT_THAT(normal(), ElementsAre("Right.Normal.X", "Right.Normal.Y", "Right.Normal.Z"));
  }
  settings.layer = "Middle";
  expect_error({"frame.exr", "Middle", "--layer", "Left"});
}

TEST_F(GBuffer, a_layer_is_a_whole_name) {
  write(
      Names{"View.Depth.Z", "ViewLayer.Depth.Z", "View.Inner.Normal.X", "View.Inner.Normal.Y", "View.Inner.Normal.Z"});
  settings.layer = "View";
  EXPECT_THAT(depth(), ElementsAre("View.Depth.Z"));
  EXPECT_THAT(normal(), ElementsAre("View.Inner.Normal.X", "View.Inner.Normal.Y", "View.Inner.Normal.Z"));
}

// Channels that the user names.

TEST_F(GBuffer, chosen_channels_win) {
  write(Names{"Z", "other.depth_filtered", "N.X", "N.Y", "N.Z", "bump.a", "bump.b", "bump.c", "smooth.X", "smooth.Y",
              "smooth.Z"});
  settings.depth_channel = "other.depth_filtered";
  for (const char* chosen : {"bump.c,bump.b,bump.a", "bump.c, bump.b, bump.a", "BUMP.C,BUMP.B,BUMP.A"}) {
    settings.normal_channels = chosen;
    EXPECT_THAT(depth(), ElementsAre("other.depth_filtered"));
    EXPECT_THAT(normal(), ElementsAre("bump.c", "bump.b", "bump.a")) << chosen;
  }
  settings.normal_channels = "smooth";
  EXPECT_THAT(normal(), ElementsAre("smooth.X", "smooth.Y", "smooth.Z"));
}

TEST_F(GBuffer, a_chosen_name_may_hold_spaces) {
  write(Names{"View Layer.Denoising Depth.Z", "View Layer.Denoising Normal.X", "View Layer.Denoising Normal.Y",
              "View Layer.Denoising Normal.Z"});
  settings.depth_channel = "View Layer.Denoising Depth.Z";
  EXPECT_THAT(depth(), ElementsAre("View Layer.Denoising Depth.Z"));
  settings.normal_channels = "View Layer.Denoising Normal";
  EXPECT_THAT(normal(), ElementsAre("View Layer.Denoising Normal.X", "View Layer.Denoising Normal.Y",
                                    "View Layer.Denoising Normal.Z"));
  settings.normal_channels =
      "View Layer.Denoising Normal.X,View Layer.Denoising Normal.Y,View Layer.Denoising Normal.Z";
  EXPECT_THAT(normal(), ElementsAre("View Layer.Denoising Normal.X", "View Layer.Denoising Normal.Y",
                                    "View Layer.Denoising Normal.Z"));
}

TEST_F(GBuffer, chosen_channels_that_are_not_there_are_errors) {
  write(Names{"Z", "N.X", "N.Y", "N.Z"});
  settings.depth_channel = "ZZ";
  expect_error({"frame.exr", "ZZ", "--depth-channel", "N.X"});
  settings.depth_channel = "";
  for (const char* chosen : {"N.X,N.Q", "N.X,N.Y,N.Q", "M", "N.X,N.Y,N.Z,Z", "N.X,,N.Z"}) {
    settings.normal_channels = chosen;
    expect_error({"frame.exr", "--normal-channels", "N.X"});
  }
}

TEST_F(GBuffer, a_beauty_is_three_channels_or_four) {
  write(Names{"Z", "fill.R", "fill.G", "fill.B", "fill.A", "key.R", "key.G", "key.B"});
  settings.beauty_channels = "fill";
  EXPECT_THAT(names_of(find(true)[RawPlane::beauty]), ElementsAre("fill.R", "fill.G", "fill.B", "fill.A"));
  settings.beauty_channels = "key";
  EXPECT_THAT(names_of(find(true)[RawPlane::beauty]), ElementsAre("key.R", "key.G", "key.B"));
  settings.beauty_channels = "key.R,key.G,key.B,fill.A";
  EXPECT_THAT(names_of(find(true)[RawPlane::beauty]), ElementsAre("key.R", "key.G", "key.B", "fill.A"));
}

TEST_F(GBuffer, alpha_is_found_in_the_spelling_of_the_colours) {
  for (const Names& channels :
       {Names{"R", "G", "B", "A"}, {"r", "g", "b", "a"}, {"RGBA.red", "RGBA.green", "RGBA.blue", "RGBA.alpha"}}) {
    Names all = channels;
    all.push_back("Z");
    write(all);
    EXPECT_EQ(names_of(find(true)[RawPlane::beauty]), channels);
  }
}

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

TEST_F(GBuffer, planes_must_cover_the_same_pixels) {
  write(std::vector<Part>{{"depth", {"Z"}}, {"N", {"X", "Y", "Z"}, kWidth + 1}});
  expect_error({"frame.exr", "3x2", "4x2", "--normal"});
  write(std::vector<Part>{{"depth", {"Z"}}, {"rgba", {"R", "G", "B"}, kWidth + 1}});
  expect_error({"frame.exr", "3x2", "4x2", "--beauty"}, true);
  EXPECT_NO_THROW(find(false)) << "nobody asked for the beauty";
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

TEST_F(GBuffer, deep_data_is_refused) {
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
  expect_error({"frame.exr", "deep"});
}

// What the settings and the camera say together.

TEST_F(GBuffer, options_win_over_the_camera_file_and_that_over_the_defaults) {
  write(Names{"Z", "N.X", "N.Y", "N.Z"});
  const auto camera = [&](const std::string& more) {
    settings.camera = folder / "camera.json";
    write_bytes(
        settings.camera,
        R"({"resolution": [3, 2], "fx": 3, "fy": 3, "cx": 1, "cy": 1, "world_to_camera": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]])" +
            more + "}");
  };
  camera(R"(, "depth": "ray", "normal_space": "view")");
  settings.normal_space = NormalSpace::automatic;
  EXPECT_EQ(find().depth_kind, DepthKind::ray);
  EXPECT_EQ(find().normal_space, NormalSpace::view);
  settings.depth_kind = DepthKind::inverse;
  settings.normal_space = NormalSpace::world;
  EXPECT_EQ(find().depth_kind, DepthKind::inverse);
  EXPECT_EQ(find().normal_space, NormalSpace::world);
  camera("");
  settings.depth_kind = DepthKind::automatic;
  settings.normal_space = NormalSpace::automatic;
  EXPECT_EQ(find().depth_kind, DepthKind::planar);
  EXPECT_EQ(find().normal_space, NormalSpace::world);
}

}  // namespace
}  // namespace alcove
