// One scene as every program writes it gives the same AO, or is refused with the option that mends it; what is said
// wrongly is noted.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/source_frame.h"
#include "tests/support/test.h"

namespace alcove::sources_test {
namespace {

using namespace test;

TEST_F(Sources, arnold_without_flags) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  add_matrices(header, true);
  header.insert("arnold/camera/near_clip", Imf::FloatAttribute(0.1f));
  expect_same("arnold");
  EXPECT_EQ(find_frame(settings, false, 0).camera_from, "the header's worldToCamera, worldToNDC");
}

TEST_F(Sources, renderman_with_normals_in_camera_space) {
  depth("Z", planar, 1e38f);
  vectors("Nn", "XYZ", [](const test::Hit& hit) { return forward_z(view_normal(hit)); });
  add_matrices(header, false);
  header.insert("PixarRenderManVersion", Imf::StringAttribute("24"));
  expect_same("renderman");
}

TEST_F(Sources, vray_with_either_kind_of_depth) {
  header.insert("vrayInfo/vrayversion", Imf::StringAttribute("5"));
  header.insert("cameraTransform", matrix(camera_to_world(1), true));
  header.insert("cameraFov", Imf::FloatAttribute(float(kFov)));
  vectors("normals", "XYZ", view_normal);
  for (double (*value)(const test::Hit&) : {planar, ray}) {
    depth("VRayZDepth.R", value, 1e30f);
    expect_same("vray");
    EXPECT_EQ(settled().reading.depth_kind, value == planar ? DepthKind::planar : DepthKind::ray);
  }
}

TEST_F(Sources, cycles_and_blender_5_need_a_camera_and_no_more) {
  depth("ViewLayer.Depth.Z", planar, 1e10f);
  vectors("ViewLayer.Normal", "XYZ", world_normal);
  vectors("ViewLayer.Denoising Normal", "XYZ", view_normal);
  expect_refused(Reply::usage, {"--camera", "--fov"});
  give_camera();
  expect_same("cycles");
  vectors("ViewLayer.Diffuse Indirect", "RGB", world_normal);
  expect_same("blender5");
}

TEST_F(Sources, redshift_by_its_own_camera) {
  depth("Z", ray, 1e30f);
  vectors("N", "XYZ", world_normal);
  const Rows rows = camera_to_world(-1);
  std::vector<float> numbers;
  for (std::size_t i = 0; i < 4; i++)
    for (std::size_t j = 0; j < 4; j++) numbers.push_back(float(rows[j][i]));
  header.insert("rs/camera/transform", Imf::FloatVectorAttribute(numbers));
  header.insert("rs/camera/fov", Imf::FloatAttribute(float(kFov)));
  expect_same("redshift");
}

TEST_F(Sources, karma_and_mantra_by_matrices) {
  depth("Pz", planar, 0);
  vectors("N", "XYZ", world_normal);
  add_matrices(header, true);
  header.insert("Software", Imf::StringAttribute("Houdini 19.5 mantra"));
  expect_same("mantra");
  planes.erase("Pz");
  depth("hitdist", ray, 0);
  header.insert("Software", Imf::StringAttribute("Karma 19.5"));
  expect_same("karma");
}

TEST_F(Sources, karma_by_what_houdini_leaves_behind_other_programs_marks) {
  depth("Pz", planar, 0);
  vectors("hitN", "XYZ", world_normal);
  give_camera();
  header.insert("renderTime_s", Imf::StringAttribute("0:12.30"));
  expect_same("karma");
  header.insert("Software", Imf::StringAttribute("Houdini 19.5 mantra"));
  planes.erase("hitN.X");
  vectors("N", "XYZ", world_normal);
  expect_same("mantra");
}

TEST_F(Sources, mitsuba_with_aovs_of_any_name) {
  depth("dd.y", ray, 0);
  vectors("nn", "XYZ", world_normal);
  give_camera();
  header.insert("generatedBy", Imf::StringAttribute("Mitsuba version 2.2.1"));
  expect_same("mitsuba");
  header.erase("generatedBy");
  expect_same("mitsuba");
  planes.clear();
  depth("depth.T", ray, 0);
  vectors("sh_normal", "XYZ", world_normal);
  expect_same("mitsuba");
}

TEST_F(Sources, moge_by_name) {
  depth("Y", planar, INFINITY);
  write(folder / "depth.exr");
  settings.depth = folder / "depth.exr";
  planes.clear();
  vectors("normal", "RGB", [](const test::Hit& hit) {
    const Vec3 n = view_normal(hit);
    return Vec3{n.x, -n.y, -n.z};  // y down, z forward
  });
  settings.normal = settings.input;
  settings.input.clear();
  write(settings.normal);
  settings.source = "moge";
  settings.fov = kFov;
  const FrameSource source = settled();
  EXPECT_EQ(source.reading.depth_kind, DepthKind::planar);
  EXPECT_LE(difference(ao_of(read_host_frame(settings, 0), 1), ao_of(rendering().frame, 1)).max, 1e-3);
}

TEST_F(Sources, octane_with_distances_along_the_ray) {
  depth("Z-Depth.R", ray, 1e10f);
  give_camera();
  vectors("Ambient occlusion", "RGB", world_normal);
  expect_same("octane", 0.1);  // an info pass is no pass of Blender
  vectors("Shading normal", "RGB", world_normal);
  expect_same("octane");
}

TEST_F(Sources, corona_and_unity_need_the_planes_of_normalized_depth) {
  depth("CGeometry_ZDepth.R", planar, float(kFar), 1 / kFar);
  for (float& z : planes["CGeometry_ZDepth.R"]) z = std::min(z, 1.0f);
  vectors("CGeometry_NormalsShading", "RGB", world_normal);
  give_camera();
  expect_refused(Reply::usage, {"--far"});
  settings.depth_range.far = kFar;
  expect_same("corona");

  header.insert("Software", Imf::StringAttribute("Unity 2022"));
  planes = {{"R", planes["CGeometry_ZDepth.R"]}};
  settings.depth = folder / "depth.exr";
  write(settings.depth);
  planes.clear();
  vectors("normal", "RGB", world_normal, 0.5f, 0.5f);
  settings.normal = folder / "normal.exr";
  write(settings.normal);
  settings.input.clear();
  const FrameSource source = settled();
  EXPECT_EQ(source.program.rules->name, "unity");
  EXPECT_TRUE(source.reading.normal_unorm);
  EXPECT_LE(difference(ao_of(read_host_frame(settings, 0), 1), ao_of(rendering().frame, 1)).max, 1e-3);
}

TEST_F(Sources, three_delight_with_normals_that_say_their_space) {
  depth("z", planar, 1e30f);
  vectors("N.camera", "XYZ", view_normal);
  give_camera();
  header.insert("Software", Imf::StringAttribute("3Delight"));
  expect_same("3delight");
}

TEST_F(Sources, unreal_in_its_left_handed_world_and_half_depth) {
  depth("FinalImageMovieRenderQueue_WorldDepth.R", planar, INFINITY, 100);
  vectors("FinalImageMovieRenderQueue_WorldNormal", "RGB", [](const test::Hit& hit) { return mirrored(hit.normal); });
  const Vec3 forward = mirrored(-shot().back), eye = 100 * mirrored(shot().eye);
  const double degree = 180 / std::numbers::pi;
  const std::pair<const char*, double> numbers[] = {
      {"unreal/camera/curPos/x", eye.x},
      {"unreal/camera/curPos/y", eye.y},
      {"unreal/camera/curPos/z", eye.z},
      {"unreal/camera/curRot/yaw", degree * std::atan2(forward.y, forward.x)},
      {"unreal/camera/curRot/pitch", degree * std::asin(forward.z)},
      {"unreal/camera/curRot/roll", 0},
      {"unreal/camera/FinalImage/fov", kFov}};
  for (const auto& [name, value] : numbers) header.insert(name, Imf::StringAttribute(fmt::format("{}", value)));
  expect_same("unreal", 0.03, 100);  // half floats step by 0.25 cm here, and AO shows it
  EXPECT_THAT(texts_of(settled().suspicious), ElementsAre(HasSubstr("half float")));
}

TEST_F(Sources, unreal_with_several_cameras_needs_to_be_told_which) {
  const std::string pass = "FinalImageMovieRenderQueue_";
  depth(pass + "WorldDepth_Near.R", planar, 65504, 100);
  depth(pass + "WorldDepth_Far.R", planar, 65504, 1000);
  vectors(pass + "WorldNormal_Near", "RGB", world_normal);
  vectors(pass + "WorldNormal_Far", "RGB", world_normal);
  give_camera();
  expect_refused(Reply::refused, {pass + "WorldDepth_Near.R", pass + "WorldDepth_Far.R", "--depth-channel"});
  settings.depth_channel = pass + "WorldDepth_Near.R";
  write(settings.input);
  const FrameSource source = find_frame(settings, false, 0);
  EXPECT_EQ(source.program.rules->name, "unreal");
  EXPECT_EQ(source.channels[RawPlane::normal].at(0).channel, pass + "WorldNormal_Near.R");
}

TEST_F(Sources, nuke_with_inverse_depth_or_with_distances_that_went_through_it) {
  vectors("N", "XYZ", world_normal);
  give_camera();
  header.insert("nuke/version", Imf::StringAttribute("13.2"));
  for (const bool inverse : {false, true}) {
    depth("depth.Z", inverse ? +[](const test::Hit& hit) { return 1 / hit.distance; } : planar, inverse ? 0 : 1e12f);
    expect_same("nuke");
    expect(Reply::silent);
  }
  header.erase("nuke/version");
  expect_refused(Reply::refused, {"device", "inverse", "--depth-kind"});
}

TEST_F(Sources, nuke_without_flat_surfaces_is_read_as_its_normals_say) {
  vectors("N", "XYZ", world_normal);
  give_camera();
  header.insert("nuke/version", Imf::StringAttribute("13.2"));
  // Waves that are small enough for the normals, and large enough that nothing is straight.
  const auto wavy = [](const test::Hit& hit) { return hit.distance * (1 + 2e-3 * std::sin(40 * hit.position.x)); };
  depth(
      "depth.Z", +[](const test::Hit& hit) { return hit.distance; }, 0);
  for (const bool inverse : {true, false}) {
    auto& plane = planes["depth.Z"];
    for (std::size_t i = 0; i < plane.size(); i++) {
      const test::Hit& hit = rendering().hits[i];
      if (hit.primitive >= 0) plane[i] = float(inverse ? 1 / wavy(hit) : 0.1 * wavy(hit));
    }
    write(settings.input);
    EXPECT_EQ(settled().reading.depth_kind, inverse ? DepthKind::inverse : DepthKind::planar);
  }
  planes.erase("N.X");
  for (float& d : planes["depth.Z"]) d = 0.3f + 0.1f * d;
  expect_refused(Reply::refused,
                 {"nuke", "--depth-kind inverse", "--depth-kind normalized --near 0 --far", "--depth-kind disparity"});
}

TEST_F(Sources, pbrt_with_positions_and_matrices_for_column_vectors) {
  vectors("P", "XYZ", [](const test::Hit& hit) { return hit.position; });
  vectors("Ns", "XYZ", world_normal);
  planes["dzdx"].resize(160 * 120);
  add_matrices(header, false, false);
  expect_same("pbrt");
}

TEST_F(Sources, reshade_and_renderdoc_by_name) {
  const auto device = [](const test::Hit& hit) { return (1 / hit.distance - 1 / 1000.0) / (1 - 1 / 1000.0); };
  depth("R", device, 0);
  planes["R"].swap(planes["depth.R"]);
  vectors("N", "XYZ", view_normal);
  planes.erase("R");
  give_camera();
  expect_refused(Reply::refused, {"--near", "--reversed-z"});
  const std::string camera = std::exchange(settings.camera, "");
  settings.vertical_fov = 60;  // which is a lens and no place
  expect_refused(Reply::refused, {"--near", "--far", "--reversed-z", "world_to_camera"});
  settings.camera = camera;
  settings.vertical_fov.reset();
  settings.source = "reshade";
  expect_same("reshade");
  settings.source = "renderdoc";
  expect_refused(Reply::usage, {"--near, and --far"});
  settings.depth_range.near = 1;
  settings.depth_range.far = 1000;
  settings.depth_range.reversed = true;
  expect_same("renderdoc");
}

TEST_F(Sources, attributes_that_went_through_nuke_are_known) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  header.insert("nuke/exr/worldToCamera", matrix(world_to_camera(-1), true));
  header.insert("exr/worldToNDC", matrix(world_to_ndc(true), true));
  header.insert("exr/arnold/version", Imf::StringAttribute("7"));
  expect_same("arnold");
}

