// AO only where it is wanted: within a matte as without one, and nothing computed elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/formats/exr.h"
#include "core/frame/channels.h"
#include "core/frame/matte.h"
#include "tests/support/command_line.h"
#include "tests/support/difference.h"

namespace alcove {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using Options = std::vector<std::string>;
using Plane = std::vector<float>;

const Window kWindow{0, 0, 320, 180};

/// 1 in a disc, 0 far from it, and between them all values: a soft edge.
Plane disc(double x, double y, double radius) {
  Plane plane;
  for (int j = 0; j < kWindow.height; j++)
    for (int i = 0; i < kWindow.width; i++)
      plane.push_back(float(std::clamp((radius + 6 - std::hypot(i - x, j - y)) / 6, 0.0, 1.0)));
  return plane;
}

float float_of(std::uint32_t bits) { return std::bit_cast<float>(bits); }

class Matte : public CommandLine {
 protected:
  Matte() { write_bytes(camera, wall_camera(kWindow).dump()); }

  /// The AO, as floats, of the frame with those planes and attributes more.
  Plane ao_of(const FrameFile& file, const Options& more) const {
    file.write(frame);
    Options options{"--type", "float", "--stats", stats};
    options.insert(options.end(), more.begin(), more.end());
    const Finished finished = run(options);
    EXPECT_EQ(finished.code, 0) << finished << testing::PrintToString(more);
    return finished.code ? Plane(kWindow.pixels()) : read_exr_image(ao).pixels;
  }

  static FrameFile with(const std::string& channel, const Plane& plane) {
    FrameFile file = wall_frame(kWindow, kWindow);
    file.planes[channel] = plane;
    return file;
  }

  nlohmann::json tiles() const { return nlohmann::json::parse(read_bytes(stats))["frames"][0]["tiles"]; }

  void expect_error(const FrameFile& file, int code, const Options& more, const std::vector<std::string>& words) const {
    file.write(frame);
    const Finished finished = run(more);
    EXPECT_EQ(finished.code, code) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    for (const auto& word : words) EXPECT_THAT(finished.err, HasSubstr(word));
  }

