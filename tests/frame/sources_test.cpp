// One scene as every program writes it gives the same AO, or is refused with the option that mends it; what is said
// wrongly is noted.
// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/base/error.h"
#include "core/frame/input_rules.h"
#include "core/frame/settle.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/program.h"
#include "tests/support/scenes.h"
#include "tests/support/settled.h"

namespace alcove {
namespace {

using namespace test;
using testing::HasSubstr;

constexpr double kFov = 60, kFar = 50;

/// A floor, two walls and a ball under sky.
const Rendering& rendering() {
  static const Rendering made = render(
      Scene{{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
             parallelogram({0, 2, 0}, {4, 0, 0}, {0, 0, 1.5}), Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}}},
      Shot::perspective({4.5, -1.5, 2.4}, {1, 0, 0.6}, kFov, 160, 120));
  return made;
}

const Shot& shot() { return rendering().shot; }
Vec3 mirrored(Vec3 v) { return {v.x, -v.y, v.z}; }
Vec3 in_view(Vec3 world) { return shot().view_from_world(world); }
Vec3 forward_z(Vec3 view) { return {view.x, view.y, -view.z}; }
double planar(const test::Hit& hit) { return hit.distance; }
double ray(const test::Hit& hit) { return length(hit.position - shot().eye); }

using Rows = std::array<std::array<double, 4>, 4>;  // for column vectors

/// World to a camera space that looks along +z (sign -1) or -z (sign 1).
Rows world_to_camera(double sign) {
  const Vec3 axes[] = {shot().right, shot().up, sign * shot().back};
  Rows rows{};
  for (std::size_t i = 0; i < 3; i++) rows[i] = {axes[i].x, axes[i].y, axes[i].z, -dot(axes[i], shot().eye)};
  rows[3] = {0, 0, 0, 1};
  return rows;
}

Rows camera_to_world(double sign) {
  const Vec3 axes[] = {shot().right, shot().up, sign * shot().back};
  return {{{axes[0].x, axes[1].x, axes[2].x, shot().eye.x},
           {axes[0].y, axes[1].y, axes[2].y, shot().eye.y},
           {axes[0].z, axes[1].z, axes[2].z, shot().eye.z},
           {0, 0, 0, 1}}};
}

/// World to NDC, through a camera that looks along +z: from 0 with y down, or from -1 with y up.
Rows world_to_ndc(bool from_zero) {
  const Rows view = world_to_camera(-1);
  const Camera& c = shot().camera;
  const double x = c.fx / c.width, y = c.fy / c.height;
  const Rows projection = from_zero ? Rows{{{x, 0, 0.5, 0}, {0, -y, 0.5, 0}, {0, 0, 1.001, -0.1}, {0, 0, 1, 0}}}
                                    : Rows{{{2 * x, 0, 0, 0}, {0, 2 * y, 0, 0}, {0, 0, 1.001, -0.1}, {0, 0, 1, 0}}};
  Rows product{};
  for (std::size_t i = 0; i < 4; i++)
    for (std::size_t j = 0; j < 4; j++)
      for (std::size_t k = 0; k < 4; k++) product[i][j] += projection[i][k] * view[k][j];
  return product;
}

Imf::M44fAttribute matrix(const Rows& rows, bool row_vectors) {
  Imath::M44f m;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      m[i][j] = float(row_vectors ? rows[std::size_t(j)][std::size_t(i)] : rows[std::size_t(i)][std::size_t(j)]);
  return Imf::M44fAttribute(m);
}

void add_matrices(Imf::Header& header, bool from_zero, bool row_vectors = true) {
  header.insert("worldToCamera", matrix(world_to_camera(-1), row_vectors));
  header.insert("worldToNDC", matrix(world_to_ndc(from_zero), row_vectors));
}

/// A frame as a program writes it: planes by name, attributes, and how it must be read.
class Sources : public testing::Test {
 protected:
  Sources() : header(160, 120) { settings.input = folder / "frame.exr"; }

  void depth(const std::string& channel, double (*value)(const test::Hit&), float sky, double scale = 1) {
    auto& plane = planes[channel];
    for (const auto& hit : rendering().hits) plane.push_back(hit.primitive < 0 ? sky : float(scale * value(hit)));
  }

