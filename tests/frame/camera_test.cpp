// Camera files, cameras from numbers, and the projection that kernels are given.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/camera.h"

#include "tests/support/program.h"
#include "tests/support/test.h"
#include "tests/support/wall_frame.h"

namespace alcove::camera_test {
namespace {

using namespace test;

constexpr Window kDisplay{0, 0, 64, 36};

class CameraFiles : public testing::Test {
 protected:
  Camera read(const std::string& text, int frame = 0) const {
    write_bytes(file, text);
    return read_camera(file, frame);
  }
  Camera read(const json& fields, int frame = 0) const { return read(fields.dump(), frame); }

  /// Reading must fail with ErrorKind::input, in one line that names the file and this.
  void expect_refused(const std::string& text, const std::string& word, int frame = 0) const {
    SCOPED_TRACE(text);
    expect_error(ErrorKind::input, {"camera.json", word}, [&] { read(text, frame); });
  }

  /// As above, with one field of a good camera replaced.
  void expect_field_refused(const char* field, const json& value) const {
    json fields = wall_camera();
    fields[field] = value;
    expect_refused(fields.dump(), field);
  }

  TemporaryFolder folder;
  const std::string file = folder / "camera.json";
};

void expect_near(const Camera& camera, double fx, double fy, double cx, double cy) {
  EXPECT_NEAR(camera.fx, fx, 1e-9 * fx);
  EXPECT_NEAR(camera.fy, fy, 1e-9 * fy);
  EXPECT_NEAR(camera.cx, cx, 1e-9);
  EXPECT_NEAR(camera.cy, cy, 1e-9);
}

TEST_F(CameraFiles, a_camera_is_read_as_it_is_written) {
  json fields = wall_camera();
  fields["cx"] = 30.25;
  fields["cy"] = -4;
  fields["depth"] = "Ray, from the eye";
  fields["normal_space"] = "camera";
  const Camera camera = read(fields);
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.height, 36);
  expect_near(camera, 60, 60, 30.25, -4);
  EXPECT_FALSE(camera.orthographic);
  EXPECT_EQ(camera.depth_kind, DepthKind::ray);
  EXPECT_EQ(camera.normal_space, NormalSpace::view);
  ASSERT_TRUE(camera.view_from_world);
  EXPECT_EQ(*camera.view_from_world, (Matrix3{{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}}));
}

TEST_F(CameraFiles, clip_planes_and_the_conventions_of_games_are_read) {
  json fields = wall_camera();
  fields["depth_kind"] = "device";
  fields["near"] = 0.25;
  fields["far"] = "inf";
  fields["reversed_z"] = true;
  fields["normal_encoding"] = "spheremap (two channels)";
  fields["projection"] = {{1.875, 0, 0, 0}, {0, 60 / 18., 0, 0}, {0, 0, 0, 0.25}, {0, 0, 1, 0}};
  const Camera camera = read(fields);
  EXPECT_EQ(camera.depth_kind, DepthKind::device);
  EXPECT_EQ(camera.near, 0.25);
  EXPECT_TRUE(camera.far && std::isinf(*camera.far));
  EXPECT_TRUE(camera.reversed_z);
  EXPECT_EQ(camera.normal_encoding, NormalEncoding::spheremap);
  EXPECT_FALSE(camera.orthographic);
  fields["projection"][3] = {0, 0, 0, 1};
  EXPECT_TRUE(read(fields).orthographic);
  for (const char* field : {"near", "far"}) expect_field_refused(field, -1);
  for (const char* field : {"reversed_z", "normal_encoding", "depth_kind", "camera_space"})
    expect_field_refused(field, "nonsense");
}

/// A camera file of a game: no fx, fy, cx and cy, but a matrix.
json game_camera(const json& projection) { return {{"resolution", {64, 36}}, {"projection", projection}}; }

TEST_F(CameraFiles, the_matrix_of_a_game_is_its_lens) {
  // A point at (x, y, -z) of OpenGL's camera space is seen at 32 + 32 (2 x / z - 0.25) and 18 - 18 (3 y / z - 0.5).
  const json opengl = {{2, 0, 0.25, 0}, {0, 3, 0.5, 0}, {0, 0, -1, -0.2}, {0, 0, -1, 0}};
  const Camera camera = read(game_camera(opengl));
  expect_near(camera, 64, 54, 24, 27);
  EXPECT_FALSE(camera.left_handed);
  // Direct3D looks along +z, where the same shift has another sign.
  json direct3d = opengl;
  direct3d[0][2] = -0.25, direct3d[1][2] = -0.5, direct3d[3][2] = 1;
  expect_near(read(game_camera(direct3d)), 64, 54, 24, 27);
  EXPECT_TRUE(read(game_camera(direct3d)).left_handed);
  // Vulkan's y points down the picture.
  json vulkan = opengl;
  vulkan[1] = {0, -3, -0.5, 0};
  expect_near(read(game_camera(vulkan)), 64, 54, 24, 27);
  const json parallel = {{0.5, 0, 0, 0.25}, {0, 1, 0, -0.5}, {0, 0, -0.1, 0}, {0, 0, 0, 1}};
  expect_near(read(game_camera(parallel)), 16, 18, 40, 27);
  EXPECT_TRUE(read(game_camera(parallel)).orthographic);
}

TEST_F(CameraFiles, what_the_file_says_wins_over_the_matrix_of_a_game) {
  json fields = game_camera({{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 1, -0.2}, {0, 0, 1, 0}});
  fields["camera_space"] = "right-handed";
  EXPECT_FALSE(read(fields).left_handed);
  fields["fx"] = fields["fy"] = 60, fields["cx"] = 32;
  expect_refused(fields.dump(), "\"cy\" is missing");
}

TEST_F(CameraFiles, a_lens_beside_a_matrix_is_that_of_the_matrix) {
  json fields = game_camera({{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 1, -0.2}, {0, 0, 1, 0}});
  const json lens{{"fx", 64}, {"fy", 54.2}, {"cx", 32.4}, {"cy", 18}};
  fields.update(lens);
  expect_near(read(fields), 64, 54.2, 32.4, 18);
  for (const auto& [field, value] : {std::pair("fx", 60.), {"fy", 60.}, {"cx", 30.}, {"cy", 20.}}) {
    json other = fields;
    other[field] = value;
    expect_refused(other.dump(), fmt::format("\"{}\" is {}, but the \"projection\" shows", field, value));
  }
}

TEST_F(CameraFiles, planes_of_a_reversed_matrix_are_those_of_the_depth) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto expect_planes = [&](const json& third, int side, int up, double near, double far) {
    const Camera camera = read(game_camera({{2, 0, 0, 0}, {0, 3 * up, 0, 0}, third, {0, 0, side, 0}}));
    ASSERT_TRUE(camera.near && camera.far) << third;
    EXPECT_NEAR(*camera.near, near, 1e-9);
    if (std::isinf(far))
      EXPECT_EQ(*camera.far, far);
    else
      EXPECT_NEAR(*camera.far, far, 1e-6);
    EXPECT_TRUE(camera.reversed_z);
  };
  const double near = 0.5, far = 200, scale = far / (far - near);
  expect_planes({0, 0, 0, near}, 1, 1, near, infinity);               // Unreal
  expect_planes({0, 0, 0, near}, -1, 1, near, infinity);              // the same along -z
  expect_planes({0, 0, 1 - scale, near * scale}, 1, 1, near, far);    // reversed
  expect_planes({0, 0, scale - 1, near * scale}, -1, -1, near, far);  // of Vulkan
  json said = game_camera({{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 0, 0.5}, {0, 0, 1, 0}});
  said["near"] = 2;
  EXPECT_EQ(read(said).near, 2) << "what the file says wins";
}

