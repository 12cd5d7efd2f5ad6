// How commands end that cannot do what they are asked: standard streams that nobody takes, reports that would overwrite
// inputs, presets, suites and limits that make no sense, devices and modules that are not there. Refused frames:
// bad_input_test.cpp.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"

namespace alcove::refusals_test {
namespace {

using namespace test;

void expect_failure(int code, const Options& texts, const Options& arguments, const Launch& launch = {}) {
  SCOPED_TRACE(testing::PrintToString(arguments));
  test::expect_refused(run_program(arguments, launch), code, texts);
}

// The standard streams.

TEST(StandardOutput, that_is_full_ends_with_4_however_much_is_said) {
  for (const char* arguments : {"--version", "run --help", "run --help-markdown", "presets", "devices"})
    expect_failure(4, {"standard output"}, typed(arguments), {.out = "/dev/full"});
}

using Streams = SequenceFolder;

TEST_F(Streams, an_error_stream_that_is_full_changes_nothing_else) {
  write_frames(1, 2);
  const Launch full{.err = "/dev/full"};
  done({}, full);
  EXPECT_THAT(names_in(out), ElementsAre("ao.0001.exr", "ao.0002.exr"));
  done({"--progress", "bar"}, full);
  EXPECT_EQ(run({"--radius", "-1"}, full).code, 2);
}

TEST_F(Streams, progress_and_a_log_that_nobody_takes_end_with_4_and_leave_whole_files) {
  write_frames(1, 2);
  done();
  const auto whole = outputs();
  remove_outputs();
  for (const auto& [more, stream] :
       {std::pair("--progress percent", "standard output"), {"--log-json -", "--log-json"}}) {
    const Finished finished = run(typed(more), {.out = "/dev/full"});
    EXPECT_EQ(finished.code, 4) << finished;
    EXPECT_THAT(finished.err, HasSubstr(stream));
    for (const auto& [name, bytes] : outputs()) EXPECT_TRUE(whole.contains(name) && whole.at(name) == bytes) << name;
  }
}

TEST_F(Streams, a_log_on_a_full_disk_ends_with_4) {
  write_frames(1, 2);
  const std::string disk = folder / "disk";
  fs::create_directory(disk);
  if (!mount_memory(disk, "size=4k")) GTEST_SKIP() << "this process may not mount";
  write_bytes(disk + "/ballast", std::string(4096, 'x'));
  expect_refused(4, {"--log-json", disk + "/log"}, {disk + "/log", "No space", "--log-json"});
  unmount(disk);
}

TEST_F(Streams, a_log_whose_disk_gets_full_ends_with_4_once_all_frames_are_whole) {
  constexpr int kFrames = 40;  // whose events are longer than the page that is left
  write_frames(1, kFrames);
  const std::string disk = folder / "disk";
  fs::create_directory(disk);
  if (!mount_memory(disk, "size=8k")) GTEST_SKIP() << "this process may not mount";
  write_bytes(disk + "/ballast", std::string(4096, 'x'));
  const Finished finished = run({"--log-json", disk + "/log"});
  EXPECT_EQ(finished.code, 4) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("40 frames done"), HasSubstr(disk + "/log"), HasSubstr("No space")));
  EXPECT_EQ(outputs().size(), std::size_t(kFrames));
  EXPECT_THAT(read_bytes(disk + "/log"), StartsWith("{\"event\":\"begin\""));
  unmount(disk);
}

// Reports and inputs.

TEST_F(Streams, no_report_overwrites_a_file_of_any_frame) {
  write_frames(1, 3);
  done();
  const std::string camera_before = read_bytes(camera), input_before = read_bytes(input(3)),
                    output_before = read_bytes(output(3));
  for (const char* option : {"--stats", "--log-json"})
    for (const std::string& path : {camera, input(1), input(3), output(1), output(3)}) {
      const Finished finished = run({option, path});
      EXPECT_EQ(finished.code, 2) << path << finished;
      EXPECT_THAT(finished.err, AllOf(HasSubstr(path), HasSubstr(option),
                                      ContainsRegex("would overwrite an input|name the same file")));
    }
  EXPECT_EQ(run({"--stats", folder / "one", "--log-json", folder / "one"}).code, 2);
  EXPECT_EQ(read_bytes(camera), camera_before);
  EXPECT_TRUE(read_bytes(input(3)) == input_before && read_bytes(output(3)) == output_before);
}

