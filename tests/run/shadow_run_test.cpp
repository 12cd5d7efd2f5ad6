// Runs with --lights: what they write, what they are computed anew for, and what they refuse before any work.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove::shadow_run_test {
namespace {

using namespace test;

/// A sun behind the wall, from which the foot of the wall keeps the floor there dark.
const std::string kSun = R"("kind": "sun", "direction": [0, 1, 2])";

std::string file_of(const std::string& light) { return R"({"lights": [{"name": "key", )" + light + "}]}"; }

class ShadowRun : public CommandLine {
 protected:
  ShadowRun() { write_lights(kSun); }

  void write_lights(const std::string& light) const { write_bytes(lights, file_of(light)); }
  std::vector<float> shadow_of(const std::string& more = "") const {
    done(joined({"--lights", lights}, typed(more)));
    return plane("shadow-key.Y");
  }
  std::vector<float> plane(const std::string& channel) const {
    const Image image = read_exr_image(ao);
    const auto values = image.plane(std::string_view(channel));
    return {values.begin(), values.end()};
  }

  const std::string lights = folder / "lights.json";
};

TEST_F(ShadowRun, writes_a_channel_for_each_light_beside_the_ao) {
  const auto shadow = shadow_of();
  ASSERT_EQ(shadow.size(), kWallWindow.pixels());
  EXPECT_EQ(shadow[64 * 5 + 32], 0) << "the wall faces away";
  EXPECT_EQ(shadow[64 * 35 + 32], 1) << "the floor far from the wall";
  int dark = 0;
  for (std::size_t y = 29; y < 36; y++) dark += shadow[64 * y + 32] == 0;
  EXPECT_GT(dark, 0) << "the floor at the wall";
  done({});
  const auto ao_alone = plane("Y");
  shadow_of();
  EXPECT_EQ(plane("Y"), ao_alone);
  EXPECT_EQ(shadow_of("--aov shadow --type float"), shadow);
}

TEST_F(ShadowRun, does_not_depend_on_a_matte_nor_on_the_resolution_of_the_ao) {
  write_lights(kSun + R"(, "angular_diameter": 20)");
  const auto soft = shadow_of();
  EXPECT_TRUE(std::ranges::any_of(soft, [](float x) { return x > 0.1F && x < 0.9F; }));
  EXPECT_EQ(shadow_of("--resolution half"), soft);
  FrameFile file = wall_frame();
  file.planes["Matte.Y"].assign(kWallWindow.pixels(), 0);
  file.write(frame);
  EXPECT_EQ(shadow_of("--set matte-channel=Matte.Y"), soft);
}

TEST_F(ShadowRun, is_computed_anew_where_the_lights_alone_have_changed) {
  const auto before = shadow_of("--resume");
  const auto written = fs::last_write_time(ao);
  EXPECT_EQ(shadow_of("--resume"), before);
  EXPECT_EQ(fs::last_write_time(ao), written) << "it is kept";
  write_lights(R"("kind": "sun", "direction": [0, -1, 2])");
  EXPECT_NE(shadow_of("--resume"), before);
}

TEST_F(ShadowRun, notes_a_sun_below_the_horizon_and_a_light_that_reaches_nothing) {
  const auto said = [&](const std::string& light, const std::string& more = "") {
    write_lights(light);
    return done(joined({"--lights", lights}, typed(more))).err;
  };
  EXPECT_THAT(said(kSun), Not(HasSubstr("[dark-light]")));
  EXPECT_THAT(said(R"("kind": "sun", "direction": [0, 1, -0.01])"),
              AllOf(HasSubstr("[dark-light]"), HasSubstr("\"key\" is below the horizon"), HasSubstr(lights)));
  EXPECT_THAT(said(R"("kind": "sun", "direction": [0, 1, -2])", "--set sun-elevation=40"), Not(HasSubstr("horizon")));
  EXPECT_THAT(said(kSun, "--set sun-elevation=-1"), HasSubstr("horizon, by --set sun-elevation"));
  const std::string lamp = R"("kind": "point", "position": )";
  EXPECT_THAT(said(lamp + "[0, 1000, -1000]"), HasSubstr("\"key\" reaches no surface"));
  EXPECT_THAT(said(lamp + "[0, 0, 1000]"), Not(HasSubstr("[dark-light]")));
}

TEST_F(ShadowRun, notes_a_lamp_that_is_far_beyond_all_surfaces) {
  const auto said = [&](const std::string& position) {
    write_lights(R"("kind": "point", "position": )" + position);
    return done({"--lights", lights}).err;
  };
  EXPECT_THAT(said("[0, 0, 90]"), Not(HasSubstr("[far-lamp]")));
  EXPECT_THAT(said("[0, 0, 600]"), AllOf(HasSubstr("alcove: note: " + lights + ": the lamp \"key\" is "),
                                         HasSubstr("in the scene's units?"), HasSubstr("[far-lamp]")));
}

/// A beauty with a layer of the light beside its indirect light.
class ShadowComposite : public ShadowRun {
 protected:
  ShadowComposite() : file(wall_frame()) {
    write_lights(kSun + R"(, "angular_diameter": 20)");
    add_beauty(file);
    std::size_t at = 0;
    for (const char* c : {"R", "G", "B"})
      for (std::size_t i = 0; i < kWallWindow.pixels(); i++)
        file.planes[std::string("ViewLayer.key_light.") + c].push_back(float(at++ * 37 % 503) / 503);
    file.write(frame);
  }
  double at(const std::string& layer, const std::string& c, std::size_t i) const {
    return file.planes.at("ViewLayer." + layer + "." + c)[i];
  }
  double diffuse(const std::string& c, std::size_t i) const { return at("DiffInd", c, i) * at("DiffCol", c, i); }

