// Frames that are computed in tiles have the bits of frames that are computed at once.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/tiles.h"
#include "core/run/frame_files.h"
#include "tests/support/exr_header.h"
#include "tests/support/test.h"
#include "tests/support/walked_shot.h"

namespace alcove::tiles_test {
namespace {

using namespace test;

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

  Options arguments(const Options& more) const {
    Options words{shot, "-o", ao, "--camera", shot_camera, "--stats", folder / "stats.json", "--type", "float"};
    if (const char* device = std::getenv("ALCOVE_TEST_DEVICE"); device && *device)
      words = joined(words, {"--device", device});
    return joined(words, more);
  }
  /// A run on the frame with so many bytes for frames or, for 0, as many as there are.
  RunReport run_with(std::uint64_t bytes, const Options& more) const { return run_here(arguments(more), bytes); }
  /// The same, which must succeed in several tiles.
  RunReport done_in_tiles(const Options& more) const {
    RunReport report = run_with(little_memory, more);
    EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
    EXPECT_TRUE(report.done == 1 && report.frames[0].parts > 1);
    return report;
  }
  /// With so few bytes the run must fail with ErrorKind::usage and these texts; what it says.
  std::string expect_refused_with(std::uint64_t bytes, const Options& more, const Options& texts) const {
    const RunReport report = run_with(bytes, more);
    if (!report.stop) ADD_FAILURE() << "done with " << bytes << " bytes";
    if (!report.stop) return "";
    EXPECT_EQ(report.stop->kind(), ErrorKind::usage);
    for (const auto& text : texts) EXPECT_THAT(report.stop->what(), HasSubstr(text));
    return report.stop->what();
  }

  /// Bytes for a frame in several tiles: more than the smallest take, which would compute most pixels many times, by
  /// that part of what the whole takes more.
  std::uint64_t bytes_for_tiles(const Options& more, double part) const {
    RunOptions options;
    EXPECT_TRUE(parse_run_options(arguments(more), options));
    RunPreview look(options.settings);
    look.prepare();
    const int number = look.plan().frames().front();
    const Settings settings = look.plan().at(number);
    set_exr_threads(threads_of(settings.device));
    std::uint64_t bytes = 0;
    for (int turn = 0; turn < 2; turn++) {  // codecs take more of more memory
      set_exr_memory(bytes / kCodecPart);
      FrameSource source = open_frame(settings, number);
      const WindowLimits limits{memory_with_others(look.plan(), source, settings), {.bytes = MemoryBudget::kEndless}};
      const MemoryNeeds needs = memory_needs(source, settings, limits);
      bytes = needs.least + std::uint64_t(part * double(needs.at_once - needs.least));
    }
    return bytes;
  }

  /// The bytes of the AO, and of the composite where there is one; how many tiles they took.
  std::pair<std::string, int> computed(const Options& more, std::uint64_t bytes) const {
    const RunReport report = run_with(bytes, more);
    EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
    if (report.done != 1) return {};
    const bool has_composite = std::ranges::find(more, "--composite") != more.end();
    return {read_bytes(ao) + (has_composite ? read_bytes(composite) : ""), report.frames[0].parts};
  }
  /// The run in tiles must give the bits of the whole.
  void expect_same(const Options& options, double part = long_tests() ? 0.25 : 0.5) const {
    SCOPED_TRACE(testing::PrintToString(options));
    const auto [whole, one] = computed(options, 0);
    const auto [tiled, many] = computed(options, bytes_for_tiles(options, part));
    EXPECT_EQ(one, 1);
    EXPECT_GT(many, 1);
    EXPECT_TRUE(whole == tiled);
  }
  /// A rendered frame: the long runs of its surfaces go on beyond the tiles.
  void take_rendered_frame() {
    shot = ALCOVE_SOURCE_DIR "/examples/interior.gbuffer.exr";
    shot_camera = ALCOVE_SOURCE_DIR "/examples/interior.camera.json";
  }