// Also one that looks along +z, or whose y points down, may be of OpenGL's depth.
TEST_F(CameraFiles, a_matrix_that_is_not_reversed_has_two_near_planes) {
  const double near = 0.5, far = 200, scale = far / (far - near);
  for (const auto& [up, side] : {std::pair(1, -1), {1, 1}, {-1, -1}}) {
    const json third = {0, 0, side * scale, -near * scale};
    const Camera camera = read(game_camera({{2, 0, 0, 0}, {0, 3 * up, 0, 0}, third, {0, 0, side, 0}}));
    EXPECT_FALSE(camera.near || camera.far || camera.reversed_z) << third;
    EXPECT_NEAR(camera.matrix_near.value(), near, 1e-9);
    EXPECT_NEAR(camera.matrix_near_opengl.value(), near * scale / (scale + 1), 1e-9);
    EXPECT_NEAR(camera.matrix_far.value(), far, 1e-6);
  }
}

TEST_F(CameraFiles, a_matrix_that_is_no_upright_lens_is_refused) {
  const json good = {{2, 0, 0.25, 0}, {0, 3, 0, 0}, {0, 0, -1, -0.2}, {0, 0, -1, 0}};
  json transposed = good;
  for (std::size_t i = 0; i < 4; i++)
    for (std::size_t j = 0; j < 4; j++) transposed[i][j] = good[j][i];
  expect_refused(game_camera(transposed).dump(), "transpose");
  // With a near plane at 1 its last row is that of column vectors.
  expect_refused(game_camera({{2, 0, 0, 0}, {0, 3, 0, 0}, {0.25, 0, 0, -1}, {0, 0, -1, 0}}).dump(), "transpose");
  expect_refused(game_camera({{2, 0, 0, 0.5}, {0, 3, 0, 0}, {0, 0, 0, 1}, {0, 0, 1, 0}}).dump(), "transpose");
  json turned = good, mirrored = good, rows = good, flat = good;
  turned[0][1] = 1, mirrored[0][0] = -2, rows[3] = {0, 0, -1}, flat[0][0] = 1e-30;
  expect_refused(game_camera(turned).dump(), "turns or mirrors");
  expect_refused(game_camera(mirrored).dump(), "turns or mirrors");
  expect_refused(game_camera(rows).dump(), "4 rows of 4");
  expect_refused(game_camera(flat).dump(), "sees nothing");
}