  /// What a composite is made of in a pixel: its shadow and occlusion, 0 where nothing is dark.
  struct Pixel {
    double shadow, occlusion;
    std::size_t i;
    std::string c;
  };
  /// The largest difference between the composite and what it must be.
  double error(const std::string& more, const std::function<double(const Pixel&)>& loss) const {
    done(joined({"--lights", lights, "--composite", composite, "--type", "float"},
                typed("--set composite-layers=rgba " + more)));
    const auto shadow = plane("shadow-key.Y"), ao_plane = plane("Y");
    const Image result = read_exr_image(composite);
    double largest = 0, taken = 0;
    for (const std::string c : {"R", "G", "B"})
      for (std::size_t i = 0; i < shadow.size(); i++) {
        const double less = loss({1 - shadow[i], at("Combined", "A", i) * (1 - ao_plane[i]), i, c});
        largest = std::max(largest, std::abs(result.plane(std::string_view(c))[i] - (at("Combined", c, i) - less)));
        taken = std::max(taken, std::abs(less));
      }
    EXPECT_GT(taken, 0.1);
    return largest;
  }

  FrameFile file;
  const std::string composite = folder / "composite.exr";
};

TEST_F(ShadowComposite, dims_the_layers_of_its_light_and_ao_what_is_left) {
  const auto key = [&](const Pixel& p) { return p.shadow * at("key_light", p.c, p.i); };
  const std::string of_key = "--set shadow-layers=key:key_light ";
  EXPECT_LT(error(of_key + "--set ambient=DiffInd*0", key), 1e-5);
  EXPECT_LT(error(of_key, [&](const Pixel& p) { return key(p) + diffuse(p.c, p.i) * p.occlusion; }), 1e-5);
  EXPECT_LT(error(of_key + "--set ambient=beauty",
                  [&](const Pixel& p) { return key(p) + (at("Combined", p.c, p.i) - key(p)) * p.occlusion; }),
            1e-5);
  EXPECT_LT(error(of_key + "--set ambient=key_light*0.5",
                  [&](const Pixel& p) {
                    const double layer = at("key_light", p.c, p.i);
                    return layer * p.shadow + 0.5 * layer * (1 - p.shadow) * p.occlusion;
                  }),
            1e-5);
  EXPECT_LT(error("--set shadow-layers=key:key_light,key:DiffInd",
                  [&](const Pixel& p) {
                    const double light = diffuse(p.c, p.i);
                    return key(p) + light * p.shadow + light * (1 - p.shadow) * p.occlusion;
                  }),
            1e-5)
      << "the colour that belongs to it, and AO once";
  EXPECT_LT(
      error(of_key + "--set mix=0.4", [&](const Pixel& p) { return 0.4 * (key(p) + diffuse(p.c, p.i) * p.occlusion); }),
      1e-5);
  const auto& z = file.planes.at("ViewLayer.Depth.Z");
  EXPECT_LT(error(of_key + "--set fog-density=0.2",
                  [&](const Pixel& p) {
                    const double x = (double(p.i % 64) - 31.5) / 60, y = (double(p.i / 64) - 17.5) / 60;
                    const double clear = std::exp(-0.2 * z[p.i] * std::sqrt(1 + x * x + y * y));
                    return clear * (key(p) + diffuse(p.c, p.i) * p.occlusion);
                  }),
            1e-5);
  EXPECT_THAT(text_in(read_header(composite), "alcove/composite"), HasSubstr("shadows: key:key_light"));
}

TEST_F(ShadowComposite, below_0_is_a_warning_where_the_beauty_is_not) {
  for (const std::string c : {"R", "G", "B"}) {
    file.planes.at("ViewLayer.key_light." + c) = file.planes.at("ViewLayer.Combined." + c);
    std::ranges::fill(file.planes.at("ViewLayer.DiffInd." + c), 0);
    std::ranges::fill(file.planes.at("ViewLayer.DiffCol." + c), 8);
  }
  file.write(frame);
  const auto said = [&](const std::string& more) {
    return done(joined({"--lights", lights, "--composite", composite}, typed("--set " + more))).err;
  };
  for (const char* light : {"shadow-layers=key:key_light", "ambient=key_light"})
    EXPECT_THAT(said(light), Not(HasSubstr("[negative-composite]"))) << light;
  for (const char* color : {"shadow-layers=key:DiffCol", "ambient=DiffCol"})
    EXPECT_THAT(said(color), AllOf(HasSubstr("warning: " + frame + ": on "), HasSubstr("[negative-composite]")))
        << color;
}

TEST_F(ShadowComposite, is_refused_where_a_light_or_a_layer_is_not_there) {
  const auto refused = [&](int code, const std::string& layers, const Options& texts, bool wanted = true) {
    Options more{"--lights", lights, "--set", "shadow-layers=" + layers};
    if (wanted) more.insert(more.end(), {"--composite", composite});
    expect_run_refused(code, texts, more);
  };
  refused(2, "kay:key_light", {"--set shadow-layers", lights, "no light \"kay\"", "did you mean key"});
  refused(3, "key:kay_light",
          {"--set shadow-layers", "kay_light", frame,
           "there is ViewLayer.Combined, ViewLayer.DiffCol, ViewLayer.DiffInd, "
           "ViewLayer.key_light; --set shadow-layers takes a layer"});
  refused(2, "key:Combined", {"--set shadow-layers", "Combined is the whole beauty"});
  refused(2, "key:key_light", {"--set shadow-layers", "--composite"}, false);
  for (const char* text : {"key", ":key_light", "key:", "key:key_light,"}) refused(2, text, {"NAME:LAYER"});
  refused(2, "key:key_light,key:key_light", {"key:key_light is there twice"});
  expect_run_refused(2, {"--set shadow-layers", "--lights"},
                     {"--composite", composite, "--set", "shadow-layers=key:key_light"});
  write_bytes(lights, R"({"lights": [{"name": "key", "kind": "sun", "direction": [0, 1, 2]},
                                     {"name": "rim", "kind": "sun", "direction": [1, 0, 2]}]})");
  refused(2, "key:key_light,rim:key_light", {"key_light is there twice: name it for one light"});
}

