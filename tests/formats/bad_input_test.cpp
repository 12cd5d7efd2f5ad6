// Whatever is wrong with files, settings or devices: the exit code, one line that helps, and every output as it was.
// SPDX-License-Identifier: BSD-3-Clause
#include <openexr.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/command_line.h"

namespace alcove::bad_input_test {
namespace {

using namespace test;

constexpr const char* kBefore = "what was here before";

class BadInput : public CommandLine {
 protected:
  BadInput() {
    fs::create_directory(out);
    for (const std::string& file : {ao_out, composite, preview, stats}) write_bytes(file, kBefore);
  }

  /// A run with these arguments must end with this code and one line on stderr, or a list of what is missing. It must
  /// hold the words and name an option, and must leave the output folder as it was.
  void expect_refused(int code, const Options& words, const Options& arguments, const Launch& launch = {}) const {
    const auto before = names_in(out);
    const Finished finished = run_program(joined({"run"}, arguments), launch);
    EXPECT_EQ(finished.code, code) << testing::PrintToString(arguments) << finished;
    const bool is_list = finished.err.starts_with("alcove: error: missing:");
    EXPECT_TRUE(is_list || lines_of(finished.err).size() == 1) << finished;
    EXPECT_EQ(finished.out, "");
    EXPECT_THAT(finished.err, ContainsRegex("INPUT|(^|[ (])--?[a-z]")) << "no option is named";
    for (const auto& word : words) EXPECT_THAT(finished.err, HasSubstr(word)) << testing::PrintToString(arguments);
    EXPECT_EQ(names_in(out), before) << finished;
    for (const std::string& file : {ao_out, composite, preview, stats})
      if (fs::is_regular_file(file)) EXPECT_TRUE(read_bytes(file) == kBefore) << file << " has changed; " << finished;
  }

  /// All that a good run of `input` needs, and these arguments.
  Options good(const std::string& input, const Options& more = {}) const { return to(ao_out, more, input); }
  Options to(const std::string& path, const Options& more = {}, const std::string& input = {}) const {
    return joined({input.empty() ? frame : input, "-o", path, "--camera", camera, "--radius", "1"}, more);
  }

  const std::string out = folder / "out", ao_out = out + "/ao.exr", composite = out + "/composite.exr",
                    preview = out + "/preview.png", stats = out + "/stats.json";
};

TEST_F(BadInput, a_good_run_is_not_refused) {  // or else all below proves nothing
  run_well(joined({"run"}, good(frame)));
}

TEST_F(BadInput, of_every_kind_ends_with_its_code) {
  const auto file = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder / name, bytes);
    return folder / name;
  };
  const auto camera_with = [&](const std::string& field, const json& value) {
    json fields = wall_camera();
    fields.erase(field);
    if (!value.is_null()) fields[field] = value;
    return file(field + ".json", fields.dump());
  };
  const auto with = [&](const Options& more) { return joined({frame, "-o", ao_out, "--radius", "1"}, more); };
  const std::string whole = read_bytes(frame), deph = folder / "deph.exr", small = folder / "small.exr",
                    lit = folder / "lit.exr", no_ocio = file("text.ocio", "no configuration");
  std::string claim = whole;
  const std::size_t window = claim.find("dataWindow") + sizeof("dataWindow") + sizeof("box2i") + 4;
  claim.replace(window + 8, 4, std::string("\xff\xff\xff\x0f", 4));  // its right border
  claim.resize(200000);                                              // of fewer bytes nobody would believe it
  FrameFile misspelt = wall_frame(), other = wall_frame({0, 0, 40, 20}, {0, 0, 40, 20}), beauty = wall_frame();
  misspelt.rename("ViewLayer.Depth.Z", "ViewLayer.Deph.Z");
  misspelt.write(deph);
  add_beauty(other);
  other.write(small);
  add_beauty(beauty);
  beauty.write(lit);
  const auto lit_by = [&](const std::string& name) {
    return good(lit, {"--composite", composite, "--preview", preview, "--set", "ocio=" + name});
  };
  const std::string there = "there is ViewLayer.Deph.Z, ViewLayer.Normal.X, ViewLayer.Normal.Y, ViewLayer.Normal.Z";
  const auto composed_with = [&](const std::string& name) {
    return good(frame, {"--composite", composite, "--beauty", name});
  };
  struct Case {
    int code;
    Options arguments, words;
  };
  for (const auto& [code, arguments, words] : std::vector<Case>{
           {3, good(folder / "missing.exr"), {"missing.exr", "not found"}},
           {3, good(folder.path()), {folder.path(), "folder"}},
           {3, good(file("text.exr", "v 0 0 0\nno image\n")), {"text.exr"}},
           {3, good(file("empty.exr", "")), {"empty.exr"}},
           {3, good("/dev/null"), {"/dev/null"}},
           {3, good(file("cut.exr", whole.substr(0, whole.size() - 1))), {"cut.exr"}},
           {5, good(file("wide.exr", claim)), {"wide.exr", "more than Alcove takes"}},
           {3, good(deph), {"deph.exr", "--depth-channel", there, "did you mean ViewLayer.Deph.Z"}},
           {3, good(frame, {"--depth-channel", "ViewLayer.Dept.Z"}), {frame, "did you mean ViewLayer.Depth.Z"}},
           {3, good(frame, {"--normal-channels", "ViewLayer.Norml"}), {frame, "--normal-channels", "ViewLayer.Norml"}},
           {3,
            good(frame, {"--normal-channels", "ViewLayer.Normal.X,ViewLayer.Normal.Y,ViewLayer.Normal.Q"}),
            {frame, "--normal-channels", "did you mean ViewLayer.Normal."}},
           {3, good(frame, {"--layer", "ViewLayr"}), {frame, "--layer", "ViewLayr"}},
           {3, good(frame, {"--normal", small}), {small, "--normal", "40x20", "64x36"}},
           {3, good(frame, {"--composite", composite}), {frame, "--set beauty-channels"}},
           {3, composed_with(small), {small, "--beauty", "40x20", "64x36"}},
           {3, composed_with(folder / "missing.exr"), {"missing.exr", "--beauty"}},
           {3, lit_by(folder / "missing.ocio"), {"missing.ocio", "--set ocio"}},
           {3, lit_by(no_ocio), {no_ocio, "--set ocio"}},
           {2, with({}), {frame, "--camera", "--fov", "--focal", "--aperture", "--ortho-width"}},
           {2, with({"--focal", "35"}), {"--focal", "--aperture"}},
           {2, with({"--aperture", "36"}), {"--focal", "--aperture"}},
           {3, with({"--fov", "60"}), {frame, "world", "--camera", "--normal none"}},
           {3,
            with({"--camera", camera_with("world_to_camera", nullptr)}),
            {frame, "world_to_camera", "--normal none"}},
           {3, with({"--camera", folder / "missing.json"}), {"missing.json", "--camera"}},
           {3, with({"--camera", folder.path()}), {folder.path(), "--camera"}},
           {2, with({"--camera", ""}), {"--camera"}},
           {3, with({"--camera", file("none.json", "")}), {"none.json", "--camera"}},
           {3, with({"--camera", file("nan.json", "{\"fx\": NaN}")}), {"nan.json", "--camera"}},
           {3, with({"--camera", camera_with("resolution", {64, 48})}), {"resolution.json", "64x48", "--camera"}},
           {3,
            with({"--camera", camera_with("frames", json::array({json{{"frame", 43}}}))}),
            {"frames.json", "42", "--camera"}},
           {2, {frame, "-o", ao_out, "--camera", camera}, {"--radius"}},
           {2, {"-o", ao_out, "--camera", camera, "--radius", "1"}, {"--depth"}},
           {2, {frame, "--camera", camera, "--radius", "1"}, {"-o"}},
           {2, good(frame, {"--beauty", frame}), {"--beauty", "--composite"}},
       })
    expect_refused(code, words, arguments);
}