  const std::string composite = folder / "composite.exr";
  std::string shot = frame, shot_camera = camera;
  std::uint64_t little_memory = kLittleMemory;
  const Window data{-6, -3, 507, 286}, display{0, 0, 500, 282};
};

TEST_F(Tiles, give_the_bits_of_the_whole) {
  int number = 0;
  for (const std::string& more :
       std::vector<std::string>{"--composite " + composite,
                                "--estimator bitmask --slices 2 --steps 20 --aov ao,normal,depth,specular-occlusion",
                                "--preset draft", "--estimator crytek --denoise none", "--estimator hbao --denoise box",
                                "--resolution quarter --set denoise-radius=5", "--resolution half --falloff smooth",
                                "--set stride=8 --set density=uniform", "--set stride=4 --roi 3,5,450,250",
                                "--set supersampling=2 --set filter-width=5 --roi 3,5,225,125", "--set stride=1"})
    if (tried_at_width(number++)) expect_same(typed("--radius 0.06 " + more), 0.25);  // rows and columns of tiles
}

TEST_F(Tiles, give_the_bits_of_the_whole_of_shadows_with_a_reach) {
  const std::string lights = folder / "lights.json";
  write_bytes(lights, R"({"lights": [
    {"name": "sun", "kind": "sun", "space": "view", "direction": [0.8, 0.5, 0.4]},
    {"name": "lamp", "kind": "point", "space": "view", "position": [0.1, 0.1, -0.8], "radius": 0.05}]})");
  int number = 0;
  for (const char* more : {"", " --preset production", " --roi 13,5,410,230"})
    if (tried(number++, 2)) expect_same(typed("--radius 0.06 --set shadow-reach=0.1 --lights " + lights + more));
}

TEST_F(Tiles, give_the_bits_of_the_whole_where_ramps_are_cut) {
  with_soft_cards(data, display).write(frame);
  little_memory = 2 * kLittleMemory;
  done_in_tiles(typed("--radius 0.06"));
  const std::string kept = read_bytes(ao);
  expect_same(typed("--radius 0.06 --set ramps=cut"));
  EXPECT_NE(read_bytes(ao), kept);
  expect_same(typed("--radius 0.06 --set ramps=cut --roi 13,5,410,230"));
}

// Planes are kept from run to run, and each run settles the frame by them.
TEST_F(Tiles, keep_planes_only_once_they_are_settled_and_cut_and_settle_no_frame_by_cut_ones) {
  with_soft_cards(data, display).write(frame);
  RunOptions options;
  ASSERT_TRUE(parse_run_options({frame, "-o", ao, "--camera", camera, "--set", "ramps=cut"}, options));
  ReadPlanes planes;
  const auto texts = [&] {
    FrameSource source = open_frame(options.settings, 0);
    read_for_parts(source, options.settings, planes, std::uint64_t(1) << 40);
    std::string all;
    for (const Note& note : source.suspicious) all += note.text + '\n';
    for (const Note& note : source.notes) all += note.text + '\n';
    return all;
  };
  const std::string first = texts();
  const auto cut = planes[RawPlane::depth];
  EXPECT_THAT(first, HasSubstr("lay on ramps"));
  EXPECT_EQ(texts(), first);
  EXPECT_EQ(planes[RawPlane::depth], cut);
  options.settings.input.depth_kind = DepthKind::disparity;
  planes = {};
  EXPECT_THROW(texts(), Error) << "larger values are farther away";
  EXPECT_TRUE(planes[RawPlane::depth].empty()) << "a run after it would take them as cut";
}

TEST_F(Tiles, give_the_bits_of_the_whole_with_a_beauty_of_another_window) {
  const std::string beauty = folder / "beauty.exr";
  int number = 0;
  for (const Window& window : {Window{100, -30, 20, 340}, Window{40, 60, 300, 150}, Window{-20, -30, 530, 340}}) {
    if (!tried(number++, 3)) continue;
    beauty_over(window, display).write(beauty);
    expect_same(
        typed("--radius 0.06 --beauty " + beauty + " --composite " + composite + " --set composite-layers=rgba"));
  }
}

TEST_F(Tiles, give_the_bits_of_the_whole_with_hidden_surfaces) {
  std::vector<float> near = wall_frame(data, display).planes.at("ViewLayer.Depth.Z"), far = near;
  for (std::size_t i = 0; i < near.size(); i++) {
    near[i] += 0.2f + 0.05f * float(i / 7 % 4);
    far[i] += 0.5f;
  }
  write_plane(folder / "near.exr", "Z", near, data, display);
  write_plane(folder / "far.exr", "Z", far, data, display);
  expect_same({"--behind", folder / "near.exr", "--behind", folder / "far.exr", "--behind-kind", "backs,fronts",
               "--aov", "ao,hidden", "--radius", "0.06"});
  EXPECT_EQ(text_in(read_header(ao), "alcove/hidden"), "far.exr Z fronts; near.exr Z backs");
}

