// Whatever option of an input differs between two frames that are equal otherwise, no lane takes the one for the other.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"
#include "core/run/frame_files.h"
#include "core/run/frame_run.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::reuse_options_test {
namespace {

using namespace test;

/// Two values of an option, as they are typed: F and S are files of the same channels and other values.
struct Change {
  std::string beside;  // what both frames have, too
  std::string one, other;
  std::string why_not = "";  // instead: why a lane never sees two values of it
};

const std::string kOfOthers = "it chooses what others show, which are told by the hash of their planes",
                  kOfRun = "it is a setting of the estimator, which all frames of a run have",
                  kOfChannels = "it chooses among channels, and so does --layer";

const std::map<std::string, Change> kChanges{
    {"depth", {"", "--depth F", "--depth S"}},
    {"normal", {"", "--normal F", "--normal S"}},
    {"position", {"--set position-channels=u.p0,u.p1,u.p2", "--position F", "--position S"}},
    {"beauty", {"--composite c.exr", "--beauty F", "--beauty S"}},
    {"material-ao", {"--set material-ao-channel=u.q1", "--set material-ao=F", "--set material-ao=S"}},
    {"matte", {"--set matte-channel=u.q1", "--matte F", "--matte S"}},
    {"occluders", {"", "--set occluders=M", "--set occluders=N"}},
    {"ignore", {"--behind B", "--set ignore=M", "--set ignore=N"}},
    {"objects", {"--set occluders=1 --set object-channel=u.id", "--set objects=F", "--set objects=S"}},
    {"object-channel", {"--set occluders=1", "--set object-channel=u.id", "--set object-channel=u.jd"}},
    {"albedo", {"--composite c.exr --set multi-bounce=true", "--set albedo=0.2", "--set albedo=0.8"}},
    {"depth-channel", {"", "--depth-channel ViewLayer.Depth.Z", "--depth-channel u.q3"}},
    {"normal-channels", {"", "--normal-channels ViewLayer.Normal", "--normal-channels u.n0,u.n1,u.n2"}},
    {"position-channels", {"", "--set position-channels=u.p0,u.p1,u.p2", "--set position-channels=u.r0,u.r1,u.r2"}},
    {"beauty-channels",
     {"--composite c.exr", "--set beauty-channels=ViewLayer.Combined", "--set beauty-channels=ViewLayer.DiffInd"}},
    {"ambient", {"--composite c.exr", "--set ambient=DiffInd", "--set ambient=DiffInd*0.5"}},
    {"shadow-layers",
     {"--composite c.exr --lights H", "--set shadow-layers=key:DiffInd", "--set shadow-layers=key:DiffCol"}},
    {"material-ao-channel", {"", "--set material-ao-channel=u.q1", "--set material-ao-channel=u.q2"}},
    {"albedo-channels",
     {"--composite c.exr --set multi-bounce=true", "--set albedo-channels=ViewLayer.DiffCol",
      "--set albedo-channels=u.n0,u.n1,u.n2"}},
    {"matte-channel", {"", "--set matte-channel=u.q1", "--set matte-channel=u.q2"}},
    {"matte-object", {"--set matte-channel=u.id", "--matte-object 1", "--matte-object 2"}},
    {"matte-outside", {"--set matte-channel=u.q1", "--matte-outside 0.25", "--matte-outside 0.75"}},
    {"layer", {"--depth-channel Z --normal none", "--layer a", "--layer b"}},
    {"view", {"", "", "", kOfChannels}},
    {"roi", {"", "--roi 0,0,32,36", "--roi 32,0,32,36"}},
    {"supersampling", {"", "--set supersampling=1", "--set supersampling=2"}},
    {"source", {"", "", "", "it stands for other options of this table"}},
    {"depth-kind", {"", "--depth-kind planar", "--depth-kind ray"}},
    {"near", {"--depth-kind device --depth-channel u.q1 --far 100", "--near 0.5", "--near 1"}},
    {"far", {"--depth-kind device --depth-channel u.q1 --near 1", "--far 100", "--far 10"}},
    {"reversed-z", {"--depth-kind device --depth-channel u.q1 --near 1 --far 10", "", "--reversed-z"}},
    {"device-range",
     {"--depth-kind device --depth-channel u.q1 --near 1 --far 10", "--set device-range=0..1",
      "--set device-range=-1..1"}},
    {"log-constant",
     {"--depth-kind log --depth-channel u.q1 --far 10", "--set log-constant=1", "--set log-constant=2"}},
    {"disparity-scale",
     {"--depth-kind disparity --depth-channel u.q1 --set disparity-shift=0", "--set disparity-scale=1",
      "--set disparity-scale=2"}},
    {"disparity-shift",
     {"--depth-kind disparity --depth-channel u.q1 --set disparity-scale=1", "--set disparity-shift=0",
      "--set disparity-shift=-0.5"}},
    {"ramps", {"--depth-channel u.q6", "--set ramps=keep", "--set ramps=cut"}},
    {"depth-scale", {"", "--depth-scale 1", "--depth-scale 1.5"}},
    {"sky", {"", "--sky 100", "--sky 5"}},
    {"normal-space", {"--camera G --normal-channels u.m0,u.m1,u.m2", "--normal-space world", "--normal-space view"}},
    {"normal-encoding", {"--normal-channels u.n0,u.n1,u.n2", "--normal-encoding signed", "--normal-encoding unorm"}},
    {"flip-normal", {"--normal-channels u.n0,u.n1,u.n2", "", "--flip-normal x"}},
    {"position-space",
     {"--camera G --set position-channels=u.p0,u.p1,u.p2", "--set position-space=view", "--set position-space=world"}},
    {"camera", {"", "--camera C", "--camera D"}},
    {"chan-rotation", {"--camera K --aov ao,normal", "--chan-rotation zxy", "--chan-rotation xyz"}},
    {"fov", {"", "--fov 50", "--fov 60"}},
    {"vertical-fov", {"", "--vertical-fov 50", "--vertical-fov 60"}},
    {"focal-px", {"", "--focal-px 50", "--focal-px 60"}},
    {"focal", {"--aperture 36", "--focal 35", "--focal 50"}},
    {"aperture", {"--focal 35", "--aperture 36", "--aperture 24"}},
    {"ortho-width", {"", "--ortho-width 4", "--ortho-width 8"}},
    {"behind", {"--set stride=1", "--behind B", "--behind E"}},
    {"behind-channel", {"--set stride=1 --behind F", "--set behind-channel=u.q4", "--set behind-channel=u.q5"}},
    {"behind-kind", {"--behind B", "--behind-kind surfaces", "--behind-kind backs"}},
    {"deep", {"", "", "", "its samples are planes, as those of --behind"}},
    {"deep-opacity", {"", "", "", "it chooses among samples, as --deep does"}},
    {"other-views", {"", "", "", kOfOthers}},
    {"around", {"", "", "", kOfOthers}},
    {"motion", {"", "", "", kOfOthers}},
    {"motion-channels", {"", "", "", kOfOthers}},
    {"motion-kind", {"", "", "", kOfOthers}},
    {"hidden", {"", "", "", kOfRun}},
    {"separation", {"", "", "", kOfRun}},
    {"environment", {"", "--environment L", "--environment T"}},
    {"lights", {"", "--lights H", "--lights I"}},
    {"aov-space", {"--aov ao,normal", "--set aov-space=world", "--set aov-space=view"}}};

/// Whether an option says what the pixels of an input are, or what they mean.
bool is_of_inputs(const SettingRow& row) {
  if (row.effect == Effect::none) return false;
  return row.group == "Input" || row.group == "Hidden surfaces" || row.role == FileRole::input ||
         row.key() == "aov-space";
}

class ReuseOfOptions : public CommandLine {
 protected:
  ReuseOfOptions() {
    write_frame("F.exr", 0);
    write_frame("S.exr", 1);
    for (const auto& [name, shift] : {std::pair("M", 0), {"N", 20}}) write_plane(file(name), "Y", half_taken(shift));
    for (const auto& [name, depth] : {std::pair("B", 6.5f), {"E", 7.0f}})
      write_plane(file(name), "Z", std::vector<float>(kWallWindow.pixels(), depth));
    for (const auto& [name, light] : {std::pair("L", 1.0f), {"T", 2.0f}}) write_sky(file(name), light);
    write_bytes(file("C"), wall_camera().dump());
    json other = wall_camera();
    other["fx"] = other["fy"] = 70;
    write_bytes(file("D"), other.dump());
    // Turned so little that what is in view space might as well be in the world's.
    json turned = wall_camera();
    turned["world_to_camera"] = {{0.9999875, 0, 0.005, 0}, {0, 1, 0, 0}, {-0.005, 0, 0.9999875, 0}, {0, 0, 0, 1}};
    write_bytes(file("G"), turned.dump());
    for (const auto& [name, z] : {std::pair("H", 1), {"I", -1}})
      write_bytes(
          file(name),
          fmt::format(R"({{"lights": [{{"name": "key", "kind": "sun", "direction": [0, 0, {}], "space": "view"}}]}})",
                      z));
    write_bytes(file("K"), "1 0.5 2 3 10 20 30 40\n");
  }

