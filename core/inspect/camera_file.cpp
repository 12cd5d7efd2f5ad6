// Camera -> JSON.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/camera_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

Json fields_of(const Camera& camera) {
  Json fields{{"resolution", {camera.width, camera.height}},
              {"projection", camera.orthographic ? "orthographic" : "perspective"},
              {"fx", camera.fx},
              {"fy", camera.fy},
              {"cx", camera.cx},
              {"cy", camera.cy}};
  if (camera.left_handed) fields["camera_space"] = "left-handed";
  if (camera.view_from_world) {
    Json& rows = fields["world_to_camera"] = Json::array();
    for (std::size_t row = 0; row < 3; row++) {
      const double sign = camera.left_handed && row == 2 ? -1 : 1;  // its own z looks forward
      Json numbers = Json::array();
      for (const double x : (*camera.view_from_world)[row]) numbers.push_back(sign * x);
      numbers.push_back(sign * camera.view_from_world_offset[row]);
      rows.push_back(std::move(numbers));
    }
    rows.push_back({0, 0, 0, 1});
  }
  if (camera.near) fields["near"] = *camera.near;
  if (camera.far) fields["far"] = std::isinf(*camera.far) ? Json("inf") : Json(*camera.far);
  if (camera.reversed_z) fields["reversed_z"] = true;
  return fields;
}

std::string text_of(const Json& json) { return json.dump(1) + "\n"; }

}  // namespace

std::string camera_file(const Camera& camera) { return text_of(fields_of(camera)); }

std::string camera_file(const std::map<int, Camera>& cameras) {
  Json frames = Json::array();
  for (const auto& [frame, camera] : cameras) {
    Json entry{{"frame", frame}};
    entry.update(fields_of(camera));
    frames.push_back(std::move(entry));
  }
  return text_of({{"frames", std::move(frames)}});
}

}  // namespace alcove
