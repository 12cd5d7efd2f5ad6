// What the pixels tell of depth and normals is found, and what they do not tell is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "core/base/error.h"
#include "tests/support/furnished.h"
#include "tests/support/program.h"
#include "tests/support/settled.h"
#include "tests/support/wall_frame.h"

namespace alcove {
namespace {

using namespace test;
using testing::HasSubstr;

constexpr double kFar = 100;

/// A rendering as a file, with the camera that made it.
class Evidence : public testing::Test {
 protected:
  Evidence() { settings.input = folder / "frame.exr"; }

  /// Depth as `value` gives it, normals by `turn`; the camera file says nothing of either.
  void write(
      const std::function<double(const test::Hit&)>& value, float sky,
      const std::function<Vec3(Vec3)>& turn = [](Vec3 n) { return n; }) {
    const Shot& shot = rendering.shot;
    FrameFile file{shot.data, shot.display, 1, {}, {}, {}};
    const HostFrame frame = with_depth(rendering, DepthKind::planar, value, sky);
    file.planes["Z"] = frame.depth;
    const char* names[] = {"N.X", "N.Y", "N.Z"};
    for (std::size_t c = 0; c < 3; c++) file.planes[names[c]].resize(frame.depth.size());
    for (std::size_t i = 0; i < frame.depth.size(); i++) {
      if (rendering.hits[i].primitive < 0) continue;
      const Vec3 n = turn(rendering.hits[i].normal);
      file.planes["N.X"][i] = float(n.x);
      file.planes["N.Y"][i] = float(n.y);
      file.planes["N.Z"][i] = float(n.z);
    }
    file.halves = halves;
    file.write(settings.input);
    const Vec3 offset = -shot.view_from_world(shot.eye);
    const nlohmann::json camera = {{"resolution", {shot.data.width, shot.data.height}},
                                   {"fx", shot.camera.fx},
                                   {"fy", shot.camera.fy},
                                   {"cx", shot.camera.cx},
                                   {"cy", shot.camera.cy},
                                   {"world_to_camera",
                                    {{shot.right.x, shot.right.y, shot.right.z, offset.x},
                                     {shot.up.x, shot.up.y, shot.up.z, offset.y},
                                     {shot.back.x, shot.back.y, shot.back.z, offset.z},
                                     {0, 0, 0, 1}}}};
    settings.camera = folder / "camera.json";
    write_bytes(settings.camera, camera.dump());
  }

  FrameSource settled() const { return test::settled(settings); }

  void expect_refused(const std::vector<std::string>& words) const {
    try {
      settled();
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      for (const auto& word : words) EXPECT_THAT(error.what(), HasSubstr(word));
    }
  }

  double ray_of(const test::Hit& hit) const { return length(hit.position - rendering.shot.eye); }

