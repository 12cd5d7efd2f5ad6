// Finding the AOVs: renderers' names, layers and views, what is ambiguous and what must not be mistaken.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/gbuffer.h"

#include "tests/support/part_files.h"

namespace alcove {
namespace {

using namespace test;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

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
        {"N.red", "N.green", "N.blue"},
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

TEST_F(GBuffer, a_layer_of_normals_may_be_chosen_whatever_its_components_are_called) {
  for (const Names& channels : {Names{"Odd.X", "Odd.Y", "Odd.Z"},
                                {"Odd.x", "Odd.y", "Odd.z"},
                                {"Odd.R", "Odd.G", "Odd.B"},
                                {"Odd.red", "Odd.green", "Odd.blue"},
                                {"Odd.nx", "Odd.ny", "Odd.nz"},
                                {"Odd.r", "Odd.g"}}) {
    Names all = channels;
    all.emplace_back("Z");
    write(all);
    settings.normal_channels = "Odd";
    EXPECT_EQ(names_of(find()[RawPlane::normal]), channels);
  }
}

TEST_F(GBuffer, a_file_of_the_depth_alone_may_call_its_one_channel_anything) {
  for (const char* name : {"distance", "camera.dist.V", "A"}) {
    write(Names{name});
    expect_error({"no depth channel", "--depth-channel"});
    std::swap(settings.depth, settings.input);
    EXPECT_THAT(names_of(find()[RawPlane::depth]), ElementsAre(name));
    std::swap(settings.depth, settings.input);
  }
  write(Names{"distance", "other"});
  std::swap(settings.depth, settings.input);
  expect_error({"no depth channel", "--depth-channel", "distance"});
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
  EXPECT_THAT(texts_of(find().notes), ElementsAre(AllOf(HasSubstr("left, right"), HasSubstr("--view"))));
  settings.view = "right";
  EXPECT_THAT(depth(), ElementsAre("1:Z"));
  EXPECT_THAT(texts_of(find().notes), IsEmpty());
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