  void vectors(const std::string& layer, const char* components, const std::function<Vec3(const test::Hit&)>& value,
               float offset = 0, float scale = 1) {
    for (const auto& hit : rendering().hits) {
      const Vec3 v = hit.primitive < 0 ? Vec3{} : value(hit);
      const double xyz[] = {v.x, v.y, v.z};
      for (int c = 0; c < 3; c++)
        planes[layer + "." + components[c]].push_back(hit.primitive < 0 ? 0 : float(offset + scale * xyz[c]));
    }
  }

  static Vec3 world_normal(const test::Hit& hit) { return hit.normal; }
  static Vec3 view_normal(const test::Hit& hit) { return in_view(hit.normal); }

  void write(const std::string& path) {
    Imf::Header h = header;
    Imf::FrameBuffer buffer;
    std::vector<std::vector<half>> halves;
    for (auto& [name, plane] : planes) {
      const bool is_half = name.ends_with("WorldDepth.R");
      h.channels().insert(name, Imf::Channel(is_half ? Imf::HALF : Imf::FLOAT));
      if (is_half) halves.emplace_back(plane.begin(), plane.end());
      char* base = is_half ? reinterpret_cast<char*>(halves.back().data()) : reinterpret_cast<char*>(plane.data());
      const std::size_t bytes = is_half ? 2 : 4;
      buffer.insert(name, Imf::Slice(is_half ? Imf::HALF : Imf::FLOAT, base, bytes, bytes * 160));
    }
    Imf::OutputFile file(path.c_str(), h);
    file.setFrameBuffer(buffer);
    file.writePixels(120);
  }

  /// The camera file of the scene, for programs that write none.
  void give_camera() {
    const Rows rows = world_to_camera(1);
    const Camera& c = shot().camera;
    std::string text = fmt::format(
        R"({{"resolution": [160, 120], "fx": {}, "fy": {}, "cx": 80, "cy": 60, "world_to_camera": [)", c.fx, c.fy);
    for (std::size_t i = 0; i < 4; i++) text += fmt::format("{}[{}]", i ? ", " : "", fmt::join(rows[i], ", "));
    settings.camera = folder / "camera.json";
    write_bytes(settings.camera, text + "]}");
  }

  FrameSource settled() const { return test::settled(settings); }

  static std::vector<float> ao_of(const HostFrame& frame, double scale) {
    EstimatorSettings estimator = plain_settings();
    estimator.radius = 1e3 * scale;
    return compute_ao(recorder(), frame, estimator).ao;
  }

  /// Written, detected as that program's, and the AO of the rendering.
  void expect_same(const std::string& program, double tolerance = 1e-3, double scale = 1) {
    write(settings.input);
    SCOPED_TRACE(program);
    const FrameSource source = settled();
    EXPECT_EQ(source.rules->name, program);
    const Difference d = difference(ao_of(read_host_frame(settings, 0), scale), ao_of(rendering().frame, 1));
    EXPECT_LE(tolerance > 1e-3 ? d.rmse : d.max, tolerance) << place(d, rendering().frame);
  }

  void expect_refused(ErrorKind kind, const std::vector<std::string>& words) {
    write(settings.input);
    try {
      settled();
      read_host_frame(settings, 0);
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind);
      for (const auto& word : words) EXPECT_THAT(error.what(), HasSubstr(word));
    }
  }

  TemporaryFolder folder;
  InputSettings settings;
  Imf::Header header;
  std::map<std::string, std::vector<float>> planes;
};

TEST_F(Sources, arnold_without_flags) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  add_matrices(header, true);
  header.insert("arnold/camera/near_clip", Imf::FloatAttribute(0.1f));
  expect_same("arnold");
  EXPECT_EQ(find_frame(settings, false, 0).camera_from, "worldToCamera, worldToNDC");
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
    planes.erase("VRayZDepth.R");
    depth("VRayZDepth.R", value, 1e30f);
    expect_same("vray");
    EXPECT_EQ(settled().depth_kind, value == planar ? DepthKind::planar : DepthKind::ray);
  }
}

