// AO only where it is wanted: within a matte as without one, and nothing computed elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/matte.h"
#include "core/frame/find/channels.h"
#include "tests/support/command_line.h"
#include "tests/support/scenes.h"

namespace alcove::matte_test {
namespace {

using namespace test;
using Plane = std::vector<float>;

const Window kWindow{0, 0, 160, 90};

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

  /// The AO, as floats, of a frame.
  Plane ao_of(const FrameFile& file, const Options& more) const {
    file.write(frame);
    const Image image = computed(joined({"--stats", stats}, more));
    return image.pixels.empty() ? Plane(kWindow.pixels()) : image.pixels;
  }
  /// That of the wall within a matte.
  Plane within(const Plane& matte, const std::string& more = {}) const {
    return ao_of(with("Matte.Y", matte), typed("--set matte-channel=Matte.Y " + more));
  }
  static FrameFile with(const std::string& channel, const Plane& plane) {
    FrameFile file = wall_frame(kWindow, kWindow);
    file.planes[channel] = plane;
    return file;
  }
  json tiles() const { return json::parse(read_bytes(stats))["frames"][0]["tiles"]; }
  std::string search() const { return json::parse(read_bytes(stats))["frames"][0]["search"]; }
  double estimates() const { return json::parse(read_bytes(stats))["frames"][0]["estimates"]["total"]; }

  void expect_error(const FrameFile& file, const std::string& more, const Options& texts, int code = 3) const {
    file.write(frame);
    expect_refused(code, typed(more), texts);
  }

