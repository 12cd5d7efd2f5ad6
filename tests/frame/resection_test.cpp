// Cameras are found from the points that they see.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/resection.h"

#include "core/formats/exr.h"
#include "core/inspect/inspect.h"
#include "tests/support/command_line.h"
#include "tests/support/scenes.h"

namespace alcove::resection_test {
namespace {

using namespace test;

const Window kPicture{0, 0, 320, 180};

/// Turned about x, then y, then z.
Matrix3 turned(double x, double y, double z) {
  const Matrix3 about_x{{{1, 0, 0}, {0, std::cos(x), -std::sin(x)}, {0, std::sin(x), std::cos(x)}}};
  const Matrix3 about_y{{{std::cos(y), 0, std::sin(y)}, {0, 1, 0}, {-std::sin(y), 0, std::cos(y)}}};
  const Matrix3 about_z{{{std::cos(z), -std::sin(z), 0}, {std::sin(z), std::cos(z), 0}, {0, 0, 1}}};
  return product(about_z, product(about_y, about_x));
}

Camera made_camera(bool orthographic = false) {
  Camera camera;
  camera.width = kPicture.width;
  camera.height = kPicture.height;
  camera.fx = camera.fy = orthographic ? 40 : 311;
  camera.cx = 160;
  camera.cy = 90;
  camera.orthographic = orthographic;
  camera.view_from_world = turned(0.7, -0.4, 1.9);
  camera.view_from_world_offset = {-3, 2, -7};
  return camera;
}

/// Pixels of a picture of uneven things: what the camera sees at them, at depths of 4 to 12.
std::vector<SeenPoint> seen_by(const Camera& camera, double far = 12) {
  std::vector<SeenPoint> points;
  const Matrix3 world_from_view =
      transposed(camera.view_from_world.value_or(Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}));
  for (int y = 4; y < kPicture.height; y += 8)
    for (int x = 4; x < kPicture.width; x += 8) {
      const double depth = 4 + (far - 4) * (0.5 + 0.5 * std::sin(0.31 * x + 0.7 * y));
      const double along = camera.orthographic ? 1 : depth;
      const Vector3 view{(x + 0.5 - camera.cx) / camera.fx * along, -(y + 0.5 - camera.cy) / camera.fy * along, -depth};
      points.push_back({times(world_from_view, difference(view, camera.view_from_world_offset)), x + 0.5, y + 0.5});
    }
  return points;
}

Resection found(const std::vector<SeenPoint>& points) {
  const auto result = resection_of(points, kPicture);
  EXPECT_TRUE(std::holds_alternative<Resection>(result)) << std::get<NoResection>(result).why;
  return std::holds_alternative<Resection>(result) ? std::get<Resection>(result) : Resection{};
}

std::string reason(const std::vector<SeenPoint>& points) {
  const auto result = resection_of(points, kPicture);
  EXPECT_TRUE(std::holds_alternative<NoResection>(result));
  return std::holds_alternative<NoResection>(result) ? std::get<NoResection>(result).why : "";
}

void expect_same(const Camera& camera, const Camera& expected, double within) {
  EXPECT_EQ(camera.orthographic, expected.orthographic);
  EXPECT_NEAR(camera.fx / expected.fx, 1, within);
  EXPECT_NEAR(camera.fy / expected.fy, 1, within);
  if (!expected.orthographic) {
    EXPECT_NEAR(camera.cx, expected.cx, within * 320);
    EXPECT_NEAR(camera.cy, expected.cy, within * 320);
  }
  ASSERT_TRUE(camera.view_from_world);
  for (std::size_t row = 0; row < 3; row++)
    for (std::size_t column = 0; column < 3; column++)
      EXPECT_NEAR((*camera.view_from_world)[row][column], (*expected.view_from_world)[row][column], within)
          << row << ", " << column;
}

TEST(Resections, find_the_camera_of_perspective_views) {
  Camera camera = made_camera();
  const Resection plain = found(seen_by(camera));
  expect_same(plain.camera, camera, 1e-9);
  EXPECT_TRUE(plain.camera.view_from_world);
  EXPECT_EQ(plain.within, 1);
  for (std::size_t k = 0; k < 3; k++)
    EXPECT_NEAR(plain.camera.view_from_world_offset[k], camera.view_from_world_offset[k], 1e-8);
  camera.cx = 40, camera.cy = 130;  // lens shift
  expect_same(found(seen_by(camera)).camera, camera, 1e-9);
  camera.fy = 622;  // pixels twice as wide as high
  expect_same(found(seen_by(camera)).camera, camera, 1e-9);
  camera.fx = camera.fy = 3000;  // 6 degrees
  expect_same(found(seen_by(camera)).camera, camera, 1e-7);
  camera.view_from_world_offset = {20000, -5000, 300};  // far from the origin
  expect_same(found(seen_by(camera)).camera, camera, 1e-6);
}

TEST(Resections, find_the_camera_of_orthographic_views) {
  const Camera camera = made_camera(true);
  const auto points = seen_by(camera);
  const Resection result = found(points);
  expect_same(result.camera, camera, 1e-9);
  // All of it is in front, and where the pixels show it.
  for (const auto& seen : points) {
    const Vector3 turned = times(*result.camera.view_from_world, seen.position);
    const auto& offset = result.camera.view_from_world_offset;
    EXPECT_LT(turned[2] + offset[2], 0);
    EXPECT_NEAR(result.camera.cx + result.camera.fx * (turned[0] + offset[0]), seen.x, 1e-6);
    EXPECT_NEAR(result.camera.cy - result.camera.fy * (turned[1] + offset[1]), seen.y, 1e-6);
  }
}

TEST(Resections, find_cameras_of_mirrored_worlds) {
  Camera camera = made_camera();
  for (auto& row : *camera.view_from_world) row[1] = -row[1];
  const Resection result = found(seen_by(camera));
  expect_same(result.camera, camera, 1e-9);
  EXPECT_TRUE(result.camera.left_handed);
}

TEST(Resections, tell_positions_in_the_cameras_space) {
  for (const bool orthographic : {false, true}) {
    Camera camera = made_camera(orthographic);
    camera.view_from_world.reset();
    camera.view_from_world_offset = {};
    auto points = seen_by(camera);
    for (const bool looks_along_z : {false, true}) {
      const Resection result = found(points);
      EXPECT_FALSE(result.camera.view_from_world);
      EXPECT_EQ(result.camera.left_handed, looks_along_z);
      EXPECT_NEAR(result.camera.fx, camera.fx, 1e-6);
      if (orthographic) break;  // nothing tells on which side of it the points are
      for (auto& seen : points) seen.position[2] = -seen.position[2];
    }
  }
}

TEST(Resections, do_not_mind_some_points_that_lie_elsewhere) {
  const Camera camera = made_camera();
  auto points = seen_by(camera);
  std::mt19937 random(5);
  std::normal_distribution<double> off(0, 1);
  for (std::size_t i = 0; i < points.size(); i += 11)
    for (auto& x : points[i].position) x += off(random);
  const Resection result = found(points);
  expect_same(result.camera, camera, 1e-9);
  EXPECT_NEAR(result.within, 10.0 / 11, 0.01);
}

TEST(Resections, take_rounded_positions_for_what_they_are) {
  const Camera camera = made_camera();
  auto points = seen_by(camera);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> rounding(-1, 1);
  for (auto& seen : points) {
    for (auto& x : seen.position) x += rounding(random) * 0x1p-9;  // half floats of 4 to 8
    seen.rounding = 1;
  }
  expect_same(found(points).camera, camera, 1e-3);
  for (auto& seen : points) seen.rounding = 0;
  EXPECT_THAT(reason(points), HasSubstr("px of their pixels"));
}

TEST(Resections, tell_flat_things_in_perspective_from_orthographic_views) {
  const Camera camera = made_camera();
  auto points = seen_by(camera, 4.1);
  for (auto& seen : points) seen.rounding = 4;  // within which an orthographic view would do
  expect_same(found(points).camera, camera, 1e-6);
}

TEST(Resections, are_refused_where_many_cameras_see_the_same) {
  Camera camera = made_camera();
  auto points = seen_by(camera);
  for (auto& seen : points) {
    const Vector3 there = times(*camera.view_from_world, seen.position);
    // Where its ray meets one plane.
    const Vector3 view{there[0] + camera.view_from_world_offset[0], there[1] + camera.view_from_world_offset[1],
                       there[2] + camera.view_from_world_offset[2]};
    const double scale = -6 / (view[2] + 0.2 * view[0]);
    seen.position =
        times(transposed(*camera.view_from_world), difference(scaled(view, scale), camera.view_from_world_offset));
  }
  EXPECT_THAT(reason(points), HasSubstr("in one plane"));
  points.resize(20);
  EXPECT_THAT(reason(points), HasSubstr("only 20"));
  auto anywhere = seen_by(camera);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-5, 5);
  for (auto& seen : anywhere)
    for (auto& x : seen.position) x = place(random);
  EXPECT_THAT(reason(anywhere), HasSubstr("no positions"));
}

