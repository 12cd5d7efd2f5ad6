// Exact searches count the pixels of a line in 16 bits: longer frames are cut, and never wrong in silence.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "core/chain/compute.h"
#include "core/formats/exr.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kLongest = 65535;  // px that an exact search can number along a line

class LongLines : public CommandLine {
 protected:
  /// A frame of steps that go up and down along its longer side, as a camera without perspective sees them: every step
  /// occludes the one below it.
  void write_steps(int width, int height) {
    const Window window{0, 0, width, height};
    FrameFile steps;
    steps.data = steps.display = window;
    std::vector<float>& depth = steps.planes["Z"];
    depth.resize(window.pixels());
    for (std::size_t i = 0; i < depth.size(); i++) {
      const std::size_t along = width > height ? i % std::size_t(width) : i / std::size_t(width);
      depth[i] = along / 7 % 2 ? 10.0f : 12.0f;
    }
    steps.write(frame);
  }

  struct Search {
    std::string width;  // scene units of the display window: a pixel is one wide
    std::string output, radius = "4", kind = "exact";
    std::vector<std::string> more = {};
  };
  Finished run_search(const Search& search) const {
    std::vector<std::string> arguments{"run",
                                       frame,
                                       "-o",
                                       search.output,
                                       "--radius",
                                       search.radius,
                                       "--search",
                                       search.kind,
                                       "--ortho-width",
                                       search.width,
                                       "--depth-channel",
                                       "Z",
                                       "--slices",
                                       "2",
                                       "--denoise",
                                       "none",
                                       "--type",
                                       "float",
                                       "--memory",
                                       "4G",
                                       "--stats",
                                       folder / "stats.json"};
    arguments.insert(arguments.end(), search.more.begin(), search.more.end());
    return run_program(arguments);
  }
  int parts() const { return json::parse(read_bytes(folder / "stats.json"))["frames"][0]["parts"]; }
};

TEST_F(LongLines, of_65535_pixels_are_searched_at_once_and_longer_ones_in_parts) {
  for (const bool steep : {false, true})
    for (const int length : {kLongest, kLongest + 1}) {
      write_steps(steep ? 2 : length, steep ? length : 2);
      const Finished finished = run_search({std::to_string(steep ? 2 : length), ao});
      ASSERT_EQ(finished.code, 0) << finished;
      EXPECT_EQ(parts() > 1, length > kLongest) << length << (steep ? " down" : " across");
    }
}

TEST_F(LongLines, give_the_bits_of_their_parts) {
  const int width = 80000, height = 4;
  write_steps(width, height);
  ASSERT_EQ(run_search({std::to_string(width), ao}).code, 0);
  const Image whole = read_exr_image(ao);
  for (const Window& part :
       {Window{0, 0, 64, height}, Window{kLongest - 30, 0, 64, height}, Window{width - 64, 0, 64, height}}) {
    const std::string file = folder / "part.exr";
    ASSERT_EQ(run_search({.width = std::to_string(width),
                          .output = file,
                          .more = {"--roi", fmt::format("{},{},{},{}", part.x, part.y, part.width, part.height)}})
                  .code,
              0);
    EXPECT_EQ(parts(), 1);
    const Image alone = read_exr_image(file);
    EXPECT_EQ(alone.pixels, cropped(whole.pixels, whole.data, part)) << to_string(part);
    EXPECT_LT(*std::ranges::min_element(alone.pixels), 0.9) << "or else there is nothing to compare";
  }
}

TEST_F(LongLines, that_no_part_can_hold_are_refused_with_what_mends_it) {
  write_steps(kLongest + 1, 2);
  const Finished far = run_search({"65536", ao, "60000"});
  EXPECT_EQ(far.code, 5) << far;
  EXPECT_THAT(far.err, AllOf(HasSubstr("--search steps"), HasSubstr("65535")));
  const Finished picture = run_search({"65536", ao, "4", "exact", {"--preview", folder / "p.png"}});
  EXPECT_EQ(picture.code, 5) << picture;
  EXPECT_THAT(picture.err, AllOf(HasSubstr("--preview"), HasSubstr("--search steps")));
  EXPECT_EQ(run_search({"65536", ao, "60000", "steps", {"--steps", "4"}}).code, 0);
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

TEST_F(LongLines, that_cannot_be_numbered_at_all_are_refused) {
  write_steps(131072, 1);
  const Finished finished = run_search({"131072", ao});
  EXPECT_EQ(finished.code, 3) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("131072 px"), HasSubstr("131070"), HasSubstr("--search steps")));
}

}  // namespace
}  // namespace alcove
