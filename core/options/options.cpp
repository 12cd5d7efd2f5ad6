// The table of all options, and what is written from it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {
namespace {

/// Reads I/N of --chunk.
bool read_chunk(const std::string& text, FrameSettings& frames) {
  const std::size_t slash = text.find('/');
  if (slash == text.npos) return false;
  const auto chunk = whole_number_of(text.substr(0, slash));
  const auto chunks = whole_number_of(text.substr(slash + 1));
  if (!chunk || !chunks || *chunk < 1 || *chunk > *chunks) return false;
  frames.chunk = *chunk;
  frames.chunks = *chunks;
  return true;
}

constexpr std::string_view kUnits = "kmgt";  // powers of 1024
constexpr double kMostMemory = 1e18;         // bytes: more than any machine has, and what 64 bits can hold

/// Reads the size of --memory: "512M", "4G", "1.5GiB", "100000".
bool read_memory(const std::string& text, std::uint64_t& bytes) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789."), text.size());
  std::string unit = lower_case(text.substr(end));
  if (unit.ends_with("b")) unit.pop_back();
  if (unit.ends_with("i")) unit.pop_back();
  const std::size_t power = unit.empty() ? 0 : kUnits.find(unit) + 1;
  const auto number = number_of(text.substr(0, end));
  const bool has_known_unit = unit.empty() || (unit.size() == 1 && power > 0);
  if (!has_known_unit || !number) return false;
  const double size = *number * double(1ull << (10 * power));
  if (!(size >= 1) || size > kMostMemory) return false;
  bytes = std::uint64_t(size);
  return true;
}

/// Writes the size in the largest unit of which it is a whole number.
std::string text_of_memory(std::uint64_t bytes) {
  if (bytes == 0) return "";
  std::size_t power = 0;
  while (power < kUnits.size() && bytes % 1024 == 0) {
    bytes /= 1024;
    power++;
  }
  return power ? fmt::format("{}{}", bytes, char(kUnits[power - 1] - 'a' + 'A')) : fmt::format("{}", bytes);
}

void add_frame_rows(std::vector<SettingRow>& rows) {
  using S = FrameSettings;
  OptionGroup frames(rows, "Frames", Effect::none, &Settings::frames);
  frames.text("--frames", &S::frames, "LIST", "frames such as 1001-1100x2,1200; else the files of INPUT on the disk")
      .is_common = true;
  frames.number("output-offset", &S::output_offset, "frames", between(-1e9, 1e9), "output number less input number");
  frames.own(
      {"--chunk", "I/N", "", "I from 1 to N", "compute only this part of the frames"},
      [](const S& s) { return s.chunks > 1 ? fmt::format("{}/{}", s.chunk, s.chunks) : std::string(); },
      [](S& s, const std::string& text) { return read_chunk(text, s); }, "is not I/N, with I from 1 to N");
  frames.choice("missing", &S::missing, "frames without their input; error: before any work; skip: left out");
  frames.flag("--keep-going", &S::keep_going, "go on after a failed frame");
  frames.flag("warnings-as-errors", &S::warnings_as_errors,
              "fail frames with a warning before their outputs are written");
  frames.flag("--resume", &S::resume, "compute only frames with missing, broken or old outputs").is_common = true;
  frames.flag("overwrite", &S::overwrite, "compute all frames, whatever --resume says");
  frames.show({"--dry-run", "", "", "", "print frames, files and memory, and stop"});
}

void add_device_rows(std::vector<SettingRow>& rows) {
  using S = DeviceSettings;
  OptionGroup device(rows, "Device", Effect::none, &Settings::device, true);
  OptionGroup process(rows, "Device", Effect::none, &Settings::device);
  device.text("--device", &S::device, "auto|cpu|INDEX|NAME|UUID",
              "where to compute; auto: the first GPU, else the CPU");
  device.flag("require-gpu", &S::require_gpu, "computing on the CPU is an error");
  device.flag("--validate", &S::validate, "load the Vulkan validation layer; any message is an error");
  process.own(
      {"--memory", "SIZE", "bytes, or with K, M, G", "", "memory of the whole process; else half of the free memory"},
      [](const S& s) { return text_of_memory(s.memory); },
      [](S& s, const std::string& text) { return read_memory(text, s.memory); }, "is no size such as 512M or 4G");
  process.number("--threads", &S::threads, "", between(0, 1024),
                 "threads of the CPU device and of codecs; 0: one per core");
}