using Plane = std::vector<float>;

/// Runs of the program on a frame with positions.
class PositionPass : public CommandLine {
 protected:
  /// The floor, the wall and a board before it, and where each pixel lies in the world.
  void write_positions(const std::string& layer) const {
    FrameFile file = wall_frame();
    Plane& depth = file.planes.at("ViewLayer.Depth.Z");
    for (int y = 0; y < 36; y++)
      for (int x = 0; x < 64; x++)
        if (x > 20 && x < 40 && y > 8 && y < 26) depth[std::size_t(y * 64 + x)] = 2.5F;
    const Camera seen = read_camera(camera, 0);
    for (std::size_t i = 0; i < depth.size(); i++) {
      const double z = depth[i];
      const Vector3 view{(double(i % 64) + 0.5 - seen.cx) / seen.fx * z,
                         -(double(i / 64) + 0.5 - seen.cy) / seen.fy * z, -z};
      const Vector3 world = times(transposed(*seen.view_from_world), difference(view, seen.view_from_world_offset));
      for (std::size_t k = 0; k < 3; k++)
        file.planes[layer + "." + std::string(1, "XYZ"[k])].push_back(float(world[k]));
    }
    file.write(frame);
  }

  Finished run_by(const Options& more) const {
    return run_program(joined({"run", frame, "-o", ao, "--type", "float", "--radius", "1"}, more));
  }
  Plane ao_of(const Options& options) const {
    const Finished finished = run_by(options);
    EXPECT_EQ(finished.code, 0) << finished;
    return read_exr_image(ao).pixels;
  }
  /// Other positions, component by component.
  void write_instead(const std::function<double(int component, int x, int y)>& position) const {
    FrameFile file = wall_frame();
    for (int c = 0; c < 3; c++)
      for (int y = 0; y < 36; y++)
        for (int x = 0; x < 64; x++)
          file.planes[std::string("ViewLayer.Position.") + "XYZ"[c]].push_back(float(position(c, x, y)));
    file.write(frame);
  }
};

