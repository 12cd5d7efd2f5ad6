// A rendering as a file with the camera file of its shot; and how it is settled, noted or refused.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/frame/settle/settle.h"
#include "tests/support/program.h"
#include "tests/support/scenes.h"
#include "tests/support/wall_frame.h"

namespace alcove::test {

/// Finds the frame that the settings name, reads its depth and normals, and settles what neither options nor headers
/// say. Fails as these steps do.
inline FrameSource settled(const InputSettings& settings) {
  FrameSource source = find_frame(settings, false, 0);
  settle(source, settings, read_raw_frame(source, source.reading.data));
  return source;
}

/// The camera file of a shot.
inline json camera_of(const Shot& shot) {
  const Camera& c = shot.camera;
  const Vec3 offset = -shot.view_from_world(shot.eye);
  const auto row = [](Vec3 axis, double by) { return json{axis.x, axis.y, axis.z, by}; };
  json camera = {{"resolution", {c.width, c.height}}, {"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy}};
  if (c.orthographic) camera["projection"] = "orthographic";
  camera["world_to_camera"] = {
      row(shot.right, offset.x), row(shot.up, offset.y), row(shot.back, offset.z), {0, 0, 0, 1}};
  return camera;
}

/// The matrix that a game has of the lens of a camera file, with its third row; it looks along z times `side`.
inline json game_matrix(const json& camera, const json& third_row, int side) {
  const double width = camera["resolution"][0], height = camera["resolution"][1], fx = camera["fx"], fy = camera["fy"],
               cx = camera["cx"], cy = camera["cy"];
  return {{2 * fx / width, 0, side * (2 * cx / width - 1), 0},
          {0, 2 * fy / height, side * (1 - 2 * cy / height), 0},
          third_row,
          {0, 0, side, 0}};
}

/// Z, and where normals are given N.X, N.Y, N.Z, which are 0 in the sky.
inline FrameFile file_of(const Rendering& rendering, float sky, const std::function<double(const Hit&)>& depth,
                         const std::function<Vec3(const Hit&)>& normal = nullptr) {
  FrameFile file{rendering.shot.data, rendering.shot.display, 1, {}, {}, {}};
  for (const auto& hit : rendering.hits) {
    const bool is_sky = hit.primitive < 0;
    file.planes["Z"].push_back(is_sky ? sky : float(depth(hit)));
    if (!normal) continue;
    const Vec3 n = is_sky ? Vec3{} : normal(hit);
    file.planes["N.X"].push_back(float(n.x));
    file.planes["N.Y"].push_back(float(n.y));
    file.planes["N.Z"].push_back(float(n.z));
  }
  return file;
}
inline double planar(const Hit& hit) { return hit.distance; }

/// What settling a frame leads to: not a word, one note, or an error.
enum class Reply { silent, noted, refused, usage };

class SettledFile : public testing::Test {
 protected:
  SettledFile() { settings.input = folder / "frame.exr"; }

  void give(const json& camera) {
    settings.camera = folder / "camera.json";
    write_bytes(settings.camera, camera.dump());
  }

  FrameSource settled() const { return test::settled(settings); }

  /// The notes as they are printed; or what an error says, behind its kind.
  std::vector<std::string> said() const {
    try {
      std::vector<std::string> lines;
      for (const auto& note : settled().notes) lines.push_back(line_of(note, settings.input));
      return lines;
    } catch (const Error& error) {
      const char* kind = error.kind() == ErrorKind::usage   ? "usage: "
                         : error.kind() == ErrorKind::input ? "refused: "
                                                            : "failed: ";
      return {kind + std::string(error.what())};
    }
  }

  /// The reply is this, in one line that holds the words.
  void expect(Reply reply, const std::vector<std::string>& words = {}) const {
    const auto lines = said();
    SCOPED_TRACE(testing::PrintToString(lines));
    ASSERT_EQ(lines.size(), reply == Reply::silent ? 0 : 1);
    if (lines.empty()) return;
    EXPECT_EQ(lines[0].starts_with("refused: "), reply == Reply::refused);
    EXPECT_EQ(lines[0].starts_with("usage: "), reply == Reply::usage);
    for (const auto& word : words) EXPECT_THAT(lines[0], HasSubstr(word));
  }

  TemporaryFolder folder;
  InputSettings settings;
};

}  // namespace alcove::test
