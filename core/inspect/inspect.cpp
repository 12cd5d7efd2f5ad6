// Collects one JSON document; the text for people is made from it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/inspect.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/frame/evidence.h"
#include "core/frame/settle.h"
#include "core/inspect/findings.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShownScores = 8;  // in the text; all are in the JSON

const char* name_of(SampleType type) {
  return type == SampleType::half_float ? "half" : type == SampleType::single_float ? "float" : "integer";
}
const char* name_of(NormalSpace space) { return space == NormalSpace::world ? "world" : "view"; }
const char* name_of(const FrameSource& source) {
  if (source.normal_encoding == NormalEncoding::octahedral) return "octahedral";
  if (source.normal_encoding == NormalEncoding::spheremap) return "spheremap";
  return source.normal_unorm ? "unorm" : "signed";
}

Json files_json(const FrameSource& source) {
  Json files = Json::array();
  for (const auto& file : source.files) {
    Json parts = Json::array();
    for (std::size_t p = 0; p < file.parts().size(); p++) {
      const ExrPart& part = file.parts()[p];
      Json channels = Json::array();
      for (const auto& channel : part.channels)
        channels.push_back({{"name", channel.name}, {"type", name_of(channel.type)}});
      parts.push_back({{"name", part.name},
                       {"view", part.view},
                       {"data_window", to_string(part.data)},
                       {"channels", channels},
                       {"attributes", file.attribute_texts(int(p))}});
    }
    files.push_back({{"path", file.path()},
                     {"display_window", to_string(file.display())},
                     {"pixel_aspect", file.pixel_aspect()},
                     {"parts", parts}});
  }
  return files;
}

void add_aov(Json& aovs, const char* name, const FrameSource& source, const std::vector<ChannelRef>& channels,
             bool chosen) {
  if (channels.empty()) return;
  Json names = Json::array();
  for (const auto& channel : channels) names.push_back(channel.channel);
  aovs[name] = {{"file", source.files[channels[0].file].path()},
                {"part", channels[0].part},
                {"channels", names},
                {"why", chosen ? "named by an option" : "a usual name"}};
}

Json camera_json(const FrameSource& source, const InputSettings& settings) {
  const Camera& camera = source.camera;
  const std::string from = !source.camera_from.empty() ? "the header's " + source.camera_from
                           : !settings.camera.empty()  ? "--camera"
                           : settings.fov              ? "--fov"
                           : settings.focal            ? "--focal and --aperture"
                                                       : "--ortho-width";
  return {{"from", from},
          {"projection", camera.orthographic ? "orthographic" : "perspective"},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"horizontal_fov",
           camera.orthographic ? Json() : Json(2 * std::atan(0.5 * camera.width / camera.fx) * 180 / std::numbers::pi)},
          {"world_to_camera", camera.view_from_world.has_value()}};
}

Json depth_json(std::span<const float> raw, const FrameSource& source) {
  const ValueStatistics s = statistics_of(raw);
  Json depth = {{"kind", alcove::name_of(source.depth_kind)},
                {"least", s.least},
                {"most", s.most},
                {"nan", s.nan},
                {"infinite", s.infinite},
                {"negative", s.negative},
                {"zero", s.zero},
                {"one", s.one}};
  return depth;
}

/// What is known once the frame is settled: distances, sky, and the scores of the other readings.
void add_planar(Json& depth, std::span<const float> raw, const std::vector<float>& planar, const FrameSource& source,
                const InputSettings& settings) {
  std::vector<float> surfaces;
  std::ranges::copy_if(planar, std::back_inserter(surfaces), [](float z) { return !std::isinf(z); });
  depth["sky_share"] = 1 - double(surfaces.size()) / double(planar.size());
  if (!surfaces.empty()) {
    std::ranges::sort(surfaces);
    depth["nearest"] = surfaces.front(), depth["median"] = surfaces[surfaces.size() / 2],
    depth["farthest"] = surfaces.back();
  }
  depth["scores"] = Json::array();
  if (source.depth_kind != DepthKind::position)
    for (const auto& score :
         score_depth(raw, view_of(source.camera, source.data, source.display), settings.sky, depth_rounding(source)))
      depth["scores"].push_back({{"kind", alcove::name_of(score.kind)}, {"straight", score.straight}});
}