/// Points that rays of a panorama see from a place in the world, turned in any way.
std::vector<SeenPoint> points_along(const std::function<Vector3(double x, double y)>& ray, const Window& picture) {
  const Matrix3 world_from_view = transposed(turned(0.7, -0.4, 1.9));
  std::vector<SeenPoint> points;
  for (int y = 2; y < picture.height; y += 6)
    for (int x = 2; x < picture.width; x += 6) {
      const double distance = 4 + 3 * std::sin(0.31 * x + 0.7 * y);
      const Vector3 direction = ray(x + 0.5 - 0.5 * picture.width, 0.5 * picture.height - y - 0.5);
      const Vector3 there = times(world_from_view, scaled(direction, distance));
      points.push_back({{there[0] + 5, there[1] - 2, there[2] + 30}, x + 0.5, y + 0.5});
    }
  return points;
}

TEST(Panoramas, are_known_by_the_points_that_they_see) {
  const auto sphere = [](double longitude, double latitude) {
    return Vector3{std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                   -std::cos(longitude) * std::cos(latitude)};
  };
  const double pi = std::numbers::pi;
  const auto whole =
      points_along([&](double x, double y) { return sphere(x * pi / 90, y * pi / 90); }, {0, 0, 180, 90});
  EXPECT_EQ(panorama_of(whole, {0, 0, 180, 90}), "equirectangular, 360 degrees wide");
  const auto half = points_along([&](double x, double y) { return sphere(x * pi / 90, y * pi / 90); }, {0, 0, 90, 90});
  EXPECT_EQ(panorama_of(half, {0, 0, 90, 90}), "equirectangular, 180 degrees wide");
  const auto cylinder = points_along(
      [&](double x, double y) {
        return Vector3{std::sin(x * pi / 90), y * pi / 90, -std::cos(x * pi / 90)};
      },
      {0, 0, 180, 60});
  EXPECT_EQ(panorama_of(cylinder, {0, 0, 180, 60}), "cylindrical, 360 degrees wide");
  const auto fish_eye = points_along(
      [&](double x, double y) {
        const double radius = std::hypot(x, y), angle = radius * pi / 90;
        return Vector3{x / radius * std::sin(angle), y / radius * std::sin(angle), -std::cos(angle)};
      },
      {0, 0, 90, 90});
  EXPECT_EQ(panorama_of(fish_eye, {0, 0, 90, 90}), "fish eye");
  EXPECT_EQ(panorama_of(seen_by(made_camera()), kPicture), "");
}

