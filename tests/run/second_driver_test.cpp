// SwiftShader, which Debian has in chromium-common, computes what lavapipe does, and the same to the bit in other ways.
// SPDX-License-Identifier: BSD-3-Clause
//
// It computes slowly, so that frames are small. Its time to compile a loop doubles with each branch in it. Shared
// estimates would take minutes, so --set stride=1 leaves them out.
#include "core/base/text.h"
#include "tests/support/test.h"
#include "tests/support/walked_shot.h"

namespace alcove::second_driver_test {
namespace {

using namespace test;

constexpr const char* kSwiftShader = "/usr/lib/chromium/vk_swiftshader_icd.json";
constexpr Window kWindow{0, 0, 64, 36};
constexpr Window kLargeWindow{0, 0, 480, 270};
constexpr std::uint64_t kLittleMemory = 6 << 20;  // bytes for frames: too few for a large one as a whole

/// The second of two frames past a board, with a beauty, and with a wall behind the board.
class SecondDriver : public WalkedShot {
 protected:
  void SetUp() override {
    if (!fs::exists(kSwiftShader)) {
      if (std::getenv("CI")) FAIL() << "there is no SwiftShader (Debian package chromium-common)";
      GTEST_SKIP() << "there is no SwiftShader (Debian package chromium-common)";
    }
    ::setenv("VK_ADD_DRIVER_FILES", kSwiftShader, 1);
    ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
    write_shot(2, kWindow);
    FrameFile frame = with_board(2, kWindow);
    write_plane(folder / "behind.exr", "Z", wall_frame(kWindow, kWindow).planes.at("ViewLayer.Depth.Z"), kWindow);
    add_beauty(frame);
    frame.write(input(2));
  }
  ~SecondDriver() override { ::unsetenv("VK_ADD_DRIVER_FILES"); }

  /// All floats that a run on the second frame writes. With `bytes` for frames it must take several tiles.
  std::vector<float> computed(const std::string& device, const std::string& more, std::uint64_t bytes = 0) const {
    const Options first = typed("--type float --frames 2 --device " + device + " --stats " + (folder / "stats.json"));
    Options options = arguments(joined(first, typed(more)));
    const bool composes = more.ends_with("--composite");
    if (composes) options = joined(options, {composite});
    const RunReport report = run_here(options, bytes);
    EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "") << more;
    if (report.done != 1) return {};
    EXPECT_EQ(report.frames[0].parts > 1, bytes > 0) << more;
    EXPECT_THAT(lower_case(report.device), HasSubstr(device));
    std::vector<float> values = read_exr_image(output(2)).pixels;
    if (composes) std::ranges::copy(read_exr_image(composite).pixels, std::back_inserter(values));
    return values;
  }
  /// What SwiftShader computes, which must be what lavapipe does.
  std::vector<float> compared(const std::string& more) {
    const auto first = computed("llvmpipe", more), second = computed("swiftshader", more);
    EXPECT_EQ(first.size(), second.size()) << more;
    if (first.size() != second.size() || first.empty()) return second;
    const double rms = difference(first, second).rmse;
    RecordProperty("rms" + more, fmt::format("{:.7f}", rms));
    EXPECT_LE(rms, 1e-4) << more;
    EXPECT_LT(*std::ranges::min_element(first), 0.9) << more << ": a frame that says little";
    return second;
  }
  void expect_same(const std::vector<float>& whole, const std::string& more, std::uint64_t bytes = 0) const {
    EXPECT_TRUE(same_bits(computed("swiftshader", more, bytes), whole)) << more;
  }

  const std::string composite = folder / "composite.exr";
};

TEST_F(SecondDriver, takes_horizons_of_directions_as_the_first_does) {
  compared("--estimator hbao");
  compared("--estimator hbao --resolution half --aov ao,normal");
}

// In a rendered frame: on the wall, rounding decides for single pixels how thick the board is.
TEST_F(SecondDriver, searches_slices_as_the_first_does) {
  const std::string interior = ALCOVE_SOURCE_DIR "/examples/interior.";
  const auto computed = [&](const char* device) {
    run_well(typed("run " + interior + "gbuffer.exr --camera " + interior + "camera.json --radius 0.35 -o " +
                   output(1) + " --roi 400,200,96,64 --type float --slices 2 --steps 8 --set stride=1 --device " +
                   device));
    return read_exr_image(output(1)).pixels;
  };
  const auto first = computed("llvmpipe"), second = computed("swiftshader");
  EXPECT_LE(difference(first, second).rmse, 1e-6);
  EXPECT_LT(*std::ranges::min_element(first), 0.9) << "a frame that says little";
}

TEST_F(SecondDriver, searches_exactly_as_the_first_does) {
  if (!long_tests()) GTEST_SKIP() << "it takes half a minute to compile each";
  compared("--search exact --slices 2 --set complete=none");
  compared("--search exact --slices 2 --behind " + (folder / "behind.exr"));
}

TEST_F(SecondDriver, accumulates_and_composes_as_the_first_does) {
  const std::string crytek = "--estimator crytek";
  const auto whole = compared(crytek);
  EXPECT_FALSE(same_bits(compared(crytek + " --accumulate 1"), whole));
  compared(crytek + " --composite");
  expect_same(whole, crytek + " --no-skip");
  expect_same(whole, crytek);
}

TEST_F(SecondDriver, computes_tiles_to_the_bit) {
  write_shot(2, kLargeWindow);
  for (const char* more : {"--estimator crytek --radius 0.2", "--estimator hbao --radius 0.1"})
    expect_same(computed("swiftshader", more), more, kLittleMemory);
}

}  // namespace
}  // namespace alcove::second_driver_test
