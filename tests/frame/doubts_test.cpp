// What the pixels refute is refused with what mends it, and what they cannot decide is said.
// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <nlohmann/json.hpp>

#include "core/frame/settle.h"
#include "tests/support/source_frame.h"
#include "tests/support/wall_frame.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class Doubts : public Sources {
 protected:
  /// Depth of the rendering through a function, without normals.
  void write_depth(const std::function<double(double)>& value, float sky) {
    planes.clear();
    auto& plane = planes["Z"];
    for (const auto& hit : rendering().hits) plane.push_back(hit.primitive < 0 ? sky : float(value(hit.distance)));
    write(settings.input);
  }

  void write_frame() {
    planes.clear();
    depth("Z", planar, 1e12f);
    vectors("N", "XYZ", world_normal);
    write(settings.input);
  }

  /// The camera file of the scene, with changes.
  void give(const json& changes = json::object(), const Rows& rows = world_to_camera(1)) {
    const Camera& c = shot().camera;
    json camera = {{"resolution", {160, 120}}, {"fx", c.fx}, {"fy", c.fy}, {"cx", 80}, {"cy", 60}};
    camera["world_to_camera"] = rows;
    camera.update(changes);
    settings.camera = folder / "camera.json";
    write_bytes(settings.camera, camera.dump());
  }

  std::vector<std::string> said() const {
    try {
      return texts_of(settled().notes);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return {"refused", error.what()};
    }
  }

  auto refused_with(const std::string& words) const { return testing::ElementsAre("refused", HasSubstr(words)); }
};

// Where the sky begins.

TEST_F(Doubts, values_of_half_floats_times_a_scale_do_not_end_where_half_floats_end) {
  give();
  const auto half = [](double z) {
    const double step = std::ldexp(1, std::ilogb(z) - 10);
    return step * std::round(z / step);
  };
  write_depth([&](double z) { return 20000 * half(z); }, 1e12f);
  EXPECT_TRUE(std::isinf(settled().found_sky)) << "surfaces reach beyond 65504";
  write_depth([&](double z) { return half(z); }, 65504);
  EXPECT_EQ(settled().found_sky, 65504);
  settings.depth_kind = DepthKind::inverse;
  write_depth([&](double z) { return half(z); }, 0);
  EXPECT_GT(depth_map_of(settled()).sky_depth, 1e8) << "1/z of half floats reaches any distance";
}

TEST_F(Doubts, what_a_filter_put_beyond_the_end_of_a_range_is_its_sky) {
  give();
  settings.depth_kind = DepthKind::normalized;
  settings.depth_range.near = 0;
  settings.depth_range.far = 100;
  write_depth([](double z) { return z / 100; }, 1);
  auto& plane = planes["Z"];
  int count = 0;
  for (float& d : plane)
    if (d == 1 && count++ % 10 == 0) d += 1e-3f * float(count % 7 + 1);
  ASSERT_GT(count, 500);
  write(settings.input);
  EXPECT_FALSE(settled().depth_range.goes_beyond_far);
  EXPECT_THAT(said(), testing::ElementsAre(HasSubstr("what lies beyond counts as that, the sky")));
}

TEST_F(Doubts, a_sky_above_negative_distances_may_be_blended_with_them) {
  give();
  write_depth([](double z) { return -z; }, 1000);
  auto& plane = planes["Z"];
  int count = 0;
  for (float& d : plane)
    if (d == 1000 && count++ % 20 == 0) d = 300 + float(count % 13);
  ASSERT_GT(count, 500);
  write(settings.input);
  EXPECT_TRUE(settled().depth_range.negative) << testing::PrintToString(said());
}

TEST_F(Doubts, a_distance_far_behind_all_others_is_pointed_out_though_edges_are_blended) {
  give();
  settings.depth_kind = DepthKind::planar;
  write_depth([](double z) { return z; }, 1e6f);
  const auto blended = std::ranges::find(planes["Z"], 1e6f);
  *blended = 7e5f;
  write(settings.input);
  EXPECT_THAT(said(), Contains(HasSubstr("--sky 1e+06")));
}

// Depth within 0 to 1.

TEST_F(Doubts, depth_that_falls_from_1_is_refused_with_the_line_that_reads_it) {
  give();
  write_depth([](double z) { return 1 - z / 100; }, 0);
  EXPECT_THAT(said(), refused_with("--depth-kind normalized --reversed-z --near 0 --far F"));
  write_depth([](double z) { return 1 - z / 4; }, 0);
  EXPECT_THAT(said(), refused_with("--reversed-z")) << "what lies beyond its far end is below 0, and counts as sky";
  write_depth([](double z) { return 1 - z / 100; }, 0);
  settings.depth_kind = DepthKind::normalized;
  settings.depth_range.reversed = true;
  settings.depth_range.near = 0;
  settings.depth_range.far = 100;
  EXPECT_THAT(said(), IsEmpty());
  EXPECT_NEAR(*settled().median_depth, 4.5, 1) << "distances, and not fractions";
}