TEST_F(CameraFiles, a_lens_beside_a_matrix_that_shows_none_is_taken) {
  const json lens{{"fx", 64}, {"fy", 54}, {"cx", 24}, {"cy", 27}};
  const json reversed = {{2, 0, 0.25, 0}, {0, 3, 0, 0}, {0, 0, 0, 0.5}, {0, 0, -1, 0}};
  json mirrored = reversed, oblique = reversed, transposed = reversed;
  mirrored[0][0] = -2, oblique[2][0] = 0.1;
  for (std::size_t i = 0; i < 4; i++)
    for (std::size_t j = 0; j < 4; j++) transposed[i][j] = reversed[j][i];
  for (const json& matrix : {mirrored, oblique, transposed}) {
    json fields = game_camera(matrix);
    fields.update(lens);
    const Camera camera = read(fields);
    expect_near(camera, 64, 54, 24, 27);
    EXPECT_EQ(camera.near, matrix == mirrored ? std::optional(0.5) : std::nullopt) << matrix << " gives no depth";
  }
}

TEST_F(CameraFiles, a_matrix_may_be_rounded) {
  const json rounded = {{2, 1e-9, 0.25, -1e-9}, {1e-9, 3, 0, 0}, {1e-9, 0, 0, 0.5}, {1e-9, 0, -1, 1e-9}};
  const Camera camera = read(game_camera(rounded));
  expect_near(camera, 64, 54, 24, 18);
  EXPECT_EQ(camera.near, 0.5);
}

TEST_F(CameraFiles, a_left_handed_camera_space_is_turned_to_look_along_minus_z) {
  json fields = wall_camera();
  fields["world_to_camera"] = {{1, 0, 0, 1}, {0, 1, 0, 2}, {0, 0, -1, 3}, {0, 0, 0, 1}};
  expect_refused(fields.dump(), "world_to_camera");
  fields["camera_space"] = "left-handed: x right, y up, z forward";
  const Camera camera = read(fields);
  EXPECT_EQ(*camera.view_from_world, (Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}));
  EXPECT_EQ(camera.view_from_world_offset, (std::array<double, 3>{1, 2, -3}));
  EXPECT_EQ(view_from_normal(camera, NormalSpace::view, {}), (Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}}));
}

TEST_F(CameraFiles, optional_fields_may_be_missing) {
  const Camera camera = read(json{{"resolution", {64, 36}}, {"fx", 60}, {"fy", 60}, {"cx", 32}, {"cy", 18}});
  EXPECT_FALSE(camera.orthographic);
  EXPECT_FALSE(camera.view_from_world);
  EXPECT_EQ(camera.depth_kind, DepthKind::automatic);
  EXPECT_EQ(camera.normal_space, NormalSpace::automatic);
}

