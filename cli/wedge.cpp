// `alcove wedge INPUT --radius A,B,C -o PAGE.html`: a frame in many looks, and the command of each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/wedge/wedge.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/frame/find/lights.h"
#include "core/frame/raw_plane.h"
#include "core/run/run_files.h"
#include "core/run/run_preview.h"

namespace alcove {
namespace {

constexpr std::size_t kMostPictures = 64;
/// Options of run that a wedge has, beside those of groups of its own.
const Words kOthers{"--frames", "--lights", "--device", "--memory", "-q,--quiet"};
/// Those that no look has.
const Words kOwn{"-o,--output", "--sheet", "-q,--quiet", "--dry-run"};

bool has(const Words& words, const std::string& word) { return std::ranges::find(words, word) != words.end(); }

constexpr const char* kWedge =
    "Shows a frame in many looks: one for each radius, and for each value of every other list. The page has all looks "
    "to\nwipe and flip between, and the command that makes each. The radius that inspect proposes is one of them. Of a "
    "sequence\nit shows the middle frame, or --frames; with one look all frames. Input options are those of run.\n\n"
    "Examples:\n"
    "  alcove wedge frame.exr --camera camera.json -o looks.html\n"
    "  alcove wedge frame.exr --camera camera.json --radius .1,.2,.5,1 --preset draft,production --sheet looks.png\n"
    "  alcove wedge frame.exr --camera camera.json --radius .5 --set intensity=.8,1,1.3 -o looks.html\n"
    "  alcove wedge frame.exr --camera camera.json --radius .5 --lights sun.json --set sun-azimuth=0,90,180 -o "
    "suns.html\n";

/// The options of run that say how a frame is read and estimated, and its own.
Command wedge_syntax() {
  Command command = run_syntax();
  command.name = "alcove wedge";
  command.description = kWedge;
  static const Words kGroups{"", "Input", "Hidden surfaces", "Estimator"};
  std::erase_if(command.rows, [](const OptionRow& row) {
    return !has(kGroups, row.group) && !has(kOthers, row.name) && row.name != "--dry-run";
  });
  for (auto& row : command.rows) {
    if (row.name == "--frames") row.sentence = "such as 1001,1050; else the middle one of INPUT on the disk";
    if (row.name == "--dry-run") row.sentence = "print frames, looks, memory and cost, and stop";
    if (row.name == "--lights")
      row.sentence = "a sun of it is the picture where --set sun-azimuth or sun-elevation turns it";
    if (row.name == "--preset") row.sentence = "settings from presets, a look for each of a list";
    if (row.name == "--set") row.value = "KEY=VALUE[,VALUE...]";
    if (row.name == "--radius")
      row.sentence = "how far occluders reach, a look for each; else half, once and twice what inspect proposes";
  }
  const auto add = [&](const char* name, const char* value, const char* sentence) {
    command.rows.push_back({.group = "Output",
                            .name = name,
                            .value = value,
                            .sentence = sentence,
                            .is_common = true,
                            .role = FileRole::report});
  };
  add("-o,--output", "FILE.html", "a self-contained page with all looks");
  add("--sheet", "FILE.png", "all looks in one labelled picture");
  return command;
}

// Looks: one value of each list.

/// What was typed for run: arguments, and of a list all its values; and the wedge's own options.
struct Typed {
  std::vector<Words> arguments;
  std::string input, page, sheet;
  bool is_quiet = false, is_dry = false;
  std::string no_composite = {};  // why there is none; "" where there may be one
};

/// Whether a setting says how the frame is read, which all looks share.
bool is_shared(const OptionRow& row) {
  return row.group == "Input" || row.group == "Hidden surfaces" || (has(kOthers, row.name) && row.name != "--lights");
}

/// The values of a list. A setting that takes a list itself has one value, but for radii and presets.
Words values_in(const SettingRow& row, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (row.name == "--set" && (equals == 0 || equals == text.npos)) return {text};
  if (row.name == "--set") {
    Words values = values_in(row_of_key(lower_case(text.substr(0, equals))), text.substr(equals + 1));
    for (auto& value : values) value = text.substr(0, equals + 1) + value;
    return values;
  }
  const bool takes_list = row.value.find(',') != text.npos && row.name != "--radius" && row.name != "--preset";
  if (is_shared(row) || takes_list) return {text};
  Words values = split(text);
  if (has(values, "")) fail(ErrorKind::usage, "{} {}: a value of the list is empty", row.long_name(), visible(text));
  return values;
}

std::vector<Words> arguments_in(const std::vector<TypedOption>& typed) {
  std::vector<Words> arguments;
  for (const auto& [name, words] : typed) {
    const auto row = std::ranges::find(option_table(), name, &SettingRow::name);
    for (const auto& word : words) {
      const bool is_radius = name == "--set" && lower_case(word).starts_with("radius=");
      if (row == option_table().end())
        arguments.push_back({word});
      else if (row->is_flag())
        arguments.push_back({name + "=" + word});
      else if (is_radius)
        arguments.insert(arguments.end(), {{"--radius"}, split(word.substr(word.find('=') + 1))});
      else
        arguments.insert(arguments.end(), {{name}, values_in(*row, word)});
    }
  }
  return arguments;
}

std::size_t count_of(const std::vector<Words>& arguments) {
  std::size_t count = 1;
  for (const auto& values : arguments) count *= values.size();
  return count;
}

/// A file's name without the folder in which all of the list lie.
std::string without_shared_folder(const Words& files, const std::string& file) {
  const std::string folder = folder_prefix(file);
  const bool is_shared = std::ranges::all_of(files, [&](const auto& other) { return folder_prefix(other) == folder; });
  return is_shared ? file.substr(folder.size()) : file;
}

/// The value of each list for the look of that number: the values of the last list change fastest.
Words values_of(const std::vector<Words>& arguments, std::size_t number) {
  Words values;
  std::size_t rest = count_of(arguments);
  for (const auto& list : arguments) {
    rest /= list.size();
    values.push_back(list[number / rest % list.size()]);
  }
  return values;
}

/// The name of a look: the values of lists, and of a single look its radius.
std::string name_of(const std::vector<Words>& arguments, const Words& values) {
  Words parts;
  for (std::size_t i = 0; i < arguments.size(); i++) {
    if (arguments[i].size() == 1 && !(parts.empty() && i + 1 == arguments.size())) continue;
    const std::string option = i > 0 ? arguments[i - 1].front() : "";
    const bool is_named = option != "--preset" && option != "--set" && option.size() > 2;
    parts.push_back((is_named ? option.substr(2) + " " : "") +
                    (option == "--preset" ? without_shared_folder(arguments[i], values[i]) : values[i]));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// The same as words of a command line: a value that begins as an option does is joined to its own.
Words words_of_values(const Words& values) {
  Words words;
  for (const auto& value : values) {
    // A flag holds its value already.
    const bool follows_option =
        !words.empty() && words.back().starts_with("--") && words.back().find('=') == words.back().npos;
    if (value.starts_with('-') && follows_option)
      words.back() += "=" + value;
    else
      words.push_back(value);
  }
  return words;
}

/// The look of that number. The last argument is the radius.
WedgeLook look_of(const Typed& typed, const std::vector<Words>& arguments, std::size_t number) {
  const Words values = values_of(arguments, number);
  Words words;
  const auto settings_with = [&](const char* file, const Words& aovs, bool has_composite) {
    words = words_of_values(values);
    words.insert(words.end(), {"-o", usual_output(typed.input, file, ".exr")});
    words.insert(words.end(), aovs.begin(), aovs.end());
    if (has_composite) words.insert(words.end(), {"--composite", usual_output(typed.input, "composite", ".exr")});
    words.insert(words.end(), {"--preview", usual_output(typed.input, "preview", ".png")});
    RunOptions options;
    (void)parse_run_options(words, options);
    return options.settings;
  };
  Settings settings = settings_with("ao", {}, typed.no_composite.empty());
  if (turns_sun(settings.estimator)) {
    const bool is_dimmed = typed.no_composite.empty() && !settings.input.shadow_layers.empty();
    settings = settings_with("shadow", {"--aov", "shadow"}, is_dimmed);
  }
  for (auto& word : words) word = for_shell(word);
  return {name_of(arguments, values), fmt::format("alcove run {}", fmt::join(words, " ")), settings};
}

/// The radii that were typed, or half and twice the proposed one; and that.
std::set<double> radii_of(const Words& typed, std::optional<double> proposed, bool adds_proposed) {
  std::set<double> radii;
  if (proposed && adds_proposed) radii.insert(*proposed);
  if (typed.empty()) radii.insert({0.5 * *proposed, 2 * *proposed});
  for (const auto& word : typed) {
    const auto number = word == "auto" ? proposed : number_of(word);
    if (!number) fail(ErrorKind::usage, "--radius: {} is neither auto nor a number", word);
    radii.insert(*number);
  }
  return radii;
}

/// Fails where looks are not of one reading of a frame, or one is there twice.
void check_looks(const std::vector<WedgeLook>& looks) {
  std::set<std::string> names;
  for (const auto& look : looks) {
    if (!names.insert(look.name).second) fail(ErrorKind::usage, "the look {} is there twice", look.name);
    for (const auto& row : option_table())
      if (is_shared(row) && row.words(look.settings) != row.words(looks.front().settings))
        fail(ErrorKind::usage, "{} differs between the looks {} and {}: a wedge reads its frame once", row.long_name(),
             looks.front().name, look.name);
  }
}

/// Refuses to write over what is read: the frames, and the presets of all looks.
void check_reports(const Typed& typed, const FramePlan& plan) {
  FileUses uses;
  add_inputs(uses, plan);
  for (std::size_t i = 0; i + 1 < typed.arguments.size(); i++)
    if (typed.arguments[i] == Words{"--preset"})
      for (const auto& preset : presets_of(typed.arguments[i + 1]))
        for (const auto& file : read_chain(preset).files) uses.add_input({"--preset", file});
  for (const auto& file : {NamedFile{"--output", typed.page}, {"--sheet", typed.sheet}}) {
    if (file.path.empty()) continue;
    uses.add_output(file);
    require_writable(file.path, file.option.c_str());
  }
  require_ending(typed.page, "--output", ".html", "HTML");
  require_ending(typed.sheet, "--sheet", ".png", "PNG");
}

/// Takes the typed radii out of the arguments.
Words take_radii(std::vector<Words>& arguments) {
  if (std::ranges::count(arguments, Words{"--radius"}) > 1)
    fail(ErrorKind::usage, "--radius is given more than once: its looks are one list, as .1,.2,.5");
  const auto at = std::ranges::find(arguments, Words{"--radius"});
  if (at == arguments.end()) return {};
  Words radii;
  for (const auto& word : at[1]) radii.push_back(lower_case(word));
  arguments.erase(at, at + 2);
  return radii;
}

std::vector<Words> with_radii(std::vector<Words> arguments, const Words& radii) {
  arguments.insert(arguments.end(), {{"--radius"}, radii});
  return arguments;
}

/// The radius that inspect proposes. A frame without a surface has none, and must have typed radii.
std::optional<double> proposed_radius(RunPreview& first, const Words& typed) {
  try {
    first.prepare();
    return first.plan().settings().estimator.radius;
  } catch (const Error& error) {
    if (typed.empty() || has(typed, "auto") || error.kind() != ErrorKind::input) throw;
  }
  return {};
}

void require_few_pictures(std::size_t looks, std::size_t frames, bool has_page) {
  if (looks * frames <= kMostPictures || (looks == 1 && !has_page)) return;
  fail(ErrorKind::usage, "there are {} of {}, and a wedge has at most {} pictures: give {}", counted(looks, "look"),
       counted(frames, "frame"), kMostPictures, looks == 1 ? "--sheet alone, or --frames" : "fewer values or --frames");
}

void require_shown_lights(const std::vector<WedgeLook>& looks) {
  if (std::ranges::any_of(looks, [](const WedgeLook& look) { return shows_lights(look.settings); })) return;
  fail(ErrorKind::usage,
       "--lights: a wedge shows a light where --set sun-azimuth or sun-elevation turns it, or --set shadow-layers "
       "names its layer");
}

/// All combinations of what was typed, with the proposed radius among the radii.
std::vector<WedgeLook> looks_of(const Typed& typed) {
  std::vector<Words> arguments = typed.arguments;
  Words given = take_radii(arguments);
  RunPreview first(look_of(typed, with_radii(arguments, {"auto"}), 0).settings);
  check_reports(typed, first.plan());
  const bool is_of_sun = turns_sun(first.plan().settings().estimator);  // of one radius, if nothing else is typed
  if (is_of_sun && given.empty()) given = {"auto"};
  std::size_t frames = first.plan().frames().size();
  const bool names_frames = std::ranges::count(arguments, Words{"--frames"}) > 0;
  const bool is_contact_sheet = frames > 1 && !names_frames && given.size() == 1 && count_of(arguments) == 1;
  const std::optional<double> proposed = proposed_radius(first, given);
  if (frames > 1 && !names_frames && !is_contact_sheet) {
    arguments.insert(arguments.end(), {{"--frames"}, {std::to_string(first.plan().frames()[frames / 2])}});
    frames = 1;
  }
  Words radii;
  for (const double radius : radii_of(given, proposed, !is_contact_sheet && !is_of_sun))
    radii.push_back(fmt::format("{}", radius));
  const std::vector<Words> all = with_radii(arguments, radii);
  const std::size_t count = count_of(all);
  require_few_pictures(count, frames, !typed.page.empty());
  std::vector<WedgeLook> looks;
  for (std::size_t i = 0; i < count; i++) {
    looks.push_back(look_of(typed, all, i));
    const bool has_own_radius = radii.size() > 1 || count == 1;
    if (proposed && has_own_radius && looks.back().settings.estimator.radius == proposed)
      looks.back().name += " (proposed)";
  }
  check_looks(looks);
  if (std::ranges::count(arguments, Words{"--lights"}) > 0) require_shown_lights(looks);
  return looks;
}

/// Makes the wedge, and says what became of each look. Gives the exit code.
int make(const Typed& typed, std::vector<WedgeLook> looks) {
  const std::string no_composite =
      typed.no_composite.empty() ? "" : "note: there is no composite: " + printable(typed.no_composite);
  if (typed.is_dry) {
    fmt::print("{}{}{}", wedge_text(looks), no_composite, no_composite.empty() ? "" : "\n");
    return 0;
  }
  remove_earlier({typed.page, typed.sheet});
  make_wedge(looks, typed.page, typed.sheet);
  std::set<std::string> told;
  const auto tell = [&](const std::string& line) {
    if (!typed.is_quiet && told.insert(line).second) print_error("{}\n", line);
  };
  for (const auto& look : looks) {
    for (const auto& note : look.notes) tell(fmt::format("{}: {}", level_of(note), printable(line_of(note, ""))));
    if (look.error)
      print_error("alcove: error: look {}: {}\n", printable(look.name), printable(look.error->what()));
    else if (!typed.is_quiet)
      fmt::print("{:<32} {:>7.0f} ms\n  {}\n", printable(look.name), look.ms, printable(look.command));
  }
  if (const std::string& frames = looks.front().settings.frames.frames; !frames.empty())
    tell(
        fmt::format("note: the commands make the frames {}; for the whole shot leave out --frames", printable(frames)));
  if (!no_composite.empty()) tell(no_composite);
  const bool is_whole = std::ranges::none_of(looks, [](const WedgeLook& look) { return look.error.has_value(); });
  return is_whole ? 0 : int(ErrorKind::some_frames_failed);
}

}  // namespace

Command describe_wedge() { return wedge_syntax(); }

int wedge_command(const std::vector<std::string>& arguments) {
  refuse_keys(arguments);
  const Command command = wedge_syntax();
  auto options = typed_options(command, arguments);
  if (!options) return 0;
  const auto word_of_option = [&](const char* option) {
    const auto found = std::ranges::find(*options, option, &TypedOption::name);
    return found == options->end() ? std::string() : found->words.front();
  };
  Typed typed{{}, "", word_of_option("-o,--output"), word_of_option("--sheet"), !word_of_option("-q,--quiet").empty()};
  typed.is_dry = !word_of_option("--dry-run").empty();
  for (const char* option : {"INPUT", "--depth", "--position"})
    if (typed.input.empty()) typed.input = word_of_option(option);
  const bool has_beauty = !word_of_option("--beauty").empty();
  std::erase_if(*options, [](const auto& option) { return has(kOwn, option.name); });
  with_help(command, [&] {
    if (typed.input.empty()) fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
    if (typed.page.empty() && typed.sheet.empty())
      fail(ErrorKind::usage, "no output: name a page with -o FILE.html, or a picture with --sheet FILE.png");
    typed.arguments = arguments_in(*options);
  });
  try {
    return make(typed, looks_of(typed));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input || has_beauty) throw;
    typed.no_composite = error.what();
    std::vector<WedgeLook> looks;
    try {
      looks = looks_of(typed);
    } catch (const Error& without) {  // such as of settings of the composite
      if (without.kind() == ErrorKind::usage) throw error;
      throw;
    }
    return make(typed, std::move(looks));
  }
}

}  // namespace alcove