TEST_F(ShadowRun, of_a_region_has_the_bits_of_the_whole_and_says_its_cost) {
  write_lights(R"("kind": "point", "position": [0.5, 0, 1.5], "radius": 0.2)");
  const std::string plan = "takes the whole frame";
  for (const char* more : {"", "--set shadow-reach=0.5"}) {
    const Options options = joined({"--lights", lights, "--radius", "0.3", "--aov", "confidence,shadow"}, typed(more));
    const Image whole = expect_region_of_whole(options, {20, 22, 9, 7});
    EXPECT_EQ(whole.names, (Words{"confidence.Y", "shadow-key.Y", "shadow-key.confidence"}));
    const std::string said = done(joined(options, {"--roi", "20,22,9,7", "--dry-run"})).out;
    EXPECT_EQ(said.find(plan) != said.npos, *more == 0) << said;
  }
}

TEST_F(ShadowRun, follows_a_sun_that_the_settings_turn) {
  const auto before = shadow_of("--set sun-azimuth=90 --set sun-elevation=63.434948822922");
  write_lights(R"("kind": "sun", "direction": [1, 0, 0])");
  EXPECT_NE(shadow_of(), before);
  EXPECT_EQ(shadow_of("--set sun-azimuth=90 --set sun-elevation=63.434948822922"), before);
  expect_refused(2, {"--lights", lights, "--set", "sun-azimuth=90", "--set", "sun=kay"}, {"no sun kay"});
}

