// A wedge shows what its commands compute, has the radius that inspect proposes, and loses no look in silence.
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <regex>
#include <sstream>

#include "core/formats/picture.h"
#include "core/measure/report.h"
#include "tests/support/command_line.h"

namespace alcove::wedge_test {
namespace {

using namespace test;
using Names = std::vector<std::string>;

class Wedge : public SequenceFolder {
 protected:
  Wedge() { wall_frame().write(frame); }

  Finished run(const Options& more, const Launch& launch = {}) const override {
    return run_program(joined({"wedge"}, more), {.folder = folder.path(), .environment = launch.environment});
  }
  /// A wedge of the frame, or of another input.
  Options of_frame(const std::string& more, const std::string& input = "") const {
    return joined({input.empty() ? frame : input, "--camera", camera, "-o", page}, typed(more));
  }
  /// What its page holds.
  json shown(const Options& arguments) const {
    fs::remove(page);
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.code, 0) << finished;
    return finished.code ? json() : report_in(page);
  }
  static Names names_of(const json& report) {
    Names names;
    for (const auto& look : report["candidates"]) names.push_back(look["name"]);
    return names;
  }

  /// Runs the command of a look, and gives the channel of its file as the page would show it.
  std::string run_command_of(const json& report, std::size_t look, const Options& more = {},
                             const char* file = "ao.exr", std::string_view channel = "Y") const {
    std::istringstream stream(report["candidates"][look]["settings"].get<std::string>());
    Names words{std::istream_iterator<std::string>(stream), {}};
    EXPECT_EQ(words.front(), "alcove");
    words.erase(words.begin());
    const Finished finished = run_program(joined(joined(words, {"--type", "float"}), more), {.folder = folder.path()});
    EXPECT_EQ(finished.code, 0) << finished;
    if (finished.code) return "";
    const Image made = read_exr_image(folder / file);
    std::vector<float> pixels(kWallWindow.pixels());  // of the display window, 0 outside of a region
    copy_common(made.plane(channel).data(), made.data, pixels.data(), kWallWindow);
    return picture_url(kWallWindow.width, kWallWindow.height, 1, pixels);
  }
  /// Runs the commands of all looks or, in the short form, of one of every `parts`, which the caller chooses so that
  /// each value is met.
  void expect_bits_of_commands(const json& report, int parts = 1) const {
    ASSERT_GE(report["images"].size(), report["candidates"].size());
    for (std::size_t i = 0; i < report["candidates"].size(); i++)
      if (tried(int(i), parts))
        EXPECT_TRUE(run_command_of(report, i) == report["images"][i]["result"]) << report["candidates"][i];
  }

  const std::string frame = folder / "wall.exr", page = folder / "page.html", sheet = folder / "sheet.png";
};

TEST_F(Wedge, shows_the_bits_of_its_commands) {
  expect_bits_of_commands(shown(of_frame("--radius .5,1.5 --preset draft,production")), 2);  // and the proposed radius
  expect_bits_of_commands(shown(of_frame("--radius 1 --set denoise=none,box --intensity 1,2 --roi 8,4,40,20")), 3);
  expect_bits_of_commands(shown(of_frame("--radius auto --estimator hbao,crytek,bitmask")));
}

TEST_F(Wedge, turns_a_sun_and_shows_its_shadow_by_one_estimate) {
  const std::string lights = folder / "lights.json";
  write_bytes(lights, R"({"lights": [{"name": "lamp", "kind": "point", "position": [0, 0, 9]},
                                     {"name": "key", "kind": "sun", "direction": [0, 1, 2]}]})");
  const json report =
      shown(of_frame("--radius 1 --lights " + lights + " --set sun-azimuth=0,90 --set sun-elevation=40,80"));
  ASSERT_EQ(report["candidates"].size(), 4);
  std::set<std::string> pictures;
  std::set<double> estimates;
  for (std::size_t i = 0; i < 4; i++) {
    const std::string picture = report["images"][i]["result"];
    EXPECT_EQ(run_command_of(report, i, {}, "shadow.exr", "shadow-key.Y"), picture);
    const std::vector<float> preview = Picture(folder / "preview.png", "--preview").read(std::array<std::size_t, 1>{});
    EXPECT_EQ(picture_url(kWallWindow.width, kWallWindow.height, 1, preview), picture) << "of the turned sun";
    pictures.insert(picture);
    estimates.insert(report["rows"][i]["estimate_ms"].get<double>());
  }
  EXPECT_GT(pictures.size(), 2u);
  EXPECT_EQ(estimates.size(), 1u);
  test::expect_refused(run(of_frame("--radius 1 --lights " + lights)), 2, {"--lights", "sun-azimuth"});
  test::expect_refused(run(of_frame("--radius 1 --set sun-azimuth=0,90")), 2, {"sun-azimuth", "--lights"});
}