void add_report_rows(std::vector<SettingRow>& rows) {
  OptionGroup files(rows, "Reports", Effect::none, &Settings::output);
  OptionGroup progress(rows, "Reports", Effect::none, &Settings::progress);
  static const char* const kWhy = "one asks for lines, the other for none";
  const auto shows_lines = [](const Settings& all) {
    return all.progress.kind == "bar" || all.progress.kind == "plain";
  };
  files.text("--stats", &OutputSettings::stats, "FILE.json", "times of every pass, counts and totals")
      .names(FileRole::report);
  progress
      .word("--progress", &ProgressSettings::kind, {"auto", "bar", "plain", "percent", "openjd", "none"},
            "plain: one line per frame; percent, openjd: on standard output, for farms")
      .idle([=](const Settings& all) { return if_given(shows_lines(all) && all.progress.quiet, "--quiet", kWhy); });
  files.text("--log-json", &OutputSettings::log_json, "FILE|-", "one JSON object per line for every event")
      .names(FileRole::report, [](const std::string& text) { return text != "-"; });
  progress.flag("-v,--verbose", &ProgressSettings::verbose, "print more: the time of every pass");
  progress.flag("-q,--quiet", &ProgressSettings::quiet, "print nothing but errors").idle([=](const Settings& all) {
    return if_given(shows_lines(all), "--progress", kWhy);
  });
  progress.show({"--print-config", "", "", "", "print the settings as a preset and stop"});
  progress.show({"--shareable", "", "", "",
                 "with --print-config: changed settings alone, without files, frames, camera and device"});
}

bool is_control(char c) { return (unsigned char)c < 0x20 || c == 0x7f; }

/// Quotes a text for TOML. A text that would have to be escaped within double quotes is put within single ones, where
/// it stays as it is.
std::string toml_text(const std::string& word) {
  const bool has_special = word.find_first_of("\"\\") != word.npos;
  const bool fits_single = word.find('\'') == word.npos && std::ranges::none_of(word, is_control);
  if (has_special && fits_single) return "'" + word + "'";
  std::string text;
  for (const char c : word) {
    if (c == '"' || c == '\\') text += '\\';
    text += is_control(c) ? fmt::format("\\u{:04x}", int(c)) : std::string(1, c);
  }
  return '"' + text + '"';
}

/// Writes a value in TOML: numbers and true as they are, anything else as a text.
std::string toml_of(const std::string& word) {
  const auto number = number_of(word);
  return word == "true" || (number && fmt::format("{}", *number) == word) ? word : toml_text(word);
}

}  // namespace

const std::vector<SettingRow>& option_table() {
  static const std::vector<SettingRow> kTable = [] {
    std::vector<SettingRow> rows;
    add_input_rows(rows);
    add_hidden_rows(rows);
    add_frame_rows(rows);
    add_estimator_rows(rows);
    add_output_rows(rows);
    add_device_rows(rows);
    add_report_rows(rows);
    return rows;
  }();
  return kTable;
}

const std::vector<SettingRow>& file_rows() {
  static const std::vector<SettingRow> kRows = [] {
    std::vector<SettingRow> rows;
    OptionGroup(rows, "", Effect::pixels, &Settings::input)
        .text("INPUT", &InputSettings::input, "",
              "an EXR file with depth and normals, or a pattern such as frame.%04d.exr")
        .names(FileRole::input);
    std::ranges::copy_if(option_table(), std::back_inserter(rows),
                         [](const SettingRow& row) { return row.role != FileRole::none; });
    return rows;
  }();
  return kRows;
}

std::vector<NamedFile> files_of(const Settings& settings, FileRole role) {
  return files_of(file_rows(), settings, role);
}

const SettingRow& row_of_key(const std::string& key) {
  const auto row = std::ranges::find(option_table(), key, &SettingRow::key);
  if (row == option_table().end()) {
    std::vector<std::string> keys;
    for (const auto& other : option_table())
      if (other.is_key()) keys.push_back(other.key());
    fail(ErrorKind::usage, "there is no setting {}{}; alcove run --help-markdown lists all", key,
         suggestion(key, keys));
  }
  if (key == "preset")
    fail(ErrorKind::usage,
         "preset is an option of the command line only: give both presets there (--preset A --preset B; the last one "
         "wins)");
  if (!row->is_key()) fail(ErrorKind::usage, "{} is an option of the command line only", key);
  return *row;
}