TEST_F(Streams, two_outputs_that_are_one_file_in_a_later_frame_are_refused) {
  FrameFile file = wall_frame();
  add_beauty(file);
  write_frames(9, 10, file);
  expect_refused(2, {"-o", out + "/a.%d.exr", "--composite", out + "/a.%02d.exr"},
                 {"a.10.exr", "--output", "--composite"});
  EXPECT_TRUE(names_in(out).empty());
}

class Refusals : public CommandLine {
 protected:
  /// Runs with each row's options must be refused with code 2 and the row's texts, and leave nothing.
  using Row = std::pair<std::string, Options>;
  void expect_rows_refused(const std::vector<Row>& rows) const {
    const auto before = names_in(folder.path());
    for (const auto& [more, texts] : rows) expect_refused(2, typed(more), texts);
    EXPECT_EQ(names_in(folder.path()), before);
  }
};

TEST_F(Refusals, a_log_of_a_run_that_is_refused_stays_as_it_was) {
  write_bytes(folder / "log", "before");
  EXPECT_EQ(run({"--log-json", folder / "log", "--aov", "nosuch"}).code, 2);
  EXPECT_EQ(run({"--log-json", folder / "log", "--depth", folder / "missing.%04d.exr"}).code, 3);
  EXPECT_EQ(read_bytes(folder / "log"), "before");
  done({"--log-json", folder / "log"});
  EXPECT_THAT(read_bytes(folder / "log"), StartsWith("{\"event\":\"begin\""));
}

TEST_F(Refusals, reports_of_bench_overwrite_nothing_that_the_suite_names) {
  const std::string before = read_bytes(frame), camera_before = read_bytes(camera);
  const std::string suite = folder / "suite.toml";
  write_bytes(suite, R"(title = "x"
[[frame]]
name = "wall"
input = "wall.0042.exr"
camera = "camera.json"
radius = 1
truth = "wall.0042.exr"
[[candidate]]
name = "draft"
preset = "draft"
)");
  for (const std::string& path : {frame, camera})
    for (const char* option : {"--json", "--csv", "--report"})
      expect_failure(2, {path, option, "overwrite"}, {"bench", suite, option, path});
  expect_failure(4, {folder / "none/x", "--csv"}, {"bench", suite, "--csv", folder / "none/x"});
  EXPECT_TRUE(read_bytes(frame) == before);
  EXPECT_EQ(read_bytes(camera), camera_before);
}

// Settings that contradict each other, or the frame.

TEST_F(Refusals, settings_that_contradict_each_other_name_what_mends_them) {
  expect_rows_refused({
      {"--tolerance 0.1 --resolution half", {"--tolerance", "--resolution full"}},
      {"--aov ao,error", {"--aov error", "--tolerance"}},
      {"--search exact --set debug=tiles", {"--set debug=tiles", "--search steps"}},
      {"--search quick --set debug=tiles", {"--set debug=tiles", "a quick search", "--search steps"}},
      {"--search quick --set debug=completed", {"--set debug=completed", "a quick search", "--search steps"}},
      {"--falloff linear --set falloff-start=0.5 --set falloff-end=0.4",
       {"--set falloff-end=0.4", "--set falloff-start=0.5"}},
      {"--set stride=4 --denoise none", {"--set stride", "--denoise bilateral", "that is none"}},
      {"--set bias=1", {"--set bias=1", "below 1"}},
      {"--aov bent-normal --estimator crytek", {"--aov bent-normal", "--estimator crytek", "gtao"}},
      {"--aov ao,cavity --set ignore=hero", {"--aov cavity", "--set ignore", "a run of its own"}},
      {"--radius 1", {"--radius 1 is there twice"}},
      {"--radius 2,3,4,5,6,7,8,9", {"--radius", "at most 8"}},
      {"--set fade-start=2 --set fade-end=2", {"--set fade-end=2", "--set fade-start=2"}},
      {"--depth " + frame + " --position " + frame, {"--depth", "--position is given", "only one of them"}},
      {"--aov transfer --estimator hbao", {"--aov transfer", "--estimator hbao", "gtao"}},
      {"--thickness -1", {"--thickness", "-1 is neither auto nor infinite"}},
      {"--thickness inf", {"--thickness", "inf is neither"}},
      {"--set albedo=2 --set multi-bounce=true", {"--set albedo", "0 to 1"}},
      {"--set denoise-kernel=1", {"--set denoise-kernel", "not 2 to 9"}},
      {"--set denoise-kernel=0,1", {"--set denoise-kernel", "no weight at the centre"}},
      {"--set denoise-kernel=1,x", {"--set denoise-kernel", "x is no weight"}},
      {"--source bledner", {"--source", "bledner"}},
      {"--set missing=hold", {"--set missing"}},
      {"--progress loud", {"--progress"}},
      {"--frames 1-x", {"--frames"}},
      {"--aov hidden", {"--aov hidden", "--behind", "--around"}},
      {"--set debug=hidden", {"--set debug=hidden", "--behind"}},
      {"--set debug=count", {"--accumulate"}},
  });
  for (const char* chunk : {"0/2", "3/2", "2", "a/b"})
    expect_rows_refused({{std::string("--chunk ") + chunk, {"--chunk"}}});
  for (const char* roi : {"0,0,8", "0,0,0,5", "a,b,c,d", "1,2,3,4,5", "1.5,2,3,4"})
    expect_rows_refused({{std::string("--roi ") + roi, {"--roi", "X,Y,WIDTH,HEIGHT"}}});
  for (const char* roi : {"100,0,8,8", "0,0,65,10", "-1,0,5,5", "60,30,4,7", "2147483647,0,2147483647,1"})
    expect_rows_refused({{std::string("--roi ") + roi, {frame, "--roi", "data window"}}});
  for (const auto& [roi, said] : {std::pair("2147483647,0,2147483647,5", "--roi is 2147483647x5 at (2147483647, 0)"),
                                  {"0,-2147483647,4,5", "--roi is 4x5 at (0, -2147483647)"}})
    expect_rows_refused({{std::string("--roi ") + roi, {said}}});
}