  std::string file(const std::string& name) const {
    const bool is_text = std::string("CDGHI").find(name) != name.npos;
    return folder / (name + (is_text ? ".json" : name == "K" ? ".chan" : ".exr"));
  }

  /// Values of a matte that takes every second column from `shift` on.
  static std::vector<float> half_taken(std::size_t shift) {
    std::vector<float> plane(kWallWindow.pixels());
    for (std::size_t i = 0; i < plane.size(); i++) plane[i] = (i + shift) % 64 < 32 ? 1.0f : 0.0f;
    return plane;
  }

  static void write_sky(const std::string& path, float light) {
    FrameFile sky{{0, 0, 16, 8}, {0, 0, 16, 8}, 1, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"}) sky.planes[channel] = std::vector<float>(16 * 8, light);
    sky.write(path);
  }

  /// The wall with a step in it, a beauty, and channels that only options name. number: 0 or 1, for other values.
  void write_frame(const std::string& name, int number) const {
    FrameFile frame = wall_frame();
    add_beauty(frame);
    auto& z = frame.planes.at("ViewLayer.Depth.Z");
    const auto plane = [&](const std::string& channel, const std::function<double(std::size_t)>& value) {
      auto& values = frame.planes["u." + channel] = std::vector<float>(z.size());
      for (std::size_t i = 0; i < z.size(); i++) values[i] = float(value(i));
    };
    for (std::size_t i = 0; i < z.size(); i++)
      if (i % 64 < 20) z[i] *= number == 0 ? 0.8f : 0.7f;
    const auto part = [=](std::size_t i) { return double((7 * i + 13 * std::size_t(number)) % 64) / 80 + 0.1; };
    plane("q1", part);
    plane("q2", [&](std::size_t i) { return part(i + 5); });
    plane("q3", [&](std::size_t i) { return i % 64 < 30 ? 0.9 * z[i] : z[i]; });
    plane("q4", [&](std::size_t) { return 6.5 + number; });
    plane("q5", [&](std::size_t) { return 7.0 + number; });
    plane("q6",
          [&](std::size_t i) { return z[i] * (1 - 0.05 * double(std::clamp<std::size_t>(i % 64, 25, 31) - 25)); });
    plane("id", [&](std::size_t i) { return double((i / 8 + std::size_t(number)) % 3); });
    plane("jd", [&](std::size_t i) { return double((i / 4 + std::size_t(number)) % 3); });
    // They face the camera as vectors and, less plainly, as 0.5 + 0.5 n.
    plane("n0", [&](std::size_t i) { return 0.25 + 0.1 * std::sin(0.1 * double(i % 64)); });
    plane("n1", [](std::size_t) { return -1.0; });
    plane("n2", [](std::size_t) { return 0.25; });
    for (int axis = 0; axis < 3; axis++)
      plane(fmt::format("m{}", axis), [&](std::size_t) { return axis == 2 ? 1.0 : 0.0; });
    const auto position = [&](std::size_t i, int axis, double scale) {
      const double x = (double(i % 64) + 0.5 - 32) / 60, y = (18 - double(i / 64) - 0.5) / 60;
      return scale * z[i] * (axis == 0 ? x : axis == 1 ? y : -1.0);
    };
    for (int axis = 0; axis < 3; axis++) {
      plane(fmt::format("p{}", axis), [&](std::size_t i) { return position(i, axis, 1); });
      plane(fmt::format("r{}", axis), [&](std::size_t i) { return position(i, axis, 1.25); });
    }
    frame.planes["a.Z"] = z;
    frame.planes["b.Z"] = frame.planes.at("u.q3");
    if (number == 1)
      for (const char* channel : {"Normal.X", "Combined.R", "Combined.G"})
        for (float& value : frame.planes.at(std::string("ViewLayer.") + channel)) value += 0.25f;
    frame.write(folder / name);
  }

  /// The settings of a frame: what one types, and the rest where that says nothing of it.
  Settings settings_of(const std::string& more) const {
    Options words{file("F")};
    std::istringstream all("-o ao.exr --radius 1 --slices 2 --steps 6 --type float --set allow=normals-disagree " +
                           more);
    for (std::string word; all >> word;) {
      const std::size_t at = word.find('=') + 1;  // 0 where there is none
      const std::string name = word.substr(at);
      words.push_back(name.size() == 1 && std::string("FSMNBELTCDGKHI").find(name) != name.npos
                          ? word.substr(0, at) + file(name)
                          : word);
    }
    const auto says = [&](const char* option) { return more.find(option) != more.npos; };
    if (!says("--camera") && !says("fov") && !says("--focal") && !says("--ortho-width"))
      words.insert(words.end(), {"--camera", file("C")});
    if (!says("--depth-channel") && !says("position") && !says("--layer"))
      words.insert(words.end(), {"--depth-channel", "ViewLayer.Depth.Z"});
    if (!says("-normal") && !says("--environment")) words.insert(words.end(), {"--normal", "none"});
    RunOptions options;
    parse_run_options(words, options);
    OutputSettings& output = options.settings.output;
    if (!output.lights.empty()) output.read_lights = read_lights(output.lights);
    return options.settings;
  }

  /// What a lane makes of a frame.
  struct Made {
    std::vector<float> values;
    bool is_reused = false;
  };
  static Made made(Lane& lane, Settings settings, bool reuses) {
    settings.estimator.no_skip = !reuses;
    FrameSource source = open_frame(settings, 1);
    const Window window = written_of(source);
    ReadPlanes planes;
    read_for_parts(source, settings, planes, std::uint64_t(1) << 40);
    FrameInputs inputs = load_frame(lane.gpu, source, window, settings, 1, &planes);
    if (const auto& lights = settings.output.read_lights) inputs.lights = lights->in_view(source.reading.camera, 1);
    const bool is_same = reuses && lane.last.is_same(lane.gpu, inputs, settings.estimator);
    const FrameOutputs outputs =
        is_same ? lane.last.outputs() : run_chain(lane.gpu, inputs, settings.estimator, settings.output);
    if (!is_same) lane.gpu.run();
    if (reuses) lane.last.keep(outputs);
    Made made{{}, is_same};
    for (const auto plane : result_planes(outputs, window, settings.output))
      made.values.insert(made.values.end(), plane.begin(), plane.end());
    return made;
  }

  /// In one lane, and in two: there the second frame goes to the other one, so that the third comes after the first.
  void expect_told_apart(const Change& change) const {
    const Settings settings[] = {settings_of(change.beside + " " + change.one),
                                 settings_of(change.beside + " " + change.other)};
    Lane fresh(device()), only(device()), first(device()), second(device());
    const std::vector<float> expected[] = {made(fresh, settings[0], false).values,
                                           made(fresh, settings[1], false).values};
    EXPECT_FALSE(same_bits(expected[0], expected[1])) << "both values give the same";
    const auto expect = [&](Lane& lane, int value, bool is_reused) {
      const Made made_here = made(lane, settings[value], true);
      EXPECT_TRUE(same_bits(made_here.values, expected[value])) << value;
      EXPECT_EQ(made_here.is_reused, is_reused) << value;
    };
    expect(only, 0, false);
    expect(only, 1, false);
    expect(only, 1, true);
    expect(only, 0, false);
    expect(first, 0, false);
    expect(second, 1, false);
    expect(first, 1, false);
    expect(second, 0, false);
  }
};

TEST_F(ReuseOfOptions, none_that_says_what_an_input_is_or_means_is_forgotten) {
  ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
  for (const SettingRow& row : option_table()) {
    if (!is_of_inputs(row)) continue;
    SCOPED_TRACE(row.long_name());
    const auto found = kChanges.find(row.key());
    if (found == kChanges.end()) {
      ADD_FAILURE() << "give it two values above, with which two frames differ";
      continue;
    }
    const Change& change = found->second;
    if (!change.why_not.empty()) continue;
    try {
      expect_told_apart(change);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

}  // namespace
}  // namespace alcove::reuse_options_test
