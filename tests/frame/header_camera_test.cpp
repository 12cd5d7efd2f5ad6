// Cameras in the headers of frames: standard attributes, matrices, and matrices without a projection.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/camera.h"
#include "tests/support/source_frame.h"

namespace alcove::header_camera_test {
namespace {

using namespace test;

class HeaderCameras : public Sources {
 protected:
  HeaderCameras() {
    depth("Z", planar, 1e12f);
    vectors("N", "XYZ", world_normal);
  }
};

TEST_F(HeaderCameras, standard_attributes_give_a_camera) {
  vectors("N", "XYZ", view_normal);
  const double width = 2 * std::tan(kFov / 2 * std::numbers::pi / 180);
  header.insert("pinholeFocalLength", Imf::FloatAttribute(50));
  header.insert("sensorOverallDimensions", Imf::V2fAttribute({float(50 * width), float(37.5 * width)}));
  settings.normal_space = NormalSpace::view;
  expect_same("generic");
  header.erase("sensorOverallDimensions");
  expect_refused(Reply::usage, {"--camera"});
  header.screenWindowWidth() = float(width);
  expect_same("generic");
}

TEST_F(HeaderCameras, lens_shift_pixel_aspect_and_overscan_are_in_the_matrices) {
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
  const Camera camera = find_frame(settings, false, 0).reading.camera;
  EXPECT_NEAR(camera.fx, shot().camera.fx, 1e-3);
  EXPECT_NEAR(camera.fy, 2 * shot().camera.fy, 1e-3);
  EXPECT_NEAR(camera.cx, 0.6 * 160, 1e-3);
  EXPECT_NEAR(camera.cy, 0.4 * 120, 1e-3);
}

TEST_F(HeaderCameras, an_orthographic_projection_is_known_by_its_matrix) {
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
  const Camera camera = find_frame(settings, false, 0).reading.camera;
  EXPECT_TRUE(camera.orthographic);
  EXPECT_NEAR(camera.fx, 20, 1e-4);
  EXPECT_NEAR(camera.cx, 80, 1e-3);
  EXPECT_NEAR(camera.cy, 60, 1e-3);
  EXPECT_TRUE(camera.left_handed);
}

TEST_F(HeaderCameras, a_matrix_that_does_no_more_than_place_the_camera_is_no_projection) {
  const auto scaled_by = [](Rows rows, double s) {
    for (std::size_t i = 0; i < 3; i++)
      for (double& x : rows[i]) x *= s;
    return rows;
  };
  const Rows view = world_to_camera(-1);
  struct Case {
    const char* what;
    Rows ndc;
    bool row_vectors;
    double camera_scale;
  };
  for (const auto& [what, ndc, row_vectors, camera_scale] :
       {Case{"the same", view, true, 1}, Case{"transposed", view, false, 1},
        Case{"both scaled", scaled_by(view, 2), true, 2}, Case{"scaled", scaled_by(view, 0.5), true, 1},
        Case{"looking back", world_to_camera(1), true, 1}}) {
    SCOPED_TRACE(what);
    for (const char* name : {"worldToCamera", "worldToNDC"}) header.erase(name);
    header.insert("worldToCamera", matrix(scaled_by(view, camera_scale), true));
    header.insert("worldToNDC", matrix(ndc, row_vectors));
    settings.fov.reset();
    expect_refused(Reply::usage, {"worldToNDC", "and no lens", "--fov"});
    settings.fov = kFov;
    settings.normal_space = NormalSpace::world;
    expect_same("generic");
  }
}

TEST_F(HeaderCameras, an_orthographic_picture_as_wide_as_high_may_keep_shapes) {
  const Window square{0, 0, 100, 100};
  const AttributeTexts identity{{"worldToCamera", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"}};
  AttributeTexts texts = identity;
  texts["worldToNDC"] = "0.2 0 0 0 0 0.2 0 0 0 0 0.2 0 0 0 0 1";  // a cube of 10 units
  const auto found = header_camera(texts, square, square, 1, "");
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->camera.orthographic);
  EXPECT_NEAR(found->camera.fx, 10, 1e-9);
  EXPECT_FALSE(header_camera(texts, {0, 0, 160, 90}, square, 1, "")) << "pixels would not be square";
  texts["worldToNDC"] = texts["worldToCamera"];
  EXPECT_FALSE(header_camera(texts, square, square, 1, ""));
}

TEST_F(HeaderCameras, arnolds_plain_numbers_stand_for_a_missing_projection) {
  header.insert("worldToCamera", matrix(world_to_camera(-1), true));
  const Imf::Header placed = header;
  header.insert("worldToScreen", matrix(world_to_ndc(false), true));
  expect_same("generic");
  EXPECT_EQ(find_frame(settings, false, 0).camera_from, "the header's worldToCamera, worldToScreen");
  header = placed;
  header.insert("CameraFov", Imf::FloatAttribute(float(kFov)));
  expect_same("generic");
  header = placed;
  header.insert("CameraFocalLength", Imf::FloatAttribute(50));
  header.insert("CameraFilmApertureHorizontal",
                Imf::FloatAttribute(float(100 * std::tan(kFov / 2 * std::numbers::pi / 180))));
  expect_same("generic");
}

TEST_F(HeaderCameras, the_lens_of_unreal_is_that_of_the_depths_pass_and_camera) {
  const std::string depth = "FinalImageMovieRenderQueue_WorldDepth";
  struct Case {
    std::vector<std::pair<std::string, double>> lenses;
    std::string layer;
    double degrees;  // 0: refused
  };
  const Case cases[] = {
      {{{"camera/FinalImage", 50}}, depth, 50},
      {{{"camera/PathTracer", 50}}, depth, 50},
      {{{"camera/FinalImage", 50}, {"camera/PathTracer", 60}}, depth, 50},
      {{{"camera/FinalImage", 50}, {"camera/PathTracer", 60}}, "PathTracerMovieRenderQueue_WorldDepth", 60},
      {{{"camera/FinalImage", 50}, {"camera/PathTracer", 60}}, "WorldDepth", 0},
      {{{"camera/FinalImage", 50}, {"camera/PathTracer", 50}}, "WorldDepth", 50},
      {{{"camera", 70}, {"camera/FinalImage", 50}}, depth, 50},
      {{{"camera/FinalImage_Cine_A", 50}, {"camera/FinalImage_Cine_B", 60}}, depth + "_Cine_B", 60},
      {{{"camera/FinalImage_A", 50}, {"camera/FinalImage_B", 60}}, depth, 0},
      {{{"camera/FinalImage_A", 50}}, depth + "_B", 0},
      {{{"CamA/FinalImage", 50}, {"CamB/FinalImage", 60}, {"CamB/PathTracer", 70}}, depth + "_CamB", 60},
  };
  const Window window{0, 0, 160, 90};
  for (const auto& [lenses, layer, degrees] : cases) {
    AttributeTexts texts;
    for (const auto& [path, lens] : lenses) texts["unreal/" + path + "/fov"] = fmt::format("{}", lens);
    SCOPED_TRACE(fmt::format("{} lenses from {}, {}", lenses.size(), lenses[0].first, layer));
    const auto found = header_camera(texts, window, window, 1, layer);
    EXPECT_EQ(found.has_value(), degrees > 0);
    if (found) EXPECT_NEAR(found->camera.fx, 80 / std::tan(degrees * std::numbers::pi / 360), 1e-6);
    if (!found) EXPECT_THAT(why_no_header_camera(texts, layer), HasSubstr(lenses[0].first + "/fov of 50 degrees"));
  }
}

TEST_F(HeaderCameras, several_cameras_of_unreal_do_not_stand_in_one_place) {
  const std::string depth = "FinalImageMovieRenderQueue_WorldDepth_";
  AttributeTexts texts{{"unreal/camera/FinalImage_A/fov", "50"}};
  const auto stand_at = [&](const std::string& prefix, double x) {
    for (const char* name : {"curPos/y", "curPos/z", "curRot/yaw", "curRot/pitch", "curRot/roll"})
      texts["unreal/" + prefix + "/" + name] = "0";
    texts["unreal/" + prefix + "/curPos/x"] = fmt::format("{}", x);
  };
  const auto place = [&](const std::string& layer) {
    const auto found = header_camera(texts, {0, 0, 160, 90}, {0, 0, 160, 90}, 1, layer);
    return found && found->camera.view_from_world ? found->camera.view_from_world_offset[2] : NAN;
  };
  stand_at("camera", 7);
  EXPECT_EQ(place(depth + "A"), 7);
  texts["unreal/camera/FinalImage_B/fov"] = "50";
  EXPECT_TRUE(std::isnan(place(depth + "A")));
  texts["unreal/B/FinalImage/fov"] = "50";
  stand_at("B/FinalImage", 9);
  texts.erase("unreal/camera/FinalImage_B/fov");
  EXPECT_EQ(place(depth + "B"), 9);
}

TEST_F(HeaderCameras, pixels_of_another_shape_than_the_files_are_of_a_crop) {
  Rows ndc = world_to_ndc(true);
  for (double& x : ndc[1]) x *= 1.5;
  header.insert("worldToCamera", matrix(world_to_camera(-1), true));
  header.insert("worldToNDC", matrix(ndc, true));
  write(settings.input);
  EXPECT_THAT(texts_of(find_frame(settings, false, 0).notes),
              ElementsAre(AllOf(HasSubstr("the header's worldToCamera, worldToNDC"),
                                HasSubstr("1.5 times as wide as high"), HasSubstr("cropped"))));
  header.pixelAspectRatio() = 1.5;  // as of an anamorphic lens
  write(settings.input);
  EXPECT_THAT(find_frame(settings, false, 0).notes, IsEmpty());
}

TEST_F(HeaderCameras, panoramas_are_refused) {
  give_camera();
  header.insert("envmap", Imf::IntAttribute(1));
  expect_refused(Reply::refused, {"panorama", "frame.exr"});
  header.erase("envmap");
  header.insert("cameraProjection", Imf::IntAttribute(1));
  expect_refused(Reply::refused, {"panorama"});
}

// Matrices that place the camera, with a projection by options.

TEST_F(HeaderCameras, world_to_camera_alone_and_a_field_of_view_are_a_camera) {
  settings.fov = kFov;
  settings.normal_space = NormalSpace::world;
  for (const bool looks_along_z : {true, false})
    for (const bool row_vectors : {true, false}) {
      SCOPED_TRACE(fmt::format("looks along z: {}, row vectors: {}", looks_along_z, row_vectors));
      header.erase("worldToCamera");
      header.insert("worldToCamera", matrix(world_to_camera(looks_along_z ? -1 : 1), row_vectors));
      expect_same("generic");
      const FrameSource source = find_frame(settings, false, 0);
      EXPECT_EQ(source.reading.camera.left_handed, looks_along_z);
      EXPECT_EQ(source.reading.camera.placement_from, "worldToCamera");
    }
  settings.fov.reset();
  settings.focal = 50;
  settings.aperture = 100 * std::tan(kFov / 2 * std::numbers::pi / 180);
  expect_same("generic");
}

TEST_F(HeaderCameras, a_field_of_view_replaces_the_headers_and_leaves_the_camera_in_its_place) {
  add_matrices(header, true);
  settings.fov = 40;
  write(settings.input);
  const Camera chosen = find_frame(settings, false, 0).reading.camera;
  settings.fov.reset();
  const Camera own = find_frame(settings, false, 0).reading.camera;
  EXPECT_NEAR(chosen.fx, 80 / std::tan(20 * std::numbers::pi / 180), 1e-6);
  EXPECT_NE(chosen.fx, own.fx);
  ASSERT_TRUE(chosen.view_from_world.has_value());
  EXPECT_EQ(*chosen.view_from_world, own.view_from_world.value());
  EXPECT_EQ(chosen.view_from_world_offset, own.view_from_world_offset);
  EXPECT_EQ(chosen.left_handed, own.left_handed);
}

TEST_F(HeaderCameras, transforms_of_redshift_and_vray_place_a_camera_too) {
  settings.fov = kFov;
  settings.normal_space = NormalSpace::world;
  for (const auto& [name, sign] : {std::pair{"rs/camera/transform", -1.0}, {"cameraTransform", 1.0}}) {
    header.insert(name, matrix(camera_to_world(sign), true));
    write(settings.input);
    EXPECT_EQ(find_frame(settings, false, 0).reading.camera.placement_from, name);
    const Difference d = difference(ao_of(read_host_frame(settings, 0), 1), ao_of(rendering().frame, 1));
    EXPECT_LE(d.max, 1e-3) << name;
    header.erase(name);
  }
}

TEST_F(HeaderCameras, a_matrix_that_is_no_rotation_places_nothing) {
  settings.fov = kFov;
  settings.normal_space = NormalSpace::world;
  Rows sheared = world_to_camera(1);
  sheared[0][1] += 0.5;
  header.insert("worldToCamera", matrix(sheared, true));
  expect_refused(Reply::refused, {"world_to_camera"});
}

}  // namespace
}  // namespace alcove::header_camera_test
