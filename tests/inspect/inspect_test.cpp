// `alcove inspect`: what it says is what `run` does, and what is missing is named with the option that gives it.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "tests/support/command_line.h"
#include "tests/support/wall_frame.h"

namespace alcove::inspect_test {
namespace {

using namespace test;

class Inspect : public CommandLine {
 protected:
  Finished inspect(const Options& more = {}) const { return run_program(joined({"inspect", frame}, more)); }
  json inspected(const Options& more) const {
    const Finished finished = inspect(joined(more, {"--json"}));
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_EQ(finished.err, "");
    return json::parse(finished.out);
  }
  /// With the camera.
  json seen(const Options& more = {}) const { return inspected(joined({"--camera", camera}, more)); }
  json seen(const FrameFile& file) const {
    file.write(frame);
    return seen();
  }
  static FrameFile changed(const std::function<void(FrameFile&)>& change, const Window& data = kWallWindow) {
    FrameFile file = wall_frame(data);
    change(file);
    return file;
  }
};

TEST_F(Inspect, lists_files_channels_and_attributes) {
  const json all = seen(changed([](FrameFile& file) {
    file.halves = {"ViewLayer.Normal.X"};
    file.attributes["Camera"] = "Camera.001";
  }));
  const json& part = all["files"][0]["parts"][0];
  EXPECT_EQ(all["files"][0]["path"], frame);
  EXPECT_EQ(part["channels"][0], (json{{"name", "ViewLayer.Depth.Z"}, {"type", "float"}}));
  EXPECT_EQ(part["channels"][1], (json{{"name", "ViewLayer.Normal.X"}, {"type", "half"}}));
  EXPECT_EQ(part["attributes"]["Camera"], "Camera.001");
  EXPECT_EQ(part["data_window"], "64x36 at (0, 0)");
}

TEST_F(Inspect, says_what_would_be_used_and_how_it_is_understood) {
  const json all = seen();
  EXPECT_EQ(all["aovs"]["depth"]["channels"], json::array({"ViewLayer.Depth.Z"}));
  EXPECT_EQ(all["aovs"]["normal"]["channels"],
            json::array({"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"}));
  EXPECT_EQ(all["depth"]["kind"], "planar");
  EXPECT_NEAR(all["depth"]["farthest"].get<double>(), 6, 1e-6);
  EXPECT_EQ(all["depth"]["sky_share"], 0);
  EXPECT_EQ(all["normals"]["space"], "world");
  EXPECT_EQ(all["normals"]["unit_share"], 1);
  EXPECT_GT(all["normals"]["agreement"], 0.95);
  EXPECT_EQ(all["normals"]["facing"], 1);
  EXPECT_EQ(all["camera"]["world_to_camera"], true);
  EXPECT_NEAR(all["camera"]["horizontal_fov"].get<double>(), 56.145, 1e-3);
}

TEST_F(Inspect, counts_sky_and_sentinels) {
  const json all = seen(changed([](FrameFile& file) {
    const float odd[] = {std::numeric_limits<float>::quiet_NaN(), 0, -1, 1e10f, std::numeric_limits<float>::infinity()};
    std::ranges::copy(odd, file.planes["ViewLayer.Depth.Z"].begin());
  }))["depth"];
  for (const char* what : {"nan", "zero", "negative", "infinite"}) EXPECT_EQ(all[what], 1) << what;
  EXPECT_NEAR(all["sky_share"].get<double>(), 5.0 / (64 * 36), 1e-9);
}

/// A beauty that is the sum of Blender's passes.
FrameFile lit_frame() {
  FrameFile file = wall_frame();
  const std::size_t pixels = file.data.pixels();
  const auto plane = [&](const std::string& pass, const char* component) -> std::vector<float>& {
    return file.planes["ViewLayer." + pass + "." + component];
  };
  std::size_t seed = 1;
  for (const char* component : {"R", "G", "B"}) {
    for (const char* pass : {"DiffDir", "DiffInd", "DiffCol", "GlossDir", "GlossInd", "GlossCol", "Emit"}) {
      auto& values = plane(pass, component) = std::vector<float>(pixels);
      for (float& value : values) value = 0.1F + float(seed++ * 7919 % 101) / 101;
    }
    plane("Combined", component).resize(pixels);
    for (std::size_t i = 0; i < pixels; i++) {
      const auto at = [&](const char* pass) { return plane(pass, component)[i]; };
      plane("Combined", component)[i] = (at("DiffDir") + at("DiffInd")) * at("DiffCol") +
                                        (at("GlossDir") + at("GlossInd")) * at("GlossCol") + at("Emit");
    }
  }
  return file;
}

TEST_F(Inspect, adds_up_the_light_passes) {
  const json light = seen(lit_frame())["light"];
  EXPECT_EQ(light["sum"], "(DiffDir + DiffInd) x DiffCol + (GlossDir + GlossInd) x GlossCol + Emit");
  EXPECT_EQ(light["adds_up"], true);
  EXPECT_NEAR(light["share"].get<double>(), 1, 1e-6);
  EXPECT_THAT(inspect({"--camera", camera}).out, HasSubstr("+ Emit is the beauty"));
  EXPECT_EQ(seen(wall_frame())["light"], nullptr) << "there are none";
  FrameFile other = wall_frame();
  add_beauty(other);
  EXPECT_EQ(seen(other)["light"], nullptr) << "one part alone is no sum";
}

TEST_F(Inspect, knows_the_light_passes_of_each_renderer) {
  for (const std::vector<std::string>& passes :
       {std::vector<std::string>{"diffuse_direct", "diffuse_indirect", "specular"},
        {"diffuse", "coat_direct", "coat_indirect", "sss"},
        {"VRayLighting", "VRayGlobalIllumination", "VRayReflection", "VRaySelfIllumination"},
        {"lighting", "GI", "reflect"},
        {"directdiffuse", "indirectdiffuse", "combinedglossyreflection"},
        {"combineddiffuse", "glossytransmission"}}) {
    FrameFile file = wall_frame();
    std::size_t seed = 1;
    for (const std::string component : {"R", "G", "B"}) {
      auto& beauty = file.planes[component] = std::vector<float>(file.data.pixels());
      for (const auto& pass : passes)
        for (float& sum : beauty) {
          const float value = 0.1F + float(seed++ * 7919 % 101) / 101;
          sum += value;
          file.planes[pass + "." + component].push_back(value);
        }
    }
    const json light = seen(file)["light"];
    ASSERT_NE(light, nullptr) << passes[0];
    EXPECT_EQ(light["sum"], fmt::format("{}", fmt::join(passes, " + ")));
    EXPECT_EQ(light["adds_up"], true);
  }
}

TEST_F(Inspect, says_which_light_is_missing) {
  const auto said = [&](const std::string& without) {
    FrameFile file = lit_frame();
    for (const char* component : {"R", "G", "B"}) file.planes.erase("ViewLayer." + without + "." + component);
    const json all = seen(file);
    EXPECT_EQ(all["light"]["adds_up"], false);
    EXPECT_THAT(all["suspicious_codes"].dump(), HasSubstr("light-passes"));
    return all["suspicious"].dump();
  };
  for (const char* pass : {"DiffInd", "GlossDir", "GlossCol", "Emit"})
    EXPECT_THAT(said(pass), ContainsRegex("the file lacks .*" + std::string(pass)));
}

TEST_F(Inspect, a_beauty_that_was_denoised_or_shows_more_sky_has_its_light_passes) {
  FrameFile noisy = lit_frame();
  for (const char* component : {"R", "G", "B"}) {
    auto& beauty = noisy.planes["ViewLayer.Combined." + std::string(component)];
    for (std::size_t i = 0; i < beauty.size(); i++) beauty[i] *= i % 2 ? 1.3F : 0.7F;
    for (std::size_t i = 0; i < 640; i++) beauty[i] += 5;  // a sky
  }
  for (std::size_t i = 0; i < 640; i++) noisy.planes["ViewLayer.Depth.Z"][i] = 1e10F;
  EXPECT_EQ(seen(noisy)["light"]["adds_up"], true);
}

TEST_F(Inspect, light_of_a_background_at_outlines_is_not_missing) {
  FrameFile file = lit_frame();
  auto& depth = file.planes["ViewLayer.Depth.Z"];
  const auto is_sky = [](std::size_t i) { return i % 64 >= 20 && i % 64 < 40; };
  for (std::size_t i = 0; i < depth.size(); i++)
    if (is_sky(i)) depth[i] = 1e10F;
  for (const char* component : {"R", "G", "B"}) {
    auto& beauty = file.planes["ViewLayer.Combined." + std::string(component)];
    for (std::size_t i = 1; i + 1 < beauty.size(); i++)
      if (is_sky(i - 1) || is_sky(i) || is_sky(i + 1)) beauty[i] += is_sky(i) ? 20 : 10;
  }
  EXPECT_EQ(seen(file)["light"]["adds_up"], true);
}

TEST_F(Inspect, light_that_is_missing_in_places_is_told_by_its_part_there) {
  FrameFile file = lit_frame();
  const auto change = [&](std::size_t first, std::size_t end, float by) {
    for (const char* component : {"R", "G", "B"})
      for (std::size_t i = first; i < end; i++) file.planes["ViewLayer.Combined." + std::string(component)][i] *= by;
  };
  const auto said = [&] { return seen(file)["suspicious"].dump(); };
  change(0, 512, 1.5F);
  EXPECT_THAT(said(), AllOf(HasSubstr("is 66.7 % of the beauty on 25 % of the surfaces"), HasSubstr("too dark")));
  change(512, 1088, 0.5F);
  EXPECT_THAT(said(), AllOf(HasSubstr("brighter in places and darker in others"), Not(HasSubstr("too dark"))));
  change(0, 2304, 0.5F);
  EXPECT_THAT(said(), HasSubstr("the beauty lacks light"));
}

TEST_F(Inspect, the_command_it_gives_runs_and_guesses_nothing) {
  json fields = wall_camera();
  fields.erase("depth");
  fields.erase("normal_space");
  write_bytes(camera, fields.dump());
  const json all = seen();
  EXPECT_FALSE(all["guesses"].empty());
  Options arguments = typed(all["command"].get<std::string>());
  ASSERT_EQ(arguments[0], "alcove");
  arguments.erase(arguments.begin());
  std::ranges::replace(arguments, std::string("ao.exr"), ao);
  run_well(joined(arguments, {"--strict"}));
}

TEST_F(Inspect, the_command_it_gives_has_the_settings_that_were_given) {
  FrameFile lit = wall_frame();
  add_beauty(lit);
  const std::string beauty = folder / "beauty.exr";
  lit.write(beauty);
  const std::string command =
      seen({"--beauty", beauty, "--preset", "draft", "--radius", "0.4", "--set", "intensity=0.5"})["command"];
  EXPECT_THAT(command,
              AllOf(HasSubstr(" --beauty " + beauty), HasSubstr(" --composite composite.exr"),
                    HasSubstr(" --preset draft"), HasSubstr(" --radius 0.4"), HasSubstr(" --set intensity=0.5")));
  EXPECT_EQ(command.find("--radius"), command.rfind("--radius"));
  Options arguments = typed(command);
  arguments.erase(arguments.begin());
  run_well(arguments, {.folder = folder.path()});
  EXPECT_TRUE(fs::exists(folder / "composite.exr"));
}

TEST_F(Inspect, the_command_it_gives_has_every_option_that_was_typed_and_has_an_effect_there) {
  const Options kept{"--slices 8",    "--denoise none",  "--aov ao,normal",
                     "--set steps=9", "--thickness 0.5", "--roi 1,2,30,20"};
  Options given = typed("--set gain=2 --depth-kind auto -v");
  for (const auto& words : kept) given = joined(given, typed(words));
  const std::string command = seen(given)["command"];
  for (const auto& words : kept) EXPECT_THAT(command, HasSubstr(" " + words));
  for (const char* words : {" gain", " auto", " -v", " --json"}) EXPECT_THAT(command, Not(HasSubstr(words)));
  Options arguments = typed(command);
  arguments.erase(arguments.begin());
  run_well(arguments, {.folder = folder.path()});
}

TEST_F(Inspect, the_command_it_gives_has_no_option_that_does_not_apply) {
  for (const char* word : {"device-range=-1..1", "log-constant=2"}) {
    const json all = seen({"--set", word});
    EXPECT_EQ(all["command"], "") << "of planar depth";
    EXPECT_THAT(all["missing"].dump(), HasSubstr("has no effect, since the depth is read as planar"));
  }
  changed([](FrameFile& file) { file.change("Depth", [](float z) { return 0.1f * z; }); }).write(frame);
  json fields = wall_camera();
  fields.update({{"depth", "log"}, {"near", 0.1}, {"far", 100}});
  write_bytes(camera, fields.dump());
  EXPECT_THAT(seen()["command"], AllOf(HasSubstr("--depth-kind log --far 100"), Not(HasSubstr("--near"))));
}

TEST_F(Inspect, calls_a_warning_of_a_run_what_the_run_calls_it) {
  changed([](FrameFile& file) { file.change("Depth", [](float z) { return 1 - 0.5f / z; }); }).write(frame);
  json fields = wall_camera();
  fields.update({{"depth", "device"}, {"near", 0.5}, {"far", "inf"}});
  write_bytes(camera, fields.dump());
  const Options words{frame, "--camera", camera, "--near", "1"};
  const std::string seen = run_well(joined({"inspect"}, words)).out,
                    said = run_well(joined({"run", "-o", folder / "ao.exr", "--radius", "1"}, words)).err;
  const std::regex near_plane("warning: .*(--near is 1.*\\[near-plane\\])\n");
  std::smatch in_inspect, in_run;
  ASSERT_TRUE(std::regex_search(seen, in_inspect, near_plane)) << seen;
  ASSERT_TRUE(std::regex_search(said, in_run, near_plane)) << said;
  EXPECT_EQ(in_inspect[1], in_run[1]);
}

TEST_F(Inspect, names_what_is_missing_and_the_option_that_gives_it) {
  changed([](FrameFile& file) { file.erase("Normal"); }).write(frame);
  const Finished finished = inspect();
  EXPECT_EQ(finished.code, 0) << finished;
  for (const char* word :
       {"missing: camera", "--camera", "--fov", "missing: normals", "--normal-channels", "missing: beauty"})
    EXPECT_THAT(finished.out, HasSubstr(word));
}

TEST_F(Inspect, a_frame_without_depth_is_described_with_what_is_missing) {
  const json all = seen(changed([](FrameFile& file) { file.erase("Depth"); }));
  EXPECT_EQ(all["files"][0]["parts"][0]["channels"].size(), 3);
  EXPECT_THAT(all["missing"].dump(), HasSubstr("--depth-channel"));
  EXPECT_EQ(all["depth"], nullptr);
}

TEST_F(Inspect, a_result_names_the_frame_that_it_was_computed_from) {
  done();
  const std::string said =
      ao + ": no depth channel found: this is a result of Alcove, which was computed from wall.0042.exr\n";
  EXPECT_THAT(run_program({"inspect", ao}).out, HasSubstr("missing: " + said));
  test::expect_refused(run_program({"run", ao, "-o", folder / "b.exr", "--fov", "60", "--radius", "1"}), 3, {said});
  test::expect_refused(
      run_program({"run", frame, "--depth", ao, "-o", folder / "b.exr", "--fov", "60", "--radius", "1"}), 3, {said});
}

TEST_F(Inspect, what_run_would_refuse_is_part_of_the_answer) {
  const json all = seen({"--depth-kind", "device"});
  EXPECT_THAT(all["missing"].dump(), HasSubstr("--near"));
  EXPECT_EQ(all["depth"]["kind"], "device");
}

TEST_F(Inspect, the_text_begins_with_the_reading_and_ends_with_the_command) {
  FrameFile file = wall_frame();
  file.attributes["Camera"] = "Camera.001";
  file.write(frame);
  const json all = inspected({"--camera", camera});
  const auto lines = lines_of(inspect({"--camera", camera}).out);
  EXPECT_THAT(lines[0], StartsWith("source: cycles"));
  EXPECT_EQ(lines[1], "depth: planar, ViewLayer.Depth.Z, distances 3.429 to 6, median 6; sky 0.0 %");
  EXPECT_THAT(lines[2], StartsWith("normals: world space, signed"));
  EXPECT_THAT(lines[3], StartsWith("camera: perspective by --camera"));
  EXPECT_EQ(lines.back(), all["command"].get<std::string>());
  const auto is_layer = [](const std::string& line) { return line == "    ViewLayer.Normal  X Y Z  float"; };
  EXPECT_EQ(std::ranges::count_if(lines, is_layer), 1) << "one line for a layer";
  const std::string text = inspect({"--camera", camera}).out, evidence = inspect({"--camera", camera, "-v"}).out;
  for (const char* words : {"Camera = Camera.001", "as planar alone", "0 NaN", "as world with flips none"}) {
    EXPECT_THAT(evidence, HasSubstr(words));
    EXPECT_THAT(text, Not(HasSubstr(words)));
  }
}

TEST_F(Inspect, says_which_program_wrote_the_frame) {
  EXPECT_EQ(seen()["source"]["name"], "cycles");
  const json said = seen({"--preset", "input/generic"});
  EXPECT_EQ(said["source"]["name"], "generic");
  EXPECT_EQ(said["source"]["by"], "--source");
  EXPECT_THAT(said["command"].get<std::string>(), HasSubstr("--source generic"));
  test::expect_refused(inspect({"--source", "blendr5"}), 2, {"blender5"});
}

TEST_F(Inspect, what_is_suspicious_is_said_once) {
  EXPECT_EQ(seen()["suspicious"].size(), 0);
  const FrameFile short_normals = changed(
      [](FrameFile& file) {
        int i = 0;
        file.change("Normal", [&](float n) { return i++ % 4 ? n : 0.5f * n; });
      },
      {-4, 0, 72, 36});
  const std::string suspicious = seen(short_normals)["suspicious"].dump();
  EXPECT_THAT(suspicious, HasSubstr("25 % of the normals"));
  EXPECT_THAT(suspicious, HasSubstr("data window is 72x36"));
  const auto make_half = [](FrameFile& file) { file.halves = {"ViewLayer.Depth.Z"}; };
  const json of_half = seen(changed(make_half))["suspicious"];
  ASSERT_EQ(of_half.size(), 1) << of_half;
  EXPECT_THAT(of_half[0].get<std::string>(), AllOf(HasSubstr("half float"), HasSubstr("steps of")));
  EXPECT_EQ(seen(changed(make_half, {-4, 0, 72, 36}))["suspicious_codes"], (json{"half-depth", "windows-differ"}));
  for (const auto compression : {Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION, Imf::ZIP_COMPRESSION}) {
    write_with_dwa(frame, compression);
    const std::string said = seen()["suspicious"].dump();
    for (const char* color : {"R", "G", "B"})
      EXPECT_EQ(said.find(std::string("ViewLayer.Normal.") + color + " is compressed by DWA") != said.npos,
                compression != Imf::ZIP_COMPRESSION)
          << said;
    EXPECT_EQ(said.find("Depth.Z"), said.npos) << "DWA keeps a channel of that name";
  }
}

TEST_F(Inspect, a_file_cut_short_is_suspicious_and_its_header_is_shown) {
  const std::string whole = read_bytes(frame);
  write_bytes(frame, whole.substr(0, whole.size() / 2));
  const Finished finished = inspect({"--camera", camera, "--json"});
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err, HasSubstr("damaged or incomplete"));
  const json all = json::parse(finished.out);
  EXPECT_EQ(all["files"][0]["parts"][0]["channels"].size(), 4);
  EXPECT_THAT(all["suspicious"].dump(), HasSubstr("damaged or incomplete"));
  EXPECT_EQ(all["command"], "");
}

TEST_F(Inspect, without_a_camera_nothing_is_said_that_needs_one) {
  const json all = inspected({});
  EXPECT_EQ(all["camera"], nullptr);
  EXPECT_EQ(all["normals"]["space"], "world") << "as Blender writes them";
  EXPECT_EQ(all["normals"]["scores"].size(), 0);
  EXPECT_FALSE(all["normals"].contains("agreement"));
  EXPECT_EQ(all["notes"].size(), 0) << all["notes"];
  EXPECT_THAT(all["command"].get<std::string>(),
              AllOf(HasSubstr("--camera CAMERA.json"), Not(HasSubstr("--normal-space"))));
  EXPECT_THAT(inspect().out, HasSubstr("missing: camera"));
}

/// Frames 1 to 8 of a camera that moves, but for 5 and 6.
class InspectSequence : public Inspect {
 protected:
  InspectSequence() {
    json cameras = wall_camera();
    for (const int number : {1, 2, 3, 4, 7, 8}) {
      wall_frame().write(path(number));
      json moved{{"frame", number}, {"world_to_camera", cameras["world_to_camera"]}};
      moved["world_to_camera"][0][3] = 0.25 * number;
      if (number == 8) moved["fx"] = 2 * cameras["fx"].get<double>(), moved["fy"] = 2 * cameras["fy"].get<double>();
      cameras["frames"].push_back(moved);
    }
    write_bytes(camera, cameras.dump());
  }

