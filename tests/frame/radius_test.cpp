// The radius that is proposed fits what the frame shows.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/radius.h"

#include "tests/support/source_frame.h"

namespace alcove::radius_test {
namespace {

using namespace test;

/// A frame of 100 pixels across whose surfaces have this median depth.
FrameSource frame_at(double median, double fx, bool orthographic = false) {
  FrameSource source;
  source.reading.camera.width = source.reading.camera.height = 100;
  source.reading.camera.fx = source.reading.camera.fy = fx;
  source.reading.camera.orthographic = orthographic;
  source.evidence.emplace().median_depth = median;
  return source;
}

std::optional<double> radius_of(const FrameSource& source) {
  return proposed_radius(source.reading.camera, source.evidence->median_depth);
}

TEST(Radius, is_a_tenth_of_the_distance_by_one_figure_but_no_more_than_a_quarter_of_what_is_seen) {
  EXPECT_EQ(radius_of(frame_at(6.2, 100)), 0.6);
  EXPECT_EQ(radius_of(frame_at(843, 100)), 80);
  EXPECT_EQ(radius_of(frame_at(1000, 10000)), 2) << "10 units are seen, and the quarter is rounded to even";
  for (const double distance : {1.0, 1e6})
    EXPECT_EQ(radius_of(frame_at(distance, 10, true)), 1) << "of a parallel view";
}

TEST(Radius, of_a_settled_frame_follows_its_surfaces_alone) {
  const TemporaryFolder folder;
  InputSettings settings;
  settings.input = folder / "frame.exr";
  settings.camera = folder / "camera.json";
  FrameFile file = wall_frame();
  auto& depth = file.planes["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < depth.size() / 3; i++) depth[i] = 1e10f;
  file.write(settings.input);
  write_bytes(settings.camera, wall_camera().dump());
  const FrameSource source = settled(settings);
  ASSERT_TRUE(source.evidence->median_depth);
  EXPECT_GT(*source.evidence->median_depth, 1.5);
  EXPECT_LE(*source.evidence->median_depth, 6);
  for (auto& z : depth) z = 1e10f;
  file.write(settings.input);
  EXPECT_EQ(settled(settings).evidence->median_depth, std::nullopt);
}

}  // namespace
}  // namespace alcove::radius_test