const std::vector<Rivals>& rivals() {
  static const char* const kCamera = "each sets the lens";
  static const std::vector<Rivals> kRivals{
      {{"depth"}, {"position"}, "both give the distance of surfaces"},
      {{"depth-channel"}, {"position", "position-channels"}, "depth is read from one of them"},
      {{"camera"}, {"fov", "vertical-fov", "focal-px", "focal", "aperture", "ortho-width"}, kCamera},
      {{"fov"}, {"vertical-fov", "focal-px", "focal", "aperture", "ortho-width"}, kCamera},
      {{"vertical-fov"}, {"focal-px", "focal", "aperture", "ortho-width"}, kCamera},
      {{"focal-px"}, {"focal", "aperture", "ortho-width"}, kCamera},
      {{"focal", "aperture"}, {"ortho-width"}, kCamera},
      {{"occluders"}, {"ignore"}, "each says what blocks"},
      {{"occluders", "ignore"}, {"around", "other-views"}, "other frames and views may show the object itself"},
      {{"tolerance"}, {"resolution"}, "the error is per pixel at --resolution full"},
      {{"tolerance"}, {"accumulate"}, "each sets the AO's accuracy"},
      {{"denoise-kernel"}, {"denoise-radius"}, "the number of weights sets the radius"},
      {{"quiet"}, {"verbose"}, "one asks for lines, the other for none"}};
  return kRivals;
}

std::string objection(const SettingRow& row, const Settings& settings) {
  const bool is_given = row.is_given(settings);
  if (row.words(settings).empty() || (row.usual_asks_nothing && !is_given)) return "";
  std::string why;
  const auto look_for = [&](const Words& own, const Words& others, const char* reason) {
    if (!why.empty() || !is_given || std::ranges::find(own, row.key()) == own.end()) return;
    for (const auto& key : others)
      if (const SettingRow& other = row_of_key(key); why.empty() && other.is_given(settings))
        why = if_given(true, other.long_name(), reason);
  };
  for (const auto& [one, other, reason] : rivals()) {
    look_for(one, other, reason);
    look_for(other, one, reason);
  }
  for (const auto& reason : row.idle_reasons)
    if (why.empty()) why = reason(settings);
  return why.empty() ? "" : fmt::format("{} has no effect: {}", row.long_name(), why);
}

std::string range_text(const OptionRow& row) {
  return row.unit + (row.unit.empty() || row.range.empty() ? "" : ", ") + row.range;
}

std::string option_table_markdown() {
  std::string text;
  for (const bool shows_keys : {false, true}) {
    text += shows_keys ? "\n## Other settings\n\nOf presets, and of `--set KEY=VALUE`.\n" : "";
    std::string group;
    for (const auto& row : option_table()) {
      if (row.is_only_key() != shows_keys) continue;
      if (row.group != group) text += fmt::format("\n### {}\n\n", row.group);
      group = row.group;
      const std::string value = row.value.empty() && shows_keys ? "true" : row.value;
      std::string limits = range_text(row);
      if (!row.default_text.empty()) limits += (limits.empty() ? "" : "; ") + ("default " + row.default_text);
      text += fmt::format("- `{}`{}{}: {}\n", row.name, value.empty() ? "" : " `" + value + "`",
                          limits.empty() ? "" : " (" + limits + ")", row.sentence);
    }
  }
  return text.substr(1);
}

namespace {

/// Whether a setting is as good for other frames: no file, no frame, no camera, and nothing of this machine.
bool is_shareable(const SettingRow& row) {
  static const Words kCamera{"near",  "far",      "fov",         "vertical-fov", "focal-px",
                             "focal", "aperture", "ortho-width", "roi"};
  return row.role == FileRole::none && row.group != "Frames" && row.group != "Device" &&
         std::ranges::find(kCamera, row.key()) == kCamera.end();
}

}  // namespace

namespace {

/// The value of a row as a line of a preset. Files have whole paths, since a preset may lie anywhere.
std::string preset_line(const SettingRow& row, const Settings& settings) {
  Words words = row.words(settings);
  for (auto& word : words)
    word = toml_of(row.names_file(word) && !is_on_share(word) ? std::filesystem::absolute(word).string() : word);
  const std::string list = fmt::format("{}", fmt::join(words, ", "));
  return fmt::format("{}={}\n", row.key(), words.size() > 1 ? "[" + list + "]" : list);
}

bool has_effect(const SettingRow& row, const Settings& settings) {
  return std::ranges::all_of(row.idle_reasons, [&](const auto& reason) { return reason(settings).empty(); });
}

}  // namespace

std::string preset_text(const Settings& settings) {
  std::string text;
  for (const auto& row : option_table())
    if (row.is_key() && !row.words(settings).empty() && (row.is_given(settings) || has_effect(row, settings)))
      text += preset_line(row, settings);
  return text;
}

std::string shareable_text(const Settings& settings) {
  std::string text;
  for (const auto& row : option_table())
    if (row.is_key() && is_shareable(row) && row.is_given(settings)) text += preset_line(row, settings);
  return text;
}

}  // namespace alcove