/// Points with each position changed.
std::vector<SeenPoint> changed(std::vector<SeenPoint> points, const std::function<void(Vector3& position)>& change) {
  for (auto& seen : points) change(seen.position);
  return points;
}

std::string stretched_by(const std::vector<SeenPoint>& points, double pixel_aspect = 1) {
  const auto found = resection_of(points, kPicture);
  return why_stretched(points, kPicture, std::get_if<Resection>(&found), pixel_aspect);
}

TEST(PositionFaults, that_components_were_cut_is_told) {
  const auto points = seen_by(made_camera());
  const auto cut = changed(points, [](Vector3& p) {
    for (double& x : p) x = std::max(x, 0.0);
  });
  EXPECT_THAT(why_cut(cut, kPicture), HasSubstr("cut at 0"));
  const auto cut_at_1 = changed(points, [](Vector3& p) {
    for (double& x : p) x = std::min(x, 1.0);
  });
  EXPECT_THAT(why_cut(cut_at_1, kPicture), HasSubstr("cut at 1"));
  EXPECT_EQ(why_cut(points, kPicture), "");
  // A floor at 0 below all else, through a bent lens, is none.
  auto bent = points;
  for (std::size_t i = 0; i < bent.size(); i++) {
    for (double& x : bent[i].position) x = std::abs(x) + 0.1;
    if (i % 3 == 0) bent[i].position[1] = 0;
    bent[i].x += 20 * std::sin(double(i));
  }
  EXPECT_EQ(why_cut(bent, kPicture), "");
}

TEST(PositionFaults, that_axes_were_stretched_is_told) {
  const auto points = seen_by(made_camera());
  const auto stretch = [](Vector3& p) { p = {3 * p[0], 0.5 * p[1], p[2]}; };
  EXPECT_THAT(stretched_by(changed(points, stretch)), HasSubstr("stretched along their axes"));
  EXPECT_EQ(stretched_by(points), "");
  // Without a turn the stretched world has a camera, of pixels that are not square.
  Camera level = made_camera();
  level.view_from_world = turned(0, 0, 0);
  const auto boxed = changed(seen_by(level), [](Vector3& p) {
    p = {(p[0] + 3.2) / 12.4, (p[1] + 5.5) / 7, (p[2] + 5.1) / 8.2};
  });
  EXPECT_THAT(stretched_by(boxed), HasSubstr("a normalized bounding box"));
  const auto flat = seen_by(made_camera(), 4);
  EXPECT_EQ(stretched_by(flat) + why_bent(flat, kPicture), "") << "one wall is seen alike by many cameras";
  const auto wide = changed(seen_by(level), [](Vector3& p) { p[0] *= 2; });
  EXPECT_EQ(stretched_by(wide), "") << "it may be anamorphic";
}

