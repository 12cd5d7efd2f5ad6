// Options in the order of their groups, quoted for a shell.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/command.h"

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/frame/chan_file.h"
#include "core/frame/evidence.h"
#include "core/frame/input_files.h"
#include "core/frame/radius.h"
#include "core/inspect/inspection.h"

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
  if (source.rules_said) command.add("--source", settings.source);
  command.add("--depth-channel", settings.depth_channel);
  command.add("--normal-channels", settings.normal_channels);
  command.add("--position-channels", settings.position_channels);
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

void add_depth(Command& command, const FrameSource& source, const InputSettings& settings) {
  command.add("--depth-kind", std::string(name_of(source.depth_kind)));
  const bool has_planes = source.depth_kind == DepthKind::device || source.depth_kind == DepthKind::normalized ||
                          source.depth_kind == DepthKind::log;
  if (has_planes) {
    if (source.depth_kind != DepthKind::log) command.add("--near", source.depth_range.near);
    command.add("--far", source.depth_range.far);
    if (source.depth_range.reversed) command.add("--reversed-z");
  }
  if (source.depth_kind == DepthKind::position)
    command.add("--set position-space", std::string(source.position_space == PositionSpace::world ? "world" : "view"));
  const InputSettings defaults;
  const bool is_device = source.depth_kind == DepthKind::device;
  if (is_device && settings.depth_range.device == DeviceRange::minus_one_to_one)
    command.add("--set device-range=-1..1");
  const bool is_log = source.depth_kind == DepthKind::log;
  if (is_log && settings.depth_range.log_constant != defaults.depth_range.log_constant)
    command.add("--set log-constant", std::optional(settings.depth_range.log_constant));
  if (settings.depth_scale != defaults.depth_scale) command.add("--depth-scale", std::optional(settings.depth_scale));
  if (settings.sky != defaults.sky) command.add("--sky", std::optional(settings.sky));
}

void add_normals(Command& command, const FrameSource& source, const InputSettings& settings, bool has_camera) {
  if (source[RawPlane::normal].empty()) return;
  if (has_camera || settings.normal_space != NormalSpace::automatic)
    command.add("--normal-space", std::string(name_of(source.normal_space)));
  command.add("--normal-encoding", std::string(encoding_name(source)));
  if (to_string(source.flip_normal) != "none") command.add("--flip-normal", to_string(source.flip_normal));
}

void add_camera(Command& command, const InputSettings& settings, bool has_camera) {
  command.add("--camera", settings.camera);
  if (is_chan_file(settings.camera)) command.add("--chan-rotation", settings.chan_rotation);
  command.add("--fov", settings.fov);
  command.add("--focal", settings.focal);
  command.add("--aperture", settings.aperture);
  command.add("--ortho-width", settings.ortho_width);
  if (!has_camera) command.add("--camera CAMERA.json");
}

}  // namespace

const char* encoding_name(const FrameSource& source) {
  if (source.normal_encoding == NormalEncoding::octahedral) return "octahedral";
  if (source.normal_encoding == NormalEncoding::spheremap) return "spheremap";
  return source.normal_unorm ? "unorm" : "signed";
}

std::string command_of(const FrameSource& source, const CommandNames& names, bool has_camera) {
  const InputSettings& settings = names.inputs;
  Command command("alcove run");
  add_files(command, source, settings);
  add_behind(command, settings);
  command.add("--frames", names.frames);
  command.add("-o", names.output);
  add_depth(command, source, settings);
  add_normals(command, source, settings, has_camera);
  add_camera(command, settings, has_camera);
  if (const auto radius = proposed_radius(source.camera, source.median_depth))
    command.add("--radius", radius);
  else
    command.add("--radius RADIUS");
  return command.text();
}

}  // namespace alcove
