// Lights files: suns and lamps, frame by frame, and files that are refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/lights.h"

#include "tests/support/test.h"

namespace alcove::lights_test {
namespace {

using namespace test;

/// A file of one light with these fields beside its name.
std::string file_of(const std::string& fields) { return R"({"lights": [{"name": "key", )" + fields + "}]}"; }

std::vector<Light> in_view(const std::string& text, const Camera& camera = {}, int frame = 0) {
  return lights_of(text, "lights.json")->in_view(camera, frame);
}

void expect_refused(const std::string& text, const std::string& why) {
  SCOPED_TRACE(text);
  expect_error(ErrorKind::input, {"lights.json", "--lights", why}, [&] { lights_of(text, "lights.json"); });
}

const std::string kSun = R"("kind": "sun", "direction": [0, 0, 4])";
const std::string kLamp = R"("kind": "point", "position": [1, 2, 3])";

TEST(Lights, are_suns_of_directions_one_long_and_lamps_at_places) {
  const std::string view = R"(, "space": "view")";
  EXPECT_EQ(in_view(file_of(kSun + R"(, "angular_diameter": 0.53)" + view))[0],
            (Light{.name = "key", .at = {0, 0, 1}, .size = 0.53}));
  EXPECT_EQ(in_view(file_of(kLamp + R"(, "radius": 0.1)" + view))[0],
            (Light{.name = "key", .is_lamp = true, .at = {1, 2, 3}, .size = 0.1}));
}

TEST(Lights, of_the_world_turn_with_the_camera_and_lamps_move_with_it) {
  Camera camera;
  camera.view_from_world = Matrix3{{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
  camera.view_from_world_offset = {10, 20, 30};
  EXPECT_EQ(in_view(file_of(kSun), camera)[0].at, (Vector3{0, 1, 0}));
  EXPECT_EQ(in_view(file_of(kLamp), camera)[0].at, (Vector3{12, 23, 31}));
  expect_error(ErrorKind::input, {"lights.json", "key", "world_to_camera", "--camera"},
               [] { in_view(file_of(kLamp)); });
}

TEST(Lights, of_the_view_are_before_a_left_handed_camera_at_positive_z) {
  Camera camera;
  camera.left_handed = true;
  camera.view_from_world = Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  EXPECT_EQ(in_view(file_of(kLamp + R"(, "space": "view")"), camera)[0].at, (Vector3{1, 2, -3}));
  EXPECT_EQ(in_view(file_of(kLamp), camera)[0].at, (Vector3{1, 2, 3})) << "the matrix has turned it already";
}

TEST(Lights, change_from_frame_to_frame) {
  const std::string text = file_of(kSun + R"(, "space": "view", "angular_diameter": 1,
      "frames": [{"frame": 1001}, {"frame": 1002, "direction": [1, 0, 0]}, {"frame": 1003, "angular_diameter": 0}])");
  EXPECT_EQ(in_view(text, {}, 1001)[0].at, (Vector3{0, 0, 1}));
  EXPECT_EQ(in_view(text, {}, 1002)[0].at, (Vector3{1, 0, 0}));
  EXPECT_EQ(in_view(text, {}, 1003)[0].size, 0);
  expect_error(ErrorKind::input, {"lights.json", "key", "1004", "1001"}, [&] { in_view(text, {}, 1004); });
  EXPECT_TRUE(lights_of(text, "lights.json")->is_soft(0));
  EXPECT_FALSE(lights_of(file_of(kSun), "lights.json")->is_soft(0));
}

TEST(Lights, with_a_misspelt_or_senseless_field_are_refused_by_name) {
  expect_refused("", "line 1 is no JSON");
  expect_refused("[1]", "JSON object");
  expect_refused(R"({"lights": []})", "0 lights");
  expect_refused(R"({"light": [], "lights": [{}]})", "no field \"light\"");
  expect_refused(R"({"lights": [5]})", "light 1 of the list");
  expect_refused(R"({"lights": [{)" + kSun + "}]}", "\"name\" is missing");
  for (const char* name : {"\"\"", "\"key.1\"", "\"key light\"", "\"k\\u00e9y\"", "7"})
    expect_refused(R"({"lights": [{"name": )" + std::string(name) + ", " + kSun + "}]}", "letters");
  expect_refused(R"({"lights": [{"name": "a", )" + kSun + R"(}, {"name": "a", )" + kLamp + "}]}",
                 "\"a\" is there twice");
  expect_refused(file_of(kSun + R"(, "angular_diamater": 1)"), "angular_diameter");
  expect_refused(file_of(kSun + R"(, "radius": 1)"), "\"radius\"");
  expect_refused(file_of(kLamp + R"(, "direction": [0, 0, 1])"), "\"direction\"");
  expect_refused(file_of(R"("direction": [0, 0, 1])"), "\"kind\" is missing");
  expect_refused(file_of(R"("kind": "spot", "direction": [0, 0, 1])"), "sun or point");
  expect_refused(file_of(R"("kind": "sun")"), "\"direction\" is missing");
  expect_refused(file_of(kSun + R"(, "position": [0, 0, 1])"), "a sun has \"direction\" and \"angular_diameter\", not");
  expect_refused(file_of(R"("kind": "sun", "direction": [0, 0, 0])"), "no length");
  for (const char* bad : {"[0, 1]", "[0, 1, null]", "[0, 1, \"z\"]", "5"})
    expect_refused(file_of(R"("kind": "sun", "direction": )" + std::string(bad)), "\"direction");
  expect_refused(file_of(R"("kind": "sun", "direction": [0, 1, 1e400])"), "no computer holds");
  expect_refused(file_of(kSun + R"(, "angular_diameter": 180)"), "0 to 30");
  expect_refused(file_of(kLamp + R"(, "radius": -1)"), "\"radius\"");
  expect_refused(file_of(kSun + R"(, "space": "object")"), "world or view");
  expect_refused(file_of(kSun + R"(, "frames": [{"direction": [1, 0, 0]}])"), "\"frame\"");
  expect_refused(file_of(kSun + R"(, "frames": [{"frame": 1, "name": "b"}])"), "no field \"name\"");
  expect_refused(file_of(kSun + R"(, "frames": [{"frame": 1}, {"frame": 1}])"), "twice");
  expect_refused(file_of(R"("kind": "sun", "frames": [{"frame": 1, "direction": [1, 0, 0]}, {"frame": 2}])"),
                 "frame 2: \"direction\" is missing");
  expect_refused(file_of(kSun + ",\n\"frames\": [1,\n}]"), "line 3 is no JSON");
  expect_refused(file_of(R"("type": "sun", "direction": [0, 0, 1])"), "no field \"type\"");
  expect_refused(R"({"up": "x", "lights": []})", "z or y");
  for (const char* number : {"4294967297", "-2147483649", "18446744073709551616", "1e300", "1.5", "\"1\"", "true"})
    expect_refused(file_of(kSun + fmt::format(R"(, "frames": [{{"frame": 1}}, {{"frame": {}}}])", number)),
                   "\"frame\"");
  expect_refused(file_of(kSun + R"(, "frames": [{"frame": 1, "radius": 2}])"), "no field \"radius\"");
  expect_refused(file_of(R"("kind": "sun", "direction": [0, 1], "frames": [{"frame": 1, "direction": [1, 0, 0]}])"),
                 "three numbers");
  expect_refused(std::string(100000, '['), "nests deeper");
  expect_refused(file_of(kSun + R"(, "frames": ["}}}]]]\"]]", [[[[[[[1]]]]]]])"), "nests deeper");
  std::string many = R"({"lights": [)";
  for (int i = 0; i < 17; i++) many += fmt::format(R"({}{{"name": "l{}", {}}})", i ? "," : "", i, kSun);
  expect_refused(many + "]}", "17 lights");
}

