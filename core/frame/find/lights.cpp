// Lights JSON.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {
namespace {

using Json = nlohmann::json;

constexpr int kDeepestLights = 8;          // objects and lists within each other
constexpr std::size_t kLongestName = 64;   // of a light: it is part of a channel's name
constexpr std::size_t kLongestShown = 60;  // characters of a text of the file in a message
constexpr double kFarthestLight = 1e12;    // scene units: kernels square it as a float
constexpr double kWidestSun = 30;          // degrees: wider ones are no discs any more
constexpr double kVertical = 1 - 1e-9;     // sine of an elevation from which the azimuth is rounding

/// A text of the file for a message.
std::string shown(const std::string& text) {
  return text.size() > kLongestShown ? as_utf8(text.substr(0, kLongestShown)) + "..." : text;
}

/// Reads the lights of a file: every complaint names the file and the light.
struct LightReader {
  std::string path, light;

  [[noreturn]] void refuse(const std::string& why) const {
    fail(ErrorKind::input, "{}: {}: {} (--lights; docs/inputs.md lists the fields)", path, light, why);
  }

  /// Fails where an object has another field than these: a misspelt one would be ignored.
  void require_known(const Json& object, const std::vector<std::string>& known) const {
    for (const auto& [field, value] : object.items())
      if (std::ranges::find(known, field) == known.end())
        refuse(fmt::format("there is no field \"{}\"{}", shown(field), suggestion(shown(field), known)));
  }

  const Json& required(const Json& object, const char* field) const {
    if (!object.contains(field)) refuse(fmt::format("\"{}\" is missing", field));
    return object[field];
  }

  std::string word(const Json& value, const char* field, const std::vector<std::string>& words) const {
    if (!value.is_string() || std::ranges::find(words, value.get<std::string>()) == words.end())
      refuse(fmt::format("\"{}\" must be {}, not {}", field, fmt::join(words, " or "), shown(value.dump())));
    return value.get<std::string>();
  }

  double number(const Json& value, const char* field, double low, double high) const {
    if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high))
      refuse(fmt::format("\"{}\" must be a number from {} to {}, not {}", field, low, high, shown(value.dump())));
    return value.get<double>();
  }

  int frame_number(const Json& value) const {
    using Int = std::numeric_limits<int>;
    const double frame = number(value, "frame", Int::min(), Int::max());
    if (frame != std::floor(frame)) refuse(fmt::format("\"frame\" must be a whole number, not {}", frame));
    return int(frame);
  }

  Vector3 vector(const Json& value, const char* field) const {
    if (!value.is_array() || value.size() != 3)
      refuse(fmt::format("\"{}\" must be three numbers, not {}", field, shown(value.dump())));
    Vector3 result{};
    for (std::size_t i = 0; i < 3; i++)
      result[i] = number(value[i], fmt::format("{}[{}]", field, i).c_str(), -kFarthestLight, kFarthestLight);
    return result;
  }

  /// The direction of this way, however short.
  Vector3 direction(Vector3 way) const {
    const double most = std::max({std::abs(way[0]), std::abs(way[1]), std::abs(way[2])});
    if (most == 0) refuse("\"direction\" has no length");
    for (double& x : way) x /= most;
    const double distance = length(way);
    for (double& x : way) x /= distance;
    return way;
  }

  /// Takes where an object says that the light is, and how large. Gives whether it says where.
  bool take(const Json& object, Light& taken) const {
    const char* const where = taken.is_lamp ? "position" : "direction";
    const char* const size = taken.is_lamp ? "radius" : "angular_diameter";
    if (object.contains(size)) taken.size = number(object[size], size, 0, taken.is_lamp ? kFarthestLight : kWidestSun);
    if (!object.contains(where)) return false;
    taken.at = vector(object[where], where);
    if (!taken.is_lamp) taken.at = direction(taken.at);
    return true;
  }
};

bool is_name(const std::string& name) {
  const auto is_fine = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) || c == '-' || c == '_'); };
  return !name.empty() && name.size() <= kLongestName && std::ranges::all_of(name, is_fine);
}