// Looks that differ in their shaping alone take one estimate, and so one time of it.
TEST_F(Wedge, estimates_once_for_looks_that_differ_in_their_shaping_alone) {
  FrameFile with_beauty = wall_frame();
  add_beauty(with_beauty);
  with_beauty.write(frame);
  const auto estimates_of = [](const json& report) {
    std::set<double> times;
    for (const auto& row : report["rows"]) times.insert(row["estimate_ms"].get<double>());
    return times.size();
  };
  const json report = shown(of_frame("--radius .5,auto --set intensity=.5,2"));
  ASSERT_EQ(report["rows"].size(), 4);
  EXPECT_EQ(estimates_of(report), 2);
  expect_bits_of_commands(report, 3);
  const json shapes = shown(of_frame("--radius auto --set least=0,.8 --set gain=1,2 --set power=1,2"));
  EXPECT_EQ(estimates_of(shapes), 1);
  expect_bits_of_commands(shapes, 3);
  // AO has no gain.
  EXPECT_THAT(names_of(shapes)[2], HasSubstr("gain=2"));
  EXPECT_TRUE(shapes["images"][0].at("composite") != shapes["images"][2].at("composite"));
  EXPECT_EQ(estimates_of(shown(of_frame("--radius auto --set slices=2,4 --set intensity=1,2"))), 2);
  write_bytes(folder / "dark.toml", "intensity=2\n");
  EXPECT_EQ(estimates_of(shown(of_frame("--radius auto --preset standard," + (folder / "dark.toml")))), 1);
}

// What a frame is read by goes into the commands, be it a guess's option, a name with blanks or a flag.
TEST_F(Wedge, reads_the_frame_as_run_does) {
  FrameFile other = wall_frame();
  other.rename("ViewLayer.Depth.Z", "far away");
  other.change("far away", [](float z) { return 2 * z; });
  other.write(folder / "other.exr");
  const json report = shown({folder / "other.exr", "--camera", camera, "--depth-channel", "far away", "--depth-scale",
                             "0.5", "--radius", "1", "-o", page});
  ASSERT_FALSE(report.is_null());
  EXPECT_THAT(report["candidates"][0]["settings"], HasSubstr("--depth-channel 'far away' --depth-scale 0.5"));
  const json strict =
      shown(joined({frame, "--strict", "--no-skip"}, typed("--camera " + camera + " --radius 1 -o " + page)));
  ASSERT_FALSE(strict.is_null());
  EXPECT_THAT(strict["candidates"][0]["settings"],
              AllOf(HasSubstr("--strict=true --camera"), HasSubstr("--no-skip=true --radius")));
  expect_bits_of_commands(strict);
  const Finished plain =
      run_program({"run", frame, "--camera", camera, "--radius", "1", "-o", folder / "ao.exr", "--type", "float"});
  const Image ao = read_exr_image(folder / "ao.exr");
  EXPECT_EQ(plain.code, 0);
  const auto one =
      std::ranges::find(report["images"], "radius 1", [](const json& image) { return image["candidate"]; });
  ASSERT_NE(one, report["images"].end());
  EXPECT_TRUE((*one)["result"] == picture_url(ao.data.width, ao.data.height, 1, ao.pixels));
}

