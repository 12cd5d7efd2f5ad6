// The text of all settings that change the result; the ends of files, since a file cut short has a good beginning.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/resume.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <algorithm>
#include <fstream>
#include <optional>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/formats/color.h"
#include "core/formats/exr.h"
#include "core/formats/png.h"
#include "core/frame/matte.h"
#include "core/frame/raw_plane.h"
#include "core/options/options.h"
#include "core/run/frame_files.h"
#include "core/run/shot.h"

namespace alcove {
namespace {

/// What the configuration of the display says; "" for the built-in one.
std::string display_text(const std::string& ocio) {
  const std::string file = display_config_file(ocio);
  if (file.empty()) return "";
  return read_text(file, "OpenColorIO configuration", ocio.empty() ? "the OCIO variable" : "--set ocio");
}

/// The words that tell results of this setting from others; none: its value does not matter.
Words telling_words(const SettingRow& row, const Settings& settings) {
  const Words words = row.words(settings);
  switch (row.effect) {
    case Effect::none: return {};
    case Effect::pixels: return words;
    case Effect::input: return Words(words.size(), "given");
    case Effect::pixels_or_input: return words.empty() || number_of(words.front()) ? words : Words{"given"};
    case Effect::pixels_or_picture: return words.empty() || !names_picture(words.front()) ? words : Words{"given"};
    case Effect::content:
      return words.empty() ? Words{} : Words{read_text(words.front(), row.key().c_str(), row.long_name().c_str())};
    case Effect::display: return shows_composite(settings.output) ? Words{display_text(settings.output.ocio)} : Words{};
  }
  return {};
}

}  // namespace

bool shows_composite(const OutputSettings& output) {
  return !output.preview.empty() && !output.composite.empty() && output.preview_style != "ao";
}

std::string options_digest(const Settings& given) {
  Settings settings = given;
  // The AO is the mean of all scales, in whatever order they were given.
  EstimatorSettings& estimator = settings.estimator;
  for (double& further : estimator.further_radii)
    if (further < *estimator.radius) std::swap(further, *estimator.radius);
  std::ranges::sort(estimator.further_radii);
  // Each word goes with its length, so that no two sets of values make one text.
  std::string text = kVersion;
  for (const auto& row : option_table())
    if (row.is_key())
      for (const auto& word : telling_words(row, settings))
        text += fmt::format("\n{} {} {}", row.key(), word.size(), word);
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

// Files of an earlier run.

namespace {

namespace fs = std::filesystem;

/// Adds the files of manifests that lie beside a file with Cryptomattes of a view. One that cannot be read has none.
void add_manifests(std::vector<std::string>& files, const std::string& path, const std::string& view) {
  try {
    for (const auto& matte : cryptomattes_of(ExrFile(path, "INPUT"), view))
      if (!matte.manifest_file.empty()) files.push_back(matte.manifest_file);
  } catch (const Error&) {
  }
}

std::vector<std::string> inputs_of(const Settings& frame) {
  const InputSettings& input = frame.input;
  std::vector<std::string> files;
  if (!input.motion.empty()) files.push_back(input.motion);
  if (!frame.output.environment.empty()) files.push_back(frame.output.environment);
  for (const auto& file : plane_file_options()) files.push_back(file.of(input));
  if (!input.matte_object.empty())
    add_manifests(files, input.matte.empty() ? main_input(input) : input.matte, input.view);
  if (!input.occluder_objects.empty() || !input.ignored_objects.empty())
    add_manifests(files, input.objects.empty() ? main_input(input) : input.objects, input.view);
  return files;
}

/// What a camera file says; nothing where it cannot be read, since the frame that needs it says so.
std::string camera_text(const std::string& path) {
  try {
    return read_text(path, "camera", "--camera");
  } catch (const Error&) {
    return "";
  }
}

/// The bytes that are looked at of a file's beginning, and as many of its end.
constexpr std::streamoff kLooked = 1 << 16;

std::optional<fs::file_time_type> time_of(const std::string& path) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  return error ? std::nullopt : std::optional(time);
}

}  // namespace

InputIdentities::Identity InputIdentities::identity_of(const Settings& frame) {
  std::string text;
  Identity identity;
  for (const auto& path : inputs_of(frame)) {
    text += '\n';
    if (path.empty()) continue;
    identity.newest = std::max(identity.newest, time_of(path).value_or(identity.newest));
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? std::streamoff(file.tellg()) : 0;
    std::string bytes(std::size_t(std::min(size, 2 * kLooked)), '\0');
    const std::streamoff head = std::min(size, kLooked), tail = std::streamoff(bytes.size()) - head;
    file.seekg(0).read(bytes.data(), head);
    file.seekg(size - tail).read(bytes.data() + head, tail);
    text += fmt::format("{} {:016x}", size, XXH3_64bits(bytes.data(), bytes.size()));
  }
  identity.text = fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
  return identity;
}

InputIdentities::Identity InputIdentities::own(int frame) {
  const std::lock_guard lock(mutex_);
  const auto [found, is_new] = own_.try_emplace(frame);
  if (is_new) found->second = identity_of(plan_.at(frame));
  return found->second;
}

InputIdentities::Identity InputIdentities::all_of(int frame) {
  const InputSettings input = plan_.at(frame).input;
  Identity all = own(frame);
  if (!shot_option(input)) return all;
  if (input.accumulate > 0) all.text += fmt::format("\nturn {}", plan_.turn_of(frame));
  for (const int other : frames_seen_for(plan_, frame)) {
    const Identity identity = own(other);
    all.newest = std::max(all.newest, identity.newest);
    all.text += fmt::format("\n{} {}", other - frame, identity.text);
    if (const std::string camera = plan_.at(other).input.camera; camera != input.camera)
      all.text += camera_text(camera);
  }
  all.text = fmt::format("{:016x}", XXH3_64bits(all.text.data(), all.text.size()));
  return all;
}

namespace {

/// Why an output is made again; "" if it is not there. Nothing if it is whole, no older than the newest input, and made
/// with the options of this digest from inputs of this identity. Reads headers and the table of chunks; never fails.
std::optional<std::string> reason_to_make(const OutputFile& output, const Settings& frame,
                                          const std::string& options_digest, const std::string& inputs,
                                          fs::file_time_type newest_input) {
  const auto time = time_of(output.path);
  if (!time) return "";
  if (*time < newest_input) return "an input is newer than the output";
  const bool is_picture = output.path != frame.output.output && output.path != frame.output.composite;
  if (is_picture) {
    if (is_whole_png(output.path, made_by(options_digest, inputs))) return std::nullopt;
    return fmt::format("{} is cut short, or was made otherwise", output.option);
  }
  const auto attribute = [&](const char* name) { return attribute_of_whole_exr(output.path, name); };
  const auto version = attribute("alcove/version");
  if (!version) return fmt::format("{} is no whole file of Alcove", output.option);
  if (*version != kVersion) return fmt::format("version {} made them", *version);
  if (attribute("alcove/options") != options_digest) {
    const std::string before = attribute("alcove/radius").value_or(""), now = radius_text(frame.estimator);
    return "other settings made them" +
           (before.empty() || before == now ? "" : fmt::format(", with the radius {} and not {}", before, now));
  }
  if (attribute("alcove/inputs") != inputs) return "an input has changed";
  if (fails_on_warnings(frame) && attribute(kNotesAttribute)) return "warnings count as errors, and they have some";
  return std::nullopt;
}

/// The same of the first output of a frame that is made again. `frame` names the files of one frame.
std::optional<std::string> reason_to_compute(const Settings& frame, const std::string& options_digest,
                                             const std::string& inputs, fs::file_time_type newest_input) {
  for (const auto& output : outputs_of(frame.output))
    if (auto reason = reason_to_make(output, frame, options_digest, inputs, newest_input)) return reason;
  return std::nullopt;
}

/// One line for all frames that are computed again.
Notes notes_on_reasons(const std::vector<std::pair<std::string, std::vector<int>>>& reasons) {
  std::vector<std::string> texts;
  for (const auto& [reason, frames] : reasons)
    texts.push_back(fmt::format("{} {}: {}", frames.size() == 1 ? "frame" : "frames", frames_text(frames), reason));
  if (texts.empty()) return {};
  return {{NoteCode::computed_again, fmt::format("--resume computes again {}", fmt::join(texts, "; "))}};
}

}  // namespace

FramesToCompute frames_to_compute(const FramePlan& plan, const std::string& digest, InputIdentities& identities) {
  const FrameSettings& frames = plan.settings().frames;
  if (!frames.resume || frames.overwrite || plan.frames().empty()) return {plan.frames(), {}};
  const Settings first = plan.at(plan.frames().front());
  FramesToCompute found;
  std::vector<std::pair<std::string, std::vector<int>>> reasons;
  for (const int frame : plan.frames()) {
    const Settings of_frame = plan.at(frame);
    const bool has_own_camera = of_frame.input.camera != first.input.camera;
    const auto reason = reason_to_compute(of_frame, has_own_camera ? options_digest(of_frame) : digest,
                                          identities.of(frame), identities.newest(frame));
    if (!reason) continue;
    found.frames.push_back(frame);
    if (reason->empty()) continue;
    const auto known = std::ranges::find(reasons, *reason, [](const auto& one) { return one.first; });
    if (known == reasons.end())
      reasons.push_back({*reason, {frame}});
    else
      known->second.push_back(frame);
  }
  found.notes = notes_on_reasons(reasons);
  return found;
}

}  // namespace alcove