  const Plane ball = disc(75, 50, 15);
  const std::string stats = folder / "stats.json";
};

TEST_F(Matte, within_it_the_ao_is_that_of_the_whole_frame_and_elsewhere_what_is_asked) {
  const FrameFile file = with("Matte.Y", ball);
  int number = 0;
  for (const char* more :
       {"", "--preset production", "--preset draft", "--preset draft --resolution half", "--estimator crytek",
        "--resolution quarter --denoise box", "--estimator hbao --radius 0.3,2",
        "--set stride=1 --slices 4 --denoise none", "--search exact", "--set density=uniform --set stride=4",
        "--tolerance 0.05", "--estimator bitmask"}) {
    if (!tried(number++, 2)) continue;
    SCOPED_TRACE(more);
    const Plane whole = ao_of(file, typed(more));
    const auto before = tiles();
    const bool is_quick = more == std::string("--preset draft");
    const double estimates_before = is_quick ? estimates() : 0;
    const Plane ao = within(ball, std::string("--matte-outside 0.25 ") + more);
    std::size_t occluded = 0;
    for (std::size_t i = 0; i < ao.size(); i++) {
      const float expected = ball[i] == 1 ? whole[i] : 0.25F + ball[i] * (whole[i] - 0.25F);
      ASSERT_NEAR(ao[i], expected, ball[i] == 1 || ball[i] == 0 ? 0 : 1e-6)
          << "pixel " << i % 160 << "," << i / 160 << ", matte " << ball[i];
      occluded += ball[i] == 1 && whole[i] < 0.95F;
    }
    EXPECT_GT(occluded, 20) << "or else there is nothing to compare";
    if (is_quick) EXPECT_LT(estimates(), 0.6 * estimates_before);
    if (std::string(more).starts_with("--preset draft")) EXPECT_EQ(search(), is_quick ? "quick" : "steps");
    const bool lists_tiles =
        !is_quick && !std::string(more).starts_with("--search") && !std::string(more).starts_with("--tol");
    const double most = std::string(more).starts_with("--resolution quarter") ? 0.65 : 0.5;  // of few tiles
    if (lists_tiles) EXPECT_LT(tiles()["computed"], most * before["computed"].get<double>());
  }
}

// A pixel takes estimates from blocks around it, which lie in up to four tiles.
TEST_F(Matte, a_single_pixel_has_the_bits_of_the_whole_wherever_it_lies_in_a_tile) {
  const Window display{-3, -2, 165, 93};  // where blocks of 4 x 4 begin
  FrameFile file = wall_frame(kWindow, display);
  write_bytes(camera, wall_camera(display).dump());
  for (std::size_t i = 0; i < kWindow.pixels(); i++)
    if ((i % 160 / 6 + i / 160 / 5) % 3 == 0) file.planes["ViewLayer.Depth.Z"][i] *= 0.93F;
  int number = 0;
  for (const char* more : {"--preset standard", "--preset draft", "--slices 6 --set denoise-radius=5"}) {
    const Plane whole = ao_of(file, typed(more));
    for (std::size_t turn = 0; turn < 8; turn++) {
      if (!tried(number++, 3)) continue;
      Plane matte(kWindow.pixels(), 0);
      std::vector<std::size_t> places;
      for (std::size_t k = 0; k < 8; k++) {  // a row of a tile, each pixel of it in a tile of its own
        places.push_back((24 + 40 * (k / 4) + turn) * 160 + 16 + 40 * (k % 4) + k);
        matte[places.back()] = 1;
      }
      FrameFile chosen = file;
      chosen.planes["Matte.Y"] = matte;
      const Plane ao = ao_of(chosen, typed(std::string("--set matte-channel=Matte.Y ") + more));
      for (const std::size_t i : places) ASSERT_EQ(ao[i], whole[i]) << more << " " << i % 160 << "," << i / 160;
    }
  }
}

TEST_F(Matte, of_zeros_everything_is_outside_and_nothing_is_computed) {
  EXPECT_THAT(within(Plane(kWindow.pixels(), 0)), Each(1.0F));
  EXPECT_EQ(tiles()["computed"], 0);
  Plane none(kWindow.pixels(), std::numeric_limits<float>::quiet_NaN());
  none[0] = -1;
  EXPECT_THAT(within(none), Each(1.0F)) << "no number";
}

TEST_F(Matte, may_be_a_file_of_its_own_or_what_numbered_objects_cover) {
  const std::string own = folder / "matte.exr";
  FrameFile{kWindow, kWindow, 1, {{"A", ball}, {"R", Plane(ball.size(), 1)}}, {}, {}}.write(own);
  const Plane expected = within(ball);
  EXPECT_EQ(ao_of(with("Matte.Y", ball), {"--matte", own}), expected);
  EXPECT_NE(ao_of(with("Matte.Y", ball), {"--matte", own, "--set", "matte-channel=R"}), expected);

  Plane numbers(kWindow.pixels(), 7), covered(kWindow.pixels(), 0);
  for (std::size_t i = 0; i < numbers.size(); i++) {
    if (i % 160 < 50) numbers[i] = 3;
    if (i % 160 > 100) numbers[i] = 12;
    covered[i] = numbers[i] == 7 ? 0.0F : 1.0F;
  }
  const FrameFile numbered = with("IndexOB.X", numbers);
  const std::string channel = "--set matte-channel=IndexOB.X --matte-object ";
  EXPECT_EQ(ao_of(numbered, typed(channel + "3,12")), within(covered));
  EXPECT_NE(ao_of(numbered, typed(channel + "3")), within(covered));
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
      const bool is_strip = i % 160 > 140;
      const float ids[] = {float_of(cryptomatte_id("Ball")), float_of(cryptomatte_id("Floor"))};
      file.planes["Crypto00.R"][i] = ids[is_ball_first ? 0 : 1];
      file.planes["Crypto00.G"][i] = is_ball_first ? ball[i] : 1 - ball[i];
      file.planes["Crypto00.B"][i] = ids[is_ball_first ? 1 : 0];
      file.planes["Crypto00.A"][i] = is_ball_first ? 1 - ball[i] : ball[i];
      file.planes["Crypto01.r"][i] = is_strip ? float_of(cryptomatte_id("Ball.2")) : 0;
      file.planes["Crypto01.g"][i] = is_strip ? 1.0F : 0.0F;
      both.push_back(std::min(1.0F, ball[i] + (is_strip ? 1.0F : 0.0F)));
    }
    set("name", "Crypto");
    set("hash", "MurmurHash3_32");
    set("conversion", "uint32_to_float32");
    set("manifest", manifest);
  }

  void set(const std::string& attribute, const std::string& text) {
    file.attributes["cryptomatte/abc1234/" + attribute] = text;
  }
  void erase_manifest() { file.attributes.erase("cryptomatte/abc1234/manifest"); }
  /// How far the AO within these objects is from what it is within a matte.
  double off(const Options& objects, const Plane& expected) const {
    return difference(ao_of(file, joined({"--matte-object"}, objects)), expected).max;
  }

  /// The AO within the ball, and within both balls.
  const Plane& of_ball() const {
    static const Plane made = within(ball);
    return made;
  }
  const Plane& of_both() const {
    static const Plane made = within(both);
    return made;
  }

  Plane both;
  const std::string manifest = fmt::format(R"({{"Ball":"{:08x}","Ball.2":"{:08x}","Floor":"{:08x}"}})",
                                           cryptomatte_id("Ball"), cryptomatte_id("Ball.2"), cryptomatte_id("Floor"));
  FrameFile file;
};

