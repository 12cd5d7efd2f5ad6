// `alcove wedge INPUT --radius A,B,C -o PAGE.html`: a frame in many looks, and the command of each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/wedge/wedge.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/frame/raw_plane.h"
#include "core/run/first_look.h"

namespace alcove {
namespace {

constexpr std::size_t kMostPictures = 64;

constexpr const char* kWedge =
    "Shows a frame in many looks: one for each radius, and for each value of every other list. The page has all looks "
    "to\nwipe and flip between, and the command that makes each. The radius that inspect proposes is one of them. Of a "
    "sequence\nit shows the middle frame, or --frames; a sequence with one look is shown whole. Input options are "
    "those "
    "of alcove run.\n\n"
    "Examples:\n"
    "  alcove wedge frame.exr --camera camera.json -o looks.html\n"
    "  alcove wedge frame.exr --camera camera.json --radius .1,.2,.5,1 --preset draft,production --sheet looks.png\n"
    "  alcove wedge frame.exr --camera camera.json --radius .5 --set intensity=.8,1,1.3 -o looks.html\n";

/// The options of run that say how a frame is read and estimated, and its own.
Command wedge_syntax() {
  Command command = run_syntax();
  command.name = "alcove wedge";
  command.description = kWedge;
  static const Words kGroups{"", "Input", "Hidden surfaces", "Estimator"}, kOthers{"--frames", "--device", "--memory"};
  std::erase_if(command.rows, [](const OptionRow& row) {
    return std::ranges::find(kGroups, row.group) == kGroups.end() &&
           std::ranges::find(kOthers, row.name) == kOthers.end();
  });
  for (auto& row : command.rows) {
    if (row.name == "--frames") row.sentence = "such as 1001,1050; else the middle one of INPUT on the disk";
    if (row.name == "--preset") row.sentence = "settings from presets, a look for each of a list";
    if (row.name == "--set") row.value = "KEY=VALUE[,VALUE...]";
    if (row.name == "--radius")
      row.sentence = "how far occluders reach, a look for each; else half, once and twice what inspect proposes";
  }
  const auto add = [&](const char* name, const char* value, const char* sentence) {
    command.rows.push_back({.group = "Output", .name = name, .value = value, .sentence = sentence, .is_common = true});
  };
  add("-o,--output", "FILE.html", "a self-contained page with all looks");
  add("--sheet", "FILE.png", "all looks in one labelled picture");
  return command;
}

// Looks: one value of each list.

/// A word of an option as it was typed, with the words of which each makes a look.
struct Choice {
  std::string option;  // the name of its row
  Words words;
};
using Choices = std::vector<Choice>;

bool takes_whole(const SettingRow& row, const std::string& value) {
  try {
    Settings settings;
    row.read(settings, {value});
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// The values of a list; what the setting takes as one value is one.
Words values_in(const SettingRow* row, const std::string& option, const std::string& text) {
  if (row && takes_whole(*row, text)) return {text};
  Words values = split(text);
  if (std::ranges::find(values, "") != values.end())
    fail(ErrorKind::usage, "{} {}: a value of the list is empty", option, visible(text));
  if (row && values.size() > 1 && row->group == "Input")
    fail(ErrorKind::usage, "{} {}: a wedge reads its frame once: give one value", option, text);
  return values;
}

Choice choice_of_set(const Command& command, const std::string& set) {
  const std::size_t equals = std::min(set.find('='), set.size());
  if (equals == 0 || equals == set.size()) return {"--set", {set}};
  const SettingRow& row = row_of_key(lower_case(set.substr(0, equals)));
  const bool is_taken =
      row.is_only_key() || std::ranges::find(command.rows, row.name, &OptionRow::name) != command.rows.end();
  if (!is_taken || row.key() == "output" || row.key() == "radius" || row.key() == "frames")
    fail(ErrorKind::usage, "--set {}: alcove wedge takes no {} as a setting", set, row.key());
  Choice choice{"--set", values_in(&row, "--set " + row.key(), set.substr(equals + 1))};
  for (auto& word : choice.words) word = set.substr(0, equals + 1) + word;
  return choice;
}

/// All words that were typed, but those of the wedge's own options.
Choices choices_of(const Command& command, const std::vector<TypedOption>& typed) {
  Choices choices;
  for (const auto& [name, words] : typed) {
    if (name == "-o,--output" || name == "--sheet") continue;
    if (name == "--radius" && words.size() > 1)
      fail(ErrorKind::usage, "--radius is given more than once: its looks are one list, as .1,.2,.5");
    for (const auto& word : words) {
      const auto row = std::ranges::find(option_table(), name, &SettingRow::name);
      const bool is_list = row == option_table().end() || !row->is_key() || name == "--radius";
      if (name == "INPUT" || name == "--frames")
        choices.push_back({name, {word}});
      else if (name == "--set")
        choices.push_back(choice_of_set(command, word));
      else
        choices.push_back({name, values_in(is_list ? nullptr : &*row, name, word)});
    }
  }
  return choices;
}

Choice& choice_of(Choices& choices, const std::string& option) {
  const auto found = std::ranges::find(choices, option, &Choice::option);
  return found == choices.end() ? choices.emplace_back(Choice{option, {}}) : *found;
}

/// Makes looks of choices of which each has one word left.
class LookMaker {
 public:
  explicit LookMaker(bool has_composite) : has_composite_(has_composite) {}

  WedgeLook operator()(const Choices& choices, const std::string& name) const {
    WedgeLook look{name, "alcove run", {}};
    std::vector<TypedOption> typed;
    for (const auto& [option, words] : choices) {
      if (typed.empty() || typed.back().name != option) typed.push_back({option, {}});
      typed.back().words.push_back(words.front());
    }
    const auto input = std::ranges::find_if(choices, [](const Choice& choice) {
      return choice.option == "INPUT" || choice.option == "--depth" || choice.option == "--position";
    });
    if (input == choices.end()) fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
    for (const auto& [option, stem, ending] : {std::array{"-o,--output", "ao", ".exr"},
                                               {"--composite", "composite", ".exr"},
                                               {"--preview", "preview", ".png"}})
      if (has_composite_ || option != std::string_view("--composite"))
        typed.push_back({option, {usual_output(input->words.front(), stem, ending)}});
    for (const auto& [option, words] : typed)
      for (const auto& word : words) look.command += in_command(option, word);
    if (input->option == "INPUT") look.settings.input.input = input->words.front();
    look.settings = with_values(look.settings, all_values(typed));
    return look;
  }

 private:
  static std::string in_command(const std::string& option, const std::string& word) {
    const auto row = std::ranges::find(option_table(), option, &SettingRow::name);
    if (row == option_table().end()) return " " + for_shell(word);  // INPUT
    if (row->is_flag()) return " " + row->long_name() + (word == "true" ? "" : "=" + word);
    return " " + option.substr(0, option.find(',')) + (word.starts_with('-') ? "=" : " ") + for_shell(word);
  }

  const bool has_composite_;
};

std::string text_of(double number) { return fmt::format("{}", number); }

/// What a look is called by a choice of which there are several.
std::string name_of(const Choice& choice, const std::string& word) {
  if (choice.option == "--preset" || choice.option == "--set") return word;
  return choice.option.substr(2) + " " + word;
}

struct Looks {
  std::vector<WedgeLook> looks;
  std::size_t columns = 0;  // of the sheet; 0: any
};

/// The looks of a wedge: all combinations of what was chosen, with the proposed radius among the radii.
class LookFinder {
 public:
  LookFinder(Choices choices, bool has_composite, bool has_page)
      : choices_(std::move(choices)), make_(has_composite), has_page_(has_page) {}

  Looks find() {
    find_frames_and_radii();
    std::size_t count = frames_;
    for (const auto& choice : choices_) count *= choice.words.size();
    if (count > kMostPictures && (has_page_ || count > frames_))
      fail(ErrorKind::usage, "there are {} looks in {} frames, and a wedge has at most {} pictures: {}",
           count / frames_, frames_, kMostPictures,
           frames_ > 1 ? "name fewer frames with --frames" : "give shorter lists");
    add_looks({}, 0, "");
    std::set<std::string> names;
    for (const auto& look : found_.looks) {
      if (!names.insert(look.name).second) fail(ErrorKind::usage, "the look {} is there twice", look.name);
      for (const auto& row : option_table())
        if (row.group == "Input" && row.words(look.settings) != row.words(found_.looks.front().settings))
          fail(ErrorKind::usage, "the looks {} and {} have another {} each: a wedge reads its frame once",
               found_.looks.front().name, look.name, row.long_name());
    }
    const std::size_t radii = choices_.back().words.size();
    if (found_.looks.size() > radii && radii > 1) found_.columns = radii;
    return std::move(found_);
  }

 private:
  /// The radius becomes the last of the choices.
  void find_frames_and_radii() {
    Choice radii = choice_of(choices_, "--radius");
    std::erase_if(choices_, [](const Choice& choice) { return choice.option == "--radius"; });
    Choices first = choices_;
    first.push_back({"--radius", {"auto"}});
    FirstLook look(make_(first, "").settings);
    frames_ = look.plan().frames().size();
    const bool is_one_look = radii.words.size() == 1 && std::ranges::all_of(choices_, [](const Choice& choice) {
                               return choice.words.size() == 1;
                             });
    const bool names_frames = std::ranges::find(choices_, "--frames", &Choice::option) != choices_.end();
    const bool is_whole = is_one_look && frames_ > 1 && !names_frames;
    if (!is_whole || radii.words[0] == "auto") find_proposal(look, !radii.words.empty());
    if (frames_ > 1 && !names_frames && !is_whole) {
      choices_.push_back({"--frames", {std::to_string(look.plan().frames()[frames_ / 2])}});
      frames_ = 1;
    }
    std::set<double> numbers;
    if (proposed_ && !is_whole) numbers.insert(*proposed_);
    if (radii.words.empty()) numbers.insert({0.5 * *proposed_, 2 * *proposed_});
    for (const auto& word : radii.words) {
      const auto number = lower_case(word) == "auto" ? proposed_ : number_of(word);
      if (!number) fail(ErrorKind::usage, "--radius: {} is neither auto nor a number", word);
      numbers.insert(*number);
    }
    radii.words.clear();
    for (const double number : numbers) radii.words.push_back(text_of(number));
    choices_.push_back(radii);
  }

  /// Where radii are given, a frame without a surface is no mistake; a fault of it fails each look.
  void find_proposal(FirstLook& look, bool has_radii) {
    try {
      look.prepare();
      proposed_ = look.plan().settings().estimator.radius;
    } catch (const Error& error) {
      if (!has_radii || error.kind() != ErrorKind::input) throw;
    }
  }

  /// Adds the looks of the choices from the i-th on.
  void add_looks(Choices chosen, std::size_t i, const std::string& name) {
    if (i == choices_.size()) {
      found_.looks.push_back(make_(chosen, name));
      return;
    }
    const bool is_radius = i + 1 == choices_.size();
    for (const auto& word : choices_[i].words) {
      std::string more = name;
      if (choices_[i].words.size() > 1 || (is_radius && name.empty()))
        more += (name.empty() ? "" : ", ") + name_of(choices_[i], word);
      if (is_radius && proposed_ && word == text_of(*proposed_)) more += " (proposed)";
      Choices with = chosen;
      with.push_back({choices_[i].option, {word}});
      add_looks(with, i + 1, more);
    }
  }

  Choices choices_;
  const LookMaker make_;
  const bool has_page_;
  std::size_t frames_ = 1;
  std::optional<double> proposed_;
  Looks found_;
};

/// Says what became of each look. Gives the exit code.
int tell(const std::vector<WedgeLook>& looks, const std::vector<WedgeTime>& times) {
  bool has_failed = false;
  std::set<std::string> told;
  for (std::size_t i = 0; i < looks.size(); i++) {
    for (const auto& note : times[i].notes)
      if (const std::string line = fmt::format("{}: {}\n", level_of(note), printable(line_of(note, "")));
          told.insert(line).second)
        print_error("{}", line);
    if (times[i].error)
      print_error("alcove: error: look {}: {}\n", printable(looks[i].name), printable(times[i].error->what()));
    has_failed = has_failed || times[i].error;
    if (!times[i].error)
      fmt::print("{:<32} {:>7.0f} ms\n  {}\n", printable(looks[i].name), times[i].ms, printable(looks[i].command));
  }
  return has_failed ? int(ErrorKind::some_frames_failed) : 0;
}

}  // namespace

Command describe_wedge() { return wedge_syntax(); }

int wedge_command(const std::vector<std::string>& arguments) {
  refuse_keys(arguments);
  const Command command = wedge_syntax();
  const auto typed = typed_options(command, arguments);
  if (!typed) return 0;
  const auto file = [&](const char* option) {
    const auto found = std::ranges::find(*typed, option, &TypedOption::name);
    return found == typed->end() ? std::string() : found->words.front();
  };
  const std::string page = file("-o,--output"), sheet = file("--sheet");
  if (page.empty() && sheet.empty())
    fail(ErrorKind::usage, "no output: name a page with -o FILE.html, or a picture with --sheet FILE.png{}",
         see_help(command.name));
  require_ending(page, "--output", ".html", "HTML");
  require_ending(sheet, "--sheet", ".png", "PNG");
  const auto make = [&](bool has_composite) {
    Looks found;
    with_help(command, [&] { found = LookFinder(choices_of(command, *typed), has_composite, !page.empty()).find(); });
    for (const auto& [path, option] : {std::pair(page, "--output"), {sheet, "--sheet"}}) {
      require_no_input(path, option, input_files(found.looks.front().settings.input));
      if (!path.empty()) require_writable(path, option);
    }
    return tell(found.looks, make_wedge(found.looks, page, sheet, found.columns));
  };
  std::optional<Error> no_composite;
  try {
    return make(true);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input || !file("--beauty").empty()) throw;
    no_composite = error;
  }
  const int code = make(false);
  print_error("note: there is no composite: {}\n", printable(no_composite->what()));
  return code;
}

}  // namespace alcove
