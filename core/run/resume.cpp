// The text of all settings that change the result; the ends of files, since a file cut short has a good beginning.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/resume.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/base/text.h"
#include "core/base/version.h"
#include "core/formats/exr.h"
#include "core/formats/png.h"
#include "core/options/options.h"
#include "core/run/frame_files.h"
#include "core/run/run_files.h"

namespace alcove {
namespace {

/// The words that tell results of this setting from others; none: its value does not matter. Of a file counts only that
/// it is given.
Words telling_words(const SettingRow& row, const Settings& settings) {
  if (row.effect == Effect::none) return {};
  Words words = row.words(settings);
  const auto is_input = [&](const std::string& word) { return row.role == FileRole::input && row.names_file(word); };
  std::ranges::replace_if(words, is_input, "given");
  return words;
}

}  // namespace

std::string options_digest(const Settings& given) {
  Settings settings = given;
  // The AO is the mean of all scales, in whatever order they were given.
  EstimatorSettings& estimator = settings.estimator;
  for (double& further : estimator.further_radii)
    if (further < *estimator.radius) std::swap(further, *estimator.radius);
  std::ranges::sort(estimator.further_radii);
  // Each word goes with its length, so that no two sets of values make one text.
  std::string text = kVersion;
  if (shows_composite(settings.output)) text += "\na preview of the composite";
  for (const auto& row : option_table())
    if (row.is_key())
      for (const auto& word : telling_words(row, settings))
        text += fmt::format("\n{} {} {}", row.key(), word.size(), word);
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

// Files of an earlier run.

namespace {

namespace fs = std::filesystem;

/// The bytes that are looked at of the beginning of a picture, and as many of its end.
constexpr std::streamoff kLooked = 1 << 16;

/// Other files are looked at whole up to this size: no part of a camera file tells of a change in another one.
constexpr std::streamoff kMostWhole = 1 << 24;

std::string bytes_of(std::ifstream& file, std::streamoff begin, std::streamoff end) {
  std::string bytes(std::size_t(end - begin), '\0');
  file.seekg(begin).read(bytes.data(), end - begin);
  return bytes;
}

std::optional<fs::file_time_type> time_of(const std::string& path) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  return error ? std::nullopt : std::optional(time);
}

}  // namespace

InputIdentities::Identity InputIdentities::identity_of(const Settings& frame) {
  std::string text;
  Identity identity;
  for (const auto& [option, path] : inputs_of(frame)) {
    if (option == "--preset") continue;  // what it says is in the settings
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? std::streamoff(file.tellg()) : 0;
    std::string bytes = bytes_of(file, 0, std::min(size, kLooked));
    const bool is_whole = size <= kMostWhole && !bytes.starts_with("\x76\x2f\x31\x01");  // how EXR files begin
    const std::streamoff beyond = std::streamoff(bytes.size());
    bytes += bytes_of(file, is_whole ? beyond : std::max(beyond, size - kLooked), size);
    text += fmt::format("\n{} {:016x}", size, XXH3_64bits(bytes.data(), bytes.size()));
    if (!is_whole) identity.newest = std::max(identity.newest, time_of(path).value_or(identity.newest));
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
  const InputSettings& input = plan_.settings().input;
  Identity all = own(frame);
  if (!shot_option(input)) return all;
  if (input.accumulate > 0) all.text += fmt::format("\nturn {}", plan_.slot_of(frame));
  for (const int other : frames_seen_for(plan_, frame)) {
    const Identity identity = own(other);
    all.newest = std::max(all.newest, identity.newest);
    all.text += fmt::format("\n{} {}", other - frame, identity.text);
  }
  all.text = fmt::format("{:016x}", XXH3_64bits(all.text.data(), all.text.size()));
  return all;
}

namespace {

/// Whether the codes of all warnings in a header are among these, which are separated by commas.
bool are_allowed(const std::string& header_notes, const std::string& codes) {
  const auto allowed = split(codes);
  std::istringstream lines(header_notes);
  for (std::string line; std::getline(lines, line);)
    if (std::ranges::find(allowed, line.substr(0, line.find(':'))) == allowed.end()) return false;
  return true;
}

/// Why an output is made again; "" if it is not there. Nothing if it is whole, no older than the newest input, and made
/// with the options of this digest from inputs of this identity. Reads headers and the table of chunks; never fails.
std::optional<std::string> reason_to_make(const NamedFile& output, const Settings& frame,
                                          const std::string& options_digest, const std::string& inputs,
                                          fs::file_time_type newest_input) {
  const auto time = time_of(output.path);
  if (!time) return "";
  if (*time < newest_input) return "an input is newer than the output";
  const bool is_picture = output.path != frame.output.output && output.path != frame.output.composite;
  if (is_picture) {
    if (is_whole_png(output.path, made_by(options_digest, inputs))) return std::nullopt;
    return fmt::format("{} is cut short, or made with other settings", output.option);
  }
  const auto attribute = [&](const char* name) { return attribute_of_whole_exr(output.path, name); };
  const auto version = attribute("alcove/version");
  if (!version) return fmt::format("{} is no whole file of Alcove", output.option);
  if (*version != kVersion) return fmt::format("version {} made them", *version);
  if (attribute("alcove/options") != options_digest) {
    const std::string before = attribute("alcove/radius").value_or(""), now = radius_text(frame.estimator);
    return "other settings made them" +
           (before.empty() || before == now ? "" : fmt::format(", with the radius {}, not {}", before, now));
  }
  if (attribute("alcove/inputs") != inputs) return "an input has changed";
  if (fails_on_warnings(frame) && !are_allowed(attribute(kNotesAttribute).value_or(""), frame.input.allow))
    return "warnings count as errors, and these frames have some";
  return std::nullopt;
}

/// The same of the first output of a frame that is made again. `frame` names the files of one frame.
std::optional<std::string> reason_to_compute(const Settings& frame, const std::string& options_digest,
                                             const std::string& inputs, fs::file_time_type newest_input) {
  for (const auto& output : files_of(frame, FileRole::output))
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
  FramesToCompute found;
  std::vector<std::pair<std::string, std::vector<int>>> reasons;
  for (const int frame : plan.frames()) {
    const auto reason = reason_to_compute(plan.at(frame), digest, identities.of(frame), identities.newest(frame));
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