TEST_F(Refusals, outputs_that_the_frame_has_nothing_for_name_what_gives_it) {
  FrameFile plain = wall_frame(), positions;
  plain.erase("Normal");
  plain.write(folder / "plain.exr");
  for (const char* axis : {"X", "Y", "Z"})
    positions.planes[std::string("Position.") + axis] = std::vector<float>(kWallWindow.pixels(), -2.0f);
  positions.write(folder / "positions.exr");
  const std::tuple<int, const char*, const char*, Options> rows[] = {
      {3, "plain.exr", "--set debug=reconstruction", {"--set debug=reconstruction", "--normal"}},
      {3, "plain.exr", "--aov normal --set aov-space=world", {"--set aov-space=world", "world_to_camera", "--camera"}},
      {3, "positions.exr", "--set debug=raw-depth", {"--set debug=raw-depth", "--depth-channel"}},
      {2, "positions.exr", "--set position-space=world", {"world_to_camera", "--camera", "--set position-space=view"}},
      {2, "plain.exr", "--depth-kind device", {"device", "--near"}},
      {2, "plain.exr", "--depth-kind log", {"log", "--far"}},
      {2, "plain.exr", "--depth-kind device --near 2 --far 1", {"--near 2", "--far 1"}}};
  for (const auto& [code, input, more, texts] : rows)
    expect_failure(code, joined(texts, {folder / input}),
                   joined({"run", folder / input, "-o", ao, "--radius", "1", "--fov", "60"}, typed(more)));
  EXPECT_FALSE(fs::exists(ao));
}

TEST_F(Refusals, folders_of_presets_and_layers_that_are_not_there) {
  expect_failure(2, {folder / "none", "ALCOVE_PRESETS"}, {"presets"},
                 {.environment = {{"ALCOVE_PRESETS", folder / "none"}}});
  expect_refused(5, {"--validate"}, {"--validate", "vulkan-validationlayers"},
                 {.environment = {{"VK_LAYER_PATH", folder / "none"}}});
  EXPECT_FALSE(fs::exists(ao));
}

// Presets.

TEST_F(Refusals, presets_that_make_no_sense_are_named_with_line_and_key) {
  const std::string preset = folder / "my.toml";
  const std::pair<const char*, Options> rows[] = {
      {"radius = {a = 1}\n", {"line 1", "radius must be"}},
      {"\nradius = [1, [2]]\n", {"line 2", "radius must be"}},
      {"radius = 1979-05-27\n", {"line 1", "radius must be"}},
      {"radius = -1\n", {"radius"}},
      {"[steps]\na = 1\n", {"line 1", "steps must be"}},
      {"steps = 1.5\n", {"--steps", "1.5"}},
      {"steps = true\n", {"--steps", "true is not a number"}},
      {"steps = [1, 2]\n", {"steps takes one value, and the list has 2"}},
      {"steps = []\n", {"steps: the list is empty"}},
      {"keep-going = \"perhaps\"\n", {"--keep-going", "perhaps"}},
      {"steps = \n", {"line 1"}},
      {"denoise = \"boxx\"\n", {"--denoise", "boxx", "did you mean box"}},
      {"slcies = 2\n", {"there is no setting slcies", "did you mean slices"}},
      {"dry-run = true\n", {"dry-run is an option of the command line only"}},
      {"preset = [\"standard\", \"draft\"]\n", {"preset takes one name"}},
  };
  for (const auto& [text, texts] : rows) {
    write_bytes(preset, text);
    expect_refused(2, {"--preset", preset}, joined(texts, {preset, "--preset"}));
  }
  for (const std::string& none : {folder / "missing.toml", folder.path()})
    expect_refused(2, {"--preset", none}, {none, "--preset"});
  EXPECT_FALSE(fs::exists(ao));
}

