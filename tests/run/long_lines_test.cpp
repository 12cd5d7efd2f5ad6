// Exact searches count the pixels of a line in 16 bits: longer frames are cut, and never wrong in silence. Others take
// them whole.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/compute.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"

namespace alcove::long_lines_test {
namespace {

using namespace test;

constexpr int kLongest = 65535;  // px that an exact search can number along a line

class LongLines : public CommandLine {
 protected:
  /// A frame of steps that go up and down along its longer side, as a camera without perspective sees them: every step
  /// occludes the one below it.
  void write_steps(int width, int height) {
    const Window window{0, 0, width, height};
    std::vector<float> depth(window.pixels());
    for (std::size_t i = 0; i < depth.size(); i++) {
      const std::size_t along = width > height ? i % std::size_t(width) : i / std::size_t(width);
      depth[i] = along / 7 % 2 ? 10.0f : 12.0f;
    }
    write_plane(frame, "Z", depth, window);
    columns = width;
  }
  /// A pixel is one scene unit wide.
  Finished search(const std::string& more) const {
    return run_program(
        typed(fmt::format("run {} -o {} --ortho-width {} --depth-channel Z --slices 2 --denoise none "
                          "--type float --memory 4G --stats {} {}",
                          frame, ao, columns, stats, more)));
  }
  /// How many parts a search within a radius of 4 that must succeed took.
  int parts(const std::string& more = {}) const {
    const Finished finished = search("--search exact --radius 4 " + more);
    EXPECT_EQ(finished.code, 0) << finished;
    return json::parse(read_bytes(stats))["frames"][0]["parts"];
  }
  const std::string stats = folder / "stats.json";
  int columns = 0;
};

TEST_F(LongLines, of_65535_pixels_are_searched_at_once_and_longer_ones_in_parts) {
  for (const bool steep : {false, true})
    for (const int length : {kLongest, kLongest + 1}) {
      write_steps(steep ? 2 : length, steep ? length : 2);
      EXPECT_EQ(parts() > 1, length > kLongest) << length << (steep ? " down" : " across");
    }
}

TEST_F(LongLines, give_the_bits_of_their_parts) {
  const int width = 80000, height = 4;
  write_steps(width, height);
  parts();
  const Image whole = read_exr_image(ao);
  for (const int x : {0, kLongest - 30, width - 64}) {
    EXPECT_EQ(parts(fmt::format("--roi {},0,64,{}", x, height)), 1);
    const Image alone = read_exr_image(ao);
    EXPECT_EQ(alone.pixels, cropped(whole.pixels, whole.data, {x, 0, 64, height})) << x;
    EXPECT_LT(std::ranges::min(alone.pixels), 0.9) << "or else there is nothing to compare";
  }
}

TEST_F(LongLines, give_the_bits_of_their_parts_where_pixels_share_estimates) {
  const int length = 70000;
  for (const auto& [width, height] : {std::pair{length, 4}, {4, length}}) {
    write_steps(width, height);
    for (const char* preset : {"draft", "standard"}) {
      const auto image = [&](const std::string& more) {
        const Finished finished = run_program(
            typed(fmt::format("run {} -o {} --ortho-width {} --depth-channel Z --preset {} --radius 4 --type float {}",
                              frame, ao, columns, preset, more)));
        EXPECT_EQ(finished.code, 0) << finished;
        return read_exr_image(ao);
      };
      const Image whole = image("");
      const int end = length - 64;
      const Window last = width > height ? Window{end, 0, 64, height} : Window{0, end, width, 64};
      const Image alone = image(fmt::format("--roi {},{},{},{}", last.x, last.y, last.width, last.height));
      EXPECT_EQ(alone.pixels, cropped(whole.pixels, whole.data, last)) << preset << " " << width;
      EXPECT_LT(std::ranges::min(alone.pixels), 0.97) << "or else there is nothing to compare";
    }
  }
}

TEST_F(LongLines, that_no_part_can_hold_or_number_are_refused_with_what_mends_it) {
  write_steps(kLongest + 1, 2);
  for (const auto& [more, text] : {std::pair(std::string("--radius 60000"), "65535"),
                                   {"--radius 4 --preview " + (folder / "p.png"), "--preview"}}) {
    test::expect_refused(search("--search exact " + more), 5, {text, "--search steps"});
  }
  EXPECT_EQ(search("--search steps --steps 4 --radius 60000").code, 0);
  write_steps(131072, 1);
  test::expect_refused(search("--search exact --radius 4"), 3, {"131072 px", "131070", "--search steps"});
}

TEST(Chain, refuses_lines_that_an_exact_search_cannot_number) {
  HostFrame host;
  host.data = host.display = {0, 0, kLongest + 1, 1};
  host.camera.fx = host.camera.fy = 100;
  host.depth.assign(host.data.pixels(), 10.0f);
  EstimatorSettings settings;
  settings.radius = 1;
  settings.search = SliceSearch::exact;
  gpu::Recorder gpu(device());
  try {
    compute_ao(gpu, host, settings);
    ADD_FAILURE() << "computed in silence";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("--search steps"));
  }
}

}  // namespace
}  // namespace alcove::long_lines_test