Json normals_json(std::span<const float> normal, std::span<const float> raw, const FrameSource& source) {
  const NormalStatistics s = normal_statistics(normal, raw, depth_map_of(source));
  Json json = {
      {"space", name_of(source.normal_space)},
      {"encoding", name_of(source)},
      {"flips", to_string(source.flip_normal)},
      {"mean_length", has_lengths(source) ? Json(source.normal_unorm ? s.unorm_mean_length : s.mean_length) : Json()},
      {"unit_share", has_lengths(source) ? Json(source.normal_unorm ? s.unorm_unit_share : s.unit_share) : Json()},
      {"least", s.least},
      {"most", s.most},
      {"scores", Json::array()}};
  const View view = view_of(source.camera, source.data, source.display);
  for (const auto& score : score_normals(normal, source.normal_encoding, source.normal_unorm, raw, depth_map_of(source),
                                         source.camera, view)) {
    const Json entry = {{"space", name_of(score.space)},
                        {"flips", to_string(score.flips)},
                        {"agreement", score.agreement},
                        {"angle", score.angle},
                        {"facing", score.facing}};
    json["scores"].push_back(entry);
    if (score.space == source.normal_space && to_string(score.flips) == to_string(source.flip_normal))
      json["agreement"] = score.agreement, json["angle"] = score.angle, json["facing"] = score.facing;
  }
  return json;
}

/// A word as a shell takes it.
std::string quoted(const std::string& word) {
  if (word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./%-+=,:") == word.npos &&
      !word.empty())
    return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// The run that reads the frame as it was understood, every guess made explicit.
std::string command_of(const FrameSource& source, const InputSettings& s, const Json& depth, bool has_camera) {
  std::string text = "alcove run";
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) text += fmt::format(" {} {}", option, quoted(value));
  };
  const auto add_number = [&](const char* option, const std::optional<double>& value) {
    if (value) text += fmt::format(" {} {}", option, *value);
  };
  if (!s.input.empty()) text += " " + quoted(s.input);
  add("--depth", s.depth), add("--normal", s.normal), add("--position", s.position), add("--layer", s.layer),
      add("--view", s.view);
  if (source.rules_said) add("--source", s.source);
  add("--depth-channel", s.depth_channel), add("--normal-channels", s.normal_channels),
      add("--position-channels", s.position_channels);
  text += fmt::format(" -o ao.exr --depth-kind {}", alcove::name_of(source.depth_kind));
  const bool has_planes = source.depth_kind == DepthKind::device || source.depth_kind == DepthKind::normalized ||
                          source.depth_kind == DepthKind::log;
  if (has_planes) add_number("--near", source.depth_range.near), add_number("--far", source.depth_range.far);
  if (has_planes && source.depth_range.reversed) text += " --reversed-z";
  if (source.depth_kind == DepthKind::position)
    add("--position-space", source.position_space == PositionSpace::world ? "world" : "view");
  if (s.depth_range.device == DeviceRange::minus_one_to_one) text += " --device-range=-1..1";
  if (s.depth_range.log_constant != 1) add_number("--log-constant", s.depth_range.log_constant);
  if (s.depth_scale != 1) add_number("--depth-scale", s.depth_scale);
  if (s.sky != 1e9) add_number("--sky", s.sky);
  if (!source[RawPlane::normal].empty()) {
    if (has_camera || s.normal_space != NormalSpace::automatic) add("--normal-space", name_of(source.normal_space));
    add("--normal-encoding", name_of(source));
    if (to_string(source.flip_normal) != "none") add("--flip-normal", to_string(source.flip_normal));
  }
  add("--camera", s.camera);
  add_number("--fov", s.fov), add_number("--focal", s.focal), add_number("--aperture", s.aperture),
      add_number("--ortho-width", s.ortho_width);
  if (!has_camera) text += " --camera CAMERA.json";
  // A tenth of the median distance, by one figure: as much as a guess at a radius deserves.
  return text +
         (depth.contains("median")
              ? fmt::format(" --radius {}", std::stod(fmt::format("{:.1g}", 0.1 * depth["median"].get<double>())))
              : std::string(" --radius RADIUS"));
}

std::string percent(const Json& share) { return fmt::format("{:.1f} %", 100 * share.get<double>()); }

