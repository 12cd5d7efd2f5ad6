// Camera JSON, .chan files, cameras from numbers, and the kernels' view of each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string_view>
#include <vector>

#include "core/base/file.h"
#include "core/base/option_words.h"
#include "core/base/text.h"

namespace alcove {

// .chan files: lines of numbers.

namespace {

constexpr std::size_t kWithoutView = 7, kWithView = 8;  // numbers of a line
constexpr double kMostFrameNumber = 1e9;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// The focal length in y, px, of a field of view over the height.
double focal_over_height(const Window& display, double degrees) {
  return 0.5 * display.height / std::tan(radians(degrees) / 2);
}

/// Reads the numbers of a line. Fails with ErrorKind::input on a word that is no number.
std::vector<double> numbers_in(const std::string& path, const std::string& line, int number) {
  std::vector<double> numbers;
  std::istringstream words(line);
  for (std::string word; words >> word;) {
    const auto value = number_of(word);
    if (!value || !std::isfinite(*value))
      fail(ErrorKind::input, "{}: line {} has \"{}\" where a number belongs (--camera)", path, number, word);
    numbers.push_back(*value);
  }
  return numbers;
}

/// Fails: a camera file does not list a frame.
[[noreturn]] void refuse_absent(const std::string& path, int frame, const std::vector<int>& listed) {
  fail(ErrorKind::input, "{}: it has no frame {}, {}: number the camera as the frames (--camera)", path, frame,
       listed.empty() ? "nor any other" : "but " + short_frames_text(listed));
}

/// The line of a frame. Of several with one number it is the first.
std::vector<double> line_of(const std::string& path, int frame) {
  std::istringstream lines(read_text(path, "camera", "--camera"));
  std::vector<double> found;
  std::vector<int> listed;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    number++;
    const auto numbers = numbers_in(path, line.substr(0, line.find('#')), number);
    if (numbers.empty()) continue;
    if (numbers.size() < kWithoutView || numbers.size() > kWithView)
      fail(ErrorKind::input,
           "{}: line {} has {} numbers, and a camera's has 8: frame, x, y, z, three angles and the vertical field of "
           "view (--camera)",
           path, number, numbers.size());
    if (found.empty() && numbers[0] == frame) found = numbers;
    if (std::abs(numbers[0]) < kMostFrameNumber) listed.push_back(int(numbers[0]));
  }
  if (found.empty()) refuse_absent(path, frame, listed);
  return found;
}

/// The turn by an angle about an axis, 0 to 2.
Matrix3 turn_about(std::size_t axis, double angle) {
  const std::size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
  Matrix3 m{};
  m[axis][axis] = 1;
  m[next][next] = m[last][last] = std::cos(angle);
  m[last][next] = std::sin(angle);
  m[next][last] = -m[last][next];
  return m;
}

}  // namespace