TEST_F(Doubts, depth_that_falls_from_1_is_refused_whoever_wrote_it) {
  give();
  header.insert("Software", Imf::StringAttribute("Blender 3.4"));
  write_depth([](double z) { return 1 - z / 100; }, 0);
  EXPECT_THAT(said(), refused_with("--reversed-z"));
}

TEST_F(Doubts, fractions_are_warned_of_where_the_camera_file_says_that_they_are_distances) {
  give({{"depth", "planar"}});
  write_depth([](double z) { return 1 - z / 100; }, 0);
  ASSERT_EQ(settled().notes.size(), 1);
  EXPECT_EQ(settled().notes[0].code, NoteCode::said_otherwise);
  EXPECT_THAT(settled().notes[0].text, HasSubstr("--depth-kind normalized --reversed-z --near 0 --far F"));
  write_depth([](double z) { return z / 100; }, 1e12f);
  ASSERT_EQ(settled().notes.size(), 1);
  EXPECT_EQ(settled().notes[0].code, NoteCode::depth_below_1);
  EXPECT_THAT(settled().notes[0].text, HasSubstr("--depth-kind normalized --near 0 --far F"));
  settings.depth_kind = DepthKind::planar;
  EXPECT_THAT(said(), IsEmpty()) << "an option says that it is known";
}

TEST_F(Doubts, fractions_that_nothing_shows_to_be_distances_are_refused) {
  give();
  for (const auto& value : std::vector<std::function<double(double)>>{[](double z) { return (z - 1) / 99; },
                                                                      [](double z) { return std::sqrt(z / 100); },
                                                                      [](double z) { return 1 - (z - 2) / 99; }}) {
    write_depth(value, 1e12f);
    EXPECT_THAT(said(), Contains(AllOf(HasSubstr("--depth-kind normalized --near 0 --far F"), HasSubstr("--reversed-z"),
                                       HasSubstr("--depth-kind planar"))));
  }
  settings.depth_kind = DepthKind::planar;
  EXPECT_EQ(settled().depth_kind, DepthKind::planar) << "what is said is taken";
}

TEST_F(Doubts, straight_distances_below_1_are_taken_and_noted) {
  give();
  write_depth([](double z) { return z / 100; }, 1e12f);
  EXPECT_EQ(settled().depth_kind, DepthKind::planar);
  ASSERT_EQ(settled().notes.size(), 1);
  EXPECT_EQ(settled().notes[0].code, NoteCode::depth_below_1);
  EXPECT_THAT(settled().notes[0].text, HasSubstr("--depth-kind normalized --near 0 --far F"));
  header.insert("Software", Imf::StringAttribute("Blender 3.4"));
  write_depth([](double z) { return z / 100; }, 1e12f);
  EXPECT_THAT(said(), IsEmpty()) << "it writes distances";
  write_depth([](double z) { return std::sqrt(z / 100); }, 1e12f);
  EXPECT_THAT(said(), testing::ElementsAre(HasSubstr("--depth-kind normalized --near 0 --far F"),
                                           HasSubstr("read as planar, as cycles writes it")))
      << "its Normalize";
}

TEST_F(Doubts, straight_depth_before_the_near_plane_is_refused) {
  give({{"near", 0.1}});
  write_depth([](double z) { return z / 100; }, 1e12f);
  EXPECT_THAT(said(), refused_with("near plane at 0.1"));
  give({{"near", 0.001}});
  EXPECT_THAT(said(), testing::ElementsAre(HasSubstr("less than 1 scene unit")));
}

TEST_F(Doubts, some_surfaces_before_the_near_plane_are_enough) {
  std::vector<double> distances;
  for (const auto& hit : rendering().hits)
    if (hit.primitive >= 0) distances.push_back(hit.distance / 100);
  std::ranges::sort(distances);
  write_depth([](double z) { return z / 100; }, 1e12f);
  give({{"near", distances[distances.size() / 20]}});
  EXPECT_THAT(said(), refused_with("near plane at"));
  give({{"near", distances[distances.size() / 500]}});
  EXPECT_THAT(said(), testing::ElementsAre(HasSubstr("less than 1 scene unit"))) << "planes are rounded";
}

