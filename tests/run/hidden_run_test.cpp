// Runs with --behind: which bits depend on it and which do not, what is counted and written, and every mistake in the
// files.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/formats/exr.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using Options = std::vector<std::string>;

/// A plate that stands 2 in front of the wall and above the floor, and layers of what it hides and of what the wall
/// hides.
class HiddenRun : public CommandLine {
 protected:
  HiddenRun() {
    FrameFile wall = wall_frame();
    std::vector<float>& z = wall.planes.at("ViewLayer.Depth.Z");
    const std::vector<float> without = z;
    for (std::size_t i = 0; i < z.size(); i++)
      if (is_plate(i)) z[i] = kPlate;
    wall.write(frame);
    first = z;
    std::vector<float> behind_plate(z.size(), 0), behind_wall(z.size(), 0), back(z.size(), 0);
    for (std::size_t i = 0; i < z.size(); i++) {
      if (is_plate(i)) behind_plate[i] = without[i];
      if (is_plate(i)) back[i] = kPlate + 0.25f;
      behind_wall[i] = 9 + 0.5f * float(i % 3);
    }
    write_layer("plate.exr", behind_plate);
    write_layer("wall.exr", behind_wall);
    write_layer("back.exr", back);
    write_layer("far.exr", std::vector<float>(z.size(), 50));
    write_layer("copy.exr", z);
  }

  static bool is_plate(std::size_t i) {
    const int x = int(i) % kWallWindow.width, y = int(i) / kWallWindow.width;
    return x >= 20 && x < 40 && y >= 8 && y < 28;
  }

  void write_layer(const std::string& name, const std::vector<float>& z, const std::string& channel = "Z") const {
    FrameFile layer;
    layer.planes[channel] = z;
    layer.write(folder / name);
  }

  Options behind(const std::vector<const char*>& names, const Options& more = {}) const {
    Options options{"--type", "float"};
    for (const char* name : names) options.insert(options.end(), {"--behind", folder / name});
    options.insert(options.end(), more.begin(), more.end());
    return options;
  }

  /// The pixels of all channels of the AO file, after a run that must succeed.
  std::map<std::string, std::vector<float>> result(const Options& options) const {
    const Finished finished = run(options);
    EXPECT_EQ(finished.code, 0) << finished;
    if (finished.code != 0) return {};
    ExrFile file(ao, "AO");
    std::map<std::string, std::vector<float>> planes;
    std::vector<ExrRead> reads;
    for (const auto& channel : file.parts()[0].channels) {
      planes[channel.name].resize(file.parts()[0].data.pixels());
      reads.push_back({0, channel.name, planes[channel.name].data()});
    }
    file.read(reads);
    return planes;
  }

  json stats_of(Options options) const {
    options.insert(options.end(), {"--stats", folder / "stats.json"});
    const Finished finished = run(options);
    EXPECT_EQ(finished.code, 0) << finished;
    return json::parse(read_bytes(folder / "stats.json"))["frames"][0];
  }

  void expect_refused(const Options& options, const std::vector<std::string>& words, int code = 3) const {
    const Finished finished = run(options);
    EXPECT_EQ(finished.code, code) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    for (const auto& word : words) EXPECT_THAT(finished.err, HasSubstr(word));
  }

  static constexpr float kPlate = 2.5f;
  std::vector<float> first;
};

TEST_F(HiddenRun, writes_the_surfaces_that_it_was_given_nearer_first) {
  const auto planes = result(behind({"wall.exr", "back.exr", "plate.exr"},
                                    {"--behind-kind", "surfaces,backs,surfaces", "--aov", "hidden,depth"}));
  ASSERT_EQ(planes.size(), 7);
  for (const auto& [i, expected] : {std::pair<std::size_t, std::vector<float>>{20 * 64 + 30, {2.75f, 0, 9, 1}},
                                    {4 * 64 + 3, {9.5f, 1e30f, 1e30f, 0}}}) {
    EXPECT_NEAR(planes.at("hidden1.Z")[i], expected[0], 1e-4);
    EXPECT_EQ(planes.at("hidden1.back")[i], expected[3]) << "of a back, and of it alone";
    if (expected[1] > 0)
      EXPECT_EQ(planes.at("hidden2.Z")[i], expected[1]);
    else
      EXPECT_LT(planes.at("hidden2.Z")[i], 6.01f) << "the floor or the wall";
    if (expected[2] > 1e9f)
      EXPECT_EQ(planes.at("hidden3.Z")[i], expected[2]);
    else
      EXPECT_NEAR(planes.at("hidden3.Z")[i], expected[2], 1.1);
  }
}

