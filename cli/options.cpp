// `alcove run` as a command, and what its options print by themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"

#include <filesystem>

#include "cli/commands.h"
#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/options/options.h"

namespace alcove {
namespace {

using TypedOptions = std::vector<TypedOption>;

/// The words that were typed for an option; none where it was not typed.
Words words_for(const TypedOptions& typed, const std::string& name) {
  const auto found = std::ranges::find(typed, name, &TypedOption::name);
  return found == typed.end() ? Words{} : found->words;
}

/// Whether a flag was typed, and not as --flag=false.
bool is_on(const TypedOptions& typed, const char* option) {
  const Words words = words_for(typed, option);
  bool is_on = false;
  if (!words.empty()) read_named(option, [&] { is_on = read_switch(words.front()); });
  return is_on;
}

/// The values of --set, setting by setting; of one that repeats each is one more.
std::vector<OptionValue> values_of_sets(const Words& sets) {
  std::vector<OptionValue> values;
  for (const auto& set : sets) {
    const std::size_t equals = std::min(set.find('='), set.size());
    if (equals == 0) fail(ErrorKind::usage, "--set: {} is not KEY=VALUE, such as denoise=none", visible(set));
    const SettingRow& row = row_of_key(lower_case(set.substr(0, equals)));
    if (equals == set.size() && !row.is_flag())
      fail(ErrorKind::usage, "--set: {} is not KEY=VALUE: {} takes {}", set, row.key(), row.value);
    const std::string value = equals == set.size() ? "true" : set.substr(equals + 1);
    const auto earlier = std::ranges::find(values, &row, &OptionValue::row);
    if (earlier == values.end())
      values.push_back({&row, {value}, "", true});
    else if (row.repeats)
      earlier->words.push_back(value);
    else
      fail(ErrorKind::usage, "{} is given more than once", row.long_name());
  }
  return values;
}

/// The project's file, and then the presets.
Words presets_in(const TypedOptions& typed) {
  Words presets;
  if (is_on(typed, "--project")) {
    Words inputs;
    for (const char* option : {"INPUT", "--depth", "--position"})
      std::ranges::copy(words_for(typed, option), std::back_inserter(inputs));
    presets.push_back(project_file(inputs.empty() ? "" : inputs.front()));
  }
  std::ranges::copy(presets_of(words_for(typed, "--preset")), std::back_inserter(presets));
  return presets;
}

/// The values of presets and then of the command line; `files` gets those of the presets.
std::vector<OptionValue> all_values(const TypedOptions& typed, std::vector<std::string>& files) {
  std::vector<OptionValue> values;
  for (const auto& preset : presets_in(typed)) {
    PresetChain chain = read_chain(preset);
    std::ranges::move(chain.values, std::back_inserter(values));
    std::ranges::move(chain.files, std::back_inserter(files));
  }
  for (auto& value : values_of_sets(words_for(typed, "--set"))) {
    if (!words_for(typed, value.row->name).empty())
      fail(ErrorKind::usage, "{} is given more than once", value.row->long_name());
    values.push_back(std::move(value));
  }
  for (const auto& [name, words] : typed) {
    const auto row = std::ranges::find(option_table(), name, &SettingRow::name);
    if (row != option_table().end() && row->is_key()) values.push_back({&*row, words});
  }
  return values;
}

/// The words that give a value, as they are typed.
std::string words_of(const OptionValue& value) {
  const auto& [row, words, preset, by_set] = value;
  std::string text;
  for (const auto& word : words) {
    text += text.empty() ? "" : " ";
    if (by_set || row->is_only_key())
      text += "--set " + for_shell(row->key() + "=" + word);
    else if (row->is_flag())
      text += row->long_name() + (word == "true" ? "" : "=" + word);
    else
      text += row->long_name() + (word.starts_with('-') ? "=" : " ") + for_shell(word);
  }
  return text;
}

/// Whether a run is told otherwise: files that inspect names itself, and its own reports.
bool is_told_otherwise(const OptionValue& value) {
  static const Words kKeys{"frames", "output", "preview"};
  return !value.is_typed() || value.row->group == "Reports" ||
         std::ranges::find(kKeys, value.row->key()) != kKeys.end();
}

/// What was typed for the run that inspect proposes: all that has an effect there.
std::vector<ProposedOption> proposed_options(const TypedOptions& typed, const RunOptions& options) {
  const Settings& settings = options.settings;
  std::vector<OptionValue> values = options.values, of_presets;
  std::ranges::copy_if(values, std::back_inserter(of_presets), std::not_fn(&OptionValue::is_typed));
  std::erase_if(values, is_told_otherwise);
  const Settings initial = with_values({}, of_presets, Reader::inspect);
  const auto is_idle = [&](const OptionValue& one) {
    Settings all = initial;
    all.input.input = settings.input.input;
    for (const auto& value : values) value.row->read(all, value.words);
    if (!all.input.beauty.empty() || !all.input.beauty_channels.empty()) all.output.composite = "composite";
    return !objection(*one.row, all).empty();
  };
  while (true) {  // what has no effect may have been another's reason
    const auto idle = std::ranges::find_if(values, is_idle);
    if (idle == values.end()) break;
    values.erase(idle);
  }
  std::vector<ProposedOption> proposed;
  if (is_on(typed, "--project")) proposed.push_back({"--project", "--project"});
  for (const auto& preset : words_for(typed, "--preset"))
    proposed.push_back({"--preset " + for_shell(preset), "--preset " + for_shell(preset)});
  for (const auto& value : values) proposed.push_back({value.row->long_name(), words_of(value)});
  return proposed;
}

}  // namespace

std::string usual_output(const std::string& input, const std::string& stem, const std::string& ending) {
  const auto pattern = frame_pattern(input);
  const std::size_t token = pattern ? pattern->before.size() : 0;
  const std::string number = pattern ? "." + input.substr(token, input.size() - token - pattern->after.size()) : "",
                    name = stem + number + ending;
  return name == std::filesystem::path(input).filename() ? "new-" + name : name;
}

namespace {

constexpr const char* kRun =
    "Computes ambient occlusion from the depth and normals of a rendered frame.\n\n"
    "Examples:\n"
    "  alcove run frame.exr -o ao.exr --camera camera.json --radius 0.5\n"
    "  alcove run frame.%04d.exr -o ao.%04d.exr --frames 1001-1100 --camera camera.json --radius 0.5 --resume\n"
    "  alcove run frame.exr --beauty beauty.exr -o ao.exr --composite out.exr --fov 60 --radius 0.5 --preset "
    "production\n";

constexpr const char* kInspect =
    "Says what a frame's files hold, which channels would be used and how they would be understood, with the "
    "evidence,\nwhat is suspicious or missing, and the command that would run it. Of a sequence (shot.####.exr, with "
    "or "
    "without\n--frames) also what changes along it, by all headers and the pixels of a few frames. All options of "
    "alcove run are\ntaken; these say what would otherwise be guessed.\n\n"
    "Examples:\n"
    "  alcove inspect frame.exr\n"
    "  alcove inspect frame.exr --camera camera.json --preview sheet.png\n"
    "  alcove inspect frame.%04d.exr --json\n";

}  // namespace

Command run_syntax() {
  Command command{"alcove run", kRun, {}};
  command.rows.push_back(file_rows().front());
  std::ranges::copy_if(option_table(), std::back_inserter(command.rows), std::not_fn(&OptionRow::is_only_key));
  return command;
}

namespace {

/// Whether inspect looks at an option of run.
bool is_inspected(const OptionRow& row) {
  static const Words kOthers{"--frames", "--preset", "--set", "--radius", "--device", "--preview"};
  return row.group == "Input" || row.group == "Hidden surfaces" ||
         std::ranges::find(kOthers, row.name) != kOthers.end();
}

/// All options of run, of which those are common that inspect looks at, and its own.
Command inspect_syntax() {
  Command command = run_syntax();
  command.name = "alcove inspect";
  command.description = kInspect;
  for (auto& row : command.rows) {
    row.is_common = is_inspected(row);
    if (row.role != FileRole::input) row.role = row.name == "--preview" ? FileRole::report : FileRole::none;
    if (row.long_name() != "--verbose") continue;
    row.is_common = true;
    row.sentence = "also print attributes, statistics and the score of each reading";
  }
  command.rows.push_back({.group = "Reports", .name = "--json", .sentence = "print JSON", .is_common = true});
  command.rows.push_back({.group = "Reports",
                          .name = "--write-camera",
                          .value = "FILE.json",
                          .sentence = "the camera that is found, for --camera; of a sequence with that of each frame",
                          .is_common = true,
                          .role = FileRole::report});
  return command;
}

}  // namespace

void refuse_keys(const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); i++) {
    const std::string& argument = arguments[i];
    const std::size_t equals = std::min(argument.find('='), argument.size());
    const auto row = std::ranges::find_if(option_table(), [&](const OptionRow& one) {
      return one.is_only_key() && argument.substr(0, equals) == "--" + one.name;
    });
    if (row == option_table().end()) continue;
    const bool has_next = i + 1 < arguments.size() && !arguments[i + 1].starts_with("--");
    const std::string value = equals < argument.size() ? argument.substr(equals + 1)
                              : row->is_flag()         ? "true"
                              : has_next               ? arguments[i + 1]
                                                       : "VALUE";
    fail(ErrorKind::usage, "--{} is a setting: write --set {}", row->name, for_shell(row->name + "=" + value));
  }
}

