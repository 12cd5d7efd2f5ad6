// What a run is told: options in the order of their groups, quoted for a shell; and the camera as JSON.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/frame/pixels/radius.h"
#include "core/frame/settle/settle.h"
#include "core/inspect/inspect.h"

namespace alcove {
namespace {

/// A command line in the making. Options without a value are left out.
class Command {
 public:
  explicit Command(std::string program) : text_(std::move(program)) {}

  void add(const std::string& word) { text_ += " " + word; }
  void add(const char* option, const std::string& value) {
    if (!value.empty()) text_ += " " + typed(option, for_shell(value));
  }
  void add(const char* option, const std::optional<double>& value) {
    if (value) text_ += " " + typed(option, fmt::format("{}", *value));
  }
  const std::string& text() const { return text_; }
  bool has(const std::string& option) const {
    return text_.find(" " + option + " ") != text_.npos || text_.find(" " + option + "=") != text_.npos;
  }

 private:
  std::string text_;
};

void add_files(Command& command, const FrameSource& source, const InputSettings& settings) {
  if (!settings.input.empty()) command.add(for_shell(settings.input));
  command.add("--depth", settings.depth);
  command.add("--normal", settings.normal);
  command.add("--position", settings.position);
  command.add("--layer", settings.layer);
  command.add("--view", settings.view);
  if (source.program.is_said()) command.add("--source", settings.source);
  command.add("--depth-channel", settings.depth_channel);
  command.add("--normal-channels", settings.normal_channels);
  command.add("--set position-channels", settings.position_channels);
}

/// The beauty goes with the composite that it is for.
void add_beauty(Command& command, const InputSettings& settings, const std::string& composite) {
  command.add("--beauty", settings.beauty);
  command.add("--set beauty-channels", settings.beauty_channels);
  if (settings.beauty.empty() && settings.beauty_channels.empty()) return;
  command.add("--composite", composite);
}

void add_behind(Command& command, const InputSettings& settings) {
  for (const auto& file : settings.behind) command.add("--behind", file);
  command.add("--set behind-channel", fmt::format("{}", fmt::join(settings.behind_channels, ",")));
  std::vector<std::string> kinds;
  for (const BehindKind kind : settings.behind_kinds) kinds.push_back(word_of(kind));
  command.add("--behind-kind", fmt::format("{}", fmt::join(kinds, ",")));
  for (const auto& file : settings.deep) command.add("--deep", file);
  if (has_deep(settings) && settings.deep_opacity != InputSettings().deep_opacity)
    command.add("--set deep-opacity", std::optional(settings.deep_opacity));
}

/// The numbers that were typed, and the shift that was found.
void add_disparity(Command& command, const Reading& reading, const DepthRange& said) {
  command.add("--near", said.near);
  command.add("--far", said.far);
  command.add("--set disparity-scale", said.disparity_scale);
  const bool is_said = disparity_of(said).shift.has_value();
  command.add("--set disparity-shift", is_said ? said.disparity_shift : reading.depth_range.disparity_shift);
}

void add_depth(Command& command, const FrameSource& source, const InputSettings& settings) {
  command.add("--depth-kind", word_of(source.reading.depth_kind));
  if (is_between_planes(source.reading.depth_kind)) {
    if (source.reading.depth_kind != DepthKind::log) command.add("--near", source.reading.depth_range.near);
    command.add("--far", source.reading.depth_range.far);
    if (source.reading.depth_range.reversed) command.add("--reversed-z");
  }
  if (source.reading.depth_kind == DepthKind::disparity) add_disparity(command, source.reading, settings.depth_range);
  if (source.reading.depth_kind == DepthKind::position)
    command.add("--set position-space", word_of(source.reading.position_space));
  const InputSettings defaults;
  const bool is_device = source.reading.depth_kind == DepthKind::device;
  if (is_device && settings.depth_range.device != DeviceRange::automatic)
    command.add("--set device-range=" + std::string(word_of(settings.depth_range.device)));
  const bool is_log = source.reading.depth_kind == DepthKind::log;
  if (is_log && settings.depth_range.log_constant != defaults.depth_range.log_constant)
    command.add("--set log-constant", std::optional(settings.depth_range.log_constant));
  if (settings.depth_scale != defaults.depth_scale) command.add("--depth-scale", std::optional(settings.depth_scale));
  if (settings.sky != defaults.sky) command.add("--sky", std::optional(settings.sky));
}

void add_normals(Command& command, const FrameSource& source, const InputSettings& settings, bool has_camera) {
  if (source.channels[RawPlane::normal].empty()) return;
  if (has_camera || settings.normal_space != NormalSpace::automatic)
    command.add("--normal-space", word_of(source.reading.normal_space));
  command.add("--normal-encoding",
              std::string(encoding_name(source.reading.normal_encoding, source.reading.normal_unorm)));
  if (to_string(source.reading.flip_normal) != "none")
    command.add("--flip-normal", to_string(source.reading.flip_normal));
}

void add_camera(Command& command, const InputSettings& settings, bool has_camera) {
  command.add("--camera", settings.camera);
  if (is_chan_file(settings.camera)) command.add("--chan-rotation", settings.chan_rotation);
  command.add("--fov", settings.fov);
  command.add("--vertical-fov", settings.vertical_fov);
  command.add("--focal-px", settings.focal_px);
  command.add("--focal", settings.focal);
  command.add("--aperture", settings.aperture);
  command.add("--ortho-width", settings.ortho_width);
  if (!has_camera) command.add("--camera CAMERA.json");
}

}  // namespace

std::string command_of(const FrameSource& source, const CommandNames& names, bool has_camera) {
  const InputSettings& settings = names.inputs;
  Command command("alcove run");
  add_files(command, source, settings);
  add_behind(command, settings);
  command.add("--frames", names.frames);
  command.add("-o", names.output);
  add_beauty(command, settings, names.composite);
  add_depth(command, source, settings);
  add_normals(command, source, settings, has_camera);
  add_camera(command, settings, has_camera);
  for (const auto& [option, words] : names.typed)
    if (!command.has(option)) command.add(words);
  if (command.has("--radius")) return command.text();
  const DepthRange& said = settings.depth_range;
  const bool has_scale = said.near || said.far || said.disparity_scale;
  const auto radius = proposed_radius(source.reading.camera, source.evidence->median_depth);
  if (radius && source.reading.depth_kind == DepthKind::disparity && !has_scale)
    command.add("--radius", fmt::format("{:.2g}%", 100 * *radius / *source.evidence->median_depth));
  else if (radius)
    command.add("--radius", radius);
  else
    command.add("--radius RADIUS");
  return command.text();
}

// Camera files.

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
