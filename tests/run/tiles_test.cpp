// Frames that are computed in tiles have the bits of frames that are computed at once.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "cli/options.h"
#include "core/run/batch.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"
#include "tests/support/long_tests.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

using Options = std::vector<std::string>;

/// Bytes for frames: too few for any frame of this test as a whole.
constexpr std::uint64_t kLittleMemory = 6 << 20;

class Tiles : public CommandLine {
 protected:
  Tiles() {
    FrameFile large = wall_frame(data, display);
    add_beauty(large);
    add_blocks(large.planes.at("ViewLayer.Depth.Z"));
    large.write(frame);
    json oblique = wall_camera(display);
    oblique["cx"] = oblique["cx"].get<double>() + 3.137;
    write_bytes(camera, oblique.dump());
    ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
  }

  /// Blocks of 5 x 4 pixels at five heights, so that occluders stand beside every border of a tile.
  void add_blocks(std::vector<float>& depth) const {
    for (std::size_t i = 0; i < depth.size(); i++) {
      const std::size_t column = i % std::size_t(data.width) / 5, row = i / std::size_t(data.width) / 4;
      depth[i] -= 0.015f * float((7 * column + 13 * row) % 5);
    }
  }

  /// `alcove run` on the frame with these arguments, with so many bytes for frames or, for 0, as many as there are. It
  /// runs within this process, since no option gives a run so few.
  RunReport run_here(const Options& more, std::uint64_t bytes) const {
    Options arguments{shot, "-o", ao, "--camera", shot_camera, "--stats", folder / "stats.json", "--type", "float"};
    if (const char* device = std::getenv("ALCOVE_TEST_DEVICE"); device && *device)
      arguments.insert(arguments.end(), {"--device", device});
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOptions options;
    EXPECT_TRUE(parse_run_options(arguments, options));
    if (bytes) options.settings.device.memory = 1;
    if (bytes) options.settings.device.least_memory = bytes;
    return run_frames(options.settings);
  }

  /// The bytes of the AO, and of the composite where there is one; how many tiles they took.
  std::pair<std::string, int> computed(const Options& more, bool in_tiles) const {
    RunReport report = run_here(more, in_tiles ? little_memory : 0);
    // What reaches far takes more: then the tiles are the smallest that there are.
    for (std::uint64_t bytes = little_memory; in_tiles && report.done != 1 && bytes < 6 * little_memory;
         bytes += bytes / 4)
      report = run_here(more, bytes);
    EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
    if (report.done != 1) return {};
    const bool has_composite = std::ranges::find(more, "--composite") != more.end();
    return {read_bytes(ao) + (has_composite ? read_bytes(folder / "composite.exr") : ""), report.frames[0].parts};
  }

  /// The run in tiles must fail with ErrorKind::usage and these words.
  void expect_refused(const Options& more, const std::vector<std::string>& words) const {
    const RunReport report = run_here(more, kLittleMemory);
    ASSERT_TRUE(report.stop);
    EXPECT_EQ(report.stop->kind(), ErrorKind::usage);
    for (const auto& word : words) EXPECT_THAT(report.stop->what(), HasSubstr(word));
  }

  void expect_enough_is_named(Options options, std::uint64_t bytes) const;

  /// The run in tiles must give the bits of the whole.
  void expect_same(const Options& options) const {
    const auto [whole, one] = computed(options, false);
    const auto [tiled, many] = computed(options, true);
    EXPECT_EQ(one, 1);
    EXPECT_GT(many, 1) << testing::PrintToString(options);
    EXPECT_TRUE(whole == tiled) << testing::PrintToString(options);
  }

  std::string shot = frame, shot_camera = camera;
  std::uint64_t little_memory = kLittleMemory;
  const Window data{-6, -3, 507, 286}, display{0, 0, 500, 282};
};

TEST_F(Tiles, give_the_bits_of_the_whole) {
  for (const Options& options :
       {Options{"--radius", "0.2"},
        {"--radius", "0.2", "--aov", "ao,normal,depth,specular-occlusion", "--composite", folder / "composite.exr"},
        {"--radius", "0.3", "--estimator", "bitmask", "--slices", "2", "--steps", "20"},
        {"--radius", "0.2", "--estimator", "hbao", "--denoise", "box"},
        {"--radius", "0.2", "--estimator", "crytek", "--denoise", "none"},
        {"--radius", "0.2", "--resolution", "half"},
        {"--radius", "0.2", "--resolution", "quarter", "--set", "denoise-radius=5"},
        {"--radius", "0.2", "--set", "stride=4"},
        {"--radius", "0.2", "--set", "stride=8", "--set", "density=uniform"},
        {"--radius", "0.2", "--set", "stride=1"},
        {"--radius", "0.2", "--set", "supersampling=2", "--set", "filter-width=5", "--roi", "3,5,225,125"},
        {"--radius", "0.2", "--roi", "3,5,450,250", "--falloff", "smooth"}}) {
    expect_same(options);
  }
}

