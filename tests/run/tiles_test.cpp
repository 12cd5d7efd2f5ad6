// Frames that are computed in tiles have the bits of frames that are computed at once.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/support/command_line.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

using Options = std::vector<std::string>;

class Tiles : public CommandLine {
 protected:
  Tiles() {
    FrameFile large = wall_frame(data, display);
    add_beauty(large);
    large.write(frame);
    json oblique = wall_camera(display);
    oblique["cx"] = oblique["cx"].get<double>() + 3.137;
    write_bytes(camera, oblique.dump());
  }

  /// The bytes of the AO, and of the composite where there is one; how many tiles they took.
  std::pair<std::string, int> computed(Options more, bool in_tiles) {
    Options arguments{"run", frame, "-o", ao, "--camera", camera, "--stats", folder / "stats.json", "--type", "float"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (in_tiles) arguments.insert(arguments.end(), {"--memory", "1M"});
    const Finished finished = run_program(arguments);
    EXPECT_EQ(finished.code, 0) << finished;
    const int tiles = json::parse(read_bytes(folder / "stats.json"))["frames"][0]["parts"];
    const bool has_composite = std::ranges::find(more, "--composite") != more.end();
    return {read_bytes(ao) + (has_composite ? read_bytes(folder / "composite.exr") : ""), tiles};
  }

  const Window data{-6, -3, 1013, 571}, display{0, 0, 1000, 562};
};

TEST_F(Tiles, give_the_bits_of_the_whole) {
  for (const Options& options :
       {Options{"--radius", "0.1"},
        {"--radius", "0.1", "--aov", "ao,normal,depth,specular-occlusion", "--composite", folder / "composite.exr"},
        {"--radius", "0.15", "--estimator", "bitmask", "--slices", "2", "--steps", "20"},
        {"--radius", "0.1", "--estimator", "hbao", "--denoise", "box"},
        {"--radius", "0.1", "--estimator", "crytek", "--denoise", "none"},
        {"--radius", "0.1", "--resolution", "half"},
        {"--radius", "0.1", "--resolution", "quarter", "--denoise-radius", "5"},
        {"--radius", "0.1", "--stride", "4"},
        {"--radius", "0.1", "--preset", "reference"},
        {"--radius", "0.1", "--preset", "reference", "--denoise", "none", "--thickness", "0.05"},
        {"--radius", "0.04", "--tolerance", "0.03", "--aov", "ao,error"},
        {"--radius", "0.1", "--roi", "3,5,900,500", "--falloff", "smooth"}}) {
    const auto [whole, one] = computed(options, false);
    const auto [tiled, many] = computed(options, true);
    EXPECT_EQ(one, 1);
    EXPECT_GT(many, 1) << testing::PrintToString(options);
    EXPECT_TRUE(whole == tiled) << testing::PrintToString(options);
  }
}

TEST_F(Tiles, a_radius_that_reaches_everywhere_is_refused) {
  const Finished finished =
      run_program({"run", frame, "-o", ao, "--camera", camera, "--radius", "50", "--memory", "1M"});
  EXPECT_EQ(finished.code, 5) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("--radius"), HasSubstr("--memory")));
}

TEST_F(Tiles, pictures_need_the_whole) {
  const Finished finished = run_program(
      {"run", frame, "-o", ao, "--camera", camera, "--radius", "0.1", "--memory", "1M", "--preview", folder / "p.png"});
  EXPECT_EQ(finished.code, 5) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("--preview"), HasSubstr("--memory")));
}

}  // namespace
}  // namespace alcove
