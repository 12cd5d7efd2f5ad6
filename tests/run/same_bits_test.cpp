// Other ways to the same result give the same bits: threads, chunks, orders, and regions of frames.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "tests/support/openexr.h"
#include "tests/support/walked_shot.h"

namespace alcove::same_bits_test {
namespace {

using namespace test;

constexpr Window kWindow{0, 0, 128, 72}, kOverscan{-16, -8, 160, 88};
constexpr int kOverscanFrame = 9;

class SameBits : public WalkedShot {
 protected:
  /// What lies behind the board in each frame, as a file of a hidden surface and as deep samples.
  void write_hidden(int frames, const Window& window) const {
    for (int frame = 1; frame <= frames; frame++) {
      const auto first = with_board(frame, window).planes.at("ViewLayer.Depth.Z");
      std::vector<float> second = wall_frame(window, window).planes.at("ViewLayer.Depth.Z"), is_board;
      DeepFilePart samples;
      samples.data = window;
      for (std::size_t i = 0; i < first.size(); i++) {
        samples.pixels.push_back({{1, second[i]}, {1, first[i]}});
        is_board.push_back(first[i] == kBoard.depth ? 1 : 0);
        if (is_board[i] == 0) second[i] = 0;
      }
      write_plane(folder / fmt::format("peel.{}.exr", frame), "Z", second, window);
      write_plane(folder / fmt::format("board.{}.exr", frame), "Y", is_board, window);
      write_deep(folder / fmt::format("deep.{}.exr", frame), {samples});
    }
  }
  const std::string peel = folder / "peel.%d.exr", board = folder / "board.%d.exr", deep = folder / "deep.%d.exr";
};

TEST_F(SameBits, of_threads_chunks_and_orders) {
  const int frames = long_tests() ? 7 : 5;
  write_shot(frames);
  write_hidden(frames, kWallWindow);
  const std::vector<std::vector<std::string>> ways{
      {fmt::format("--threads 3 --frames {}-1", frames)},
      {fmt::format("--threads 2 --frames 1-{}x2,2-{}:2", frames, frames - 1)},
      {"--chunk 2/2", "--threads 1 --chunk 1/2"}};
  int number = 0;
  for (const std::string& more : std::vector<std::string>{
           "", "--accumulate 1 --around 1 --preset reference --aov ao,transfer", "--accumulate 2", "--preset draft",
           "--around 2 --estimator bitmask", "--around 1 --search exact --behind " + peel}) {
    SCOPED_TRACE(more);
    remove_outputs();
    done(joined(typed(more), {"--threads", "1"}));
    const auto before = outputs();
    EXPECT_EQ(before.size(), frames);
    const int row = number++;
    for (std::size_t i = 0; i < ways.size(); i++) {
      if (!tried(row + int(i), 3)) continue;
      std::vector<Options> runs;
      for (const auto& run : ways[i]) runs.push_back(typed(run + " " + more));
      expect_same_outputs(before, runs);
    }
    if (more.empty()) expect_same_outputs(before, {{"--accumulate", "0"}});
  }
}

TEST_F(SameBits, of_a_region_and_the_whole_at_less_cost) {
  const Window region{56, 48, 27, 20};
  write_shot(3, kWindow);
  write_hidden(3, kWindow);
  json cameras = json::parse(read_bytes(camera));
  cameras["frames"].push_back({{"frame", kOverscanFrame}});
  write_bytes(camera, cameras.dump());
  wall_frame(kOverscan, kWindow).write(input(kOverscanFrame));
  // What hides or completes surfaces may take all of a frame, and so may what tells how far back solids go.
  const std::string near = "--radius 0.3 ", exact = near + "--search exact ", ignore = "--set ignore=" + board;
  std::vector<std::tuple<int, double, std::string>> rows{
      {kOverscanFrame, 0.29, "--radius 0.05 --denoise none"},
      {kOverscanFrame, 0.82, "--radius 0.05 --denoise bilateral"},
      {kOverscanFrame, 0.4, "--radius 0.05 --set stride=4 --set density=uniform"},
      {kOverscanFrame, 0.8, near + "--set stride=1"},
      {kOverscanFrame, 1, exact},
      {2, 1, near + "--around 1 --accumulate 1"},
      {2, 1, near + "--behind " + peel + " --aov ao,hidden"},
      {2, 1, near + "--matte " + board + " --matte-outside 0.25"},
      {2, 1, near + ignore + " --resolution half --behind " + peel},
      {2, 1, exact + ignore + " --behind " + peel}};
  // Covered elsewhere: margins by tiles_test, combined options by rows above, deep files by deep_run_test.
  if (long_tests())
    rows.insert(rows.end(), {{kOverscanFrame, 1, near + "--preset draft"},
                             {kOverscanFrame, 0.91, near + "--resolution half"},
                             {kOverscanFrame, 1, near + "--resolution quarter --denoise box"},
                             {2, 1, near + "--around 1"},
                             {2, 1, near + "--accumulate 1"},
                             {2, 1, near + ignore + " --behind " + peel},
                             {2, 1, exact + "--deep " + deep}});
  for (const auto& [frame, most, more] : rows) {
    SCOPED_TRACE(more);
    const Options options = joined({"--type", "float", "--frames", std::to_string(frame)}, typed(more));
    const auto cost_of = [&](const Options& part) {
      return stats_of(joined(options, part))["frames"][0]["pixels"].get<double>();
    };
    const double cost = cost_of({});
    const Image whole = read_exr_image(output(frame));
    EXPECT_LE(cost_of({"--roi", "56,48,27,20"}), most * cost);
    const Image part = read_exr_image(output(frame));
    EXPECT_EQ(part.data, region);
    EXPECT_EQ(part.display, kWindow);
    EXPECT_EQ(difference(part.pixels, cropped(whole.pixels, whole.data, region)).max, 0);
    // Filters, and estimates that many pixels share, leave less of the crease.
    const bool is_smooth = std::regex_search(more, std::regex("bilateral|half|quarter|uniform"));
    EXPECT_LT(std::ranges::min(part.plane("Y")), is_smooth ? 0.99 : 0.95) << "or else there is nothing to compare";
  }
}

// How many directions a tile takes is decided by all of its pixels, and by its neighbours, at each of four comparisons.
TEST_F(SameBits, of_a_region_by_error_take_the_tiles_that_decide) {
  const std::string interior = ALCOVE_SOURCE_DIR "/examples/interior", stats = folder / "stats.json";
  const auto width_of = [&](const std::string& search) {
    run_well(typed("run " + interior + ".gbuffer.exr --camera " + interior + ".camera.json -o " + output(1) +
                   " --stats " + stats + " --roi 480,270,20,16 --radius 0.02 --set complete=none " + search));
    return std::sqrt(json::parse(read_bytes(stats))["frames"][0]["pixels"].get<double>());
  };
  EXPECT_GE(width_of("--tolerance 0.004"), width_of("--search exact --denoise none") + 55) << "39 px on either side";
}

TEST_F(SameBits, of_a_region_come_from_one_reading) {
  write_frames(1, 1);
  for (const char* more : {"", "--roi 4,6,20,10", "--roi 4,6,20,10 --preset reference"})
    EXPECT_EQ(stats_of(typed(std::string("--radius 0.02 ") + more))["frames"][0]["rows_read"], kWallWindow.height)
        << more;
}

TEST_F(SameBits, of_a_region_that_shows_too_little_are_read_as_those_of_the_whole) {
  const Window tall{0, 0, 320, 240};
  FrameFile inverse = wall_frame(tall, tall);
  inverse.change("Depth", [](float z) { return 20 / z; });
  inverse.write(input(1));
  json silent = wall_camera(tall);
  silent.erase("depth");
  write_bytes(camera, silent.dump());
  const auto computed = [&](const char* more) {
    EXPECT_THAT(done(typed(more)).err, HasSubstr("depth kind taken as inverse")) << "or else nothing is proved";
    return read_exr_image(output(1));
  };
  const Image whole = computed("--radius 0.1"), part = computed("--radius 0.1 --roi 10,12,24,9");
  EXPECT_EQ(part.pixels, cropped(whole.pixels, tall, part.data));
}

}  // namespace
}  // namespace alcove::same_bits_test