TEST_F(Wedge, has_the_radius_that_inspect_proposes) {
  const json inspected = json::parse(run_well({"inspect", frame, "--camera", camera, "--json"}).out);
  std::smatch found;
  const std::string command = inspected["command"];
  ASSERT_TRUE(std::regex_search(command, found, std::regex("--radius ([0-9.]+)")));
  const double proposed = std::stod(found[1]);
  const std::string name = fmt::format("radius {} (proposed)", proposed);
  EXPECT_EQ(names_of(shown(of_frame(""))),
            (Names{fmt::format("radius {}", proposed / 2), name, fmt::format("radius {}", 2 * proposed)}));
  EXPECT_EQ(names_of(shown(of_frame("--radius auto"))), Names{name});
  EXPECT_EQ(names_of(shown(of_frame("--set radius=9,.01"))), (Names{"radius 0.01", name, "radius 9"}));
  EXPECT_EQ(names_of(shown(of_frame(fmt::format("--radius 9,{} --preset draft,standard", proposed)))),
            (Names{"draft, " + name, "draft, radius 9", "standard, " + name, "standard, radius 9"}));
}

TEST_F(Wedge, names_no_look_by_what_all_have) {
  for (const char* preset : {"soft", "hard"}) write_bytes(folder / preset, "intensity=2\n");
  const std::string presets = (folder / "soft") + "," + (folder / "hard");
  EXPECT_EQ(names_of(shown(of_frame("--radius auto --preset " + presets))), (Names{"soft", "hard"}));
  EXPECT_EQ(names_of(shown(of_frame("--radius auto --preset standard," + (folder / "soft")))),
            (Names{"standard", folder / "soft"}));
}

// The sheet of looks of one radius is no column.
TEST_F(Wedge, makes_sheets_about_as_wide_as_high) {
  const auto width_of = [&](const std::string& more) {
    EXPECT_EQ(run(typed(frame + " --camera " + camera + " --sheet " + sheet + " " + more)).code, 0);
    return open_image(sheet, "the test", Formats::all).parts()[0].data.width;
  };
  const int cell = width_of("--radius auto") - 8;
  EXPECT_EQ(width_of("--radius auto --set intensity=1,2,3,4"), 2 * cell + 8);
  EXPECT_EQ(width_of("--radius .1,.2,auto --set intensity=1,2"), 3 * cell + 8) << "a row of all radii";
}

TEST_F(Wedge, of_a_beauty_shows_composites_and_makes_them) {
  FrameFile with_beauty = wall_frame();
  add_beauty(with_beauty);
  with_beauty.write(frame);
  const json report = shown(of_frame("--radius 1 --set intensity=0,1"));
  const json& images = report["images"];
  ASSERT_EQ(images.size(), report["candidates"].size() + 1);
  EXPECT_THAT(images[0]["composite"].get<std::string>(), HasSubstr("data:image"));
  EXPECT_EQ(images.back()["candidate"], "beauty");
  EXPECT_TRUE(images.back()["beauty"] == images[0]["composite"]) << "without strength it is the beauty";
  EXPECT_FALSE(images.back()["beauty"] == images[images.size() - 2]["composite"]);
  EXPECT_THAT(report["candidates"][0]["settings"], HasSubstr("-o ao.exr --composite composite.exr"));
  expect_bits_of_commands(report);
  EXPECT_TRUE(fs::exists(folder / "composite.exr"));
  // A beauty that was not rendered is told of, and the AO is shown.
  with_beauty.change("Combined", [](float) { return 0.0F; });
  with_beauty.write(frame);
  EXPECT_THAT(run(of_frame("--radius 1")).err, AllOf(HasSubstr("no composite"), HasSubstr("one colour")));
  EXPECT_TRUE(report_in(page)["images"][0]["composite"].is_null());
}