TEST_F(Tiles, give_the_bits_of_the_whole_in_exact_searches) {
  take_rendered_frame();
  if (!long_tests()) return expect_same(typed("--radius 0.05 --preset reference --slices 2 --roi 300,150,200,120"));
  expect_same(typed("--radius 0.05 --preset reference"));
  expect_same(typed("--radius 0.06 --preset reference --denoise none --thickness 0.05"));
}

// Slabs whose fronts lie 1.1 to 2.1 radii before the wall and the floor, with others behind them.
TEST_F(Tiles, give_the_bits_of_the_whole_where_solids_reach_into_the_sphere) {
  const auto put = [&](std::vector<float>& depth, double radius, int shift) {
    for (std::size_t i = 0; i < depth.size(); i++) {
      const int x = int(i) % data.width + shift, y = int(i) / data.width + shift;
      if (x % 60 < 40 && y % 50 < 34) depth[i] -= float(radius * (1.1 + 0.25 * ((x / 60 + y / 50) % 5)));
    }
  };
  const auto write_slabs = [&](double radius) {
    FrameFile slabs = wall_frame(data, display);
    std::vector<float>& near = slabs.planes.at("ViewLayer.Depth.Z");
    std::vector<float> far = near;
    put(near, radius, 0);
    for (std::size_t i = 0; i < far.size(); i++) far[i] += 0.02f;
    put(far, radius, 25);
    slabs.write(frame);
    write_plane(folder / "far.exr", "Z", far, data, display);
  };
  write_slabs(0.1);
  const Options slices = typed("--radius 0.1 --aov ao,transfer");
  const Options hidden{"--behind", folder / "far.exr", "--behind-kind", "fronts"};
  expect_same(joined(slices, {"--roi", "3,5,450,250"}));
  expect_same(joined(slices, hidden));
  if (!long_tests()) return;
  // Lines of an exact search go on for seven radii: with a larger one, each tile is computed with all of the frame.
  write_slabs(0.03);
  expect_same(joined(typed("--radius 0.03 --preset reference"), hidden));
}

TEST_F(Tiles, give_the_bits_of_the_whole_where_tiles_of_pixels_decide_for_others) {
  take_rendered_frame();
  const std::string part = long_tests() ? "" : " --roi 300,150,260,150";
  expect_same(typed("--radius 0.02 --tolerance 0.05 --set complete=none --aov ao,error" + part));
}

TEST_F(Tiles, give_the_warnings_of_the_whole) {
  FrameFile repaired = wall_frame(data, display);
  repaired.halves = {"ViewLayer.Depth.Z"};
  for (const std::size_t pixel : {50000, 140000}) repaired.planes.at("ViewLayer.Normal.X")[pixel] = NAN;
  repaired.write(frame);
  for (const char* more : {"--radius 0.005", "--radius 0.005 --roi 3,5,450,250"}) {
    expect_same(typed(more));
    const std::string notes = text_in(read_header(ao), "alcove/notes");
    for (const char* code : {"half-depth", "radius-below-precision", "radius-below-pixel", "repaired-normals"})
      EXPECT_THAT(notes, HasSubstr(code));
  }
}

using TilesOfShots = WalkedShot;