TEST_F(Refusals, a_preset_or_a_camera_on_a_disk_that_fails_ends_with_3) {
  const std::string failing = "/proc/self/mem";  // nothing can be read at its beginning
  expect_refused(3, {"--preset", failing}, {failing, "--preset", "cannot be read"});
  expect_failure(3, {failing, "cannot be read"}, {"presets", failing});
  expect_failure(3, {failing, "--camera", "cannot be read"},
                 {"run", frame, "-o", ao, "--camera", failing, "--radius", "1"});
  expect_failure(3, {failing, "SUITE", "cannot be read"}, {"bench", failing});
}

// Suites and limits.

class Suites : public CommandLine {
 protected:
  /// A suite of the frame, with other text for one of its parts.
  std::string suite_with(const std::string& part, const std::string& text) const {
    std::map<std::string, std::string> parts{{"top", "title = \"x\"\nrepeats = 1\nreference-slices = 0\n"},
                                             {"frame", kFrame + "radius = 1\ntruth = \"ao.exr\"\n"},
                                             {"candidate", "[[candidate]]\nname = \"draft\"\npreset = \"draft\"\n"}};
    parts[part] = text;
    write_bytes(folder / "suite.toml", parts["top"] + parts["frame"] + parts["candidate"]);
    return folder / "suite.toml";
  }
  const std::string kFrame = "[[frame]]\nname = \"wall\"\ninput = \"wall.0042.exr\"\ncamera = \"camera.json\"\n";
};

TEST_F(Suites, of_the_wrong_types_are_refused_by_file_table_and_key) {
  const std::string candidate = "[[candidate]]\nname = \"a\"\n";
  const std::tuple<const char*, std::string, Options> rows[] = {
      {"top", "title = 3\n", {"\"title\"", "must be a string"}},
      {"top", "title = \"x\"\nrepeats = 0\n", {"\"repeats\"", "whole number"}},
      {"top", "title = \"x\"\nrepeats = \"many\"\n", {"\"repeats\"", "whole number"}},
      {"top", "title = \"x\"\nreference-slices = -1\n", {"\"reference-slices\""}},
      {"top", "title = \"x\"\nrepaets = 1\n", {"repaets", "did you mean repeats"}},
      {"top", "title = \"x\n", {"line 1"}},
      {"frame", "", {"there is no [[frame]]"}},
      {"frame", "frame = 1\n", {"[[frame]] must be a list of tables"}},
      {"frame", "frame = [1]\n", {"[[frame]] must be a list of tables"}},
      {"frame", kFrame + "radius = 0\ntruth = \"ao.exr\"\n", {"[[frame]] 1", "\"radius\"", "above 0"}},
      {"frame", kFrame + "radius = \"1\"\ntruth = \"ao.exr\"\n", {"\"radius\"", "above 0"}},
      {"frame", kFrame + "radius = inf\ntruth = \"ao.exr\"\n", {"\"radius\"", "above 0"}},
      {"frame", kFrame + "radius = 1\n", {"frame wall has no \"truth\""}},
      {"frame", kFrame + "radius = 1\ntruth = []\n", {"\"truth\"", "one file or two"}},
      {"frame", kFrame + "radius = 1\ntruth = [1]\n", {"\"truth\"", "one file or two"}},
      {"frame", kFrame + "radius = 1\ntruth = [\"a\", \"b\", \"c\"]\n", {"\"truth\"", "one file or two"}},
      {"candidate", "", {"there is no [[candidate]]"}},
      {"candidate", candidate + candidate, {"two candidates are called a"}},
      {"candidate", candidate + "slices = [1, 2]\n", {"[[candidate]] 1", "\"slices\"", "a string, a number or true"}},
      {"candidate", candidate + "no-skip = false\n", {"\"no-skip\"", "a string, a number or true"}},
      {"candidate", "[[sweep]]\nslices = []\n", {"[[sweep]] 1", "\"slices\"", "must not be empty"}},
      {"candidate", "[[sweep]]\nslices = [{a = 1}]\n", {"[[sweep]] 1", "\"slices\""}},
  };
  for (const auto& [part, text, texts] : rows) {
    const std::string suite = suite_with(part, text);
    expect_failure(3, joined(texts, {suite}), {"bench", suite});
  }
  const std::pair<const char*, Options> candidates[] = {
      {"slcies = 2", {"slcies", "did you mean slices"}},
      {"slices = 65", {"slices", "65"}},
      {"preset = \"drat\"", {"drat", "did you mean draft"}},
      {"help = true", {"alcove run"}},
      {"tolerance = 0.1\nestimator = \"hbao\"", {"tolerance", "gtao"}},
      {"radius = \"auto\"", {"--radius auto", "of its truth"}},
      {"stride = \"4\"\ndenoise = \"none\"", {"--set stride", "--denoise bilateral"}}};
  for (const auto& [text, texts] : candidates)
    expect_failure(2, joined(texts, {"suite.toml", "candidate a"}),
                   {"bench", suite_with("candidate", candidate + text + "\n")});
}