TEST_F(Wedge, of_a_sequence_shows_the_middle_frame_or_the_frames_that_are_named) {
  write_frames(1001, 1005);
  const auto frames_of = [](const json& report) {
    std::set<std::string> frames;
    for (const auto& image : report["images"]) frames.insert(image["frame"]);
    return frames;
  };
  const std::string shot = in + "/f.####.exr";
  const json middle = shown(of_frame("--radius 1,2", shot));
  EXPECT_EQ(frames_of(middle), std::set<std::string>{"1003"});
  EXPECT_THAT(middle["candidates"][0]["settings"], AllOf(HasSubstr("--frames 1003"), HasSubstr("-o 'ao.####.exr'")));
  // The frames are the same, the looks are not.
  const json two = shown(of_frame("--radius 1,2 --frames 1001,1004", shot));
  EXPECT_EQ(frames_of(two), (std::set<std::string>{"1001", "1004"}));
  const std::size_t looks = middle["images"].size();
  ASSERT_EQ(two["images"].size(), 2 * looks);
  EXPECT_FALSE(middle["images"][0]["result"] == middle["images"][1]["result"]);
  for (std::size_t i = 0; i < 2 * looks; i++)
    EXPECT_TRUE(two["images"][i]["result"] == middle["images"][i % looks]["result"]) << i;
  // With one setting it is the contact sheet of the shot.
  const json whole = shown(of_frame("--radius 1", shot));
  EXPECT_EQ(frames_of(whole).size(), 5);
  EXPECT_EQ(names_of(whole), Names{"radius 1"});
  EXPECT_EQ(run(typed(shot + " --camera " + camera + " --radius 1 --sheet " + sheet)).code, 0);
  EXPECT_TRUE(fs::exists(sheet));
}

TEST_F(Wedge, that_makes_no_sense_is_refused) {
  const auto refused = [&](const std::string& more, const Options& texts) { expect_refused(2, of_frame(more), texts); };
  expect_refused(2, {frame, "--camera", camera}, {"-o FILE.html", "--sheet FILE.png"});
  expect_refused(2, typed("--radius 1 -o page.html"), {"no input", "--depth"});
  expect_refused(2, {frame, "--camera", camera, "-o", folder / "page.exr"}, {"--output", ".html"});
  expect_refused(2, {frame, "--camera", camera, "--sheet", folder / "sheet.jpg"}, {"--sheet", "PNG"});
  refused("--radius .1,,.2", {"--radius .1,,.2", "empty"});
  refused("--radius .1,x", {"--radius", "x"});
  refused("--radius .1,-1", {"--radius", "-1"});
  refused("--radius .1 --radius .2", {"--radius", "one list"});
  refused("--preset draft,darft", {"darft", "did you mean draft"});
  refused("--set intensty=1,2", {"intensty", "did you mean intensity"});
  refused("--set intensity=1,", {"--intensity 1,", "empty"});
  refused("--set slices=2,900", {"slices", "900"});
  refused("--radius 1 --set radius=2", {"--radius", "one list"});
  refused("--radius=-1,2", {"--radius", "-1"});
  refused("--set output=x.exr", {"--output", "more than once"});
  refused("--set intensity=1,1", {"intensity=1", "twice"});
  refused("--depth-kind planar,ray", {"--depth-kind", "planar,ray"});
  refused("--gain 1,2", {"--set gain=1,2"});
  refused("--stats x.json", {"--stats", "no option"});
  refused("--radius 1,2,3,4,5,6,7,8 --set intensity=1,2,3,4,5,6,7,8", {"64", "fewer values"});
  expect_refused(3, of_frame("--radius 1", folder / "none.exr"), {"none.exr"});
}

TEST_F(Wedge, tells_which_look_fails_and_shows_the_others) {
  FrameFile with_beauty = wall_frame();
  add_beauty(with_beauty);
  with_beauty.erase("Diff");
  with_beauty.write(frame);
  const Finished finished = run(joined(of_frame("--radius auto --set multi-bounce=false,true"), {"--sheet", sheet}));
  EXPECT_EQ(finished.code, 1) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("look multi-bounce=true"), HasSubstr("albedo")));
  EXPECT_EQ(report_in(page)["images"].size(), 2) << "a look, and the beauty";
  EXPECT_TRUE(fs::exists(sheet));
}

TEST_F(Wedge, that_fails_leaves_no_page_of_an_earlier_one_and_says_why) {
  for (const auto& file : {page, sheet}) write_bytes(file, "of an earlier wedge");
  const Finished failed = run(joined(of_frame("--radius 1,2 --memory 1M"), {"--sheet", sheet}));
  EXPECT_EQ(failed.code, 2) << failed;
  EXPECT_THAT(failed.err, AllOf(HasSubstr("at least --memory"), Not(HasSubstr("beauty"))));
  EXPECT_FALSE(fs::exists(page) || fs::exists(sheet));
}