Matrix3 view_by_angles(const Vector3& angles, const std::string& rotation) {
  Matrix3 turned{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (const char axis : rotation) {
    const auto place = std::size_t(axis - 'x');
    turned = product(turn_about(place, angles[place]), turned);
  }
  return transposed(turned);
}

bool is_chan_file(const std::string& path) { return lower_case(path).ends_with(".chan"); }

Camera read_chan(const std::string& path, int frame, const std::string& rotation, const Window& display,
                 double pixel_aspect) {
  const auto numbers = line_of(path, frame);
  if (numbers.size() < kWithView)
    fail(ErrorKind::input,
         "{}: frame {} has no field of view: write the file from a camera, or give a --camera file of another kind",
         path, frame);
  const double fov = numbers[kWithoutView];
  if (!(fov > 0 && fov < 180))
    fail(ErrorKind::input, "{}: the vertical field of view of frame {} is {} degrees (--camera)", path, frame, fov);
  Camera camera = centred(display, focal_over_height(display, fov) / pixel_aspect, pixel_aspect);
  camera.chan_angles = {radians(numbers[4]), radians(numbers[5]), radians(numbers[6])};
  camera.view_from_world = view_by_angles(*camera.chan_angles, rotation);
  camera.view_from_world_offset = scaled(times(*camera.view_from_world, {numbers[1], numbers[2], numbers[3]}), -1);
  return camera;
}

// Camera files in JSON, and options.

namespace {

struct ForeignCamera {
  std::array<std::string_view, 2> marks;  // texts that such a file has, both of them
  const char* what;
  const char* mend;
};

constexpr const char* kExport = "export the camera as a .chan file, or write a camera file in JSON";

constexpr ForeignCamera kForeignCameras[] = {
    {{"\"transform_matrix\"", ""},
     "a transforms.json of NeRF tools",
     "write a camera file with its fl_x and fl_y as \"fx\" and \"fy\" (fx = w / 2 / tan(camera_angle_x / 2)), cx, cy, "
     "the \"resolution\" [w, h], and as \"world_to_camera\" the inverse of the frame's transform_matrix"},
    {{"\"camera_angle_x\"", ""},
     "a transforms.json of NeRF tools",
     "write a camera file with \"fx\" = w / 2 / tan(camera_angle_x / 2)"},
    {{"\"intrinsic_matrix\"", ""},
     "camera parameters of Open3D",
     "write a camera file with fx, fy, cx and cy of its intrinsic_matrix, and as \"world_to_camera\" its extrinsic "
     "with the second and the third row negated"},
    {{"\"intrinsics\"", "\"poses\""}, "a scene of Meshroom (AliceVision)", kExport},
    {{"\"cameras\"", "\"shots\""}, "a reconstruction of OpenSfM", kExport},
    {{"\"asset\"", "\"cameras\""}, "a glTF scene", kExport},
    {{"# Camera list with one line", ""},
     "COLMAP's cameras.txt, which holds no places",
     "write a camera file with its parameters as fx, fy, cx and cy"},
    {{"# Image list with two lines", ""},
     "COLMAP's images.txt, which holds no lens",
     "write a camera file with a lens, and as \"world_to_camera\" the rotation and the translation with the second and "
     "the third row negated"},
    {{"Ogawa", "\xff"}, "an Alembic file", kExport},
    {{"Kaydara FBX Binary", ""}, "an FBX file", kExport},
    {{"FBXHeaderExtension", ""}, "an FBX file", kExport},
    {{"PXR-USDC", ""}, "a USD file", kExport},
    {{"#usda", ""}, "a USD file", kExport},
    {{"//Maya ASCII", ""}, "a Maya scene", kExport},
    {{"Camera", "inputs "}, "a Nuke script", kExport},
};

/// Names the program of a foreign camera file, and the way to give its camera to Alcove. "" for any other text.
std::string why_foreign_camera(const std::string& text) {
  if (text.find("\"fx\"") != text.npos) return "";
  const auto* found = std::ranges::find_if(kForeignCameras, [&](const ForeignCamera& camera) {
    return std::ranges::all_of(camera.marks, [&](std::string_view mark) { return text.find(mark) != text.npos; });
  });
  return found == std::end(kForeignCameras) ? "" : fmt::format("{}, no camera file: {}", found->what, found->mend);
}

using Json = nlohmann::json;

// Kernels keep these numbers as floats and square them: within these limits they stay finite and above 0.
constexpr double kLeastScale = 1e-18, kMostScale = 1e18;  // fx and fy
constexpr double kMostCenter = 1e9;                       // px: cx and cy, to either side
constexpr int kDeepest = 64;                              // lists and objects within each other

bool is_scale(double pixels) { return pixels >= kLeastScale && pixels <= kMostScale; }

using Row4 = std::array<double, 4>;
using Rows4 = std::array<Row4, 4>;

/// A camera file being read: every complaint names the file and the field.
struct CameraFile {
  std::string path;
  // Fields of the frame's own entry win over those outside it, and within either those of the view.
  Json top, frame = Json::object(), view_of_top = Json::object(), view_of_frame = Json::object();

  const Json* find(const char* field) const {
    for (const Json* fields : {&view_of_frame, &frame, &view_of_top, &top})
      if (fields->contains(field)) return &(*fields)[field];
    return nullptr;
  }

  [[noreturn]] void refuse(const char* field, const std::string& why) const {
    const bool is_of_frame = frame.contains(field) || view_of_frame.contains(field);
    fail(ErrorKind::input, "{}: camera field \"{}\"{} {} (--camera)", path, field,
         is_of_frame ? " of frame " + frame["frame"].dump() : "", why);
  }

  double number(const char* field) const {
    const Json* value = find(field);
    if (!value) refuse(field, "is missing");
    if (!value->is_number() || !std::isfinite(value->get<double>()))
      refuse(field, "must be a finite number, not " + value->dump());
    return value->get<double>();
  }

  double positive(const char* field) const {
    const double value = number(field);
    if (value <= 0) refuse(field, fmt::format("must be above 0, not {}", value));
    return value;
  }

  double scale(const char* field) const {
    const double value = positive(field);
    if (!is_scale(value))
      refuse(field, fmt::format("must be from {:g} to {:g}, not {}", kLeastScale, kMostScale, value));
    return value;
  }

  double center(const char* field) const {
    const double value = number(field);
    if (std::abs(value) > kMostCenter)
      refuse(field, fmt::format("must be from {:g} to {:g}, not {}", -kMostCenter, kMostCenter, value));
    return value;
  }

  /// The rows of a matrix of finite numbers; none where the field is no list.
  std::optional<Rows4> rows(const char* field) const {
    const Json* value = find(field);
    if (!value || !value->is_array()) return std::nullopt;
    Rows4 rows{};
    bool fine = value->size() == 4;
    for (std::size_t row = 0; fine && row < 4; row++) {
      fine = (*value)[row].is_array() && (*value)[row].size() == 4;
      for (std::size_t column = 0; fine && column < 4; column++) {
        const Json& number = (*value)[row][column];
        fine = number.is_number() && std::isfinite(number.get<double>());
        if (fine) rows[row][column] = number.get<double>();
      }
    }
    if (!fine) refuse(field, "must be 4 rows of 4 finite numbers");
    return rows;
  }

  std::string text(const char* field) const {
    const Json* value = find(field);
    if (!value) return {};
    if (!value->is_string()) refuse(field, "must be a string, not " + value->dump());
    return lower_case(value->get<std::string>());
  }

  int resolution(int index) const {
    const Json* value = find("resolution");
    if (!value) refuse("resolution", "is missing");
    const bool fine = value->is_array() && value->size() == 2 && (*value)[std::size_t(index)].is_number_integer();
    const auto count = fine ? (*value)[std::size_t(index)].get<std::int64_t>() : 0;
    if (count <= 0 || count > (1 << 24))
      refuse("resolution", "must be two whole numbers of pixels above 0, not " + value->dump());
    return int(count);
  }
};

/// The object that the text of a camera file is.
Json object_of(const std::string& text, const std::string& path) {
  if (const std::string why = why_foreign_camera(text); !why.empty())
    fail(ErrorKind::input, "{}: {} (--camera; docs/inputs.md describes a camera file)", path, why);
  std::string why;
  Json top = json_of(text, kDeepest, why);
  if (!top.is_object())
    fail(ErrorKind::input,
         "{}: not a JSON object{}: --camera takes a camera file in JSON, as docs/inputs.md describes it, or a .chan "
         "file, which Nuke, Maya, Houdini and Blender export from a camera",
         path, why);
  return top;
}

Json object_in(const std::string& path) { return object_of(read_text(path, "camera", "--camera"), path); }

/// Gives the entry of `frames` with that number, or an empty object where the file has no `frames`.
Json frame_entry(const CameraFile& file, int frame) {
  if (!file.top.contains("frames")) return Json::object();
  const Json& frames = file.top["frames"];
  if (!frames.is_array()) file.refuse("frames", "must be a list");
  std::vector<int> listed;
  for (const auto& entry : frames) {
    if (!entry.is_object() || !entry.contains("frame") || !entry["frame"].is_number_integer())
      file.refuse("frames", "must list objects with a whole number \"frame\"");
    if (entry["frame"] == frame) return entry;
    listed.push_back(entry["frame"].get<int>());
  }
  refuse_absent(file.path, frame, listed);
}

/// Gives the entry of `views` with that name, in any case; an empty object where there are no `views`.
Json view_entry(const CameraFile& file, const Json& within, const std::string& view) {
  if (view.empty() || !within.contains("views")) return Json::object();
  const Json& views = within["views"];
  if (!views.is_object()) file.refuse("views", "must be an object, with an object of fields for the name of each view");
  for (const auto& [name, entry] : views.items())
    if (lower_case(name) == lower_case(view)) {
      if (!entry.is_object()) file.refuse("views", fmt::format("has no object of fields for {}", name));
      return entry;
    }
  file.refuse("views", fmt::format("has no view {}", view));
}

/// Whether the file says that its camera space is left-handed, looking along +z.
bool left_handed(const CameraFile& file) {
  const std::string text = file.text("camera_space");
  if (text.empty() || text.starts_with("right-handed")) return false;
  if (text.starts_with("left-handed")) return true;
  file.refuse(
      "camera_space",
      fmt::format("must begin with right-handed (looks along -z) or left-handed (looks along +z), not \"{}\"", text));
}

/// Fills in rotation and offset of world_to_camera. The rotation is orthonormal once a uniform scale is divided out.
void read_view_from_world(const CameraFile& file, Camera& camera) {
  const char* field = "world_to_camera";
  if (!file.find(field)) return;
  const auto rows = file.rows(field);
  if (!rows) file.refuse(field, "must be 4 rows of 4 finite numbers");
  for (std::size_t column = 0; column < 4; column++)
    if (std::abs((*rows)[3][column] - (column == 3)) > 1e-6)
      file.refuse(field, "must end in the row 0 0 0 1: it is for column vectors");
  Matrix3 m{};
  for (std::size_t row = 0; row < 3; row++) std::copy_n((*rows)[row].begin(), 3, m[row].begin());
  const auto squared = squared_scale(m);
  if (!squared) file.refuse(field, "is no rotation with a translation");
  if (determinant(m) < 0 && !camera.left_handed)
    file.refuse(field,
                "mirrors space; the camera looks along -z with x right and y up, right-handed, unless \"camera_space\" "
                "says left-handed");
  for (std::size_t row = 0; row < 3; row++) {
    const double scale = (camera.left_handed && row == 2 ? -1 : 1) / std::sqrt(*squared);
    for (auto& x : m[row]) x *= scale;
    camera.view_from_world_offset[row] = (*rows)[row][3] * scale;
  }
  camera.view_from_world = m;
}

/// Reads near or far. The word "inf" says that there is no far plane.
std::optional<double> clip_plane(const CameraFile& file, const char* field) {
  const Json* value = file.find(field);
  if (!value || value->is_null()) return std::nullopt;
  if (value->is_string() && file.text(field).starts_with("inf")) return std::numeric_limits<double>::infinity();
  return file.positive(field);
}

constexpr double kMatrixRounding = 1e-6;

bool is_about(double value, double other) { return std::abs(value - other) < kMatrixRounding; }

/// Whether a projection matrix divides by nothing, as an orthographic one.
bool is_affine(const Rows4& m) { return is_about(m[3][3], 1); }

/// Tells the projection by its word, or by the last row of the matrix that games have: 0 0 0 1 divides by nothing.
bool is_orthographic(const CameraFile& file) {
  if (const auto matrix = file.rows("projection")) return is_affine(*matrix);
  const std::string projection = file.text("projection");
  if (!projection.empty() && projection != "perspective" && projection != "orthographic")
    file.refuse("projection", fmt::format("must be perspective or orthographic, not \"{}\"", projection));
  return projection == "orthographic";
}

/// Says why a projection matrix is none for column vectors whose z is a depth; "" for one that is.
std::string why_no_depth(const Rows4& m) {
  const auto ends_in = [&](double z, double w) {
    return is_about(m[3][0], 0) && is_about(m[3][1], 0) && is_about(m[3][2], z) && is_about(m[3][3], w);
  };
  if (!ends_in(-1, 0) && !ends_in(1, 0) && !ends_in(0, 1))
    return "must end in the row 0 0 -1 0, 0 0 1 0 or 0 0 0 1, for column vectors: transpose a matrix for row vectors";
  const std::size_t zero = is_affine(m) ? 2 : 3;
  const bool has_zeros =
      is_about(m[2][0], 0) && is_about(m[2][1], 0) && is_about(m[0][zero], 0) && is_about(m[1][zero], 0);
  return has_zeros ? ""
                   : "has numbers where a matrix for column vectors has zeros: transpose a matrix for row vectors; an "
                     "oblique near plane gives no depth";
}

/// The same of one that also shows the picture as it is.
std::string why_not_upright(const Rows4& m) {
  const bool is_upright = is_about(m[0][1], 0) && is_about(m[1][0], 0) && m[0][0] > 0 && m[1][1] != 0;
  const std::string why = why_no_depth(m);
  return !why.empty() || is_upright ? why : "turns or mirrors the picture: give fx, fy, cx and cy instead";
}

/// Takes the planes of the z-buffer out of a matrix, where the file does not say them. At the distance d, depth is
/// a + b / d. It falls with the distance where it is reversed, from 1 to 0. Else nothing in a matrix tells whether its
/// depth begins at 0 or, as OpenGL's, at -1: camera.h has both.
void read_planes_of_matrix(const CameraFile& file, Camera& camera) {
  const auto matrix = file.rows("projection");
  if (!matrix || !why_no_depth(*matrix).empty()) return;
  const Rows4& m = *matrix;
  const double zero = std::abs(m[2][3] / m[2][2]);
  if (zero > 0 && std::isfinite(zero)) camera.matrix_near = zero;
  if (camera.orthographic) return;
  constexpr double kMostReversed = 0.5;
  const double a = m[2][2] * m[3][2], b = m[2][3], infinity = std::numeric_limits<double>::infinity();
  if (b < 0 && a > 1 - kMatrixRounding) {
    camera.matrix_near_opengl = -b / (a + 1);
    camera.matrix_far = a > 1 + kMatrixRounding ? b / (1 - a) : infinity;
  }
  const bool is_reversed = b > 0 && std::abs(a) < kMostReversed;
  if (!is_reversed || camera.near || camera.far || file.find("reversed_z")) return;
  camera.near = b / (1 - a);
  camera.far = a < -kMatrixRounding ? -b / a : infinity;
  camera.reversed_z = true;
}

/// Takes the lens of a file without fx, fy, cx and cy out of the matrix that games have. Its y points down the picture
/// where it is Vulkan's, and its camera looks along +z where the last row is 0 0 1 0.
void read_lens_of_matrix(const CameraFile& file, const Rows4& m, Camera& camera) {
  if (const std::string why = why_not_upright(m); !why.empty()) file.refuse("projection", why);
  const std::size_t shift = is_affine(m) ? 3 : 2;
  const double side = m[3][2] < 0 ? -1 : 1, up = m[1][1] > 0 ? 1 : -1;
  camera.fx = 0.5 * camera.width * m[0][0];
  camera.fy = 0.5 * camera.height * std::abs(m[1][1]);
  camera.cx = 0.5 * camera.width * (1 + side * m[0][shift]);
  camera.cy = 0.5 * camera.height * (1 - up * side * m[1][shift]);
  if (!is_scale(camera.fx) || !is_scale(camera.fy) || std::abs(camera.cx) > kMostCenter ||
      std::abs(camera.cy) > kMostCenter)
    file.refuse("projection", "sees nothing");
  if (!is_affine(m) && !file.find("camera_space")) camera.left_handed = side > 0;
}

/// Fails where a matrix shows another lens than fx, fy, cx and cy. One that is not upright shows none.
void require_same_lens(const CameraFile& file, const Rows4& m, const Camera& camera) {
  if (!why_not_upright(m).empty()) return;
  Camera by_matrix = camera;
  read_lens_of_matrix(file, m, by_matrix);
  constexpr double kSame = 0.01, kSamePixels = 1;  // matrices are rounded, and jitter by a part of a pixel
  const auto require = [&](const char* field, double said, double shown, double tolerance) {
    if (std::abs(said - shown) > tolerance)
      file.refuse(field,
                  fmt::format("is {:.6g}, but the \"projection\" shows {:.6g}: leave one of them out", said, shown));
  };
  require("fx", camera.fx, by_matrix.fx, kSame * camera.fx);
  require("fy", camera.fy, by_matrix.fy, kSame * camera.fy);
  require("cx", camera.cx, by_matrix.cx, kSamePixels);
  require("cy", camera.cy, by_matrix.cy, kSamePixels);
}

void read_lens(const CameraFile& file, Camera& camera) {
  const bool has_none = !file.find("fx") && !file.find("fy") && !file.find("cx") && !file.find("cy");
  const auto matrix = file.rows("projection");
  if (has_none && matrix) return read_lens_of_matrix(file, *matrix, camera);
  camera.fx = file.scale("fx");
  camera.fy = file.scale("fy");
  camera.cx = file.center("cx");
  camera.cy = file.center("cy");
  if (matrix) require_same_lens(file, *matrix, camera);
}

bool truth(const CameraFile& file, const char* field) {
  const Json* value = file.find(field);
  if (value && !value->is_boolean()) file.refuse(field, "must be true or false, not " + value->dump());
  return value && value->get<bool>();
}

/// The meaning of a text that begins with a word of an option; automatic where it begins with none.
template <class T>
T meaning_of(const std::string& text) {
  for (const auto& [word, meaning] : kWordsOf<T>)
    if (meaning != T::automatic && text.starts_with(word)) return meaning;
  return T::automatic;
}

DepthKind depth_kind(const CameraFile& file) {
  const char* field = file.find("depth_kind") ? "depth_kind" : "depth";
  const std::string text = file.text(field);
  const DepthKind kind = meaning_of<DepthKind>(text);
  const bool needs_options = kind == DepthKind::position || kind == DepthKind::disparity;
  if (text.empty() || (kind != DepthKind::automatic && !needs_options)) return kind;
  file.refuse(field, fmt::format("must begin with planar, ray, inverse, device, normalized or log, not \"{}\"", text));
}

NormalSpace normal_space(const CameraFile& file) {
  const std::string text = file.text("normal_space");
  if (text.empty()) return NormalSpace::automatic;
  if (text == "world") return NormalSpace::world;
  if (text == "view" || text == "camera") return NormalSpace::view;
  file.refuse("normal_space", fmt::format("must be world or view, not \"{}\"", text));
}

NormalEncoding normal_encoding(const CameraFile& file) {
  const std::string text = file.text("normal_encoding");
  const NormalEncoding encoding = meaning_of<NormalEncoding>(text);
  if (text.empty() || encoding != NormalEncoding::automatic) return encoding;
  file.refuse("normal_encoding",
              fmt::format("must begin with signed, unorm, octahedral or spheremap, not \"{}\"", text));
}

/// The same from numbers of options. Fails with ErrorKind::usage where it sees nothing.
Camera centred_by_options(const Window& display, double fx, double aspect, bool orthographic) {
  Camera camera = centred(display, fx, aspect);
  camera.orthographic = orthographic;
  if (!is_scale(camera.fx) || !is_scale(camera.fy))
    fail(
        ErrorKind::usage,
        "a camera of {:g} pixels per unit sees nothing: give another --fov, --vertical-fov or --focal-px, --focal with "
        "--aperture, or --ortho-width",
        fx);
  return camera;
}

/// Scales the camera to the frame's resolution, and keeps its field of view: proxies share the camera of the full size.
Camera fitted(Camera camera, const Window& display, const std::string& path) {
  if (camera.width == display.width && camera.height == display.height) return camera;
  if (std::int64_t(camera.width) * display.height != std::int64_t(camera.height) * display.width)
    fail(ErrorKind::input,
         "{}: the camera is for {}x{} pixels, and the frame's display window is {}x{}: give a --camera that fits", path,
         camera.width, camera.height, display.width, display.height);
  const double scale = double(display.width) / camera.width;
  camera.scaled_from = {camera.width, camera.height};
  camera.width = display.width;
  camera.height = display.height;
  for (double* x : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *x *= scale;
  return camera;
}

Camera camera_in(CameraFile file, int frame, const std::string& view) {
  file.frame = frame_entry(file, frame);
  file.view_of_top = view_entry(file, file.top, view);
  file.view_of_frame = view_entry(file, file.frame, view);

  Camera camera;
  camera.width = file.resolution(0);
  camera.height = file.resolution(1);
  camera.orthographic = is_orthographic(file);
  camera.left_handed = left_handed(file);
  read_lens(file, camera);
  read_view_from_world(file, camera);
  camera.near = clip_plane(file, "near");
  camera.far = clip_plane(file, "far");
  camera.reversed_z = truth(file, "reversed_z");
  read_planes_of_matrix(file, camera);
  camera.depth_kind = depth_kind(file);
  camera.normal_space = normal_space(file);
  camera.normal_encoding = normal_encoding(file);
  if (file.find("pixel_aspect")) file.positive("pixel_aspect");
  return camera;
}

}  // namespace

Camera read_camera(const std::string& path, int frame, const std::string& view) {
  return camera_in({path, object_in(path)}, frame, view);
}

Camera camera_of(const std::string& text, const std::string& name, const Window& display, int frame) {
  return fitted(camera_in({name, object_of(text, name)}, frame, ""), display, name);
}

bool lists_frames(const std::string& path) { return is_chan_file(path) || object_in(path).contains("frames"); }

void require_listed(const std::string& path, int frame) {
  if (is_chan_file(path)) return void(line_of(path, frame));
  frame_entry({path, object_in(path)}, frame);
}

NoCamera::NoCamera(const std::string& file, const std::string& why)
    : Error(ErrorKind::usage,
            fmt::format("no camera for {}: {}give {}", file, why.empty() ? "" : why + ": ", kCameraOptions)),
      why(why) {}

Camera centred(const Window& display, double fx, double pixel_aspect) {
  Camera camera;
  camera.width = display.width;
  camera.height = display.height;
  camera.fx = fx;
  camera.fy = fx * pixel_aspect;
  camera.cx = 0.5 * display.width;
  camera.cy = 0.5 * display.height;
  return camera;
}

Camera camera_for(const InputSettings& settings, const Window& display, double pixel_aspect, int frame,
                  const std::string& view) {
  if (is_chan_file(settings.camera))
    return read_chan(settings.camera, frame, settings.chan_rotation, display, pixel_aspect);
  if (!settings.camera.empty()) return fitted(read_camera(settings.camera, frame, view), display, settings.camera);
  const double half_width = 0.5 * display.width;
  if (settings.fov)
    return centred_by_options(display, half_width / std::tan(radians(*settings.fov) / 2), pixel_aspect, false);
  if (settings.vertical_fov)
    return centred_by_options(display, focal_over_height(display, *settings.vertical_fov) / pixel_aspect, pixel_aspect,
                              false);
  if (settings.focal_px) return centred_by_options(display, *settings.focal_px, pixel_aspect, false);
  if (settings.focal && settings.aperture)
    return centred_by_options(display, 2 * half_width * *settings.focal / *settings.aperture, pixel_aspect, false);
  if (settings.ortho_width)
    return centred_by_options(display, 2 * half_width / *settings.ortho_width, pixel_aspect, true);
  throw NoCamera(!settings.input.empty()  ? settings.input
                 : settings.depth.empty() ? settings.position
                                          : settings.depth);
}

Matrix3 view_from_normal(const Camera& camera, NormalSpace space, const NormalFlips& flips) {
  Matrix3 m = space == NormalSpace::world ? camera.view_from_world.value()
                                          : Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, camera.left_handed ? -1.0 : 1.0}}};
  for (auto& row : m) {
    if (flips.x) row[0] = -row[0];
    if (flips.y) row[1] = -row[1];
    if (flips.z) row[2] = -row[2];
  }
  return m;
}