TEST_F(Tiles, give_the_bits_of_the_whole_with_a_beauty_of_another_window) {
  for (const Window& window : {Window{-20, -30, 530, 340}, Window{40, 60, 300, 150}, Window{100, -30, 20, 340}}) {
    FrameFile beauty{window, display, 1, {}, {}, {}};
    for (const char* name : {"R", "G", "B"}) {
      auto& plane = beauty.planes[name] = std::vector<float>(window.pixels());
      for (std::size_t i = 0; i < plane.size(); i++) plane[i] = float(i % 97) / 32;
    }
    beauty.write(folder / "beauty.exr");
    // All of its layers would take more than the little memory.
    expect_same({"--radius", "0.2", "--beauty", folder / "beauty.exr", "--composite", folder / "composite.exr", "--set",
                 "composite-layers=rgba"});
  }
}

TEST_F(Tiles, give_the_bits_of_the_whole_with_hidden_surfaces) {
  for (const char* name : {"near.exr", "far.exr"}) {
    FrameFile layer{data, display, 1, {}, {}, {}};
    std::vector<float>& z = layer.planes["Z"] = wall_frame(data, display).planes.at("ViewLayer.Depth.Z");
    for (std::size_t i = 0; i < z.size(); i++) z[i] += 0.2f + (name[0] == 'f' ? 0.3f : 0.05f * float(i / 7 % 4));
    layer.write(folder / name);
  }
  const Options behind{
      "--behind",  folder / "near.exr", "--behind", folder / "far.exr", "--behind-kind", "backs,fronts", "--aov",
      "ao,hidden", "--radius",          "0.2"};
  expect_same(behind);
  EXPECT_EQ(text_in(read_header(ao), "alcove/hidden"), "far.exr Z fronts; near.exr Z backs");
}

TEST_F(Tiles, give_the_bits_of_the_whole_in_exact_searches) {
  // A rendered frame: the long runs of its surfaces go on beyond the tiles.
  shot = ALCOVE_SOURCE_DIR "/examples/interior.gbuffer.exr";
  shot_camera = ALCOVE_SOURCE_DIR "/examples/interior.camera.json";
  little_memory = 4 * kLittleMemory;
  expect_same({"--radius", "0.05", "--preset", "reference"});
  if (long_tests())
    expect_same({"--radius", "0.06", "--preset", "reference", "--denoise", "none", "--thickness", "0.05"});
}

TEST_F(Tiles, give_the_bits_of_the_whole_where_tiles_of_pixels_decide_for_others) {
  shot = ALCOVE_SOURCE_DIR "/examples/interior.gbuffer.exr";
  shot_camera = ALCOVE_SOURCE_DIR "/examples/interior.camera.json";
  little_memory = 4 * kLittleMemory;
  expect_same({"--radius", "0.02", "--tolerance", "0.05", "--set", "complete=none", "--aov", "ao,error"});
}

TEST_F(Tiles, give_the_warnings_of_the_whole) {
  FrameFile repaired = wall_frame(data, display);
  repaired.halves = {"ViewLayer.Depth.Z"};
  for (const std::size_t pixel : {50000, 140000}) repaired.planes.at("ViewLayer.Normal.X")[pixel] = NAN;
  repaired.write(frame);
  for (const Options& options : {Options{"--radius", "0.005"}, {"--radius", "0.005", "--roi", "3,5,450,250"}}) {
    expect_same(options);
    const std::string notes = text_in(read_header(ao), "alcove/notes");
    for (const char* code : {"half-depth", "radius-below-precision", "radius-below-pixel", "repaired-normals"})
      EXPECT_THAT(notes, HasSubstr(code));
  }
}

TEST_F(Tiles, a_radius_that_reaches_everywhere_is_refused) {
  expect_refused({"--radius", "50"}, {frame, "--radius", "--memory"});
}

/// The megabytes of the --memory that a sentence names; 0 where it names none.
std::uint64_t memory_named_in(const std::string& text) {
  const std::string option = "--memory ";
  const auto at = text.find(option);
  return at == text.npos ? 0 : std::strtoull(text.c_str() + at + option.size(), nullptr, 10);
}