TEST_F(Crypto, objects_are_found_by_names_and_patterns_in_all_ranks) {
  EXPECT_EQ(off({"Ball"}, of_ball()), 0);
  for (const char* objects : {"Ball,Ball.2", "Ball*", "Ball?2,Ball"})
    EXPECT_LE(off({objects}, of_both()), 1e-6) << objects;
  EXPECT_EQ(off({"Ball", "--set", "matte-channel=Crypto"}, of_ball()), 0);
  EXPECT_GT(difference(of_ball(), of_both()).max, 0.05) << "or else there is nothing to tell apart";
}

TEST_F(Crypto, ranks_beyond_the_sixteenth_are_not_read_and_that_is_said) {
  file.planes["Crypto01.B"] = file.planes["Crypto01.A"] = Plane(kWindow.pixels(), 0);
  const auto said_with = [&](int ranks) {
    for (int pair = 2; pair < (ranks + 1) / 2; pair++)
      for (const char* channel : {"R", "G", "B", "A"})
        file.planes[fmt::format("Crypto{:02}.{}", pair, channel)].assign(kWindow.pixels(), 0);
    file.write(frame);
    return done({"--matte-object", "Ball"}).err;
  };
  EXPECT_THAT(said_with(16), Not(HasSubstr("unread-ranks")));
  EXPECT_THAT(said_with(18), AllOf(HasSubstr("18 ranks"), HasSubstr("--matte-object"), HasSubstr("[unread-ranks]")));
}

TEST_F(Crypto, a_name_that_is_given_exactly_is_that_object) {
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
    SCOPED_TRACE(c.list);
    set("manifest", json{{c.ball, fmt::format("{:08x}", cryptomatte_id("Ball"))},
                         {c.second, fmt::format("{:08x}", cryptomatte_id("Ball.2"))},
                         {"Floor", fmt::format("{:08x}", cryptomatte_id("Floor"))}}
                        .dump());
    file.write(frame);
    const std::string said = done({"--matte-object", c.list, "--type", "float"}).err;
    EXPECT_LE(difference(read_exr_image(ao).pixels, c.is_both ? of_both() : of_ball()).max, 1e-6);
    EXPECT_EQ(said.find(c.note ? c.note : "stands for") != said.npos, c.note != nullptr) << said;
  }
  expect_error(file, "--matte-object nobody", {"backslash", "no such object"});
  set("manifest", R"({"ball ":"00000001"})");
  expect_error(file, "--matte-object balls", {"did you mean 'ball '?"});
}

TEST_F(Crypto, manifests_may_lie_beside_the_file_or_be_missing_or_damaged) {
  const std::string beside = folder / "names.json";
  erase_manifest();
  EXPECT_LE(off({"Ball,Ball.2"}, of_both()), 1e-6) << "names are hashed";
  expect_error(file, "--matte-object Ball*", {frame, "Ball*", "no manifest", "--matte-object"});
  set("manif_file", "../elsewhere/names.json");
  write_bytes(beside, manifest);
  EXPECT_LE(off({"Ball*"}, of_both()), 1e-6) << "only beside the file";
  write_bytes(beside, "[1, 2");
  expect_error(file, "--matte-object Ball*", {"names.json is no manifest"});
  set("manifest", R"({"Ball":"zz","Floor":7,"x":"123456789"})");
  EXPECT_EQ(off({"Ball"}, of_ball()), 0) << "no manifest: the name is hashed";
  set("name", "Other");
  expect_error(file, "--matte-object Ball", {"no Cryptomatte"});
}