TEST_F(ShadowRun, is_refused_without_lights_or_where_these_cannot_be_placed) {
  expect_refused(2, {"--aov", "shadow"}, {"--aov shadow", "--lights"});
  expect_refused(3, {"--lights", folder / "none.json"}, {"none.json", "--lights"});
  expect_refused(2, {"--lights", lights, "--set", "ao-name=shadow-key.Y"}, {"shadow-key.Y", "--set ao-name"});
  json plain = wall_camera();
  plain.erase("world_to_camera");
  write_bytes(camera, plain.dump());
  for (const char* more : {"", "--dry-run"})
    expect_refused(3, joined({"--lights", lights, "--normal", "none"}, typed(more)),
                   {lights, "key", "world_to_camera", "--lights"});
}

using ShadowSequence = SequenceFolder;

TEST_F(ShadowSequence, is_refused_before_any_work_where_a_light_lacks_a_frame) {
  write_frames(1, 3);
  const std::string lights = folder / "lights.json";
  write_bytes(lights, file_of(kSun + R"(, "frames": [{"frame": 1}, {"frame": 2}])"));
  for (const char* more : {"", "--dry-run", "--keep-going"})
    expect_refused(3, joined({"--lights", lights}, typed(more)), {lights, "key", "no frame 3", "--lights", "--frames"});
  EXPECT_TRUE(outputs().empty());
}

TEST_F(ShadowSequence, is_that_of_the_light_of_its_frame) {
  write_frames(1, 2);
  const std::string lights = folder / "lights.json";
  write_bytes(lights, file_of(kSun + R"(, "frames": [{"frame": 1}, {"frame": 2, "direction": [0, -1, 2]}])"));
  done({"--lights", lights, "--chunk", "1/3"});
  EXPECT_TRUE(outputs().empty()) << "a chunk without frames";
  done({"--lights", lights});
  const Image first = read_exr_image(output(1)), second = read_exr_image(output(2));
  const std::size_t wall = 64 * 5 + 32;
  EXPECT_EQ(first.plane(std::string_view("shadow-key.Y"))[wall], 0) << "it faces away";
  EXPECT_EQ(second.plane(std::string_view("shadow-key.Y"))[wall], 1) << "it faces the sun";
}

}  // namespace
}  // namespace alcove::shadow_run_test