TEST_F(Tiles, too_little_memory_is_refused_with_the_least_that_is_enough) {
  const Options options{"--radius", "0.2"};
  const RunReport refused = run_here(options, 3 << 20);
  ASSERT_TRUE(refused.stop);
  EXPECT_EQ(refused.stop->kind(), ErrorKind::usage) << refused.stop->what();
  const std::uint64_t named = memory_named_in(refused.stop->what());
  ASSERT_GT(named, 0) << refused.stop->what();
  const auto report_with = [&](std::uint64_t megabytes) {
    Options with = options;
    with.insert(with.end(), {"--memory", std::to_string(megabytes) + "M"});
    return run_here(with, 0);
  };
  const RunReport enough = report_with(named), less = report_with(named - 2);
  EXPECT_EQ(enough.done, 1) << (enough.stop ? enough.stop->what() : "");
  ASSERT_TRUE(less.stop);
  EXPECT_EQ(less.stop->kind(), ErrorKind::usage);
  EXPECT_NEAR(double(memory_named_in(less.stop->what())), double(named), 1) << less.stop->what();
}

/// The run must be refused with so few bytes, and done with the memory that the refusal names.
void Tiles::expect_enough_is_named(Options options, std::uint64_t bytes) const {
  const RunReport refused = run_here(options, bytes);
  ASSERT_TRUE(refused.stop);
  const std::string named = std::to_string(memory_named_in(refused.stop->what()));
  options.insert(options.end(), {"--memory", named + "M"});
  const RunReport enough = run_here(options, 0);
  EXPECT_EQ(enough.done, 1) << "with " << named << "M: " << (enough.stop ? enough.stop->what() : "");
}

TEST_F(Tiles, what_is_named_is_enough_for_codecs_that_take_more_of_more_memory) {
  const Window tall{0, 0, 160, 1500};
  wall_frame(tall, tall).write(frame);
  write_bytes(camera, wall_camera(tall).dump());
  expect_enough_is_named({"--radius", "50", "--threads", "4"}, 1 << 20);
}

TEST_F(Tiles, what_is_named_is_enough_beside_the_planes_of_the_frame) {
  // Less than the planes alone take, which stay in memory beside any tile.
  expect_enough_is_named({"--radius", "0.4", "--slices", "1", "--steps", "2", "--aov",
                          "ao,bent-normal,normal,depth,specular-occlusion,confidence"},
                         1 << 20);
}

TEST_F(Tiles, a_note_says_how_many_there_are_and_why) {
  const RunReport report = run_here({"--radius", "0.05"}, little_memory);
  ASSERT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
  ASSERT_GT(report.frames[0].parts, 1);
  const auto note = std::ranges::find(report.frames[0].notes, NoteCode::in_parts, &Note::code);
  ASSERT_NE(note, report.frames[0].notes.end());
  EXPECT_THAT(note->text, AllOf(HasSubstr(fmt::format("in {} parts", report.frames[0].parts)), HasSubstr("--memory")));
}

TEST_F(Tiles, that_are_refused_leave_no_folder) {
  FrameFile repaired = wall_frame(data, display);
  add_beauty(repaired);
  repaired.planes.at("ViewLayer.Normal.X")[140000] = NAN;
  repaired.write(frame);
  const std::string inner = folder / "new/inner";
  const Options options{"--radius",    "0.05",           "--set", "warnings-as-errors=true",
                        "--composite", inner + "/c.exr", "--set", "composite-layers=rgba"};
  const RunReport report = run_here(options, 2 * little_memory);
  ASSERT_TRUE(report.stop);
  EXPECT_THAT(report.stop->what(), HasSubstr("repaired-normals")) << "or else no tile was begun";
  EXPECT_FALSE(std::filesystem::exists(folder / "new"));
  std::filesystem::create_directories(inner);
  ASSERT_TRUE(run_here(options, 2 * little_memory).stop);
  EXPECT_TRUE(std::filesystem::exists(inner)) << "it was there before";
}

TEST_F(Tiles, decode_each_row_once) {
  const RunReport report = run_here({"--radius", "0.05"}, little_memory);
  ASSERT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
  ASSERT_GT(report.frames[0].parts, 2);
  EXPECT_EQ(report.frames[0].rows_read, std::uint64_t(data.height));
}

TEST_F(Tiles, of_a_frame_with_one_near_corner_are_few) {
  // The blocks of the corner reach across half of the frame, and no other.
  FrameFile corner = wall_frame(data, display);
  auto& depth = corner.planes.at("ViewLayer.Depth.Z");
  for (std::size_t y = 0; y < 16; y++)
    for (std::size_t x = 0; x < 32; x++) depth[y * std::size_t(data.width) + x] = 0.25f;
  corner.write(shot);
  const RunReport report = run_here({"--radius", "0.05"}, little_memory);
  ASSERT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
  EXPECT_GT(report.frames[0].parts, 1);
  EXPECT_LT(double(report.frames[0].pixels), 2.2 * double(data.pixels()));
}

TEST_F(Tiles, pictures_need_the_whole) {
  expect_refused({"--radius", "0.1", "--preview", folder / "p.png"}, {frame, "--preview", "--memory"});
}

}  // namespace
}  // namespace alcove