TEST_F(BadInput, a_compression_that_openexr_does_not_know_is_named) {
  std::string bytes = read_bytes(frame);
  char& compression = bytes[bytes.find("compression") + sizeof("compression") + sizeof("compression") + sizeof(int)];
  for (const auto& [number, name] : {std::pair(10, "JPEG 2000"), std::pair(99, "number 99")}) {
    if (number < EXR_COMPRESSION_LAST_TYPE) continue;
    compression = char(number);
    write_bytes(folder / "new.exr", bytes);
    expect_refused(3, {"new.exr", name, "ZIP"}, good(folder / "new.exr"));
  }
}

TEST_F(BadInput, a_pipe_is_refused_and_not_waited_for) {
  const std::string pipe = folder / "pipe.exr";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_refused(3, {"pipe.exr"}, good(pipe), {.environment = {}, .seconds = 60});
}

// Outputs. Those that are inputs, or one file twice: overwriting_test.

TEST_F(BadInput, an_output_where_no_file_can_be) {
  fs::create_directory(out + "/folder.exr");
  fs::create_symlink("loop", folder / "loop");
  const std::string missing = out + "/missing/ao.exr";
  expect_refused(4, {missing, "--output"}, to(missing, {"--set", "no-mkdir=true"}));
  for (const std::string& path : {ao_out + "/ao.exr", out + "/folder.exr", std::string("/dev/full"),
                                  std::string("/dev/null"), out + "/", folder / "loop/ao.exr"})
    expect_refused(4, {path, "--output"}, to(path));
  for (const auto& [option, name] : std::map<std::string, std::string>{
           {"--composite", "/missing/c.exr"}, {"--preview", "/missing/p.png"}, {"--stats", "/missing/s.json"}})
    expect_refused(4, {out + name, option}, good(frame, {option, out + name, "--set", "no-mkdir=true"}));
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
  for (const char* name : {"/ao.exr", "/new.exr"}) expect_refused(4, {locked + name, "--output"}, to(locked + name));
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
  const auto expect_full = [&](const std::string& name, const Options& more) {
    const Options arguments{"run", frame,       "--camera", camera,       "--radius",
                            "1",   "--denoise", "none",     "--progress", "none"};
    test::expect_refused(run_program(joined(arguments, more)), 4, {name, "No space"});
    EXPECT_THAT(names_in(disk), IsSupersetOf({"ao.exr", "composite.exr", "preview.png", "stats.json"}));
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
  const Launch none{.environment = {{"VK_ICD_FILENAMES", "/nonexistent"}, {"VK_DRIVER_FILES", "/nonexistent"}}};
  const auto before = names_in(out);
  for (const Options& words : {joined({"run"}, good(frame)), {"devices"}, {"devices", "--json"}})
    test::expect_refused(run_program(words, none), 5, {"Vulkan"});
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
}  // namespace alcove::bad_input_test