TEST_F(TilesOfShots, give_the_bits_of_the_whole) {
  const auto expect_same = [&](const char* more, std::uint64_t mebibytes) {
    SCOPED_TRACE(more);
    const auto computed = [&](std::uint64_t bytes) {
      const Options all = joined(typed("--radius 0.08 --slices 1 --steps 2 --frames 2 --type float"), typed(more));
      const RunReport report = run_here(joined(arguments(all), {"--stats", folder / "stats.json"}), bytes);
      EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "");
      return report.done == 1 ? std::pair(report.frames[0].parts, read_exr_image(output(2), {"Y"}).pixels)
                              : std::pair(0, std::vector<float>());
    };
    const auto [one, whole] = computed(0);
    const auto [many, tiled] = computed(mebibytes << 20);
    EXPECT_EQ(one, 1);
    EXPECT_GT(many, 1);
    EXPECT_TRUE(whole == tiled) << difference(tiled, whole).rmse;
  };
  write_shot(3, {0, 0, 512, 288});
  expect_same("--around 1", 40);
  if (long_tests()) expect_same("--accumulate 1 --aov ao,bent-normal", 48);
  expect_same("--accumulate 1 --aov ao,transfer", 84);
  // What moves is known in tiles after those of sky.
  constexpr Window kTall{0, 0, 512, 400};
  write_bytes(camera, wall_camera(kTall).dump());
  for (int frame = 1; frame <= 3; frame++) {
    FrameFile file = wall_frame(kTall, kTall);
    put_board(file, 0, {0.3 * frame - 0.5, 0.3 * frame, 0.9, 5});
    const auto begin = file.planes.at("ViewLayer.Depth.Z").begin();
    std::fill(begin, begin + 190 * kTall.width, 1e10f);
    file.write(input(frame));
  }
  expect_same("--accumulate 1", 42);
}

/// The megabytes of the --memory that a sentence names; 0 where it names none.
std::uint64_t memory_named_in(const std::string& text) {
  const std::string option = "--memory ";
  const auto at = text.find(option);
  return at == text.npos ? 0 : std::strtoull(text.c_str() + at + option.size(), nullptr, 10);
}

TEST_F(Tiles, too_little_memory_is_refused_with_the_least_that_is_enough) {
  const auto expect_enough_is_named = [&](const Window& window, const char* more) {
    FrameFile file = wall_frame(window, window);
    add_beauty(file);
    file.write(frame);
    write_bytes(camera, wall_camera(window).dump());
    const std::string enough = std::to_string(memory_named_in(expect_refused_with(1 << 20, typed(more), {})));
    const RunReport report = run_with(0, joined(typed(more), {"--memory", enough + "M"}));
    EXPECT_EQ(report.done, 1) << "with " << enough << "M: " << (report.stop ? report.stop->what() : "");
  };
  // Less than the planes alone take, which stay in memory beside any tile: 16 bytes per pixel.
  expect_enough_is_named(
      {0, 0, 320, 208},
      "--radius 0.4 --slices 1 --steps 2 --aov ao,bent-normal,transfer,normal,depth,specular-occlusion,confidence");
  // Codecs take more of more memory.
  expect_enough_is_named({0, 0, 160, 1500}, "--radius 50 --slices 1 --steps 2 --threads 4");
  const std::string copied = "--radius 0.06 --slices 1 --steps 2 --threads 4 --composite " + composite;
  expect_enough_is_named({0, 0, 200, 1500}, copied.c_str());
}