TEST_F(Suites, limits_that_fit_no_candidate_are_refused_before_anything_is_measured) {
  done();
  const std::string suite = suite_with("", ""), limits = folder / "limits.toml";
  const auto limit = [](const char* frame, const char* candidate, const char* measure) {
    return fmt::format("[[limit]]\nframe = \"{}\"\ncandidate = \"{}\"\n{}\n", frame, candidate, measure);
  };
  const std::tuple<int, std::string, Options> rows[] = {
      {3, "", {"there is no [[limit]]", "--limits"}},
      {3, limit("wall", "draft", ""), {"there is no [[limit]]", "--limits"}},
      {3, limit("wall", "draft", "rms = 1"), {"rms", "did you mean"}},
      {3, limit("wall", "draft", "rmse = \"x\""), {"\"rmse\"", "above 0"}},
      {2, limit("wall", "draft", "estimator-rmse = 1"), {"estimator-rmse", "--reference-slices", "--limits"}},
      {3, limit("wal", "draft", "rmse = 1"), {"no frame wal", "did you mean wall", "--limits"}},
      {3, limit("wall", "drft", "rmse = 1"), {"no candidate drft", "did you mean draft", "--limits"}},
  };
  for (const auto& [code, text, texts] : rows) {
    write_bytes(limits, text);
    expect_failure(code, joined(texts, {limits}), {"bench", suite, "--limits", limits, "--json", folder / "b.json"});
  }
  EXPECT_FALSE(fs::exists(folder / "b.json"));
  write_bytes(limits, limit("wall", "draft", "rmse = 1e-9\nmae = 1\np99 = 1\nbias = 1"));
  expect_failure(6, {"alcove: draft on wall: rmse is "}, {"bench", suite, "--limits", limits, "-q"});
}

TEST_F(Suites, truths_and_yardsticks_that_are_none) {
  done();
  const std::string start = kFrame + "radius = 1\n";
  expect_failure(3, {frame, "4 channels", "must have one"},
                 {"bench", suite_with("frame", start + "truth = \"wall.0042.exr\"\n"), "-q"});
  expect_failure(3, {"none.exr", "not found"}, {"bench", suite_with("frame", start + "truth = \"none.exr\"\n"), "-q"});
  const std::string suite = suite_with("", "");
  expect_failure(2, {"--yardstick true", "median X ms"}, {"bench", suite, "--yardstick", "true", "-q"});
  expect_failure(5, {"nosuch", "--device"}, {"bench", suite, "--device", "nosuch", "-q"});
  expect_failure(2, {"SUITE"}, {"bench"});
  expect_failure(4, {folder / "none/x", "--json"}, {"bench", "--stability", "--json", folder / "none/x"});
}

// Pictures, and the module of them.

TEST_F(Refusals, a_picture_that_is_cut_short_is_an_input_that_cannot_be_read) {
  const std::string picture = folder / "p.png";
  done({"--preview", picture});
  ASSERT_EQ(run_program({"compare", picture, picture}).code, 0);
  fs::resize_file(picture, fs::file_size(picture) / 2);
  const Finished finished = run_program({"compare", picture, picture});
  EXPECT_EQ(finished.code, 3) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr(picture), HasSubstr("damaged or incomplete"), HasSubstr("RESULT")));
}