  std::string path(int number) const { return folder / fmt::format("shot.{:04}.exr", number); }

  Finished inspect_all(const Options& more) const {
    return run_program(joined({"inspect", folder / "shot.####.exr", "--camera", camera}, more));
  }
  json sequence(const Options& more = {}) const {
    const Finished finished = inspect_all(joined(more, {"--json"}));
    EXPECT_EQ(finished.code, 0) << finished;
    return json::parse(finished.out)["sequence"];
  }
  static json change(const json& sequence, const std::string& what) {
    for (const auto& each : sequence["changes"])
      if (each["what"] == what) return each["values"];
    return nullptr;
  }
};

TEST_F(InspectSequence, says_which_frames_there_are_and_which_are_missing) {
  const json all = sequence();
  EXPECT_EQ(all["frames"], "1-4, 7-8");
  EXPECT_EQ(all["count"], 6);
  EXPECT_EQ(all["absent"], "5-6");
  EXPECT_EQ(sequence({"--frames", "1-3,9"})["absent"], "9");
  for (const int number : {2, 4, 8}) fs::remove(path(number));
  EXPECT_EQ(sequence()["absent"], "5") << "the step of 1, 3 and 7 is 2";
  EXPECT_EQ(seen()["sequence"], nullptr) << "a single frame";
}

TEST_F(InspectSequence, follows_the_camera) {
  const json moves = sequence()["camera"];
  EXPECT_NEAR(moves["farthest"].get<double>(), 0.25 * 7, 1e-9);
  EXPECT_NEAR(moves["largest_step"].get<double>(), 0.25 * 3, 1e-9);
  EXPECT_EQ(moves["at_largest_step"], 7);
  EXPECT_NEAR(moves["largest_turn"].get<double>(), 0, 1e-6);
  EXPECT_NEAR(moves["widest"].get<double>(), 56.145, 1e-3);
  EXPECT_LT(moves["narrowest"].get<double>(), 30);
}

TEST_F(InspectSequence, a_camera_whose_matrix_is_rounded_stands_still) {
  json cameras = wall_camera();
  // No exact rotation, as a header in single precision has it; and once a last bit differs.
  const auto rows = [](double turned) {
    return json{{0.9999999, turned, 0, 0.5}, {0, 0, 0.9999999, -2}, {0, -0.9999999, 0, 3}, {0, 0, 0, 1}};
  };
  for (const int number : {1, 2, 3, 4, 7, 8})
    cameras["frames"].push_back({{"frame", number}, {"world_to_camera", rows(number == 3 ? 0x1p-24 : 0)}});
  write_bytes(camera, cameras.dump());
  EXPECT_EQ(sequence()["camera"]["largest_turn"], 0);
  EXPECT_THAT(inspect_all({}).out, HasSubstr("wide in all frames, stands still\n"));
}

TEST_F(InspectSequence, says_what_changes_and_what_does_not) {
  json all = sequence();
  EXPECT_EQ(all["changes"].size(), 0) << all["changes"];
  EXPECT_THAT(all["same"].dump(), AllOf(HasSubstr("data window"), HasSubstr("channels"), HasSubstr("source")));
  FrameFile other = wall_frame({-4, 0, 72, 36});
  other.planes["Extra"] = other.planes["ViewLayer.Depth.Z"];
  other.write(path(4));
  write_bytes(path(7), "no frame");
  all = sequence();
  const json window = change(all, "data window");
  ASSERT_EQ(window.size(), 2) << all;
  EXPECT_EQ(window[1]["value"], "72x36 at (-4, 0)");
  EXPECT_EQ(window[1]["frames"], "4");
  EXPECT_THAT(change(all, "channels").dump(), HasSubstr("Extra (float)"));
  EXPECT_EQ(change(all, "refused")[0]["frames"], "7");
  EXPECT_EQ(change(all, "display window"), nullptr);
}

TEST_F(InspectSequence, gives_distances_of_a_few_frames_and_the_command_of_all) {
  const json all = json::parse(inspect_all({"--json"}).out);
  EXPECT_EQ(all["sequence"]["depth"].size(), 5);
  EXPECT_EQ(all["sequence"]["depth"][0]["frame"], 1);
  EXPECT_EQ(all["sequence"]["depth"][4]["frame"], 8);
  EXPECT_NEAR(all["sequence"]["depth"][0]["farthest"].get<double>(), 6, 1e-6);
  const std::string command = all["command"];
  EXPECT_THAT(command, AllOf(HasSubstr("shot.####.exr"), HasSubstr("-o 'ao.####.exr'")));
  const std::string shot = folder / "shot.####.exr";
  EXPECT_THAT(json::parse(inspect_all({"--json", "--accumulate", "1", "--motion", shot}).out)["command"],
              AllOf(HasSubstr(" --accumulate 1"), HasSubstr(" --motion '" + shot + "'")));
  const std::string text = inspect_all({}).out;
  for (const char* words : {"sequence: 6 frames, 1-4, 7-8", "missing frames: 5-6", "the same in all frames",
                            "its largest step is 0.75, to frame 7", "depth of frame 8: distances"})
    EXPECT_THAT(text, HasSubstr(words));
}

TEST_F(Inspect, normals_that_are_left_out_are_not_missing) {
  const json all = seen({"--normal", "none"});
  EXPECT_EQ(all["normals"], nullptr);
  EXPECT_EQ(all["missing"].size(), 1) << all["missing"];  // a beauty
  EXPECT_THAT(all["command"].get<std::string>(), HasSubstr("--normal none"));
}

TEST_F(Inspect, shows_the_scores_of_normals_that_run_refuses) {
  json wrong = wall_camera();
  wrong["world_to_camera"] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  write_bytes(camera, wrong.dump());
  const json all = seen();
  EXPECT_THAT(all["missing"].dump(), HasSubstr("--normal none"));
  EXPECT_FALSE(all["normals"]["scores"].empty());
  EXPECT_EQ(all["depth"]["kind"], "planar");
  EXPECT_EQ(all["command"], "");
}

TEST_F(Inspect, lengths_are_of_vectors_only) {
  EXPECT_EQ(seen()["normals"]["mean_length"], 1);
  const json all = seen({"--normal-encoding", "spheremap"})["normals"];
  EXPECT_EQ(all["encoding"], "spheremap");
  EXPECT_EQ(all["mean_length"], nullptr);
  EXPECT_EQ(inspect({"--camera", camera, "--normal-encoding", "spheremap", "-v"}).out.find("mean length"),
            std::string::npos);
}

TEST_F(Inspect, bad_files_and_arguments_have_their_exit_codes) {
  write_bytes(folder / "text.exr", "no image");
  for (const auto& [code, arguments] : {std::pair(3, "inspect " + (folder / "missing.exr")),
                                        {3, "inspect " + (folder / "text.exr")},
                                        {2, "inspect"},
                                        {2, "inspect --nonsense " + frame},
                                        {0, "inspect --help"}})
    EXPECT_EQ(run_program(typed(arguments)).code, code) << arguments;
  for (const char* option : {"--depth", "--normal", "--position"}) {
    const Finished finished = run_program({"inspect", frame, option, folder / "missing.exr"});
    EXPECT_THAT(finished.err, AllOf(HasSubstr("missing.exr"), HasSubstr(option), Not(HasSubstr("INPUT")))) << finished;
  }
}

}  // namespace
}  // namespace alcove::inspect_test