/// The direction of a light of this space after a turn.
Vector3 turned(const std::string& top, const std::string& space, std::optional<double> azimuth,
               std::optional<double> elevation, const Camera& camera = {}) {
  EstimatorSettings settings;
  settings.sun_azimuth = azimuth;
  settings.sun_elevation = elevation;
  const std::string text = "{" + top + R"("lights": [{"name": "lamp", "space": "view", )" + kLamp +
                           R"(}, {"name": "key", "space": ")" + space +
                           R"(", "kind": "sun", "direction": [0, 3, 4]}]})";
  const auto lights = lights_of(text, "lights.json", settings)->in_view(camera, 0);
  EXPECT_EQ(lights[0].at, (Vector3{1, 2, camera.left_handed ? -3. : 3.})) << "a lamp stays";
  return lights[1].at;
}

TEST(Lights, turn_a_sun_about_what_is_up) {
  Camera camera;
  camera.view_from_world = Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const double half = std::sqrt(0.5);
  const auto expect_near = [](const Vector3& found, const Vector3& right) {
    for (std::size_t i = 0; i < 3; i++) EXPECT_NEAR(found[i], right[i], 1e-12) << i;
  };
  expect_near(turned("", "world", 90, 45, camera), {0, half, half});
  expect_near(turned("", "world", 0, 0, camera), {1, 0, 0});
  expect_near(turned("", "world", {}, 90, camera), {0, 0, 1});
  expect_near(turned("", "world", 180, {}, camera), {-0.6, 0, 0.8});
  expect_near(turned("", "world", {}, 0, camera), {0, 1, 0});
  expect_near(turned(R"("up": "y", )", "world", 90, 45, camera), {0, half, -half});
  expect_near(turned(R"("up": "y", )", "world", {}, 0, camera), {0, 0, 1});
  expect_near(turned("", "view", 270, 45), {0, half, half});
  Camera left_handed;
  left_handed.left_handed = true;
  expect_near(turned("", "view", 270, 45, left_handed), {0, half, half});
  expect_near(turned("", "view", {}, 0, left_handed), {0, 0, -1});
}