LightsFile::Entry entry_of(LightReader reader, const Json& json) {
  if (!json.is_object()) reader.refuse("it must be an object, not " + shown(json.dump()));
  reader.require_known(json,
                       {"name", "kind", "direction", "angular_diameter", "position", "radius", "space", "frames"});
  LightsFile::Entry entry;
  const Json& name = reader.required(json, "name");
  if (!name.is_string() || !is_name(name.get<std::string>()))
    reader.refuse(
        fmt::format("\"name\" must be up to {} letters, digits, - and _, not {}", kLongestName, shown(name.dump())));
  entry.name = name.get<std::string>();
  reader.light = fmt::format("light \"{}\"", entry.name);
  Light light;
  light.is_lamp = reader.word(reader.required(json, "kind"), "kind", {"sun", "point"}) == "point";
  std::vector<std::string> fields = light.is_lamp ? std::vector<std::string>{"position", "radius"}
                                                  : std::vector<std::string>{"direction", "angular_diameter"};
  const std::string where = fields.front();
  for (const char* other : {"position", "radius", "direction", "angular_diameter"})
    if (json.contains(other) && std::ranges::find(fields, other) == fields.end())
      reader.refuse(fmt::format("a {} has \"{}\" and \"{}\", not \"{}\"", light.is_lamp ? "point" : "sun", fields[0],
                                fields[1], other));
  fields.emplace_back("frame");
  entry.in_world = !json.contains("space") || reader.word(json["space"], "space", {"world", "view"}) == "world";
  const bool is_placed = reader.take(json, light);
  entry.is_constant = !json.contains("frames");
  if (entry.is_constant) {
    if (!is_placed) reader.refuse(fmt::format("\"{}\" is missing", where));
    entry.of_frames[0] = light;
    return entry;
  }
  const Json& frames = json["frames"];
  if (!frames.is_array() || frames.empty()) reader.refuse("\"frames\" must list at least one frame");
  for (const auto& frame : frames) {
    if (!frame.is_object() || !frame.contains("frame")) reader.refuse("\"frames\" must list objects with a \"frame\"");
    const int number = reader.frame_number(frame["frame"]);
    LightReader of_number{reader.path, fmt::format("{}, frame {}", reader.light, number)};
    of_number.require_known(frame, fields);
    Light of_frame = light;
    if (!of_number.take(frame, of_frame) && !is_placed) of_number.refuse(fmt::format("\"{}\" is missing", where));
    if (!entry.of_frames.emplace(number, of_frame).second) of_number.refuse("it is there twice");
  }
  return entry;
}

/// A direction with another azimuth, or another elevation, where these are given.
Vector3 turned(const Vector3& at, std::optional<double> azimuth, std::optional<double> elevation, std::size_t up) {
  if (!azimuth && !elevation) return at;
  const std::size_t side = 3 - up;
  const double left = up == 2 ? 1 : -1, degree = std::numbers::pi / 180;
  const double around = azimuth ? *azimuth * degree : std::atan2(left * at[side], at[0]);
  const double high = elevation ? *elevation * degree : std::asin(std::clamp(at[up], -1.0, 1.0));
  Vector3 result{};
  result[0] = std::cos(high) * std::cos(around);
  result[side] = left * std::cos(high) * std::sin(around);
  result[up] = std::sin(high);
  return result;
}

/// Takes the sun that the settings turn.
void take_turn(LightsFile& file, const EstimatorSettings& settings) {
  if (!turns_sun(settings)) return;
  std::vector<std::string> suns;
  for (std::size_t i = 0; i < file.lights.size(); i++) {
    const auto& [name, of_frames, is_constant, in_world] = file.lights[i];
    if (of_frames.begin()->second.is_lamp) continue;
    if (settings.sun.empty() || settings.sun == name) file.sun = i, suns.push_back(name);
  }
  if (suns.empty())
    fail(ErrorKind::usage, "{}: {} lists no sun{}",
         settings.sun.empty() ? "--set sun-azimuth and sun-elevation" : "--set sun=" + settings.sun, file.path,
         settings.sun.empty() ? "" : " " + settings.sun);
  if (suns.size() > 1)
    fail(ErrorKind::usage,
         "--set sun-azimuth and sun-elevation: {} has the suns {}: --set sun=NAME says which they turn", file.path,
         list_of(suns));
  file.azimuth = settings.sun_azimuth;
  file.elevation = settings.sun_elevation;
}

}  // namespace