std::string text_of(const Json& json) {
  std::string text;
  const auto line = [&]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
    text += printable(fmt::format(format, std::forward<Args>(args)...)) + "\n";
  };
  for (const auto& file : json["files"]) {
    line("{}: display window {}, pixel aspect {:.4g}", file["path"].get<std::string>(),
         file["display_window"].get<std::string>(), file["pixel_aspect"].get<double>());
    for (const auto& part : file["parts"]) {
      const std::string name = part["name"], view = part["view"];
      line("  part{}{}: data window {}", name.empty() ? "" : " " + name, view.empty() ? "" : ", view " + view,
           part["data_window"].get<std::string>());
      for (const auto& channel : part["channels"])
        line("    {} ({})", channel["name"].get<std::string>(), channel["type"].get<std::string>());
      for (const auto& [key, value] : part["attributes"].items())
        line("    {} = {}", key, value.get<std::string>().substr(0, 100));
    }
  }
  if (const auto& program = json["source"]; !program.is_null())
    line("source: {}{}", program["name"].get<std::string>(),
         program["by"].empty() || program["by"] == "" ? "" : " (" + program["by"].get<std::string>() + ")");
  for (const auto& [name, aov] : json["aovs"].items()) {
    std::vector<std::string> channels = aov["channels"];
    line("{}: {} ({})", name, fmt::join(channels, ", "), aov["why"].get<std::string>());
  }
  if (const auto& camera = json["camera"]; !camera.is_null())
    line("camera: {} by {}, {}, {} world_to_camera", camera["projection"].get<std::string>(),
         camera["from"].get<std::string>(),
         camera["horizontal_fov"].is_null()
             ? fmt::format("{:.5g} px a scene unit", camera["fx"].get<double>())
             : fmt::format("{:.2f} degrees wide", camera["horizontal_fov"].get<double>()),
         camera["world_to_camera"] ? "with" : "without");
  const char* straight = !json["camera"].is_null() && json["camera"]["projection"] == "orthographic" ? "z" : "1/z";
  if (const auto& depth = json["depth"]; !depth.is_null()) {
    line("depth: {}, values {:.6g} to {:.6g}; {} NaN, {} infinite, {} negative, {} of 0, {} of 1",
         depth["kind"].get<std::string>(), depth["least"].get<double>(), depth["most"].get<double>(),
         depth["nan"].dump(), depth["infinite"].dump(), depth["negative"].dump(), depth["zero"].dump(),
         depth["one"].dump());
    if (depth.contains("median"))
      line("  distances {:.6g} to {:.6g}, median {:.6g}; sky {}", depth["nearest"].get<double>(),
           depth["farthest"].get<double>(), depth["median"].get<double>(), percent(depth["sky_share"]));
    for (const auto& score : depth.value("scores", Json::array()))
      line("  only as {}: {} straight on {}", score["kind"].get<std::string>(), straight, percent(score["straight"]));
  }
  if (const auto& normals = json["normals"]; !normals.is_null()) {
    const std::string lengths = normals["mean_length"].is_null()
                                    ? ""
                                    : fmt::format(", mean length {:.4f}, of unit length on {}",
                                                  normals["mean_length"].get<double>(), percent(normals["unit_share"]));
    line("normals: {} space, {}, flips {}{}", normals["space"].get<std::string>(),
         normals["encoding"].get<std::string>(), normals["flips"].get<std::string>(), lengths);
    for (std::size_t i = 0; i < std::min<std::size_t>(normals["scores"].size(), kShownScores); i++) {
      const auto& score = normals["scores"][i];
      line("  as {} with flips {}: {} agree with depth, a quarter within {:.1f} degrees, {} face the camera",
           score["space"].get<std::string>(), score["flips"].get<std::string>(), percent(score["agreement"]),
           score["angle"].get<double>(), percent(score["facing"]));
    }
  }
  for (const auto& guess : json["guesses"])
    line("guess: {} {}, since {} ({})", guess["what"].get<std::string>(), guess["chosen"].get<std::string>(),
         guess["why"].get<std::string>(), guess["option"].get<std::string>());
  for (const auto& note : json["notes"]) line("note: {}", note.get<std::string>());
  for (const auto& finding : json["suspicious"]) line("suspicious: {}", finding.get<std::string>());
  for (const auto& missing : json["missing"]) line("missing: {}", missing.get<std::string>());
  if (json["command"] != "") line("{}", json["command"].get<std::string>());
  return text;
}

/// A camera for frames that have none yet, so that everything else can be looked at.
InputSettings with_some_camera(InputSettings settings) {
  settings.fov = 50;
  if (settings.normal_space == NormalSpace::automatic) settings.normal_space = NormalSpace::view;
  return settings;
}

}  // namespace