TEST_F(Crypto, resume_redoes_what_another_manifest_beside_the_file_decided) {
  namespace fs = std::filesystem;
  const std::string beside = folder / "names.json";
  erase_manifest();
  set("manif_file", "names.json");
  write_bytes(beside, manifest);
  file.write(frame);
  const auto says = [&](const std::string& text) {
    EXPECT_THAT(done({"--matte-object", "Ball*", "--resume"}).err, HasSubstr(text));
  };
  says(" -> ");
  says("whole, kept");
  const auto before = fs::last_write_time(ao);
  write_bytes(beside, fmt::format(R"({{"Ball":"{:08x}"}})", cryptomatte_id("Ball")));
  fs::last_write_time(beside, before - std::chrono::hours(1));
  says(" -> ");
  fs::last_write_time(beside, fs::last_write_time(ao) + std::chrono::seconds(1));
  says("whole, kept");
}

TEST_F(Crypto, mistakes_are_named) {
  const FrameFile wall = wall_frame(kWindow, kWindow);
  expect_error(file, "--matte-object Bal", {frame, "Crypto", "did you mean Ball", "--matte-object"});
  expect_error(file, "--set matte-channel=Crypto", {frame, "--matte-object"});
  expect_error(wall, "--matte-object Ball", {frame, "no Cryptomatte", "--set matte-channel"});
  expect_error(with("IndexOB.X", ball), "--set matte-channel=IndexOB.X --matte-object Ball",
               {frame, "IndexOB.X", "numbers"});
  expect_error(wall, "--set matte-channel=Matte.Y", {frame, "Matte.Y", "--set matte-channel"});
  expect_error(with("Matte.Y", ball), "--set matte-channel=Matte.Y --matte-outside 2", {"--matte-outside"}, 2);
  write_plane(folder / "small.exr", "A", Plane(100, 1), {0, 0, 10, 10});
  expect_error(file, "--matte " + (folder / "small.exr"), {"small.exr", "--matte", "10x10"});
  // A second Cryptomatte that knows the name, too.
  for (const char* channel : {"00.R", "00.G"}) file.planes[std::string("Material") + channel] = ball;
  file.attributes["cryptomatte/0000000/name"] = "Material";
  file.attributes["cryptomatte/0000000/manifest"] = manifest;
  expect_error(file, "--matte-object Ball", {"Crypto", "Material", "--set matte-channel"});
}

TEST_F(Matte, composites_keep_every_bit_outside_of_it) {
  FrameFile file = with("Matte.Y", ball);
  add_beauty(file);
  file.write(frame);
  const std::string composite = folder / "composite.exr";
  done(typed("--set matte-channel=Matte.Y --set composite-layers=rgba --composite " + composite));
  const Image result = read_exr_image(composite);
  const Plane& red = file.planes.at("ViewLayer.Combined.R");
  const auto after = result.plane("R");
  ASSERT_EQ(after.size(), red.size());
  std::size_t dimmed = 0;
  for (std::size_t i = 0; i < red.size(); i++) {
    if (ball[i] == 0) ASSERT_EQ(after[i], red[i]) << i;
    dimmed += ball[i] == 1 && after[i] < 0.98F * red[i];
  }
  EXPECT_GT(dimmed, 30);
}

// What is kept from the frame before must be what this frame's matte asks for.
TEST_F(Matte, one_that_moves_along_a_sequence_gives_each_frame_its_own) {
  std::vector<Plane> alone;
  for (int i = 1; i <= 3; i++) {
    const Plane matte = disc(15 + 30 * i, 50, 15);
    alone.push_back(within(matte));
    with("Matte.Y", matte).write(folder / fmt::format("shot.{:04}.exr", i));
  }
  run_well(typed("run " + folder.path() + "/shot.####.exr -o " + folder.path() + "/out.####.exr --camera " + camera +
                 " --radius 1 --type float --threads 1 --set matte-channel=Matte.Y"));
  for (int i = 1; i <= 3; i++)
    EXPECT_EQ(read_exr_image(folder / fmt::format("out.{:04}.exr", i)).pixels, alone[std::size_t(i - 1)]) << i;
}

}  // namespace
}  // namespace alcove::matte_test
