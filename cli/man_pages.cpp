// Man pages in the macros of man(7): one for the program, and one for each command.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "cli/build_facts.h"
#include "cli/commands.h"
#include "cli/generate.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/options/options.h"

namespace alcove {
namespace {

constexpr std::size_t kColumns = 79;

/// Text that roff takes for no command: hyphens are those of options, and lines begin with no dot.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '~')
      out += "\\(ti";
    else if (c == '\'')
      out += "\\(aq";
    else
      out += c;
  }
  return out.starts_with('.') ? "\\&" + out : out;
}

/// A paragraph in lines of roff: it is filled again where it is read.
std::string filled(const std::string& text) {
  std::string out, line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    word = escaped(word);
    if (!line.empty() && line.size() + 1 + word.size() > kColumns) {
      out += line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? out : out + line + "\n";
}

/// A description: paragraphs, and examples, whose lines are indented and stay as they are.
std::string described(const std::string& text) {
  std::string out, paragraph, examples;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line == "Example:" || line == "Examples:") continue;
    if (line.starts_with("  "))
      examples += escaped(line.substr(2)) + "\n";
    else
      paragraph += line + " ";
  }
  out += filled(paragraph);
  return examples.empty() ? out : out + ".SH EXAMPLES\n.EX\n" + examples + ".EE\n";
}

char upper(char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; }

std::string title(const std::string& name, const std::string& sentence) {
  std::string heading = name;
  std::ranges::transform(heading, heading.begin(), upper);
  return fmt::format(".TH {} 1 \"{}\" \"alcove {}\" \"User Commands\"\n.ad l\n.nh\n.SH NAME\n{} \\- {}\n",
                     escaped(heading), kReleaseDate, kVersion, escaped(name), escaped(sentence));
}

std::string heading_of(const OptionRow& row) {
  std::vector<std::string> names;
  for (const auto& name : names_of_row(row)) names.push_back("\\fB" + escaped(name) + "\\fR");
  std::string value;  // lines may break behind each word of a list
  for (const char c : escaped(row.value)) value += c == '|' ? std::string("|\\:") : std::string(1, c);
  return fmt::format("{}{}", fmt::join(names, ", "), value.empty() ? "" : " \\fI" + value + "\\fR");
}

/// What stands below a row's heading: its sentence, range and default.
std::string text_of(const OptionRow& row) {
  std::vector<std::string> facts;
  if (const std::string range = range_text(row); !range.empty()) facts.push_back(range);
  if (!row.default_text.empty()) facts.push_back("default: " + row.default_text);
  return upper(row.sentence[0]) + row.sentence.substr(1) +
         (facts.empty() ? "." : fmt::format(" ({}).", fmt::join(facts, "; ")));
}

std::string options_of(const Command& command) {
  std::string out = ".SH OPTIONS\n", group;
  for (const auto& row : rows_with_help(command)) {
    if (row.group != group && !row.group.empty()) out += ".SS " + escaped(row.group) + "\n";
    group = row.group;
    out += ".TP\n" + heading_of(row) + "\n" + filled(text_of(row));
  }
  return out;
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n.TP\n0\nAll was done.\n.TP\n1\nSome frames failed.\n.TP\n2\nUsage or settings.\n.TP\n3\nAn input "
    "is missing or cannot be read.\n.TP\n4\nAn output could not be written.\n.TP\n5\nThere is no device, or it was "
    "lost.\n"
    ".TP\n6\nA comparison failed.\n.TP\n128 and more\nThe number of the signal that ended the run, plus 128.\n";

constexpr const char* kEnvironment =
    ".SH ENVIRONMENT\n.TP\nALCOVE_PRESETS\nThe folder of presets.\n.TP\nALCOVE_PRESET_PATH\n"
    "Folders of further presets, with colons, which come first.\n.TP\nOCIO\nThe colour configuration of composites "
    "and previews.\n";

std::string see_also(const std::string& but) {
  std::vector<std::string> pages;
  if (!but.empty()) pages.emplace_back("\\fBalcove\\fR(1)");
  for (const auto& command : subcommands())
    if (command.name != but) pages.push_back("\\fBalcove\\-" + command.name + "\\fR(1)");
  return fmt::format(".SH SEE ALSO\n{}\n", fmt::join(pages, ",\n"));
}

}  // namespace

std::string man_page() {
  std::string out = title("alcove", "ambient occlusion from rendered depth and normals");
  out +=
      ".SH SYNOPSIS\n\\fBalcove\\fR \\fICOMMAND\\fR [\\fIoptions\\fR]\n.br\n\\fBalcove\\fR \\fIFILE.exr\\fR "
      "[\\fIoptions\\fR]\n.SH DESCRIPTION\n";
  out += filled(
      "Computes ambient occlusion offline, from the depth and normals of a renderer or a game, and writes AO and "
      "composites as EXR files. An input without a command is run.");
  out += ".SH COMMANDS\n";
  for (const auto& [name, sentence, run, describe] : subcommands())
    out += fmt::format(".TP\n\\fB{}\\fR\n{}See \\fBalcove\\-{}\\fR(1).\n", name,
                       filled(upper(sentence[0]) + sentence.substr(1) + "."), name);
  out +=
      ".SH OPTIONS\n.TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nPrint the commands and stop.\n.TP\n\\fB\\-\\-version\\fR\n"
      "Print version, build and libraries and stop.\n";
  return out + kExitStatus + kEnvironment + see_also("");
}

std::string man_page_of(const Command& command) {
  const std::string name = command.name.substr(std::string("alcove ").size());
  const auto& entry = *std::ranges::find(subcommands(), name, &Subcommand::name);
  std::string out = title("alcove-" + name, entry.sentence) + ".SH SYNOPSIS\n\\fBalcove " + name + "\\fR";
  for (const auto& row : command.rows)
    if (!row.name.starts_with('-'))
      out += row.is_required ? " \\fI" + row.name + "\\fR" : " [\\fI" + row.name + "\\fR]";
  out += " [\\fIoptions\\fR]\n.SH DESCRIPTION\n" + described(command.description);
  return out + options_of(command) + see_also(name);
}

}  // namespace alcove