ViewMap view_from_view(const Camera& to, const Camera& from) {
  const Matrix3 &t = to.view_from_world.value(), &f = from.view_from_world.value();
  const Matrix3 turn = product(t, transposed(f));  // the way back of a rotation is its transpose
  ViewMap map{};
  for (std::size_t i = 0; i < 3; i++) {
    map[i] = {turn[i][0], turn[i][1], turn[i][2], to.view_from_world_offset[i]};
    for (std::size_t j = 0; j < 3; j++) map[i][3] -= turn[i][j] * from.view_from_world_offset[j];
  }
  return map;
}

View view_of(const Camera& camera, const Window& data, const Window& display) {
  View view{};
  view.size = {data.width, data.height};
  // The centre is rounded so that its differences to pixels are exact floats, whatever part of a frame is looked at:
  // 1/4096 px for displays up to 1024 wide.
  const double steps = std::exp2(22 - std::ceil(std::log2(std::max(display.width, display.height))));
  const auto rounded = [&](double px) { return std::round(px * steps) / steps; };
  view.center = {float(rounded(camera.cx) + display.x - data.x), float(rounded(camera.cy) + display.y - data.y)};
  view.tangent_per_pixel = {float(1 / camera.fx), float(-1 / camera.fy)};
  view.orthographic = camera.orthographic ? 1 : 0;
  return view;
}

SeenAt seen_from(const View& other, const ViewMap& map, const View& view, double x, double y, double depth) {
  const double scale = view.orthographic ? 1 : depth;
  const std::array<double, 3> here{(x - double(view.center.x)) * double(view.tangent_per_pixel.x) * scale,
                                   (y - double(view.center.y)) * double(view.tangent_per_pixel.y) * scale, -depth};
  std::array<double, 3> there{};
  for (std::size_t i = 0; i < 3; i++)
    there[i] = map[i][0] * here[0] + map[i][1] * here[1] + map[i][2] * here[2] + map[i][3];
  const double distance = other.orthographic ? 1 : -there[2];
  return {double(other.center.x) + there[0] / distance / double(other.tangent_per_pixel.x),
          double(other.center.y) + there[1] / distance / double(other.tangent_per_pixel.y), -there[2]};
}

double ray_length(const View& view, int x, int y) {
  const double u = (x + 0.5 - view.center.x) * view.tangent_per_pixel.x;
  const double v = (y + 0.5 - view.center.y) * view.tangent_per_pixel.y;
  return view.orthographic ? 1 : std::sqrt(1 + u * u + v * v);
}

}  // namespace alcove