TEST_F(HiddenRun, the_order_of_files_changes_no_bit) {
  const auto one = result(
      behind({"wall.exr", "back.exr", "plate.exr"}, {"--behind-kind", "surfaces,backs,fronts", "--aov", "ao,hidden"}));
  const std::string header = text_in(read_header(ao), "alcove/hidden");
  const auto other = result(
      behind({"plate.exr", "wall.exr", "back.exr"}, {"--behind-kind", "fronts,surfaces,backs", "--aov", "ao,hidden"}));
  EXPECT_TRUE(one == other);
  EXPECT_EQ(header, "back.exr Z backs; plate.exr Z fronts; wall.exr Z surfaces");
  EXPECT_EQ(text_in(read_header(ao), "alcove/hidden"), header);
}

TEST_F(HiddenRun, a_copy_of_the_first_surface_and_one_beyond_the_radius_change_no_bit) {
  const auto plain = result({"--type", "float"});
  EXPECT_TRUE(result(behind({"copy.exr"})) == plain);
  EXPECT_TRUE(result(behind({"far.exr"})) == plain);
  EXPECT_TRUE(result(behind({"far.exr", "copy.exr", "copy.exr"})) == plain);
}

TEST_F(HiddenRun, nothing_is_kept_where_nothing_is_asked_for) {
  const auto plain = result({"--type", "float"});
  EXPECT_TRUE(result(behind({"plate.exr", "wall.exr"}, {"--set", "hidden=0"})) == plain);
  EXPECT_EQ(text_in(read_header(ao), "alcove/hidden"), "(none)");
}

TEST_F(HiddenRun, a_region_has_the_bits_of_the_whole) {
  const Options options = behind({"plate.exr", "wall.exr"}, {"--aov", "ao,hidden"});
  auto whole = result(options);
  const Window region{18, 10, 17, 12};
  for (auto& [channel, pixels] : whole) pixels = cropped(pixels, kWallWindow, region);
  Options with_region = options;
  with_region.insert(with_region.end(), {"--roi", "18,10,17,12"});
  EXPECT_TRUE(result(with_region) == whole);
}

TEST_F(HiddenRun, counts_what_is_kept_and_what_is_dropped) {
  const Options layers = behind({"plate.exr", "wall.exr", "back.exr"}, {"--behind-kind", "surfaces,surfaces,backs"});
  const json all = stats_of(layers);
  const int plate = 20 * 20, pixels = int(kWallWindow.pixels());
  EXPECT_EQ(all["hidden"]["surfaces"], pixels + 2 * plate);
  EXPECT_EQ(all["hidden"]["dropped"], 0);
  Options two = layers;
  two.insert(two.end(), {"--set", "hidden=1"});
  const json one = stats_of(two);
  EXPECT_EQ(one["hidden"]["surfaces"], pixels);
  EXPECT_EQ(one["hidden"]["dropped"], 2 * plate);
  EXPECT_FALSE(stats_of({}).contains("hidden"));
}

TEST_F(HiddenRun, draws_how_many_there_are) {
  EXPECT_EQ(run(behind({"plate.exr", "wall.exr"}, {"--set", "debug=hidden"})).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "ao.hidden.png"));
}

TEST_F(HiddenRun, resume_sees_a_layer_that_is_changed_or_added) {
  const auto kept = [&](const Options& options) {
    Options with = options;
    with.emplace_back("--resume");
    return stats_of(with)["state"] == "kept";
  };
  EXPECT_FALSE(kept(behind({"plate.exr"})));
  EXPECT_TRUE(kept(behind({"plate.exr"})));
  EXPECT_FALSE(kept(behind({"plate.exr", "wall.exr"})));
  EXPECT_TRUE(kept(behind({"plate.exr", "wall.exr"})));
  EXPECT_FALSE(kept(behind({"plate.exr", "wall.exr"}, {"--behind-kind", "fronts"})));
  EXPECT_FALSE(kept(behind({"plate.exr", "wall.exr"})));
  const auto written = std::filesystem::last_write_time(folder / "wall.exr");
  write_layer("wall.exr", std::vector<float>(kWallWindow.pixels(), 7));
  std::filesystem::last_write_time(folder / "wall.exr", written);
  EXPECT_FALSE(kept(behind({"plate.exr", "wall.exr"}))) << "by its bytes, since its time is as it was";
}