TEST_F(Sources, cycles_and_blender_5_need_a_camera_and_no_more) {
  depth("ViewLayer.Depth.Z", planar, 1e10f);
  vectors("ViewLayer.Normal", "XYZ", world_normal);
  vectors("ViewLayer.Denoising Normal", "XYZ", view_normal);
  expect_refused(ErrorKind::usage, {"--camera", "--fov"});
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

TEST_F(Sources, octane_with_distances_along_the_ray) {
  depth("Z-Depth.R", ray, 1e10f);
  vectors("Shading normal", "RGB", world_normal);
  give_camera();
  expect_same("octane");
}

TEST_F(Sources, corona_and_unity_need_the_planes_of_normalized_depth) {
  depth("CGeometry_ZDepth.R", planar, float(kFar), 1 / kFar);
  for (float& z : planes["CGeometry_ZDepth.R"]) z = std::min(z, 1.0f);
  vectors("CGeometry_NormalsShading", "RGB", world_normal);
  give_camera();
  expect_refused(ErrorKind::usage, {"--far"});
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
  EXPECT_EQ(source.rules->name, "unity");
  EXPECT_TRUE(source.normal_unorm);
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
  EXPECT_THAT(settled().suspicious, testing::ElementsAre(HasSubstr("half float")));
}

TEST_F(Sources, nuke_with_inverse_depth) {
  depth(
      "depth.Z", [](const test::Hit& hit) { return 1 / hit.distance; }, 0);
  vectors("N", "XYZ", world_normal);
  give_camera();
  header.insert("nuke/version", Imf::StringAttribute("13.2"));
  settings.depth_range.near = std::nullopt;
  expect_refused(ErrorKind::input, {"device", "inverse", "--depth-kind"});
  settings.depth_kind = DepthKind::inverse;
  expect_same("nuke");
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
  expect_refused(ErrorKind::input, {"--near", "--reversed-z"});
  settings.source = "reshade";
  expect_same("reshade");
  settings.source = "renderdoc";
  expect_refused(ErrorKind::usage, {"--near"});
  settings.depth_range.near = 1, settings.depth_range.far = 1000, settings.depth_range.reversed = true;
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
  EXPECT_EQ(find_frame(settings, false, 0).rules->name, "nuke");
  for (const auto& [attribute, program] : {std::pair{"exr/vrayInfo/camera", "vray"},
                                           {"nuke/exr/rs/camera/aspect", "redshift"},
                                           {"exr/unreal/frame", "unreal"}}) {
    const Imf::Header before = header;
    header.insert(attribute, Imf::StringAttribute("1"));
    write(settings.input);
    EXPECT_EQ(find_frame(settings, false, 0).rules->name, program);
    header = before;
  }
}

TEST_F(Sources, an_info_pass_of_octane_is_no_pass_of_blender) {
  depth("Z-Depth.R", ray, 1e10f);
  vectors("Ambient occlusion", "RGB", world_normal);
  give_camera();
  expect_same("octane", 0.1);
}

TEST_F(Sources, standard_attributes_give_a_camera) {
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

TEST_F(Sources, lens_shift_pixel_aspect_and_overscan_are_in_the_matrices) {
  depth("Z", planar, 1e12f);
  const Rows view = world_to_camera(-1);
  Rows ndc = world_to_ndc(true);
  for (std::size_t j = 0; j < 4; j++)
    ndc[0][j] += 0.1 * ndc[3][j], ndc[1][j] = 2 * (ndc[1][j] - 0.5 * ndc[3][j]) + 0.4 * ndc[3][j];
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

TEST_F(Sources, an_orthographic_projection_is_known_by_its_matrix) {
  depth("Z", planar, 1e12f);
  const Rows view = world_to_camera(-1);
  Rows ndc{};
  for (std::size_t j = 0; j < 4; j++)
    ndc[0][j] = view[0][j] / 8, ndc[1][j] = -view[1][j] / 6, ndc[2][j] = view[2][j] / 100;
  ndc[0][3] += 0.5, ndc[1][3] += 0.5, ndc[3] = {0, 0, 0, 1};
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

TEST_F(Sources, panoramas_are_refused) {
  depth("Z", planar, 1e12f);
  give_camera();
  header.insert("envmap", Imf::IntAttribute(1));
  expect_refused(ErrorKind::input, {"panorama", "frame.exr"});
  header.erase("envmap");
  header.insert("cameraProjection", Imf::IntAttribute(1));
  expect_refused(ErrorKind::input, {"panorama"});
}

TEST_F(Sources, every_wrong_reading_that_is_forced_is_noted) {
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", world_normal);
  give_camera();
  write(settings.input);
  EXPECT_THAT(settled().notes, testing::IsEmpty());
  const InputSettings right = settings;
  const auto expect_noted = [&](const char* what, const char* option,
                                const std::function<void(InputSettings&)>& wrong) {
    settings = right;
    wrong(settings);
    std::vector<std::string> notes;
    try {
      notes = settled().notes;
    } catch (const Error& error) {
      notes = {error.what()};
    }
    EXPECT_THAT(notes, testing::Contains(HasSubstr(option))) << what;
  };
  expect_noted("ray", "--depth-kind", [](InputSettings& s) { s.depth_kind = DepthKind::ray; });
  expect_noted("inverse", "--depth-kind", [](InputSettings& s) { s.depth_kind = DepthKind::inverse; });
  expect_noted("device", "--depth-kind", [](InputSettings& s) {
    s.depth_kind = DepthKind::device, s.depth_range.near = 1, s.depth_range.far = 10;
  });
  expect_noted("normalized", "--depth-kind",
               [](InputSettings& s) { s.depth_kind = DepthKind::normalized, s.depth_range.far = 10; });
  expect_noted("log", "--depth-kind", [](InputSettings& s) { s.depth_kind = DepthKind::log, s.depth_range.far = 10; });
  expect_noted("view normals", "--normal-space", [](InputSettings& s) { s.normal_space = NormalSpace::view; });
  for (const NormalFlips flips :
       {NormalFlips{true, false, false}, NormalFlips{false, true, false}, NormalFlips{false, false, true}})
    expect_noted(flips.x   ? "x"
                 : flips.y ? "y"
                           : "z",
                 "--flip-normal",
                 [&](InputSettings& s) { s.normal_space = NormalSpace::world, s.flip_normal = flips; });
  for (const NormalEncoding encoding : {NormalEncoding::unorm, NormalEncoding::octahedral, NormalEncoding::spheremap})
    expect_noted("encoding", "--normal",
                 [&](InputSettings& s) { s.normal_space = NormalSpace::world, s.normal_encoding = encoding; });
}

TEST_F(Sources, a_matrix_for_another_depth_range_is_noted) {
  depth(
      "Z", [](const test::Hit& hit) { return 1 - 0.5 / hit.distance; }, 1);
  give_camera();
  std::string text = read_bytes(settings.camera);
  text.insert(
      1,
      R"("near": 0.5, "far": "inf", "depth_kind": "device", "projection": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -1], [0, 0, 1, 0]], )");
  write_bytes(settings.camera, text);
  write(settings.input);
  EXPECT_THAT(settled().notes, testing::Contains(HasSubstr("2 times as large")));
  settings.depth_range.near = 1;
  EXPECT_THAT(settled().notes, testing::Contains(testing::AllOf(HasSubstr("--near"), HasSubstr("2 times"))));
}

TEST(InputRules, all_names_are_there_and_unknown_ones_name_the_nearest) {
  for (const char* name : {"arnold", "vray", "renderman", "cycles", "blender5", "redshift", "karma", "mantra", "octane",
                           "corona", "3delight", "unreal", "unity", "nuke", "pbrt", "renderdoc", "reshade", "generic"})
    EXPECT_EQ(input_rules(name).name, name);
  try {
    input_rules("arnlod");
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("arnold"));
  }
  EXPECT_THROW(parse_input_rules("x", "depth-kind = \"sideways\""), Error);
  EXPECT_THROW(parse_input_rules("x", "depth-kin = \"ray\""), Error);
}

}  // namespace
}  // namespace alcove
