// What a preview shows: the AO, the composite, or the beauty beside it, through the display and view that are named.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/formats/exr.h"
#include "tests/support/command_line.h"

namespace alcove {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using Options = std::vector<std::string>;

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

  Picture shown(const Options& more) const {
    Options options{"--composite", folder / "composite.exr", "--preview", png, "--set", "overwrite=true"};
    options.insert(options.end(), more.begin(), more.end());
    const Finished finished = run(options);
    EXPECT_EQ(finished.code, 0) << finished;
    return finished.code ? Picture() : picture_in(png);
  }

  const std::string png = folder / "preview.png", config = folder / "config.ocio";
};

TEST_F(Preview, of_the_composite_may_be_of_the_ao_or_have_the_beauty_beside_it) {
  const Picture composite = shown({}), beauty = shown({"--set", "mix=0"}), ao = shown({"--set", "preview-style=ao"});
  EXPECT_EQ(shown({"--set", "preview-style=composite"}).planes, composite.planes);
  EXPECT_EQ(ao.planes.size(), 1);
  EXPECT_NE(beauty.planes, composite.planes);
  const Picture split = shown({"--set", "preview-style=split"});
  const int width = kWallWindow.width;
  ASSERT_EQ(split.window.width, 2 * width + 4);
  ASSERT_EQ(split.window.height, kWallWindow.height);
  EXPECT_EQ(columns(split, 0, width), columns(beauty, 0, width));
  EXPECT_EQ(columns(split, width + 4, width), columns(composite, 0, width));
  EXPECT_THAT(columns(split, width, 4), testing::Each(testing::FloatNear(0.5F, 0.01F)));
}

TEST_F(Preview, goes_through_the_display_and_the_view_that_are_named) {
  const Options with_config{"--set", std::string("ocio=") + config};
  const auto named = [&](const Options& more) {
    Options options = with_config;
    options.insert(options.end(), more.begin(), more.end());
    return shown(options).planes;
  };
  const auto plain = named({}), dark = named({"--set", "view-transform=Darker"});
  EXPECT_NE(plain, dark);
  EXPECT_EQ(named({"--set", "display=Screen", "--set", "view-transform=darker"}), dark) << "in any case of letters";
  EXPECT_EQ(named({"--set", "display=projector"}), dark);
  EXPECT_EQ(named({"--set", "display=projector", "--set", "view-transform=plain"}), dark);
  EXPECT_EQ(named({"--set", "display=screen"}), plain);
  for (std::size_t i = 0; i < plain[0].size(); i++)
    if (plain[0][i] < 0.99F) ASSERT_NEAR(dark[0][i], plain[0][i] / 2, 0.005) << i;
}

TEST_F(Preview, names_the_displays_and_views_that_there_are) {
  const auto expect_error = [&](const Options& more, const Options& words) {
    Options options{"--composite", folder / "composite.exr", "--preview", png};
    options.insert(options.end(), more.begin(), more.end());
    const Finished finished = run(options);
    EXPECT_EQ(finished.code, 3) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    for (const auto& word : words) EXPECT_THAT(finished.err, HasSubstr(word));
  };
  expect_error({"--set", std::string("ocio=") + config, "--set", "display=scren"},
               {config, "--set display=scren", "did you mean screen", "projector"});
  expect_error({"--set", std::string("ocio=") + config, "--set", "display=projector", "--set", "view-transform=Darker"},
               {config, "--set view-transform=Darker", "it has plain"});
  expect_error({"--set", "display=P3"}, {"built-in", "--set display=P3", "sRGB", "--set ocio"});
}

// The pictures of a sequence that is resumed are made again where another style or view is asked for.
TEST_F(Preview, of_another_look_is_made_again_by_resume) {
  const auto resumed = [&](const Options& more) {
    Options options{"--composite", folder / "composite.exr", "--preview", png, "--resume"};
    options.insert(options.end(), more.begin(), more.end());
    const auto before =
        std::filesystem::exists(png) ? std::filesystem::last_write_time(png) : std::filesystem::file_time_type();
    EXPECT_EQ(run(options).code, 0);
    return std::filesystem::last_write_time(png) != before;
  };
  EXPECT_TRUE(resumed({}));
  EXPECT_FALSE(resumed({}));
  EXPECT_TRUE(resumed({"--set", "preview-style=split"}));
  EXPECT_FALSE(resumed({"--set", "preview-style=split"}));
  EXPECT_TRUE(resumed({"--set", std::string("ocio=") + config}));
  EXPECT_TRUE(resumed({"--set", std::string("ocio=") + config, "--set", "view-transform=Darker"}));
  EXPECT_TRUE(resumed({"--set", std::string("ocio=") + config, "--set", "display=projector"}));
}

}  // namespace
}  // namespace alcove
