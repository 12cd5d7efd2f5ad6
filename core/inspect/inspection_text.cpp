// An inspection as lines for people.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/inspect/inspect.h"

namespace alcove {

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

/// TextLines that a terminal may show.
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

void add(TextLines& lines, const InspectedAov& aov) {
  lines.add("{}: {}{}", aov.name, fmt::join(aov.channels, ", "), aov.is_chosen ? ", named by an option" : "");
}

/// The channels of an AOV; "" where there is none.
std::string channels_of(const Inspection& inspection, std::initializer_list<std::string_view> names) {
  for (const auto& aov : inspection.aovs)
    if (std::ranges::find(names, aov.name) != names.end())
      return fmt::format(", {}{}", fmt::join(aov.channels, ", "), aov.is_chosen ? ", named by an option" : "");
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
  lines.add("sequence: {} frames, {}; shown is frame {}", sequence.frames.size(), frames_text(sequence.frames),
            sequence.shown);
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
    if (!is_said) add(lines, aov);
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

}  // namespace alcove