TEST_F(CameraFiles, a_uniform_scale_is_divided_out_of_the_rotation_which_may_be_rounded) {
  json fields = wall_camera();
  fields["world_to_camera"] = {{0, 100, 0, 7}, {0, 0, 100, 8}, {100, 0, 0, 9}, {0, 0, 0, 1}};
  EXPECT_EQ(read(fields).view_from_world, (Matrix3{{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}}));
  const double c = float(std::cos(0.3)), s = float(std::sin(0.3));
  fields["world_to_camera"] = {{c, s, 0, 0}, {-s, c, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  EXPECT_NO_THROW(read(fields));
}

TEST_F(CameraFiles, the_frames_own_entry_wins) {
  json fields = wall_camera();
  fields["frames"] = {{{"frame", 7}, {"fx", 70}}, {{"frame", -8}, {"fx", 80}, {"projection", "orthographic"}}};
  EXPECT_EQ(read(fields, 7).fx, 70);
  EXPECT_EQ(read(fields, 7).fy, 60) << "what the entry does not say stands above";
  EXPECT_EQ(read(fields, -8).fx, 80);
  EXPECT_TRUE(read(fields, -8).orthographic);
  expect_refused(fields.dump(), "frames", 9);
  json wrong = fields;
  wrong["frames"][0]["fx"] = "wide";
  expect_refused(wrong.dump(), "\"fx\" of frame 7 must", 7);
  for (const auto* field : {"fx", "fy", "cx", "cy", "resolution"}) {
    fields["frames"][0][field] = fields[field];
    fields.erase(field);
  }
  EXPECT_EQ(read(fields, 7).fx, 60) << "an entry may say everything";
  expect_refused(fields.dump(), "missing", -8);
}

TEST_F(CameraFiles, text_that_is_no_camera_is_refused_with_what_is_taken) {
  for (const char* text : {"", " ", "{", "{}x", "[]", "7", "null", "\"fx\"", "{\"fx\": NaN}",
                           "{\"fx\": 1e999, \"fy\": 1}", "{'fx': 1}", "\xff\xfe{}", "{\"fx\": \"\xff\"}"})
    expect_refused(text, "JSON");
  expect_refused(std::string(100000, '['), "JSON");
  expect_refused("{\"fx\": 1,\n\n\"fy\": }", "line 3 is no JSON");
  for (const char* text : {"Camera2 {\n focal 50\n}\n", "Kaydara FBX Binary", "#usda 1.0", "[1, 2]"}) {
    expect_refused(text, ".chan");
    expect_refused(text, "docs/inputs.md");
  }
  for (const char* field : {"resolution", "fx", "fy", "cx", "cy"}) {
    json fields = wall_camera();
    fields.erase(field);
    expect_refused(fields.dump(), field);
  }
}

TEST_F(CameraFiles, those_of_other_programs_are_known_by_name) {
  for (const auto& [text, word] :
       {std::pair(R"({"camera_angle_x": 0.9, "frames": [{"file_path": "r_7", "transform_matrix": [[1, 0]]}]})",
                  "inverse"),
        std::pair(R"({"camera_angle_x": 0.9, "w": 64})", "transforms.json"),
        std::pair(R"({"views": [], "intrinsics": [], "poses": []})", "Meshroom"),
        std::pair(R"([{"cameras": {}, "shots": {}}])", "OpenSfM"),
        std::pair(R"({"intrinsic": {"intrinsic_matrix": []}, "extrinsic": []})", "Open3D"),
        std::pair("# Camera list with one line of data per camera:\n", "cameras.txt"), std::pair("PXR-USDC\1", "USD"),
        std::pair("Ogawa\xff\1", "Alembic")})
    expect_refused(text, word);
}

TEST_F(CameraFiles, senseless_fields_are_refused) {
  const json wrong_numbers[] = {"NaN", "60", nullptr, true, json::array({60}), json::object()};
  for (const char* field : {"fx", "fy", "cx", "cy"})
    for (const json& value : wrong_numbers) expect_field_refused(field, value);
  for (const char* field : {"fx", "fy", "pixel_aspect"})
    for (const double value : {0.0, -1.0}) expect_field_refused(field, value);
  for (const char* field : {"fx", "fy"})
    for (const double value : {1e-40, 1e40}) expect_field_refused(field, value);
  for (const char* field : {"cx", "cy"})
    for (const double value : {-1e10, 1e300}) expect_field_refused(field, value);
  for (const json& value : {json{0, 5}, json{64, -36}, json{64}, json{64, 36, 1}, json{64.5, 36}, json{"64", "36"},
                            json("64x36"), json(64), json{64, 1 << 30}, json{9e99, 1}})
    expect_field_refused("resolution", value);
  for (const json& value : {json("panoramic"), json(1), json("persp")}) expect_field_refused("projection", value);
  for (const json& value : {json("deep"), json(1)}) expect_field_refused("depth", value);
  for (const json& value : {json("tangent"), json(false)}) expect_field_refused("normal_space", value);
  for (const json& value : {json("1-10"), json(7), json{1, 2}, json{{{"fx", 1}}}, json{{{"frame", "1"}}},
                            json{{{"frame", 0.5}}}, json::array()})
    expect_field_refused("frames", value);
}

TEST_F(CameraFiles, only_a_rotation_with_a_translation_is_a_world_to_camera) {
  const json ok = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  for (const json& value :
       {json(nullptr), json("identity"), json::array(), json{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
        json{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}})
    expect_field_refused("world_to_camera", value);
  const auto with = [&](std::size_t row, std::size_t column, const json& entry) {
    json matrix = ok;
    matrix[row][column] = entry;
    return matrix;
  };
  for (const json& value : {with(0, 0, 0), with(0, 0, -1), with(0, 1, 0.01), with(1, 1, 2), with(2, 2, "1"),
                            with(0, 3, nullptr), with(2, 2, 0.99)})
    expect_field_refused("world_to_camera", value);
  // With the translation in the last row it is the transposed matrix of row vectors: its rotation would be turned
  // round.
  expect_field_refused("world_to_camera", {{0, 1, 0, 0}, {0, 0, 1, 0}, {1, 0, 0, 0}, {5, 6, 7, 1}});
  expect_field_refused("world_to_camera", with(3, 3, 0));
}

// A camera for a frame.

InputSettings with_fov(double degrees) {
  InputSettings settings;
  settings.fov = degrees;
  return settings;
}
InputSettings with_vertical_fov(double degrees) {
  InputSettings settings;
  settings.vertical_fov = degrees;
  return settings;
}
InputSettings with_focal_px(double pixels) {
  InputSettings settings;
  settings.focal_px = pixels;
  return settings;
}
InputSettings with_lens(double focal, double aperture) {
  InputSettings settings;
  settings.focal = focal;
  settings.aperture = aperture;
  return settings;
}
InputSettings with_ortho_width(double width) {
  InputSettings settings;
  settings.ortho_width = width;
  return settings;
}

TEST_F(CameraFiles, options_give_a_camera_over_the_width_of_the_display_window) {
  const double degree = std::numbers::pi / 180;
  struct Case {
    InputSettings by;
    double pixel_aspect, fx, fy;
  };
  // Pixels twice as wide as high: a tangent has half as many of them in x as in y.
  for (const auto& [by, pixel_aspect, fx, fy] :
       {Case{with_fov(90), 1, 32, 32}, Case{with_fov(60), 1, 32 / std::tan(30 * degree), 32 / std::tan(30 * degree)},
        Case{with_fov(90), 2, 32, 64}, Case{with_lens(25, 36), 2, 64 * 25 / 36.0, 2 * 64 * 25 / 36.0},
        Case{with_fov(2 * std::atan(18.0 / 25) / degree), 2, 64 * 25 / 36.0, 2 * 64 * 25 / 36.0},
        Case{with_vertical_fov(90), 1, 18, 18}, Case{with_vertical_fov(90), 2, 9, 18},
        Case{with_focal_px(50), 1, 50, 50}, Case{with_focal_px(50), 2, 50, 100},
        Case{with_ortho_width(16), 0.5, 4, 2}}) {
    const Camera camera = camera_for(by, kDisplay, pixel_aspect, 0);
    expect_near(camera, fx, fy, 32, 18);
    EXPECT_EQ(camera.orthographic, by.ortho_width.has_value());
    EXPECT_FALSE(camera.view_from_world);
  }
}

TEST_F(CameraFiles, a_proxy_shares_the_camera_of_the_full_size) {
  json fields = wall_camera();
  fields["cx"] = 30;
  fields["fy"] = 66;
  read(fields);
  InputSettings settings;
  settings.camera = file;
  expect_near(camera_for(settings, {0, 0, 64, 36}, 1, 0), 60, 66, 30, 18);
  expect_near(camera_for(settings, {0, 0, 32, 18}, 1, 0), 30, 33, 15, 9);
  expect_near(camera_for(settings, {100, -50, 160, 90}, 1, 0), 150, 165, 75, 45);
  fields["projection"] = "orthographic";
  read(fields);
  expect_near(camera_for(settings, {0, 0, 32, 18}, 1, 0), 30, 33, 15, 9);
}

TEST_F(CameraFiles, another_aspect_does_not_fit) {
  read(wall_camera());
  InputSettings settings;
  settings.camera = file;
  for (const Window& display : {Window{0, 0, 64, 48}, Window{0, 0, 36, 64}, Window{0, 0, 1, 1}})
    expect_error(ErrorKind::input, {"camera.json", "64x36", "--camera"}, [&] { camera_for(settings, display, 1, 0); });
}

TEST_F(CameraFiles, none_and_one_that_floats_cannot_hold_are_usage_errors) {
  const std::vector<std::string> options{"--fov",   "--vertical-fov", "--focal-px",
                                         "--focal", "--aperture",     "--ortho-width"};
  for (const auto& by : {with_fov(1e-300), with_vertical_fov(1e-300), with_focal_px(1e-300), with_lens(1e30, 1e-30),
                         with_ortho_width(1e-200), InputSettings{}})
    expect_error(ErrorKind::usage, options, [&] { camera_for(by, kDisplay, 1, 0); });
  expect_error(ErrorKind::usage, {"--camera"}, [] { camera_for(InputSettings{}, kDisplay, 1, 0); });
}

// What kernels are given.

/// The image point of a view-space position, in pixels from the display window's corner, by the camera's own
/// definition.
std::array<double, 2> seen_at(const Camera& camera, double x, double y, double z) {
  const double w = camera.orthographic ? 1 : -z;
  return {camera.cx + camera.fx * x / w, camera.cy - camera.fy * y / w};
}

TEST_F(CameraFiles, view_is_the_inverse_of_the_projection_in_every_data_window) {
  Camera off_axis = camera_for(with_fov(70), {0, 0, 64, 36}, 1.5, 0);
  off_axis.cx = 11.5;
  off_axis.cy = 40;
  for (const Camera& camera : {camera_for(with_fov(70), {0, 0, 64, 36}, 1.5, 0), off_axis,
                               camera_for(with_ortho_width(16), {0, 0, 64, 36}, 2, 0)})
    for (const Window& display : {Window{0, 0, 64, 36}, Window{-7, 100, 64, 36}})
      for (const Window& data :
           {display, Window{display.x - 8, display.y - 4, 80, 44}, Window{display.x + 10, display.y + 6, 40, 24}}) {
        const View view = view_of(camera, data, display);
        EXPECT_EQ(view.size.x, data.width);
        EXPECT_EQ(view.size.y, data.height);
        EXPECT_EQ(view.orthographic, camera.orthographic ? 1u : 0u);
        const double x = 0.3, y = -0.7, depth = 5;
        const auto seen = seen_at(camera, x, y, -depth);
        // The same point counted from the data window's corner, taken back to view space.
        const double back_x = (seen[0] + display.x - data.x - view.center.x) * view.tangent_per_pixel.x;
        const double back_y = (seen[1] + display.y - data.y - view.center.y) * view.tangent_per_pixel.y;
        const double scale = camera.orthographic ? 1 : depth;
        EXPECT_NEAR(back_x * scale, x, 1e-4) << to_string(data) << " in " << to_string(display);
        EXPECT_NEAR(back_y * scale, y, 1e-4) << to_string(data) << " in " << to_string(display);
      }
}

}  // namespace
}  // namespace alcove::camera_test
