// Finding the AOVs: renderers' names, layers and views, what is ambiguous and what must not be mistaken.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/frame_source.h"

#include "tests/support/part_files.h"

namespace alcove::frame_source_test {
namespace {

using namespace test;

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
    write(channels + Names{"Z"});
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
    write(channels + Names{"Z"});
    settings.normal_channels = "Odd";
    EXPECT_EQ(names_of(find().channels[RawPlane::normal]), channels);
  }
}

TEST_F(GBuffer, a_file_of_the_depth_alone_may_call_its_one_channel_anything) {
  for (const char* name : {"distance", "camera.dist.V", "A"}) {
    write(Names{name});
    expect_error({"no depth channel", "--depth-channel"});
    std::swap(settings.depth, settings.input);
    EXPECT_THAT(names_of(find().channels[RawPlane::depth]), ElementsAre(name));
    std::swap(settings.depth, settings.input);
  }
  write(Names{"distance", "other"});
  std::swap(settings.depth, settings.input);
  expect_error({"no depth channel", "--depth-channel", "distance"});
}

TEST_F(GBuffer, a_frame_as_blender_writes_it) {
  const auto in = [](const std::string& layer, const Names& components) {
    Names names;
    for (const auto& component : components) names.push_back("ViewLayer." + layer + "." + component);
    return names;
  };
  const Names rgb{"R", "G", "B"}, rgba{"R", "G", "B", "A"};
  for (const auto& [indirect, colour] : {std::pair("DiffInd", "DiffCol"), {"Diffuse Indirect", "Diffuse Color"}}) {
    Names all = in("Depth", {"Z"}) + in("Denoising Depth", {"Z"}) + in("Mist", {"Z"}) + in("IndexOB", {"X"}) +
                in("UV", {"U", "V", "A"}) + in("CryptoObject00", {"r", "g", "b"});
    for (const char* layer : {"Combined", indirect, colour, "DiffDir", "Diffuse Direct", "Image", "Denoising Albedo"})
      all = all + in(layer, rgba);
    for (const char* layer : {"Normal", "Position", "Vector", "Denoising Normal"})
      all = all + xyz(std::string("ViewLayer.") + layer);
    write(all);
    const FrameSource source = find(true);
    EXPECT_EQ(names_of(source.channels[RawPlane::depth]), in("Depth", {"Z"}));
    EXPECT_EQ(names_of(source.channels[RawPlane::normal]), xyz("ViewLayer.Normal"));
    EXPECT_EQ(names_of(source.channels[RawPlane::beauty]), in("Combined", rgba));
    EXPECT_EQ(names_of(source.channels[RawPlane::indirect]), in(indirect, rgb));
    EXPECT_EQ(names_of(source.channels[RawPlane::diffuse_color]), in(colour, rgb));
  }
}

TEST_F(GBuffer, indirect_light_without_the_colour_that_it_needs_is_no_part) {
  write(Names{"Z", "R", "G", "B", "DiffInd.R", "DiffInd.G", "DiffInd.B"});
  EXPECT_THAT(find(true).channels[RawPlane::indirect], IsEmpty());
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
}

TEST_F(GBuffer, positions_stand_in_for_a_depth_that_is_missing) {
  for (const Names& channels :
       {Names{"P.X", "P.Y", "P.Z"}, {"ViewLayer.Position.X", "ViewLayer.Position.Y", "ViewLayer.Position.Z"}}) {
    write(channels);
    EXPECT_EQ(depth(), channels);
    EXPECT_EQ(find().reading.depth_kind, DepthKind::position);
    settings.depth_kind = DepthKind::planar;
    expect_error({"frame.exr", "no depth channel", "--depth-channel", channels[0]});
    settings.depth_kind = DepthKind::automatic;
  }
  write(Names{"Z", "P.X", "P.Y", "P.Z"});
  EXPECT_THAT(depth(), ElementsAre("Z"));
  settings.depth_kind = DepthKind::position;
  EXPECT_THAT(depth(), ElementsAre("P.X", "P.Y", "P.Z"));
}