TEST_F(Doubts, distances_beyond_1_are_not_doubted) {
  give();
  write_depth([](double z) { return z; }, 1e12f);
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(Doubts, options_that_the_kind_of_depth_takes_not_are_refused_and_named) {
  give();
  settings.depth_range.near = 0.1;
  settings.depth_range.far = 100;
  settings.depth_range.reversed = true;
  settings.depth_range.device = DeviceRange::minus_one_to_one;
  settings.depth_range.log_constant = 0.5;
  write_depth([](double z) { return z; }, 1e12f);
  const std::string all = "--near, --far, --reversed-z, --set device-range, --set log-constant";
  expect_refused(ErrorKind::usage, {settings.input, all, "planar", "--depth-kind"});
  settings.depth_range = {};
  settings.depth_range.near = 0.1;
  give({{"depth_kind", "log"}, {"far", 100}});
  write_depth([](double z) { return std::log2(1 + z) / std::log2(101.); }, 1);
  settings.depth_range.far = 100;
  expect_refused(ErrorKind::usage, {"--near has no effect", "log"});  // what the camera file says is a kind too
}

TEST_F(Doubts, of_presets_options_that_the_kind_of_depth_takes_not_are_left_out) {
  give();
  settings.depth_range.near = 0.1;
  settings.depth_range.far = 100;
  settings.depth_range.reversed = true;
  settings.from_presets = {"--near", "--far", "--reversed-z"};
  write_depth([](double z) { return z; }, 1e12f);
  EXPECT_THAT(said(), IsEmpty());
  settings.from_presets = {"--near", "--reversed-z"};
  expect_refused(ErrorKind::usage, {"--far has no effect"});
}

TEST_F(Doubts, planes_of_a_camera_file_and_those_that_are_used_are_not_doubted) {
  give({{"near", 0.1}, {"far", 100}});
  write_depth([](double z) { return z; }, 1e12f);
  EXPECT_THAT(said(), IsEmpty()) << "a camera has planes whatever its depth is";
  give();
  settings.depth_kind = DepthKind::normalized;
  settings.depth_range.near = 0;
  settings.depth_range.far = 100;
  settings.depth_range.reversed = true;
  write_depth([](double z) { return 1 - z / 100; }, 0);
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(Doubts, a_z_buffer_that_leaves_out_half_of_its_range_speaks_against_the_option) {
  give();
  write_depth([](double z) { return 1 - 1 / z; }, 1);
  settings.depth_kind = DepthKind::device;
  settings.depth_range.near = 1;
  settings.depth_range.far = std::numeric_limits<double>::infinity();
  settings.depth_range.device = DeviceRange::minus_one_to_one;
  ASSERT_EQ(settled().notes.size(), 1);
  EXPECT_EQ(settled().notes[0].code, NoteCode::said_otherwise);
}

TEST_F(Doubts, a_near_plane_of_0_is_none_of_a_z_buffer) {
  give();
  write_depth([](double z) { return 1 - 1 / z; }, 1);
  settings.depth_kind = DepthKind::device;
  settings.depth_range.near = 0;
  settings.depth_range.far = 100;
  expect_refused(ErrorKind::usage, {"near plane above 0", "--near"});
}

// Cameras.

TEST_F(Doubts, the_right_camera_is_not_doubted) {
  give();
  write_frame();
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(Doubts, pixels_of_another_shape_than_the_files_are_warned_of) {
  const double fx = shot().camera.fx;
  write_depth([](double z) { return z; }, 1e12f);
  give({{"fy", 1.78 * fx}});
  ASSERT_EQ(settled().notes.size(), 1);
  EXPECT_EQ(settled().notes[0].code, NoteCode::said_otherwise);
  EXPECT_THAT(settled().notes[0].text, AllOf(HasSubstr(settings.camera), HasSubstr("pixel is 1.78 times as wide")));
  give({{"fy", 1.001 * fx}});
  EXPECT_THAT(said(), IsEmpty()) << "numbers are rounded";
}

TEST_F(Doubts, a_camera_that_was_scaled_is_noted_since_crops_look_like_proxies) {
  const Camera& c = shot().camera;
  write_depth([](double z) { return z; }, 1e12f);
  give({{"resolution", {320, 240}}, {"fx", 2 * c.fx}, {"fy", 2 * c.fy}, {"cx", 160}, {"cy", 120}});
  ASSERT_EQ(settled().notes.size(), 1);
  EXPECT_EQ(settled().notes[0].code, NoteCode::camera_scaled);
  EXPECT_THAT(settled().notes[0].text, AllOf(HasSubstr(settings.camera), HasSubstr("320x240"), HasSubstr("160x120")));
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
  EXPECT_THAT(said(), refused_with("--chan-rotation xyz"));
  settings.chan_rotation = "xyz";
  EXPECT_THAT(said(), IsEmpty());
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

TEST_F(Doubts, a_view_that_no_file_names_is_warned_of) {
  give();
  write_depth([](double z) { return z; }, 1e12f);
  settings.view = "left";
  EXPECT_THAT(said(), testing::ElementsAre(HasSubstr("--view left chooses nothing")));
}

TEST_F(Doubts, an_inverted_matrix_is_refused_and_named) {
  for (const bool is_said : {false, true}) {
    give(is_said ? json{{"normal_space", "world"}} : json::object(), camera_to_world(1));
    write_frame();
    EXPECT_THAT(said(), testing::ElementsAre("refused", AllOf(HasSubstr("camera_to_world: give the inverse"),
                                                              HasSubstr("camera.json"), HasSubstr("--normal none"))))
        << is_said;
  }
}

TEST_F(Doubts, a_camera_of_another_convention_is_refused_and_named) {
  Rows rows = world_to_camera(1);
  for (const std::size_t i : {1, 2})
    for (double& x : rows[i]) x = -x;
  give({{"normal_space", "world"}}, rows);
  write_frame();
  EXPECT_THAT(said(), refused_with("OpenCV"));
  rows = world_to_camera(1);
  for (auto& row : rows) row = {row[0], row[2], -row[1], row[3]};
  give({{"normal_space", "world"}}, rows);
  EXPECT_THAT(said(), refused_with("another axis up"));
}

TEST_F(Doubts, view_normals_of_a_camera_along_an_axis_are_not_those_of_a_turned_world) {
  FrameFile file = wall_frame();  // its camera is level and looks along the world's y
  file.rename("ViewLayer.Depth.Z", "Z");
  file.rename("ViewLayer.Normal.X", "N.X");
  file.rename("ViewLayer.Normal.Z", "N.Y");
  file.rename("ViewLayer.Normal.Y", "N.Z");
  for (float& z : file.planes["N.Z"]) z = -z;
  file.write(settings.input);
  settings.camera = folder / "camera.json";
  json camera = wall_camera();
  camera.erase("normal_space");
  write_bytes(settings.camera, camera.dump());
  EXPECT_THAT(said(), testing::ElementsAre(HasSubstr("normal space taken as view")));
}

TEST_F(Doubts, normals_that_agree_with_nothing_are_refused) {
  give({{"normal_space", "world"}});
  planes.clear();
  depth("Z", planar, 1e12f);
  vectors("N", "XYZ", [](const test::Hit& hit) { return unit(cross(hit.normal, Vec3{0.31, 0.52, 0.79})); });
  write(settings.input);
  EXPECT_THAT(said(),
              testing::ElementsAre("refused", AllOf(HasSubstr("nor in any other space"), HasSubstr("--normal-encoding"),
                                                    HasSubstr("--normal none"))));
  settings.normal = "none";
  EXPECT_THAT(said(), IsEmpty());
  EXPECT_THAT(settled()[RawPlane::normal], IsEmpty());
}

TEST_F(Doubts, half_floats_refute_no_normals) {
  settings.camera = folder / "camera.json";
  write_bytes(settings.camera, wall_camera().dump());
  FrameFile file = wall_frame();
  for (const auto& [component, value] : {std::pair("X", 0.9f), {"Y", 0.3f}, {"Z", 0.3f}})
    std::ranges::fill(file.planes[std::string("ViewLayer.Normal.") + component], value);
  file.write(settings.input);
  EXPECT_THAT(said(), refused_with("nor in any other space"));
  file.halves = {"ViewLayer.Depth.Z"};
  file.write(settings.input);
  EXPECT_THAT(said(), Contains(HasSubstr("only 0 % of the normals agree with depth")));
}

/// A part of the rendering whose optical axis is not in its middle.
class OffCentre : public Doubts {
 protected:
  static constexpr int kLeft = 48, kWidth = 160 - kLeft;  // columns that are cut off, and that stay

  void write_part(bool with_normals) const {
    FrameFile file{{0, 0, kWidth, 120}, {0, 0, kWidth, 120}, 1, {}, {}, {}};
    for (std::size_t i = 0; i < rendering().hits.size(); i++) {
      if (int(i % 160) < kLeft) continue;
      const test::Hit& hit = rendering().hits[i];
      const Vec3 n = hit.primitive < 0 ? Vec3{} : hit.normal;
      file.planes["Z"].push_back(hit.primitive < 0 ? 1e12f : float(hit.distance));
      if (!with_normals) continue;
      file.planes["N.X"].push_back(float(n.x));
      file.planes["N.Y"].push_back(float(n.y));
      file.planes["N.Z"].push_back(float(n.z));
    }
    file.write(settings.input);
  }
};

TEST_F(OffCentre, a_mirrored_principal_point_is_refused_with_the_right_one) {
  write_part(true);
  give({{"resolution", {kWidth, 120}}, {"cx", kWidth - 32}});
  EXPECT_THAT(said(), refused_with("\"cx\": 32"));
}

TEST_F(OffCentre, a_principal_point_that_belongs_into_the_centre_is_refused) {
  write_frame();
  give({{"cx", 120}});
  EXPECT_THAT(said(), refused_with("\"cx\": 80, \"cy\": 60, the centre"));
}

TEST_F(OffCentre, the_right_principal_point_is_not_doubted) {
  write_part(true);
  give({{"resolution", {kWidth, 120}}, {"cx", 32}});
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(OffCentre, a_principal_point_that_no_pixel_shows_is_noted) {
  write_part(false);
  give({{"resolution", {kWidth, 120}}, {"cx", 32}});
  ASSERT_EQ(settled().notes.size(), 1);
  EXPECT_EQ(settled().notes[0].code, NoteCode::principal_point);
  EXPECT_THAT(settled().notes[0].text, HasSubstr("(32, 60)"));
  give({{"resolution", {kWidth, 120}}, {"cx", kWidth / 2}});
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(Doubts, another_field_of_view_that_fits_is_named) {
  write_frame();
  give({{"fx", 2 * shot().camera.fx}, {"fy", 2 * shot().camera.fy}});
  ASSERT_EQ(settled().notes.size(), 1);
  EXPECT_EQ(settled().notes[0].code, NoteCode::field_of_view);
  EXPECT_THAT(settled().notes[0].text, HasSubstr("about 60 degrees"));
}

// Normals that cannot be used.

TEST_F(Doubts, world_normals_without_a_matrix_are_refused_with_what_works) {
  header.insert("Software", Imf::StringAttribute("Blender 3.4"));
  write_frame();
  settings.fov = kFov;
  for (const char* source : {"auto", "cycles"}) {
    settings.source = source;
    EXPECT_THAT(said(), testing::ElementsAre("refused", AllOf(HasSubstr("world_to_camera"), HasSubstr("--normal none"),
                                                              testing::Not(HasSubstr("--normal-space view")))));
  }
  settings.normal = "none";
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(Doubts, normals_of_an_unknown_program_without_a_matrix_are_refused_with_all_that_may_be_wrong) {
  write_frame();
  settings.fov = kFov;
  EXPECT_THAT(said(),
              testing::ElementsAre("refused", AllOf(HasSubstr("world_to_camera"), HasSubstr("--fov"),
                                                    HasSubstr("--normal-encoding"), HasSubstr("--normal none"))));
}

// What harms AO is found with the settling.

TEST_F(Doubts, what_is_suspicious_is_known_to_whoever_settles_a_frame) {
  give();
  write_frame();
  EXPECT_THAT(texts_of(settled().suspicious), IsEmpty());
  for (const char* name : {"N.X", "N.Y", "N.Z"})
    for (std::size_t i = 0; i < planes[name].size(); i += 4) planes[name][i] *= 0.5f;
  write(settings.input);
  ASSERT_EQ(settled().suspicious.size(), 1);
  EXPECT_EQ(settled().suspicious[0].code, NoteCode::shortened_normals);
  EXPECT_THAT(warnings_of(settled().suspicious), testing::SizeIs(1));
}

TEST_F(Doubts, normals_that_the_program_always_averages_are_no_warning) {
  add_matrices(header, true);
  for (const char* program : {"Blender 4.2", "Blender 5.0"}) {
    header.insert("Software", Imf::StringAttribute(program));
    planes.clear();
    depth("Depth.Z", planar, 1e10f);
    vectors("Normal", "XYZ", world_normal);
    for (const char* name : {"Normal.X", "Normal.Y", "Normal.Z"})
      for (std::size_t i = 0; i < planes[name].size(); i += 4) planes[name][i] *= 0.5f;
    write(settings.input);
    const Notes suspicious = settled().suspicious;
    ASSERT_EQ(suspicious.size(), 1) << program;
    EXPECT_EQ(suspicious[0].code, NoteCode::averaged_normals) << program;
    EXPECT_THAT(warnings_of(suspicious), IsEmpty()) << program;
  }
}

}  // namespace
}  // namespace alcove
