// The AO of disparity is that of the depth behind it, in radii that need no scene units.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "tests/support/source_frame.h"

namespace alcove::disparity_run_test {
namespace {

using namespace test;

/// The room with a ball.
class DisparityRun : public SequenceFolder {
 protected:
  DisparityRun() { write_bytes(camera, camera_of(shot()).dump()); }

  static Vec3 normal(const Hit& hit) { return hit.normal; }
  /// Frames with 3 / z + 0.7.
  void write_disparities(int first, int last) const {
    write_frames(first, last,
                 file_of(
                     rendering(), 0.7f, [](const Hit& hit) { return 3 / hit.distance + 0.7; }, normal));
  }
  std::vector<float> ao(int frame) const { return read_exr_image(output(frame)).pixels; }

  static constexpr std::array<float, 5> kBinomial{1, 4, 6, 4, 1};
  static constexpr const char* kDisparity = "--depth-kind disparity --normal-space world ";
  static Options said(const std::string& more) { return typed(kDisparity + more); }
};

TEST_F(DisparityRun, has_the_ao_of_the_depth_that_it_stands_for) {
  write_frames(1, 1, file_of(rendering(), kSky, planar, normal));
  EXPECT_THAT(done(typed("--depth-kind planar --normal-space world --radius 20%")).err,
              testing::ContainsRegex("--radius 20% takes [0-9.]+, of a median depth of [0-9.]+ for all frames"));
  const auto by_depth = ao(1);
  write_disparities(1, 1);
  done(said("--radius 20%"));
  const auto by_disparity = ao(1);
  ASSERT_EQ(by_disparity.size(), by_depth.size());
  EXPECT_LT(std::ranges::min(by_depth), 0.8) << "there is AO";
  for (std::size_t i = 0; i < by_depth.size(); i++) EXPECT_NEAR(by_disparity[i], by_depth[i], 0.01) << i;
}

TEST_F(DisparityRun, is_the_same_in_chunks_and_regions) {
  write_disparities(1, 3);
  done(said("--radius 20%"));
  const auto whole = ao(2);
  expect_same_outputs(outputs(), {said("--radius 20% --chunk 2/2"), said("--radius 20% --chunk 1/2")});
  done(said("--radius 20% --roi 60,40,50,30"));
  EXPECT_EQ(ao(2), cropped(whole, rendering().shot.data, {60, 40, 50, 30}));
}

TEST_F(DisparityRun, with_blurred_outlines_has_about_the_ao_of_sharp_ones_once_ramps_are_cut) {
  const std::string example = ALCOVE_SOURCE_DIR "/examples/interior.";
  const Image frame = read_exr_image(example + "gbuffer.exr", {"ViewLayer.Depth.Z"});
  const Window& data = frame.data;
  std::vector<float> sharp, soft(data.pixels());
  for (const float z : frame.pixels) sharp.push_back(1 / z + 0.7f);
  const auto width = std::size_t(data.width);
  for (std::size_t i = 3 * width; i < soft.size() - 3 * width; i++)
    for (std::size_t dy = 0; dy < 5; dy++)
      for (std::size_t dx = 0; dx < 5; dx++)
        soft[i] += kBinomial[dx] * kBinomial[dy] * sharp[i + dx - 2 + (dy - 2) * width] / 256;
  const auto ao_with = [&](const std::vector<float>& values, const std::string& more, bool is_told) {
    write_plane(input(1), "disparity", values, data, data);
    const Finished finished = done(typed("--depth-kind disparity --set disparity-shift=0.7 --radius 10% --camera " +
                                         example + "camera.json " + more));
    EXPECT_EQ(finished.err.find("--set ramps=cut") != std::string::npos, is_told) << finished;
    EXPECT_EQ(finished.err.find("lay on ramps") != std::string::npos, more.starts_with("--set ramps=cut")) << finished;
    return ao(1);
  };
  const auto wanted = ao_with(sharp, "", false), kept = ao_with(soft, "", true),
             cut = ao_with(soft, "--set ramps=cut", false);
  const auto rms = [&](const std::vector<float>& values) {
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); i++) sum += std::pow(values[i] - wanted[i], 2);
    return std::sqrt(sum / double(values.size()));
  };
  EXPECT_LT(rms(cut), 0.85 * rms(kept));
  EXPECT_EQ(ao_with(soft, "--set ramps=cut --roi 60,40,50,30", false), cropped(cut, data, {60, 40, 50, 30}));
}

TEST_F(DisparityRun, is_found_where_input_holds_nothing_else) {
  const Window& data = rendering().shot.data;
  std::vector<float> values;
  for (const float z : rendering().frame.depth) values.push_back(z < kSky ? 3 / z + 0.7f : 0.7f);
  for (const char* channel : {"disparity", "Y", "R"}) {
    write_plane(input(1), channel, values, data, data);
    done(typed("--depth-kind disparity --set disparity-shift=0.7 --radius 20%"));
    EXPECT_LT(std::ranges::min(ao(1)), 0.8) << channel;
  }
  EXPECT_EQ(run(typed("--depth-kind planar --radius 1")).code, 3)
      << "other depth is named, or stands in a --depth file";
}

TEST_F(DisparityRun, takes_scene_units_only_with_a_scale) {
  write_disparities(1, 1);
  for (const char* length :
       {"--radius 0.5", "--radius 5% --thickness 1", "--radius 5% --set fade-start=1 --set fade-end=2",
        "--radius 5% --sky 100", "--radius 5% --depth-scale 2"}) {
    const Finished finished = run(said(length));
    EXPECT_EQ(finished.code, 2) << length;
    EXPECT_THAT(finished.err, AllOf(HasSubstr("no scene units"), HasSubstr("--set disparity-scale"))) << length;
  }
  EXPECT_THAT(run(said("--radius 0.5")).err, HasSubstr("in percent"));
  for (const char* scale :
       {"--set disparity-scale=3", "--near 10", "--radius 5% --thickness infinite", "--radius auto"})
    done(said(scale));
  EXPECT_EQ(run(said("--near 1 --far 9 --set disparity-shift=0")).code, 2);
  const Finished around = run(said("--radius 5% --around 1"));
  EXPECT_EQ(around.code, 2);
  EXPECT_THAT(around.err, HasSubstr("do not fit together"));
}

TEST_F(DisparityRun, without_normals_ends_as_an_input_that_lacks_something) {
  write_disparities(1, 1);
  const Finished finished = run(typed("--depth-kind disparity --normal none --radius 5%"));
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err, AllOf(HasSubstr(input(1)), HasSubstr("--set disparity-shift"), HasSubstr("--normal")));
}

TEST_F(DisparityRun, is_told_by_inspect_with_its_error_and_a_radius_in_percent) {
  write_disparities(1, 1);
  const Finished finished = run_program(joined({"inspect", input(1), "--camera", camera}, said("")));
  EXPECT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.out, AllOf(HasSubstr("+-"), HasSubstr("AO is off by up to"),
                                  HasSubstr("--set disparity-shift=0."), HasSubstr("--radius 10%")));
}

}  // namespace
}  // namespace alcove::disparity_run_test
