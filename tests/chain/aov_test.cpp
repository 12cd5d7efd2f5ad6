// What comes out besides plain AO: AOVs by name, rgb, multi-bounce, material AO and fog, from files to files.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove::aov_test {
namespace {

using namespace test;

/// `--set` before each.
Options set(const Options& values, const Options& more = {}) {
  Options options;
  for (const auto& value : values) options = joined(options, {"--set", value});
  return joined(options, more);
}

class Aovs : public CommandLine {
 protected:
  /// Makes a run that must succeed, and returns what OUTPUT holds then.
  Image good(const Options& more) {
    done(more);
    return read_exr_image(ao);
  }

  std::vector<HeaderChannel> channels() const { return channels_in(read_header(ao)); }

  FrameFile input = wall_frame();
  const std::string composite = folder / "composite.exr", other = folder / "other.exr";
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
  run_well({"run", written, "-o", again, "--camera", camera, "--radius", "1", "--type", "float"});
  const Image first = read_exr_image(ao), second = read_exr_image(again);
  for (std::size_t i = 0; i < first.data.pixels(); i++)
    ASSERT_NEAR(first.plane("Y")[i], second.plane("Y")[i], 1e-3) << i;
}

TEST_F(Aovs, normals_are_in_world_space_where_the_camera_has_it_else_in_view_space) {
  input.planes["ViewLayer.Depth.Z"][5] = 1e10f;
  for (const char* axis : {"X", "Y", "Z"})  // must be reconstructed: on the wall it becomes that of its neighbours
    input.planes["ViewLayer.Normal." + std::string(axis)][7] = 0;
  input.write(frame);
  const Image source = read_exr_image(frame);
  for (const std::string space : {"auto", "world", "view"}) {
    const Image result = good(set({"aov-space=" + space}, {"--aov", "normal"}));
    EXPECT_EQ(text_in(read_header(ao), "alcove/normal_space"), space == "view" ? "view" : "world");
    for (std::size_t i = 0; i < source.data.pixels(); i++) {  // view space: x right, y up (world z), z back (world -y)
      const float up = i != 5 && is_floor(source, i) ? 1 : 0, back = i == 5 ? 0 : 1 - up, near = i == 5 ? 0 : 2e-3f;
      ASSERT_NEAR(result.plane("normal.X")[i], 0, near) << i;
      ASSERT_NEAR(result.plane("normal.Y")[i], space == "view" ? up : -back, near) << i;
      ASSERT_NEAR(result.plane("normal.Z")[i], space == "view" ? back : up, near) << i;
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

TEST_F(Aovs, only_what_was_asked_for_is_computed) {
  EXPECT_THAT(passes_of({"--aov", "depth"}), ElementsAre("prepare", "reconstruct"));
  EXPECT_EQ(stats_of({"--aov", "depth"})["frames"][0]["samples_per_pixel"], 0);
  EXPECT_THAT(passes_of({"--aov", "normal"}), ElementsAre("prepare", "reconstruct", "directions"));
  const Options plain{"--denoise", "none"};
  EXPECT_THAT(passes_of(plain), ElementsAre("prepare", "reconstruct", "classify", "chains", "chain_ends", "backs",
                                            "horizon", "completion"));
  EXPECT_THAT(passes_of(joined(plain, {"--aov", "specular-occlusion"})),
              ElementsAre("prepare", "reconstruct", "classify", "chains", "chain_ends", "backs", "horizon",
                          "completion", "bent_normal", "specular_occlusion"));
  EXPECT_THAT(passes_of(joined(plain, {"--aov", "transfer"})),
              ElementsAre("prepare", "reconstruct", "classify", "chains", "chain_ends", "backs", "horizon",
                          "completion", "transfer"));
}

TEST_F(Aovs, a_region_holds_what_the_whole_holds_there) {
  expect_region_of_whole(set({"ao-channels=rgb", "multi-bounce=true", "albedo=0.7"},
                             {"--radius", "1", "--aov", "ao,normal,bent-normal,transfer,depth,specular-occlusion"}),
                         {20, 10, 9, 20});
  expect_region_of_whole({"--aov", "depth"}, {20, 10, 9, 20});  // no radius, no surroundings
}

TEST_F(Aovs, without_ao_no_radius_is_needed) {
  EXPECT_EQ(run_program({"run", frame, "-o", ao, "--camera", camera, "--aov", "depth,normal"}).code, 0);
  EXPECT_EQ(run_program({"run", frame, "-o", ao, "--camera", camera, "--aov", "depth,normal,ao"}).code, 2);
}

TEST_F(Aovs, unknown_ones_are_answered_with_all_there_are) {
  for (const char* list : {"nromal", "ao,nromal", "bent", "ao,,depth", ""})
    expect_run_refused(2,
                       {"--aov",
                        "ao, ao-scales, normal, bent-normal, transfer, relight, relight-open, depth, hidden, "
                        "confidence, shadow, error, specular-occlusion, convexity, cavity, curvature"},
                       {"--aov", list});
  expect_run_refused(2, {"did you mean normal?"}, {"--aov", "nromal"});
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
  const auto of_frame = [&](const std::string& layer) {
    return
        [this, layer](const std::string& c, std::size_t i) { return input.planes["ViewLayer." + layer + "." + c][i]; };
  };
  const std::pair<Options, std::function<double(const std::string&, std::size_t)>> cases[]{
      {set({"albedo=0.8"}), [](const std::string&, std::size_t) { return 0.8; }},
      {set({"albedo=" + other}), [&](const std::string& c, std::size_t i) { return colors.planes[c][i]; }},
      {{}, of_frame("DiffCol")},
      {{"--beauty", frame}, of_frame("DiffCol")},
      {set({"albedo-channels=ViewLayer.DiffInd"}), of_frame("DiffInd")}};
  for (const auto& [more, albedo] : cases) {
    const Image rgb = good(joined(set({"ao-channels=rgb", "multi-bounce=true"}, {"--type", "float"}), more));
    for (const std::string c : {"R", "G", "B"})
      for (std::size_t i = 0; i < mono.data.pixels(); i++)
        ASSERT_NEAR(rgb.plane(c)[i], bounced(mono.plane("Y")[i], albedo(c, i)), 1e-5) << c << i;
  }
}

TEST_F(Aovs, multi_bounce_says_what_it_lacks) {
  const Options in_rgb{"multi-bounce=true", "ao-channels=rgb"};
  const auto with = [&](const std::string& albedo) { return set(in_rgb, {"--set", "albedo=" + albedo}); };
  expect_run_refused(3, {"wall.0042.exr", "--set multi-bounce", "--set albedo"}, set(in_rgb));
  expect_run_refused(3, {"missing.exr", "--set albedo"}, with(folder / "missing.exr"));
  expect_run_refused(2, {"overwrite an input"}, with(ao));
  add_beauty(input);
  for (const char* c : {"R", "G", "B"}) input.planes.erase("ViewLayer.DiffInd." + std::string(c));
  input.write(frame);
  expect_run_refused(3, {"--set multi-bounce", "indirect"},
                     set({"multi-bounce=true", "albedo=0.5"}, {"--composite", composite}));
}

TEST_F(Aovs, composite_dims_each_colour_of_the_indirect_light_by_its_own_ao_and_less_through_fog) {
  add_beauty(input);
  input.write(frame);
  const Image source = read_exr_image(frame);
  const auto in = [&](const std::string& name, std::size_t i) { return double(source.plane("ViewLayer." + name)[i]); };
  for (const double density : {0.0, 0.3}) {
    const Image plain =
        good(set({"multi-bounce=true", "composite-layers=rgba", "fog-density=" + std::to_string(density)},
                 {"--type", "float", "--composite", composite}));
    const Image result = read_exr_image(composite);
    const std::string how = text_in(read_header(composite), "alcove/composite");
    EXPECT_THAT(how, HasSubstr("multi-bounce"));
    EXPECT_EQ(how.find("fog of density 0.3") != how.npos, density > 0) << how;
    for (std::size_t i = 0; i < plain.data.pixels(); i++) {
      const double distance = in("Depth.Z", i) * ray_length(i);
      for (const std::string c : {"R", "G", "B"}) {
        const double f = 1 - in("Combined.A", i) * std::exp(-density * distance) *
                                 (1 - bounced(plain.plane("Y")[i], in("DiffCol." + c, i)));
        const double light = in("DiffInd." + c, i) * in("DiffCol." + c, i),
                     expected = in("Combined." + c, i) - light + light * f;
        ASSERT_NEAR(result.plane(c)[i], expected, 1e-5 * (1 + std::abs(expected))) << c << i;
      }
    }
  }
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
  for (const Options& how : {Options{"material-ao=" + other},
                             {"material-ao=" + other, "material-ao-channel=R"},
                             {"material-ao-channel=ViewLayer.Baked.occ"}}) {
    const Image result = good(set(how, {"--type", "float"}));
    for (std::size_t i = 0; i < material.size(); i++)
      ASSERT_EQ(result.plane("Y")[i], plain.plane("Y")[i] * material[i]) << i << testing::PrintToString(how);
  }
  const Image rounded = good(set({"material-ao=" + other}));
  for (std::size_t i = 0; i < material.size(); i++)
    ASSERT_NEAR(rounded.plane("Y")[i], plain.plane("Y")[i] * material[i], 0x1p-12) << i;
}

TEST_F(Aovs, a_channel_may_serve_two_purposes) {
  for (float& z : input.planes["ViewLayer.Depth.Z"]) z *= 0.05f;
  input.write(frame);
  const Image plain = good({"--type", "float"}),
              result = good(set({"material-ao-channel=ViewLayer.Depth.Z"}, {"--type", "float"}));
  for (std::size_t i = 0; i < plain.data.pixels(); i++)
    ASSERT_EQ(result.plane("Y")[i], plain.plane("Y")[i] * input.planes["ViewLayer.Depth.Z"][i]) << i;
}

TEST_F(Aovs, material_ao_that_does_not_fit_is_refused) {
  expect_run_refused(3, {"missing.exr", "--set material-ao"}, set({"material-ao=" + folder / "missing.exr"}));
  expect_run_refused(3, {"wall.0042.exr", "--set material-ao-channel"}, set({"material-ao=" + frame}));
  expect_run_refused(3, {"nothing.here", "--set material-ao-channel"}, set({"material-ao-channel=nothing.here"}));
  expect_run_refused(2, {"overwrite an input"}, set({"material-ao=" + ao}));
  FrameFile small{{0, 0, 8, 8}, {0, 0, 8, 8}, 1, {{"Y", std::vector<float>(64, 1)}}, {}, {}};
  small.write(other);
  expect_run_refused(3, {"other.exr", "--set material-ao", "8x8", "64x36"}, set({"material-ao=" + other}));
}

TEST_F(Aovs, fade_goes_from_its_start_to_its_end) {
  const Image source = read_exr_image(frame), plain = good({}), result = good(set({"fade-start=4", "fade-end=5"}));
  int changed = 0;
  for (std::size_t i = 0; i < source.data.pixels(); i++) {
    const float z = source.plane("ViewLayer.Depth.Z")[i];
    if (z <= 4) ASSERT_EQ(result.plane("Y")[i], plain.plane("Y")[i]) << i;
    if (z >= 5) ASSERT_EQ(result.plane("Y")[i], 1.0f) << i;
    changed += result.plane("Y")[i] != plain.plane("Y")[i];
  }
  EXPECT_GT(changed, 100);
}

}  // namespace
}  // namespace alcove::aov_test