  const std::string stats = folder / "stats.json";
};

TEST_F(Matte, within_it_the_ao_is_that_of_the_whole_frame_and_elsewhere_what_is_asked) {
  const Plane matte = disc(150, 100, 30);
  const FrameFile file = with("Matte.Y", matte);
  for (const Options& options : std::vector<Options>{{},
                                                     {"--denoise", "none"},
                                                     {"--preset", "production"},
                                                     {"--preset", "draft", "--resolution", "half"},
                                                     {"--resolution", "quarter", "--denoise", "box"},
                                                     {"--set", "stride=1", "--slices", "4"},
                                                     {"--set", "density=uniform", "--set", "stride=4"},
                                                     {"--estimator", "bitmask"},
                                                     {"--estimator", "hbao"},
                                                     {"--estimator", "crytek"},
                                                     {"--radius", "0.3,2"},
                                                     {"--search", "exact"},
                                                     {"--tolerance", "0.05"}}) {
    const Plane whole = ao_of(file, options);
    const auto before = tiles();
    Options with_matte = options;
    with_matte.insert(with_matte.end(), {"--set", "matte-channel=Matte.Y", "--matte-outside", "0.25"});
    const Plane ao = ao_of(file, with_matte);
    std::size_t occluded = 0;
    for (std::size_t i = 0; i < ao.size(); i++) {
      const float expected = matte[i] == 1 ? whole[i] : 0.25F + matte[i] * (whole[i] - 0.25F);
      ASSERT_NEAR(ao[i], expected, matte[i] == 1 || matte[i] == 0 ? 0 : 1e-6)
          << testing::PrintToString(options) << " pixel " << i % 320 << "," << i / 320 << ", matte " << matte[i];
      occluded += matte[i] == 1 && whole[i] < 0.95F;
    }
    EXPECT_GT(occluded, 40) << "or else there is nothing to compare" << testing::PrintToString(options);
    const bool lists_tiles = options.empty() || (options[0] != "--search" && options[0] != "--tolerance");
    if (lists_tiles)
      EXPECT_LT(tiles()["computed"], before["computed"].get<int>() / 2) << testing::PrintToString(options);
  }
}

TEST_F(Matte, of_zeros_everything_is_outside_and_nothing_is_computed) {
  const Plane ao = ao_of(with("Matte.Y", Plane(kWindow.pixels(), 0)), {"--set", "matte-channel=Matte.Y"});
  EXPECT_THAT(ao, testing::Each(1.0F));
  EXPECT_EQ(tiles()["computed"], 0);
  Plane none(kWindow.pixels(), std::numeric_limits<float>::quiet_NaN());
  none[0] = -1;
  EXPECT_THAT(ao_of(with("Matte.Y", none), {"--set", "matte-channel=Matte.Y"}), testing::Each(1.0F)) << "no number";
}

TEST_F(Matte, a_file_of_its_own_needs_no_channel) {
  const Plane matte = disc(150, 100, 30);
  FrameFile own{kWindow, kWindow, 1, {{"A", matte}, {"R", Plane(matte.size(), 1)}}, {}, {}};
  own.write(folder / "matte.exr");
  const FrameFile file = with("Matte.Y", matte);
  const Plane expected = ao_of(file, {"--set", "matte-channel=Matte.Y"});
  EXPECT_EQ(ao_of(file, {"--matte", folder / "matte.exr"}), expected);
  EXPECT_NE(ao_of(file, {"--matte", folder / "matte.exr", "--set", "matte-channel=R"}), expected);
}

TEST_F(Matte, of_numbers_is_what_the_objects_cover) {
  Plane numbers(kWindow.pixels(), 7);
  Plane covered(kWindow.pixels(), 0);
  for (std::size_t i = 0; i < numbers.size(); i++) {
    if (i % 320 < 100) numbers[i] = 3;
    if (i % 320 > 200) numbers[i] = 12;
    covered[i] = numbers[i] == 7 ? 0.0F : 1.0F;
  }
  FrameFile file = with("IndexOB.X", numbers);
  file.planes["Matte.Y"] = covered;
  const Plane expected = ao_of(file, {"--set", "matte-channel=Matte.Y"});
  EXPECT_EQ(ao_of(file, {"--set", "matte-channel=IndexOB.X", "--matte-object", "3,12"}), expected);
  EXPECT_NE(ao_of(file, {"--set", "matte-channel=IndexOB.X", "--matte-object", "3"}), expected);
}

// Identifiers that Blender 3.4 wrote into a manifest, and published ones of MurmurHash3; of the last two the exponents
// are 0 and 255 before they are changed, as an exhaustive search over short names gave.
TEST(Cryptomatte, names_have_their_published_identifiers) {
  EXPECT_EQ(cryptomatte_id("Ground"), 0x24950135U);
  EXPECT_EQ(cryptomatte_id("Floor.A"), 0x01736443U);
  EXPECT_EQ(cryptomatte_id("Floor.B"), 0xa0f28c86U);
  EXPECT_EQ(cryptomatte_id("hello"), 0x248bfa47U);
  EXPECT_EQ(cryptomatte_id("hello, world"), 0x149bbb7fU);
  EXPECT_EQ(cryptomatte_id("The quick brown fox jumps over the lazy dog"), 0x2e4ff723U);
  for (int i = 0; i < 5000; i++) EXPECT_TRUE(std::isnormal(float_of(cryptomatte_id(std::to_string(i))))) << i;
}

TEST(Cryptomatte, patterns_match_whole_names) {
  for (const auto& [name, pattern] : {std::pair("Column.01", "Column*"),
                                      {"Column.01", "*"},
                                      {"Column.01", "*.0?"},
                                      {"a", "?"},
                                      {"", "*"},
                                      {"aXbXc", "a*X*c"},
                                      {"aaab", "*ab"},
                                      {"x*y", "x*y"}})
    EXPECT_TRUE(fits_pattern(name, pattern)) << name << " " << pattern;
  for (const auto& [name, pattern] :
       {std::pair("Column.01", "Col"), {"Column", "column"}, {"ab", "?"}, {"a", "a?"}, {"aXb", "a*X*c"}, {"a", ""}})
    EXPECT_FALSE(fits_pattern(name, pattern)) << name << " " << pattern;
}

/// Two ranks and one of a third channel file: Ball covers a soft disc, Floor the rest, and a strip is Ball.2 in the
/// third rank.
class Crypto : public Matte {
 protected:
  Crypto() : file(wall_frame(kWindow, kWindow)) {
    for (const char* channel : {"00.R", "00.G", "00.B", "00.A", "01.r", "01.g"})
      file.planes[std::string("Crypto") + channel].assign(kWindow.pixels(), 0);
    for (std::size_t i = 0; i < kWindow.pixels(); i++) {
      const bool is_ball_first = ball[i] > 0.5F;
      const bool is_strip = i % 320 > 280;
      const float ids[] = {float_of(cryptomatte_id("Ball")), float_of(cryptomatte_id("Floor"))};
      file.planes["Crypto00.R"][i] = ids[is_ball_first ? 0 : 1];
      file.planes["Crypto00.G"][i] = is_ball_first ? ball[i] : 1 - ball[i];
      file.planes["Crypto00.B"][i] = ids[is_ball_first ? 1 : 0];
      file.planes["Crypto00.A"][i] = is_ball_first ? 1 - ball[i] : ball[i];
      file.planes["Crypto01.r"][i] = is_strip ? float_of(cryptomatte_id("Ball.2")) : 0;
      file.planes["Crypto01.g"][i] = is_strip ? 1.0F : 0.0F;
      both.push_back(std::min(1.0F, ball[i] + (is_strip ? 1.0F : 0.0F)));
    }
    file.attributes["cryptomatte/abc1234/name"] = "Crypto";
    file.attributes["cryptomatte/abc1234/hash"] = "MurmurHash3_32";
    file.attributes["cryptomatte/abc1234/conversion"] = "uint32_to_float32";
    file.attributes["cryptomatte/abc1234/manifest"] = manifest;
  }