TEST_F(HiddenRun, takes_another_channel_of_input) {
  FrameFile both = wall_frame();
  both.planes["ViewLayer.Depth.Z"] = first;
  both.planes["layer2.Z"] = std::vector<float>(kWallWindow.pixels(), 9);
  both.write(frame);
  const Options options{"--behind", frame, "--set", "behind-channel=layer2.Z", "--aov", "hidden", "--set", "hidden=1"};
  EXPECT_EQ(result(options).at("hidden1.Z")[5], 9);
  expect_refused({"--behind", frame},
                 {frame, "ViewLayer.Depth.Z is the depth of the frame itself", "--set behind-channel"});
  expect_refused({"--behind", frame, "--set", "behind-channel=layer3.Z"}, {frame, "layer3.Z", "--set behind-channel"});
}

TEST_F(HiddenRun, a_thickness_is_added_to_the_first_surface) {
  std::vector<float> thickness(kWallWindow.pixels(), 0);
  for (std::size_t i = 0; i < thickness.size(); i++)
    if (is_plate(i)) thickness[i] = 0.25f;
  write_layer("thickness.exr", thickness);
  const Options aov{"--aov", "hidden", "--set", "hidden=1"};
  Options with_kind = aov;
  with_kind.insert(with_kind.end(), {"--behind-kind", "thickness"});
  const auto by_thickness = result(behind({"thickness.exr"}, with_kind));
  with_kind.back() = "backs";
  EXPECT_TRUE(by_thickness == result(behind({"back.exr"}, with_kind)));
  for (float& t : thickness) t = -t;
  write_layer("thickness.exr", thickness);
  with_kind.back() = "thickness";
  expect_refused(behind({"thickness.exr"}, with_kind),
                 {folder / "thickness.exr", "Z is below 0", "--set behind-channel", "--behind-kind"});
}

TEST_F(HiddenRun, what_is_not_of_the_same_pixels_is_refused_with_both_files) {
  FrameFile small;
  small.data = small.display = {0, 0, 32, 36};
  small.planes["Z"] = std::vector<float>(small.data.pixels(), 9);
  small.write(folder / "small.exr");
  expect_refused(behind({"small.exr"}), {folder / "small.exr", "display window", "32x36", frame, "64x36", "--behind"});
  FrameFile overscan;
  overscan.display = {2, 0, 60, 36};
  overscan.planes["Z"] = std::vector<float>(overscan.data.pixels(), 9);
  overscan.write(folder / "overscan.exr");
  expect_refused(behind({"overscan.exr"}), {folder / "overscan.exr", "display window", frame, "--behind"});
  write_layer("nameless.exr", first, "A.U");
  expect_refused(behind({"plate.exr", "nowhere.exr"}), {folder / "nowhere.exr", "--behind"});
}

