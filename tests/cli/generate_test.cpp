// Man pages and completions say what the help says, and the programs that read them take them.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "core/base/system.h"
#include "tests/support/program.h"

namespace alcove::generate_test {
namespace {

using namespace test;
using Names = std::vector<std::string>;

const Names kCommands{"run", "inspect", "wedge", "compare", "bench", "presets", "devices", "doctor"};

std::string generated(const Names& what) {
  const Finished finished = run_well(joined({"--generate"}, what));
  EXPECT_THAT(finished.err, IsEmpty());
  return finished.out;
}

/// The flags that a command's help shows. That of inspect leaves out those of run's that it only takes.
Names flags_of(const std::string& command) {
  const std::string help = run_program({command, command == "inspect" ? "--help" : "--help-all"}).out;
  Names flags;
  const std::regex entry(R"(^  ((-[a-z],)?--[a-z0-9-]+))");
  for (const auto& line : lines_of(help)) {
    std::smatch found;
    if (!std::regex_search(line, found, entry)) continue;
    const std::string names = found.str(1);
    const std::size_t comma = names.find(',');
    if (comma != names.npos) flags.push_back(names.substr(0, comma));
    flags.push_back(comma == names.npos ? names : names.substr(comma + 1));
  }
  return flags;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) text.replace(at, from.size(), to);
  return text;
}

class Generated : public testing::Test {
 protected:
  /// Skips the test, or in continuous integration fails it, where a program is missing.
  static bool lacks(const std::string& program) {
    if (!output_of_command("command -v " + program).empty()) return false;
    EXPECT_EQ(std::getenv("CI"), nullptr) << program << " is missing: see packages.txt";
    return true;
  }

  std::string kept(const std::string& name, const std::string& text) const {
    write_bytes(folder / name, text);
    return folder / name;
  }

  /// What a command of the shell prints, also as errors, with our program on the path.
  static std::string said(const std::string& command) {
    const std::string programs = fs::path(ALCOVE_PROGRAM).parent_path();
    return output_of_command("PATH=" + programs + ":$PATH ALCOVE_PRESETS=" ALCOVE_SOURCE_DIR "/presets; export PATH " +
                             "ALCOVE_PRESETS; cd / && { " + command + "; } 2>&1");
  }