TEST_F(Sources, what_went_through_nuke_is_not_nukes) {
  depth("Z", planar, 1e12f);
  header.insert("nuke/version", Imf::StringAttribute("13.2"));
  settings.fov = kFov;
  write(settings.input);
  EXPECT_EQ(find_frame(settings, false, 0).program.rules->name, "nuke");
  for (const auto& [attribute, program] : {std::pair{"exr/vrayInfo/camera", "vray"},
                                           {"nuke/exr/rs/camera/aspect", "redshift"},
                                           {"exr/unreal/frame", "unreal"}}) {
    const Imf::Header before = header;
    header.insert(attribute, Imf::StringAttribute("1"));
    write(settings.input);
    EXPECT_EQ(find_frame(settings, false, 0).program.rules->name, program);
    header = before;
  }
}

TEST_F(Sources, a_matrix_for_another_depth_range_is_noted) {
  depth(
      "Z", [](const test::Hit& hit) { return 1 - 0.5 / hit.distance; }, 1);
  json camera = camera_of(shot());
  camera.update({{"near", 0.5}, {"far", "inf"}, {"depth_kind", "device"}});
  camera["projection"] = game_matrix(camera, {0, 0, 1, -1}, 1);
  give(camera);
  write(settings.input);
  EXPECT_THAT(texts_of(settled().notes), Contains(HasSubstr("2 times as large")));
  settings.depth_range.near = 1;
  EXPECT_THAT(texts_of(settled().notes), Contains(AllOf(HasSubstr("--near"), HasSubstr("2 times"))));
}

TEST(InputRules, all_names_are_there_and_unknown_ones_name_the_nearest) {
  for (const char* name : {"arnold",    "vray",
                           "renderman", "cycles",
                           "blender5",  "redshift",
                           "karma",     "mantra",
                           "octane",    "corona",
                           "3delight",  "unreal",
                           "unity",     "nuke",
                           "pbrt",      "mitsuba",
                           "moge",      "renderdoc",
                           "reshade",   "generic",
                           "depth-pro", "depth-anything-metric"})
    EXPECT_EQ(input_rules(name).name, name);
  expect_error(ErrorKind::usage, {"arnold"}, [] { input_rules("arnlod"); });
  EXPECT_THROW(parse_input_rules("x", "depth-kind = \"sideways\""), Error);
  EXPECT_THROW(parse_input_rules("x", "depth-kind = \"position\""), Error) << "positions have channels of their own";
  EXPECT_THROW(parse_input_rules("x", "depth-kin = \"ray\""), Error);
}

}  // namespace
}  // namespace alcove::sources_test
