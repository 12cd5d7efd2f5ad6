// What comes out besides plain AO: AOVs by name, rgb, multi-bounce, material AO and fog, from files to files.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/formats/exr.h"
#include "core/run/resume.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

class Aovs : public CommandLine {
 protected:
  using Planes = std::span<const float>;

  /// Makes a run that must succeed, and returns what OUTPUT holds then.
  Image good(const std::vector<std::string>& more) {
    const Finished finished = run(more);
    EXPECT_EQ(finished.code, 0) << finished;
    return read_exr_image(ao);
  }

  /// Makes a run that must end with this code and one line that holds the words, and must leave nothing behind.
  void expect_refused(int code, const std::vector<std::string>& words, const std::vector<std::string>& more) {
    const auto before = names_in(folder.path());
    const Finished finished = run(more);
    EXPECT_EQ(finished.code, code) << testing::PrintToString(more) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    for (const auto& word : words) EXPECT_THAT(finished.err, HasSubstr(word)) << testing::PrintToString(more);
    EXPECT_EQ(names_in(folder.path()), before) << testing::PrintToString(more);
  }

  std::vector<HeaderChannel> channels() const { return channels_in(read_header(ao)); }

  /// The passes of the last run, by the statistics that it wrote.
  std::vector<std::string> passes() const {
    std::vector<std::string> names;
    const auto report = nlohmann::json::parse(read_bytes(stats));
    for (const auto& pass : report.at("frames")[0].at("passes")) names.push_back(pass.at("name"));
    return names;
  }

  FrameFile input = wall_frame();
  const std::string stats = folder / "stats.json", composite = folder / "composite.exr", other = folder / "other.exr";
};

bool is_floor(const Image& image, std::size_t i) { return image.plane("ViewLayer.Normal.Z")[i] == 1; }

// AOVs.

TEST_F(Aovs, all_of_them_lie_in_one_file_under_their_names) {
  const Image result = good({"--aov", "specular-occlusion, ao,normal,depth,ao"});
  EXPECT_THAT(channels(),
              ElementsAre(HeaderChannel{"Y", 1}, HeaderChannel{"Z", 2}, HeaderChannel{"normal.X", 1},
                          HeaderChannel{"normal.Y", 1}, HeaderChannel{"normal.Z", 1}, HeaderChannel{"specular.Y", 1}));
  const Image plain = good({});
  EXPECT_THAT(channels(), ElementsAre(HeaderChannel{"Y", 1}));
  EXPECT_TRUE(std::ranges::equal(result.plane("Y"), plain.plane("Y"))) << "another AOV changes the AO";
}

TEST_F(Aovs, type_is_that_of_all_but_depth) {
  good({"--aov", "ao,depth,specular-occlusion", "--type", "float"});
  for (const auto& channel : channels()) EXPECT_EQ(channel.type, 2) << channel.name;
}

TEST_F(Aovs, depth_is_planar_in_scene_units_and_sky_is_1e30) {
  input.planes["ViewLayer.Depth.Z"][5] = 1e10f;
  input.write(frame);
  const Image result = good({"--aov", "depth", "--depth-scale", "0.5"}), source = read_exr_image(frame);
  for (std::size_t i = 0; i < source.data.pixels(); i++)
    ASSERT_EQ(result.plane("Z")[i], i == 5 ? 1e30f : 0.5f * source.plane("ViewLayer.Depth.Z")[i]) << i;
}

TEST_F(Aovs, depth_near_the_eye_keeps_the_digits_that_a_logarithmic_depth_has) {
  constexpr double kFar = 1000, kSmall = 1e-4;
  auto& depth = input.planes["ViewLayer.Depth.Z"];
  std::vector<double> expected;
  for (float& z : depth) {
    z = float(std::log1p(kSmall * double(z)) / std::log1p(kFar));
    expected.push_back(std::expm1(double(z) * std::log1p(kFar)));
  }
  input.write(frame);
  const Image result = good({"--aov", "depth", "--depth-kind", "log", "--far", "1000", "--set", "log-constant=1"});
  for (std::size_t i = 0; i < expected.size(); i++) ASSERT_NEAR(result.plane("Z")[i] / expected[i], 1, 1e-6) << i;
}

