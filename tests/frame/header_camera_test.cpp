// Cameras in the headers of frames: standard attributes, matrices, and matrices without a projection.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/source_frame.h"

namespace alcove {
namespace {

using namespace test;

using HeaderCamera = Sources;

TEST_F(HeaderCamera, standard_attributes_give_a_camera) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", view_normal);
  const double width = 2 * std::tan(kFov / 2 * std::numbers::pi / 180);
  header.insert("pinholeFocalLength", Imf::FloatAttribute(50));
  header.insert("sensorOverallDimensions", Imf::V2fAttribute({float(50 * width), float(37.5 * width)}));
  settings.normal_space = NormalSpace::view;
  expect_same("generic");
  header.erase("sensorOverallDimensions");
  expect_refused(ErrorKind::usage, {"--camera"});
  header.screenWindowWidth() = float(width);
  expect_same("generic");
}

TEST_F(HeaderCamera, lens_shift_pixel_aspect_and_overscan_are_in_the_matrices) {
  depth("Z", planar, 1e12f);
  const Rows view = world_to_camera(-1);
  Rows ndc = world_to_ndc(true);
  for (std::size_t j = 0; j < 4; j++) {
    ndc[0][j] += 0.1 * ndc[3][j];
    ndc[1][j] = 2 * (ndc[1][j] - 0.5 * ndc[3][j]) + 0.4 * ndc[3][j];
  }
  header.insert("worldToCamera", matrix(view, true));
  header.insert("worldToNDC", matrix(ndc, true));
  header.dataWindow() = Imath::Box2i({0, 0}, {159, 119});
  write(settings.input);
  const Camera camera = find_frame(settings, false, 0).camera;
  EXPECT_NEAR(camera.fx, shot().camera.fx, 1e-3);
  EXPECT_NEAR(camera.fy, 2 * shot().camera.fy, 1e-3);
  EXPECT_NEAR(camera.cx, 0.6 * 160, 1e-3);
  EXPECT_NEAR(camera.cy, 0.4 * 120, 1e-3);
}

TEST_F(HeaderCamera, an_orthographic_projection_is_known_by_its_matrix) {
  depth("Z", planar, 1e12f);
  const Rows view = world_to_camera(-1);
  Rows ndc{};
  for (std::size_t j = 0; j < 4; j++) {
    ndc[0][j] = view[0][j] / 8;
    ndc[1][j] = -view[1][j] / 6;
    ndc[2][j] = view[2][j] / 100;
  }
  ndc[0][3] += 0.5;
  ndc[1][3] += 0.5;
  ndc[3] = {0, 0, 0, 1};
  header.insert("worldToCamera", matrix(view, true));
  header.insert("worldToNDC", matrix(ndc, true));
  write(settings.input);
  const Camera camera = find_frame(settings, false, 0).camera;
  EXPECT_TRUE(camera.orthographic);
  EXPECT_NEAR(camera.fx, 20, 1e-4);
  EXPECT_NEAR(camera.cx, 80, 1e-3);
  EXPECT_NEAR(camera.cy, 60, 1e-3);
  EXPECT_TRUE(camera.left_handed);
}

TEST_F(HeaderCamera, panoramas_are_refused) {
  depth("Z", planar, 1e12f);
  give_camera();
  header.insert("envmap", Imf::IntAttribute(1));
  expect_refused(ErrorKind::input, {"panorama", "frame.exr"});
  header.erase("envmap");
  header.insert("cameraProjection", Imf::IntAttribute(1));
  expect_refused(ErrorKind::input, {"panorama"});
}

// Matrices that place the camera, with a projection by options.

TEST_F(HeaderCamera, world_to_camera_alone_and_a_field_of_view_are_a_camera) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  settings.fov = kFov;
  settings.normal_space = NormalSpace::world;
  for (const bool looks_along_z : {true, false})
    for (const bool row_vectors : {true, false}) {
      SCOPED_TRACE(fmt::format("looks along z: {}, row vectors: {}", looks_along_z, row_vectors));
      header.erase("worldToCamera");
      header.insert("worldToCamera", matrix(world_to_camera(looks_along_z ? -1 : 1), row_vectors));
      expect_same("generic");
      const FrameSource source = find_frame(settings, false, 0);
      EXPECT_EQ(source.camera.left_handed, looks_along_z);
      EXPECT_EQ(source.camera.placement_from, "worldToCamera");
    }
}

TEST_F(HeaderCamera, world_to_camera_alone_and_a_focal_length_with_an_aperture_are_a_camera) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  settings.focal = 50;
  settings.aperture = 100 * std::tan(kFov / 2 * std::numbers::pi / 180);
  settings.normal_space = NormalSpace::world;
  header.insert("worldToCamera", matrix(world_to_camera(-1), true));
  expect_same("generic");
}

TEST_F(HeaderCamera, a_field_of_view_replaces_the_headers_and_leaves_the_camera_in_its_place) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  add_matrices(header, true);
  settings.fov = 40;
  write(settings.input);
  const Camera chosen = find_frame(settings, false, 0).camera;
  settings.fov.reset();
  const Camera own = find_frame(settings, false, 0).camera;
  EXPECT_NEAR(chosen.fx, 80 / std::tan(20 * std::numbers::pi / 180), 1e-6);
  EXPECT_NE(chosen.fx, own.fx);
  ASSERT_TRUE(chosen.view_from_world.has_value());
  EXPECT_EQ(*chosen.view_from_world, own.view_from_world.value());
  EXPECT_EQ(chosen.view_from_world_offset, own.view_from_world_offset);
  EXPECT_EQ(chosen.left_handed, own.left_handed);
}

TEST_F(HeaderCamera, transforms_of_redshift_and_vray_place_a_camera_too) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  settings.fov = kFov;
  settings.normal_space = NormalSpace::world;
  for (const auto& [name, sign] : {std::pair{"rs/camera/transform", -1.0}, {"cameraTransform", 1.0}}) {
    header.insert(name, matrix(camera_to_world(sign), true));
    write(settings.input);
    EXPECT_EQ(find_frame(settings, false, 0).camera.placement_from, name);
    const Difference d = difference(ao_of(read_host_frame(settings, 0), 1), ao_of(rendering().frame, 1));
    EXPECT_LE(d.max, 1e-3) << name;
    header.erase(name);
  }
}

TEST_F(HeaderCamera, a_matrix_that_is_no_rotation_places_nothing) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  settings.fov = kFov;
  settings.normal_space = NormalSpace::world;
  Rows sheared = world_to_camera(1);
  sheared[0][1] += 0.5;
  header.insert("worldToCamera", matrix(sheared, true));
  expect_refused(ErrorKind::input, {"world_to_camera"});
}

}  // namespace
}  // namespace alcove
