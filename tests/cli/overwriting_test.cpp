// No command writes over what it reads, or one file twice: all pairs of the tables of options, by every kind of name.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "cli/commands.h"
#include "core/base/error.h"
#include "core/options/options.h"
#include "tests/support/command_line.h"

namespace alcove::overwriting_test {
namespace {

using namespace test;

/// The ending of every file: with it a view's picture may be any file too.
constexpr const char* kEnding = ".raw-depth.png";

/// Whose frames 1 to 3 are there; each command reads all three, though it may write only one.
const std::string kSequence = "%d";

class Overwriting : public testing::Test {
 protected:
  Overwriting() {
    ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
    for (const char* number : {".1", ".2", ".3", ""})
      for (const char* stem : {"read", "other"}) write_bytes(folder / (stem + std::string(number) + kEnding), kBytes);
    fs::create_directory_symlink(folder.path(), folder / "linked");
    fs::create_symlink(folder / read_by_all(true), folder / ("link.of-frame" + std::string(kEnding)));
    fs::create_symlink(folder / read_by_all(false), folder / ("link" + std::string(kEnding)));
    fs::create_hard_link(folder / read_by_all(true), folder / ("hard.of-frame" + std::string(kEnding)));
    fs::create_hard_link(folder / read_by_all(false), folder / ("hard" + std::string(kEnding)));
  }

  /// A file that a command reads by an option: of a sequence that of a frame beside the one that is computed.
  static std::string read_by_all(bool is_of_frame) { return (is_of_frame ? "read.3" : "read") + std::string(kEnding); }

  /// The names of that file without its ending.
  Options stems(bool is_of_frame) const {
    const std::string name = is_of_frame ? "read.3" : "read", kind = is_of_frame ? ".of-frame" : "";
    return {folder / name, folder / ("./linked/./" + name), folder / ("link" + kind), folder / ("hard" + kind)};
  }

  using Typed = std::map<std::string, std::string>;

  static bool has(const Command& command, const std::string& name) {
    return std::ranges::find(command.rows, name, &OptionRow::name) != command.rows.end();
  }

  /// What gives every option an effect, where the command has these.
  Typed others(const Command& command) const {
    const Typed all{{"INPUT", folder / "other.%d" + kEnding},
                    {"RESULT", folder / "other.%d" + kEnding},
                    {"REFERENCE", folder / "other.%d" + kEnding},
                    {"SUITE", folder / "other" + kEnding},
                    {"--frames", has(command, "--accumulate") ? "2" : "1-3"},
                    {"--accumulate", "1"},
                    {"--output", folder / "new.exr"},
                    {"--composite", folder / "new.composite.exr"},
                    {"--preview", folder / "new.png"},
                    {"--camera", folder / "other" + kEnding},
                    {"--radius", "1"},
                    {"--set multi-bounce", "true"}};
    Typed typed;
    for (const auto& row : rows_of(command))
      if (const auto found = all.find(row.long_name()); found != all.end()) typed.insert(*found);
    if (command.name == "alcove wedge") typed["--output"] = folder / "new.html";
    return typed;
  }

  /// The rows of the command and, where it takes them, the settings of --set.
  static std::vector<OptionRow> rows_of(const Command& command) {
    std::vector<OptionRow> rows = command.rows;
    if (!has(command, "--set")) return rows;
    const auto is_output = [](const OptionRow& row) { return row.role == FileRole::output; };
    for (const auto& row : option_table())
      if (row.is_only_key() && (!is_output(row) || std::ranges::any_of(rows, is_output))) rows.push_back(row);
    return rows;
  }

  /// Types the option for a file of that name: --set debug writes it beside OUTPUT.
  static void type(Typed& typed, const OptionRow& row, const std::string& stem) {
    typed[row.long_name()] = row.key() == "debug" ? "raw-depth" : stem + kEnding;
    if (row.key() == "debug") typed["--output"] = stem + ".exr";
    if (row.key() == "objects") typed["--set occluders"] = "Hero";
    if (row.key() == "motion" && row.group == "Hidden surfaces") typed["--accumulate"] = "1";
  }

