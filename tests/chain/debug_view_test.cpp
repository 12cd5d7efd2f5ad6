// The debug views: a picture each that says its scale, whole or not at all, and right where what it must show is
// known.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/debug.h"
#include "tests/support/command_line.h"
#include "tests/support/picture_file.h"

namespace alcove::debug_view_test {
namespace {

using namespace test;

/// The ends of the colour ramp, near the darkest and the brightest colour of "viridis".
constexpr std::array kLowest{71, 1, 85}, kHighest{252, 231, 33};

/// Of a frame by itself: how many frames it is a mean of is shown by tests/run/accumulate_test.cpp.
std::vector<std::string> names_of_one_frame() {
  std::vector<std::string> names = debug_view_names();
  std::erase(names, "count");
  return names;
}

class DebugViews : public CommandLine {
 protected:
  Image view(const std::string& name, const Options& more = {}) {
    done(joined(more, {"--set", "debug=" + name}));
    return shown(name);
  }
  Image shown(const std::string& name) const { return whole(*open_picture(folder / ("ao." + name + ".png"), "INPUT")); }
  static std::array<int, 3> color(const Image& picture, int x, int y) {
    std::array<int, 3> bytes{};
    const std::size_t i = std::size_t(y) * std::size_t(picture.data.width) + std::size_t(x);
    for (std::size_t c = 0; c < 3; c++) bytes[c] = int(std::lround(255 * picture.plane(c)[i]));
    return bytes;
  }
  /// The arguments for all views: those of what is hidden need something that is.
  Options all_views() const {
    FrameFile layer;
    layer.planes["Z"] = std::vector<float>(layer.data.pixels(), 9);
    layer.write(folder / "layer.exr");
    return {"--set", fmt::format("debug={}", fmt::join(names_of_one_frame(), ",")), "--behind", folder / "layer.exr"};
  }
};

TEST_F(DebugViews, every_one_is_a_picture_beside_the_output_that_says_its_scale) {
  done(joined(all_views(), {"--resolution", "full"}));
  for (const auto& name : names_of_one_frame()) EXPECT_EQ(shown(name).data, (Window{0, 0, 64, 36})) << name;
  const auto text = [&](const char* name) { return read_bytes(folder / fmt::format("ao.{}.png", name)); };
  EXPECT_THAT(
      text("raw-ao"),
      HasSubstr(
          "raw AO: as estimated, of the smallest radius, at its own resolution; 1 is open. Darkest: 0, brightest: 1."));
  EXPECT_THAT(text("linear-depth"), AllOf(HasSubstr("scene units. Darkest: <= 3."), HasSubstr(", brightest: >= 6.")));
}

TEST_F(DebugViews, sky_has_a_colour_that_no_number_has) {
  FrameFile input = wall_frame();
  input.planes["ViewLayer.Depth.Z"][3 * 64 + 5] = 1e10f;
  input.write(frame);
  ASSERT_EQ(run(all_views()).code, 0);
  for (const auto& name : names_of_one_frame()) {
    const Image picture = shown(name);
    const auto sky = color(picture, 5, 3);
    EXPECT_GT(sky[0], sky[1] + 60) << name;
    for (int y = 0; y < 36; y++)
      for (int x = 0; x < 64; x++)
        if (x != 5 || y != 3) ASSERT_NE(color(picture, x, y), sky) << name << " " << x << " " << y;
  }
}

TEST_F(DebugViews, raw_ao_is_grey_as_the_ao_is_before_shaping) {
  const Image picture = view("raw-ao", {"--set", "power=3", "--set", "stride=1"});
  ASSERT_EQ(run({"--type", "float", "--denoise", "none"}).code, 0);
  const Image plain = read_exr_image(ao);
  for (int y = 0; y < 36; y++)
    for (int x = 0; x < 64; x++) {
      const int grey = int(std::lround(255 * plain.plane("Y")[std::size_t(y * 64 + x)]));
      ASSERT_EQ(color(picture, x, y), (std::array{grey, grey, grey})) << x << " " << y;
    }
}

TEST_F(DebugViews, estimates_are_shown_at_their_own_resolution) {
  for (const char* name : {"raw-ao", "denoised-ao"}) {
    const Image picture = view(name, {"--resolution", "half", "--denoise", "bilateral"});
    EXPECT_EQ(picture.data, (Window{0, 0, 32, 18})) << name;
  }
  EXPECT_NE(read_bytes(folder / "ao.raw-ao.png"), read_bytes(folder / "ao.denoised-ao.png"));
}

TEST_F(DebugViews, linear_depth_brightens_with_the_distance_and_view_z_darkens) {
  // Luma of the ramp rises from end to end. Column 0 of the wall frame: the wall above, then the floor towards the eye.
  const auto luma = [](const std::array<int, 3>& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
  for (const auto& [name, sign] : {std::pair{"raw-depth", 1}, {"linear-depth", 1}, {"view-z", -1}}) {
    const Image picture = view(name);
    EXPECT_GT(sign * (luma(color(picture, 0, 0)) - luma(color(picture, 0, 35))), 100) << name;
    for (int y = 30; y < 35; y++)
      EXPECT_GE(sign * (luma(color(picture, 0, y)) - luma(color(picture, 0, y + 1))), 0) << name << " " << y;
  }
}

TEST_F(DebugViews, reconstruction_tells_wrong_normals_from_right_ones) {
  const Image right = view("reconstruction");
  FrameFile input = wall_frame();
  for (std::size_t i = 0; i < 64 * 4; i++) {  // the upper rows of the wall lean by 60 degrees
    input.planes["ViewLayer.Normal.X"][i] = float(std::sqrt(0.75));
    input.planes["ViewLayer.Normal.Y"][i] = -0.5f;
  }
  input.write(frame);
  const Image wrong = view("reconstruction");
  for (int x = 0; x < 64; x++) {
    ASSERT_EQ(color(right, x, 1), kLowest) << x;
    ASSERT_EQ(color(wrong, x, 1), kHighest) << x;
    ASSERT_EQ(color(wrong, x, 8), kLowest) << x;
  }
}

TEST_F(DebugViews, edges_are_where_the_surface_bends_or_ends) {
  FrameFile input = wall_frame();
  input.planes["ViewLayer.Depth.Z"][10 * 64 + 20] = 3;  // a speck before the wall
  input.write(frame);
  const Image picture = view("edges");
  const auto none = color(picture, 40, 3);
  EXPECT_EQ(none, kLowest) << "flat";
  for (const auto& [x, y] : {std::pair{20, 10}, {21, 10}, {20, 9}})
    EXPECT_NE(color(picture, x, y), none) << x << " " << y;
  EXPECT_EQ(color(picture, 22, 10), none);
}

TEST_F(DebugViews, view_normal_z_shows_the_wall_facing_and_the_floor_across) {
  const Image picture = view("view-normal-z");
  EXPECT_EQ(color(picture, 9, 2), kHighest) << "1";
  EXPECT_NE(color(picture, 9, 34), color(picture, 9, 2));
}

TEST_F(DebugViews, without_ao_only_its_own_passes_run) {
  EXPECT_THAT(passes_of({"--aov", "depth", "--set", "debug=edges"}), ElementsAre("prepare", "reconstruct", "debug"));
}

TEST_F(DebugViews, what_cannot_be_shown_or_written_is_refused_before_any_work) {
  expect_run_refused(2, {"--set debug", "did you mean edges?", "raw-depth, linear-depth"}, {"--set", "debug=edgse"});
  expect_run_refused(2, {"--set debug", "raw-depth"}, {"--set", "debug=raw-depth,"});
  expect_run_refused(2, {"--set debug", "--preview", "same file"},
                     {"--set", "debug=edges", "--preview", folder / "ao.edges.png"});
  fs::create_directory(folder / "ao.edges.png");
  expect_run_refused(4, {"ao.edges.png", "--set debug"}, {"--set", "debug=edges"});
}

}  // namespace
}  // namespace alcove::debug_view_test
