// The command line as an interface: help, misspelt words, presets and devices. What it refuses of inputs stands in
// bad_input_test.cpp, what a good run leaves behind in outputs_test.cpp.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "cli/options.h"
#include "core/base/error.h"

namespace alcove::command_line_test {
namespace {

using namespace test;

std::string config(const Options& more) {
  const Finished finished = run_well(joined({"run", "--print-config"}, more));
  EXPECT_THAT(finished.err, IsEmpty());
  return finished.out;
}

void expect_usage_error(const Options& arguments, const Options& texts) {
  SCOPED_TRACE(testing::PrintToString(arguments));
  expect_refused(run_program(arguments), 2, texts);
}

TEST_F(CommandLine, no_arguments_give_the_help_and_code_2) {
  const Finished finished = run_program({});
  EXPECT_EQ(finished.code, 2);
  EXPECT_THAT(finished.out + finished.err,
              AllOf(HasSubstr("Usage"), HasSubstr("run"), HasSubstr("presets"), HasSubstr("devices")));
}

TEST_F(CommandLine, help_and_version_give_code_0) {
  for (const char* arguments : {"--help", "run --help", "run -h", "presets --help", "devices -h"}) {
    const Finished finished = run_well(typed(arguments));
    EXPECT_THAT(finished.out, HasSubstr("Usage")) << arguments;
    EXPECT_THAT(finished.err, IsEmpty());
  }
  const Finished finished = run_well({"--version"});
  EXPECT_THAT(finished.out, testing::MatchesRegex("alcove [0-9]+\\.[0-9]+\\.[0-9]+\n.+, .+\nOpenEXR 3\\..+\n"));
}

TEST_F(CommandLine, help_of_run_shows_a_dozen_options_and_help_all_the_rest) {
  const std::string help = run_program({"run", "--help"}).out, all = run_program({"run", "--help-all"}).out;
  const auto options_in = [](const std::string& text) {
    return std::ranges::count_if(lines_of(text),
                                 [](const auto& line) { return line.starts_with("  -") && line[3] != ' '; });
  };
  EXPECT_THAT(help, AllOf(HasSubstr("Examples:"), HasSubstr("--radius"), HasSubstr("--output"), HasSubstr("--camera"),
                          HasSubstr("--help-all"), Not(HasSubstr("sample-kernel"))));
  EXPECT_LE(options_in(help), 16);
  for (const auto& row : option_table()) {
    if (row.is_only_key()) continue;
    EXPECT_THAT(all, HasSubstr(row.long_name()));
    if (row.is_common) EXPECT_THAT(help, HasSubstr(row.long_name()));
  }
  for (const char* text : {"=auto", "=1000000000", "=none", "=half", "--slices NUMBER=", "--seed NUMBER=0"})
    EXPECT_THAT(all, HasSubstr(text)) << "defaults";
  EXPECT_THAT(all, Not(HasSubstr("filter-width")));
  EXPECT_LE(options_in(all), 80);
  EXPECT_EQ(run_program({"compare", "--help"}).out, run_program({"compare", "--help-all"}).out);
}

TEST_F(CommandLine, help_of_a_command_is_what_its_option_prints) {
  EXPECT_EQ(run_program({"help"}).out, run_program({"--help"}).out);
  for (const char* command : {"run", "inspect", "wedge", "compare", "bench", "presets", "devices", "doctor"}) {
    const Finished finished = run_well({"help", command});
    EXPECT_EQ(finished.out, run_program({command, "--help"}).out) << command;
    EXPECT_THAT(finished.out, HasSubstr(command));
  }
}

TEST_F(CommandLine, an_input_without_a_command_is_run) {
  done();
  const std::string expected = read_bytes(ao);
  const Options options{"-o", ao, "--camera", camera, "--radius", "1"};
  for (const auto& arguments : {joined({frame}, options), joined(options, {frame})}) {
    fs::remove(ao);
    const Finished finished = run_well(arguments);
    EXPECT_EQ(read_bytes(ao), expected) << testing::PrintToString(arguments);
  }
  for (const std::string name : {"/none/shot.0001.EXR", "/none/shot.tif", "/none/shot.####", "/none/shot.$F4.exr"}) {
    const Finished finished = run_program(joined({name}, options));
    EXPECT_EQ(finished.code, 3) << finished;
    EXPECT_THAT(finished.err, HasSubstr("/none/")) << "not: there is no command";
  }
}

TEST_F(CommandLine, complaints_are_sentences_of_ours_and_name_the_nearest_words) {
  const std::string run = "run " + frame + " ";
  const std::pair<std::string, std::string> rows[] = {
      {run + "--radius",
       "--radius needs a value: auto|NUMBER[%][,NUMBER[%]...] (scene units, above 0 and at most 1e+18)"},
      {run + "--layer=", "--layer needs a value: NAME"},
      {run + "--radius -1", "--radius: -1 is out of range: above 0 and at most 1e+18"},
      {run + "--slices 65", "--slices: 65 is out of range: 1 to 64"},
      {run + "--slices 1,5", "--slices: 1,5 is no single number; decimals are written with a point"},
      {run + "--slices 1 --slices 2", "--slices is given more than once"},
      {run + "--set least 0.2", "--set least 0.2: did you mean --set least=0.2?"},
      {run + "--set denoise-kernel=1,,2", "--set denoise-kernel: \"\" is no weight of 0 or more"},
      {run + "shot.0002.exr",
       "shot.0002.exr: alcove run takes one INPUT; a sequence is one name with a pattern: write shot.####.exr"},
      {run + "shot.7.exr", "write shot.%d.exr"},
      {run + "shot12.exr", "write shot##.exr"},
      {run + "shot_3_beauty.exr", "write shot_%d_beauty.exr"},
      {run + "shot_1920x1080.exr", "shot_1920x1080.exr: alcove run takes one INPUT; see"},
      {run + "shot.0007_v002.exr", "write shot.####_v002.exr"},
      {run + "shot_V002.exr", "shot_V002.exr: alcove run takes one INPUT; see"},
      {run + "v2.exr", "v2.exr: alcove run takes one INPUT; see"},
      {run + "-- -x", "there is no option -x"},
      {run + "-o", "--output needs a value: FILE.exr"},
      {run + "--radis 1", "there is no option --radis (did you mean --radius"},
      {run + "-r 1", "there is no option -r (did you mean --resume or --radius?"},
      {run + "--preset prodction", "prodction (did you mean production?"},
      {run + "--falloff quadradic", "--falloff: quadradic"},
      {run + "--falloff quadradic", "did you mean quadratic?"},
      {run + "--set compression=zipp", "--set compression: zipp"},
      {run + "--set compression=zipp", "did you mean zip"},
      {run + "--depth-kind plannar", "did you mean planar?"},
      {"--radius 1", "--radius: name a command before it, such as run, or an input"},
      {"frame", "there is no command frame"},
      {"frame", "alcove FILE.exr"},
      {"rnu", "did you mean run?"},
      {"preset", "did you mean presets"},
      {"help rnu", "did you mean run?"},
      {"help run bench", "one command"},
      {"inspect " + frame + " --slcies 2", "there is no option --slcies (did you mean --slices?); see alcove inspect"},
      {"compare a.exr", "REFERENCE is missing: the reference"},
      {"compare a.exr b.exr c.exr", "c.exr: alcove compare takes one RESULT and one REFERENCE; see"},
      {"compare a.exr b.exr --max-rmse -1", "--max-rmse: -1 is out of range: 0 or more"},
      {"bench a.toml --repeats 1.5", "--repeats: 1.5 is no whole number"},
      {"bench a.toml --json", "--json needs a value: FILE.json"},
      {"bench a.toml --stability", "SUITE does not apply with --stability"},
      {"bench --stability --limits l.toml", "--limits does not apply with --stability"},
      {"devices first", "first: alcove devices takes options only"},
      {"devices --jsn", "there is no option --jsn (did you mean --json?"},
      {"presets standrad", "did you mean standard?"},
      {"presets draft standard", "standard: alcove presets takes one NAME; see alcove presets --help"},
  };
  for (const auto& [arguments, sentence] : rows) expect_usage_error(typed(arguments), {sentence});
}

TEST_F(CommandLine, hints_name_the_help_that_shows_the_option) {
  const std::pair<const char*, const char*> rows[] = {
      {"run --radius -1", "; see alcove run --help\n"},
      {"run --slices", "; see alcove run --help-all\n"},
      {"run --slices 65", "; see alcove run --help-all\n"},
      {"run --slcies 6", "; see alcove run --help-all\n"},
      {"inspect a.exr b.exr", "; see alcove inspect --help\n"},
      {"inspect --slices x", "; see alcove inspect --help-all\n"},
      {"compare a.exr b.exr --max-rmse -1", "; see alcove compare --help\n"},
  };
  for (const auto& [arguments, hint] : rows) expect_usage_error(typed(arguments), {hint});
}

TEST_F(CommandLine, numbers_out_of_range_name_option_and_range) {
  const std::pair<const char*, std::vector<std::string>> cases[] = {
      {"radius", {"0", "-1", "nan", "inf", "wide", "1e400", "", "1,", "1 2", "2e18", "-inf"}},
      {"fov", {"0", "180", "nan"}},
      {"slices", {"0", "65", "2.5"}},
      {"steps", {"0", "4097"}},
      {"falloff-start", {"1", "-0.1"}},
      {"power", {"0", "101"}},
      {"least", {"-0.1", "1.1"}},
      {"vertical-fov", {"0", "180"}},
      {"denoise-radius", {"0", "9", "1.5"}},
      {"denoise-kernel", {"1", "1,-1", "0,1", "1,,2", "1,x", "1,inf", "1,1,1,1,1,1,1,1,1,1"}},
      {"denoise-depth-sigma", {"-1", "101"}},
      {"intensity", {"-1", "inf"}},
      {"seed", {"-1", "4294967296", "0.5"}},
      {"sky", {"0"}},
      {"focal", {"0"}},
      {"aperture", {"-36"}},
      {"ortho-width", {"0"}},
      {"depth-scale", {"0", "-1"}},
      {"far", {"-1", "away"}},
      {"flip-normal", {"xx", "w"}},
      {"memory", {"0", "0.5", "-1G", "4X", "1000000000000000T"}},
      {"threads", {"-1", "1025"}}};
  for (const auto& [option, values] : cases)
    for (const auto& value : values) {
      RunOptions options;
      try {
        parse_run_options({frame, "-o", ao, "--set", std::string(option) + "=" + value}, options);
        ADD_FAILURE() << option << " " << value << " was accepted";
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_THAT(error.what(), HasSubstr(option));
      }
    }
}

TEST_F(CommandLine, presets_are_listed_and_printed) {
  const Finished list = run_well({"presets", "--json"});
  std::vector<std::string> names;
  for (const auto& preset : json::parse(list.out)) names.push_back(preset["name"]);
  EXPECT_THAT(names, IsSupersetOf({"draft", "production", "standard", "source/fp-asm", "input/arnold"}));
  for (const auto& name : names) {
    EXPECT_EQ(run_program({"presets", name}).out, read_bytes(ALCOVE_SOURCE_DIR "/presets/" + name + ".toml"));
    EXPECT_NE(config({"--preset", name}), "") << name;
  }
}

TEST_F(CommandLine, presets_of_a_show_come_before_those_of_the_user_and_ours_and_may_build_on_others) {
  fs::create_directories(folder / "show");
  fs::create_directories(folder / "home/alcove/presets");
  write_bytes(folder / "show/look.toml", "intensity = 0.5\npreset = \"draft\"\n");
  write_bytes(folder / "show/loop.toml", "preset = \"loop\"\n");
  write_bytes(folder / "home/alcove/presets/look.toml", "intensity = 0.75\n");
  const auto printed = [&](const std::string& preset, const std::string& path) {
    return run_program({"run", frame, "--print-config", "--preset", preset},
                       {.environment = {{"ALCOVE_PRESET_PATH", path}, {"XDG_CONFIG_HOME", folder / "home"}}});
  };
  const Finished show = printed("look", folder / "show");
  EXPECT_THAT(show.out, AllOf(HasSubstr("intensity=0.5\n"), HasSubstr("search=\"quick\"\n"))) << show;
  EXPECT_THAT(printed("look", "").out, HasSubstr("intensity=0.75\n"));
  EXPECT_THAT(printed("draft", folder / "show").out, HasSubstr("search=\"quick\"\n"));
  EXPECT_THAT(printed("look", folder / "missing:" + (folder / "show")).out, HasSubstr("intensity=0.5\n"))
      << "a folder that is not there is passed over";
  test::expect_refused(printed("loop", folder / "show"), 2, {"loop", "itself"});
  write_bytes(folder / "show/shot.toml", "preset = \"of-a-show.toml\"\n");
  write_bytes(folder / "show/of-a-show.toml", "intensity = 0.125\n");
  EXPECT_THAT(printed("shot", folder / "show").out, HasSubstr("intensity=0.125\n")) << "a file beside it";
  write_bytes(folder / "show/lost.toml", "preset = \"drift\"\n");
  test::expect_refused(printed("lost", folder / "show"), 2, {"lost (--preset): there is no preset drift"});
}

TEST_F(CommandLine, a_preset_that_names_its_own_name_builds_on_the_next_of_that_name) {
  fs::create_directories(folder / "show");
  fs::create_directories(folder / "home/alcove/presets");
  write_bytes(folder / "show/draft.toml", "intensity = 0.5\npreset = \"draft\"\n");
  const auto printed = [&] {
    const Launch launch{.environment = {{"ALCOVE_PRESET_PATH", folder / "show"}, {"XDG_CONFIG_HOME", folder / "home"}}};
    return run_well({"run", frame, "--print-config", "--preset", "draft"}, launch).out;
  };
  EXPECT_THAT(printed(), AllOf(HasSubstr("intensity=0.5\n"), HasSubstr("search=\"quick\"\n")));
  write_bytes(folder / "home/alcove/presets/draft.toml", "power = 2\npreset = \"draft\"\n");
  EXPECT_THAT(printed(), AllOf(HasSubstr("intensity=0.5\n"), HasSubstr("power=2\n"), HasSubstr("search=\"quick\"")));
}

TEST_F(CommandLine, the_base_of_a_preset_lies_beside_it_and_not_where_the_command_runs) {
  fs::create_directories(folder / "show");
  fs::create_directories(folder / "work");
  write_bytes(folder / "work/base.toml", "intensity = 0.5\n");
  write_bytes(folder / "show/look.toml", "preset = \"base.toml\"\n");
  const auto printed = [&](const std::string& preset) {
    return run_program({"run", frame, "--print-config", "--preset", preset},
                       {.folder = folder / "work", .environment = {{"ALCOVE_PRESET_PATH", folder / "show"}}});
  };
  test::expect_refused(printed(folder / "show/look.toml"), 2, {"show/base.toml", "--preset"});
  write_bytes(folder / "show/look.toml", "preset = '" + folder / "work/base.toml" + "'\n");
  EXPECT_THAT(printed("look").out, HasSubstr("intensity=0.5\n")) << "a whole path";
  write_bytes(folder / "show/draft.toml", "intensity = 0.5\npreset = \"Draft\"\n");
  EXPECT_THAT(printed("draft").out, AllOf(HasSubstr("intensity=0.5\n"), HasSubstr("search=\"quick\"\n")));
}

TEST_F(CommandLine, a_folder_that_looks_like_a_pattern_makes_none_of_a_file) {
  for (const std::string name : {"a#b", "v%04d"}) {
    fs::create_directories(folder / name);
    write_bytes(folder / (name + "/look.toml"), "output = \"ao.exr\"\n");
    const Finished preset = run_program({"run", frame, "--preset", folder / (name + "/look.toml"), "--print-config"});
    test::expect_refused(preset, 2, {"--output ao.exr", name, "rename"});
    const Options words{"run", frame, "-o", "ao.####.exr", "--print-config"};
    test::expect_refused(run_program(words, {.folder = folder / name}), 2, {"--output ao.####.exr", name, "rename"});
  }
}

TEST_F(CommandLine, a_printed_path_leads_through_the_same_links) {
  EXPECT_THAT(run_program({"run", frame, "--camera", "l/../cam.json", "--print-config"}, {.folder = folder.path()}).out,
              HasSubstr("/l/../cam.json\""));
}

TEST_F(CommandLine, a_wedge_writes_over_no_preset_that_another_one_builds_on) {
  write_bytes(folder / "base.html", "intensity = 0.5\n");
  write_bytes(folder / "look.toml", "preset = \"base.html\"\n");
  const std::string presets = "draft," + (folder / "look.toml");  // the first look has no base
  const Options words{"wedge", frame,      "--camera", camera, "--radius",
                      "1",     "--preset", presets,    "-o",   folder / "base.html"};
  test::expect_refused(run_program(words), 2, {"--output", "base.html", "--preset"});
}

TEST_F(CommandLine, files_of_a_preset_and_of_a_project_lie_beside_it) {
  fs::create_directories(folder / "shots/010");
  fs::copy_file(frame, folder / "shots/010/frame.exr");
  fs::copy_file(camera, folder / "shots/show.json");
  write_bytes(folder / "shots/alcove.toml", "camera = \"show.json\"\nradius = 1\noutput = \"010/ao.exr\"\n");
  for (const Options& words : {Options{"--project"}, Options{"--preset", folder / "shots/alcove.toml"}}) {
    fs::remove(folder / "shots/010/ao.exr");
    const Finished finished =
        run_well(joined({"run", folder / "shots/010/frame.exr", "--log-json", folder / "log.json"}, words),
                 {.folder = folder / "shots/010"});
    EXPECT_THAT(finished.err, HasSubstr("alcove: settings of " + (folder / "shots/alcove.toml") + "\n"));
    EXPECT_TRUE(fs::exists(folder / "shots/010/ao.exr"));
    const json begin = json::parse(lines_of(read_bytes(folder / "log.json")).front());
    EXPECT_THAT(begin["presets"], ElementsAre(folder / "shots/alcove.toml"));
  }
  EXPECT_THAT(done({"--preset", "draft"}).err, Not(HasSubstr("settings of"))) << "one of the program's";
  write_bytes(folder / "shots/alcove.toml", "camera = \"lost.json\"\nradius = 1\n");
  const Options lost{"run", folder / "shots/010/frame.exr", "-o", ao, "--project"};
  test::expect_refused(run_program(lost), 3, {"lost.json", "--camera is of " + (folder / "shots/alcove.toml")});
}

TEST_F(CommandLine, a_project_has_settings_of_its_own_where_they_are_asked_for) {
  fs::create_directories(folder / "shots/010");
  const std::string shot = folder / "shots/010/frame.exr";
  write_bytes(folder / "shots/alcove.toml", "intensity = 0.25\n");
  const auto printed = [&](const Options& more) {
    return run_program(joined({"run", shot, "--print-config"}, more)).out;
  };
  EXPECT_THAT(printed({"--project"}), HasSubstr("intensity=0.25\n"));
  EXPECT_THAT(printed({"--project", "--intensity", "0.5"}), HasSubstr("intensity=0.5\n"));
  EXPECT_THAT(printed({}), HasSubstr("intensity=1\n")) << "nothing is read that nobody named";
  fs::create_directories(folder / "elsewhere");
  write_bytes(folder / "elsewhere/alcove.toml", "intensity = 0.75\n");
  const Options above{"run", "../shots/010/frame.exr", "--print-config", "--project"},
      own{"run", "../frame.exr", "--print-config", "--project"};
  const Launch from{.folder = folder / "elsewhere"};
  EXPECT_THAT(run_program(above, from).out, HasSubstr("intensity=0.25\n"));
  test::expect_refused(run_program(own, from), 2, {"--project", "../frame.exr"});
  test::expect_refused(run_program({"run", frame, "--print-config", "--project"}), 2, {"--project", frame});
}

TEST_F(CommandLine, settings_that_are_shared_name_no_files_frames_and_cameras) {
  const Options words{"run",    frame, "-o",           ao,       "--camera",  camera, "--radius",      "2",
                      "--near", "1",   "--depth-kind", "device", "--threads", "3",    "--print-config"};
  EXPECT_THAT(run_program(words).out, AllOf(HasSubstr("output="), HasSubstr("camera="), HasSubstr("near=")));
  const std::string shared = run_program(joined(words, {"--shareable"})).out;
  EXPECT_THAT(shared, AllOf(HasSubstr("radius=2\n"), Not(HasSubstr("slices="))));
  for (const char* key : {"output=", "camera=", "\nnear=", "threads="}) EXPECT_THAT(shared, Not(HasSubstr(key)));
  test::expect_refused(run_program({"run", frame, "--shareable"}), 2, {"--shareable", "--print-config"});
}

TEST_F(CommandLine, presets_are_listed_with_what_each_is_for_ours_first_and_inputs_last) {
  const Finished finished = run_well({"presets"});
  const auto place = [&](const char* text) {
    EXPECT_THAT(finished.out, HasSubstr(text));
    return finished.out.find(text);
  };
  EXPECT_LT(place("\n  draft "), place("\n  standard "));
  EXPECT_LT(place("\n  production "), place("\n  reference "));
  EXPECT_LT(place("\n  reference "), place("to match their frames"));
  EXPECT_LT(place("to match their frames"), place("\n  source/fp-asm "));
  EXPECT_LT(place("\n  source/taos-quality "), place("\n  input/3delight "));
  for (const auto& preset : json::parse(run_program({"presets", "--json"}).out)) {
    EXPECT_NE(preset["sentence"], "") << preset["name"];
    EXPECT_THAT(finished.out, HasSubstr(preset["sentence"].get<std::string>()));
    EXPECT_TRUE(fs::exists(preset["file"].get<std::string>()));
  }
  EXPECT_EQ(preset_sentence("# Blender 2.8. Old.\nx = 1\n"), "Blender 2.8");
  EXPECT_EQ(preset_sentence("x = 1\n# What.\n"), "");
}

TEST_F(CommandLine, standard_is_what_no_preset_gives) {
  EXPECT_EQ(config({"--preset", "standard"}), config({}));
  EXPECT_NE(config({"--preset", "draft"}), config({}));
  EXPECT_NE(config({"--preset", "production"}), config({}));
}

TEST_F(CommandLine, later_presets_win_and_options_win_over_presets) {
  EXPECT_EQ(config({"--preset", "draft", "--preset", "production"}), config({"--preset", "production"}));
  write_bytes(folder / "first.toml", "radius = 2\nslices = 5\n");
  write_bytes(folder / "second.toml", "slices = 7\n");
  const std::string both = config({"--preset", folder / "first.toml", "--preset", folder / "second.toml"});
  EXPECT_THAT(lines_of(both), AllOf(Contains("radius=2"), Contains("slices=7")));
  for (const auto& arguments :
       {std::vector<std::string>{"--slices", "9", "--preset", "draft"}, {"--preset", "draft", "--slices", "9"}})
    EXPECT_THAT(lines_of(config(arguments)), Contains("slices=9"));
}

TEST_F(CommandLine, printed_config_is_a_preset_that_gives_itself) {
  const std::string preset = folder / "printed.toml", odd_name = "a b/\"cam\" = ü.json";
  const Options odd = joined(
      {"--camera", odd_name, "-o", "out put.exr"},
      typed("--radius 0.1234567890123 --falloff smooth --set falloff-start=0.25 --seed 4294967295 --sky 1e10 --device "
            "cpu --set require-gpu=true --set denoise-kernel=0.5,0.25,0.125 -v "
            "--normal-channels a.X,b.Y,c.Z --type float --preset draft"));
  EXPECT_THAT(config(odd), AllOf(HasSubstr(odd_name), HasSubstr("0.1234567890123"), HasSubstr("out put.exr"),
                                 HasSubstr("a.X,b.Y,c.Z"), HasSubstr("0.5,0.25,0.125"), HasSubstr("require-gpu")));
  for (const Options& options :
       {odd, Options(), typed("-v -v"), typed("--accumulate 4 --radius 0.5"), typed("--preset reference --radius 2")}) {
    const std::string printed = config(options);
    write_bytes(preset, printed);
    EXPECT_EQ(config({"--preset", preset}), printed) << testing::PrintToString(options);
  }
}

TEST_F(CommandLine, a_hash_within_a_name_begins_no_comment_of_a_preset) {
  write_bytes(folder / "shot.toml", "camera = \"shot #1.json\"  # the first\n");
  EXPECT_THAT(lines_of(config({"--preset", folder / "shot.toml"})),
              Contains("camera=\"" + (folder / "shot #1.json") + "\""));
}

TEST_F(CommandLine, a_file_in_the_working_directory_is_not_taken_for_a_preset_of_that_name) {
  write_bytes(folder / "production", "slices = 1\n");
  const Finished finished =
      run_program({"run", "--preset", "production", "--print-config"}, {.folder = folder.path(), .environment = {}});
  EXPECT_EQ(finished.out, config({"--preset", "production"})) << finished;
}

TEST_F(CommandLine, a_switch_that_a_preset_turns_off_is_off) {
  write_bytes(folder / "on.toml", "no-mkdir = false\nrequire-gpu = false\nvalidate = false\nquiet = false\n");
  done({"--preset", folder / "on.toml", "--preview", folder / "new/ao.png"});
  EXPECT_TRUE(fs::exists(folder / "new/ao.png")) << "no-mkdir = false makes folders";
  EXPECT_EQ(run({"--set", "no-mkdir=true", "--preview", folder / "newer/ao.png"}).code, 4);
}

TEST_F(CommandLine, presets_of_another_folder_have_their_path_as_name) {
  fs::create_directories(folder / "presets/show");
  write_bytes(folder / "presets/show/day.toml", "slices = 11\n");
  write_bytes(folder / "elsewhere.toml", "slices = 13\n");
  fs::create_symlink(folder / "elsewhere.toml", folder / "presets/linked.toml");
  const Launch launch{.environment = {{"ALCOVE_PRESETS", folder / "presets"}}};
  const json listed = json::parse(run_program({"presets", "--json"}, launch).out);
  ASSERT_EQ(listed.size(), 2);
  EXPECT_EQ(listed[0]["name"], "linked");
  EXPECT_EQ(listed[1]["name"], "show/day");
  EXPECT_THAT(lines_of(run_program({"run", "--preset", "linked", "--print-config"}, launch).out),
              Contains("slices=13"));
  EXPECT_THAT(lines_of(run_program({"run", "--preset", "show/day", "--print-config"}, launch).out),
              Contains("slices=11"));
}

TEST_F(CommandLine, devices_are_listed_as_text_and_json) {
  const Finished text = run_well({"devices"}), finished = run_well({"devices", "--json"});
  const json devices = json::parse(finished.out);
  EXPECT_EQ(lines_of(text.out).size(), devices.size());
  ASSERT_FALSE(devices.empty());
  for (const auto& device : devices) {
    for (const char* field :
         {"index", "name", "type", "uuid", "driver", "api_version", "memory_bytes", "buffer_bytes", "usable"})
      EXPECT_TRUE(device.contains(field)) << field;
    EXPECT_THAT(text.out, HasSubstr(device["name"].get<std::string>()));
  }
  const std::string uuid = devices[0]["uuid"], name = devices[0]["name"];
  for (const std::string& choice : {std::string("0"), uuid, name})
    EXPECT_EQ(run({"--device", choice}).code, 0) << choice;
}

TEST_F(CommandLine, doctor_tells_what_a_report_needs) {
  const Finished text = run_well({"doctor"}), finished = run_well({"doctor", "--json"});
  const json facts = json::parse(finished.out), devices = json::parse(run_program({"devices", "--json"}).out);
  EXPECT_EQ(facts["devices"], devices);
  EXPECT_THAT(facts["problems"], IsEmpty());
  EXPECT_EQ("alcove " + facts["version"].get<std::string>(), lines_of(run_program({"--version"}).out)[0]);
  EXPECT_THAT(facts["presets"].get<std::string>(), StartsWith(std::string(ALCOVE_SOURCE_DIR "/presets, ")));
  EXPECT_THAT(facts["memory"].get<std::string>(), Not(HasSubstr("0000000")));
  for (const auto& fact : facts.items())
    if (fact.value().is_string()) EXPECT_THAT(text.out, HasSubstr(fact.key())) << fact.key();
}

TEST_F(CommandLine, doctor_tells_what_is_amiss) {
  const Finished without_device =
      run_program({"doctor"}, {.environment = {{"VK_DRIVER_FILES", "/none"}, {"VK_ICD_FILENAMES", "/none"}}});
  EXPECT_EQ(without_device.code, 5) << without_device;
  EXPECT_THAT(without_device.out,
              AllOf(HasSubstr("problem "), HasSubstr("lavapipe"), HasSubstr("VK_DRIVER_FILES=/none")));
  const Finished without_presets = run_program({"doctor"}, {.environment = {{"ALCOVE_PRESETS", "/none"}}});
  EXPECT_EQ(without_presets.code, 5) << without_presets;
  EXPECT_THAT(without_presets.out, AllOf(HasSubstr("problem "), HasSubstr("no folder of presets at /none")));
  const Finished limited =
      run_program({"doctor"}, {.environment = {{"SLURM_JOB_ID", "7"}, {"SLURM_MEM_PER_NODE", "2048"}}});
  EXPECT_THAT(limited.out, HasSubstr("asked of Slurm: 2.0 GiB"));
}

}  // namespace
}  // namespace alcove::command_line_test
