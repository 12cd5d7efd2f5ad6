// What the pixels refute is refused with what mends it, and what they cannot decide is said.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/settle.h"
#include "tests/support/source_frame.h"

namespace alcove::doubts_test {
namespace {

using namespace test;

class Doubts : public Sources {
 protected:
  /// Depth of the rendering through a function, without normals; some of the sky is changed.
  void write_depth(
      const std::function<double(double)>& value, float sky,
      const std::function<float(int)>& some_sky = [](int) { return NAN; }) {
    planes = file_of(rendering(), sky, [&](const test::Hit& hit) { return value(hit.distance); }).planes;
    int count = 0;
    for (float& d : planes["Z"])
      if (const float other = d == sky ? some_sky(count++) : NAN; !std::isnan(other)) d = other;
    ASSERT_GT(count, 500) << "or else too little of the sky is changed";
    write(settings.input);
  }

  void write_frame() {
    planes = file_of(rendering(), 1e12f, planar, world_normal).planes;
    write(settings.input);
  }

  /// The camera file of the scene, with changes.
  void give(const json& changes = json::object()) {
    json camera = camera_of(shot());
    camera.update(changes);
    Sources::give(camera);
  }

  void set_range(DepthKind kind, double near, double far, bool reversed = false) {
    settings.depth_kind = kind;
    settings.depth_range.near = near;
    settings.depth_range.far = far;
    settings.depth_range.reversed = reversed;
  }
};

double itself(double z) { return z; }
double hundredths(double z) { return z / 100; }
double falling(double z) { return 1 - z / 100; }
double root(double z) { return std::sqrt(z / 100); }
double half(double z) {
  const double step = std::ldexp(1, std::ilogb(z) - 10);
  return step * std::round(z / step);
}

// Where the sky begins.

TEST_F(Doubts, values_of_half_floats_times_a_scale_do_not_end_where_half_floats_end) {
  give();
  write_depth([&](double z) { return 20000 * half(z); }, 1e12f);
  EXPECT_TRUE(std::isinf(settled().reading.found_sky)) << "surfaces reach beyond 65504";
  write_depth(half, 65504);
  EXPECT_EQ(settled().reading.found_sky, 65504);
  settings.depth_kind = DepthKind::inverse;
  write_depth(half, 0);
  EXPECT_GT(depth_map_of(settled().reading).sky_depth, 1e8) << "1/z of half floats reaches any distance";
}

TEST_F(Doubts, a_sky_may_be_blended_with_what_is_before_it_or_filtered_beyond_its_range) {
  give();
  write_depth([](double z) { return -z; }, 1000, [](int i) { return i % 20 == 0 ? float(300 + i % 13) : NAN; });
  EXPECT_TRUE(settled().reading.depth_range.negative);
  settings.depth_kind = DepthKind::planar;
  write_depth(itself, 1e6f, [](int i) { return i == 0 ? 7e5f : NAN; });
  EXPECT_THAT(said(), Contains(HasSubstr("--sky 1e+06")));
  set_range(DepthKind::normalized, 0, 100);
  write_depth(hundredths, 1, [](int i) { return i % 10 == 0 ? 1 + 1e-3f * float(i % 7 + 1) : NAN; });
  EXPECT_FALSE(settled().reading.depth_range.goes_beyond_far);
  expect(Reply::noted, {"all of these count as sky"});
}

TEST_F(Doubts, a_wall_that_faces_the_camera_far_behind_all_others_is_not_called_the_sky) {
  give();
  settings.depth_kind = DepthKind::planar;
  settings.normal_space = NormalSpace::world;
  for (const bool is_wall : {true, false}) {
    write_frame();
    for (std::size_t i = 0; i < planes["Z"].size(); i++)
      if (planes["Z"][i] == 1e12f) planes["Z"][i] = 1000, planes[is_wall || i % 2 ? "N.Z" : "N.Y"][i] = 1;
    write(settings.input);
    EXPECT_EQ(std::ranges::count(settled().notes, NoteCode::finite_sky, &Note::code), is_wall ? 0 : 1);
  }
}

TEST_F(Doubts, depth_that_was_rounded_to_whole_units_is_called_rounded) {
  give();
  for (const double unit : {1.0, 0.25}) {
    write_depth([=](double z) { return unit * std::round(z / unit); }, 1e12f);
    EXPECT_THAT(texts_of(settled().suspicious), Contains(HasSubstr("was rounded: at its median"))) << unit;
  }
  write_depth(itself, 1e12f);
  EXPECT_THAT(settled().suspicious, IsEmpty());
}

TEST_F(Doubts, depth_is_clamped_where_many_pixels_have_its_largest_value_and_not_where_halves_are_coarse) {
  give();
  settings.depth_kind = DepthKind::planar;
  const auto codes_with = [&](const std::function<double(double)>& depth) {
    planes = file_of(
                 rendering(), 1e12f, [&](const test::Hit& hit) { return depth(hit.distance); }, world_normal)
                 .planes;
    write(settings.input);
    std::vector<NoteCode> codes;
    for (const Note& note : settled().suspicious) codes.push_back(note.code);
    return codes;
  };
  EXPECT_THAT(codes_with(half), ElementsAre(NoteCode::half_depth));
  EXPECT_THAT(codes_with([](double z) { return std::min(half(z), 5.0); }), Contains(NoteCode::clamped_depth));
  EXPECT_THAT(codes_with([](double z) { return std::min(z, 5.0); }), Contains(NoteCode::clamped_depth));
}

// Depth within 0 to 1.

TEST_F(Doubts, what_depth_may_be_is_told_by_its_values_its_program_and_its_camera_file) {
  const std::string normalized = "--depth-kind normalized --near 0 --far F",
                    reversed = "--depth-kind normalized --reversed-z --near 0 --far F";
  const std::vector<std::string> all_kinds{normalized, "--reversed-z", "--depth-kind planar", "--depth-kind disparity"};
  std::vector<double> distances;
  for (const auto& hit : rendering().hits)
    if (hit.primitive >= 0) distances.push_back(hit.distance / 100);
  std::ranges::sort(distances);
  struct Case {
    const char* what;
    std::string program;
    json camera;
    std::function<double(double)> depth;
    float sky;
    Reply reply;
    std::vector<std::string> words;
  };
  const json nothing = json::object(), is_planar = {{"depth", "planar"}};
  const auto near = [](double z) { return json{{"near", z}}; };
  for (const Case& c : std::vector<Case>{
           {"falls from 1", "", nothing, falling, 0, Reply::refused, {reversed}},
           {"its far end is 4", "", nothing, [](double z) { return 1 - z / 4; }, 0, Reply::refused, {"--reversed-z"}},
           {"falls from 1, by Blender", "Blender 3.4", nothing, falling, 0, Reply::refused, {"--reversed-z"}},
           {"falls from 1, said planar", "", is_planar, falling, 0, Reply::noted, {reversed, "[said-otherwise]"}},
           {"below 1, said planar", "", is_planar, hundredths, 1e12f, Reply::noted, {normalized, "[depth-below-1]"}},
           {"near is 1", "", nothing, [](double z) { return (z - 1) / 99; }, 1e12f, Reply::refused, all_kinds},
           {"bent", "", nothing, root, 1e12f, Reply::refused, all_kinds},
           {"around 0",
            "",
            nothing,
            [](double z) { return 3 / z - 0.6; },
            -1,
            Reply::refused,
            {"below 0", "--depth-kind disparity"}},
           {"near is 2, falls", "", nothing, [](double z) { return 1 - (z - 2) / 99; }, 1e12f, Reply::refused,
            all_kinds},
           {"straight", "", nothing, hundredths, 1e12f, Reply::noted, {normalized, "[depth-below-1]"}},
           {"straight, by Blender", "Blender 3.4", nothing, hundredths, 1e12f, Reply::silent, {}},
           {"before near", "", near(0.1), hundredths, 1e12f, Reply::refused, {"near plane at 0.1"}},
           {"behind near", "", near(0.001), hundredths, 1e12f, Reply::noted, {"less than 1 scene unit"}},
           {"a twentieth before near",
            "",
            near(distances[distances.size() / 20]),
            hundredths,
            1e12f,
            Reply::refused,
            {"near plane at"}},
           {"a 500th before near",
            "",
            near(distances[distances.size() / 500]),
            hundredths,
            1e12f,
            Reply::noted,
            {"less than 1 scene unit"}},
           {"beyond 1", "", nothing, itself, 1e12f, Reply::silent, {}},
           {"beyond 1, planes said", "", {{"near", 0.1}, {"far", 100}}, itself, 1e12f, Reply::silent, {}},
       }) {
    SCOPED_TRACE(c.what);
    header = Imf::Header(160, 120);
    if (!c.program.empty()) header.insert("Software", Imf::StringAttribute(c.program));
    give(c.camera);
    write_depth(c.depth, c.sky);
    expect(c.reply, c.words);
  }
  header.insert("Software", Imf::StringAttribute("Blender 3.4"));
  give();
  write_depth(root, 1e12f);
  EXPECT_THAT(said(), ElementsAre(HasSubstr(normalized), HasSubstr("read as planar, as cycles writes it")))
      << "its Normalize";
}

TEST_F(Doubts, an_option_says_that_it_is_known) {
  settings.depth_kind = DepthKind::planar;
  for (const json& camera : {json::object(), json{{"depth", "planar"}}}) {
    give(camera);
    write_depth(hundredths, 1e12f);
    expect(Reply::silent);
    write_depth(root, 1e12f);
    EXPECT_EQ(settled().reading.depth_kind, DepthKind::planar);
  }
  set_range(DepthKind::normalized, 0, 100, true);
  write_depth(falling, 0);
  expect(Reply::silent);
  EXPECT_NEAR(*settled().evidence->median_depth, 4.5, 1) << "distances, and not fractions";
}

TEST_F(Doubts, options_that_the_kind_of_depth_takes_not_are_refused_and_named_but_those_of_presets_are_left_out) {
  give();
  write_depth(itself, 1e12f);
  set_range(DepthKind::automatic, 0.1, 100, true);
  settings.from_presets = {{"--near", "far"}, {"--far", "far"}, {"--reversed-z", "far"}};
  expect(Reply::silent);
  settings.from_presets = {{"--near", "far"}, {"--reversed-z", "far"}};
  expect(Reply::usage, {"--far has no effect"});
  settings.from_presets.clear();
  settings.depth_range.device = DeviceRange::minus_one_to_one;
  settings.depth_range.log_constant = 0.5;
  const std::string all = "--near, --far, --reversed-z, --set device-range, --set log-constant";
  expect(Reply::usage, {settings.input, all, "planar", "--depth-kind"});
  give({{"depth_kind", "log"}, {"far", 100}});  // what the camera file says is a kind too
  write_depth([](double z) { return std::log2(1 + z) / std::log2(101.); }, 1);
  settings.depth_range = {};
  settings.depth_range.near = 0.1;
  settings.depth_range.far = 100;
  expect(Reply::usage, {"--near has no effect", "log"});
}

TEST_F(Doubts, planes_of_a_z_buffer_are_doubted_where_they_leave_out_half_of_its_range_or_are_none) {
  give();
  write_depth([](double z) { return 1 - 1 / z; }, 1);
  set_range(DepthKind::device, 1, std::numeric_limits<double>::infinity());
  settings.depth_range.device = DeviceRange::minus_one_to_one;
  expect(Reply::noted, {"[said-otherwise]"});
  settings.depth_range = {};
  set_range(DepthKind::device, 0, 100);
  expect(Reply::usage, {"near plane above 0", "--near"});
}

TEST_F(Doubts, the_near_plane_of_a_matrix_is_doubted_until_an_option_says_it) {
  // OpenGL's matrix of a near plane at 1, whose depth is read as 0 to 1.
  const json matrix = game_matrix(camera_of(shot()), {0, 0, -1, -2}, -1);
  give({{"projection", matrix}, {"near", 1}, {"far", "inf"}, {"depth_kind", "device"}});
  write_depth([](double z) { return 1 - 1 / z; }, 1);
  expect(Reply::noted, {"[near-plane]", "--near", "--set device-range"});
  settings.depth_range.near = 1;
  expect(Reply::silent);
  settings.depth_range = {};
  settings.depth_range.device = DeviceRange::zero_to_one;
  expect(Reply::silent);
  settings.depth_range = {};
  give({{"projection", matrix}, {"far", "inf"}, {"depth_kind", "device"}});
  expect(Reply::usage, {"--near", "at 2 if its z is 0 to 1", "at 1 if it is OpenGL's", "device-range=-1..1"});
}

TEST_F(Doubts, planes_of_a_matrix_are_those_of_the_range_that_is_said) {
  for (const int side : {1, -1}) {
    // A near plane at 1 and no far plane: from 0, as Direct3D and Vulkan have it, and from -1.
    for (const int low : {0, -1}) {
      const json matrix = game_matrix(camera_of(shot()), {0, 0, side, low - 1}, side);
      give({{"projection", matrix}, {"camera_space", "right-handed"}, {"depth_kind", "device"}});
      write_depth([&](double z) { return 1 - (1 - low) / z; }, 1);
      settings.depth_range.device = low ? DeviceRange::minus_one_to_one : DeviceRange::zero_to_one;
      EXPECT_NEAR(settled().reading.depth_range.near.value(), 1, 1e-9);
      settings.depth_range = {};
      expect(Reply::usage, {"--near", "--set device-range"});
    }
  }
}

// Cameras.

TEST_F(Doubts, a_camera_that_the_pixels_refute_is_refused_or_noted_with_the_right_one) {
  const Camera c = shot().camera;
  const auto placed = [](const Rows& rows, const json& more = json::object()) {
    json changes = more;
    changes["world_to_camera"] = rows;
    return changes;
  };
  const json in_world = {{"normal_space", "world"}};
  Rows of_opencv = world_to_camera(1), other_up = world_to_camera(1);
  for (const std::size_t i : {1, 2})
    for (double& x : of_opencv[i]) x = -x;
  for (auto& row : other_up) row = {row[0], row[2], -row[1], row[3]};
  const std::vector<std::string> inverse{"camera_to_world: give the inverse", "camera.json", "--normal none"};
  struct Case {
    const char* what;
    bool with_normals;
    json camera;
    Reply reply;
    std::vector<std::string> words;
  };
  for (const Case& k : std::vector<Case>{
           {"right", true, json::object(), Reply::silent, {}},
           {"oblong pixels",
            false,
            {{"fy", 1.78 * c.fx}},
            Reply::noted,
            {"camera.json", "pixel is 1.78 times as wide", "[said-otherwise]"}},
           {"rounded", false, {{"fy", 1.001 * c.fx}}, Reply::silent, {}},
           {"of twice the size",
            false,
            {{"resolution", {320, 240}}, {"fx", 2 * c.fx}, {"fy", 2 * c.fy}, {"cx", 160}, {"cy", 120}},
            Reply::noted,
            {"camera.json", "320x240", "160x120", "[camera-scaled]"}},
           {"twice the focal length",
            true,
            {{"fx", 2 * c.fx}, {"fy", 2 * c.fy}},
            Reply::noted,
            {"about 60 degrees", "[field-of-view]"}},
           {"a longer lens",
            true,
            {{"fx", 1.2 * c.fx}, {"fy", 1.2 * c.fy}},
            Reply::noted,
            {"--fov", "[field-of-view]"}},
           {"a shorter lens",
            true,
            {{"fx", 0.8 * c.fx}, {"fy", 0.8 * c.fy}},
            Reply::noted,
            {"--fov", "[field-of-view]"}},
           {"the optical axis aside", true, {{"cx", 120}}, Reply::refused, {"\"cx\": 80, \"cy\": 60, the centre"}},
           {"inverted", true, placed(camera_to_world(1)), Reply::refused, inverse},
           {"inverted, and the space is said", true, placed(camera_to_world(1), in_world), Reply::refused, inverse},
           {"of OpenCV", true, placed(of_opencv, in_world), Reply::refused, {"OpenCV"}},
           {"with another axis up", true, placed(other_up, in_world), Reply::refused, {"another axis up"}},
       }) {
    SCOPED_TRACE(k.what);
    give(k.camera);
    k.with_normals ? write_frame() : write_depth(itself, 1e12f);
    expect(k.reply, k.words);
  }
  give();
  write_depth(itself, 1e12f);
  settings.view = "left";
  expect(Reply::noted, {"--view left chooses nothing"});
}

TEST_F(Doubts, a_camera_of_the_frame_before_is_noted_by_the_turn_of_the_normals) {
  write_frame();
  const auto turned_by = [&](double degrees) {
    Rows rows = world_to_camera(1);
    const double s = std::sin(degrees * std::numbers::pi / 180), c = std::cos(degrees * std::numbers::pi / 180);
    for (std::size_t column = 0; column < 4; column++) {
      const double x = rows[0][column], z = rows[2][column];
      rows[0][column] = c * x + s * z;
      rows[2][column] = c * z - s * x;
    }
    give({{"world_to_camera", rows}, {"normal_space", "world"}});
  };
  turned_by(0);
  expect(Reply::silent);
  for (const double degrees : {0.4, 1.5, 4.0}) {
    turned_by(degrees);
    expect(Reply::noted, {fmt::format("turned by {:.2g} degrees", degrees), "another frame", "[normals-disagree]"});
  }
}

TEST_F(Doubts, an_order_of_rotation_that_fits_is_named) {
  write_frame();
  const double degrees = 180 / std::numbers::pi;
  const Vec3 right = shot().right, up = shot().up, back = shot().back;
  // Turned about x, then y, then z, the camera's axes are the columns of Rz Ry Rx.
  const Vector3 angles{std::atan2(up.z, back.z), -std::asin(right.z), std::atan2(right.y, right.x)};
  settings.camera = folder / "camera.chan";
  const double view = 2 * std::atan(60 / shot().camera.fy) * degrees;
  const Vec3 eye = shot().eye;
  write_bytes(settings.camera, fmt::format("0 {} {} {} {} {} {} {}\n", eye.x, eye.y, eye.z, degrees * angles[0],
                                           degrees * angles[1], degrees * angles[2], view));
  settings.chan_rotation = "zxy";
  expect(Reply::refused, {"--chan-rotation xyz"});
  settings.chan_rotation = "xyz";
  expect(Reply::silent);
}

TEST_F(Doubts, bars_on_two_opposite_sides_are_warned_of_and_a_sky_is_not) {
  give();
  settings.depth_kind = DepthKind::planar;
  // Rows and columns that are empty: above, below, on the left, on the right.
  struct Case {
    int top, bottom, left, right;
    bool are_bars;
  };  // the last two are things before an empty background
  for (const Case& c : std::vector<Case>{{9, 9, 0, 0, true},
                                         {0, 0, 7, 8, true},
                                         {0, 0, 0, 0, false},
                                         {40, 0, 0, 0, false},
                                         {9, 20, 0, 0, false},
                                         {30, 30, 50, 50, false},
                                         {30, 0, 50, 50, false}}) {
    planes.clear();
    for (int y = 0; y < 120; y++)
      for (int x = 0; x < 160; x++) {
        const bool is_empty = x < c.left || x >= 160 - c.right || y < c.top || y >= 120 - c.bottom;
        planes["Z"].push_back(is_empty ? 0 : 1 / (0.1f + 0.0005f * float(x) + 0.0003f * float(y)));
      }
    write(settings.input);
    const Notes found = settled().suspicious;
    const auto bars = std::ranges::find(found, NoteCode::letterbox_bars, &Note::code);
    EXPECT_EQ(bars != found.end(), c.are_bars) << c.top << " " << c.bottom << " " << c.left << " " << c.right;
  }
}

TEST_F(Doubts, of_a_part_of_a_picture_the_right_principal_point_alone_is_not_doubted) {
  constexpr int kLeft = 48, kWidth = 160 - kLeft;  // columns that are cut off, and that stay: the axis is at 32
  for (const auto& [with_normals, cx, reply, words] :
       {std::tuple{true, kWidth - 32, Reply::refused, std::vector<std::string>{"\"cx\": 32"}},
        {true, 32, Reply::silent, {}},
        {false, 32, Reply::noted, {"(32, 60)", "[principal-point]"}},
        {false, kWidth / 2, Reply::silent, {}}}) {
    FrameFile file = file_of(rendering(), 1e12f, planar, with_normals ? world_normal : nullptr);
    file.data = file.display = {0, 0, kWidth, 120};
    for (auto& [name, plane] : file.planes) {
      std::size_t i = 0;
      std::erase_if(plane, [&](float) { return i++ % 160 < kLeft; });
    }
    file.write(settings.input);
    give({{"resolution", {kWidth, 120}}, {"cx", cx}});
    SCOPED_TRACE(fmt::format("cx {}, normals {}", cx, with_normals));
    expect(reply, words);
  }
}

// Normals that cannot be used.

TEST_F(Doubts, view_normals_of_a_camera_along_an_axis_are_not_those_of_a_turned_world) {
  FrameFile file = wall_frame();  // its camera is level and looks along the world's y
  file.rename("ViewLayer.Depth.Z", "Z");
  file.rename("ViewLayer.Normal.X", "N.X");
  file.rename("ViewLayer.Normal.Z", "N.Y");
  file.rename("ViewLayer.Normal.Y", "N.Z");
  for (float& z : file.planes["N.Z"]) z = -z;
  file.write(settings.input);
  json camera = wall_camera();
  camera.erase("normal_space");
  Sources::give(camera);
  expect(Reply::noted, {"normal space taken as view"});
}

TEST_F(Doubts, normals_that_agree_with_nothing_are_refused_unless_depth_is_half) {
  give({{"normal_space", "world"}});
  planes = file_of(rendering(), 1e12f, planar, [](const test::Hit& hit) {
             return unit(cross(hit.normal, Vec3{0.31, 0.52, 0.79}));
           }).planes;
  write(settings.input);
  expect(Reply::refused, {"no other space fits", "--normal-encoding", "--normal none"});
  settings.normal = "none";
  expect(Reply::silent);
  EXPECT_THAT(settled().channels[RawPlane::normal], IsEmpty());
  settings.normal.clear();
  Sources::give(wall_camera());
  FrameFile file = wall_frame();
  for (const auto& [component, value] : {std::pair("X", 0.9f), {"Y", 0.3f}, {"Z", 0.3f}})
    std::ranges::fill(file.planes[std::string("ViewLayer.Normal.") + component], value);
  file.write(settings.input);
  expect(Reply::refused, {"no other space fits"});
  file.halves = {"ViewLayer.Depth.Z"};
  file.write(settings.input);
  EXPECT_THAT(said(), Contains(HasSubstr("only 0 % of the normals agree with depth")));
}

TEST_F(Doubts, world_normals_without_a_matrix_are_refused_with_what_works) {
  write_frame();
  settings.fov = kFov;
  expect(Reply::refused, {"world_to_camera", "--fov", "--normal-encoding", "--normal none"});
  header.insert("Software", Imf::StringAttribute("Blender 3.4"));
  write_frame();
  for (const char* source : {"auto", "cycles"}) {
    settings.source = source;
    expect(Reply::refused, {"world_to_camera", "--normal none"});
    EXPECT_THAT(said(), Each(Not(HasSubstr("--normal-space view"))));
  }
  settings.normal = "none";
  expect(Reply::silent);
}

// What harms AO is found with the settling.

TEST_F(Doubts, shortened_normals_are_warned_of_but_not_where_the_program_always_averages_them) {
  give();
  write_frame();
  EXPECT_THAT(settled().suspicious, IsEmpty());
  for (const char* program : {"", "Blender 4.2", "Blender 5.0"}) {
    if (*program) header.insert("Software", Imf::StringAttribute(program));
    planes.clear();
    depth("Depth.Z", planar, 1e10f);
    vectors("Normal", "XYZ", world_normal);
    for (const char* name : {"Normal.X", "Normal.Y", "Normal.Z"})
      for (std::size_t i = 0; i < planes[name].size(); i += 4) planes[name][i] *= 0.5f;
    write(settings.input);
    const Notes suspicious = settled().suspicious;
    ASSERT_EQ(suspicious.size(), 1) << program;
    EXPECT_EQ(suspicious[0].code, *program ? NoteCode::averaged_normals : NoteCode::shortened_normals) << program;
    EXPECT_EQ(warnings_of(suspicious).size(), *program ? 0 : 1) << program;
  }
}

}  // namespace
}  // namespace alcove::doubts_test
