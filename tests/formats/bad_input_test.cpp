// Whatever is wrong with files, settings or devices: the exit code, one line that helps, and every output as it was.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <tuple>

#include "core/formats/exr.h"
#include "tests/support/command_line.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;
using namespace test;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kBefore = "what was here before";

class BadInput : public CommandLine {
 protected:
  BadInput() {
    fs::create_directory(out);
    for (const std::string& file : {ao_out, composite, preview, stats}) write_bytes(file, kBefore);
  }

  /// A run with these arguments must end with this code and one line on stderr that holds the words and names an
  /// option, and must leave the output folder as it was.
  void expect_refused(int code, const std::vector<std::string>& words, std::vector<std::string> arguments,
                      const Surroundings& surroundings = {}) const {
    arguments.insert(arguments.begin(), "run");
    const auto before = names_in(out);
    const Finished finished = run_program(arguments, surroundings);
    EXPECT_EQ(finished.code, code) << testing::PrintToString(arguments) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    EXPECT_EQ(finished.out, "");
    EXPECT_THAT(finished.err, testing::ContainsRegex("INPUT|(^|[ (])--?[a-z]")) << "no option is named";
    for (const auto& word : words) EXPECT_THAT(finished.err, HasSubstr(word)) << testing::PrintToString(arguments);
    EXPECT_EQ(names_in(out), before) << finished;
    for (const std::string& file : {ao_out, composite, preview, stats})
      if (fs::is_regular_file(file)) EXPECT_TRUE(read_bytes(file) == kBefore) << file << " has changed; " << finished;
  }