TEST(PositionFaults, that_the_lens_bends_lines_is_told) {
  for (const double bend : {-0.1, 0.05, 0.4}) {
    auto points = seen_by(made_camera());
    for (auto& seen : points) {
      const double x = (seen.x - 160) / 160, y = (seen.y - 90) / 160, more = 1 + bend * (x * x + y * y);
      seen.x = 160 + 160 * x * more;
      seen.y = 90 + 160 * y * more;
    }
    for (std::size_t i = 0; i < points.size(); i += 31) points[i].position[0] += 1;  // of edges
    EXPECT_THAT(why_bent(points, kPicture), HasSubstr("distorted")) << bend;
    EXPECT_EQ(why_cut(points, kPicture) + stretched_by(points), "") << bend;
  }
  auto shaken = seen_by(made_camera());
  for (std::size_t i = 0; i < shaken.size(); i++) shaken[i].x += 3 * std::sin(double(i * i));
  EXPECT_EQ(why_bent(shaken, kPicture) + stretched_by(shaken), "");
}

TEST_F(PositionPass, disagrees_with_depth_of_another_unit_plane_or_frame) {
  write_positions("ViewLayer.Position");
  const FrameFile right = [&] {
    FrameFile file = wall_frame();
    const Image image = read_exr_image(frame);
    for (const auto& name : image.names) {
      const auto plane = image.plane(name);
      file.planes[name] = {plane.begin(), plane.end()};
    }
    return file;
  }();
  const auto said = [&](const std::function<float(float)>& depth) {
    FrameFile file = right;
    for (float& z : file.planes.at("ViewLayer.Depth.Z")) z = depth(z);
    file.write(frame);
    return run_by({"--normal", "none", "--depth-kind", "planar"}).err;
  };
  const auto disagree = HasSubstr("[positions-disagree]");
  EXPECT_THAT(said([](float z) { return z; }), Not(disagree));
  EXPECT_THAT(said([](float z) { return 100 * z; }), AllOf(disagree, HasSubstr("--depth-scale 0.01 ")));
  EXPECT_THAT(said([](float z) { return z - 1.5F; }), AllOf(disagree, HasSubstr("theirs less 1.5,")));
  EXPECT_THAT(said([](float z) { return z * z; }), AllOf(disagree, HasSubstr("of another kind")));
}

TEST_F(PositionPass, gives_the_camera_that_nobody_said_and_its_file) {
  write_positions("ViewLayer.Position");
  const Plane by_file = ao_of({"--camera", camera}), by_positions = ao_of({});
  EXPECT_EQ(by_file.size(), kWallWindow.pixels());
  EXPECT_LT(difference(by_positions, by_file).max, 0.002);
  EXPECT_LT(difference(ao_of({"--depth-kind", "position"}), by_file).max, 0.002);
  const std::string written = folder / "written.json";
  const Finished inspected = run_well({"inspect", frame, "--write-camera", written});
  EXPECT_THAT(inspected.out, AllOf(HasSubstr("by its positions"), Not(HasSubstr("missing: camera"))));
  expect_same(read_camera(written, 0), read_camera(camera, 0), 1e-5);
  EXPECT_EQ(ao_of({"--camera", written}), by_positions);
  write_positions("strange");
  const Finished without = run_by({});
  EXPECT_EQ(without.code, 2) << without;
  EXPECT_THAT(without.err, HasSubstr("--camera"));
  EXPECT_LT(difference(ao_of({"--set", "position-channels=strange"}), by_file).max, 0.002);
}

TEST_F(PositionPass, of_a_sequence_is_written_with_its_frames) {
  write_positions("ViewLayer.Position");
  for (const char* number : {"7", "9"}) write_bytes(folder / "shot.000" + number + ".exr", read_bytes(frame));
  const std::string written = folder / "written.json";
  run_well({"inspect", folder / "shot.####.exr", "--write-camera", written});
  expect_same(read_camera(written, 9), read_camera(camera, 0), 1e-5);
  EXPECT_THROW(read_camera(written, 8), Error);
}

