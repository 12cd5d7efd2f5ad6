// An inspection as lines for people and as one JSON document; and the contact sheet, for which the chain runs.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/formats/png.h"
#include "core/inspect/inspect.h"

namespace alcove {

// Lines.

const char* name_of(SampleType type) {
  switch (type) {
    case SampleType::half_float: return "half";
    case SampleType::single_float: return "float";
    case SampleType::integer: break;
  }
  return "integer";
}

namespace {

constexpr std::size_t kShownScores = 8;        // of normals; the JSON has all of them
constexpr std::size_t kShownCharacters = 100;  // of an attribute
constexpr std::size_t kShownValue = 300;       // of what changes along a sequence

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string text_of(const Distances& distances) {
  return fmt::format("distances {:.4g} to {:.4g}, median {:.4g}; sky {}", *distances.nearest, *distances.farthest,
                     *distances.median, percent(distances.sky_share));
}

/// Lines that a terminal may show.
class TextLines {
 public:
  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    text_ += printable(fmt::format(format, std::forward<Args>(args)...)) + "\n";
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// A layer's channels of one type, on one line.
struct LayerLine {
  std::string layer, channels;
  SampleType type;
};

std::vector<LayerLine> layers_of(const ExrPart& header) {
  std::vector<LayerLine> layers;
  for (const auto& channel : header.channels) {
    const std::size_t dot = channel.name.rfind('.');
    const std::string layer = dot == channel.name.npos ? "" : channel.name.substr(0, dot);
    const std::string name = dot == channel.name.npos ? channel.name : channel.name.substr(dot + 1);
    if (!layers.empty() && layers.back().layer == layer && layers.back().type == channel.type)
      layers.back().channels += " " + name;
    else
      layers.push_back({layer, name, channel.type});
  }
  return layers;
}

std::size_t longest(const std::vector<LayerLine>& layers, std::string LayerLine::*text) {
  std::size_t most = 0;
  for (const auto& layer : layers) most = std::max(most, (layer.*text).size());
  return most;
}

void add(TextLines& lines, const InspectedPart& part, bool has_evidence) {
  const ExrPart& header = part.header;
  lines.add("  part{}{}: data window {}", header.name.empty() ? "" : " " + header.name,
            header.view.empty() ? "" : ", view " + header.view, to_string(header.data));
  const auto layers = layers_of(header);
  const std::size_t width = longest(layers, &LayerLine::layer), names = longest(layers, &LayerLine::channels);
  for (const auto& [layer, channels, type] : layers)
    lines.add("    {:{}}{}{:{}}  {}", layer, width, width > 0 ? "  " : "", channels, names, name_of(type));
  if (!has_evidence) return;
  for (const auto& [name, value] : part.attributes) lines.add("    {} = {}", name, value.substr(0, kShownCharacters));
}

void add(TextLines& lines, const InspectedFile& file, bool has_evidence) {
  lines.add("{}: display window {}, pixel aspect {:.4g}", file.path, to_string(file.display), file.pixel_aspect);
  for (const auto& part : file.parts) add(lines, part, has_evidence);
  for (const auto& matte : file.cryptomattes) {
    std::vector<std::string> names;
    for (const auto& [name, id] : matte.manifest) names.push_back(name);
    const std::string lacking = matte.lacking.empty() ? "no manifest" : matte.lacking;
    lines.add("  Cryptomatte {}, for --matte-object, --set occluders and --set ignore: {}", matte.name,
              names.empty() ? lacking : list_of(names));
  }
}

void add(TextLines& lines, const InspectedCamera& inspected) {
  const Camera& camera = inspected.camera;
  const double degrees = 2 * std::atan(0.5 * camera.width / camera.fx) * 180 / std::numbers::pi;
  lines.add("camera: {} by {}, {}, {} world_to_camera", camera.orthographic ? "orthographic" : "perspective",
            inspected.from,
            camera.orthographic ? fmt::format("{:.5g} px per scene unit", camera.fx)
                                : fmt::format("{:.2f} degrees wide", degrees),
            camera.view_from_world ? "with" : "without");
}

std::string text_of(const InspectedAov& aov) {
  return fmt::format("{}{}", fmt::join(aov.channels, ", "), aov.is_chosen ? ", named by an option" : "");
}

/// The channels of an AOV; "" where there is none.
std::string channels_of(const Inspection& inspection, std::initializer_list<std::string_view> names) {
  for (const auto& aov : inspection.aovs)
    if (std::ranges::find(names, aov.name) != names.end()) return ", " + text_of(aov);
  return "";
}

void add(TextLines& lines, const InspectedDepth& depth, const std::string& channels) {
  if (depth.distances && depth.distances->median)
    lines.add("depth: {}{}, {}", depth.kind, channels, text_of(*depth.distances));
  else
    lines.add("depth: {}{}, values {:.6g} to {:.6g}", depth.kind, channels, depth.values.least, depth.values.most);
}

void add_evidence(TextLines& lines, const InspectedDepth& depth) {
  const ValueStatistics& values = depth.values;
  lines.add("depth values {:.6g} to {:.6g}; {} NaN, {} infinite, {} negative, {} of 0, {} of 1", values.least,
            values.most, values.nan, values.infinite, values.negative, values.zero, values.one);
  if (!depth.scores) return;
  for (const auto& score : *depth.scores)
    lines.add("  as {} alone {} of the smooth places are flat", word_of(score.kind), percent(score.straight));
}

void add(TextLines& lines, const InspectedNormals& normals, const std::string& channels) {
  lines.add("normals: {} space, {}, flips {}{}", word_of(normals.space), normals.encoding, to_string(normals.flips),
            channels);
}

void add_evidence(TextLines& lines, const InspectedNormals& normals) {
  if (normals.mean_length)
    lines.add("normals of mean length {:.4f}, of unit length on {}", *normals.mean_length,
              percent(*normals.unit_share));
  for (std::size_t i = 0; i < std::min(normals.scores.size(), kShownScores); i++) {
    const NormalScore& score = normals.scores[i];
    lines.add("  as {} with flips {}: {} agree with depth, a quarter within {:.1f} degrees, {} face the camera{}",
              word_of(score.space), to_string(score.flips), percent(score.agreement), score.angle,
              percent(score.facing),
              score.opposite > 0 ? fmt::format(", {} are opposite to depth", percent(score.opposite)) : "");
  }
}

void add(TextLines& lines, const InspectedDeep& deep) {
  lines.add("deep: {} part {}: {}, {}, {}; {:.2f} samples per pixel, {} at most; {} hidden behind opaque ones",
            deep.file, fmt::join(deep.parts, ", "), deep.layout.is_tiled ? "tiles" : "lines", deep.layout.compression,
            deep.layout.state, deep.samples_per_pixel(), deep.counts.most, percent(deep.hidden_share()));
  if (deep.counts.volumes > 0) lines.add("  {} samples are volumes", deep.counts.volumes);
  if (deep.counts.repaired > 0) lines.add("  {} samples had to be repaired", deep.counts.repaired);
  if (!deep.depth.empty()) lines.add("  its Z is {}", deep.depth);
  if (deep.shows_nothing_hidden()) lines.add("  holds no surface behind an opaque one: elements rendered in one go");
}

void add(TextLines& lines, const SequenceCamera& camera, bool is_orthographic) {
  const char* unit = is_orthographic ? "scene units" : "degrees";
  const bool is_constant = camera.widest - camera.narrowest < 1e-6 * camera.widest;
  std::string text = is_constant ? fmt::format("{:.2f} {} wide in all frames", camera.widest, unit)
                                 : fmt::format("{:.2f} to {:.2f} {} wide", camera.narrowest, camera.widest, unit);
  if (camera.is_placed && camera.farthest == 0 && camera.largest_turn == 0)
    text += ", stands still";
  else if (camera.is_placed)
    text += fmt::format(", moves up to {:.4g} scene units and turns up to {:.4g} degrees from its first place",
                        camera.farthest, camera.largest_turn);
  if (camera.largest_step > 0)
    text += fmt::format("; its largest step is {:.4g}, to frame {}", camera.largest_step, camera.at_largest_step);
  lines.add("  camera: {}", text);
}

void add(TextLines& lines, const SequenceDepth& depth) {
  lines.add("  depth of frame {}: {}", depth.frame, depth.distances.median ? text_of(depth.distances) : "all is sky");
}

void add(TextLines& lines, const InspectedSequence& sequence, bool is_orthographic) {
  lines.add("sequence: {}, {}; shown is frame {}", counted(sequence.frames.size(), "frame"),
            frames_text(sequence.frames), sequence.shown);
  if (!sequence.absent.empty()) lines.add("  missing frames: {}", frames_text(sequence.absent));
  for (const auto& change : sequence.changes)
    for (const auto& [value, frames] : change.values)
      lines.add("  {}: {} ({} {})", change.what, value.substr(0, kShownValue), frames.size() == 1 ? "frame" : "frames",
                frames_text(frames));
  if (!sequence.same.empty()) lines.add("  the same in all frames: {}", fmt::join(sequence.same, ", "));
  if (sequence.camera) add(lines, *sequence.camera, is_orthographic);
  for (const auto& depth : sequence.depth) add(lines, depth);
}

}  // namespace

std::string inspection_text(const Inspection& inspection, bool has_evidence) {
  TextLines lines;
  const std::string depth = channels_of(inspection, {"depth", "position"}),
                    normal = channels_of(inspection, {"normal"});
  if (const auto& source = inspection.source)
    lines.add("source: {}{}", source->name, source->by.empty() ? "" : " (" + source->by + ")");
  if (inspection.depth) add(lines, *inspection.depth, depth);
  if (inspection.normals) add(lines, *inspection.normals, normal);
  if (inspection.camera) add(lines, *inspection.camera);
  for (const auto& aov : inspection.aovs) {
    const bool is_said = (inspection.depth && (aov.name == "depth" || aov.name == "position")) ||
                         (inspection.normals && aov.name == "normal");
    if (!is_said) lines.add("{}: {}", aov.name, text_of(aov));
  }
  if (inspection.light && inspection.light->adds_up) lines.add("light passes: {} is the beauty", inspection.light->sum);
  for (const auto& deep : inspection.deep) add(lines, deep);
  const bool is_orthographic = inspection.camera && inspection.camera->camera.orthographic;
  if (inspection.sequence) add(lines, *inspection.sequence, is_orthographic);
  for (const auto& file : inspection.files) add(lines, file, has_evidence);
  if (has_evidence && inspection.depth) add_evidence(lines, *inspection.depth);
  if (has_evidence && inspection.normals) add_evidence(lines, *inspection.normals);
  for (const auto& guess : inspection.guesses)
    lines.add("guess: {} {}, since {} ({})", guess.what, guess.chosen, guess.why, guess.option);
  for (const auto& guess : inspection.hidden)
    lines.add("perhaps hidden surfaces: {} of {}; a run takes what --behind names", guess.channel, guess.file);
  if (!inspection.hidden_options.empty()) lines.add("  {}", inspection.hidden_options);
  for (const auto& note : inspection.notes) lines.add("{}: {}", level_of(note), line_of(note, ""));
  for (const auto& finding : inspection.suspicious) lines.add("suspicious: {}", finding.text);
  for (const auto& missing : inspection.missing) lines.add("missing: {}", missing);
  for (const auto& refused : inspection.refused) lines.add("refused: {}", refused);
  if (!inspection.command.empty()) lines.add("{}", inspection.command);
  return lines.text();
}

// JSON.

namespace {

using Json = nlohmann::ordered_json;

Json number(std::optional<double> value) { return value ? Json(*value) : Json(); }

Json to_json(const InspectedPart& part) {
  Json channels = Json::array();
  for (const auto& channel : part.header.channels)
    channels.push_back({{"name", channel.name}, {"type", name_of(channel.type)}});
  return {{"name", part.header.name},
          {"view", part.header.view},
          {"data_window", to_string(part.header.data)},
          {"channels", channels},
          {"attributes", part.attributes}};
}

Json to_json(const Cryptomatte& matte) {
  Json objects = Json::array();
  for (const auto& [name, id] : matte.manifest) objects.push_back(name);
  return {{"name", matte.name},
          {"part", matte.part},
          {"ranks", matte.ranks.size()},
          {"objects", objects},
          {"lacking", matte.lacking}};
}

Json to_json(const InspectedFile& file) {
  Json parts = Json::array();
  Json mattes = Json::array();
  for (const auto& matte : file.cryptomattes) mattes.push_back(to_json(matte));
  for (const auto& part : file.parts) parts.push_back(to_json(part));
  return {{"path", file.path},
          {"display_window", to_string(file.display)},
          {"pixel_aspect", file.pixel_aspect},
          {"parts", parts},
          {"cryptomattes", mattes}};
}

Json to_json(const InspectedDeep& deep) {
  return {{"file", deep.file},
          {"parts", deep.parts},
          {"storage", deep.layout.is_tiled ? "tiles" : "lines"},
          {"compression", deep.layout.compression},
          {"state", deep.layout.state},
          {"samples", deep.counts.samples},
          {"samples_per_pixel", deep.samples_per_pixel()},
          {"most_samples", deep.counts.most},
          {"volumes", deep.counts.volumes},
          {"repaired", deep.counts.repaired},
          {"hidden_share", deep.hidden_share()},
          {"shows_nothing_hidden", deep.shows_nothing_hidden()},
          {"depth", deep.depth}};
}

Json to_json(const InspectedSource& source) { return {{"name", source.name}, {"by", source.by}}; }

Json to_json(const InspectedAov& aov) {
  return {{"file", aov.file},
          {"part", aov.part},
          {"channels", aov.channels},
          {"why", aov.is_chosen ? "named by an option" : "a usual name"}};
}

Json to_json(const InspectedCamera& inspected) {
  const Camera& camera = inspected.camera;
  const double half_width = 0.5 * camera.width / camera.fx;
  return {{"from", inspected.from},
          {"projection", camera.orthographic ? "orthographic" : "perspective"},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"horizontal_fov", camera.orthographic ? Json() : Json(2 * std::atan(half_width) * 180 / std::numbers::pi)},
          {"world_to_camera", camera.view_from_world.has_value()}};
}

Json to_json(const Distances& distances) {
  return {{"sky_share", distances.sky_share},
          {"nearest", number(distances.nearest)},
          {"median", number(distances.median)},
          {"farthest", number(distances.farthest)}};
}

Json to_json(const InspectedDepth& depth) {
  const ValueStatistics& values = depth.values;
  Json json = {
      {"kind", depth.kind},          {"least", values.least},       {"most", values.most}, {"nan", values.nan},
      {"infinite", values.infinite}, {"negative", values.negative}, {"zero", values.zero}, {"one", values.one}};
  const Json distances = depth.distances ? to_json(*depth.distances) : Json::object();
  for (const auto& [name, value] : distances.items())
    if (!value.is_null()) json[name] = value;
  if (!depth.scores) return json;
  json["scores"] = Json::array();
  for (const auto& score : *depth.scores)
    json["scores"].push_back({{"kind", word_of(score.kind)}, {"straight", score.straight}});
  return json;
}

Json to_json(const NormalScore& score) {
  return {{"space", word_of(score.space)}, {"flips", to_string(score.flips)},
          {"agreement", score.agreement},  {"opposite", score.opposite},
          {"close", score.close},          {"angle", score.angle},
          {"turn", score.turn_degrees()},  {"facing", score.facing}};
}

Json to_json(const InspectedNormals& normals) {
  Json scores = Json::array();
  for (const auto& score : normals.scores) scores.push_back(to_json(score));
  Json json = {{"space", word_of(normals.space)},
               {"encoding", normals.encoding},
               {"flips", to_string(normals.flips)},
               {"mean_length", number(normals.mean_length)},
               {"unit_share", number(normals.unit_share)},
               {"least", normals.least},
               {"most", normals.most},
               {"scores", scores}};
  if (!normals.chosen) return json;
  json["agreement"] = normals.chosen->agreement;
  json["close"] = normals.chosen->close;
  json["angle"] = normals.chosen->angle;
  json["facing"] = normals.chosen->facing;
  return json;
}

Json to_json(const Guess& guess) {
  return {{"what", guess.what}, {"chosen", guess.chosen}, {"why", guess.why}, {"option", guess.option}};
}

Json to_json(const SequenceChange& change) {
  Json values = Json::array();
  for (const auto& [value, frames] : change.values)
    values.push_back({{"value", value}, {"frames", frames_text(frames)}});
  return {{"what", change.what}, {"values", values}};
}

Json to_json(const SequenceCamera& camera) {
  Json json = {{"widest", camera.widest}, {"narrowest", camera.narrowest}};
  if (!camera.is_placed) return json;
  json["farthest"] = camera.farthest;
  json["largest_turn"] = camera.largest_turn;
  json["largest_step"] = camera.largest_step;
  json["at_largest_step"] = camera.at_largest_step;
  return json;
}

Json to_json(const SequenceDepth& depth) {
  Json json = {{"frame", depth.frame}};
  json.update(to_json(depth.distances));
  return json;
}

Json to_json(const InspectedLight& light) {
  return {{"sum", light.sum}, {"share", light.share}, {"adds_up", light.adds_up}, {"lacking", light.lacking}};
}

Json to_json(const HiddenGuess& guess) { return {{"file", guess.file}, {"channel", guess.channel}}; }

template <class T>
Json to_json(const std::optional<T>& value) {
  return value ? to_json(*value) : Json();
}

template <class T>
Json list_json(const std::vector<T>& values) {
  Json list = Json::array();
  for (const auto& value : values) list.push_back(to_json(value));
  return list;
}

Json to_json(const InspectedSequence& sequence) {
  return {{"shown", sequence.shown},
          {"frames", frames_text(sequence.frames)},
          {"count", sequence.frames.size()},
          {"absent", frames_text(sequence.absent)},
          {"changes", list_json(sequence.changes)},
          {"same", sequence.same},
          {"camera", sequence.camera ? to_json(*sequence.camera) : Json()},
          {"depth", list_json(sequence.depth)}};
}

Json codes_of(const Notes& notes) {
  Json codes = Json::array();
  for (const auto& note : notes) codes.push_back(facts_of(note.code).name);
  return codes;
}

}  // namespace

std::string inspection_json(const Inspection& inspection) {
  Json aovs = Json::object();
  for (const auto& aov : inspection.aovs) aovs[aov.name] = to_json(aov);
  const Json json = {{"files", list_json(inspection.files)},
                     {"source", to_json(inspection.source)},
                     {"aovs", aovs},
                     {"camera", to_json(inspection.camera)},
                     {"depth", to_json(inspection.depth)},
                     {"normals", to_json(inspection.normals)},
                     {"deep", list_json(inspection.deep)},
                     {"light", to_json(inspection.light)},
                     {"guesses", list_json(inspection.guesses)},
                     {"hidden", list_json(inspection.hidden)},
                     {"hidden_options", inspection.hidden_options},
                     {"notes", texts_of(inspection.notes)},
                     {"note_codes", codes_of(inspection.notes)},
                     {"suspicious", texts_of(inspection.suspicious)},
                     {"suspicious_codes", codes_of(inspection.suspicious)},
                     {"missing", inspection.missing},
                     {"refused", inspection.refused},
                     {"sequence", inspection.sequence ? to_json(*inspection.sequence) : Json()},
                     {"command", inspection.command}};
  return json_text(json, 1) + "\n";
}

// The contact sheet.

namespace {

constexpr float kMostSky = 1e29f;  // depth from there on is sky

/// The surfaces' depths that 1 %, 50 % and 99 % of them do not reach; 1 where there is none.
std::array<double, 3> percentiles(std::span<const float> depth) {
  std::vector<float> surfaces;
  std::ranges::copy_if(depth, std::back_inserter(surfaces), [](float z) { return z < kMostSky; });
  if (surfaces.empty()) return {1, 1, 1};
  const auto at = [&](double part) {
    return double(value_at_rank(surfaces, std::size_t(part * double(surfaces.size() - 1))));
  };
  return {at(0.01), at(0.5), at(0.99)};
}

}  // namespace

void write_contact_sheet(const Settings& settings, int number) {
  const std::string& path = settings.output.preview;
  require_ending(path, "--preview", ".png", "PNG");
  require_writable(path, "--preview");
  const HostFrame frame = read_host_frame(settings.input, number);
  gpu::Device device({settings.device.device, settings.device.require_gpu, settings.device.validate});
  gpu::Recorder gpu(device);
  const FrameInputs inputs = upload(gpu, frame);
  EstimatorSettings estimator = settings.estimator;
  if (!estimator.radius) {
    std::vector<float> planar = planar_depths(frame.depth, inputs.depth_map, inputs.view);
    std::ranges::replace_if(
        planar, [](float z) { return std::isinf(z); }, kMostSky);
    estimator.radius = 0.1 * percentiles(planar)[1];
  }
  OutputSettings output;
  output.aovs = "ao,normal,depth";
  const FrameOutputs outputs = run_chain(gpu, inputs, estimator, output);
  gpu.run();

  const auto depth = outputs.depth->as<float>(), normal = outputs.normal->as<float>(), ao = outputs.ao->as<float>();
  const auto [near, median, far] = percentiles(depth);
  const std::size_t width = std::size_t(frame.data.width), pixels = frame.data.pixels();
  std::vector<float> picture(9 * pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    const bool sky = depth[i] >= kMostSky;
    const float bright = far > near ? float(1 - std::log(depth[i] / near) / std::log(far / near)) : 0.5f;
    const std::array<float, 3> panels[] = {
        {bright, bright, bright},
        {0.5f + 0.5f * normal[i], 0.5f + 0.5f * normal[i + pixels], 0.5f + 0.5f * normal[i + 2 * pixels]},
        {ao[i], ao[i], ao[i]}};
    for (std::size_t panel = 0; panel < 3; panel++)
      for (std::size_t c = 0; c < 3; c++)
        picture[3 * (i / width * 3 * width + panel * width + i % width) + c] = sky ? kSkyColor[c] : panels[panel][c];
  }
  write_png(path, 3 * frame.data.width, frame.data.height, 3, picture);
}

}  // namespace alcove