  /// All that a good run of `input` needs, and these arguments.
  std::vector<std::string> good(const std::string& input, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{input, "-o", ao_out, "--camera", camera, "--radius", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  void expect_bad_input(const std::string& input, const std::vector<std::string>& words,
                        const std::vector<std::string>& more = {}) const {
    expect_refused(3, words, good(input, more));
  }

  const std::string out = folder / "out", ao_out = out + "/ao.exr", composite = out + "/composite.exr",
                    preview = out + "/preview.png", stats = out + "/stats.json";
};

// The input file.

TEST_F(BadInput, a_good_run_is_not_refused) {  // or else all below proves nothing
  std::vector<std::string> arguments = good(frame);
  arguments.insert(arguments.begin(), "run");
  const Finished finished = run_program(arguments);
  EXPECT_EQ(finished.code, 0) << finished;
}

TEST_F(BadInput, a_missing_file_a_folder_or_no_exr) {
  expect_bad_input(folder / "missing.exr", {"missing.exr", "not found"});
  expect_bad_input(folder.path(), {folder.path(), "folder"});
  for (const std::string& bytes : {std::string("v 0 0 0\nno image\n"), std::string()}) {
    write_bytes(folder / "text.exr", bytes);
    expect_bad_input(folder / "text.exr", {"text.exr"});
  }
  expect_bad_input("/dev/null", {"/dev/null"});
}

TEST_F(BadInput, a_pipe_is_refused_and_not_waited_for) {
  const std::string pipe = folder / "pipe.exr";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_refused(3, {"pipe.exr"}, good(pipe), {.environment = {}, .seconds = 3});
}

TEST_F(BadInput, an_exr_cut_off_anywhere) {
  const std::string whole = read_bytes(frame);
  for (int cut = 0; cut < 12; cut++) {
    write_bytes(folder / "cut.exr",
                whole.substr(0, cut < 6 ? 1 + std::size_t(cut) * 97 : whole.size() * std::size_t(cut - 5) / 6 - 1));
    expect_bad_input(folder / "cut.exr", {"cut.exr"});
  }
}

TEST_F(BadInput, a_frame_larger_than_any_device_takes) {
  std::string bytes = read_bytes(frame);
  const std::size_t window = bytes.find("dataWindow") + sizeof("dataWindow") + sizeof("box2i") + 4;
  bytes.replace(window + 8, 4, std::string("\xff\xff\xff\x0f", 4));  // its right border
  bytes.resize(200000);                                              // of fewer bytes nobody would believe it
  write_bytes(folder / "wide.exr", bytes);
  expect_refused(5, {"wide.exr", "--memory"}, good(folder / "wide.exr"));
}

TEST_F(BadInput, no_depth_channel_lists_what_there_is_and_the_nearest) {
  FrameFile input = wall_frame();
  input.rename("ViewLayer.Depth.Z", "ViewLayer.Deph.Z");
  input.write(frame);
  expect_bad_input(frame, {"wall.0042.exr", "--depth-channel",
                           "there is ViewLayer.Deph.Z, ViewLayer.Normal.X, ViewLayer.Normal.Y, ViewLayer.Normal.Z",
                           "did you mean ViewLayer.Deph.Z"});
}

TEST_F(BadInput, misspelt_channels_and_layers) {
  expect_bad_input(frame, {"wall.0042.exr", "--depth-channel", "did you mean ViewLayer.Depth.Z"},
                   {"--depth-channel", "ViewLayer.Dept.Z"});
  expect_bad_input(frame, {"wall.0042.exr", "--normal-channels", "ViewLayer.Norml"},
                   {"--normal-channels", "ViewLayer.Norml"});
  expect_bad_input(frame, {"wall.0042.exr", "--normal-channels", "did you mean ViewLayer.Normal."},
                   {"--normal-channels", "ViewLayer.Normal.X,ViewLayer.Normal.Y,ViewLayer.Normal.Q"});
  expect_bad_input(frame, {"wall.0042.exr", "--layer", "ViewLayr"}, {"--layer", "ViewLayr"});
}

TEST_F(BadInput, two_depth_layers_are_ambiguous) {
  FrameFile input = wall_frame();
  input.planes["Other.Depth.Z"] = input.planes["ViewLayer.Depth.Z"];
  input.write(frame);
  expect_bad_input(frame, {"wall.0042.exr", "ViewLayer.Depth.Z", "Other.Depth.Z", "--depth-channel"});
}

TEST_F(BadInput, normals_of_another_size) {
  wall_frame({0, 0, 32, 18}, {0, 0, 32, 18}).write(folder / "small.exr");
  expect_bad_input(frame, {"small.exr", "--normal", "32x18", "64x36"}, {"--normal", folder / "small.exr"});
}

TEST_F(BadInput, beauty_missing_or_of_another_size) {
  expect_bad_input(frame, {"wall.0042.exr", "--set beauty-channels"}, {"--composite", composite});
  FrameFile beauty = wall_frame({0, 0, 40, 20}, {0, 0, 40, 20});
  add_beauty(beauty);
  beauty.write(folder / "small.exr");
  expect_bad_input(frame, {"small.exr", "--beauty", "40x20", "64x36"},
                   {"--composite", composite, "--beauty", folder / "small.exr"});
  expect_bad_input(frame, {"missing.exr", "--beauty"}, {"--composite", composite, "--beauty", folder / "missing.exr"});
}

TEST_F(BadInput, an_unusable_colour_configuration_is_found_before_anything_is_written) {
  FrameFile input = wall_frame();
  add_beauty(input);
  input.write(frame);
  write_bytes(folder / "text.ocio", "no configuration");
  for (const char* name : {"missing.ocio", "text.ocio"})
    expect_bad_input(frame, {name, "--set ocio"},
                     {"--composite", composite, "--preview", preview, "--set", std::string("ocio=") + folder / name});
}

// The camera.

TEST_F(BadInput, no_camera_names_the_options_that_give_one) {
  expect_refused(2, {"wall.0042.exr", "--camera", "--fov", "--focal", "--aperture", "--ortho-width"},
                 {frame, "-o", ao_out, "--radius", "1"});
  expect_refused(2, {"--focal", "--aperture"}, {frame, "-o", ao_out, "--radius", "1", "--focal", "35"});
  expect_refused(2, {"--focal", "--aperture"}, {frame, "-o", ao_out, "--radius", "1", "--aperture", "36"});
}

TEST_F(BadInput, world_normals_need_the_cameras_orientation) {
  const std::vector<std::string> arguments{frame, "-o", ao_out, "--radius", "1", "--fov", "60"};
  expect_refused(3, {"wall.0042.exr", "world", "--camera", "--normal none"}, arguments);
  json fields = wall_camera();
  fields.erase("world_to_camera");
  write_bytes(camera, fields.dump());
  expect_bad_input(frame, {"wall.0042.exr", "world_to_camera", "--camera", "--normal none"});
}

// Every field and every way to get it wrong: camera_test.cpp. Here, that the program ends as it should.
TEST_F(BadInput, camera_files_that_are_none) {
  for (const std::string& path : {folder / "missing.json", folder.path(), std::string()})
    expect_refused(path.empty() ? 2 : 3, {path, "--camera"}, {frame, "-o", ao_out, "--camera", path, "--radius", "1"});
  for (const char* text : {"", "{\"fx\": NaN}"}) {
    write_bytes(camera, text);
    expect_bad_input(frame, {"camera.json", "--camera"});
  }
}

TEST_F(BadInput, camera_fields_that_are_missing_or_make_no_sense) {
  const std::tuple<const char*, json, const char*> cases[] = {
      {"fy", nullptr, "fy"},
      {"fx", 0, "fx"},
      {"resolution", {0, 5}, "resolution"},
      {"resolution", {64, 48}, "64x48"},
      {"world_to_camera", {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, "world_to_camera"},
      {"projection", "panoramic", "panoramic"},
      {"frames", {{{"frame", 1}}, {{"frame", 43}}}, "42"}};
  for (const auto& [field, value, word] : cases) {
    json fields = wall_camera();
    if (value.is_null())
      fields.erase(field);
    else
      fields[field] = value;
    write_bytes(camera, fields.dump());
    expect_bad_input(frame, {"camera.json", word, "--camera"});
  }
}

// Settings.

TEST_F(BadInput, no_radius_no_input_no_output) {
  expect_refused(2, {"--radius"}, {frame, "-o", ao_out, "--camera", camera});
  expect_refused(2, {"--depth"}, {"-o", ao_out, "--camera", camera, "--radius", "1"});
  expect_refused(2, {"-o"}, {frame, "--camera", camera, "--radius", "1"});
  expect_refused(2, {"--beauty", "--composite"}, good(frame, {"--beauty", frame}));
}

// Outputs.

TEST_F(BadInput, an_output_that_is_an_input) {
  const std::string before = read_bytes(frame), camera_before = read_bytes(camera);
  fs::create_symlink(frame, folder / "link.exr");
  fs::create_hard_link(frame, folder / "hard.exr");
  for (const std::string& path : {frame, folder / "./out/../wall.0042.exr", folder / "link.exr", folder / "hard.exr"})
    expect_refused(2, {path, "overwrite", "--output"},
                   {folder / "wall.0042.exr", "-o", path, "--camera", camera, "--radius", "1"});
  expect_refused(2, {"camera.json", "overwrite", "--stats"}, good(frame, {"--stats", camera}));
  expect_refused(2, {"wall.0042.exr", "overwrite", "--composite"}, good(frame, {"--composite", frame}));
  EXPECT_TRUE(read_bytes(frame) == before);
  EXPECT_EQ(read_bytes(camera), camera_before);
}

TEST_F(BadInput, two_outputs_that_are_one_file) {
  expect_refused(2, {"ao.exr", "--output", "--composite"}, good(frame, {"--composite", out + "/../out/ao.exr"}));
  expect_refused(2, {"preview.png", "--preview", "--stats"}, good(frame, {"--preview", preview, "--stats", preview}));
}

TEST_F(BadInput, an_output_where_no_file_can_be) {
  fs::create_directory(out + "/folder.exr");
  fs::create_symlink("loop", folder / "loop");
  const std::string missing = out + "/missing/ao.exr", below_file = ao_out + "/ao.exr";
  for (const std::string& path :
       {missing, below_file, out + "/folder.exr", std::string("/dev/full"), std::string("/dev/null"), out + "/"}) {
    expect_refused(4, {path, "--output"},
                   {frame, "-o", path, "--camera", camera, "--radius", "1", "--set", "no-mkdir=true"});
    if (path != missing)
      expect_refused(4, {path, "--output"}, {frame, "-o", path, "--camera", camera, "--radius", "1"});
  }
  for (const auto& [option, name] : std::map<std::string, std::string>{
           {"--composite", "/missing/c.exr"}, {"--preview", "/missing/p.png"}, {"--stats", "/missing/s.json"}})
    expect_refused(4, {out + name, option}, good(frame, {option, out + name, "--set", "no-mkdir=true"}));
  expect_refused(4, {folder / "loop/ao.exr", "--output"},
                 {frame, "-o", folder / "loop/ao.exr", "--stats", folder / "loop/stats.json", "--camera", camera,
                  "--radius", "1"});
}

TEST_F(BadInput, a_read_only_folder) {
  const std::string locked = folder / "locked";
  fs::create_directory(locked);
  const bool is_mount = ::geteuid() == 0;  // whom permissions do not stop
  if (is_mount && !mount_memory(locked, "size=64k")) GTEST_SKIP() << "this process may not mount";
  write_bytes(locked + "/ao.exr", kBefore);
  if (is_mount)
    ASSERT_TRUE(make_read_only(locked));
  else
    fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  for (const char* name : {"/ao.exr", "/new.exr"})
    expect_refused(4, {locked + name, "--output"}, {frame, "-o", locked + name, "--camera", camera, "--radius", "1"});
  EXPECT_EQ(names_in(locked), std::vector<std::string>{"ao.exr"});
  EXPECT_EQ(read_bytes(locked + "/ao.exr"), kBefore);
  if (is_mount)
    unmount(locked);
  else
    fs::permissions(locked, fs::perms::owner_all);
}

TEST_F(BadInput, a_full_disk) {
  const std::string disk = folder / "disk";
  fs::create_directory(disk);
  if (!mount_memory(disk, "size=64k")) GTEST_SKIP() << "this process may not mount";
  const Window large{0, 0, 256, 144};
  FrameFile input = wall_frame(large, large);
  add_beauty(input);
  input.write(frame);
  write_bytes(camera, wall_camera(large).dump());
  for (const char* name : {"/ao.exr", "/composite.exr", "/preview.png", "/stats.json"})
    write_bytes(disk + name, kBefore);
  // Without a denoiser, whose smooth pictures would fit.
  const auto expect_full = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(),
                {"run", frame, "--camera", camera, "--radius", "1", "--denoise", "none", "--progress", "none"});
    const Finished finished = run_program(more);
    EXPECT_EQ(finished.code, 4) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    EXPECT_THAT(finished.err, testing::AllOf(HasSubstr(name), HasSubstr("No space")));
    EXPECT_THAT(names_in(disk), testing::IsSupersetOf({"ao.exr", "composite.exr", "preview.png", "stats.json"}));
    EXPECT_EQ(names_in(disk).size(), fs::exists(disk + "/ballast") ? 5 : 4) << testing::PrintToString(names_in(disk));
    EXPECT_TRUE(read_bytes(disk + name) == kBefore) << name;
  };
  expect_full("/ao.exr", {"-o", disk + "/ao.exr", "--type", "float", "--set", "compression=none"});
  expect_full("/composite.exr", {"-o", folder / "ao.exr", "--composite", disk + "/composite.exr"});
  write_bytes(disk + "/ballast", std::string(44 << 10, 'x'));  // four files take a page each, so one page is left
  expect_full("/preview.png", {"-o", folder / "ao.exr", "--preview", disk + "/preview.png"});
  unmount(disk);
}

// Devices.

TEST_F(BadInput, no_vulkan_driver) {
  const Surroundings none{.environment = {{"VK_ICD_FILENAMES", "/nonexistent"}, {"VK_DRIVER_FILES", "/nonexistent"}}};
  std::vector<std::string> arguments = good(frame);
  arguments.insert(arguments.begin(), "run");
  const auto before = names_in(out);
  for (const auto& words : {arguments, {"devices"}, {"devices", "--json"}}) {
    const Finished finished = run_program(words, none);
    EXPECT_EQ(finished.code, 5) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    EXPECT_THAT(finished.err, HasSubstr("Vulkan"));
  }
  EXPECT_EQ(names_in(out), before);
  EXPECT_TRUE(read_bytes(ao_out) == kBefore);
}

TEST_F(BadInput, a_device_that_is_not_there) {
  const std::string listed = json::parse(run_program({"devices", "--json"}).out)[0]["name"];
  expect_refused(5, {"a GPU is required", "--device cpu"},
                 good(frame, {"--device", "cpu", "--set", "require-gpu=true"}));
  for (const char* device : {"nosuch", "99", ""})
    expect_refused(5, {"--device", device, listed}, good(frame, {"--device", device}));
}

}  // namespace
}  // namespace alcove