TEST(Lights, a_vertical_sun_has_no_azimuth_of_its_own) {
  EstimatorSettings settings;
  const auto in_view = [&] {
    const auto lights = R"({"lights": [{"name": "a", "kind": "sun", "direction": [0, 1, 0], "space": "view"}]})";
    return lights_of(lights, "lights.json", settings)->in_view({}, 0);
  };
  settings.sun_azimuth = 90;
  expect_error(ErrorKind::usage, {"lights.json", "\"a\"", "vertical", "sun-elevation"}, [&] { in_view(); });
  settings.sun_elevation = 0;
  EXPECT_NEAR(in_view()[0].at[1], 0, 1e-12);
}

TEST(Lights, that_turn_must_be_one_sun) {
  EstimatorSettings settings;
  settings.sun_azimuth = 1;
  const std::string two = R"({"lights": [{"name": "a", )" + kSun + R"(}, {"name": "b", )" + kSun + "}]}";
  const auto refused = [&](const std::string& text, const std::vector<std::string>& words) {
    expect_error(ErrorKind::usage, words, [&] { lights_of(text, "lights.json", settings); });
  };
  refused(file_of(kLamp), {"lights.json", "no sun", "--set sun-azimuth"});
  refused(two, {"a, b", "--set sun=NAME"});
  settings.sun = "c";
  refused(two, {"no sun c", "--set sun=c"});
  settings.sun = "b";
  EXPECT_EQ(lights_of(two, "lights.json", settings)->sun, 1u);
}

TEST(Lights, are_refused_in_a_short_sentence_whatever_the_file_holds) {
  const std::string flood(100000, 'x');
  for (const std::string& text :
       {file_of("\"" + flood + "\": 1, " + kSun), file_of("\"kind\": \"" + flood + "\""),
        file_of(R"("kind": "sun", "direction": ")" + flood + "\""), "{\"lights\": [\"" + flood + "\"]}",
        R"({"lights": [{"name": ")" + flood + "\"}]}", file_of(kSun + ", \"angular_diameter\": \"" + flood + "\"")})
    try {
      lights_of(text, "lights.json");
      ADD_FAILURE() << text.substr(0, 100);
    } catch (const Error& error) {
      EXPECT_LT(std::string(error.what()).size(), 400u);
    }
}

TEST(Lights, of_many_frames_are_read_at_once) {
  std::string frames;
  for (int i = 0; i < 30000; i++) frames += fmt::format(R"({}{{"frame": {}}})", i == 0 ? "" : ",", i);
  const auto file = lights_of(file_of(kSun + R"(, "frames": [)" + frames + "]"), "lights.json");
  EXPECT_EQ(file->lights[0].of_frames.size(), 30000u);
  EXPECT_EQ(in_view(file_of(R"("kind": "sun", "space": "view", "direction": [0, 1e-300, 0])"))[0].at,
            (Vector3{0, 1, 0}));
}

}  // namespace
}  // namespace alcove::lights_test