TEST_F(Wedge, without_room_is_refused_dry_as_well) {
  FrameFile large = wall_frame({0, 0, 3840, 2160}, {0, 0, 3840, 2160});
  large.write(frame);
  write_bytes(camera, wall_camera({0, 0, 3840, 2160}).dump());
  const Options little = of_frame("--radius 1 --memory 240M");
  expect_refused(2, joined(little, {"--dry-run"}), {"whole", "--roi", "--memory"});
  expect_refused(2, little, {"--memory"});
  // What is enough for one look is too little for another.
  wall_frame(kWallWindow, kWallWindow).write(frame);
  write_bytes(camera, wall_camera(kWallWindow).dump());
  const std::string words = run(of_frame("--radius 1 --preset draft --memory 1M --dry-run")).err;
  std::smatch least;
  expect_refused(2, of_frame("--radius 1 --memory 1M --dry-run --roi 8,4,40,20"), {"choose a smaller region"});
  ASSERT_TRUE(std::regex_search(words, least, std::regex("--memory ([0-9]+M)"))) << words;
  const std::string memory = " --dry-run --memory " + least[1].str();
  EXPECT_EQ(run(of_frame("--radius 1 --preset draft" + memory)).code, 0);
  expect_refused(2, of_frame("--radius 1 --preset draft,production" + memory), {"look production", "--memory"});
}

TEST_F(Wedge, may_be_tried_dry) {
  write_bytes(page, "of an earlier wedge");
  const Finished dry = run(of_frame("--radius 1,2 --set intensity=1,2 --dry-run"));
  EXPECT_EQ(dry.code, 0) << dry;
  EXPECT_THAT(dry.out, AllOf(HasSubstr("memory  "), Not(HasSubstr("ao.exr")), HasSubstr("no composite")));
  EXPECT_THAT(dry.out, testing::ContainsRegex("looks +6 of each frame, by 3 estimates\n +intensity=1, radius"));
  EXPECT_EQ(read_bytes(page), "of an earlier wedge");
  write_frames(1, 5);
  const std::string shot = in + "/f.####.exr";
  EXPECT_THAT(run(of_frame("--radius auto --frames 3 --set intensity=1,2 --around 1 --dry-run", shot)).out,
              AllOf(HasSubstr(" reads for 1 frame, "), HasSubstr("by 1 estimate\n")));
}

TEST_F(Wedge, may_say_nothing) {
  const Finished quiet = run(of_frame("--radius 1 -q"));
  EXPECT_EQ(quiet.code, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_THAT(report_in(page)["candidates"][0]["settings"], Not(HasSubstr(" -q")));
  EXPECT_THAT(run(of_frame("--radius 1 -q", folder / "none.exr")).err, HasSubstr("none.exr"));
}

TEST_F(Wedge, of_a_frame_that_cannot_be_read_is_none) {
  fs::resize_file(frame, fs::file_size(frame) * 2 / 3);
  fs::remove(page);
  expect_refused(3, of_frame("--radius 1,2"), {"wall.exr"});
  EXPECT_FALSE(fs::exists(page));
}

TEST_F(Wedge, tells_why_there_is_no_composite_or_no_radius) {
  expect_refused(3, of_frame("--radius 1 --set gain=1,2"), {"no beauty channel"});
  FrameFile sky = wall_frame();
  sky.change("ViewLayer.Depth.Z", [](float) { return 1e10F; });
  sky.write(frame);
  const Finished finished = run(of_frame("--radius .1,auto"));
  EXPECT_NE(finished.code, 0);
  EXPECT_THAT(finished.err, Not(HasSubstr("neither auto")));
}

// A preset may say how a frame is read, but not two presets two ways.
TEST_F(Wedge, of_two_readings_is_refused) {
  write_bytes(folder / "half.toml", "depth-scale=0.5\n");
  expect_refused(2, of_frame("--radius 1 --preset standard," + (folder / "half.toml")),
                 {"--depth-scale", "reads its frame once"});
  EXPECT_EQ(shown(of_frame("--radius 1 --preset " + (folder / "half.toml")))["images"].size(), 2);
}

}  // namespace
}  // namespace alcove::wedge_test
