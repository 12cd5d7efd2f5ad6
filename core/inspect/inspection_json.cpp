// An inspection as one JSON document.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/inspect/inspect.h"

namespace alcove {
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

}  // namespace alcove