  static Options arguments(const Command& command, const Typed& typed) {
    Options words;
    for (const auto& row : command.rows)
      if (!row.name.starts_with('-') && typed.contains(row.name)) words.push_back(typed.at(row.name));
    for (const auto& [option, value] : typed) {
      if (option.starts_with("--set ")) words = joined(words, {"--set", option.substr(6) + "=" + value});
      if (option.starts_with("--") && !option.starts_with("--set ")) words = joined(words, {option, value});
    }
    return words;
  }

  /// The command must name both options, and leave all files as they are.
  void expect_refused(const Subcommand& command, const Typed& typed, const OptionRow& one, const OptionRow& other) {
    pairs++;
    const auto before = names_in(folder.path());
    try {
      (void)command.run(arguments(command.describe(), typed));
      ADD_FAILURE() << command.name << " " << testing::PrintToString(arguments(command.describe(), typed))
                    << " is not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
      EXPECT_THAT(error.what(), AllOf(HasSubstr(one.long_name() + " "), HasSubstr(other.long_name() + " "),
                                      ContainsRegex("would overwrite an input|name the same file")))
          << command.name << " " << testing::PrintToString(arguments(command.describe(), typed));
    }
    EXPECT_EQ(names_in(folder.path()), before);
    for (const bool is_of_frame : {false, true}) EXPECT_EQ(read_bytes(folder / read_by_all(is_of_frame)), kBytes);
  }

  /// Calls for every pair of options of every command that have these roles.
  void for_each_pair(const std::function<bool(FileRole, FileRole)>& are_wanted,
                     const std::function<void(const Subcommand&, const OptionRow&, const OptionRow&)>& call) {
    for (const auto& command : subcommands()) {
      const auto rows = rows_of(command.describe());
      for (const auto& one : rows)
        for (const auto& other : rows)
          if (&one != &other && are_wanted(one.role, other.role)) call(command, one, other);
    }
  }

  const std::string kBytes = "power = 1\n";  // also a preset
  TemporaryFolder folder;
  int pairs = 0;
};

bool is_written(FileRole role) { return role == FileRole::output || role == FileRole::report; }

TEST_F(Overwriting, every_option_that_reads_a_file_is_safe_from_every_one_that_writes) {
  for_each_pair([](FileRole one, FileRole other) { return one == FileRole::input && is_written(other); },
                [&](const Subcommand& command, const OptionRow& reads, const OptionRow& writes) {
                  for (const auto& stem : stems(reads.is_of_frame)) {
                    Typed typed = others(command.describe());
                    type(typed, reads, folder / (reads.is_of_frame ? "read.%d" : "read"));
                    type(typed, writes, stem);
                    expect_refused(command, typed, reads, writes);
                  }
                });
  // run has 19 that read and 6 that write; inspect, wedge, compare and bench have fewer
  EXPECT_GE(pairs, 4 * 19 * 6);
}

TEST_F(Overwriting, no_two_options_write_one_file) {
  for_each_pair([](FileRole one, FileRole other) { return is_written(one) && is_written(other); },
                [&](const Subcommand& command, const OptionRow& one, const OptionRow& other) {
                  if (one.key() == "debug" && other.key() == "output") return;  // which are beside each other
                  if (one.key() == "output" && other.key() == "debug") return;
                  Typed typed = others(command.describe());
                  type(typed, one, folder / "written");
                  type(typed, other, folder / "linked/./written");
                  expect_refused(command, typed, one, other);
                });
  EXPECT_GE(pairs, 6 * 5);
}

TEST(FileRoles, of_options_are_never_forgotten) {
  const std::regex file(R"(FILE|\.(exr|json|png|html|csv|toml)\b)");
  for (const auto& command : subcommands())
    for (const auto& row : command.describe().rows)
      if (!row.name.starts_with("-") || std::regex_search(row.value, file))
        EXPECT_NE(row.role, FileRole::none) << command.name << " " << row.name << " " << row.value;
  for (const auto& row : option_table())
    if (std::regex_search(row.value, file)) EXPECT_NE(row.role, FileRole::none) << row.name << " " << row.value;
}

// Runs that destroyed what they read.

class LostFiles : public SequenceFolder {
 protected:
  LostFiles() { write_frames(1, 3); }