TEST_F(Aovs, a_depth_that_was_written_is_read_again) {
  good({"--aov", "depth,normal,ao", "--type", "float"});
  const std::string written = folder / "written.0042.exr", again = folder / "again.exr";  // the number keeps the noise
  write_bytes(written, read_bytes(ao));
  const Finished finished =
      run_program({"run", written, "-o", again, "--camera", camera, "--radius", "1", "--type", "float"});
  ASSERT_EQ(finished.code, 0) << finished;
  const Image first = read_exr_image(ao), second = read_exr_image(again);
  for (std::size_t i = 0; i < first.data.pixels(); i++)
    ASSERT_NEAR(first.plane("Y")[i], second.plane("Y")[i], 1e-3) << i;
}

TEST_F(Aovs, normals_are_in_world_space_where_the_camera_has_it_else_in_view_space) {
  for (auto& [name, plane] : input.planes)
    // This normal must be reconstructed: on the wall it becomes that of its neighbours.
    if (name.find("Normal") != name.npos) plane[7] = 0;
  input.write(frame);
  const Image source = read_exr_image(frame);
  for (const char* space : {"auto", "world", "view"}) {
    const Image result = good({"--aov", "normal", "--set", std::string("aov-space=") + space});
    EXPECT_EQ(text_in(read_header(ao), "alcove/normal_space"), std::string(space) == "view" ? "view" : "world");
    for (std::size_t i = 0; i < source.data.pixels(); i++) {  // view space: x right, y up (world z), z back (world -y)
      const float up = is_floor(source, i) ? 1 : 0, back = 1 - up;
      ASSERT_NEAR(result.plane("normal.X")[i], 0, 2e-3) << i;
      ASSERT_NEAR(result.plane("normal.Y")[i], std::string(space) == "view" ? up : -back, 2e-3) << i;
      ASSERT_NEAR(result.plane("normal.Z")[i], std::string(space) == "view" ? back : up, 2e-3) << i;
    }
  }
  auto without = wall_camera();
  without.erase("world_to_camera");
  write_bytes(camera, without.dump());
  turn_normals_to_view(input);
  input.write(frame);
  good({"--aov", "normal", "--normal-space", "view"});
  EXPECT_EQ(text_in(read_header(ao), "alcove/normal_space"), "view");
  EXPECT_EQ(run({"--aov", "normal", "--normal-space", "view", "--set", "aov-space=world"}).code, 3);
}

TEST_F(Aovs, normals_of_the_sky_are_0) {
  input.planes["ViewLayer.Depth.Z"][5] = 1e10f;
  input.write(frame);
  const Image result = good({"--aov", "normal"});
  for (const char* name : {"normal.X", "normal.Y", "normal.Z"}) EXPECT_EQ(result.plane(name)[5], 0.0f) << name;
}

TEST_F(Aovs, only_what_was_asked_for_is_computed) {
  good({"--aov", "depth", "--stats", stats});
  EXPECT_THAT(passes(), ElementsAre("prepare", "reconstruct"));
  EXPECT_EQ(nlohmann::json::parse(read_bytes(stats)).at("frames")[0].at("samples_per_pixel"), 0);
  good({"--aov", "normal", "--stats", stats});
  EXPECT_THAT(passes(), ElementsAre("prepare", "reconstruct", "directions"));
  good({"--aov", "specular-occlusion", "--denoise", "none", "--stats", stats});
  EXPECT_THAT(passes(), ElementsAre("prepare", "reconstruct", "classify", "horizon", "completion", "bent_normal",
                                    "specular_occlusion"));
  good({"--denoise", "none", "--stats", stats});
  EXPECT_THAT(passes(), ElementsAre("prepare", "reconstruct", "classify", "horizon", "completion"));
}

TEST_F(Aovs, a_region_holds_what_the_whole_holds_there) {
  const std::vector<std::string> all{"--aov", "ao,normal,bent-normal,depth,specular-occlusion",
                                     "--set", "ao-channels=rgb",
                                     "--set", "multi-bounce=true",
                                     "--set", "albedo=0.7"};
  const Image whole = good(all);
  auto region = all;
  region.insert(region.end(), {"--roi", "20,10,9,20"});
  const Image part = good(region);
  ASSERT_EQ(part.data, (Window{20, 10, 9, 20}));
  EXPECT_EQ(part.names, whole.names);
  for (const auto& name : whole.names)
    for (int y = 0; y < 20; y++)
      for (int x = 0; x < 9; x++)
        ASSERT_EQ(part.plane(name)[std::size_t(y * 9 + x)], whole.plane(name)[std::size_t((y + 10) * 64 + x + 20)])
            << name << x << " " << y;
  EXPECT_EQ(run_program({"run", frame, "-o", ao, "--camera", camera, "--aov", "depth", "--roi", "20,10,9,20"}).code, 0)
      << "no radius, no surroundings";
  EXPECT_EQ(read_exr_image(ao).data, (Window{20, 10, 9, 20}));
}

