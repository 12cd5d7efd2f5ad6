// Lights JSON.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/lights.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {
namespace {

using Json = nlohmann::json;

constexpr int kDeepestLights = 8;             // objects and lists within each other
constexpr std::size_t kLongestName = 64;      // of a light: it is part of a channel's name
constexpr double kFarthestLight = 1e12;       // scene units: kernels square it as a float
constexpr double kWidestSun = 179;            // degrees
constexpr double kShortestDirection = 1e-30;  // scene units

/// A light being read: every complaint names the file and the light.
struct LightReader {
  std::string path, light;
  Json fields;  // those of a frame win over those beside `frames`

  [[noreturn]] void refuse(const std::string& why) const {
    fail(ErrorKind::input, "{}: {}: {} (--lights; docs/inputs.md lists the fields)", path, light, why);
  }

  /// Fails where an object has another field than these: a misspelt one would be ignored.
  void require_known(const Json& object, const std::vector<std::string>& known) const {
    for (const auto& [field, value] : object.items())
      if (std::ranges::find(known, field) == known.end())
        refuse(fmt::format("there is no field \"{}\"{}", field, suggestion(field, known)));
  }

  const Json& required(const char* field) const {
    if (!fields.contains(field)) refuse(fmt::format("\"{}\" is missing", field));
    return fields[field];
  }

  std::string word(const char* field, const std::vector<std::string>& words) const {
    const Json& value = required(field);
    if (!value.is_string() || std::ranges::find(words, value.get<std::string>()) == words.end())
      refuse(fmt::format("\"{}\" must be {}, not {}", field, fmt::join(words, " or "), value.dump()));
    return value.get<std::string>();
  }

  double number(const Json& value, const char* field, double low, double high) const {
    if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high))
      refuse(fmt::format("\"{}\" must be of numbers from {:g} to {:g}, not {}", field, low, high, value.dump()));
    return value.get<double>();
  }

  Vector3 vector(const char* field) const {
    const Json& value = required(field);
    if (!value.is_array() || value.size() != 3)
      refuse(fmt::format("\"{}\" must be three numbers, not {}", field, value.dump()));
    Vector3 result{};
    for (std::size_t i = 0; i < 3; i++) result[i] = number(value[i], field, -kFarthestLight, kFarthestLight);
    return result;
  }

  double size(const char* field, double most) const {
    return fields.contains(field) ? number(fields[field], field, 0, most) : 0;
  }

  Light read() const {
    Light result;
    result.is_lamp = word("kind", {"sun", "point"}) == "point";
    for (const char* other :
         {result.is_lamp ? "direction" : "position", result.is_lamp ? "angular_diameter" : "radius"})
      if (fields.contains(other))
        refuse(fmt::format("\"{}\" is none of the fields of a {}", other, result.is_lamp ? "point" : "sun"));
    result.in_world = !fields.contains("space") || word("space", {"world", "view"}) == "world";
    result.at = vector(result.is_lamp ? "position" : "direction");
    result.size = result.is_lamp ? size("radius", kFarthestLight) : size("angular_diameter", kWidestSun);
    if (result.is_lamp) return result;
    const double distance = length(result.at);
    if (!(distance > kShortestDirection)) refuse("\"direction\" has no length");
    for (double& x : result.at) x /= distance;
    return result;
  }
};

const std::vector<std::string>& light_fields() {
  static const std::vector<std::string> kFields{
      "name", "kind", "space", "direction", "radius", "position", "angular_diameter", "frames"};
  return kFields;
}

bool is_name(const std::string& name) {
  const auto is_fine = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) || c == '-' || c == '_'); };
  return !name.empty() && name.size() <= kLongestName && std::ranges::all_of(name, is_fine);
}

LightsFile::Entry entry_of(LightReader reader, const Json& json) {
  if (!json.is_object()) reader.refuse("it must be an object, not " + json.dump());
  reader.require_known(json, light_fields());
  LightsFile::Entry entry;
  reader.fields = json;
  const Json& name = reader.required("name");
  if (!name.is_string() || !is_name(name.get<std::string>()))
    reader.refuse(fmt::format("\"name\" must be up to {} letters, digits, - and _, not {}", kLongestName, name.dump()));
  entry.name = name.get<std::string>();
  reader.light = fmt::format("light \"{}\"", entry.name);
  entry.is_constant = !json.contains("frames");
  if (entry.is_constant) {
    entry.of_frames[0] = reader.read();
    return entry;
  }
  if (!json["frames"].is_array() || json["frames"].empty()) reader.refuse("\"frames\" must be a list of objects");
  for (const auto& frame : json["frames"]) {
    if (!frame.is_object() || !frame.contains("frame") || !frame["frame"].is_number_integer())
      reader.refuse("\"frames\" must list objects with a whole number \"frame\"");
    reader.require_known(frame, {"frame", "direction", "radius", "position", "angular_diameter"});
    reader.fields = json;
    reader.fields.update(frame);
    if (!entry.of_frames.emplace(frame["frame"].get<int>(), reader.read()).second)
      reader.refuse(fmt::format("\"frames\" has frame {} twice", frame["frame"].get<int>()));
  }
  return entry;
}

}  // namespace

std::vector<Light> LightsFile::in_view(const Camera& camera, int frame) const {
  std::vector<Light> result;
  for (const auto& [name, of_frames, is_constant] : lights) {
    const auto found = is_constant ? of_frames.begin() : of_frames.find(frame);
    if (found == of_frames.end()) {
      std::vector<int> listed;
      for (const auto& [number, light] : of_frames) listed.push_back(number);
      fail(ErrorKind::input, "{}: light \"{}\" has no frame {}, but {}: lights must count as the frames do (--lights)",
           path, name, frame, short_frames_text(listed));
    }
    Light light = found->second;
    if (light.in_world && !camera.view_from_world)
      fail(ErrorKind::input,
           "{}: light \"{}\" is in world space, and needs a camera with world_to_camera: give a --camera file with it, "
           "or the light in view space",
           path, name);
    if (light.in_world) light.at = times(*camera.view_from_world, light.at);
    if (light.in_world && light.is_lamp)
      for (std::size_t i = 0; i < 3; i++) light.at[i] += camera.view_from_world_offset[i];
    if (!light.in_world && camera.left_handed) light.at[2] = -light.at[2];
    light.in_world = false;
    result.push_back(light);
  }
  return result;
}

bool LightsFile::is_soft(std::size_t light) const {
  return std::ranges::any_of(lights[light].of_frames, [](const auto& of_frame) { return of_frame.second.size > 0; });
}

std::shared_ptr<const LightsFile> lights_of(const std::string& text, const std::string& path) {
  LightsFile file{path, text, {}};
  LightReader reader{path, "the file", {}};
  const auto bounded = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > kDeepestLights) reader.refuse(fmt::format("its JSON nests deeper than {}", kDeepestLights));
    return true;
  };
  const Json top = Json::parse(text, bounded, false);
  if (!top.is_object() || !top.contains("lights") || !top["lights"].is_array())
    reader.refuse("it must be a JSON object with a list \"lights\"");
  reader.require_known(top, {"lights"});
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
  return std::make_shared<const LightsFile>(std::move(file));
}

std::shared_ptr<const LightsFile> read_lights(const std::string& path) {
  return lights_of(read_text(path, "lights", "--lights"), path);
}

}  // namespace alcove