TEST_F(Refusals, a_broken_module_of_pictures_is_named_where_one_is_read_and_not_missed_where_one_is_written) {
#ifdef ALCOVE_SANITIZE_ADDRESS
  GTEST_SKIP() << "the program's own folder comes before LD_LIBRARY_PATH";
#endif
  fs::create_directory(folder / "lib");
  write_bytes(folder / "lib/libalcove_image_io.so", "no library");
  const Launch broken{.environment = {{"LD_LIBRARY_PATH", folder / "lib"}}};
  write_bytes(folder / "a.tif", "x");
  expect_failure(3, {folder / "a.tif", "libalcove_image_io.so", "alcove-pictures"},
                 {"compare", folder / "a.tif", frame}, broken);
  done({"--preview", folder / "p.png"});
  EXPECT_EQ(run_program({"compare", folder / "p.png", folder / "p.png"}, broken).code, 0) << "libpng reads it";
  for (const Options& more : {Options{}, {"--preview", folder / "p.png"}, {"--set", "debug=linear-depth"}})
    done(more, broken);
}

// Devices.

Launch lacking(const std::string& what) {
  return {.environment = {{"ALCOVE_LACKS", what}}, .preload = ALCOVE_POOR_DEVICE};
}

TEST_F(Refusals, devices_that_lack_what_kernels_need_or_fail_end_with_5) {
  for (const std::string what : {"Vulkan 1.2", "a compute queue", "scalar block layout"}) {
    const Finished listed = run_well({"devices"}, lacking(what));
    EXPECT_THAT(listed.out, HasSubstr("not usable: it lacks " + what));
    expect_refused(5, {}, {"--device", "it lacks " + what}, lacking(what));
  }
  expect_failure(5, {"no Vulkan device found"}, {"devices"}, lacking("any device"));
  expect_refused(5, {}, {"no Vulkan device found"}, lacking("any device"));
  expect_refused(5, {}, {"vkCreateDevice"}, lacking("a driver that works"));
  expect_refused(5, {}, {"out of memory in vkCreateComputePipelines"}, lacking("memory for kernels"));
  expect_refused(5, {}, {"kernel prepare has", "storage buffers, and", "takes 2"}, lacking("buffers"));
  expect_refused(5, {}, {"no room for a buffer", "--device"}, lacking("memory"));
  EXPECT_THAT(names_in(folder.path()), ElementsAre("camera.json", "wall.0042.exr"));
  EXPECT_THAT(run_program({"devices"}, lacking("a known type")).out, HasSubstr("  other  "));
  done({}, lacking("nothing"));  // or else all of this proves nothing
}

TEST_F(Refusals, a_device_without_timestamps_gives_the_same_without_times) {
  done();
  const std::string with = read_bytes(ao);
  fs::remove(ao);
  EXPECT_EQ(stats_of({}, lacking("timestamps"))["frames"][0]["ms"]["compute"], 0);
  EXPECT_TRUE(read_bytes(ao) == with);
}

TEST_F(Streams, a_frame_that_finds_no_memory_is_computed_again_and_leaves_nothing_to_the_next) {
  // The second frame has another size, so that the buffers of the first one go; the first one can be cut.
  const Window large{0, 0, 320, 180};
  for (const int frame : {1, 3}) wall_frame(large, large).write(input(frame));
  wall_frame().write(input(2));
  write_bytes(camera, wall_camera(large).dump());
  const Options options = typed("--no-skip --threads 1 --radius 0.1");
  done(options);
  const auto whole = outputs();
  for (const char* number : {"3", "4", "6", "8"}) {
    remove_outputs();
    const std::string stats = folder / "stats.json";
    const Finished finished = done(joined(options, {"--stats", stats}),
                                   {.environment = {{"ALCOVE_ALLOCATION", number}}, .preload = ALCOVE_POOR_DEVICE});
    EXPECT_THAT(finished.err, AllOf(HasSubstr(input(1)), HasSubstr("had no memory for ")));
    EXPECT_TRUE(outputs() == whole) << "after allocation " << number;
    const auto frames = json::parse(read_bytes(stats))["frames"];
    EXPECT_EQ(frames[1]["passes"].size(), frames[2]["passes"].size()) << "passes of the frame that failed";
  }
}

}  // namespace
}  // namespace alcove::refusals_test