TEST_F(HiddenRun, another_camera_in_the_header_is_noted) {
  FrameFile both = wall_frame();
  both.attributes = {{"cameraFov", "50"}, {"cameraTransform", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"}};
  const auto say = [&](const char* fov) {
    FrameFile layer;
    layer.planes["Z"] = std::vector<float>(kWallWindow.pixels(), 9);
    layer.attributes = both.attributes;
    layer.attributes["cameraFov"] = fov;
    layer.write(folder / "layer.exr");
    return run(behind({"layer.exr"})).err;
  };
  both.write(frame);
  EXPECT_THAT(say("50"), Not(HasSubstr("the camera in the header")));
  EXPECT_THAT(say("40"), AllOf(HasSubstr("the camera in the header of " + folder / "layer.exr"), HasSubstr(frame)));
}

TEST_F(HiddenRun, another_scale_or_kind_of_depth_is_refused) {
  std::vector<float> z(kWallWindow.pixels());
  for (std::size_t i = 0; i < z.size(); i++) z[i] = 0.01f * first[i] * (1 + 0.001f * float(i % 7));
  write_layer("metres.exr", z);
  expect_refused(behind({"plate.exr", "metres.exr"}),
                 {folder / "metres.exr", "before the first surface on 100 %", "0.01 times", "--set behind-channel",
                  "--depth-kind", "--depth-scale", frame});
  for (std::size_t i = 0; i < z.size(); i++) {
    const double x = (double(i % 64) + 0.5 - 32) / 60, y = (double(i / 64) + 0.5 - 18) / 60;
    z[i] = float(first[i] * std::sqrt(1 + x * x + y * y));
  }
  write_layer("ray.exr", z);
  expect_refused(behind({"ray.exr"}),
                 {folder / "ray.exr", "if it is along the ray", "is read as planar", "--depth-kind"});
}

TEST_F(HiddenRun, layers_without_use_are_noted) {
  EXPECT_THAT(run(behind({"copy.exr"})).err,
              AllOf(HasSubstr("[nothing-hidden]"), HasSubstr(folder / "copy.exr"), HasSubstr("--set behind-channel"),
                    HasSubstr("or give another file")));
  write_layer("empty.exr", std::vector<float>(kWallWindow.pixels(), NAN));
  EXPECT_THAT(run(behind({"empty.exr"})).err, HasSubstr("[empty-layer]"));
  std::vector<float> shifted = first;
  for (std::size_t i = 0; i < shifted.size(); i++) shifted[i] = is_plate(i) ? 6 : i % 3 == 0 ? 0.8f * first[i] : 7;
  write_layer("shifted.exr", shifted);
  EXPECT_THAT(run(behind({"shifted.exr"})).err, HasSubstr("[before-first]"));
  FrameFile half;
  half.planes["Z"] = std::vector<float>(kWallWindow.pixels(), 9);
  half.halves = {"Z"};
  half.write(folder / "half.exr");
  EXPECT_THAT(run(behind({"half.exr"})).err, AllOf(HasSubstr("[half-depth]"), HasSubstr("stored as half float")));
  const std::string none = run(behind({"plate.exr", "wall.exr"})).err;
  for (const char* code : {"nothing-hidden", "empty-layer", "before-first"}) EXPECT_THAT(none, Not(HasSubstr(code)));
}

TEST_F(HiddenRun, a_layer_that_is_given_twice_is_noted) {
  std::filesystem::copy_file(folder / "wall.exr", folder / "same.exr");
  const std::string nothing_new = "wall.exr: Z shows nothing new: what is given before it";
  EXPECT_THAT(run(behind({"wall.exr", "wall.exr"})).err, AllOf(HasSubstr("[nothing-hidden]"), HasSubstr(nothing_new)));
  EXPECT_THAT(run(behind({"same.exr", "plate.exr", "wall.exr"})).err, HasSubstr(nothing_new));
  EXPECT_THAT(run(behind({"wall.exr", "same.exr"}, {"--behind-kind", "surfaces,backs"})).err,
              Not(HasSubstr("nothing new")))
      << "that they are backs is new";
}

TEST_F(HiddenRun, a_layer_before_most_of_the_first_surface_is_refused) {
  std::vector<float> other = first;
  for (std::size_t i = 0; i < other.size(); i++) other[i] = i % 5 < 3 ? 0.8f * first[i] : 7;
  write_layer("other.exr", other);
  expect_refused(behind({"other.exr"}),
                 {folder / "other.exr", "before the first surface on 60 %", "--behind", "--set behind-channel", frame});
}

TEST_F(HiddenRun, a_depth_that_is_said_to_be_a_thickness_is_noted) {
  const Options thickness{"--behind-kind", "thickness"};
  EXPECT_THAT(run(behind({"far.exr"}, thickness)).err,
              AllOf(HasSubstr("[said-otherwise]"), HasSubstr(folder / "far.exr"), HasSubstr("--behind-kind backs")));
  write_layer("thickness.exr", std::vector<float>(kWallWindow.pixels(), 0.25f));
  EXPECT_THAT(run(behind({"thickness.exr"}, thickness)).err, Not(HasSubstr("said-otherwise")));
}

TEST_F(HiddenRun, outputs_of_what_is_hidden_need_something_that_is) {
  expect_refused({"--aov", "hidden"}, {"--aov hidden", "--behind", "--around"}, 2);
  expect_refused({"--set", "debug=hidden"}, {"--set debug=hidden", "--behind"}, 2);
  expect_refused(behind({"plate.exr"}, {"--aov", "hidden", "--set", "hidden=0"}), {"--aov hidden", "--set hidden=0"},
                 2);
}

TEST_F(HiddenRun, a_dry_run_names_the_files_and_their_memory) {
  const auto told = [&](const Options& options) {
    Options with = options;
    with.emplace_back("--dry-run");
    const Finished finished = run(with);
    EXPECT_EQ(finished.code, 0) << finished;
    return finished.out;
  };
  EXPECT_THAT(told(behind({"plate.exr", "wall.exr"})),
              AllOf(HasSubstr("--behind"), HasSubstr(folder / "plate.exr"), HasSubstr(folder / "wall.exr")));
  // A frame of which a plane is 1 MiB.
  const Window large{0, 0, 512, 512};
  wall_frame(large, large).write(frame);
  write_bytes(camera, wall_camera(large).dump());
  FrameFile layer{large, large, 1, {}, {}, {}};
  layer.planes["Z"] = std::vector<float>(large.pixels(), 9);
  layer.write(folder / "large.exr");
  const auto memory = [&](const Options& options) {
    const std::string text = told(options);
    return std::stoi(text.substr(text.find("memory ") + std::string("memory ").size()));
  };
  const int none = memory({}), one = memory(behind({"large.exr"})), two = memory(behind({"large.exr", "large.exr"}));
  const int plane = 4 * 512 * 512 >> 20;
  EXPECT_GE(one, none + 6 * plane - 1) << "as it is read and found, what is kept, of what kind, and where it ends";
  EXPECT_GE(two, one + 2 * plane - 1);
}

TEST_F(HiddenRun, layers_of_a_sequence_go_with_its_frames) {
  for (int number = 1; number <= 2; number++) {
    std::filesystem::copy_file(frame, folder / fmt::format("f.{}.exr", number));
    write_layer(fmt::format("peel.{}.exr", number), std::vector<float>(kWallWindow.pixels(), float(8 + number)));
  }
  const Finished finished =
      run_program({"run", folder / "f.%d.exr", "-o", folder / "out.%d.exr", "--camera", camera, "--radius", "1",
                   "--behind", folder / "peel.%d.exr", "--aov", "ao,hidden", "--set", "hidden=1"});
  ASSERT_EQ(finished.code, 0) << finished;
  for (int number = 1; number <= 2; number++)
    EXPECT_EQ(read_exr_image(folder / fmt::format("out.{}.exr", number), {"hidden1.Z"}).pixels[7], float(8 + number));
  std::filesystem::remove(folder / "peel.2.exr");
  const Finished missing = run_program({"run", folder / "f.%d.exr", "-o", folder / "out.%d.exr", "--camera", camera,
                                        "--radius", "1", "--behind", folder / "peel.%d.exr"});
  EXPECT_EQ(missing.code, 3) << missing;
  EXPECT_THAT(missing.err, HasSubstr("--behind"));
}

TEST_F(HiddenRun, inspect_proposes_channels_that_may_be_hidden_and_reads_none_of_them) {
  FrameFile both = wall_frame();
  for (const char* name : {"Layer2.Z", "zback", "Peel3.Z", "depth_back", "uvback.Z"})
    both.planes[name] = std::vector<float>(kWallWindow.pixels(), 9);
  both.write(frame);
  const Finished finished = run_program({"inspect", frame, "--camera", camera, "--json"});
  ASSERT_EQ(finished.code, 0) << finished;
  const json found = json::parse(finished.out);
  std::vector<std::string> channels;
  for (const auto& guess : found["hidden"]) channels.push_back(guess["channel"]);
  EXPECT_THAT(channels, testing::UnorderedElementsAre("Layer2.Z", "zback", "Peel3.Z", "depth_back"));
  EXPECT_THAT(found["hidden_options"].get<std::string>(),
              AllOf(HasSubstr("--behind " + frame), HasSubstr("--set behind-channel"), HasSubstr("backs")));
  EXPECT_THAT(found["command"].get<std::string>(), Not(HasSubstr("--behind")));
  EXPECT_THAT(run_program({"inspect", frame, "--camera", camera}).out,
              AllOf(HasSubstr("perhaps hidden surfaces: Layer2.Z"), HasSubstr("--set behind-channel")));
  const Finished proposed = run({"--behind", frame, "--set", "behind-channel=Layer2.Z", "--aov", "hidden"});
  EXPECT_EQ(proposed.code, 0) << proposed;
}

}  // namespace
}  // namespace alcove