TEST_F(Aovs, without_ao_no_radius_is_needed) {
  EXPECT_EQ(run_program({"run", frame, "-o", ao, "--camera", camera, "--aov", "depth,normal"}).code, 0);
  EXPECT_EQ(run_program({"run", frame, "-o", ao, "--camera", camera, "--aov", "depth,normal,ao"}).code, 2);
}

TEST_F(Aovs, unknown_ones_are_answered_with_all_there_are) {
  for (const char* list : {"nromal", "ao,nromal", "bent", "ao,,depth", ""})
    expect_refused(
        2, {"--aov", "ao, ao-scales, normal, bent-normal, depth, hidden, confidence, error, specular-occlusion"},
        {"--aov", list});
  expect_refused(2, {"did you mean normal?"}, {"--aov", "nromal"});
}

TEST_F(Aovs, specular_occlusion_follows_the_roughness) {
  const Image rough = good({"--aov", "ao,specular-occlusion", "--roughness", "0.9"}),
              smooth = good({"--aov", "ao,specular-occlusion", "--roughness", "0.1"});
  EXPECT_FALSE(std::ranges::equal(rough.plane("specular.Y"), smooth.plane("specular.Y")));
  for (const auto* image : {&rough, &smooth})
    for (std::size_t i = 0; i < image->data.pixels(); i++) {
      ASSERT_TRUE(image->plane("specular.Y")[i] >= 0 && image->plane("specular.Y")[i] <= 1) << i;
      // the AO is rounded to half: 1 stands for .9998 too
      if (image->plane("Y")[i] == 1) ASSERT_NEAR(image->plane("specular.Y")[i], 1, 0.03) << i;
    }
}

// Colour.

TEST_F(Aovs, rgb_without_multi_bounce_is_the_ao_three_times) {
  const Image mono = good({}), rgb = good({"--set", "ao-channels=rgb"});
  EXPECT_THAT(channels(), ElementsAre(HeaderChannel{"B", 1}, HeaderChannel{"G", 1}, HeaderChannel{"R", 1}));
  for (const char* name : {"R", "G", "B"}) EXPECT_TRUE(std::ranges::equal(rgb.plane(name), mono.plane("Y"))) << name;
}

/// The cubic of multi_bounce.comp.
double bounced(double ao, double albedo) {
  const double rho = std::clamp(albedo, 0.0, 1.0), a = 2.0404 * rho - 0.3324, b = -4.7951 * rho + 0.6417,
               c = 2.7552 * rho + 0.6903;
  return std::clamp(((a * ao + b) * ao + c) * ao, ao, 1.0);
}