void LightsFile::require_frames(const std::vector<int>& frames) const {
  for (const auto& light : lights)
    for (const int frame : frames) {
      if (light.is_constant || light.of_frames.contains(frame)) continue;
      std::vector<int> listed;
      for (const auto& [number, of_frame] : light.of_frames) listed.push_back(number);
      fail(ErrorKind::input,
           "{}: light \"{}\" has no frame {}, but {}: it must list all frames of the run (--lights, --frames)", path,
           light.name, frame, short_frames_text(listed));
    }
}

std::vector<Light> LightsFile::in_view(const Camera& camera, int frame) const {
  require_frames({frame});
  std::vector<Light> result;
  for (const auto& [name, of_frames, is_constant, in_world] : lights) {
    Light light = is_constant ? of_frames.begin()->second : of_frames.at(frame);
    light.name = name;
    if (in_world && !camera.view_from_world)
      fail(ErrorKind::input,
           "{}: light \"{}\" is in world space, and needs a camera with world_to_camera: give a --camera file with it, "
           "or the light in view space (--lights)",
           path, name);
    if (!in_world && camera.left_handed) light.at[2] = -light.at[2];
    const std::size_t up = in_world ? up_of_world() : 1;
    if (name == lights[sun].name && azimuth.has_value() != elevation.has_value() && std::abs(light.at[up]) > kVertical)
      fail(ErrorKind::usage, "{}: light \"{}\" is vertical: give both --set sun-azimuth and sun-elevation", path, name);
    if (name == lights[sun].name) light.at = turned(light.at, azimuth, elevation, up);
    if (in_world) light.at = times(*camera.view_from_world, light.at);
    if (in_world && light.is_lamp) light.at = sum(light.at, camera.view_from_world_offset);
    result.push_back(light);
  }
  return result;
}

std::vector<std::string> LightsFile::below_horizon(const std::vector<int>& frames) const {
  std::vector<std::string> names;
  for (const Entry& entry : lights) {
    const bool is_turned = elevation && entry.name == lights[sun].name;
    const auto is_below = [&](int frame) {
      const Light& light = entry.is_constant ? entry.of_frames.begin()->second : entry.of_frames.at(frame);
      return !light.is_lamp && (is_turned ? *elevation : light.at[up_of_world()]) < 0;
    };
    if (entry.in_world && std::ranges::any_of(frames, is_below)) names.push_back(entry.name);
  }
  return names;
}

std::shared_ptr<const LightsFile> lights_of(const std::string& text, const std::string& path,
                                            const EstimatorSettings& settings) {
  LightsFile file;
  file.path = path;
  LightReader reader{path, "the file"};
  std::string why;
  const Json top = json_of(text, kDeepestLights, why);
  if (!why.empty()) reader.refuse(why.substr(2));
  if (!top.is_object() || !top.contains("lights") || !top["lights"].is_array())
    reader.refuse("it must be a JSON object with a list \"lights\"");
  reader.require_known(top, {"lights", "up"});
  file.is_y_up = top.contains("up") && reader.word(top["up"], "up", {"z", "y"}) == "y";
  const Json& lights = top["lights"];
  if (lights.empty() || lights.size() > kMostLights)
    reader.refuse(fmt::format("it lists {} lights, and a run takes 1 to {}", lights.size(), kMostLights));
  for (const auto& json : lights) {
    reader.light = fmt::format("light {} of the list", file.lights.size() + 1);
    file.lights.push_back(entry_of(reader, json));
    const std::string& name = file.lights.back().name;
    if (std::ranges::count(file.lights, name, &LightsFile::Entry::name) > 1)
      reader.refuse(fmt::format("the name \"{}\" is there twice", name));
  }
  take_turn(file, settings);
  return std::make_shared<const LightsFile>(std::move(file));
}

std::shared_ptr<const LightsFile> read_lights(const std::string& path, const EstimatorSettings& settings) {
  return lights_of(read_text(path, "lights", "--lights"), path, settings);
}

}  // namespace alcove