namespace {

/// Prints the settings as a preset, whose files have whole paths.
void print_preset(const Settings& settings) {
  for (const auto& row : option_table())
    if (row.is_key())
      for (const auto& word : row.words(settings))
        if (row.names_file(word)) refuse_token_of_folder(row, word, std::filesystem::current_path().string());
  fmt::print("{}", preset_text(settings));
}

/// Reads the command line; nothing where it asks for what is only printed.
std::optional<TypedOptions> read_arguments(const Command& command, const std::vector<std::string>& arguments,
                                           RunOptions& options, Reader reader) {
  refuse_keys(arguments);
  auto typed = typed_options(command, arguments);
  if (!typed) return std::nullopt;
  if (const Words input = words_for(*typed, "INPUT"); !input.empty()) options.settings.input.input = input.front();
  bool prints_config = false;
  with_help(command, [&] {
    options.values = all_values(*typed, options.settings.preset_files);
    options.settings = with_values(options.settings, options.values, reader);
    options.dry_run = is_on(*typed, "--dry-run");
    prints_config = is_on(*typed, "--print-config");
    if (is_on(*typed, "--shareable") && !prints_config)
      fail(ErrorKind::usage, "--shareable has no effect without --print-config");
  });
  if (!prints_config) return typed;
  const Settings whole = with_idle_values(options.settings, options.values);
  if (is_on(*typed, "--shareable"))
    fmt::print("{}", shareable_text(whole));
  else
    print_preset(whole);
  return std::nullopt;
}

}  // namespace

Command describe_run() { return run_syntax(); }

/// Only what inspect looks at.
Command describe_inspect() {
  Command command = inspect_syntax();
  std::erase_if(command.rows, [](const OptionRow& row) { return row.name.starts_with('-') && !row.is_common; });
  return command;
}

bool parse_run_options(const std::vector<std::string>& arguments, RunOptions& options) {
  if (arguments == std::vector<std::string>{"--help-markdown"}) {
    fmt::print("{}", option_table_markdown());
    return false;
  }
  return read_arguments(run_syntax(), arguments, options, Reader::run).has_value();
}

bool parse_inspect_options(const std::vector<std::string>& arguments, InspectOptions& options) {
  const Command command = inspect_syntax();
  const auto typed = read_arguments(command, arguments, options.run, Reader::inspect);
  if (!typed) return false;
  with_help(command, [&] { options.json = is_on(*typed, "--json"); });
  options.typed = proposed_options(*typed, options.run);
  const Words path = words_for(*typed, "--write-camera");
  if (!path.empty()) options.write_camera = path.front();
  return true;
}

}  // namespace alcove