TEST_F(Aovs, multi_bounce_takes_the_albedo_from_a_number_a_file_or_the_frame) {
  const Image mono = good({"--type", "float"});
  add_beauty(input);
  input.write(frame);
  FrameFile colors{input.data, input.display, 1, {}, {}, {}};
  for (const char* c : {"R", "G", "B"}) colors.planes[c] = input.planes["ViewLayer.Combined." + std::string(c)];
  colors.write(other);
  const auto expect_albedo = [&](const std::vector<std::string>& more,
                                 const std::function<double(const std::string&, std::size_t)>& albedo) {
    std::vector<std::string> arguments{"--set", "ao-channels=rgb", "--set", "multi-bounce=true", "--type", "float"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Image rgb = good(arguments);
    for (const std::string c : {"R", "G", "B"})
      for (std::size_t i = 0; i < mono.data.pixels(); i++)
        ASSERT_NEAR(rgb.plane(c)[i], bounced(mono.plane("Y")[i], albedo(c, i)), 1e-5) << c << i;
  };
  expect_albedo({"--set", "albedo=0.8"}, [](const std::string&, std::size_t) { return 0.8; });
  expect_albedo({"--set", std::string("albedo=") + other},
                [&](const std::string& c, std::size_t i) { return colors.planes[c][i]; });
  expect_albedo({}, [&](const std::string& c, std::size_t i) { return input.planes["ViewLayer.DiffCol." + c][i]; });
  expect_albedo({"--beauty", frame},
                [&](const std::string& c, std::size_t i) { return input.planes["ViewLayer.DiffCol." + c][i]; });
  expect_albedo({"--set", "albedo-channels=ViewLayer.DiffInd"},
                [&](const std::string& c, std::size_t i) { return input.planes["ViewLayer.DiffInd." + c][i]; });
}

TEST_F(Aovs, multi_bounce_says_what_it_lacks) {
  expect_refused(2, {"--set multi-bounce", "--set ao-channels=rgb", "--composite"}, {"--set", "multi-bounce=true"});
  expect_refused(2, {"--set albedo", "--set multi-bounce"}, {"--set", "albedo=0.5"});
  expect_refused(2, {"--set albedo", "1.5"},
                 {"--set", "albedo=1.5", "--set", "multi-bounce=true", "--set", "ao-channels=rgb"});
  expect_refused(3, {"wall.0042.exr", "--set multi-bounce", "--set albedo"},
                 {"--set", "multi-bounce=true", "--set", "ao-channels=rgb"});
  expect_refused(3, {"missing.exr", "--set albedo"},
                 {"--set", "multi-bounce=true", "--set", "ao-channels=rgb", "--set",
                  std::string("albedo=") + folder / "missing.exr"});
  expect_refused(2, {"overwrite an input"},
                 {"--set", "multi-bounce=true", "--set", "ao-channels=rgb", "--set", std::string("albedo=") + ao});
  add_beauty(input);
  for (const char* c : {"R", "G", "B"}) input.planes.erase("ViewLayer.DiffInd." + std::string(c));
  input.write(frame);
  expect_refused(3, {"--set multi-bounce", "indirect"},
                 {"--set", "multi-bounce=true", "--set", "albedo=0.5", "--composite", composite});
}

TEST_F(Aovs, composite_dims_each_colour_of_the_indirect_light_by_its_own_ao_and_less_through_fog) {
  add_beauty(input);
  input.write(frame);
  const Image source = read_exr_image(frame);
  const auto in = [&](const std::string& name, std::size_t i) { return double(source.plane("ViewLayer." + name)[i]); };
  for (const double density : {0.0, 0.3}) {
    const Image plain = good({"--type", "float", "--set", "multi-bounce=true", "--composite", composite, "--set",
                              std::string("fog-density=") + std::to_string(density), "--set", "composite-layers=rgba"});
    const Image result = read_exr_image(composite);
    const std::string how = text_in(read_header(composite), "alcove/composite");
    EXPECT_THAT(how, HasSubstr("multi-bounce"));
    EXPECT_EQ(how.find("fog of density 0.3") != how.npos, density > 0) << how;
    for (std::size_t i = 0; i < plain.data.pixels(); i++) {
      const double x = (double(i % 64) + 0.5 - 32) / 60, y = (double(i / 64) + 0.5 - 18) / 60,
                   distance = in("Depth.Z", i) * std::sqrt(1 + x * x + y * y);
      for (const std::string c : {"R", "G", "B"}) {
        const double f = 1 - in("Combined.A", i) * std::exp(-density * distance) *
                                 (1 - bounced(plain.plane("Y")[i], in("DiffCol." + c, i)));
        const double light = in("DiffInd." + c, i) * in("DiffCol." + c, i),
                     expected = in("Combined." + c, i) - light + light * f;
        ASSERT_NEAR(result.plane(c)[i], expected, 1e-5 * (1 + std::abs(expected))) << c << i;
      }
    }
  }
  expect_refused(2, {"--set fog-density", "--composite"}, {"--set", "fog-density=0.1"});
}

// Material AO and fade.

TEST_F(Aovs, material_ao_is_multiplied_in_from_a_file_or_a_channel) {
  const Image plain = good({"--type", "float"});
  std::vector<float> material(input.data.pixels());
  for (std::size_t i = 0; i < material.size(); i++) material[i] = float(i % 5) / 4.0f;
  FrameFile file{input.data, input.display, 1, {{"R", material}}, {}, {}};
  file.write(other);
  input.planes["ViewLayer.Baked.occ"] = material;
  input.write(frame);
  for (const auto& how : {std::vector<std::string>{"--set", std::string("material-ao=") + other},
                          {"--set", std::string("material-ao=") + other, "--set", "material-ao-channel=R"},
                          {"--set", "material-ao-channel=ViewLayer.Baked.occ"}}) {
    std::vector<std::string> arguments{"--type", "float"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    const Image result = good(arguments);
    for (std::size_t i = 0; i < material.size(); i++)
      ASSERT_EQ(result.plane("Y")[i], plain.plane("Y")[i] * material[i]) << i << testing::PrintToString(how);
  }
  const Image rounded = good({"--set", std::string("material-ao=") + other});
  for (std::size_t i = 0; i < material.size(); i++)
    ASSERT_NEAR(rounded.plane("Y")[i], plain.plane("Y")[i] * material[i], 0x1p-12) << i;
}

TEST_F(Aovs, a_channel_may_serve_two_purposes) {
  for (float& z : input.planes["ViewLayer.Depth.Z"]) z *= 0.05f;
  input.write(frame);
  auto near = wall_camera();
  write_bytes(camera, near.dump());
  const Image plain = good({"--type", "float"}),
              result = good({"--type", "float", "--set", "material-ao-channel=ViewLayer.Depth.Z"});
  for (std::size_t i = 0; i < plain.data.pixels(); i++)
    ASSERT_EQ(result.plane("Y")[i], plain.plane("Y")[i] * input.planes["ViewLayer.Depth.Z"][i]) << i;
}

TEST_F(Aovs, material_ao_that_does_not_fit_is_refused) {
  expect_refused(3, {"missing.exr", "--set material-ao"},
                 {"--set", std::string("material-ao=") + folder / "missing.exr"});
  expect_refused(3, {"wall.0042.exr", "--set material-ao-channel"}, {"--set", std::string("material-ao=") + frame});
  expect_refused(3, {"nothing.here", "--set material-ao-channel"}, {"--set", "material-ao-channel=nothing.here"});
  expect_refused(2, {"overwrite an input"}, {"--set", std::string("material-ao=") + ao});
  FrameFile small{{0, 0, 8, 8}, {0, 0, 8, 8}, 1, {{"Y", std::vector<float>(64, 1)}}, {}, {}};
  small.write(other);
  expect_refused(3, {"other.exr", "--set material-ao", "8x8", "64x36"}, {"--set", std::string("material-ao=") + other});
}

TEST_F(Aovs, fade_needs_both_ends_in_order) {
  expect_refused(2, {"--set fade-start", "--set fade-end"}, {"--set", "fade-start=1"});
  expect_refused(2, {"--set fade-start", "--set fade-end"}, {"--set", "fade-end=1"});
  expect_refused(2, {"--set fade-end=2", "--set fade-start=2"}, {"--set", "fade-start=2", "--set", "fade-end=2"});
  const Image source = read_exr_image(frame), plain = good({}),
              result = good({"--set", "fade-start=4", "--set", "fade-end=5"});
  int changed = 0;
  for (std::size_t i = 0; i < source.data.pixels(); i++) {
    const float z = source.plane("ViewLayer.Depth.Z")[i];
    if (z <= 4) ASSERT_EQ(result.plane("Y")[i], plain.plane("Y")[i]) << i;
    if (z >= 5) ASSERT_EQ(result.plane("Y")[i], 1.0f) << i;
    changed += result.plane("Y")[i] != plain.plane("Y")[i];
  }
  EXPECT_GT(changed, 100);
}

TEST(Digest, changes_with_every_setting_of_what_comes_out) {
  const auto digest = [](const std::function<void(Settings&)>& change) {
    Settings settings;
    settings.estimator.radius = 1;
    change(settings);
    return options_digest(settings);
  };
  const std::pair<const char*, std::function<void(Settings&)>> changes[] = {
      {"--aov", [](Settings& s) { s.output.aovs = "ao,depth"; }},
      {"--set ao-channels", [](Settings& s) { s.output.ao_channels = AoChannels::rgb; }},
      {"--set aov-space", [](Settings& s) { s.output.aov_space = NormalSpace::view; }},
      {"--set multi-bounce", [](Settings& s) { s.output.multi_bounce = true; }},
      {"--set fog-density", [](Settings& s) { s.output.look.fog_density = 0.1; }},
      {"--set fade-start", [](Settings& s) { s.estimator.fade_start = 0; }},
      {"--set fade-end", [](Settings& s) { s.estimator.fade_end = 1; }},
      {"--roughness", [](Settings& s) { s.estimator.roughness = 0.1; }},
      {"--set albedo", [](Settings& s) { s.input.albedo = "a.exr"; }},
      {"--set albedo 0", [](Settings& s) { s.input.albedo_value = 0; }},
      {"--set albedo-channels", [](Settings& s) { s.input.albedo_channels = "a"; }},
      {"--set material-ao", [](Settings& s) { s.input.material_ao = "a.exr"; }},
      {"--set material-ao-channel", [](Settings& s) { s.input.material_ao_channel = "a"; }},
  };
  const std::string plain = digest([](Settings&) {});
  for (const auto& [option, change] : changes) EXPECT_NE(digest(change), plain) << option;
}

}  // namespace
}  // namespace alcove
