// Runs with --behind: which bits depend on it and which do not, what is counted and written, and every mistake in the
// files.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"
#include "tests/support/picture_file.h"

namespace alcove::hidden_run_test {
namespace {

using namespace test;

/// A plate that stands 2 in front of the wall and above the floor, and layers of what it hides and of what the wall
/// hides.
class HiddenRun : public CommandLine {
 protected:
  HiddenRun() {
    FrameFile wall = wall_frame();
    std::vector<float>& z = wall.planes.at("ViewLayer.Depth.Z");
    std::vector<float> behind_plate(z.size(), 0), behind_wall(z.size(), 0), back(z.size(), 0);
    for (std::size_t i = 0; i < z.size(); i++) {
      behind_wall[i] = 9 + 0.5f * float(i % 3);
      if (!is_plate(i)) continue;
      behind_plate[i] = z[i];
      z[i] = kPlate;
      back[i] = kPlate + 0.25f;
    }
    wall.write(frame);
    first = z;
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
  void write_layer(const std::string& name, const std::vector<float>& z) const { write_plane(folder / name, "Z", z); }

  /// The options that give these files, and more.
  Options behind(const std::string& names, const std::string& more = {}) const {
    Options options;
    for (const auto& name : typed(names)) options.insert(options.end(), {"--behind", folder / (name + ".exr")});
    return joined(options, typed(more));
  }
  std::vector<float> result(const Options& options) const { return computed(options).pixels; }
  std::string said(const std::string& names, const std::string& more = {}) const {
    return run(behind(names, more)).err;
  }

  static constexpr float kPlate = 2.5f;
  std::vector<float> first;
};

TEST_F(HiddenRun, writes_the_surfaces_that_it_was_given_nearer_first) {
  const Image image = computed(behind("wall back plate", "--behind-kind surfaces,backs,surfaces --aov hidden,depth"));
  ASSERT_EQ(image.names.size(), 7);
  const std::size_t plate = 20 * 64 + 30, wall = 4 * 64 + 3;
  EXPECT_NEAR(image.plane("hidden1.Z")[plate], 2.75f, 1e-4);
  EXPECT_NEAR(image.plane("hidden1.Z")[wall], 9.5f, 1e-4);
  EXPECT_EQ(image.plane("hidden1.back")[plate], 1) << "of a back, and of it alone";
  EXPECT_EQ(image.plane("hidden1.back")[wall], 0);
  EXPECT_LT(image.plane("hidden2.Z")[plate], 6.01f) << "the floor or the wall";
  EXPECT_NEAR(image.plane("hidden3.Z")[plate], 9, 1.1);
  for (const char* name : {"hidden2.Z", "hidden3.Z"}) EXPECT_EQ(image.plane(name)[wall], 1e30f);
}

TEST_F(HiddenRun, other_ways_to_the_same_surfaces_change_no_bit) {
  const auto one = result(behind("wall back plate", "--behind-kind surfaces,backs,fronts --aov ao,hidden"));
  const std::string header = text_in(read_header(ao), "alcove/hidden");
  EXPECT_EQ(header, "back.exr Z backs; plate.exr Z fronts; wall.exr Z surfaces");
  EXPECT_TRUE(result(behind("plate wall back", "--behind-kind fronts,surfaces,backs --aov ao,hidden")) == one);
  EXPECT_EQ(text_in(read_header(ao), "alcove/hidden"), header);
  // A copy of the first surface, one beyond the radius, and those that are not kept, are as good as none.
  const auto plain = result({});
  for (const auto& [names, more] : {std::pair("far copy copy", ""), {"plate wall", "--set hidden=0"}})
    EXPECT_TRUE(result(behind(names, more)) == plain) << names;
  EXPECT_EQ(text_in(read_header(ao), "alcove/hidden"), "(none)");
  // A thickness is a back so far behind the first surface.
  std::vector<float> thickness(kWallWindow.pixels(), 0);
  for (std::size_t i = 0; i < thickness.size(); i++)
    if (is_plate(i)) thickness[i] = 0.25f;
  write_layer("thickness.exr", thickness);
  const std::string aov = "--aov hidden --set hidden=1 --behind-kind ";
  EXPECT_TRUE(result(behind("thickness", aov + "thickness")) == result(behind("back", aov + "backs")));
  for (float& t : thickness) t = -t;
  write_layer("thickness.exr", thickness);
  expect_refused(3, behind("thickness", aov + "thickness"),
                 {folder / "thickness.exr", "Z is below 0", "--set behind-channel", "--behind-kind"});
}

TEST_F(HiddenRun, counts_what_is_kept_and_what_is_dropped) {
  const std::string kinds = "--behind-kind surfaces,surfaces,backs";
  const int plate = 20 * 20, pixels = int(kWallWindow.pixels());
  const json all = stats_of(behind("plate wall back", kinds))["frames"][0]["hidden"],
             one = stats_of(behind("plate wall back", kinds + " --set hidden=1"))["frames"][0]["hidden"];
  EXPECT_EQ(all["surfaces"], pixels + 2 * plate);
  EXPECT_EQ(all["dropped"], 0);
  EXPECT_EQ(one["surfaces"], pixels);
  EXPECT_EQ(one["dropped"], 2 * plate);
  EXPECT_FALSE(stats_of({})["frames"][0].contains("hidden"));
}

TEST_F(HiddenRun, draws_how_many_there_are) {
  const auto greens = [&](const std::string& names) {  // of the plate and of the wall: more is more surfaces
    done(behind(names, "--set debug=hidden"));
    const Image shown = whole(*open_picture(folder / "ao.hidden.png", "INPUT"));
    return std::pair(shown.plane(1)[20 * 64 + 30], shown.plane(1)[4 * 64 + 3]);
  };
  const auto [one, same] = greens("wall");
  EXPECT_EQ(one, same) << "one surface behind both";
  const auto [two, still_one] = greens("plate wall");
  EXPECT_EQ(still_one, one);
  EXPECT_GT(two, one);
}

TEST_F(HiddenRun, resume_sees_a_layer_that_is_changed_or_added) {
  const auto kept = [&](const std::string& names, const std::string& more = {}) {
    return stats_of(joined(behind(names, more), {"--resume"}))["frames"][0]["state"] == "kept";
  };
  EXPECT_FALSE(kept("plate"));
  EXPECT_TRUE(kept("plate"));
  EXPECT_FALSE(kept("plate wall"));
  EXPECT_TRUE(kept("plate wall"));
  EXPECT_FALSE(kept("plate wall", "--behind-kind fronts"));
  EXPECT_FALSE(kept("plate wall"));
  const auto written = fs::last_write_time(folder / "wall.exr");
  write_layer("wall.exr", std::vector<float>(kWallWindow.pixels(), 7));
  fs::last_write_time(folder / "wall.exr", written);
  EXPECT_FALSE(kept("plate wall")) << "by its bytes, since its time is as it was";
}

TEST_F(HiddenRun, takes_another_channel_of_input) {
  FrameFile both = wall_frame();
  both.planes["ViewLayer.Depth.Z"] = first;
  both.planes["layer2.Z"] = std::vector<float>(kWallWindow.pixels(), 9);
  both.write(frame);
  const Options own{"--behind", frame};
  EXPECT_EQ(
      computed(joined(own, typed("--set behind-channel=layer2.Z --aov hidden --set hidden=1"))).plane("hidden1.Z")[5],
      9);
  expect_refused(3, own, {frame, "ViewLayer.Depth.Z is the depth of the frame itself", "--set behind-channel"});
  expect_refused(3, joined(own, typed("--set behind-channel=layer3.Z")), {frame, "layer3.Z", "--set behind-channel"});
}

TEST_F(HiddenRun, what_is_not_of_the_same_pixels_or_depth_is_refused_with_both_files) {
  write_plane(folder / "small.exr", "Z", std::vector<float>(32 * 36, 9), {0, 0, 32, 36});
  write_plane(folder / "overscan.exr", "Z", std::vector<float>(kWallWindow.pixels(), 9), kWallWindow,
              Window{2, 0, 60, 36});
  std::vector<float> metres = first, ray = first, other = first;
  for (std::size_t i = 0; i < first.size(); i++) {
    metres[i] = 0.01f * first[i] * (1 + 0.001f * float(i % 7));
    ray[i] = float(first[i] * ray_length(i));
    other[i] = i % 5 < 3 ? 0.8f * first[i] : 7;
  }
  write_layer("metres.exr", metres);
  write_layer("ray.exr", ray);
  write_layer("other.exr", other);
  const std::pair<const char*, Options> rows[] = {
      {"small", {"display window", "32x36", frame, "64x36", "--behind"}},
      {"overscan", {"display window", frame, "--behind"}},
      {"plate nowhere", {"--behind"}},
      {"plate metres",
       {"before the first surface on 100 %", "0.01 times", "--set behind-channel", "--depth-kind", "--depth-scale",
        frame}},
      {"ray", {"if read as along the ray", "is read as planar", "--depth-kind"}},
      {"other", {"before the first surface on 60 %", "--behind", "--set behind-channel", frame}}};
  for (const auto& [names, texts] : rows)
    expect_refused(3, behind(names), joined({folder / (typed(names).back() + ".exr")}, texts));
  expect_refused(2, behind("plate", "--aov hidden --set hidden=0"), {"--aov hidden", "--set hidden=0"});
}

TEST_F(HiddenRun, another_camera_in_the_header_is_noted) {
  FrameFile both = wall_frame();
  both.attributes = {{"cameraFov", "50"}, {"cameraTransform", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"}};
  both.write(frame);
  for (const char* fov : {"50", "40"}) {
    FrameFile layer;
    layer.planes["Z"] = std::vector<float>(kWallWindow.pixels(), 9);
    layer.attributes = both.attributes;
    layer.attributes["cameraFov"] = fov;
    layer.write(folder / "layer.exr");
    const bool is_noted =
        said("layer").find("the camera in the header of " + (folder / "layer.exr")) != std::string::npos;
    EXPECT_EQ(is_noted, fov == std::string("40"));
  }
}

TEST_F(HiddenRun, layers_without_use_are_noted) {
  write_layer("empty.exr", std::vector<float>(kWallWindow.pixels(), NAN));
  write_layer("same.exr", read_exr_image(folder / "wall.exr").pixels);
  write_layer("thickness.exr", std::vector<float>(kWallWindow.pixels(), 0.25f));
  std::vector<float> shifted = first;
  for (std::size_t i = 0; i < shifted.size(); i++) shifted[i] = is_plate(i) ? 6 : i % 3 == 0 ? 0.8f * first[i] : 7;
  write_layer("shifted.exr", shifted);
  FrameFile half;
  half.planes["Z"] = std::vector<float>(kWallWindow.pixels(), 9);
  half.halves = {"Z"};
  half.write(folder / "half.exr");
  const std::string nothing_new = "wall.exr: Z shows nothing new: earlier planes";
  const std::tuple<const char*, const char*, Options> rows[] = {
      {"copy empty shifted half",
       "",
       {"[nothing-hidden]", "shows nothing but the first surface", folder / "copy.exr", "--set behind-channel",
        "or give another file", "[empty-layer]", "[before-first]", "[half-depth]", "stored as half float"}},
      {"same plate wall", "", {"[nothing-hidden]", nothing_new}},
      {"far", "--behind-kind thickness", {"[said-otherwise]", folder / "far.exr", "--behind-kind backs"}}};
  for (const auto& [names, more, texts] : rows) {
    const std::string text = said(names, more);
    for (const auto& part : texts) EXPECT_THAT(text, HasSubstr(part));
  }
  for (const auto& [names, more] :
       {std::pair("plate wall same", "--behind-kind surfaces,surfaces,backs"),  // that they are backs is new
        {"thickness", "--behind-kind thickness"}})
    EXPECT_THAT(said(names, more),
                Not(ContainsRegex("nothing-hidden|empty-layer|before-first|nothing new|said-otherwise")));
}

TEST_F(HiddenRun, a_dry_run_names_the_files_and_their_memory) {
  EXPECT_THAT(done(behind("plate wall", "--dry-run")).out,
              AllOf(HasSubstr("--behind"), HasSubstr(folder / "plate.exr"), HasSubstr(folder / "wall.exr")));
  // A frame of which a plane is 1 MiB.
  const Window large{0, 0, 512, 512};
  wall_frame(large, large).write(frame);
  write_bytes(camera, wall_camera(large).dump());
  write_plane(folder / "large.exr", "Z", std::vector<float>(large.pixels(), 9), large);
  const auto memory = [&](const char* names) {
    const std::string text = done(behind(names, "--dry-run")).out;
    return std::stoi(text.substr(text.find("memory ") + std::string("memory ").size()));
  };
  const int none = memory(""), one = memory("large"), two = memory("large large"), plane = 4 * 512 * 512 >> 20;
  EXPECT_GE(one, none + 6 * plane - 1) << "as it is read and found, what is kept, of what kind, and where it ends";
  EXPECT_GE(two, one + 2 * plane - 1);
}

TEST_F(HiddenRun, layers_of_a_sequence_go_with_its_frames) {
  for (int number = 1; number <= 2; number++) {
    fs::copy_file(frame, folder / fmt::format("f.{}.exr", number));
    write_layer(fmt::format("peel.{}.exr", number), std::vector<float>(kWallWindow.pixels(), float(8 + number)));
  }
  const Options sequence{
      "run",      folder / "f.%d.exr",    "-o",    folder / "out.%d.exr", "--camera", camera,    "--radius", "1",
      "--behind", folder / "peel.%d.exr", "--aov", "ao,hidden",           "--set",    "hidden=1"};
  run_well(sequence);
  for (int number = 1; number <= 2; number++)
    EXPECT_EQ(read_exr_image(folder / fmt::format("out.{}.exr", number), {"hidden1.Z"}).pixels[7], float(8 + number));
  fs::remove(folder / "peel.2.exr");
  test::expect_refused(run_program(sequence), 3, {"--behind"});
}

TEST_F(HiddenRun, inspect_proposes_channels_that_may_be_hidden_and_reads_none_of_them) {
  FrameFile both = wall_frame();
  for (const char* name : {"Layer2.Z", "zback", "Peel3.Z", "depth_back", "uvback.Z"})
    both.planes[name] = std::vector<float>(kWallWindow.pixels(), 9);
  both.write(frame);
  const json found = json::parse(run_program({"inspect", frame, "--camera", camera, "--json"}).out);
  std::vector<std::string> channels;
  for (const auto& guess : found["hidden"]) channels.push_back(guess["channel"]);
  EXPECT_THAT(channels, UnorderedElementsAre("Layer2.Z", "zback", "Peel3.Z", "depth_back"));
  EXPECT_THAT(found["hidden_options"].get<std::string>(),
              AllOf(HasSubstr("--behind " + frame), HasSubstr("--set behind-channel"), HasSubstr("backs")));
  EXPECT_THAT(found["command"].get<std::string>(), Not(HasSubstr("--behind")));
  EXPECT_THAT(run_program({"inspect", frame, "--camera", camera}).out,
              AllOf(HasSubstr("perhaps hidden surfaces: Layer2.Z"), HasSubstr("--set behind-channel")));
  done({"--behind", frame, "--set", "behind-channel=Layer2.Z", "--aov", "hidden"});
}

}  // namespace
}  // namespace alcove::hidden_run_test
