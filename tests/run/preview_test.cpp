// What a preview shows: the AO, the composite, or the beauty beside it, through the display and view that are named.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"

namespace alcove::preview_test {
namespace {

using namespace test;

struct Picture {
  Window window;
  std::vector<std::vector<float>> planes;
};

Picture picture_in(const std::string& path) {
  ExrFile file = open_image(path, "the test", Formats::all);
  const ExrPart& part = file.parts()[0];
  Picture picture{part.data, {}};
  std::vector<ExrRead> reads;
  picture.planes.resize(part.channels.size(), std::vector<float>(part.data.pixels()));
  for (std::size_t c = 0; c < part.channels.size(); c++)
    reads.push_back({0, part.channels[c].name, picture.planes[c].data()});
  file.read(reads);
  return picture;
}

/// The columns from `left` on of all planes, row by row.
std::vector<float> columns(const Picture& picture, int left, int width) {
  std::vector<float> result;
  for (const auto& plane : picture.planes)
    for (int y = 0; y < picture.window.height; y++) {
      const auto row = plane.begin() + y * picture.window.width + left;
      result.insert(result.end(), row, row + width);
    }
  return result;
}

class Preview : public CommandLine {
 protected:
  Preview() {
    FrameFile input = wall_frame();
    add_beauty(input);
    input.write(frame);
    write_bytes(config, R"(ocio_profile_version: 1
roles: {default: scene, scene_linear: scene}
displays:
  screen:
    - !<View> {name: plain, colorspace: scene}
    - !<View> {name: Darker, colorspace: dark}
  projector:
    - !<View> {name: plain, colorspace: dark}
colorspaces:
  - !<ColorSpace> {name: scene}
  - !<ColorSpace> {name: dark, from_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}}
)");
  }

  /// The options of a composite and its preview with such settings.
  Options with(const std::string& settings) const {
    Options options{"--composite", folder / "composite.exr", "--preview", png};
    for (const auto& setting : typed(settings)) options.insert(options.end(), {"--set", setting});
    return options;
  }
  Picture shown(const std::string& settings) const { return done(with(settings)).code ? Picture() : picture_in(png); }

  const std::string png = folder / "preview.png", config = folder / "config.ocio", ocio = "ocio=" + config + " ";
};

TEST_F(Preview, of_a_run_without_ao_is_the_shadow_of_the_first_light) {
  const std::string lights = folder / "lights.json";
  write_bytes(lights, R"({"lights": [{"name": "key", "kind": "sun", "direction": [0, 1, 2]},
                                     {"name": "fill", "kind": "sun", "direction": [0, 0, 1]}]})");
  done({"--lights", lights, "--aov", "shadow", "--preview", png});
  const Image image = read_exr_image(ao);
  const auto shadow = image.plane("shadow-key.Y");
  ASSERT_NE(std::ranges::count(shadow, 0), std::ranges::ssize(shadow)) << "all is dark";
  ASSERT_GT(std::ranges::count(shadow, 0), 0) << "nothing is dark";
  EXPECT_THAT(picture_in(png).planes, ElementsAre(testing::ElementsAreArray(shadow)));
  done({"--lights", lights, "--aov", "ao,shadow", "--preview", png});
  EXPECT_THAT(picture_in(png).planes, Not(ElementsAre(testing::ElementsAreArray(shadow))));
}

TEST_F(Preview, of_the_composite_may_be_of_the_ao_or_have_the_beauty_beside_it) {
  const Picture composite = shown(""), beauty = shown("mix=0");
  EXPECT_EQ(shown("preview-style=composite").planes, composite.planes);
  EXPECT_EQ(shown("preview-style=ao").planes.size(), 1);
  EXPECT_NE(beauty.planes, composite.planes);
  const Picture split = shown("preview-style=split");
  const int width = kWallWindow.width;
  ASSERT_EQ(split.window.width, 2 * width + 4);
  ASSERT_EQ(split.window.height, kWallWindow.height);
  EXPECT_EQ(columns(split, 0, width), columns(beauty, 0, width));
  EXPECT_EQ(columns(split, width + 4, width), columns(composite, 0, width));
  EXPECT_THAT(columns(split, width, 4), Each(testing::FloatNear(0.5F, 0.01F)));
}

TEST_F(Preview, goes_through_the_display_and_the_view_that_are_named) {
  const auto plain = shown(ocio).planes, dark = shown(ocio + "view-transform=Darker").planes;
  EXPECT_NE(plain, dark);
  for (const char* settings : {"display=Screen view-transform=darker", "display=projector",  // in any case of letters
                               "display=projector view-transform=plain"})
    EXPECT_EQ(shown(ocio + settings).planes, dark) << settings;
  EXPECT_EQ(shown(ocio + "display=screen").planes, plain);
  for (std::size_t i = 0; i < plain[0].size(); i++)
    if (plain[0][i] < 0.99F) ASSERT_NEAR(dark[0][i], plain[0][i] / 2, 0.005) << i;
}

TEST_F(Preview, names_the_displays_and_views_that_there_are) {
  expect_refused(3, with(ocio + "display=scren"), {config, "--set display=scren", "did you mean screen", "projector"});
  expect_refused(3, with(ocio + "display=projector view-transform=Darker"),
                 {config, "--set view-transform=Darker", "it has plain"});
  expect_refused(3, with("display=P3"), {"built-in", "--set display=P3", "sRGB", "--set ocio"});
}

// The pictures of a sequence that is resumed are made again where another style or view is asked for.
TEST_F(Preview, of_another_look_is_made_again_by_resume) {
  const auto is_made = [&](const std::string& settings) {
    return done(joined(with(settings), {"--resume"})).err.find("whole, kept") == std::string::npos;
  };
  EXPECT_TRUE(is_made(""));
  EXPECT_FALSE(is_made(""));
  EXPECT_TRUE(is_made("preview-style=split"));
  EXPECT_FALSE(is_made("preview-style=split"));
  EXPECT_TRUE(is_made(ocio));
  EXPECT_TRUE(is_made(ocio + "view-transform=Darker"));
  EXPECT_TRUE(is_made(ocio + "display=projector"));
}

}  // namespace
}  // namespace alcove::preview_test
