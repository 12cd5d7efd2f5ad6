// Channels as programs and people name them: views, messages that propose names, values, and colours taken for depth.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "core/frame/find/matte.h"
#include "core/inspect/inspect.h"
#include "tests/support/part_files.h"
#include "tests/support/wall_frame.h"

namespace alcove::addressing_test {
namespace {

using namespace test;

using Views = GBuffer;

TEST_F(Views, of_a_second_file_are_those_of_the_first_one) {
  settings.depth = folder / "d.exr";
  Part stereo{"", {"Z", "right.Z"}};
  stereo.multi_view = {"left", "right"};
  write_parts(settings.depth, {stereo});
  Part other{"", {"N.X", "N.Y", "N.Z", "left.N.X", "left.N.Y", "left.N.Z"}};
  other.multi_view = {"right", "left"};
  write(std::vector<Part>{other});
  EXPECT_THAT(normal(), ElementsAre("left.N.X", "left.N.Y", "left.N.Z"));
}

TEST_F(Views, hidden_surfaces_are_proposed_of_the_one_that_is_read) {
  Part part{"", {"Z", "ZBack", "left.Z", "left.ZBack", "left.peel2.Z"}};
  part.multi_view = {"right", "left"};
  write(std::vector<Part>{part});
  for (const char* view : {"", "left"}) {
    settings.view = view;
    Names names;
    for (const auto& guess : hidden_guesses(find(), settings)) names.push_back(guess.channel);
    if (settings.view.empty())
      EXPECT_THAT(names, ElementsAre("ZBack"));
    else
      EXPECT_THAT(names, ElementsAre("left.ZBack", "left.peel2.Z"));
    // What is proposed is found.
    for (const auto& name : names) {
      InputSettings with = settings;
      with.behind[0] = settings.input;
      with.behind_channels = {name};
      EXPECT_EQ(names_of(find_frame(with, false, 0).channels[RawPlane::behind]), Names{name});
    }
  }
  write(std::vector<Part>{{"left", {"Z", "ZBack"}, kWidth, "left"}, {"right", {"Z"}, kWidth, "right"}});
  settings.view = "right";
  EXPECT_THAT(hidden_guesses(find(), settings), IsEmpty());
}

TEST_F(Views, each_has_its_own_ranks_of_a_cryptomatte) {
  for (const char* right : {"right.Crypto00.R", "Crypto00.right.R"}) {
    std::string coverage = right;
    coverage.back() = 'G';
    Part part{"", {"Z", "Crypto00.R", "Crypto00.G", right, coverage}};
    part.multi_view = {"left", "right"};
    Imf::Header header = header_of(part);
    header.insert("cryptomatte/0123456/name", Imf::StringAttribute("Crypto"));
    Imf::OutputFile(settings.input.c_str(), header);
    const ExrFile file(settings.input, "INPUT");
    for (const auto& [view, channel] : {std::pair("", "Crypto00.R"), {"left", "Crypto00.R"}, {"right", right}}) {
      const auto found = cryptomattes_of(file, view);
      ASSERT_EQ(found.size(), 1) << view;
      ASSERT_EQ(found[0].ranks.size(), 1) << view;
      EXPECT_EQ(found[0].ranks[0].object, channel) << view;
    }
  }
}

// Messages.

TEST_F(GBuffer, names_that_a_message_proposes_are_taken) {
  const auto proposed = [&] {
    try {
      find();
    } catch (const Error& error) {
      std::smatch found;
      const std::string text = error.what();
      if (std::regex_search(text, found, std::regex("did you mean ([^ ?]*?)(,| or |\\?)"))) return found[1].str();
    }
    return std::string();
  };
  for (const Names& channels : {Names{"Detph.Z"}, {"Depths.V", "Mist.V"}, {"R", "Deth.Y"}}) {
    settings.depth_channel = "";
    write(channels);
    settings.depth_channel = proposed();
    EXPECT_NE(settings.depth_channel, "");
    EXPECT_EQ(depth().size(), 1) << settings.depth_channel;
  }
  settings.depth_channel = "";
  for (const Names& channels : {Names{"Z", "Nrm.X", "Nrm.Y", "Nrm.Z"}, {"Z", "Nrm2.R", "Nrm2.G", "Nrm2.B"}}) {
    write(channels);
    settings.normal_channels = "Nrn";
    settings.normal_channels = proposed();
    EXPECT_NE(settings.normal_channels, "");
    EXPECT_EQ(normal().size(), 3) << settings.normal_channels;
  }
  write(Names{"Z", "Normal.X"});
  settings.normal_channels = "Normals";
  EXPECT_EQ(proposed(), "") << "one channel is no normal";
}

TEST_F(GBuffer, the_v_of_a_value_is_depth_in_a_layer_of_that_name) {
  for (const Names& channels : {Names{"Depth.V", "Mist.V"}, {"ViewLayer.Depth.V"}, {"Z.V"}, {"depth.V", "IndexOB.V"}}) {
    write(channels);
    EXPECT_THAT(depth(), ElementsAre(channels[0]));
  }
  write(Names{"Mist.V", "Alpha.V"});
  expect_error({"no depth channel", "Mist.V"});
}

// Colours.

class ThreeChannels : public GBuffer {
 protected:
  /// Says of each pixel's number what the channels hold.
  template <class Of>
  void write_planes(const std::string& path, const Names& names, Of of) const {
    const Window window{0, 0, 40, 30};
    FrameFile file{window, window};
    for (std::size_t i = 0; i < window.pixels(); i++)
      for (std::size_t c = 0; c < names.size(); c++) file.planes[names[c]].push_back(of(i, c));
    file.write(path);
  }
  static float grey(std::size_t i, std::size_t) { return 2 + float(i % 7); }
  static float coloured(std::size_t i, std::size_t c) { return 1 + float((i + 3 * c) % 7); }
};

TEST_F(ThreeChannels, that_differ_are_no_depth) {
  settings.input = "";
  settings.depth = folder / "d.exr";
  write_planes(settings.depth, {"R", "G", "B"}, grey);
  EXPECT_THAT(depth(), ElementsAre("R"));
  write_planes(settings.depth, {"R", "G", "B", "A"},
               [](std::size_t i, std::size_t c) { return c == 0 ? grey(i, 0) : 0; });
  EXPECT_THAT(depth(), ElementsAre("R")) << "G and B are empty";
  write_planes(settings.depth, {"R", "G", "B"}, coloured);
  settings.fov.reset();
  expect_error({"d.exr", "R, G and B", "differ", "--depth", "--depth-channel R", "--position"});
  settings.fov = 60;
  settings.depth_channel = "R";
  EXPECT_THAT(depth(), ElementsAre("R"));
}

TEST_F(ThreeChannels, that_differ_in_a_layer_called_depth_are_told) {
  const auto suspicious = [&] { return texts_of(find().suspicious); };
  write_planes(settings.input, {"depth.R", "depth.G", "depth.B"}, coloured);
  EXPECT_THAT(suspicious(), ElementsAre(HasSubstr("R, G and B of layer depth differ")));
  write_planes(settings.input, {"depth.R", "depth.G", "depth.B"}, grey);
  EXPECT_THAT(suspicious(), IsEmpty());
}

TEST_F(ThreeChannels, that_are_a_vector_are_told) {
  write_planes(settings.input, {"X", "Y", "Z"}, coloured);
  EXPECT_THAT(texts_of(find().suspicious), ElementsAre(HasSubstr("--position")));
  settings.depth_channel = "Z";
  EXPECT_THAT(texts_of(find().suspicious), IsEmpty());
  settings.depth_channel = "";
  write_planes(settings.input, {"X", "Y", "Z"}, [](std::size_t i, std::size_t c) { return c == i % 3 ? 1.0F : 0.0F; });
  expect_error({"normals", "--normal", "--depth"});
}

}  // namespace
}  // namespace alcove::addressing_test