  /// A command that must name both options and leave the file as it is.
  void expect_safe(const std::string& file, const Options& options, const Options& command) const {
    const std::string before = read_bytes(file);
    test::expect_refused(run_program(command), 2, options);
    EXPECT_TRUE(read_bytes(file) == before) << testing::PrintToString(command);
  }
  Options run_of(const Options& more) const { return joined({"run"}, arguments(more)); }
};

TEST_F(LostFiles, are_no_renders_that_the_outputs_of_other_frames_are_spelled_like) {
  fs::create_directory_symlink(in, folder / "renders");
  for (const std::string& name : {in + "/f.%04d.exr", in + "/./f.%04d.exr", folder / "renders/f.%04d.exr"})
    expect_safe(input(2), {"--output of frame 1", "INPUT " + input(2)},
                run_of({"-o", name, "--set", "output-offset=1"}));
}

TEST_F(LostFiles, are_no_frames_that_others_take_from) {
  for (const Options& takes : {Options{"--around", "1"}, {"--accumulate", "1"}, {}})  // each may be a run of its own
    expect_safe(input(2), {"--output of frame 1", "INPUT " + input(2)},
                run_of(joined(takes, {"--frames", "1", "-o", input(2)})));
}

TEST_F(LostFiles, are_no_outputs_of_other_frames) {
  fs::create_directories(folder / "ao.1");
  for (const char* other : {"ao.2", "ao.3"}) fs::create_directory_symlink(folder / "ao.1", folder / other);
  test::expect_refused(run_program(run_of({"-o", folder / "ao.%d/ao.exr"})), 2,
                       {"--output of frame 1 and --output of frame 2 name the same file"});
  EXPECT_TRUE(names_in(folder / "ao.1").empty());
}

TEST_F(LostFiles, are_none_of_a_chunk_without_frames) {
  const std::string preset = folder / "p.toml";
  write_bytes(preset, "power = 1\n");
  const Options chunk{"--chunk", "1/5"};  // chunks 2, 4 and 5 have the three frames
  ASSERT_EQ(run(chunk).code, 0);
  ASSERT_TRUE(names_in(out).empty());
  for (const char* report : {"--stats", "--log-json"}) {
    expect_safe(input(1), {report, "INPUT " + input(1)}, run_of(joined(chunk, {report, input(1)})));
    expect_safe(preset, {report, "--preset " + preset}, run_of(joined(chunk, {"--preset", preset, report, preset})));
  }
  expect_safe(input(1), {"--stats", "INPUT " + input(1)}, run_of(joined(chunk, {"--dry-run", "--stats", input(1)})));
}

TEST_F(LostFiles, are_no_files_that_inputs_name) {
  FrameFile file = wall_frame();
  for (const char* channel : {"00.r", "00.g", "00.b", "00.a"})
    file.planes[std::string("CryptoObject") + channel].assign(kWallWindow.pixels(), 0);
  file.attributes["cryptomatte/0123456/name"] = "CryptoObject";
  file.attributes["cryptomatte/0123456/hash"] = "MurmurHash3_32";
  file.attributes["cryptomatte/0123456/manif_file"] = "manifest.json";
  write_bytes(in + "/manifest.json", R"({"Hero":"3f800000"})");
  for (int frame = 1; frame <= 3; frame++) file.write(input(frame));
  expect_safe(in + "/manifest.json", {"--stats", "the manifest of"},
              run_of({"--matte-object", "Hero", "--stats", in + "/manifest.json"}));
  write_bytes(folder / "config.ocio", "none");
  const Launch with_ocio{.environment = {{"OCIO", folder / "config.ocio"}}};
  const Options shown{"--composite", out + "/c.%d.exr", "--preview", out + "/p.%d.png"};
  test::expect_refused(run_program(run_of(joined(shown, {"--stats", folder / "config.ocio"})), with_ocio), 2,
                       {"--stats", "the OCIO variable"});
}

}  // namespace
}  // namespace alcove::overwriting_test