  Plane expected(const Plane& matte) const {
    FrameFile plain = wall_frame(kWindow, kWindow);
    plain.planes["Matte.Y"] = matte;
    return ao_of(plain, {"--set", "matte-channel=Matte.Y"});
  }

  const Plane ball = disc(150, 100, 30);
  Plane both;
  const std::string manifest = fmt::format(R"({{"Ball":"{:08x}","Ball.2":"{:08x}","Floor":"{:08x}"}})",
                                           cryptomatte_id("Ball"), cryptomatte_id("Ball.2"), cryptomatte_id("Floor"));
  FrameFile file;
};

TEST_F(Crypto, objects_are_found_by_names_and_patterns_in_all_ranks) {
  const Plane of_ball = expected(ball);
  const Plane of_both = expected(both);
  EXPECT_EQ(difference(ao_of(file, {"--matte-object", "Ball"}), of_ball).max, 0);
  for (const char* objects : {"Ball,Ball.2", "Ball*", "Ball?2,Ball"})
    EXPECT_LE(difference(ao_of(file, {"--matte-object", objects}), of_both).max, 1e-6) << objects;
  EXPECT_EQ(difference(ao_of(file, {"--matte-object", "Ball", "--set", "matte-channel=Crypto"}), of_ball).max, 0);
  EXPECT_GT(difference(of_ball, of_both).max, 0.05) << "or else there is nothing to tell apart";
}

TEST_F(Crypto, ranks_beyond_the_sixteenth_are_not_read_and_that_is_said) {
  const auto said_with = [&](int ranks) {
    for (int pair = 2; pair < (ranks + 1) / 2; pair++)
      for (const char* channel : {"R", "G", "B", "A"})
        file.planes[fmt::format("Crypto{:02}.{}", pair, channel)].assign(kWindow.pixels(), 0);
    file.write(frame);
    const Finished finished = run({"--matte-object", "Ball"});
    EXPECT_EQ(finished.code, 0) << finished;
    return finished.err;
  };
  file.planes["Crypto01.B"] = file.planes["Crypto01.A"] = Plane(kWindow.pixels(), 0);
  EXPECT_THAT(said_with(16), testing::Not(HasSubstr("unread-ranks")));
  EXPECT_THAT(said_with(18), AllOf(HasSubstr("18 ranks"), HasSubstr("--matte-object"), HasSubstr("[unread-ranks]")));
}

TEST_F(Crypto, a_name_that_is_given_exactly_is_that_object) {
  const Plane of_ball = expected(ball), of_both = expected(both);
  // What the file calls its three objects; the list that is given; whether it is the ball, or both balls.
  struct Case {
    const char *ball, *second, *list;
    bool is_both;
    const char* note = nullptr;
  };
  for (const Case& c :
       std::vector<Case>{{"a_*_b", "a_n_b", "a_*_b", false},
                         {"a_?_b", "a_n_b", "a_?_b", false},
                         {"a_*_b", "a_n_b", "a_\\*_b", false},
                         {"a_*_b", "a_n_b", "a_*", true, "a_* stands for 2 objects of Crypto: a_*_b, a_n_b"},
                         {"a, b", "c", "a, b", false},
                         {"a, b", "c", "a\\, b", false},
                         {"a, b", "c", "c,a, b", true},
                         {"a, b", "c", "a, b , c", true},
                         {"a,b", "a", "a,b", false},
                         {"ball ", "ball", "ball ", false},
                         {"ball ", " c", "ball\\ , c", true},
                         {"a\\b", "c", "a\\b", false},
                         {"7", "8", "7", false}}) {
    nlohmann::json named{{c.ball, fmt::format("{:08x}", cryptomatte_id("Ball"))},
                         {c.second, fmt::format("{:08x}", cryptomatte_id("Ball.2"))},
                         {"Floor", fmt::format("{:08x}", cryptomatte_id("Floor"))}};
    file.attributes["cryptomatte/abc1234/manifest"] = named.dump();
    EXPECT_LE(difference(ao_of(file, {"--matte-object", c.list}), c.is_both ? of_both : of_ball).max, 1e-6) << c.list;
    const std::string said = run({"--matte-object", c.list}).err;
    if (c.note)
      EXPECT_THAT(said, HasSubstr(c.note));
    else
      EXPECT_THAT(said, testing::Not(HasSubstr("stands for")));
  }
  expect_error(file, 3, {"--matte-object", "nobody"}, {"backslash", "no such object"});
  file.attributes["cryptomatte/abc1234/manifest"] = R"({"ball ":"00000001"})";
  expect_error(file, 3, {"--matte-object", "balls"}, {"did you mean 'ball '?"});
}

TEST_F(Crypto, manifests_may_lie_beside_the_file_or_be_missing) {
  const Plane of_both = expected(both);
  file.attributes.erase("cryptomatte/abc1234/manifest");
  EXPECT_LE(difference(ao_of(file, {"--matte-object", "Ball,Ball.2"}), of_both).max, 1e-6) << "names are hashed";
  expect_error(file, 3, {"--matte-object", "Ball*"}, {frame, "Ball*", "no manifest", "--matte-object"});
  file.attributes["cryptomatte/abc1234/manif_file"] = "../elsewhere/names.json";
  write_bytes(folder / "names.json", manifest);
  EXPECT_LE(difference(ao_of(file, {"--matte-object", "Ball*"}), of_both).max, 1e-6) << "only beside the file";
  write_bytes(folder / "names.json", "[1, 2");
  expect_error(file, 3, {"--matte-object", "Ball*"}, {"names.json is no manifest"});
}

TEST_F(Crypto, resume_redoes_what_another_manifest_beside_the_file_decided) {
  file.attributes.erase("cryptomatte/abc1234/manifest");
  file.attributes["cryptomatte/abc1234/manif_file"] = "names.json";
  write_bytes(folder / "names.json", manifest);
  file.write(frame);
  const auto says = [&](const std::string& words) {
    const Finished finished = run({"--matte-object", "Ball*", "--resume"});
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_THAT(finished.err, HasSubstr(words));
  };
  says(" -> ");
  says("whole, kept");
  const auto before = std::filesystem::last_write_time(ao);
  write_bytes(folder / "names.json", fmt::format(R"({{"Ball":"{:08x}"}})", cryptomatte_id("Ball")));
  std::filesystem::last_write_time(folder / "names.json", before - std::chrono::hours(1));
  says(" -> ");
  std::filesystem::last_write_time(folder / "names.json",
                                   std::filesystem::last_write_time(ao) + std::chrono::seconds(1));
  says(" -> ");
}

TEST_F(Crypto, mistakes_are_named) {
  expect_error(file, 3, {"--matte-object", "Bal"}, {frame, "Crypto", "did you mean Ball", "--matte-object"});
  expect_error(file, 3, {"--set", "matte-channel=Crypto"}, {frame, "--matte-object"});
  expect_error(wall_frame(kWindow, kWindow), 3, {"--matte-object", "Ball"},
               {frame, "no Cryptomatte", "--set matte-channel"});
  expect_error(with("IndexOB.X", ball), 3, {"--set", "matte-channel=IndexOB.X", "--matte-object", "Ball"},
               {frame, "IndexOB.X", "numbers"});
  expect_error(wall_frame(kWindow, kWindow), 3, {"--set", "matte-channel=Matte.Y"},
               {frame, "Matte.Y", "--set matte-channel"});
  expect_error(wall_frame(kWindow, kWindow), 2, {"--matte-outside", "0.5"}, {"--matte-outside", "--matte"});
  expect_error(with("Matte.Y", ball), 2, {"--set", "matte-channel=Matte.Y", "--matte-outside", "2"},
               {"--matte-outside"});
  FrameFile small{{0, 0, 10, 10}, {0, 0, 10, 10}, 1, {{"A", Plane(100, 1)}}, {}, {}};
  small.write(folder / "small.exr");
  expect_error(file, 3, {"--matte", folder / "small.exr"}, {"small.exr", "--matte", "10x10"});
  // A second Cryptomatte that knows the name, too.
  for (const char* channel : {"00.R", "00.G"}) file.planes[std::string("Material") + channel] = ball;
  file.attributes["cryptomatte/0000000/name"] = "Material";
  file.attributes["cryptomatte/0000000/manifest"] = manifest;
  expect_error(file, 3, {"--matte-object", "Ball"}, {"Crypto", "Material", "--set matte-channel"});
}

TEST_F(Crypto, damaged_headers_are_no_cryptomattes) {
  file.attributes["cryptomatte/abc1234/manifest"] = R"({"Ball":"zz","Floor":7,"x":"123456789"})";
  const Plane of_ball = expected(ball);
  EXPECT_EQ(difference(ao_of(file, {"--matte-object", "Ball"}), of_ball).max, 0) << "no manifest: the name is hashed";
  file.attributes["cryptomatte/abc1234/name"] = "Other";
  expect_error(file, 3, {"--matte-object", "Ball"}, {"no Cryptomatte"});
}

TEST_F(Matte, a_region_of_the_frame_has_the_values_of_the_whole) {
  const FrameFile file = with("Matte.Y", disc(150, 100, 30));
  const Plane whole = ao_of(file, {"--set", "matte-channel=Matte.Y"});
  const Plane part = ao_of(file, {"--set", "matte-channel=Matte.Y", "--roi", "100,60,70,50"});
  EXPECT_LE(difference(part, cropped(whole, kWindow, {100, 60, 70, 50})).max, 1e-6);
}

TEST_F(Matte, composites_keep_every_bit_outside_of_it) {
  const Plane matte = disc(150, 100, 30);
  FrameFile file = with("Matte.Y", matte);
  add_beauty(file);
  file.write(frame);
  const std::string composite = folder / "composite.exr";
  ASSERT_EQ(run({"--set", "matte-channel=Matte.Y", "--composite", composite, "--set", "composite-layers=rgba"}).code,
            0);
  const Image result = read_exr_image(composite);
  const Plane& red = file.planes["ViewLayer.Combined.R"];
  ASSERT_EQ(red.size(), matte.size()) << "the beauty of add_beauty() has other names";
  std::size_t dimmed = 0;
  const auto at = std::size_t(std::ranges::find(result.names, "R") - result.names.begin());
  ASSERT_LT(at, result.names.size());
  for (std::size_t i = 0; i < red.size(); i++) {
    const float value = result.pixels[at * red.size() + i];
    if (matte[i] == 0) ASSERT_EQ(value, red[i]) << i;
    dimmed += matte[i] == 1 && value < 0.98F * red[i];
  }
  EXPECT_GT(dimmed, 100);
}

// What is kept from the frame before must be what this frame's matte asks for.
TEST_F(Matte, one_that_moves_along_a_sequence_gives_each_frame_its_own) {
  std::vector<Plane> alone;
  for (int i = 0; i < 3; i++) {
    const FrameFile file = with("Matte.Y", disc(90 + 60 * i, 100, 30));
    alone.push_back(ao_of(file, {"--set", "matte-channel=Matte.Y"}));
    file.write(fmt::format("{}/shot.{:04}.exr", folder.path(), i + 1));
  }
  const Finished finished =
      run_program({"run", folder / "shot.####.exr", "-o", folder / "out.####.exr", "--camera", camera, "--radius", "1",
                   "--type", "float", "--threads", "1", "--set", "matte-channel=Matte.Y"});
  ASSERT_EQ(finished.code, 0) << finished;
  for (int i = 0; i < 3; i++)
    EXPECT_EQ(read_exr_image(fmt::format("{}/out.{:04}.exr", folder.path(), i + 1)).pixels, alone[std::size_t(i)]) << i;
}

}  // namespace
}  // namespace alcove