Inspection inspect_frame(const InputSettings& settings, int frame) {
  Json json = {{"files", Json::array()},   {"source", nullptr},      {"aovs", Json::object()},
               {"camera", nullptr},        {"depth", nullptr},       {"normals", nullptr},
               {"guesses", Json::array()}, {"notes", Json::array()}, {"suspicious", Json::array()},
               {"missing", Json::array()}, {"command", ""}};
  FrameSource source;
  bool has_camera = !settings.camera.empty() || settings.fov || settings.focal || settings.ortho_width;
  try {
    has_camera = has_camera || header_has_camera(settings);
  } catch (const Error&) {  // said below, with all that is missing
  }
  const InputSettings reading = has_camera ? settings : with_some_camera(settings);
  const auto finish = [&] {
    json["files"] = files_json(source);
    return Inspection{text_of(json), json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", std::nullopt};
  };
  if (!has_camera)
    json["missing"].push_back("camera: --camera FILE.json, or --fov, or --focal with --aperture, or --ortho-width");
  try {
    source = find_frame(reading, false, frame);
  } catch (const Error& error) {
    for (const std::string& path : {settings.input, settings.depth, settings.normal, settings.position})
      if (!path.empty()) source.files.push_back(open_file(path, "INPUT"));  // what cannot be read fails here
    json["missing"].push_back(error.what());
    return finish();
  }
  json["source"] = {{"name", source.rules->name}, {"by", source.rules_by}};
  add_aov(json["aovs"], source[RawPlane::depth].size() == 3 ? "position" : "depth", source, source[RawPlane::depth],
          !settings.depth_channel.empty() || !settings.position_channels.empty());
  add_aov(json["aovs"], "normal", source, source[RawPlane::normal], !settings.normal_channels.empty());
  if (source[RawPlane::normal].empty())
    json["missing"].push_back(
        "normals: they would be reconstructed from depth; --normal or --normal-channels names them");
  if (has_camera) json["camera"] = camera_json(source, settings);
  require_host_room(source.depth_path(), source.data);
  std::vector<float> depth(source[RawPlane::depth].size() * source.data.pixels()),
      normal(source[RawPlane::normal].size() * source.data.pixels());
  try {
    read_planes(source, {{&source[RawPlane::depth], depth.data()}, {&source[RawPlane::normal], normal.data()}});
  } catch (const Error& error) {
    json["suspicious"].push_back(error.what());
    Inspection inspection = finish();
    inspection.unreadable = error;
    return inspection;
  }
  json["depth"] = depth_json(depth, source);
  try {
    const auto notes = source.notes;
    settle(source, reading, depth, normal);
    if (!has_camera) {  // a camera that nobody gave has nothing to say
      source.notes = notes;
      if (settings.normal_space == NormalSpace::automatic) source.normal_space = source.usual_normal_space;
    }
    json["depth"]["kind"] = alcove::name_of(source.depth_kind);
    const auto planar = planar_depths(depth, depth_map_of(source), view_of(source.camera, source.data, source.display));
    add_planar(json["depth"], depth, planar, source, reading);
    if (!normal.empty()) json["normals"] = normals_json(normal, depth, source);
    if (!normal.empty() && !has_camera)
      json["normals"]["scores"].clear(), json["normals"].erase("agreement"), json["normals"].erase("angle"),
          json["normals"].erase("facing");
    json["suspicious"] = source.suspicious;
    for (const auto& finding : findings(source, depth, normal)) json["suspicious"].push_back(finding);
    json["command"] = command_of(source, settings, json["depth"], has_camera);
  } catch (const Error& error) {
    json["missing"].push_back(error.what());
    if (source.depth_kind_open) json["depth"]["kind"] = "undecided";
  }
  for (const auto& guess : source.guesses)
    json["guesses"].push_back(
        {{"what", guess.what}, {"chosen", guess.chosen}, {"why", guess.why}, {"option", guess.option}});
  json["notes"] = source.notes;
  try {
    const FrameSource beauty = find_frame(reading, true, frame);
    add_aov(json["aovs"], "beauty", beauty, beauty[RawPlane::beauty], !settings.beauty_channels.empty());
    add_aov(json["aovs"], "indirect", beauty, beauty[RawPlane::indirect], false);
    add_aov(json["aovs"], "diffuse_color", beauty, beauty[RawPlane::diffuse_color], false);
  } catch (const Error&) {
    json["missing"].push_back("beauty: only --composite needs one; --beauty or --beauty-channels names it");
  }
  return finish();
}

}  // namespace alcove