TEST_F(GBuffer, layers_whose_names_only_contain_the_word_are_others) {
  for (const char* name :
       {"ViewLayer.Denoising Depth.Z", "DepthOfField.Z", "Mist.Z", "notdepth.Z", "depth_mask.R", "volume_Z"}) {
    write(Names{name});
    expect_error({"no depth channel", name});
  }
  for (const char* layer : {"ViewLayer.Denoising Normal", "AbNormal", "NormalMap", "UN"}) {
    write(Names{"Z"} + xyz(layer));
    EXPECT_THAT(normal(), IsEmpty()) << layer;
  }
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

// Where each is found.

struct Chosen {
  std::string view = "", layer = "", depth = "", normal = "", beauty = "";
};
/// What is found by these options, or what the error says.
struct Answer {
  Chosen by;
  Names depth, normal, beauty, error;
};
Answer found(const Chosen& by, const Names& depth, const Names& normal = {}, const Names& beauty = {}) {
  return {by, depth, normal, beauty, {}};
}
Answer told(const Chosen& by, const Names& error) { return {by, {}, {}, {}, error}; }

struct Case {
  const char* file;
  std::vector<Part> parts;
  std::vector<Answer> answers;
};

std::vector<Part> one(const Names& channels, const Names& views = {}) { return {{"", channels, kWidth, "", views}}; }

std::vector<Case> cases() {
  const Names z{"Z"}, n = xyz("N"), rgba{"R", "G", "B", "A"}, rgb{"R", "G", "B"},
                      words{"RGBA.red", "RGBA.green", "RGBA.blue", "RGBA.alpha"}, nuke{"depth.Z"},
                      nuke_right{"right.depth.Z"}, n_right = xyz("right.N"), rgb_right{"right.R", "right.G", "right.B"},
                      of_nuke = rgb + nuke + n + rgb_right + nuke_right + n_right, filtered{"other.depth_filtered"},
                      bump{"bump.c", "bump.b", "bump.a"}, blank_z{"View Layer.Denoising Depth.Z"},
                      blank_n = xyz("View Layer.Denoising Normal"), fill{"fill.R", "fill.G", "fill.B", "fill.A"},
                      key{"key.R", "key.G", "key.B"}, part_z{"1:ViewLayer.Depth.Z"},
                      part_n{"2:ViewLayer.Normal.X", "2:ViewLayer.Normal.Y", "2:ViewLayer.Normal.Z"},
                      part_rgb{"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"},
                      no_normal{"frame.exr", "--normal-channels", "N.X"};
  const std::string z_right = "right.depth.Z";
  return {
      {"a grey layer",
       one({"VRayZDepth.R", "VRayZDepth.G", "VRayZDepth.B", "VRayZDepth.A"}),
       {found({}, {"VRayZDepth.R"})}},
      {"colours, which are read where they are asked for", one(z + rgba), {found({}, z, {}, rgba), found({}, z)}},
      {"colours in small letters", one({"Z", "r", "g", "b", "a"}), {found({}, z, {}, {"r", "g", "b", "a"})}},
      {"colours in words", one(z + words), {found({}, z, {}, words)}},
      {"positions and motion", one(z + xyz("P") + xyz("Vector")), {found({}, z)}},
      {"two components of a normal", one({"Z", "N.X", "N.Y"}), {found({}, z)}},
      {"components of two layers", one({"Z", "N.X", "N.Y", "Normal.Z"}), {found({}, z)}},
      {"two places",
       one(Names{"Left.Depth.Z", "Right.Depth.Z"} + xyz("Left.Normal") + xyz("Right.Normal")),
       {told({}, {"Left.Depth.Z", "Right.Depth.Z", "--layer", "--depth-channel"}),
        told({.depth = "Left.Depth.Z"}, {"Left.Normal.X", "Right.Normal.X", "--layer", "--normal-channels"}),
        found({.layer = "Right"}, {"Right.Depth.Z"}, xyz("Right.Normal")),
        found({.layer = "right"}, {"Right.Depth.Z"}, xyz("Right.Normal")),
        told({.layer = "Middle"}, {"frame.exr", "Middle", "--layer", "Left"})}},
      {"layers that begin alike",
       one(Names{"View.Depth.Z", "ViewLayer.Depth.Z"} + xyz("View.Inner.Normal")),
       {found({.layer = "View"}, {"View.Depth.Z"}, xyz("View.Inner.Normal"))}},
      {"a layer that is one channel",
       one(Names{"ViewLayer.Depth.V", "zDepth.Y", "Dist", "Main.Z.Far"} + rgb),
       {found({.layer = "ViewLayer.Depth"}, {"ViewLayer.Depth.V"}), found({.layer = "zdepth"}, {"zDepth.Y"}),
        found({.layer = "Dist"}, {"Dist"}), found({.layer = "Main.Z.Far"}, {"Main.Z.Far"}),
        found({.layer = "Main"}, {"Main.Z.Far"})}},
      {"more than is needed",
       one(z + n + xyz("smooth") + filtered + bump),
       {found({.depth = "other.depth_filtered", .normal = "bump.c,bump.b,bump.a"}, filtered, bump),
        found({.depth = "other.depth_filtered", .normal = "bump.c, bump.b, bump.a"}, filtered, bump),
        found({.depth = "other.depth_filtered", .normal = "BUMP.C,BUMP.B,BUMP.A"}, filtered, bump),
        found({.normal = "smooth"}, z, xyz("smooth"))}},
      {"blanks",
       one(blank_z + blank_n),
       {found({.depth = blank_z[0], .normal = "View Layer.Denoising Normal"}, blank_z, blank_n),
        found({.depth = blank_z[0], .normal = fmt::format("{}", fmt::join(blank_n, ","))}, blank_z, blank_n)}},
      {"what is chosen is not there",
       one(z + n),
       {told({.depth = "ZZ"}, {"frame.exr", "ZZ", "--depth-channel", "N.X"}), told({.normal = "N.X,N.Q"}, no_normal),
        told({.normal = "N.X,N.Y,N.Q"}, no_normal), told({.normal = "M"}, no_normal),
        told({.normal = "N.X,N.Y,N.Z,Z"}, no_normal), told({.normal = "N.X,,N.Z"}, no_normal)}},
      {"lights",
       one(z + fill + key),
       {found({.beauty = "fill"}, z, {}, fill), found({.beauty = "key"}, z, {}, key),
        found({.beauty = "key.R,key.G,key.B,fill.A"}, z, {}, key + Names{"fill.A"})}},
      {"parts as layers",
       {{"rgba", {"A", "B", "G", "R"}}, {"depth", z}, {"N", {"X", "Y", "Z"}}, {"albedo", {"B", "G", "R"}}},
       {found({}, {"1:Z"}, {"2:X", "2:Y", "2:Z"}, rgba)}},
      {"parts that repeat their name",
       {{"ViewLayer.Combined", part_rgb},
        {"ViewLayer.Depth", {"ViewLayer.Depth.Z"}},
        {"ViewLayer.Normal", xyz("ViewLayer.Normal")}},
       {found({}, part_z, part_n, part_rgb), found({.layer = "ViewLayer"}, part_z, part_n, part_rgb)}},
      {"the only part's name is no layer", {{"rgba", rgb + z + n}}, {found({}, z, n, rgb)}},
      {"nor is one of two words", {{"rgba.main", rgb + z + n}}, {found({}, z, n, rgb)}},
      {"nor is Layer", {{"Layer", rgb + z + n}}, {found({}, z, n, rgb)}},
      {"a part with any name holds all", {{"main", rgb + z + n}, {"extra", rgb}}, {found({}, z, n)}},
      // Views.
      {"a part a view",
       {{"left", z, kWidth, "left"}, {"right", z, kWidth, "right"}},
       {found({}, z), found({.view = "right"}, {"1:Z"}),
        told({.view = "middle"}, {"frame.exr", "middle", "--view", "left, right"})}},
      {"parts whose names end in the view",
       {{"depth.left", z, kWidth, "left"},
        {"N.left", {"X", "Y", "Z"}, kWidth, "left"},
        {"depth.right", z, kWidth, "right"},
        {"N.right", {"X", "Y", "Z"}, kWidth, "right"}},
       {found({}, z, {"1:X", "1:Y", "1:Z"}), found({.view = "right"}, {"2:Z"}, {"3:X", "3:Y", "3:Z"})}},
      {"and channels that begin with it",
       {{"depth.left", z, kWidth, "left"}, {"depth.right", {"right.Z"}, kWidth, "right"}},
       {found({.view = "right"}, {"1:right.Z"}), found({.view = "right", .layer = "depth"}, {"1:right.Z"}),
        found({.view = "right", .layer = "depth.right"}, {"1:right.Z"})}},
      {"parts whose names begin with the view",
       {{"left.depth", z, kWidth, "left"}, {"right.depth", {"right.Z"}, kWidth, "right"}},
       {found({.view = "right"}, {"1:right.Z"}), found({.view = "right", .layer = "depth"}, {"1:right.Z"}),
        found({.view = "right", .layer = "right.depth"}, {"1:right.Z"})}},
      {"channels with the view in their layer",
       one(z + n + Names{"right.Z"} + xyz("N.right"), {"left", "right"}),
       {found({}, z, n), found({.view = "Right"}, {"right.Z"}, xyz("N.right"))}},
      {"a view without depth",
       one({"depth.Z", "right.R"}, {"left", "right"}),
       {told({.view = "right"}, {"no depth", "of the view right", "there is right.R"})}},
      {"no views without the attribute",
       one(nuke + nuke_right),
       {told({}, {"two layers hold a depth", z_right, "--layer"}), found({.layer = "depth"}, nuke),
        found({.layer = "right.depth"}, nuke_right)}},
      {"channels whose first word is their view, as of Nuke",
       one(of_nuke, {"left", "right"}),
       {found({}, nuke, n, rgb), found({.view = "left"}, nuke, n, rgb), found({.view = "LEFT"}, nuke, n, rgb),
        found({.view = "Right"}, nuke_right, n_right, rgb_right),
        found({.depth = z_right}, nuke_right, n_right, rgb_right),
        found({.view = "Right", .depth = z_right, .normal = "right.N"}, nuke_right, n_right, rgb_right),
        told({.view = "left", .depth = z_right},
             {"no channel right.depth.Z", "of the view left", "did you mean depth.Z", "--depth-channel"})}},
      {"views in other letters",
       one(of_nuke, {"Left", "RIGHT"}),
       {found({.view = "Right"}, nuke_right, n_right, rgb_right)}},
  };
}

TEST_F(GBuffer, depth_normals_and_beauty_are_found_or_it_is_said_which_there_are) {
  for (const Case& c : cases()) {
    write(c.parts);
    for (const auto& [by, depth, normal, beauty, error] : c.answers) {
      SCOPED_TRACE(fmt::format("{}: {} {} {} {} {}", c.file, by.view, by.layer, by.depth, by.normal, by.beauty));
      settings.view = by.view;
      settings.layer = by.layer;
      settings.depth_channel = by.depth;
      settings.normal_channels = by.normal;
      settings.beauty_channels = by.beauty;
      if (!error.empty()) {
        expect_error(error);
        continue;
      }
      const FrameSource source = find(!beauty.empty());
      EXPECT_EQ(names_of(source.channels[RawPlane::depth]), depth);
      EXPECT_EQ(names_of(source.channels[RawPlane::normal]), normal);
      EXPECT_EQ(names_of(source.channels[RawPlane::beauty]), beauty);
    }
  }
}

TEST_F(GBuffer, a_layer_of_one_view_or_of_all_is_taken_of_the_view_that_is_said) {
  write(one({"depth.Z", "N.X", "right.depth.Z", "right.N.X"}, {"left", "right"}));
  for (const auto& [view, layer, found] : {std::tuple("Right", "depth", "right.depth.Z"),
                                           {"Right", "right.depth", "right.depth.Z"},
                                           {"", "right.depth", "right.depth.Z"},
                                           {"", "depth", "depth.Z"}}) {
    settings.view = view;
    settings.layer = layer;
    EXPECT_THAT(depth(), ElementsAre(found)) << view << " " << layer;
  }
  settings.view = settings.layer = "";
  settings.depth_channel = "right.depth.Z";
  EXPECT_EQ(find().channels.view, "right");
  EXPECT_THAT(texts_of(find().notes), ElementsAre(HasSubstr("this is right")));
  settings.depth_channel = "";
  write({{"left", {"Z"}, kWidth, "left"}, {"right", {"Z"}, kWidth, "right"}});
  EXPECT_THAT(texts_of(find().notes), ElementsAre(AllOf(HasSubstr("left, right"), HasSubstr("--view"))));
  settings.view = "right";
  EXPECT_THAT(texts_of(find().notes), IsEmpty());
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
  EXPECT_EQ(find().reading.depth_kind, DepthKind::ray);
  EXPECT_EQ(find().reading.normal_space, NormalSpace::view);
  settings.depth_kind = DepthKind::inverse;
  settings.normal_space = NormalSpace::world;
  EXPECT_EQ(find().reading.depth_kind, DepthKind::inverse);
  EXPECT_EQ(find().reading.normal_space, NormalSpace::world);
  camera("");
  settings.depth_kind = DepthKind::automatic;
  settings.normal_space = NormalSpace::automatic;
  EXPECT_EQ(find().reading.depth_kind, DepthKind::planar);
  EXPECT_EQ(find().reading.normal_space, NormalSpace::world);
}

}  // namespace
}  // namespace alcove::frame_source_test
