// Lines of numbers -> cameras.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/chan_file.h"

#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {
namespace {

constexpr std::size_t kWithoutView = 7, kWithView = 8;  // numbers of a line

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// The numbers of a line; what is no number is told by its text.
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

/// The line of a frame. Of several with one number it is the first.
std::vector<double> line_of(const std::string& path, int frame) {
  std::istringstream lines(read_text(path, "camera", "--camera"));
  std::vector<double> found;
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
  }
  if (found.empty()) fail(ErrorKind::input, "{}: it has no frame {} (--camera)", path, frame);
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
  Camera camera = centred(display, 0.5 * display.height / std::tan(0.5 * radians(fov)) / pixel_aspect, pixel_aspect);
  camera.chan_angles = {radians(numbers[4]), radians(numbers[5]), radians(numbers[6])};
  camera.view_from_world = view_by_angles(*camera.chan_angles, rotation);
  camera.view_from_world_offset = scaled(times(*camera.view_from_world, {numbers[1], numbers[2], numbers[3]}), -1);
  return camera;
}

void require_in_chan(const std::string& path, int frame) { line_of(path, frame); }

}  // namespace alcove
