// A scene as renderers write it: channels by their names, attributes and matrices of headers; and how it must be read.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/frame/find/input_rules.h"
#include "core/frame/settle/settle.h"
#include "tests/support/device.h"
#include "tests/support/openexr.h"
#include "tests/support/program.h"
#include "tests/support/scenes.h"
#include "tests/support/wall_frame.h"

namespace alcove::test {

// A rendering as a file with the camera file of its shot; and how it is settled, noted or refused.

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

// Frames of each source.

constexpr double kFov = 60, kFar = 50;

/// A floor, two walls and a ball under sky.
inline Scene scene() {
  return {{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
           parallelogram({0, 2, 0}, {4, 0, 0}, {0, 0, 1.5}), Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}}};
}
inline const Rendering& rendering() {
  static const Rendering made = render(scene(), room_shot(160, 120, false, kFov));
  return made;
}

inline const Shot& shot() { return rendering().shot; }
inline Vec3 mirrored(Vec3 v) { return {v.x, -v.y, v.z}; }
inline Vec3 in_view(Vec3 world) { return shot().view_from_world(world); }
inline Vec3 forward_z(Vec3 view) { return {view.x, view.y, -view.z}; }
inline double ray(const Hit& hit) { return length(hit.position - shot().eye); }

using Rows = std::array<std::array<double, 4>, 4>;  // for column vectors

/// World to a camera space that looks along +z (sign -1) or -z (sign 1).
inline Rows world_to_camera(double sign) {
  const Vec3 axes[] = {shot().right, shot().up, sign * shot().back};
  Rows rows{};
  for (std::size_t i = 0; i < 3; i++) rows[i] = {axes[i].x, axes[i].y, axes[i].z, -dot(axes[i], shot().eye)};
  rows[3] = {0, 0, 0, 1};
  return rows;
}

inline Rows camera_to_world(double sign) {
  const Vec3 axes[] = {shot().right, shot().up, sign * shot().back};
  return {{{axes[0].x, axes[1].x, axes[2].x, shot().eye.x},
           {axes[0].y, axes[1].y, axes[2].y, shot().eye.y},
           {axes[0].z, axes[1].z, axes[2].z, shot().eye.z},
           {0, 0, 0, 1}}};
}

/// World to NDC, through a camera that looks along +z: from 0 with y down, or from -1 with y up.
inline Rows world_to_ndc(bool from_zero) {
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

inline Imf::M44fAttribute matrix(const Rows& rows, bool row_vectors) {
  Imath::M44f m;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      m[i][j] = float(row_vectors ? rows[std::size_t(j)][std::size_t(i)] : rows[std::size_t(i)][std::size_t(j)]);
  return Imf::M44fAttribute(m);
}

inline void add_matrices(Imf::Header& header, bool from_zero, bool row_vectors = true) {
  header.insert("worldToCamera", matrix(world_to_camera(-1), row_vectors));
  header.insert("worldToNDC", matrix(world_to_ndc(from_zero), row_vectors));
}

/// A frame as a program writes it: planes by name, attributes, and how it must be read.
class Sources : public SettledFile {
 protected:
  void depth(const std::string& channel, double (*value)(const Hit&), float sky, double scale = 1) {
    planes[channel] = file_of(rendering(), sky, [&](const Hit& hit) { return scale * value(hit); }).planes.at("Z");
  }

  void vectors(const std::string& layer, const char* components, const std::function<Vec3(const Hit&)>& value,
               float offset = 0, float scale = 1) {
    const Vec3 offsets{offset, offset, offset};
    const FrameFile file =
        file_of(rendering(), 0, planar, [&](const Hit& hit) { return offsets + scale * value(hit); });
    for (std::size_t c = 0; c < 3; c++)
      planes[layer + "." + components[c]] = file.planes.at(std::string("N.") + "XYZ"[c]);
  }

  static Vec3 world_normal(const Hit& hit) { return hit.normal; }
  static Vec3 view_normal(const Hit& hit) { return in_view(hit.normal); }

  void write(const std::string& path) const {
    Imf::Header with_halves = header;
    for (const auto& [name, plane] : planes)
      if (name.ends_with("WorldDepth.R")) with_halves.channels().insert(name, Imf::Channel(Imf::HALF));
    write_openexr(path, with_halves, planes);
  }

  /// The camera file of the scene, for programs that write none.
  void give_camera() { give(camera_of(shot())); }

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
    EXPECT_EQ(source.program.rules->name, program);
    const Difference d = difference(ao_of(read_host_frame(settings, 0), scale), ao_of(rendering().frame, 1));
    EXPECT_LE(tolerance > 1e-3 ? d.rmse : d.max, tolerance) << place(d, rendering().frame);
  }

  void expect_refused(Reply reply, const std::vector<std::string>& words) {
    write(settings.input);
    expect(reply, words);
  }

  Imf::Header header{160, 120};
  std::map<std::string, std::vector<float>> planes;
};

}  // namespace alcove::test