  TemporaryFolder folder;
};

#define SKIP_WITHOUT(program) \
  if (lacks(program)) GTEST_SKIP() << program << " is not installed"

TEST_F(Generated, each_flag_of_the_help_is_in_the_man_page_and_in_all_completions) {
  const std::string bash = generated({"bash"}), zsh = generated({"zsh"}), fish = generated({"fish"});
  for (const auto& command : kCommands) {
    const Names flags = flags_of(command);
    ASSERT_GE(flags.size(), 2) << command;
    const std::string page = generated({"man", command});
    // The lists of each command begin with its name.
    const std::string in_bash = bash.substr(bash.find("      " + command + ") words=\"-h "));
    const std::string of_bash = in_bash.substr(0, in_bash.find("\" ;;")) + " ";
    const std::string in_zsh = zsh.substr(zsh.find("    " + command + ")\n"));
    const std::string of_zsh = in_zsh.substr(0, in_zsh.find(" ;;\n"));
    for (const auto& flag : flags) {
      EXPECT_THAT(page, HasSubstr("\\fB" + replaced(flag, "-", "\\-") + "\\fR")) << command;
      EXPECT_THAT(of_bash.substr(of_bash.find('"')), ContainsRegex("[\" ]" + flag + " ")) << command;
      EXPECT_THAT(of_zsh, ContainsRegex("[)*]" + flag + "[+=]?\\[")) << command;
      const std::string of_fish = flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
      EXPECT_THAT(lines_of(fish), Contains(AllOf(StartsWith("complete -c alcove -n '__alcove_command " + command + "'"),
                                                 HasSubstr(of_fish + " "))));
    }
  }
}

TEST_F(Generated, man_pages_show_groups_ranges_and_defaults) {
  const std::string page = generated({"man", "run"});
  EXPECT_THAT(page, AllOf(HasSubstr(".SS Estimator"), HasSubstr(".SH EXAMPLES\n.EX\nalcove run frame.exr"),
                          HasSubstr("\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fI")));
  EXPECT_THAT(replaced(page, "\n", " "), HasSubstr("(degrees, above 0 and below 180)."));
  EXPECT_THAT(generated({"man"}), AllOf(HasSubstr(".SH EXIT STATUS"), HasSubstr("\\fBalcove\\-doctor\\fR(1)")));
  EXPECT_THAT(generated({"man", "inspect"}), AllOf(HasSubstr("\\-\\-json"), Not(HasSubstr("\\-\\-no\\-skip"))));
}

TEST_F(Generated, man_finds_nothing_to_warn_of) {
  SKIP_WITHOUT("man");
  SKIP_WITHOUT("mandoc");
  Names pages{""};
  pages.insert(pages.end(), kCommands.begin(), kCommands.end());
  for (const auto& command : pages) {
    const std::string page = kept("page.1", command.empty() ? generated({"man"}) : generated({"man", command}));
    EXPECT_EQ(said("LC_ALL=C.UTF-8 MANROFFOPT= man --warnings -l " + page + " >/dev/null"), "") << command;
    EXPECT_EQ(said("mandoc -T lint -W warning " + page), "") << command;
    const std::string shown = said("MANWIDTH=100 man -l " + page + " | cat");
    EXPECT_THAT(shown, HasSubstr("SEE ALSO")) << command;
    if (command == "run") EXPECT_THAT(shown, AllOf(HasSubstr("--radius"), HasSubstr("scene units")));
  }
}

TEST_F(Generated, bash_completes_commands_options_words_and_names) {
  SKIP_WITHOUT("bash");
  const std::string script = kept("alcove.bash", generated({"bash"}));
  const auto completed = [&](const std::string& words) {
    return lines_of(said("bash -c 'source " + script + "; COMP_WORDS=(" + words +
                         "); COMP_CWORD=$((${#COMP_WORDS[@]}-1)); _alcove; printf \"%s\\n\" \"${COMPREPLY[@]}\"'"));
  };
  EXPECT_THAT(completed("alcove \"\""), IsSupersetOf(kCommands));
  EXPECT_THAT(completed("alcove pres"), ElementsAre("presets"));
  EXPECT_THAT(completed("alcove run --rad"), ElementsAre("--radius"));
  EXPECT_THAT(completed("alcove frame.exr --rad"), ElementsAre("--radius")) << "a file is run";
  EXPECT_THAT(completed("alcove inspect --js"), ElementsAre("--json"));
  EXPECT_THAT(completed("alcove run --normal-space \"\""), ElementsAre("auto", "view", "world"));
  EXPECT_THAT(completed("alcove run --normal-space = wo"), ElementsAre("world")) << "as bash splits --x=wo";
  EXPECT_THAT(completed("alcove run --preset pro"), ElementsAre("production"));
  EXPECT_THAT(completed("alcove presets source/taos-q"), ElementsAre("source/taos-quality"));
  EXPECT_THAT(completed("alcove run --device \"\""), IsSupersetOf({"auto", "cpu", "0"}));
  EXPECT_THAT(completed("alcove help doc"), ElementsAre("doctor"));
  EXPECT_THAT(completed("alcove run --fov \"\""), ElementsAre("")) << "a number";
}

TEST_F(Generated, zsh_completes) {
  SKIP_WITHOUT("zsh");
  kept("_alcove", generated({"zsh"}));
  EXPECT_EQ(said("zsh -n " + (folder / "_alcove")), "");
  // zsh completes only for a terminal: a shell of its own gets the keys, and shows at its end what the line has become.
  const auto completed = [&](const std::string& typed) {
    const std::string script =
        kept("try.zsh",
             "zmodload zsh/zpty\nzpty shell 'PS1=\"> \" TERM=dumb zsh -f -i'\n"
             "zpty -w shell 'fpath=(" +
                 folder.path() +
                 " $fpath); autoload -U compinit; compinit -u -D; '"
                 "'show() { print -r -- \"LINE<$BUFFER>\"; zle kill-buffer; }; zle -N show; bindkey \"^X\" show; "
                 "bindkey \"^I\" complete-word; print REA''DY'\n"
                 "zpty -r -m shell out '*READY*'\n"
                 "zpty -w -n shell '" +
                 typed +
                 "'$'\\t\\x18'\n"
                 "zpty -r -m shell out '*LINE<*>*'\nprint -r -- \"$out\"\n");
    const std::string shown = said("timeout 60 zsh -f " + script);
    const std::size_t begin = shown.rfind("LINE<");
    return begin == shown.npos ? shown : shown.substr(begin + 5, shown.find('>', begin) - begin - 5);
  };
  for (const auto& [words, line] : {std::pair("alcove pres", "alcove presets"),
                                    {"alcove run --normal-sp", "alcove run --normal-space"},
                                    {"alcove run --normal-space w", "alcove run --normal-space world"},
                                    {"alcove frame.exr --rad", "alcove frame.exr --radius"},
                                    {"alcove run --preset produ", "alcove run --preset production"},
                                    {"alcove compare --max-r", "alcove compare --max-rmse"}})
    EXPECT_THAT(completed(words), StartsWith(line));
}

TEST_F(Generated, fish_completes) {
  SKIP_WITHOUT("fish");
  const std::string script = kept("alcove.fish", generated({"fish"}));
  EXPECT_EQ(said("fish -n " + script), "");
  const auto completed = [&](const std::string& line) {
    Names words;
    for (const auto& found :
         lines_of(said("HOME=" + folder.path() + " fish -c 'source " + script + "; complete -C \"" + line + "\"'")))
      words.push_back(found.substr(0, found.find('\t')));
    return words;
  };
  EXPECT_THAT(completed("alcove "), IsSupersetOf(kCommands));
  // Others follow that only have these letters, in that order, since fish 4.
  EXPECT_EQ(completed("alcove run --rad").at(0), "--radius");
  EXPECT_EQ(completed("alcove frame.exr --rad").at(0), "--radius");
  EXPECT_THAT(completed("alcove run --normal-space "), ElementsAre("auto", "view", "world"));
  EXPECT_THAT(completed("alcove run --preset produ"), ElementsAre("production"));
  EXPECT_THAT(completed("alcove help doc"), ElementsAre("doctor"));
  EXPECT_EQ(completed("alcove compare --max-r").at(0), "--max-rmse");
}

TEST_F(Generated, other_words_are_refused) {
  for (const char* more : {"", "html", "man rnu", "bash run", "man run more"})
    expect_refused(run_program(joined({"--generate"}, typed(more))), 2, {});
}

}  // namespace
}  // namespace alcove::generate_test