TEST_F(Tiles, too_little_memory_is_refused_with_its_cost_and_with_what_is_enough_for_the_whole) {
  const Options options = typed("--radius 0.06 --slices 1 --steps 2");
  const std::string refusal = expect_refused_with(3 << 20, options, {"times as long", "at once"});
  const std::uint64_t least = memory_named_in(refusal);
  const std::uint64_t at_once = memory_named_in(refusal.substr(refusal.find("), or --memory")));
  ASSERT_GT(at_once, least);
  const auto with = [&](std::uint64_t megabytes) {
    return joined(options, {"--memory", fmt::format("{}M", megabytes)});
  };
  const auto frame_within = [&](std::uint64_t megabytes) {
    const RunReport report = run_with(0, with(megabytes));
    EXPECT_EQ(report.done, 1) << megabytes << (report.stop ? report.stop->what() : "");
    return report.done == 1 ? report.frames[0] : FrameReport();
  };
  EXPECT_EQ(frame_within(at_once).parts, 1);
  const FrameReport parts = frame_within(least);
  EXPECT_EQ(memory_named_in(expect_refused_with(0, with(least - 1), {})), least);
  // The least is rounded up to whole MiB, and near it a little more memory saves many parts.
  const double told = std::strtod(refusal.c_str() + refusal.find("M (in ") + 6, nullptr);
  EXPECT_LE(parts.parts, told);
  EXPECT_GE(parts.parts, told / 6);
  const auto planned = [&](const Options& more) {
    return run_program(joined({"run", shot, "-o", ao, "--camera", shot_camera, "--type", "float", "--stats",
                               folder / "stats.json", "--dry-run"},
                              joined(options, more)));
  };
  EXPECT_THAT(planned({}).out,
              HasSubstr(fmt::format("{}M computes a frame at once, {}M is the least", at_once, least)));
  for (const std::uint64_t memory : {at_once - 1, (at_once + least) / 2}) {
    const int tiles = frame_within(memory).parts;
    EXPECT_GT(tiles, 1) << memory;
    EXPECT_THAT(planned({"--memory", fmt::format("{}M", memory)}).out,
                HasSubstr(fmt::format("in {} tiles per frame", tiles)));
  }
  const Finished refused = planned({"--memory", fmt::format("{}M", least - 1)});
  test::expect_refused(refused, 2, {shot});
  EXPECT_EQ(memory_named_in(refused.err), least) << refused;
  const auto with_preview = [&](std::uint64_t megabytes) {
    return Options{"--preview", folder / "p.png", "--memory", fmt::format("{}M", megabytes)};
  };
  const std::uint64_t whole = memory_named_in(planned(with_preview(least)).err);
  ASSERT_GT(whole, least);
  EXPECT_THAT(planned(with_preview(whole)).out, HasSubstr("nothing less is enough"));
  EXPECT_EQ(planned(joined(with_preview(least), {"--roi", "0,0,40,30"})).code, 0) << "a region takes less";
  EXPECT_EQ(run_with(0, joined(options, with_preview(whole))).done, 1);
  EXPECT_EQ(memory_named_in(expect_refused_with(0, joined(options, with_preview(whole - 1)), {"--preview"})), whole);
}

TEST_F(Tiles, that_cannot_be_are_refused) {
  expect_refused_with(kLittleMemory, {"--radius", "50"}, {frame, "--radius", "--memory"});
  expect_refused_with(kLittleMemory, {"--radius", "0.1", "--preview", folder / "p.png"},
                      {frame, "--preview", "--memory"});
}

TEST_F(Tiles, that_are_refused_leave_no_folder) {
  FrameFile repaired = wall_frame(data, display);
  add_beauty(repaired);
  repaired.planes.at("ViewLayer.Normal.X")[140000] = NAN;
  repaired.write(frame);
  const std::string inner = folder / "new/inner";
  const Options options =
      typed("--radius 0.05 --set warnings-as-errors=true --set composite-layers=rgba --composite " + inner + "/c.exr");
  const RunReport report = run_with(3 * little_memory, options);
  ASSERT_TRUE(report.stop);
  EXPECT_THAT(report.stop->what(), HasSubstr("repaired-normals")) << "or else no tile was begun";
  EXPECT_FALSE(fs::exists(folder / "new"));
  fs::create_directories(inner);
  ASSERT_TRUE(run_with(3 * little_memory, options).stop);
  EXPECT_TRUE(fs::exists(inner)) << "it was there before";
}

TEST_F(Tiles, are_told_of_in_a_note_and_decode_each_row_once) {
  const FrameReport report = done_in_tiles({"--radius", "0.015"}).frames[0];
  EXPECT_GT(report.parts, 2);
  EXPECT_EQ(report.rows_read, std::uint64_t(data.height));
  const auto note = std::ranges::find(report.notes, NoteCode::in_parts, &Note::code);
  ASSERT_NE(note, report.notes.end());
  EXPECT_THAT(note->text, AllOf(HasSubstr(fmt::format("in {} parts", report.parts)), HasSubstr("--memory")));
}

TEST_F(Tiles, of_a_frame_with_one_near_corner_are_few) {
  // The blocks of the corner reach across half of the frame, and no other.
  FrameFile corner = wall_frame(data, display);
  auto& depth = corner.planes.at("ViewLayer.Depth.Z");
  for (std::size_t y = 0; y < 16; y++)
    for (std::size_t x = 0; x < 32; x++) depth[y * std::size_t(data.width) + x] = 0.25f;
  corner.write(shot);
  EXPECT_LT(double(done_in_tiles({"--radius", "0.015"}).frames[0].pixels), 3.8 * double(data.pixels()));
}

}  // namespace
}  // namespace alcove::tiles_test