TEST_F(PositionPass, refutes_a_lens_by_pixels) {
  write_positions("ViewLayer.Position");
  const Camera right = read_camera(camera, 0);
  const double degrees = 2 * std::atan(32 / right.fx) * 180 / std::numbers::pi;
  const auto warned = [&](const Options& options) {
    const Finished finished = run_by(joined(options, {"--normal", "none"}));
    EXPECT_EQ(finished.code, 0) << finished;
    return finished.err;
  };
  const auto refutes = HasSubstr("px from their pixels");
  EXPECT_THAT(warned({"--fov", fmt::format("{}", degrees)}), Not(refutes));
  EXPECT_THAT(warned({"--fov", fmt::format("{}", degrees + 0.2)}), Not(refutes)) << "it is rounded";
  EXPECT_THAT(warned({"--fov", "90"}),
              AllOf(HasSubstr("by --fov 90"), refutes, HasSubstr(fmt::format("--fov {:.5g}", degrees))));
  EXPECT_THAT(warned({"--ortho-width", "5"}), AllOf(HasSubstr("by --ortho-width"), refutes));
  EXPECT_THAT(warned({"--camera", camera}), Not(refutes));
}

TEST_F(PositionPass, show_a_camera_of_another_frame) {
  write_positions("ViewLayer.Position");
  const auto said = [&](double shift) {
    json moved = json::parse(read_bytes(camera));
    moved["world_to_camera"][0][3] = moved["world_to_camera"][0][3].get<double>() + shift;
    write_bytes(folder / "moved.json", moved.dump());
    return run_by({"--camera", folder / "moved.json", "--normal", "none"}).err;
  };
  EXPECT_THAT(said(0.2),
              AllOf(HasSubstr("turned by 0.00 degrees and moved by 0.2"), HasSubstr("[positions-disagree]")));
  EXPECT_THAT(said(0), Not(HasSubstr("[positions-disagree]")));
  EXPECT_THAT(said(1000), Not(HasSubstr("[positions-disagree]"))) << "a world of its own";
}

TEST_F(PositionPass, that_no_camera_fits_is_told_beside_a_lens) {
  write_instead([](int c, int x, int y) {  // smooth, and seen along the rays of no lens
    const double longitude = 0.07 * x, latitude = 0.05 * (y - 18), distance = 3 + 0.1 * std::sin(0.3 * x + 0.2 * y);
    return distance * Vector3{std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                              std::cos(longitude) * std::cos(latitude)}[std::size_t(c)];
  });
  EXPECT_THAT(run_by({"--normal", "none", "--fov", "50"}).err,
              AllOf(HasSubstr("no camera fits"), HasSubstr("--fov 50 is taken")));
}

TEST_F(PositionPass, that_is_none_is_told) {
  std::mt19937 random(5);
  write_instead([&](int, int, int) { return random() % 1000; });
  const Finished finished = run_by({});
  EXPECT_EQ(finished.code, 2) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr(frame), HasSubstr("its positions tell none"), HasSubstr("--camera")));
  const Finished inspected = run_well({"inspect", frame});
  EXPECT_THAT(inspected.out, HasSubstr("its positions tell none"));
}

TEST(ResectedCameras, are_read_as_they_were_written) {
  const TemporaryFolder folder;
  const std::string path = folder / "camera.json";
  Camera camera = made_camera();
  camera.near = 0.1;
  camera.far = INFINITY;
  camera.reversed_z = true;
  for (const bool left_handed : {false, true}) {
    camera.left_handed = left_handed;
    if (left_handed)
      for (auto& row : *camera.view_from_world) row[1] = -row[1];
    write_bytes(path, camera_file(camera));
    const Camera read = read_camera(path, 0);
    expect_same(read, camera, 1e-12);
    EXPECT_EQ(read.left_handed, left_handed);
    EXPECT_EQ(read.near, camera.near);
    EXPECT_EQ(read.far, camera.far);
    EXPECT_TRUE(read.reversed_z);
    for (std::size_t k = 0; k < 3; k++)
      EXPECT_NEAR(read.view_from_world_offset[k], camera.view_from_world_offset[k], 1e-12);
  }
}

}  // namespace
}  // namespace alcove::resection_test
