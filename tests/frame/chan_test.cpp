// .chan files, as Blender's add-on writes them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/camera.h"
#include "tests/support/command_line.h"
#include "tests/support/test.h"

namespace alcove::chan_test {
namespace {

using namespace test;

// One camera, written by Blender 3.4.1 with both orders of rotation, and its matrix by Blender.
const char* const kXyz =
    "1\t1.500000\t-7.000000\t3.000000\t72.000002\t7.000000\t12.000000\t37.849288\n"
    "3\t2.250000\t-6.500000\t2.750000\t73.500007\t-1.000000\t18.499999\t37.849288\n";
const char* const kZxy =
    "# frame x y z rx ry rz vfov\n\n3 2.250000 -6.500000 2.750000 65.622286 46.528031 50.231923 37.849288\n";
const Matrix3 kViewFromWorld{{{0.9481791853904724, 0.3172563314437866, 0.017452409490942955},
                              {-0.10598831623792648, 0.2640286386013031, 0.9586736559867859},
                              {0.2995373606681824, -0.9108442664146423, 0.28397199511528015}}};
const Vector3 kOffset{-0.11923131346702576, -0.6816926598548889, -7.375370025634766};

class Chan : public CommandLine {
 protected:
  void expect_refused(const std::string& text, int frame, const std::vector<std::string>& words) const {
    write_bytes(path, text);
    expect_error(ErrorKind::input, words, [&] { read_chan(path, frame, "zxy", kWallWindow, 1); });
  }

  const std::string path = folder / "camera.chan";
};

TEST_F(Chan, has_the_camera_that_blender_wrote) {
  for (const auto& [text, rotation] : {std::pair(kXyz, "xyz"), std::pair(kZxy, "zxy")}) {
    write_bytes(path, text);
    const Camera camera = read_chan(path, 3, rotation, {0, 0, 360, 240}, 1);
    for (std::size_t row = 0; row < 3; row++) {
      for (std::size_t column = 0; column < 3; column++)
        EXPECT_NEAR((*camera.view_from_world)[row][column], kViewFromWorld[row][column], 1e-6) << rotation;
      EXPECT_NEAR(camera.view_from_world_offset[row], kOffset[row], 1e-5) << rotation;
    }
    // The focal length is 35 mm, and the sensor 36 mm x 24 mm.
    EXPECT_NEAR(camera.fx, 350, 1e-3);
    EXPECT_NEAR(camera.fy, 350, 1e-3);
    EXPECT_EQ(camera.cx, 180);
    EXPECT_EQ(camera.cy, 120);
    EXPECT_NEAR(read_chan(path, 3, rotation, {0, 0, 360, 240}, 2).fx, 175, 1e-3);
  }
}

TEST_F(Chan, gives_frames_of_a_run_their_cameras) {
  // The camera of the wall: z is up, and it looks along y.
  write_bytes(path, "42 -0.5 3 2 90 0 0 33.398488467987\n");
  run_well({"inspect", frame, "--camera", path, "--write-camera", folder / "c.json"});
  const Camera from_chan = read_camera(folder / "c.json", 42), from_json = read_camera(camera, 42);
  EXPECT_NEAR(from_chan.fx, from_json.fx, 1e-6);
  for (std::size_t row = 0; row < 3; row++)
    EXPECT_NEAR(from_chan.view_from_world_offset[row], from_json.view_from_world_offset[row], 1e-9);
  const Finished absent = run_program({"run", frame, "-o", ao, "--camera", path, "--radius", "1", "--frames", "43"});
  EXPECT_NE(absent.code, 0) << absent;
}

TEST_F(Chan, is_refused_where_it_makes_no_sense) {
  expect_refused(kXyz, 2, {path, "no frame 2, but 1, 3", "--camera"});
  expect_refused("1 2 3\n", 1, {"line 1", "3 numbers"});
  expect_refused("1 2 3 4 5 six 7 8\n", 1, {"line 1", "six"});
  expect_refused("1 2 3 4 5 6 nan 8\n", 1, {"nan"});
  expect_refused("1 2 3 4 5 6 7\n", 1, {"frame 1", "no field of view"});
  expect_refused("1 2 3 4 5 6 7 180\n", 1, {"frame 1", "180 degrees"});
}

}  // namespace
}  // namespace alcove::chan_test
