// Runs with --lights: what they write, what they are computed anew for, and what they refuse before any work.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"

namespace alcove::shadow_run_test {
namespace {

using namespace test;

/// A sun behind the wall, from which the foot of the wall keeps the floor there dark.
const std::string kSun = R"("kind": "sun", "direction": [0, 1, 2])";

std::string file_of(const std::string& light) { return R"({"lights": [{"name": "key", )" + light + "}]}"; }

class ShadowRun : public CommandLine {
 protected:
  ShadowRun() { write_lights(kSun); }

  void write_lights(const std::string& light) const { write_bytes(lights, file_of(light)); }
  std::vector<float> shadow_of(const std::string& more = "") const {
    done(joined({"--lights", lights}, typed(more)));
    return plane("shadow-key.Y");
  }
  std::vector<float> plane(const std::string& channel) const {
    const Image image = read_exr_image(ao);
    const auto values = image.plane(std::string_view(channel));
    return {values.begin(), values.end()};
  }

  const std::string lights = folder / "lights.json";
};

TEST_F(ShadowRun, writes_a_channel_for_each_light_beside_the_ao) {
  const auto shadow = shadow_of();
  ASSERT_EQ(shadow.size(), kWallWindow.pixels());
  EXPECT_EQ(shadow[64 * 5 + 32], 0) << "the wall faces away";
  EXPECT_EQ(shadow[64 * 35 + 32], 1) << "the floor far from the wall";
  int dark = 0;
  for (std::size_t y = 29; y < 36; y++) dark += shadow[64 * y + 32] == 0;
  EXPECT_GT(dark, 0) << "the floor at the wall";
  done({});
  const auto ao_alone = plane("Y");
  shadow_of();
  EXPECT_EQ(plane("Y"), ao_alone);
  EXPECT_EQ(shadow_of("--aov shadow --type float"), shadow);
}

TEST_F(ShadowRun, does_not_depend_on_a_matte_nor_on_the_resolution_of_the_ao) {
  write_lights(kSun + R"(, "angular_diameter": 20)");
  const auto soft = shadow_of();
  EXPECT_TRUE(std::ranges::any_of(soft, [](float x) { return x > 0.1F && x < 0.9F; }));
  EXPECT_EQ(shadow_of("--resolution half"), soft);
  FrameFile file = wall_frame();
  file.planes["Matte.Y"].assign(kWallWindow.pixels(), 0);
  file.write(frame);
  EXPECT_EQ(shadow_of("--set matte-channel=Matte.Y"), soft);
}

TEST_F(ShadowRun, is_computed_anew_where_the_lights_alone_have_changed) {
  const auto before = shadow_of("--resume");
  const auto written = fs::last_write_time(ao);
  EXPECT_EQ(shadow_of("--resume"), before);
  EXPECT_EQ(fs::last_write_time(ao), written) << "it is kept";
  write_lights(R"("kind": "sun", "direction": [0, -1, 2])");
  EXPECT_NE(shadow_of("--resume"), before);
}

TEST_F(ShadowRun, is_refused_without_lights_or_where_these_cannot_be_placed) {
  expect_refused(2, {"--aov", "shadow"}, {"--aov shadow", "--lights"});
  expect_refused(3, {"--lights", folder / "none.json"}, {"none.json", "--lights"});
  expect_refused(2, {"--lights", lights, "--set", "ao-name=shadow-key.Y"}, {"shadow-key.Y", "--set ao-name"});
  json plain = wall_camera();
  plain.erase("world_to_camera");
  write_bytes(camera, plain.dump());
  for (const char* more : {"", "--dry-run"})
    expect_refused(3, joined({"--lights", lights, "--normal", "none"}, typed(more)),
                   {lights, "key", "world_to_camera", "--lights"});
}

using ShadowSequence = SequenceFolder;

TEST_F(ShadowSequence, is_refused_before_any_work_where_a_light_lacks_a_frame) {
  write_frames(1, 3);
  const std::string lights = folder / "lights.json";
  write_bytes(lights, file_of(kSun + R"(, "frames": [{"frame": 1}, {"frame": 2}])"));
  for (const char* more : {"", "--dry-run", "--keep-going"})
    expect_refused(3, joined({"--lights", lights}, typed(more)), {lights, "key", "no frame 3", "--lights", "--frames"});
  EXPECT_TRUE(outputs().empty());
}

TEST_F(ShadowSequence, is_that_of_the_light_of_its_frame) {
  write_frames(1, 2);
  const std::string lights = folder / "lights.json";
  write_bytes(lights, file_of(kSun + R"(, "frames": [{"frame": 1}, {"frame": 2, "direction": [0, -1, 2]}])"));
  done({"--lights", lights});
  const Image first = read_exr_image(output(1)), second = read_exr_image(output(2));
  const std::size_t wall = 64 * 5 + 32;
  EXPECT_EQ(first.plane(std::string_view("shadow-key.Y"))[wall], 0) << "it faces away";
  EXPECT_EQ(second.plane(std::string_view("shadow-key.Y"))[wall], 1) << "it faces the sun";
}

}  // namespace
}  // namespace alcove::shadow_run_test