  Rendering rendering = furnished();
  std::set<std::string> halves;
  TemporaryFolder folder;
  InputSettings settings;
};

TEST_F(Evidence, tells_planar_ray_and_inverse_apart) {
  write([](const test::Hit& hit) { return hit.distance; }, 1e10f);
  FrameSource source = settled();
  EXPECT_EQ(source.depth_kind, DepthKind::planar);
  EXPECT_EQ(source.normal_space, NormalSpace::world);
  EXPECT_THAT(texts_of(source.notes), testing::IsEmpty()) << "nothing unusual";
  write([&](const test::Hit& hit) { return ray_of(hit); }, 1e10f);
  source = settled();
  EXPECT_EQ(source.depth_kind, DepthKind::ray);
  EXPECT_THAT(texts_of(source.notes), testing::ElementsAre(HasSubstr("--depth-kind")));
  write([](const test::Hit& hit) { return 30 / hit.distance; }, 0);
  EXPECT_EQ(settled().depth_kind, DepthKind::inverse);
}

TEST_F(Evidence, is_not_asked_where_the_user_speaks) {
  write([&](const test::Hit& hit) { return ray_of(hit); }, 1e10f);
  settings.depth_kind = DepthKind::planar;
  EXPECT_EQ(settled().depth_kind, DepthKind::planar);
}

TEST_F(Evidence, a_z_buffer_without_planes_is_refused_and_with_planes_is_read) {
  write([](const test::Hit& hit) { return device_depth(hit.distance, kFar, false, DeviceRange::zero_to_one); }, 1);
  expect_refused({"device", "inverse", "--near", "--far", "frame.exr"});
  settings.depth_range = between_planes(kFar, false);
  const FrameSource standard = settled();
  EXPECT_EQ(standard.depth_kind, DepthKind::device);
  EXPECT_FALSE(standard.depth_range.reversed) << "its sky is 1";
  write([](const test::Hit& hit) { return device_depth(hit.distance, kFar, true, DeviceRange::zero_to_one); }, 0);
  const FrameSource reversed = settled();
  EXPECT_EQ(reversed.depth_kind, DepthKind::device);
  EXPECT_TRUE(reversed.depth_range.reversed) << "its sky is 0";
  write([](const test::Hit& hit) { return device_depth(hit.distance, kFar, true, DeviceRange::zero_to_one); }, 0.5f);
  expect_refused({"--reversed-z"});
}

TEST_F(Evidence, positions_that_are_not_on_their_pixels_are_refused) {
  FrameFile file{rendering.shot.data, rendering.shot.display, 1, {}, {}, {}};
  const char* names[] = {"P.X", "P.Y", "P.Z"};
  for (const char* name : names) file.planes[name].resize(rendering.hits.size());
  for (std::size_t i = 0; i < rendering.hits.size(); i++) {
    if (rendering.hits[i].primitive < 0) continue;
    const Vec3 p = rendering.hits[i].position;
    file.planes["P.X"][i] = float(p.x);
    file.planes["P.Y"][i] = float(p.y);
    file.planes["P.Z"][i] = float(p.z);
  }
  write([](const test::Hit& hit) { return hit.distance; }, 1e10f);  // for its camera
  file.write(settings.input);
  EXPECT_EQ(settled().position_space, PositionSpace::world);
  settings.position_space = PositionSpace::view;
  expect_refused({"frame.exr", "pixels", "--set position-space", "--camera"});
}

TEST_F(Evidence, finds_the_space_and_the_flips_of_normals) {
  const auto planar = [](const test::Hit& hit) { return hit.distance; };
  const Shot& shot = rendering.shot;
  write(planar, 1e10f, [&](Vec3 n) { return shot.view_from_world(n); });
  EXPECT_EQ(settled().normal_space, NormalSpace::view);
  write(planar, 1e10f, [&](Vec3 n) {
    const Vec3 v = shot.view_from_world(n);
    return Vec3{v.x, v.y, -v.z};
  });
  const FrameSource source = settled();
  EXPECT_EQ(source.normal_space, NormalSpace::view);
  EXPECT_EQ(to_string(source.flip_normal), "z");
  EXPECT_THAT(texts_of(source.notes), testing::ElementsAre(HasSubstr("--flip-normal")));
}

TEST_F(Evidence, finds_normals_between_0_and_1) {
  write([](const test::Hit& hit) { return hit.distance; }, 1e10f,
        [](Vec3 n) {
          return Vec3{0.5 + 0.5 * n.x, 0.5 + 0.5 * n.y, 0.5 + 0.5 * n.z};
        });
  const FrameSource source = settled();
  EXPECT_TRUE(source.normal_unorm);
  EXPECT_EQ(source.normal_space, NormalSpace::world);
}

TEST_F(Evidence, strict_turns_a_guess_into_an_error) {
  write([](const test::Hit& hit) { return hit.distance; }, 1e10f);
  settings.strict = true;
  expect_refused({"--strict", "--depth-kind", "planar"});
  settings.depth_kind = DepthKind::planar;
  expect_refused({"--strict", "--normal-space", "world"});
  settings.normal_space = NormalSpace::world;
  EXPECT_NO_THROW(settled());
}

TEST_F(Evidence, half_depth_is_noted_with_its_step) {
  halves = {"Z"};
  settings.depth_kind = DepthKind::planar;
  write([](const test::Hit& hit) { return hit.distance; }, 65504);
  EXPECT_THAT(texts_of(settled().suspicious),
              testing::ElementsAre(testing::AllOf(HasSubstr("half float"), HasSubstr("0.0039"))));
}

}  // namespace
}  // namespace alcove
