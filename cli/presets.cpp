// `alcove presets [NAME] [--json]`: lists the presets with what each is for, or prints one.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/parsing.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"

namespace alcove {
namespace {

/// A preset as it is listed.
struct Listed {
  std::string name, group, sentence;
};

/// A folder of presets, "" for those that lie in none, and what it is for.
struct Group {
  std::string name, heading;
};

/// Ours come first, then other folders of the user's, then the systems whose look may be wanted, then the programs.
std::vector<Group> groups_of(const std::vector<Listed>& presets) {
  std::vector<Group> groups{{"", "Quality, from fast to exact (alcove run --preset NAME)"}};
  const Group sources{"source",
                      "The look of the systems that Alcove grew out of, by their own parameters: to match a frame of "
                      "theirs, or to compare with them"};
  const Group inputs{"input",
                     "The programs that frames come from, found by themselves: to say which where that goes wrong, as "
                     "--source does"};
  for (const auto& preset : presets) {
    const bool is_known = preset.group == sources.name || preset.group == inputs.name ||
                          std::ranges::find(groups, preset.group, &Group::name) != groups.end();
    if (!is_known) groups.push_back({preset.group, preset.group});
  }
  groups.insert(groups.end(), {sources, inputs});
  return groups;
}

/// The order of what we make ourselves is that of the time they take; others come by their names.
int rank_of(const std::string& name) {
  const std::vector<std::string> ours{"draft", "standard", "production", "reference"};
  return int(std::ranges::find(ours, name) - ours.begin());
}

std::vector<Listed> listed_presets() {
  std::vector<Listed> presets;
  for (const auto& name : preset_names()) {
    const std::size_t slash = name.find('/');
    const std::string text = read_text(preset_file(name), "preset", "NAME");
    presets.push_back({name, slash == name.npos ? "" : name.substr(0, slash), preset_sentence(text)});
  }
  std::ranges::stable_sort(presets, {}, [](const Listed& preset) { return rank_of(preset.name); });
  return presets;
}

void print_list(const std::vector<Listed>& presets) {
  std::size_t width = 0;
  for (const auto& preset : presets) width = std::max(width, preset.name.size());
  bool is_first = true;
  for (const auto& group : groups_of(presets)) {
    if (std::ranges::find(presets, group.name, &Listed::group) == presets.end()) continue;
    fmt::print("{}{}:\n", is_first ? "" : "\n", printable(group.heading));
    is_first = false;
    for (const auto& preset : presets)
      if (preset.group == group.name)
        fmt::print("  {:<{}}{}{}\n", printable(preset.name), preset.sentence.empty() ? 0 : width,
                   preset.sentence.empty() ? "" : "  ", printable(preset.sentence));
  }
}

void print_json(const std::vector<Listed>& presets) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& preset : presets)
    list.push_back({{"name", preset.name},
                    {"group", preset.group},
                    {"sentence", preset.sentence},
                    {"file", preset_file(preset.name)}});
  fmt::print("{}\n", json_text(list, 1));
}

struct PresetsArguments {
  std::string name;
  bool json = false;
};

Command presets_for(PresetsArguments& a) {
  Command command{"alcove presets", "Lists the presets with what each is for, or prints the one of that name.\n", {}};
  OptionGroup(command.rows, "", Effect::none).text("NAME", a.name, "", "a preset to print, or a TOML file");
  OptionGroup(command.rows, "Options", Effect::none)
      .flag("--json", a.json, "print the list as JSON: name, group, sentence, file");
  return command;
}

}  // namespace

Command describe_presets() { return shown(presets_for); }

int presets_command(const std::vector<std::string>& arguments) {
  PresetsArguments a;
  if (!parse_arguments(presets_for(a), arguments)) return 0;
  const auto& [name, json] = a;
  if (!name.empty() && json) fail(ErrorKind::usage, "--json is of the list; {} is printed as it is", name);
  if (!name.empty())
    fmt::print("{}", read_text(preset_file(name), "preset", "NAME"));
  else if (json)
    print_json(listed_presets());
  else
    print_list(listed_presets());
  return 0;
}

}  // namespace alcove
